#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What pictures of models cost: processor seconds of sample-grammar for one of 600 by 600 pixels on one thread, and for the model
# alone (derivation and mesh), whose difference is the renderer's; least of three runs.
# usage: render_times.sh [GRAMMAR...]    (names in data/grammars; SG_BUILD_DIR: where the programs are)
set -eu
grammars=$(cd "$(dirname "${BASH_SOURCE[0]}")/../data/grammars" && pwd)
sample=${SG_BUILD_DIR:-build}/src/sample-grammar
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
[ $# -gt 0 ] || set -- toy low-rise skyscraper city weber-penn old-oak
TIMEFORMAT=%U

seconds() { # NAME FORMAT
    for _ in 1 2 3; do
        { time "$sample" "$grammars/$1.sg" -n 1 --seed 4 --threads 1 --formats "$2" --quiet --name m -o "$work"; } 2>&1
    done | sort -n | head -n 1
}
printf '%-12s %9s %12s %12s\n' grammar faces 'model (s)' 'picture (s)'
for name; do
    model=$(seconds "$name" obj)
    faces=$(grep -c '^f ' "$work/m-0001.obj")
    printf '%-12s %9d %12s %12s\n' "$name" "$faces" "$model" "$(seconds "$name" render)"
done
