#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Figure 4 of the model-merging paper (Martinovic and Van Gool, CVPR 2013): two streets of buildings sampled from induced grammars.
# (a) a grammar of 30 facades of the ECP set, learned as experiments/ecp_samples.sh has it; (b) one that was merged too far: the
# prior weighs much more, and anything may merge with anything of the same labels. Both get their third dimension from
# data/grammars/street.sg. Written are FOLDER/figure4{a,b}.png, the grammars, and the models as OBJ.
# usage: figure4.sh ECP_DATASET FOLDER    (SG_BUILD_DIR: where the programs are; SG_SEED: of the streets, 3)
set -eu
data=${1:?usage: figure4.sh ECP_DATASET FOLDER}; out=${2:?usage: figure4.sh ECP_DATASET FOLDER}
build=${SG_BUILD_DIR:-build}
grammars=$(cd "$(dirname "${BASH_SOURCE[0]}")/../data/grammars" && pwd)
mkdir -p "$out"

learn() { # NAME OPTION...
    "$build"/learn/learn-grammar "$data" --fold 1 --classes "$data/classes7.tsv" --cells 300 "${@:2}" --quiet -o "$out/$1.sg"
}
street() { # NAME: a street of facades of this grammar
    sed "s|haussmann.sg|$1.sg|; s/^grammar street/grammar \"street $1\"/" "$grammars/street.sg" >"$out/street-$1.sg"
    grep -q '^tied$' "$out/$1.sg" || sed -i '/^tied$/d' "$out/street-$1.sg"
    "$build"/src/sample-grammar "$out/street-$1.sg" -n 1 --name "figure4$1" --formats obj,render --size 1500x500 --view=-22,10 \
        --seed "${SG_SEED:-3}" --quiet -o "$out"
    mv "$out/figure4$1-0001.render.png" "$out/figure4$1.png"
}
learn a --regroup floors --compatible sizes --weight 0.3 --tied
learn b --regroup pairs --compatible labels --weight 30
street a
street b
echo "$out/figure4a.png $out/figure4b.png"
