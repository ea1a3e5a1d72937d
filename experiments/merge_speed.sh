#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Speed of model merging on ECP, one core: 30 and all 80 training images (train and valid of fold 1), counts carried along with
# one re-estimation at the end, and re-estimation by parsing after every merge; how far the two energies differ.
# usage: merge_speed.sh ECP_DATASET [learn-grammar options...]    (SG_BUILD_DIR)
set -eu
data=${1:?usage: merge_speed.sh ECP_DATASET [learn-grammar options...]}; shift
build=${SG_BUILD_DIR:-build}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
"$build"/parse/make-lattice "$data" --classes "$data/classes7.tsv" -o "$work/lat" --quiet >/dev/null
awk -F'\t' '$2 == "train" || $2 == "valid" { print $1 }' "$data/folds/1.tsv" >"$work/names"
field() { awk -v n="\"$2\":" '$1 == n && /^ "/ { sub(/,$/, "", $2); print $2; exit }' "$1"; }
echo "options: $*; seconds of learning without reading and fitting; median of three"
for n in 30 80; do
    for regroup in pairs floors best; do
        for when in end every; do
            for _ in 1 2 3; do
                "$build"/learn/learn-grammar "$work/lat" --names "$work/names" --max-images $n --classes "$data/classes7.tsv" \
                    --threads 1 --quiet --regroup $regroup --reestimate $when "$@" -o "$work/g.sg" --json "$work/$when.json"
                field "$work/$when.json" seconds
            done | sort -g | sed -n 2p >"$work/$when.s"
        done
        printf '%s images, regroup %-6s: end %.2f s, every %.2f s (%s lattices parsed); energies %.4f and %.4f differ by %.3g; %s merges\n' \
            $n $regroup "$(cat "$work/end.s")" "$(cat "$work/every.s")" "$(field "$work/every.json" lattices_parsed)" \
            "$(field "$work/end.json" energy)" "$(field "$work/every.json" energy)" \
            "$(echo "$(field "$work/end.json" energy) $(field "$work/every.json" energy)" | awk '{ print $1 - $2 }')" \
            "$(field "$work/end.json" merges)"
    done
done
