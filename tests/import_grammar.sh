#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Grammars that import others: names, labels that become symbols, where errors are said to be.
# shellcheck disable=SC2154 # work is shell_support.sh's
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
PATH=$SG_BUILD_DIR/src:$PATH
mkdir sub sub/meshes

cat >street.sg <<'END'
grammar street
const n = 3
import Facade "sub/facade.sg"
start Street(n)
rule Street(k) if k > 0 -> split x { 10: Facade(2) | ~1: Street(k - 1) }
rule Street(k) if k <= 0 -> nothing
rule window -> split x { 0.1: frame | ~1: glass | 0.1: frame }
label frame #804000
label wall #123456
label glass
END
# h is a constant, hidden by a parameter and by a draw
cat >sub/facade.sg <<'END'
const h = 2.5
function twice(x) = 2 * x * h
label window #ff0000
label wall #ffff00
label door
start S(1)
rule S(k) -> split y { twice(1): Floor(h) | h: Ground | ~k: wall }
rule Floor(h) -> split x { wall | h: window | wall }
rule Ground -> turn(h) h ~ uniform(0, h) split x { h: door | wall }
END
cat >flat.sg <<'END'
grammar street
const n = 3
const "Facade.h" = 2.5
function "Facade.twice"(x) = 2 * x * "Facade.h"
label frame #804000
label wall #123456
label glass
label door
start Street(n)
rule Street(k) if k > 0
  -> split x { 10 : Facade(2) | ~1 : Street(k - 1) }
rule Street(k) if k <= 0
  -> nothing
rule window
  -> split x { 0.1 : frame | ~1 : glass | 0.1 : frame }
rule Facade(k)
  -> split y { "Facade.twice"(1) : "Facade.Floor"("Facade.h") | "Facade.h" : "Facade.Ground" | ~k : wall }
rule "Facade.Floor"(h)
  -> split x { wall | h : window | wall }
rule "Facade.Ground"
  -> turn("Facade.h") h ~ uniform(0, "Facade.h") split x { h : door | wall }
END
expect 0 print-grammar street.sg
same out flat.sg
expect 0 print-grammar flat.sg
same out flat.sg
# from another folder, and by an absolute path
(cd sub && print-grammar ../street.sg) | cmp -s - flat.sg || fail 'read from another folder it differs'
sed "s|sub/|$work/sub/|" street.sg >absolute.sg
print-grammar absolute.sg | sed 's/^grammar .*/grammar street/' | cmp -s - flat.sg || fail 'with an absolute path it differs'

# imports of imports, each from its own folder; meshes are seen from the outermost one
printf 'start A\nrule A -> size(1, 1, 1) insert("meshes/a.obj") insert(box)\n' >sub/inner.sg
printf 'import Inner "inner.sg"\nstart B\nrule B -> Inner Inner\n' >sub/outer.sg
printf 'import Outer "sub/outer.sg"\nstart C\nrule C -> Outer\n' >nested.sg
expect 0 print-grammar nested.sg
says out 'rule "Outer.Inner"'
says out 'insert("sub/meshes/a.obj") insert(box)'

# errors point into the file that they are in
broken() { # TEXT IN ITS PLACE: in the imported file
    sed "s/$1/$2/" sub/facade.sg >sub/broken.sg
    sed 's/facade.sg/broken.sg/' street.sg >broken.sg
    expect 3 print-grammar broken.sg
}
broken '^const h = 2.5' 'const h = 2.5 +'
says err '^print-grammar: sub/broken.sg:2:1: error: found .function.; expected an expression$'
broken 'twice(1)' 'trice(1)'
says err "^print-grammar: sub/broken.sg:7:24: error: unknown function or distribution 'trice'"
says err '^rule S(k) -> split y { trice(1): Floor(h)'
broken '^label door' "$(printf '\\x01')"
says err 'sub/broken.sg:5:1: error: control character'
broken '^start.*' ''
says err 'broken.sg:3:15: error: a grammar without a start symbol'
broken '^start.*' 'start door'
says err 'broken.sg:3:15: error: a grammar without a start symbol'
broken '^label door' 'label door tied'
says err 'broken.sg:3:15: error: this grammar is tied and the one that imports it is not'
broken '^label door' 'label door weights'
says err 'must say .weights.'
broken '^label door' 'label door limit depth 9'
says err 'broken.sg:3:15: error: this grammar has a depth limit'
# an error behind the imports is one of the importing file still
sed 's/Facade(2)/Facade/' street.sg >bad.sg
expect 3 print-grammar bad.sg
says err '^print-grammar: bad.sg:5:42: error: Facade takes 1 argument, not 0'

# so do warnings, and what a run fails on
cat >sub/odd.sg <<'END'
material oak #8b5a2b
material pine #c0a060
start A(1)
rule A(x) if x > 0
  -> u ~ normal(x, 0.1) set_material(oak) insert(box) set_material(pine) insert(box) B(1, u)
rule B(n, u) if n < 3000 -> B(n + 1, u)
rule B(n, u) if n >= 3000
  -> draw(normal(0, u - 9))
rule B(n, u) if n < 0 -> nothing
END
printf 'material pine #123456\nimport A "sub/odd.sg"\nstart A(1)\n' >odd.sg
expect 0 print-grammar odd.sg
says err '^print-grammar: sub/odd.sg:9:17: warning: this guard never holds, as n is from 1 to 3001$'
says out '^material oak #8b5a2b$'
says out '^material pine #123456$'
[ "$(grep -c '^material' out)" = 2 ] || fail 'a material is declared twice'
expect 1 sample-grammar odd.sg -o odd --formats obj
says err 'sub/odd.sg:8: error: deriving A(1) > A.B(1, .*) > .* more) > .*: draw: the standard deviation must be greater than 0'

refuse() { # TEXT SENTENCE
    printf '%s' "$1" >bad.sg
    expect 3 print-grammar bad.sg
    says err "$2"
}
refuse 'import A "none.sg" start A' 'bad.sg:1:10: error: none.sg: No such file'
refuse 'import A "sub" start A' 'bad.sg:1:10: error: sub: Is a directory'
refuse 'import A "bad.sg" start A' 'bad.sg:1:8: error: imports more than 16 deep'
refuse 'import A "-" start A' 'standard input cannot be imported'
refuse 'import A start A' "found .start.; expected a name"
refuse 'import A "sub/inner.sg" rule A -> nothing start A' "bad.sg:1:8: error: 'A' is defined here as well"
refuse 'import A "sub/inner.sg" import A "sub/inner.sg" start A' "bad.sg:1:32: error: 'A' is defined here as well"
refuse 'import A "sub/inner.sg" label A start A' "'A' is defined here as well"
printf '{"format":"shapegram-grammar","version":1}' >sub/e.json
refuse 'import A "sub/e.json" start A' 'sub/e.json:1:1: error: '

# What is imported is read, and no output.
cp sub/facade.sg facade.kept
expect 2 print-grammar street.sg -o sub/facade.sg
says err 'sub/facade.sg: this is read'
expect 2 sample-grammar street.sg --table sub/facade.sg
says err 'sub/facade.sg: this is a grammar that is read'
expect 2 sample-grammar street.sg --stats --json ./sub/../sub/facade.sg
same sub/facade.sg facade.kept
# many imports by a large file: what is read is kept once. A sanitizer's own memory is larger than any bound.
printf 'start A\nrule A -> nothing\n' >small.sg
{ printf '#'; head -c 4000000 /dev/zero | tr '\0' x; echo
  for i in $(seq 300); do echo "import A$i \"small.sg\""; done
  echo 'start S rule S ->'; for i in $(seq 300); do echo " A$i"; done; } >many.sg
if (ulimit -v 400000 && print-grammar --version) >out 2>&1; then
    (ulimit -v 400000 && exec print-grammar many.sg) >out 2>err || fail 'many imports take too much memory'
else
    expect 0 print-grammar many.sg
fi
[ $failures -eq 0 ] || exit 1
echo "imports are read"
