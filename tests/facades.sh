#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The bundled facades are what their grammar and seed make: the first label maps come out byte for byte, with any number of
# pictures; the set is complete and has no faults; the renderer refuses what it cannot render.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
data=$SG_SOURCE_DIR/data
render=$SG_BUILD_DIR/data/render-facades
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*"; exit 1; }

seed=$(sed -n 's/.*--seed \([0-9]*\).*/\1/p' "$data/make-facades.sh")
"$render" "$data/grammars/haussmann.sg" -o "$work/set" -n 3 --seed "$seed" --quiet || fail "render-facades failed"
cmp "$work/set/classes.tsv" "$data/facades/classes.tsv" || fail "other classes"
for name in facade001 facade002 facade003; do
    cmp "$work/set/labels/$name.png" "$data/facades/labels/$name.png" || fail "$name: another label map"
    cmp -s "$work/set/images/$name.jpg" "$data/facades/images/$name.jpg" ||
        echo "$name: another photograph; another OpenCV may do that"
    [ -s "$work/set/images/$name.jpg" ] || fail "$name: no photograph"
done

[ "$(find "$data/facades/labels" -name '*.png' | wc -l)" = 48 ] || fail "not 48 label maps"
for fold in 1 2 3 4; do
    [ "$(cut -f 2 "$data/facades/folds/$fold.tsv" | sort | uniq -c | tr -s ' \n' ' ')" = " 12 test 30 train 6 valid " ] ||
        fail "fold $fold: not 30 train, 6 valid, 12 test"
done
[ "$(cat "$data"/facades/folds/?.tsv | grep test | cut -f 1 | sort -u | wc -l)" = 48 ] ||
    fail "the folds do not test every facade once"
"$SG_BUILD_DIR/parse/make-lattice" "$data/facades" -o "$work/lattices" --starts 1 --quiet >/dev/null || fail "the set has faults"
[ "$(find "$work/lattices" -name '*.lat' | wc -l)" = 48 ] || fail "not 48 lattices"

printf 'grammar other\nlabel lobby #ffffff\nstart S\nrule S\n  -> split x { lobby | lobby }\n' >"$work/other.sg"
"$render" "$work/other.sg" -o "$work/other" --quiet 2>"$work/message" && fail "a label that cannot be rendered passed"
grep -q "label 'lobby'" "$work/message" || fail "the message does not name the label: $(cat "$work/message")"
[ ! -e "$work/other/images" ] || fail "something was written for a grammar that cannot be rendered"
echo "label maps as committed"
