#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# How fast forests judge photographs, beside OpenCV's own prediction: the goal is 500 000 pixels a second on two cores with 20
# trees of depth 20, features of the patch set included.
# Usage: bench_forest.sh [DATASET [CLASSES]]   (default: the ECP facades in $SG_SHARED_DIR/data, seven classes)
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
build=${SG_BUILD_DIR:-$here/build}
shared=${SG_SHARED_DIR:-$here/../shared}
dataset=${1:-$shared/data/ecp}
classes=${2:-$dataset/classes7.tsv}
[ -e "$classes" ] || classes=$dataset/classes.tsv
[ -d "$dataset/labels" ] || { echo "no data set in $dataset" >&2; exit 77; }
run() { echo "== $*"; "$build/experiments/bench_forest" "$dataset" --classes "$classes" "$@"; }
run --features patch --trees 10 --depth 15
run --features patch --trees 20 --depth 20
run --features rich --trees 20 --depth 20
