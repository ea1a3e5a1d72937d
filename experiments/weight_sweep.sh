#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Which weight of the prior is best? Held-out facades' lattices are parsed with cell costs of hard labels (0.994/0.001 a pixel)
# in region mode by the finished grammars of many weights (0: the initial grammar): pixel accuracy and energy per pixel.
# usage: weight_sweep.sh ECP_DATASET [learn-grammar options...]
#   FOLDS="1 2"  IMAGES=10 (held-out facades a fold)  WEIGHTS="0 0.01 ..."  SG_BUILD_DIR=build
set -eu
data=${1:?usage: weight_sweep.sh ECP_DATASET [learn-grammar options...]}; shift
build=${SG_BUILD_DIR:-build}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
echo "options: $*; folds: ${FOLDS:=1}; ${IMAGES:=10} held-out facades a fold"
printf 'weight\tfold\tN\tx\ty\tfacades\toutside\taccuracy\tlattice\tenergy_per_pixel\tseconds\n'
for w in ${WEIGHTS:-0 0.01 0.03 0.1 0.3 1 2}; do
    for k in $FOLDS; do
        "$build"/learn/learn-grammar "$data" --fold "$k" --classes "$data/classes7.tsv" --quiet --weight "$w" "$@" \
            -o "$work/$w.sg" --json "$work/r.json"
        size() { awk -v n="\"$1\":" '/^ "/ { inside = $1 == "\"finished\":" } inside && /^  "/ && $1 == n { sub(/,$/, "", $2); print $2; exit }' "$work/r.json"; }
        "$build"/experiments/eval_parse --fold "$k" --classes "$data/classes7.tsv" --max-images "$IMAGES" --quiet \
            "$data" "$work/$w.sg" |
            awk -F'\t' -v w="$w" -v k="$k" -v n="$(size nonterminals)" -v x="$(size rules_x)" -v y="$(size rules_y)" \
                '{ printf "%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n", w, k, n, x, y, $2, $3, $4, $5, $6, $7 }' | tee -a "$work/all"
    done
done
awk -F'\t' '{ a[$1] += $8; e[$1] += $10; n[$1]++; if (!($1 in seen)) { seen[$1] = 1; order[++m] = $1 } }
    END { for (i = 1; i <= m; i++) { w = order[i]; printf "mean of w = %s: accuracy %.2f, energy per pixel %.5f\n", w, a[w] / n[w], e[w] / n[w]
              if (i == 1 || e[w] / n[w] < best) { best = e[w] / n[w]; at = w } }
          print "least energy per pixel at w = " at }' "$work/all"
