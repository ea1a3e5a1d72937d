#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Sizes of models and grammars beside published ones: table I of Talton et al., "Metropolis procedural modeling" (TOG 30(2), 2011),
# and the grammars of Dang et al., "Interactive design of probability density functions for shape grammars" (TOG 34(6), 2015).
# usage: table_models.sh [FOLDER]    of the grammars (default data/grammars beside this script's folder)
# SG_BUILD_DIR: where the programs are (default build); SG_SAMPLES: models of each grammar (default 20)
set -eu
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
grammars=${1:-$here/data/grammars}
build=${SG_BUILD_DIR:-build}
samples=${SG_SAMPLES:-20}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT

# summary COLUMN: mean and range of a column of the table in $work/table
summary() {
    awk -F'\t' -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i }
        $1 == "mean" { mean = $c } $1 == "min" { low = $c } $1 == "max" { high = $c }
        END { printf "%.0f (%d-%d)", mean, low, high }' "$work/table"
}

echo "Models of the prior: mean (range) of $samples samples, beside the one model that table I tells of. Symbols are non-terminals"
echo "and terminals; parameters the numbers that these carry, and draws. Published models were made for a target."
echo
printf '%-12s %26s %9s %26s %9s %26s %9s %14s %9s\n' model symbols published parameters published "draws alone" "" depth published
while read -r name symbols parameters depth; do
    file=$grammars/$name.sg
    if [ ! -e "$file" ]; then
        printf '%-12s %26s %9s %26s %9s %26s %9s %14s %9s\n' "$name" "(no grammar)" "$symbols" "" "$parameters" "" "" "" "$depth"
        continue
    fi
    if ! "$build"/src/sample-grammar "$file" -n "$samples" --table "$work/table" --quiet 2>"$work/err"; then
        printf '%-12s failed: %s\n' "$name" "$(head -n 1 "$work/err")"
        continue
    fi
    printf '%-12s %26s %9s %26s %9s %26s %9s %14s %9s\n' "$name" "$(summary symbols)" "$symbols" "$(summary parameters)" \
        "$parameters" "$(summary draws)" "" "$(summary depth)" "$depth"
done <<'END'
young-oak 12152 18937 15
old-oak 53624 71738 30
acacia 21176 29909 29
willow 70754 164823 34
conifer 31319 35639 27
poplar 11019 12836 32
building 9673 16805 28
city 850 1154 120
mondrian 74 134 21
END

echo
echo "Grammars: draws of the rules (published: parameters), symbols (labels included), rules as they are written."
echo
printf '%-12s %9s %9s %9s %9s %9s %9s\n' grammar draws published symbols published rules published
while read -r name title parameters symbols rules; do
    file=$grammars/$name.sg
    if [ ! -e "$file" ]; then
        printf '%-12s %9s %9s %9s %9s %9s %9s  (no grammar)\n' "$title" "" "$parameters" "" "$symbols" "" "$rules"
        continue
    fi
    if ! "$build"/src/print-grammar --counts "$file" >"$work/counts" 2>"$work/err"; then
        printf '%-12s failed: %s\n' "$title" "$(head -n 1 "$work/err")"
        continue
    fi
    count() { awk -F'\t' -v name="$1" '$1 == name { print $2 }' "$work/counts"; }
    printf '%-12s %9s %9s %9s %9s %9s %9s\n' "$title" "$(count draws)" "$parameters" "$(count symbols)" "$symbols" "$(count rules)" "$rules"
done <<'END'
furniture furniture 50 38 75
low-rise low-rise 26 80 122
skyscraper skyscraper 39 27 61
airplane airplane 8 44 26
END
