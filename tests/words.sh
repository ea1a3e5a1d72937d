#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# The words of the language, "KIND WORD" a line, from the tables that the program itself uses.
set -u
: "${SG_SOURCE_DIR:?}"
cd "$SG_SOURCE_DIR/src/grammar" || exit 99
words() { # KIND FILE BEGIN PATTERN: what matches in the table that begins with this line
    awk -v begin="$3" 'index($0, begin) { on = 1 } on { print } on && /^};/ { exit }' "$2" | grep -oE "$4" |
        grep -oE '"[a-z][a-z0-9_]*"' | tr -d '"' | sed "s/^/$1 /"
}
words keyword sg_scanner.l '} keywords[] = {' '\{"[a-z]+"'
words function operators.c 'static const sg_operator_info table' '\{"[a-z][a-z0-9]*", [0-9], 9\}'
words distribution distribution.c 'static const sg_distribution_info distributions' '\{"[a-z_]+"'
words operation shape_ops.c 'static const sg_shape_info operations' '\{"[a-z_]+"' | grep -v ' components$'
words face shape_ops.c 'static const char *const faces' '"[a-z]+"'
grep -oE 'strcmp\(name, "[a-z]+"\)' build_expr.c | grep -oE '"[a-z]+"' | tr -d '"' | sort -u | sed 's/^/constant /'
