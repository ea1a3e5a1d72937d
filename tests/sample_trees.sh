#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sample-grammar: drawn derivations, draws that are given, statistics.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
sample=$SG_BUILD_DIR/src/sample-grammar
cat >plant.sg <<'END'
grammar plant
limit depth 6
start Trunk(4)
rule Trunk(l)
  -> 0.6 : f ~ uniform(0.5, 0.9) draw(l) [ turn(normal(30, 8)) Trunk(l * f) ] [ turn(-30) Trunk(l * f) ]
  -> 0.4 : k ~ discrete((1, 2), (1, 5)) repeat y k { draw(0.1) } maybe(0.6) Leaf
rule Trunk(l) at limit -> Leaf
rule Leaf -> insert(sphere)
END

# Drawn trees: the same bytes for any number of threads; SVG that a reader of XML takes.
expect 0 "$sample" plant.sg -n 3 --tree -o a --threads 1
expect 0 "$sample" plant.sg -n 3 --tree -o b --threads 2
diff -r a b >/dev/null || fail "two threads draw other trees"
[ "$(find a -type f | wc -l)" = 6 ] || fail "other files than expected: $(ls -A a)"
[ "$(head -c 8 a/plant-0001.tree.png | tail -c 7 | head -c 3)" = PNG ] || fail "no PNG"
if command -v xmllint >/dev/null; then expect 0 xmllint --noout a/plant-0001.tree.svg; fi
says a/plant-0001.tree.svg '>Trunk(4)</text>'
says a/plant-0001.tree.svg '>p = 0\.[46]</text>'
expect 0 "$sample" plant.sg --given Trunk#1=1 --tree --tree-nodes 8 -o c
says c/plant-0001.tree.svg '>… [0-9]* nodes\?</text>'
expect 0 "$sample" plant.sg --given Trunk#1=1 --formats derivation --tree --tree-depth 0 -o d
[ -s d/plant-0001.sgd ] || fail "--tree replaces --formats"
[ "$(grep -c '<rect x' d/plant-0001.tree.svg)" = 1 ] || fail "depth 0 is more than the root"
expect 0 "$sample" "$SG_SOURCE_DIR/data/grammars/haussmann.sg" --formats tree -o e
says e/haussmann-0001.tree.svg '>House</text>'
for bad in "--tree-nodes 0" "--tree-nodes x" "--tree-depth -1"; do
    # shellcheck disable=SC2086
    expect 2 "$sample" plant.sg --tree -o f $bad
done
expect 2 "$sample" plant.sg --tree

# Given draws: in the derivation, kept when it is read again; the rest as it would be.
expect 0 "$sample" plant.sg -n 5 --given Trunk#1=1 --given 'Trunk#1.f=0.75' --given 'Trunk > Trunk=2' --given 'Trunk:2.k=5' \
    --formats derivation,tree -o g --json g.json
for i in 1 2 3 4 5; do
    says g/plant-000$i.tree.svg '>f = 0.75</text>'
    [ "$(grep -c '>Trunk(3)</text>' g/plant-000$i.tree.svg)" = 2 ] && [ "$(grep -c '>k = 5</text>' g/plant-000$i.tree.svg)" = 2 ] ||
        fail "sample $i is not as given"
    says g.json '"log_given": -'
    expect 0 "$sample" plant.sg --from g/plant-000$i.sgd --formats derivation -o h --name again
    same h/again-0001.sgd g/plant-000$i.sgd
done
expect 0 "$sample" plant.sg --given 'Trunk > (8 more) > Trunk.f=0.6' --given Trunk#1=1 --stats
says err 'warning: --given Trunk > (8 more) > Trunk.f=0.6: no sample has such a node'
[ "$(grep -c warning err)" = 1 ] || fail "warnings of pins that are used"
refused() { # STATUS PIN SENTENCE
    expect "$1" "$sample" plant.sg --given "$2" --given Trunk#1=1 --stats
    says err "$3"
}
refused 2 Trunk.g=1 "--given 'Trunk.g=1': Trunk has no draw 'g' of 1 value; its draws are: f in rule 1, 2 in rule 1, k in rule 2"
refused 2 Tree.f=1 'the symbols are: Trunk, Leaf, maybe(0.6) Leaf'
refused 2 Trunk.f 'is missing'
refused 2 Trunk=3 'Trunk has 2 rules, not 3'
refused 1 Trunk.f=0.4 'sample 1: plant.sg:5: error: deriving Trunk(4): given Trunk.f=0.4: 0.4 is outside of the support of this uniform: from 0.5 to 0.9'
expect 1 "$sample" plant.sg --given 'Trunk=2' --given 'Trunk.k=3' --stats
says err '3 is outside of the support of this discrete: 2, 5'
expect 2 "$sample" plant.sg --from g/plant-0001.sgd --given Trunk=1 -o f
[ ! -e f ] || fail "wrong usage leaves a folder"

# Statistics.
expect 0 "$sample" plant.sg -n 4 --table t.tsv --json t.json --threads 2
expect 0 "$sample" plant.sg -n 4 --table - --threads 1
same out t.tsv
[ "$(head -n 1 out | cut -f 1-4)" = "$(printf 'name\tsymbols\tparameters\tdepth')" ] && [ "$(wc -l <out)" = 8 ] ||
    fail "another table"
awk -F'\t' 'NR == 1 { n = NF } NF != n { exit 1 }
    NR > 1 && NR < 6 { s += $2; if (NR == 2 || $2 < low) low = $2; if ($2 > high) high = $2; if ($2 != $5 + $6 || $3 != $7 + $8 + $9) exit 1 }
    $1 == "mean" && $2 != s / 4 { exit 1 } $1 == "min" && $2 != low { exit 1 } $1 == "max" && $2 != high { exit 1 }' out ||
    fail "the table does not add up"
says t.json '"summary"'
[ "$(grep -c '"terminal_arguments"' t.json)" = 5 ] || fail "the report has not the statistics of each sample and their summary"
[ "$(find . -name '*.png' -newer t.tsv)" = "" ] || fail "statistics write pictures"
expect 0 "$sample" plant.sg -n 2 --stats --formats obj -o o
[ "$(awk '$1 == "plant-0001" { print $(NF - 2) }' out)" = "$(grep -c '^f ' o/plant-0001.obj)" ] || fail "faces are not those of the mesh"
[ "$(awk '$1 == "plant-0001" { print $(NF - 3) }' out)" = "$(grep -c '^v ' o/plant-0001.obj)" ] || fail "nor vertices"
expect 2 "$sample" plant.sg --table x --json x
expect 2 "$sample" plant.sg --stats --json -
expect 2 "$sample" plant.sg --stats --formats obj
expect 4 "$sample" plant.sg --table /dev/full
cp plant.sg keep.sg
expect 2 "$sample" keep.sg --table keep.sg
same plant.sg keep.sg

[ $failures -eq 0 ] || exit 1
echo "drawn trees, given draws, statistics: all well"
