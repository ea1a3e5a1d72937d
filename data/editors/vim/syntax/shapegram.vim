" SPDX-License-Identifier: GPL-3.0-or-later
" Vim syntax file for shape grammars (*.sg). Copy the folders beside this one to ~/.vim.

if exists('b:current_syntax')
  finish
endif
let s:cpo = &cpo
set cpo&vim

setlocal comments=:# commentstring=#\ %s

" A # begins a colour after a bracket, a comma, and the name of a label or material; elsewhere a comment.
syntax match shapegramComment "#.*$" contains=shapegramTodo,@Spell
syntax match shapegramColor "\%([(,]\s*\)\@<=#\x\{6}\>"
syntax match shapegramColor "\%(\<\%(label\|material\)\s\+\%(\"\%([^\"\\]\|\\.\)*\"\|[^ \t\"#]\+\)\s\+\)\@<=#\x\{6}\>"
syntax keyword shapegramTodo contained TODO FIXME XXX

syntax region shapegramQuoted start=+"+ skip=+\\["\\]+ end=+"+ oneline
syntax match shapegramNumber "\%(\k\)\@<!\%(\d\+\%(\.\d*\)\?\|\.\d\+\)\%([eE][-+]\?\d\+\)\?\>"

syntax keyword shapegramStatement grammar limit tied weights import const function label material start rule
syntax keyword shapegramBody nothing maybe split repeat components sizes mean covariance sd examples at
syntax keyword shapegramConditional if
syntax keyword shapegramOperatorWord and or not
syntax keyword shapegramConstant pi depth true false

" With a bracket behind them; without one they are names like others.
syntax match shapegramFunction "\<\%(abs\|sign\|floor\|ceil\|round\|sqrt\|exp\|log\|sin\|cos\|tan\|asin\|acos\|atan\|atan2\|hypot\|mod\|min\|max\)\ze\s*("
syntax match shapegramDistribution "\<\%(uniform\|normal\|truncated_normal\|mixture\|discrete\)\ze\s*("
syntax match shapegramOperation "\<\%(draw\|move\|turn\|pitch\|roll\|width\|tropism\|translate\|rotate\|scale\|size\|polygon\|extrude\|flat_roof\|gable_roof\|hip_roof\|insert\|set_material\|set_label\)\ze\s*("
syntax match shapegramFace "\<\%(front\|back\|left\|right\|top\|bottom\|side\|all\)\ze\s*:"
syntax match shapegramAxis "\%(\<\%(split\|repeat\)\s\+\)\@<=[xyz]\>"
syntax match shapegramPrimitive "\%(\<insert\s*(\s*\)\@<=\%(box\|cylinder\|cone\|sphere\)\>"
syntax match shapegramOperator "->\|[-+*/^<>=|~']\|[<>=!]="

" Nobody writes grammars of which a colour needs more context than this.
syntax sync minlines=50

highlight default link shapegramComment Comment
highlight default link shapegramTodo Todo
highlight default link shapegramColor Constant
highlight default link shapegramQuoted String
highlight default link shapegramNumber Number
highlight default link shapegramStatement Statement
highlight default link shapegramBody Keyword
highlight default link shapegramConditional Conditional
highlight default link shapegramOperatorWord Operator
highlight default link shapegramOperator Operator
highlight default link shapegramConstant Constant
highlight default link shapegramFunction Function
highlight default link shapegramDistribution Type
highlight default link shapegramOperation PreProc
highlight default link shapegramFace Identifier
highlight default link shapegramAxis Special
highlight default link shapegramPrimitive Special

let b:current_syntax = 'shapegram'
let &cpo = s:cpo
unlet s:cpo
