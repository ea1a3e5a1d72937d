# SPDX-License-Identifier: GPL-3.0-or-later
# demo-steps.sh - what the demonstration does once the programs are built. To be sourced, after setup.sh.

# An older demonstration may go; anything else in the folder is not ours to remove.
empty_folder() { # FOLDER
    if [ -d "$1" ] && [ -n "$(ls -A "$1")" ]; then
        [ -f "$1/.shapegram-demo" ] || die "$1 is not empty and holds no demonstration of ours; choose another --output"
        rm -rf "$1"
    fi
    mkdir -p "$1"
    : >"$1/.shapegram-demo"
}

make_demo() { # BUILD-FOLDER FOLDER SEED
    local build=$1 out=$2 seed=$3 top data log
    top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
    data=$top/data/facades
    log=$out/log
    empty_folder "$out"
    mkdir -p "$out/training" "$log"
    run_step "fitting lattices to 30 facades" "$log/lattices.txt" \
        "$build"/parse/make-lattice "$data" --fold 1 -o "$out/lattices" --pictures
    run_step "learning a grammar" "$log/learning.txt" \
        "$build"/learn/learn-grammar "$data" --fold 1 --weight 0.3 --compatible sizes --tied --seed "$seed" \
        -o "$out/grammar.sg" --initial "$out/initial.sg" --json "$out/learning.json" \
        --report "$out/report"
    run_step "drawing it" "$log/drawing.txt" sh -c \
        '"$1"/src/print-grammar --dot "$2/grammar.sg" | dot -Tsvg -o "$2/graph.svg"' sh "$build" "$out"
    run_step "sampling 28 new facades" "$log/samples.txt" \
        "$build"/src/sample-grammar "$out/grammar.sg" -n 28 -o "$out/samples" --seed "$seed" --size 200x280 --name facade \
        --formats rgb,labels,json,svg
    run_step "rendering 14 more as photographs" "$log/rendered.txt" \
        "$build"/data/render-facades "$out/grammar.sg" -n 14 -o "$out/rendered" --seed "$seed" --quiet
    mkdir "$out/street"
    sed 's|haussmann.sg|../grammar.sg|' "$top/data/grammars/street.sg" >"$out/street/street.sg"
    run_step "building a street of new facades" "$log/street.txt" \
        "$build"/src/sample-grammar "$out/street/street.sg" -n 1 --name street --formats obj,gltf,render --size 1100x420 --view=-22,10 \
        --seed "$seed" --quiet -o "$out/street"
    mapfile -t held_out < <(awk -F'\t' -v folder="$data/images/" '$2 == "test" { print folder $1 ".jpg" }' "$data/folds/1.tsv" | head -n 6)
    run_step "training a pixel classifier on the 30 photographs" "$log/unaries.txt" \
        "$build"/parse/learn-unaries "$data" --fold 1 --trees 12 --depth 16 --pixels 60000 --seed "$seed" --quiet \
        -o "$out/unaries.rf" --json "$out/unaries.json"
    run_step "classifying the pixels of ${#held_out[@]} photographs not learned from" "$log/classified.txt" \
        "$build"/parse/apply-unaries "$out/unaries.rf" "${held_out[@]}" --quiet -o "$out/unaries"
    run_step "parsing them with the grammar" "$log/parsed.txt" \
        "$build"/parse/parse-facade "$out/grammar.sg" -p "$out/unaries" "${held_out[@]}" --truth "$data" --runs 2 --iterations 50000 --seed "$seed" \
        --quiet --json "$out/parsed.json" -o "$out/parsed"
    run_step "writing the page" "$log/page.txt" "$top"/scripts/demo-page.sh "$data" "$out"
}
