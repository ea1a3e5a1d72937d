#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: count-tests.sh BUILD-FOLDER
# Reads what "make check" left there and prints the failures, the reasons of what was skipped, and "N passed, N failed".
# A Check program counts with each of its checks ("N%: Checks: N, Failures: N, Errors: N"), any other test as one. A
# check that skips itself prints a line that begins with "skipped:". Exit status 1 when something failed or nothing ran.
set -euo pipefail
cd "$1"
passed=0 failed=0 skipped=0

count_check_program() { # LOG RESULT
    local summary checks failures errors skips
    summary=$(grep -aE '^[0-9]+%: Checks: ' "$1" | tail -n 1 || true)
    read -r checks failures errors <<<"$(sed -E 's/.*Checks: ([0-9]+), Failures: ([0-9]+), Errors: ([0-9]+).*/\1 \2 \3/' <<<"$summary")"
    skips=$(grep -acE '^skipped: ' "$1" || true)
    failed=$((failed + failures + errors))
    skipped=$((skipped + skips))
    passed=$((passed + checks - failures - errors - skips))
    # A program that ends badly though every check is fine (a leak, say) has failed too.
    if [ "$2" = FAIL ] && [ $((failures + errors)) = 0 ]; then failed=$((failed + 1)); fi
}

for trs in tests/*.trs; do
    [ -e "$trs" ] || continue
    log=${trs%.trs}.log
    result=$(sed -n 's/^:test-result: \([A-Z]*\).*/\1/p' "$trs")
    if grep -aqE '^[0-9]+%: Checks: ' "$log"; then
        count_check_program "$log" "$result"
    else
        case $result in
            PASS | XFAIL) passed=$((passed + 1)) ;;
            SKIP) skipped=$((skipped + 1)) ;;
            *) failed=$((failed + 1)) ;;
        esac
    fi
    case $result in
        PASS | XFAIL) ;;
        SKIP) printf 'SKIP %s: %s\n' "${trs%.trs}" "$(tail -n 2 "$log" | head -n 1)" ;;
        *) printf 'FAIL %s\n' "${trs%.trs}"; grep -aE ':[EF]:|[Ee]rror|FAIL' "$log" | head -n 20 | sed 's/^/    /' || true ;;
    esac
done
grep -ahE '^skipped: ' tests/*.log 2>/dev/null | sort | uniq -c | sed -E 's/^ *([0-9]+) skipped: /SKIP (\1 checks) /' || true
if [ $((passed + failed)) = 0 ]; then
    printf 'no test ran; the end of %s/log/check.log:\n' "$1"
    tail -n 30 log/check.log 2>/dev/null || true
    failed=1
fi
if [ "$skipped" = 0 ]; then
    printf '%d passed, %d failed\n' "$passed" "$failed"
else
    printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
fi
[ "$failed" = 0 ]
