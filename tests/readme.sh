#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The commands of README's walk-through work as printed, and its small program compiles.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}" "${SG_COMPILE:?}"
command -v dot >/dev/null || { echo "graphviz is not installed"; echo; exit 77; }
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*"; exit 1; }
block() { awk -v lang="$1" '$0 == "```" lang { on = 1; next } $0 == "```" { on = 0 } on' "$SG_SOURCE_DIR/README.md"; }

PATH=$SG_BUILD_DIR/src:$SG_BUILD_DIR/parse:$SG_BUILD_DIR/learn:$SG_BUILD_DIR/data:$PATH
export PATH
ln -s "$SG_SOURCE_DIR/data" "$work/data"
block sh >"$work/commands"
[ "$(grep -cE '^[a-z]+-[a-z]+ ' "$work/commands")" -ge 7 ] || fail "README's commands were not found"
(cd "$work" && bash -e -o pipefail commands) >"$work/log" 2>&1 || { cat "$work/log"; fail "a command failed"; }
for file in lattices/facade020.lat facades.sg canonical.sg report/index.html facades.svg samples/sheet.png \
    facades.rf parsed/facade001.overlay.png oaks/sheet.png oaks/young_oak-0004.glb plane/airplane-0001.render.png \
    city/city-0020.obj mondrian/mondrian-0001.tree.svg spaceship.svg; do
    [ -s "$work/out/$file" ] || fail "out/$file was not made"
done

block c >"$work/rules.c"
cp "$work/out/facades.sg" "$work/"
# shellcheck disable=SC2086
(cd "$SG_BUILD_DIR" && $SG_COMPILE -c "$work/rules.c" -o "$work/rules.o") || fail "the small program does not compile"
echo "$(grep -cE '^[a-z]+-[a-z]+ ' "$work/commands") commands work"
