#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Every installed program has a manual page; its long options are those of --help, both ways; mandoc finds no fault in it.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}" "${SG_PROGRAMS?}"
bad=0
fault() { printf '%s\n' "$*"; bad=1; }

options_of_help() { "$SG_BUILD_DIR/$1" --help | grep -oE -- '--[a-z][a-z-]*' | sort -u; }
options_of_page() { grep -oE 'Fl -[a-z][a-z-]*' "$1" | sed 's/^Fl -/--/' | sort -u; }

for program in $SG_PROGRAMS; do
    name=${program##*/}
    page=$SG_SOURCE_DIR/man/$name.1
    [ -f "$page" ] || { fault "$name has no manual page"; continue; }
    "$SG_BUILD_DIR/$program" --help >/dev/null || { fault "$name --help failed"; continue; }
    [ -n "$(options_of_help "$program")" ] || fault "$name --help shows no options"
    while IFS= read -r line; do
        case $line in
            '<'*) fault "$name: --help has${line#<}, the page has not" ;;
            '>'*) fault "$name: the page has${line#>}, --help has not" ;;
        esac
    done < <(diff <(options_of_help "$program") <(options_of_page "$page"))
    if command -v mandoc >/dev/null; then
        mandoc -T lint -W warning "$page" || fault "$name: mandoc finds faults"
    fi
done
for page in "$SG_SOURCE_DIR"/man/*.1; do
    [ -e "$page" ] || continue
    name=$(basename "$page" .1)
    case " $SG_PROGRAMS " in *"/$name "*) ;; *) fault "man/$name.1 is of no program" ;; esac
done
[ "$bad" = 0 ] || exit 1
command -v mandoc >/dev/null || echo "mandoc is not installed: the pages were not linted"
echo "$(wc -w <<<"$SG_PROGRAMS") programs and their pages agree"
