#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every example of the manual of the language works as it stands: grammars are read and sampled, wrong ones are refused with the
# message that is shown behind them.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
PATH=$SG_BUILD_DIR/src:$PATH
manual=$SG_SOURCE_DIR/docs/language.md

# Blocks to NUMBER.KIND; what stands in the block right behind a wrong one to NUMBER.says.
mkdir blocks
awk '/^```/ && !inside { kind = substr($0, 4); gsub(/ /, "-", kind); inside = 1
        file = ""
        if (kind ~ /^shapegram/) { file = sprintf("blocks/%03d.%s", ++n, kind); wrong = kind ~ /error|warning/ }
        else if (kind == "" && wrong && after) { file = sprintf("blocks/%03d.says", n); wrong = 0 }
        if (file != "") printf "" >file
        next }
    /^```$/ { inside = 0; after = file ~ /error|warning/; next }
    inside { if (file != "") print >file; next }
    { after = 0 }' "$manual"

# expect_said PROGRAM: its standard error is what the manual shows
expect_said() {
    [ -s "$block.says" ] || fail "no message behind block $block"
    sed "s/^$1: //" err >told
    cmp -s told "$block.says" || { fail "block $block: not what the manual shows"; diff told "$block.says"; }
}
sample() { # FORMATS
    rm -rf out.d
    sample-grammar example.sg -n 3 -o out.d --quiet --formats "$1" >out 2>err
}

for file in blocks/*.shapegram*; do
    block=${file%.*}
    cp "$file" example.sg
    case $file in
        *.shapegram | *.shapegram-labels)
            expect 0 print-grammar example.sg
            [ ! -s err ] || fail "block $block: a warning"
            cp out canonical.sg
            expect 0 print-grammar canonical.sg
            same out canonical.sg
            expect 0 sample obj,derivation
            grep -q '^f ' out.d/*-0001.obj || fail "block $block: nothing is placed"
            case $file in *labels) expect 0 sample labels,lat ;; esac ;;
        *.shapegram-error)
            expect 3 print-grammar example.sg
            expect_said print-grammar
            expect 3 sample obj
            expect_said sample-grammar ;;
        *.shapegram-warning)
            expect 0 print-grammar example.sg
            expect_said print-grammar ;;
        *.shapegram-run-error)
            expect 0 print-grammar example.sg
            expect 1 sample obj
            expect_said sample-grammar ;;
        *.shapegram-file-*) cp "$file" "${file#*.shapegram-file-}" ;;
        *) fail "an unknown kind of block: $file" ;;
    esac
done
n=$(find blocks -name '*.shapegram*' | wc -l)
[ "$n" -ge 35 ] || fail "only $n examples were found"

# The contents name all sections, in order.
sed -n 's/^[0-9]*\. \[\(.*\)\](#.*/\1/p' "$manual" >contents
sed -n 's/^## [0-9]*\. //p' "$manual" >sections
same contents sections
# Every link within leads to a heading.
sed -n 's/^##* //p' "$manual" | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9\n-' >anchors
grep -oE '\]\(#[a-z0-9-]*\)' "$manual" | tr -d '](#)' | grep -vxFf anchors >lost
[ ! -s lost ] || { cat lost; fail 'links that lead nowhere'; }
# The manual speaks of every keyword, function, distribution, operation and face.
awk '/^```/ { inside = !inside; next } !inside' "$manual" | tr '\n' ' ' | grep -oE '`[^`]*`' >code
"$SG_SOURCE_DIR/tests/words.sh" | while read -r kind word; do
    grep -qw "$word" code || echo "$kind $word"
done >unspoken
[ ! -s unspoken ] || { cat unspoken; fail 'words that the manual does not explain'; }
[ $failures -eq 0 ] || exit 1
echo "$n examples"
