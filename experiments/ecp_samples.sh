#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A sheet of facades sampled from a grammar that was induced from 30 real ones (ECP, fold 1): docs/pictures/ecp-samples.png.
# Lattices of 300 cells leave the thin strips out that would have to be aligned by chance; bands and columns merge with those of
# about their size only; the weight of the prior is the paper's (a larger one mixes more storeys); and what a facade repeats it
# repeats exactly (tied siblings).
# usage: ecp_samples.sh ECP_DATASET SHEET.png    (SG_BUILD_DIR: where the programs are)
set -eu
data=${1:?usage: ecp_samples.sh ECP_DATASET SHEET.png}; sheet=${2:?usage: ecp_samples.sh ECP_DATASET SHEET.png}
build=${SG_BUILD_DIR:-build}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
"$build"/learn/learn-grammar "$data" --fold 1 --classes "$data/classes7.tsv" --cells 300 --regroup floors --compatible sizes \
    --weight 0.3 --tied --quiet -o "$work/ecp.sg"
"$build"/src/sample-grammar "$work/ecp.sg" -n 20 -o "$work/samples" --sheet 10x2 --size 120x160 --quiet
cp "$work/samples/sheet.png" "$sheet"
