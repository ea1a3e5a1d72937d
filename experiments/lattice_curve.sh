#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Accuracy of lattices against their size, over all maps of a data set: the ceiling of what is learned from them.
# Usage: lattice_curve.sh [DATASET [CLASSES]]   (default: the ECP facades in $SG_SHARED_DIR/data, seven classes)
# For comparison on these maps: alternating dynamic programs with a fixed price a line, without the rest, reached 98.2 % at
# 584 cells and 97.1 % at 376. Times are processor time of one core: evidence, sums and all descents of a fit.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
build=${SG_BUILD_DIR:-$here/build}
shared=${SG_SHARED_DIR:-$here/../shared}
dataset=${1:-$shared/data/ecp}
classes=${2:-$dataset/classes7.tsv}
[ -e "$classes" ] || classes=$dataset/classes.tsv
[ -d "$dataset/labels" ] || { echo "no data set in $dataset" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

run() { # TITLE OPTION...
    local title=$1
    shift
    "$build/parse/make-lattice" "$dataset" --classes "$classes" -o "$work/out" --quiet --json "$work/json" "$@" >"$work/table"
    awk -v title="$title" -v ms="$(sed -n 's/.*"mean_milliseconds": \([0-9.]*\).*/\1/p' "$work/json")" '
        $1 == "mean" { printf "%-34s %8s %7s %7s %9s %9s %7.1f\n", title, $4, $2, $3, $5, $9, ms }' \
        "$work/table"
}

printf '%-34s %8s %7s %7s %9s %9s %7s\n' "weights" "cells" "columns" "rows" "accuracy" "pooled" "ms/map"
run "description length (default)"
echo "-- one price of a cell, a share of each map (--mean-cells): the curve"
for n in 150 200 300 400 500 600 700 800 1000 1500; do run "mean cells $n" --mean-cells $n; done
run "mean accuracy 97 %" --mean-accuracy 0.97
run "mean accuracy 98 %" --mean-accuracy 0.98
run "mean accuracy 99 %" --mean-accuracy 0.99
echo "-- one price of a line, the same for all maps (--lambda): E = wrong + v (columns + rows)"
for v in 400 275 200 143 120 100 50; do run "lambda $v" --lambda $v; done
echo "-- the same size, or the same accuracy, for every map"
for n in 400 600; do run "cells $n" --cells $n; done
for a in 0.97 0.98; do run "accuracy $a" --accuracy $a; done
echo "-- descents a fit (price of a cell 3.3 in 100000)"
for n in 1 2 4; do run "starts $n" --mu 3.3 --starts $n; done
echo
echo "What is lost at a mean of 600 cells"
"$build/parse/make-lattice" "$dataset" --classes "$classes" -o "$work/out" --quiet --mean-cells 600 --loss | sed '1,/^mean/d'
echo
echo "The ten worst maps there"
"$build/parse/make-lattice" "$dataset" --classes "$classes" -o "$work/out" --quiet --mean-cells 600 | sed '1d;/^mean/d' | sort -k5,5n | head
if [ -x "$build/experiments/lattice_starts" ]; then
    echo
    echo "Is there anything better? Energies against the best of random starts"
    "$build/experiments/lattice_starts" "$dataset" "$classes" 30
fi
