#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A larger weight of the prior gives a shorter description (docs/errata.md, 7). The minima obey this always; the greedy search
# does on the bundled facades.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*"; exit 1; }

for term in marginal viterbi; do
    for fold in 1 2; do
        lengths=
        for weight in 0.1 0.3 1; do
            "$SG_BUILD_DIR/learn/learn-grammar" "$SG_SOURCE_DIR/data/facades" --fold "$fold" --weight "$weight" --quiet \
                --data-term "$term" -o "$work/g.sg" --json "$work/g.json" 2>"$work/message" || fail "$(cat "$work/message")"
            lengths="$lengths $(awk '$1 == "\"log_structure_prior\":" { print -$2; exit }' "$work/g.json")"
        done
        echo "$term, fold $fold: description lengths$lengths"
        awk '{ exit !(NF == 3 && $1 > $2 && $2 > $3 && $3 > 0) }' <<<"$lengths" || fail "they do not fall"
    done
done
