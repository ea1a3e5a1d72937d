#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every example grammar is in the gallery as its script makes it, has a picture that can be read, and is installed; and nothing
# else is. The sizes in the gallery are left out: the last digits of drawn numbers, and with them a choice, may depend on the
# mathematical library.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
grammars=$SG_SOURCE_DIR/data/grammars
pictures=$SG_SOURCE_DIR/docs/pictures/grammars
gallery=$SG_SOURCE_DIR/docs/grammars.md
script=$SG_SOURCE_DIR/experiments/thumbnails.sh

# The names of files, and of what is listed, one a line and sorted.
files() { find "$1" -maxdepth 1 -name "*.$2" -exec basename {} ".$2" \; | sort; }
found() { grep -oE "$2" "$1" | sed 's,.*/,,; s/\.[a-z]*$//' | sort; }
files "$grammars" sg >names
[ "$(wc -l <names)" -ge 12 ] || fail 'where are the grammars?'
files "$pictures" png >pictures
found "$SG_SOURCE_DIR/data/Makefile.inc" '%D%/grammars/[^ ]*\.sg' >installed
found "$gallery" '\(pictures/grammars/[^)]*\.png' >shown
for list in pictures installed shown; do
    diff names $list >out || fail "grammars, and what is $list"
done

while read -r name; do
    expect 0 "$SG_BUILD_DIR/tests/check_png" "$pictures/$name.png"
    says out '^240x240 '
    [ "$(wc -c <"$pictures/$name.png")" -lt 40960 ] || fail "$name.png is over 40 KB: was it made without pngquant?"
done <names

# What it says is what the script makes of the grammars of today: each of them can be sampled, too.
SG_SAMPLES=1 expect 0 "$script" --gallery
grep '^| !' out | cut -d '|' -f 1-4 >made
grep '^| !' "$gallery" | cut -d '|' -f 1-4 >kept
diff made kept >out || fail 'experiments/thumbnails.sh makes another gallery'
[ "$(grep -cE '(\| [0-9]+( \([0-9]+-[0-9]+\))? ){3}\|$' "$gallery")" = "$(wc -l <names)" ] || fail 'sizes are missing'

# The script: a picture of labels and one in space; an unknown grammar.
mkdir -p copy/experiments copy/data/grammars copy/docs
cp "$script" copy/experiments
cp "$grammars"/{mondrian,ga-city}.sg copy/data/grammars
SG_SAMPLES=1 expect 0 copy/experiments/thumbnails.sh
says copy/docs/grammars.md 'ga-city.png'
expect 0 "$SG_BUILD_DIR/tests/check_png" copy/docs/pictures/grammars/{mondrian,ga-city}.png
expect 3 copy/experiments/thumbnails.sh none
says err 'none.sg'

[ $failures -eq 0 ] && echo "$(wc -l <names) grammars"
exit $((failures > 0))
