#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Learning a grammar without ground truth (named as future work by Martinovic and Van Gool, CVPR 2013). The classifier comes from
# the training part of a fold; the photographs of its validation and test part have no labels here. A grammar is learned
# from their unaries' MAP label maps, they are parsed with it, a grammar is learned from the parses, and so on. Printed is
# the accuracy of each iteration on these photographs; their label maps serve for that alone.
# usage: unsupervised.sh ECP_DATASET FOLDER [FOLD]    (SG_BUILD_DIR; ITERATIONS=3; SET=rich|patch; SG_MOVES; SG_LEARN; SG_PARSE)
set -eu
data=${1:?usage: unsupervised.sh ECP_DATASET FOLDER [FOLD]}
out=${2:?usage: unsupervised.sh ECP_DATASET FOLDER [FOLD]}
fold=${3:-1}
build=${SG_BUILD_DIR:-build}
classes=$data/classes7.tsv
set=${SET:-rich}
mkdir -p "$out"
awk -F'\t' '$2 == "test" || $2 == "valid" { print $1 }' "$data/folds/$fold.tsv" >"$out/names"
photographs=$(while read -r n; do ls "$data/images/$n".*; done <"$out/names")
forest="--features rich"
[ "$set" = rich ] || forest="--features patch --balanced --trees 4 --depth 8"

# shellcheck disable=SC2086
[ -s "$out/$set.rf" ] || "$build"/parse/learn-unaries "$data" --fold "$fold" --classes "$classes" $forest --quiet -o "$out/$set.rf"
# shellcheck disable=SC2086
"$build"/parse/apply-unaries "$out/$set.rf" $photographs --quiet -o "$out/unaries"

score() { # NAME DIR: what the label maps in DIR are worth
    "$build"/parse/evaluate-labels "$data" "$2" --names "$out/names" --classes "$classes" --quiet --json - |
        awk -v name="$1" '/^ "/ { k = $1; gsub(/[":]/, "", k); if (k == "overall" || k == "class_average") v[k] = $2 + 0 }
            END { printf "%-44s overall %.2f  class average %.2f\n", name, 100 * v["overall"], 100 * v["class_average"] }'
}
learn_from() { # DIR: its label maps as a data set, then a grammar
    mkdir -p "$1.data/labels"
    cp "$1/classes.tsv" "$1.data/classes.tsv"
    while read -r n; do cp "$1/$n.png" "$1.data/labels/$n.png"; done <"$out/names"
    # shellcheck disable=SC2086
    "$build"/learn/learn-grammar "$1.data" --names "$out/names" ${SG_LEARN:-} --quiet -o "$1.sg"
}

score "MAP of the unaries ($set)" "$out/unaries"
from=$out/unaries
for i in $(seq 1 "${ITERATIONS:-3}"); do
    learn_from "$from"
    # shellcheck disable=SC2086
    "$build"/parse/parse-facade "$from.sg" -p "$out/unaries" $photographs ${SG_PARSE:---unary-weight 0.1} ${SG_MOVES:-} --quiet -o "$out/parse$i" >"$out/parse$i.txt"
    score "iteration $i: parsed by a grammar of these maps" "$out/parse$i"
    from=$out/parse$i
done
# shellcheck disable=SC2086
"$build"/learn/learn-grammar "$data" --fold "$fold" --classes "$classes" ${SG_LEARN:-} --quiet -o "$out/true.sg"
# shellcheck disable=SC2086
"$build"/parse/parse-facade "$out/true.sg" -p "$out/unaries" $photographs ${SG_PARSE:---unary-weight 0.1} ${SG_MOVES:-} --quiet -o "$out/true" >"$out/true.txt"
score "for comparison: grammar of true label maps" "$out/true"
