#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Table 2 of the model-merging paper (Martinovic and Van Gool, CVPR 2013): photographs of the ECP facades, parsed. Five folds: a
# pixel classifier and a grammar are learned from the training part, the test part is labelled and parsed.
# usage: table2.sh ECP_DATASET FOLDER    (SG_BUILD_DIR: where the programs are; FOLDS="1 2": some folds only; ROWS: some rows)
# Resumable: what is in FOLDER is not made again, photograph by photograph. SG_MOVES="--iterations 1000" for a quick look.
set -eu
data=${1:?usage: table2.sh ECP_DATASET FOLDER}
out=${2:?usage: table2.sh ECP_DATASET FOLDER}
build=${SG_BUILD_DIR:-build}
classes=$data/classes7.tsv
grammars=$(cd "$(dirname "${BASH_SOURCE[0]}")/../data/grammars" && pwd)
folds=${FOLDS:-1 2 3 4 5}
moves=${SG_MOVES:-}

# One setting a row, chosen on the validation part of fold 1. The unaries: the rich forest, and a patch forest cut down to about
# the published one. Weak and hard unaries say too much too often: they weigh less, and storeys are tied.
forest_rich="--features rich"
forest_patch="--features patch --balanced --trees 4 --depth 8"
learn_rich="--max-images 0"
learn_patch="--max-images 0 --tied --compatible sizes --regroup floors"
parse_rich="--unary-weight 0.1"
parse_patch="--hard 0.994 --unary-weight 0.01"
# of the rows by mcmc; the weak unaries gain hardly anything from more runs
search_rich="--start exact"
search_patch="--runs 2"
# row, unaries, grammar (learned, or a file of data/grammars), method
rows=${ROWS:-"rich-learned rich-written rich-exact patch-learned patch-written patch-exact"}
written=ecp.sg

test_names() { awk -F'\t' '$2 == "test" { print $1 }' "$data/folds/$1.tsv"; }
photograph() { for e in jpg jpeg png; do [ ! -e "$data/images/$1.$e" ] || { echo "$data/images/$1.$e"; return; }; done; }
option() { local v=$1_$2; echo "${!v}"; }
# What is made goes beside its place and is renamed, so that an interrupted run leaves nothing half.
note() { echo "$(date +%T) $*" >&2; }

# missing FOLDER FOLD: photographs whose label map is not there
missing() { for n in $(test_names "$2"); do [ -s "$1/$n.png" ] || photograph "$n"; done; }

prepare() { # FOLD SET
    local dir=$out/fold$1 todo
    mkdir -p "$dir/$2"
    # shellcheck disable=SC2046
    [ -s "$dir/$2.rf" ] || { note "fold $1: learning $2 unaries"
        "$build"/parse/learn-unaries "$data" --fold "$1" --classes "$classes" $(option forest "$2") --quiet \
            --json "$dir/$2.rf.json" -o "$dir/$2.rf"; }
    todo=$(missing "$dir/$2" "$1")
    # shellcheck disable=SC2086
    [ -z "$todo" ] || { note "fold $1: applying them"; "$build"/parse/apply-unaries "$dir/$2.rf" $todo --quiet -o "$dir/$2"; }
    # shellcheck disable=SC2046
    [ -s "$dir/$2.sg" ] || "$build"/learn/learn-grammar "$data" --fold "$1" --classes "$classes" $(option learn "$2") --quiet \
        --json "$dir/$2.sg.json" -o "$dir/$2.sg"
}

parse_row() { # FOLD ROW
    local dir=$out/fold$1 row=$2 set=${2%%-*} kind=${2##*-} grammar todo method
    grammar=$dir/$set.sg; method="--method mcmc $(option search "$set")"
    [ "$kind" != written ] || grammar=$grammars/$written
    [ "$kind" != exact ] || method="--method exact"
    mkdir -p "$dir/$row"
    todo=$(missing "$dir/$row" "$1")
    [ -n "$todo" ] || return 0
    note "fold $1: $row"
    # shellcheck disable=SC2046,SC2086
    "$build"/parse/parse-facade "$grammar" -p "$dir/$set" $todo $(option parse "$set") $method $moves --quiet \
        --truth "$data" --classes "$classes" --json "$dir/$row.$(date +%s).json" -o "$dir/$row"
}

for k in $folds; do
    mkdir -p "$out/fold$k"
    for set in rich patch; do prepare "$k" "$set"; done
    for row in $rows; do parse_row "$k" "$row"; done
done

# ---- the table ----
line() { printf '%-34s' "$1"; shift; printf '%9s' "$@"; echo; }
fields() { # FILE OBJECT: class recalls, class average and overall of an object of the result, in per cent
    awk -v o="\"$2\":" '
        /^ "/ { inside = $1 == o } o == "\"pooled\":" && /^ [^ ]/ { inside = 1 }
        { key = $1; gsub(/[":]/, "", key); v = $2; sub(/,$/, "", v) }
        inside && key ~ /^(window|wall|balcony|door|roof|sky|shop|class_average|overall)$/ && !(key in got) { got[key] = v }
        END { n = split("window wall balcony door roof sky shop class_average overall", k, " ")
              for (i = 1; i <= n; i++) printf "%.1f ", 100 * got[k[i]]; print "" }' "$1"
}
# shellcheck disable=SC2046,SC2086
measured() { # NAME DIR
    local f=$out/$2.json list; list=$(for k in $folds; do echo "--fold $k"; done)
    "$build"/parse/evaluate-labels "$data" "$out/fold%d/$2" $list --classes "$classes" --quiet --json "$f" >"$out/$2.txt" ||
        { line "$1" "(not measured)"; return; }
    line "$1, pooled" $(fields "$f" pooled)
    line "   mean of folds" $(fields "$f" fold_mean)
    line "   published convention" $(fields "$f" published)
}
echo "settings: unaries rich ($forest_rich), patch ($forest_patch); grammars rich ($learn_rich), patch ($learn_patch);"
echo "          parses rich ($parse_rich $search_rich $moves), patch ($parse_patch $search_patch $moves); folds $folds"
line "per cent of pixels" window wall balcony door roof sky shop average overall
line "published: forest MAP" 29 58 35 79 51 73 20 49.3 48.55
line "published: written grammar" 62 82 58 47 66 95 88 71.1 74.71
line "published: model merging" 66 80 49 50 71 91 81 69.7 74.82
for set in rich patch; do
    measured "$set: MAP" "$set"
    for row in $rows; do
        case $row in
            "$set"-learned) measured "$set: learned grammar, mcmc" "$row" ;;
            "$set"-written) measured "$set: written grammar, mcmc" "$row" ;;
            "$set"-exact) measured "$set: learned grammar, exact" "$row" ;;
        esac
    done
done
