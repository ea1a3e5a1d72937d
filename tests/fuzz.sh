#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Each fuzzer over its corpus, and over a few thousand mutations of it. Longer runs: configure --enable-fuzzers with clang.
set -u
: "${SG_BUILD_DIR:?}" "${SG_SOURCE_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
corpus=$SG_SOURCE_DIR/tests/corpus
mkdir new # libFuzzer puts what it finds into the first folder
for file in "$corpus"/*/*; do # fuzzers read no files of other names
    [ -s "$file" ] || fail "$file is empty or missing"
done
echo >new/blank
run_fuzzer() { # NAME FOLDER...
    fuzzer=$1
    shift
    expect 0 "$SG_BUILD_DIR/tests/fuzz_$fuzzer" -runs=20000 -seed=1 new "$@"
}
run_fuzzer grammar "$corpus/grammar" "$SG_SOURCE_DIR/data/grammars"
run_fuzzer derivation_binary "$corpus/derivation_binary"
run_fuzzer derivation_json "$corpus/derivation_json"
run_fuzzer obj "$corpus/obj"
[ $failures -eq 0 ]
