#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# print-grammar: its four forms, its exit statuses, and that nothing half-written stays.
set -u
: "${SG_BUILD_DIR:?}"
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 99
program=$SG_BUILD_DIR/src/print-grammar
bad=0
expect() { # STATUS WHAT COMMAND...
    local wanted=$1 what=$2 got
    shift 2
    "$@" >out 2>err
    got=$?
    [ "$got" = "$wanted" ] || { echo "$what: status $got, not $wanted"; cat err; bad=1; }
}
said() { grep -qF -- "$1" err || { echo "not said: $1"; cat err; bad=1; }; }

cat >good.sg <<'END'
label window #ff0000
label wall
start S
rule S -> 0.5 : split y { wall | S } sizes mean (0.5, 0.5) sd (0.1, 0.1) -> 0.5 : split x { wall | window }
END
printf 'start S\nrule S -> [ S' >bad.sg

expect 0 'canonical text' "$program" good.sg
cp out once.sg
expect 0 'text of the text' "$program" once.sg
cmp -s out once.sg || { echo 'no fixed point'; bad=1; }
expect 0 'exchange form' "$program" --json good.sg
cp out once.json
expect 0 'exchange form of itself' "$program" --json -o again.json once.json
cmp -s again.json once.json || { echo 'the exchange form changes'; bad=1; }
expect 0 'standard input' "$program" - <good.sg
expect 0 'a graph' "$program" --dot good.sg
grep -q '^digraph' out || { echo 'no graph'; bad=1; }
if command -v dot >/dev/null; then dot -Tsvg out >/dev/null || { echo 'Graphviz cannot read it'; bad=1; }; fi
grep -q '^  s0 -> s0 \[label="0.5"\];$' out || { echo 'no edge of a recursive symbol'; cat out; bad=1; }
expect 0 'counts' "$program" --counts good.sg
[ "$(cut -f 2 out | tr '\n' ' ')" = '3 1 2 2 2 0 1 0 4 ' ] || { echo 'other counts'; cat out; bad=1; }
expect 2 'two forms' "$program" --counts --dot good.sg
expect 0 'help' "$program" --help
[ "$(wc -l <out)" -le 24 ] || { echo 'help is longer than a screen'; bad=1; }
head -1 out | grep -q '^Example' || { echo 'help does not begin with an example'; bad=1; }
expect 0 'version' "$program" --version

expect 3 'a bad grammar' "$program" bad.sg
said "bad.sg:2:13: error: found the end of the file; expected "
expect 3 'a missing file' "$program" none.sg
said 'none.sg: No such file'
expect 3 'a folder' "$program" .
expect 2 'no argument' "$program"
expect 2 'an unknown option' "$program" --nonsense good.sg
printf 'start A rule A -> draw(1)' >turtle.sg
expect 3 'no split grammar' "$program" --json turtle.sg
said 'turtle.sg:1: error: no split grammar: rule of A: a body that is not one split or one label'
expect 4 'a full disk' "$program" -o /dev/full good.sg
expect 4 'a folder that is not there' "$program" -o none/out.sg good.sg
printf 'old' >kept
expect 3 'a failure after the output was named' "$program" --json -o kept turtle.sg
[ "$(cat kept)" = old ] || { echo 'a failure changed the output'; bad=1; }
(ulimit -f 0; "$program" -o small good.sg >out 2>err)
[ $? = 4 ] || { echo 'a file size limit: wrong status'; bad=1; }
[ ! -e small ] && [ -z "$(find . -name '.small*')" ] || { echo 'half a file stayed'; bad=1; }
exit "$bad"
