#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# check.sh - install what is missing, build, run every test, and say how many passed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
. scripts/setup.sh

usage() {
    cat <<'TXT'
Usage: ./check.sh [OPTION]...
Install what is missing (through apt), build, run all tests. The last line is "N passed, N failed", with the number of
skipped tests behind it when there are any. Exit status 0 when none failed.

  --sanitize   with AddressSanitizer, UndefinedBehaviorSanitizer and one malloc for each arena allocation
  --clang      with clang instead of gcc
  --werror     compiler warnings are errors
  --help
TXT
}

folder=build
options=()
needs="$needs_build $needs_check"
for option in "$@"; do
    case $option in
        --sanitize) folder=$folder-sanitize; options+=(--enable-sanitizers --enable-arena-debug) ;;
        --clang) folder=$folder-clang; options+=(CC=clang CXX=clang++); needs="$needs $needs_clang" ;;
        --werror) options+=(--enable-werror) ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
done

# shellcheck disable=SC2086
install_missing $needs
bootstrap
# A folder that was configured before Check was installed (by demo.sh, say) would leave nearly all tests out.
has_check() { grep -q '^CHECK_LIBS = .' "$folder/Makefile" 2>/dev/null; }
has_check || rm -f "$folder/config.status"
configure_in "$folder" ${options[@]+"${options[@]}"}
has_check || die "configure did not find Check, which the tests need; see $folder/log/configure.log"
build_in "$folder" all
run_step "building the tests" "$folder/log/build-tests.log" make -C "$folder" -j"$(cores)" check TESTS=
printf '== testing ...\n'
start=$SECONDS
rm -f "$folder"/tests/*.trs
status=0
make -C "$folder" -j"$(cores)" check >"$folder/log/check.log" 2>&1 </dev/null || status=$?
say "== tests ended ($((SECONDS - start)) s); logs: $folder/tests/*.log"
scripts/count-tests.sh "$folder" || exit 1
[ "$status" = 0 ] || die "make check failed outside the tests; see $folder/log/check.log"
