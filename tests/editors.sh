#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The syntax files of editors know every word of the language, JSON files can be parsed, and vim gives each kind of word the
# group that is meant for it.
set -u
: "${SG_BUILD_DIR:?}" "${SG_SOURCE_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
editors=$SG_SOURCE_DIR/data/editors
vim_syntax=$editors/vim/syntax/shapegram.vim
tm_grammar=$editors/vscode/syntaxes/shapegram.tmLanguage.json

# Words that one table of the program has; those of vim's comments and links do not count.
"$SG_SOURCE_DIR/tests/words.sh" >words
[ "$(wc -l <words)" -ge 75 ] || fail 'the tables of words were not found'
for kind in keyword function distribution operation face constant; do
    grep -q "^$kind " words || fail "no word of kind $kind was found"
done
grep '^syntax ' "$vim_syntax" >vim.words
grep '"match"' "$tm_grammar" >code.words
while read -r kind word; do
    grep -qw "$word" vim.words || fail "vim's syntax file lacks the $kind $word"
    sed 's/\\\\b/ /g' code.words | grep -qw "$word" || fail "the grammar of VS Code lacks the $kind $word"
done <words
# The other way round: words between bars that the language does not have.
for word in $(grep -ohE '[a-z][a-z0-9_]*(\||\\\|)[a-z][a-z0-9_|\\]*' vim.words code.words | tr -s '|\\' '\n' | sort -u); do
    case $word in box | cylinder | cone | sphere | s) continue ;; esac # primitives are the interpreter's
    grep -q " $word\$" words || fail "'$word' is no word of the language"
done

if command -v python3 >/dev/null; then
    for file in package.json language-configuration.json syntaxes/shapegram.tmLanguage.json; do
        expect 0 python3 -m json.tool "$editors/vscode/$file"
    done
    for path in $(sed -n 's|.*"\./\(.*\)".*|\1|p' "$editors/vscode/package.json"); do
        [ -f "$editors/vscode/$path" ] || fail "package.json names $path, which is not there"
    done
    # Every pattern is a regular expression.
    cat >patterns.py <<'END'
import json, re, sys

def walk(value):
    if isinstance(value, dict):
        for key, inner in value.items():
            if key in ("match", "begin", "end"):
                re.compile(re.sub(r"\(\?<=\[\(,\]\|\[\(,\]\\s\)", "", inner))
            walk(inner)
    elif isinstance(value, list):
        for inner in value:
            walk(inner)

walk(json.load(open(sys.argv[1])))
END
    expect 0 python3 patterns.py "$tm_grammar"
else
    echo 'no python3: JSON files were not parsed'
fi

if ! command -v vim >/dev/null; then
    [ $failures -eq 0 ] || exit 1
    echo 'vim is not installed: its syntax file was not loaded'
    exit 0
fi
cat >try.sg <<'END'
# rule uniform
limit depth 3
label wall #ff00aa
label "two rules" #00ff00 # uniform
material oak #aabbcc
const k = 2.5e-3
start S
rule S(x) if x > 0 and not true
  -> 1 - k : u ~ uniform(0, max(1, pi)) split x { '0.5 : wall | ~1 : maybe(0.3) "two rules" } draw(u)
  -> k : set_material(#123456) components { top : draw } insert(sphere) # set
rule S(x) at limit -> size(1, 2, 3)
END
cat >try.vim <<'END'
set nocompatible
let &runtimepath = $VIM_FOLDER . ',' . &runtimepath
syntax enable
filetype on
edit try.sg
function! Group(line, text)
  let column = match(getline(a:line), a:text) + 1
  return column == 0 ? 'nothing' : synIDattr(synID(a:line, column, 1), 'name')
endfunction
let said = [&filetype, get(b:, 'current_syntax', '')]
for [line, text, group] in [
      \ [1, 'rule', 'Comment'], [2, 'limit', 'Statement'], [2, 'depth', 'Constant'], [2, '3', 'Number'],
      \ [3, 'label', 'Statement'], [3, '#', 'Color'], [4, 'rules', 'Quoted'], [4, '#00', 'Color'], [4, 'uniform', 'Comment'],
      \ [5, 'material', 'Statement'], [5, '#', 'Color'], [6, 'const', 'Statement'], [6, '2.5', 'Number'],
      \ [8, 'rule', 'Statement'], [8, 'if', 'Conditional'], [8, 'and', 'OperatorWord'], [8, 'true', 'Constant'],
      \ [9, '->', 'Operator'], [9, 'uniform', 'Distribution'], [9, 'max', 'Function'], [9, 'pi', 'Constant'],
      \ [9, 'split', 'Body'], [9, 'x {', 'Axis'], [9, "'0", 'Operator'], [9, 'maybe', 'Body'], [9, 'draw', 'Operation'],
      \ [10, 'set_material', 'Operation'], [10, '#12', 'Color'], [10, 'components', 'Body'], [10, 'top', 'Face'],
      \ [10, 'draw', ''], [10, 'sphere', 'Primitive'], [10, '# set', 'Comment'], [11, 'at', 'Body'], [11, 'size', 'Operation']]
  let got = Group(line, text)
  let wanted = group ==# '' ? '' : 'shapegram' . group
  if got !=# wanted
    call add(said, text . ' in line ' . line . ' is ' . got . ', not ' . wanted)
  endif
endfor
call writefile(said, 'said')
quitall!
END
VIM_FOLDER=$editors/vim HOME=$work expect 0 vim -Nu NONE -n -es -S try.vim
if ! [ -e said ] || grep -qi 'E[0-9][0-9]*:' out err; then
    fail 'vim could not load the syntax file'
elif [ "$(cat said)" = "shapegram
" ] || [ "$(head -1 said)" = '' ]; then
    echo 'this vim was built without syntax highlighting'
else
    printf 'shapegram\nshapegram\n' >wanted
    same said wanted || cat said
fi
[ $failures -eq 0 ]
