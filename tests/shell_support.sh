# SPDX-License-Identifier: GPL-3.0-or-later
# shell_support.sh - sourced by the shell tests: a folder of their own that goes when they end, and the count of failures.
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 99
failures=0

# fail TEXT...: with what the last command said
fail() {
    echo "FAIL: $*"
    [ ! -e out ] || head -c 2000 out
    [ ! -e err ] || head -c 2000 err
    failures=$((failures + 1))
}

# expect STATUS COMMAND...: out and err are kept in the files of these names
expect() {
    want=$1
    shift
    "$@" >out 2>err
    got=$?
    [ $got -eq "$want" ] || fail "status $got, not $want: $*"
}

# says FILE TEXT: the file holds it
says() { grep -q -e "$2" "$1" || fail "'$2' is not in $1"; }
same() { cmp -s "$1" "$2" || fail "$1 and $2 differ"; }
absent() { [ ! -e "$1" ] || fail "$1 is there"; }
