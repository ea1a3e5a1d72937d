#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Times of the Earley parser on real facades: earley.sh DATASET [FOLD]
# Lattices of the first 30 training images, the initial and the induced grammar (w = 0.3) by cells, the finished ones by
# regions, over labels and over pixel costs. Then the synthetic part of bench_earley. Milliseconds a lattice, one thread.
set -eu
[ $# -ge 1 ] || { echo "usage: $0 DATASET [FOLD]" >&2; exit 2; }
build=${SG_BUILD_DIR:-build}
data=$1 fold=${2:-1}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
classes=$data/classes7.tsv
[ -e "$classes" ] || classes=$data/classes.tsv

"$build/parse/make-lattice" "$data" -o "$work/lattices" --fold "$fold" --classes "$classes" --max-images 30 --quiet \
    >"$work/lattices.txt"
tail -n 1 "$work/lattices.txt"
"$build/parse/make-lattice" "$data" -o "$work/held-out" --fold "$fold" --part test --classes "$classes" --max-images 10 \
    --quiet >/dev/null
"$build/learn/learn-grammar" "$work/lattices" -o "$work/finished.json" --initial "$work/initial.json" \
    --json "$work/result.json" --weight 0.3 --reestimate end --quiet >/dev/null
# The merged grammar, before finishing, stands in the result.
python3 -c 'import json, sys; json.dump(json.load(open(sys.argv[1]))["merged"], open(sys.argv[2], "w"))' \
    "$work/result.json" "$work/merged.json"
bench() { # NAME MODE GRAMMAR LATTICES [OPTION]
    name=$1 mode=$2 grammar=$3 lattices=$4
    shift 4
    "$build/experiments/bench_earley" --name "$name" --mode "$mode" "$@" "$work/$grammar.json" "$work/$lattices"/*.lat
}
printf '%-34s %6s %6s %7s %7s %9s %9s %8s %9s %9s %9s %8s\n' 'grammar, lattices' '|N|' rules parsed table Viterbi slowest \
    'its tree' inside expected states MB
bench 'initial, by cells' cell initial lattices
bench 'induced (w = 0.3), by cells' cell merged lattices
bench 'finished, by regions' region finished lattices
bench 'finished, by regions, pixel costs' region finished lattices --costs
bench 'the same, facades not learned from' region finished held-out --costs
echo
"$build/experiments/bench_earley"
