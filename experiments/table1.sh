#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Table 1 of the model-merging paper (Martinovic and Van Gool, CVPR 2013): sizes of the initial and the induced grammars over
# five folds of the ECP facades, first 30 training images each, seven classes.
# usage: table1.sh ECP_DATASET [learn-grammar options...]    (SG_BUILD_DIR: where the programs are)
set -eu
data=${1:?usage: table1.sh ECP_DATASET [learn-grammar options...]}; shift
build=${SG_BUILD_DIR:-build}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
# The paper's own setting: rows regrouped in pairs, and any two symbols of equal labels may be merged.
paper=(--regroup pairs --compatible labels)
[ $# = 0 ] || paper=("$@")

"$build"/parse/make-lattice "$data" --classes "$data/classes7.tsv" -o "$work/lat" --quiet >"$work/lattices"
for k in 1 2 3 4 5; do
    awk -F'\t' '$2 == "train" { print $1 }' "$data/folds/$k.tsv" | head -n 30 >"$work/names$k"
done

# field FILE NAME: of the result; field FILE OBJECT NAME: of an object in it (one is indented by one space, two by two)
field() {
    if [ $# = 2 ]; then awk -v n="\"$2\":" '$1 == n && /^ "/ { sub(/,$/, "", $2); print $2; exit }' "$1"
    else awk -v o="\"$2\":" -v n="\"$3\":" '/^ "/ { inside = $1 == o } inside && /^  "/ && $1 == n { sub(/,$/, "", $2); print $2; exit }' "$1"; fi
}
# mean +- sd of a column of numbers
summary() { awk '{ s += $1; q += $1 * $1; n++ } END { m = s / n; v = n > 1 ? (q - n * m * m) / (n - 1) : 0; printf "%.1f +- %.1f", m, (v > 0 ? sqrt(v) : 0) }'; }
mean() { awk '{ s += $1; n++ } END { printf "%.4f", s / n }'; }

echo "settings: ${paper[*]}; lattices by description length (make-lattice); classes7.tsv; first 30 training images"
tail -n 1 "$work/lattices"
for k in 1 2 3 4; do for j in 2 3 4 5; do
    [ "$k" -ge "$j" ] || ! cmp -s "$work/names$k" "$work/names$j" || echo "note: folds $k and $j have the same first 30 training images"
done; done
echo
echo "published              |N| 126.8 +- 6.6  |R_x| 121.8 +- 6.6  |R_y| 33.0   initial"
echo "                       |N|  26.6         |R_x|  65           |R_y| 15.6   induced, w = 0.3"
echo "                       |N|  14           |R_x|  27.8         |R_y| 11     induced, w = 1"
echo "(The paper's 126.8 = 121.8 + 4 + 1: it counts neither lexical symbols nor, it seems, uncollapsed rows. Ours counts all"
echo " non-terminals, seven lexical ones among them. 'collapsed': rules after runs of one symbol are collapsed.)"
exceptions=0
for term in marginal viterbi; do
    for share in none equal collapsed; do
        echo
        echo "== data term $term, --share $share"
        for w in 0.3 1.0; do
            for k in 1 2 3 4 5; do
                "$build"/learn/learn-grammar "$work/lat" --names "$work/names$k" --classes "$data/classes7.tsv" --quiet \
                    --share "$share" --data-term "$term" --weight "$w" "${paper[@]}" -o "$work/g.sg" --json "$work/$w.$k.json"
            done
            if [ "$w" = 0.3 ]; then
                printf '%-22s' initial
                for f in nonterminals rules_x rules_y; do
                    printf ' %s %s ' "$f" "$(for k in 1 2 3 4 5; do field "$work/$w.$k.json" initial $f; done | summary)"
                done
                printf ' collapsed: x %s y %s\n' "$(for k in 1 2 3 4 5; do field "$work/$w.$k.json" initial_finished rules_x; done | summary)" \
                    "$(for k in 1 2 3 4 5; do field "$work/$w.$k.json" initial_finished rules_y; done | summary)"
            fi
            printf 'induced, w = %-9s' "$w"
            for f in nonterminals rules_x rules_y; do
                printf ' %s %s ' "$f" "$(for k in 1 2 3 4 5; do field "$work/$w.$k.json" $f; done | summary)"
            done
            printf ' collapsed: x %s y %s\n' "$(for k in 1 2 3 4 5; do field "$work/$w.$k.json" finished rules_x; done | summary)" \
                "$(for k in 1 2 3 4 5; do field "$work/$w.$k.json" finished rules_y; done | summary)"
        done
        for f in "nonterminals" "rules_x" "rules_y" "finished rules_x" "finished rules_y"; do
            # shellcheck disable=SC2086
            a=$(for k in 1 2 3 4 5; do field "$work/0.3.$k.json" $f; done | mean)
            # shellcheck disable=SC2086
            b=$(for k in 1 2 3 4 5; do field "$work/1.0.$k.json" $f; done | mean)
            awk -v a="$a" -v b="$b" 'BEGIN { exit !(b < a) }' && echo "mean of $f falls from w = 0.3 to 1: $a -> $b" && continue
            echo "EXCEPTION: mean of $f does not fall from w = 0.3 to 1: $a -> $b"; exceptions=$((exceptions + 1))
        done
    done
done
echo
echo "$exceptions exceptions. In cell mode a row is a sequence of lexical symbols and columns, so merging rows leaves their rules"
echo "apart: symbols become fewer with w, x-rules and y-rules only once runs are collapsed (finished)."
