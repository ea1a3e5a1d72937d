#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The demonstration's page: every picture and link that it names is there, no number is missing, all paths are relative.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
command -v dot >/dev/null || { echo "graphviz is not installed"; echo; exit 77; }
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*"; exit 1; }

. "$SG_SOURCE_DIR/scripts/setup.sh"
. "$SG_SOURCE_DIR/scripts/demo-steps.sh"
(set -e; make_demo "$SG_BUILD_DIR" "$work/demo" 1) || fail "the demonstration failed"
page=$work/demo/index.html
count=0
while IFS= read -r link; do
    case $link in /* | *:*) fail "$link is not relative" ;; esac
    [ -s "$work/demo/$link" ] || fail "$link is not there"
    count=$((count + 1))
done < <(grep -oE '(src|href)="[^"]+"' "$page" | cut -d '"' -f 2)
[ "$count" -ge 80 ] || fail "only $count pictures and links"
# a part that is left out would leave no broken link
for part in report/grammar.svg samples/ rendered/ street/street-0001.render.png street/street-0001.glb .overlay.png .uncertainty.png; do
    grep -qF "$part\"" "$page" || grep -qF "\"$part" "$page" || fail "the page does not show $part"
done
if grep -E '<td></td>|here  merges| in  s' "$page"; then fail "a number is missing"; fi

# What is not a demonstration is left alone; an older one is replaced.
mkdir "$work/mine" && echo dear >"$work/mine/letter"
(empty_folder "$work/mine") 2>/dev/null && fail "a folder of something else was emptied"
[ -f "$work/mine/letter" ] || fail "the letter is gone"
(empty_folder "$work/demo") || fail "an older demonstration was not replaced"
[ ! -e "$page" ] || fail "the older page is still there"
echo "$count pictures and links"
