#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# make-lattice as a program: a data set made here, exit statuses, bad input, threads, signals.
set -u
program=${SG_BUILD_DIR:-.}/parse/make-lattice
import=${SG_BUILD_DIR:-.}/data/import-labels
. "${SG_SOURCE_DIR:-.}/tests/shell_support.sh"

# Text maps: 12 of them, 60 x 40 px, windows on a wall over a shop, each a little different; one pixel is odd.
mkdir maps
k=1
while [ $k -le 12 ]; do
    awk -v k=$k 'BEGIN {
        for (y = 0; y < 40; y++) {
            line = ""
            for (x = 0; x < 60; x++) {
                c = 1
                if (y < 5) c = 2
                else if (y >= 32) c = 3
                else if ((x + k) % 15 < 6 && (y - 5) % 9 >= 2 && (y - 5) % 9 < 7) c = 0
                if (x == 30 && y == 33) c = 1
                line = line c
            }
            print line
        }
    }' >"maps/f$k.txt"
    k=$((k + 1))
done
printf '0\twindow\t#ff0000\n1\twall\t#ffff00\n2\tsky\t#80ffff\n3\tshop\t#00ff00\n' >classes.tsv
[ -x "$import" ] || { echo "import-labels is not built"; exit 77; }
expect 0 "$import" digits maps -o set --classes classes.tsv
[ $failures -eq 0 ] || exit 1

# The lattices and the table
expect 0 "$program" set -o lattices --quiet
says out '^name  *W  *H  *cells  *accuracy'
says out '^f12 '
says out '^mean .* over 12 maps'
[ ! -s err ] || fail "--quiet is not quiet"
[ "$(find lattices -name '*.lat' | wc -l)" -eq 12 ] || fail "not 12 lattices"
says lattices/f1.lat '^lattice 9 9$'
says lattices/f1.lat '^x 0 5 14 20 29 35 44 50 59 60$'
says lattices/f1.lat '^y 0 5 7 12 16 21 25 30 32 40$'
[ "$(find lattices | wc -l)" -eq 13 ] || fail "something else is left in the folder"

# The same bytes with any number of threads, and with options that bisect
for option in "" "--cells 40" "--accuracy 0.97" "--mean-cells 30" "--mean-accuracy 0.95" "--lambda 3" "--mu 50"; do
    # shellcheck disable=SC2086
    expect 0 "$program" set -o one --threads 1 --pictures --loss $option
    cp out out.one
    # shellcheck disable=SC2086
    expect 0 "$program" set -o two --threads 2 --pictures --loss $option
    cmp -s out out.one || fail "threads change the table with '$option'"
    diff -r one two >diff.out || fail "threads change the files with '$option'"
    rm -rf one two
done
says out '^of all .* lost pixels: misaligned'
expect 0 "$program" set -o cells --cells 40
awk '$1 ~ /^f/ && $4 > 40 { exit 1 }' out || fail "--cells 40 gives more"
expect 0 "$program" set -o accuracy --accuracy 1
awk '$1 ~ /^f/ && $5 != "100.000%" { exit 1 }' out || fail "--accuracy 1 gives less"

# Choosing images
printf 'f3\nf1\n' >names
expect 0 "$program" set -o named --names names --max-images 1
says out '^f3 '
[ "$(find named -name '*.lat')" = named/f3.lat ] || fail "not f3 alone"
mkdir set/folds
printf 'f2\ttrain\nf5\ttest\n' >set/folds/1.tsv
expect 0 "$program" set -o fold --fold 1 --part test
[ "$(find fold -name '*.lat')" = fold/f5.lat ] || fail "not f5 alone"

# JSON, also to standard output, where the table then is not
expect 0 "$program" set -o js --json result.json --names names
says result.json '"mean_accuracy"'
says out '^mean'
expect 0 "$program" set -o js --json - --names names
says out '"confusion"'
if grep -q '^mean' out; then fail "a table among the JSON"; fi
if command -v python3 >/dev/null; then
    expect 0 python3 -c 'import json, sys
r = json.load(open("result.json"))
assert [m["name"] for m in r["maps"]] == ["f3", "f1"]
for m in r["maps"]:
    assert m["cells"] == m["width"] * m["height"]
    assert m["wrong"] == sum(c["lost"] for c in m["loss"]["per_class"].values())
    assert m["pixels"] == sum(map(sum, m["loss"]["confusion"])) == 2400'
fi

# Usage
expect 0 "$program" --help
says out 'make-lattice'
expect 0 "$program" --version
expect 2 "$program"
expect 2 "$program" set
expect 2 "$program" set other -o x
expect 2 "$program" set -o x --cells 0
expect 2 "$program" set -o x --cells many
expect 2 "$program" set -o x --accuracy 98
expect 2 "$program" set -o x --lambda -1
expect 2 "$program" set -o x --lambda nan
expect 2 "$program" set -o x --cells 5 --mu 3
says err 'take one'
expect 2 "$program" set -o x --fold 1 --names names
expect 2 "$program" set -o x --starts 5
expect 2 "$program" set -o x --part some
expect 2 "$program" set -o x --no-such-option
absent x

# No input is overwritten
cp set/labels/f1.png before.png
expect 2 "$program" set -o set/labels --pictures
says err 'f1.png: this is read'
cmp -s set/labels/f1.png before.png || fail "a label map was overwritten"

# Bad input: all faults, before any work
expect 3 "$program" nowhere -o x
expect 3 "$program" set -o x --names nowhere
cp -r set bad
printf 'no picture' >bad/labels/f2.png
head -c 100 set/labels/f3.png >bad/labels/f3.png
expect 3 "$program" bad -o x
says err 'f2.png'
says err 'f3.png'
absent x
cp -r set ignored
printf '0\tignore\t#ff0000\n1\tignore\t#ffff00\n2\tignore\t#80ffff\n3\tignore\t#00ff00\n4\tdoor\t#000000\n' >ignored.tsv
expect 3 "$program" ignored -o x --classes ignored.tsv --names names
says err 'f3.png: every pixel is ignored'
[ -z "$(find x -name '*.lat' 2>/dev/null)" ] || fail "lattices of bad input"

# The system fails
touch file
expect 4 "$program" set -o file
expect 4 "$program" set -o file/below
if [ -e /dev/full ]; then
    "$program" set -o full >/dev/full 2>err
    [ $? -eq 4 ] || fail "a full standard output is no failure"
    says err 'standard output'
    expect 4 "$program" set -o full --json /dev/full
    says err '/dev/full'
fi
if [ "$(id -u)" -ne 0 ]; then
    mkdir closed
    chmod a-w closed
    expect 4 "$program" set -o closed
fi
mkdir here
expect 2 "$program" "$SG_SOURCE_DIR/data/facades" --max-images 2 -o here --json ./here//facade001.lat
expect 2 "$program" "$SG_SOURCE_DIR/data/facades" --max-images 2 -o here --pictures --json here/facade002.png
[ -z "$(ls here)" ] || fail "a result is written over another"
# Two blocks and not none: the OpenMP of clang keeps a small file in shared memory, and dies where it may not.
(ulimit -f 2 && "$program" "$SG_SOURCE_DIR/data/facades" --max-images 2 -o small >/dev/null 2>err)
[ $? -eq 4 ] || fail "a file size limit is no failure"
[ -z "$(find small -type f)" ] || fail "half a file: $(find small -type f)"

# A signal ends it: 5, and what is there is whole
mkdir many many/labels
cp set/classes.tsv many
k=0
while [ $k -lt 400 ]; do
    ln -s "$work/set/labels/f$((k % 12 + 1)).png" "many/labels/m$k.png"
    k=$((k + 1))
done
"$program" many -o stopped --quiet --pictures >out 2>err &
pid=$!
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    [ -n "$(find stopped -name '*.lat' 2>/dev/null | head -n 1)" ] && break
    sleep 0.05
done
kill -INT $pid 2>/dev/null
wait $pid
status=$?
case $status in
5) says err 'stopped' ;;
0) echo "(it was done before the signal came)" ;;
*) fail "status $status after SIGINT" ;;
esac
[ -z "$(find stopped -name '*.??????' ! -name '*.png' ! -name '*.lat')" ] || fail "temporary files are left"
grep -q '^mean' out || [ "$(find stopped -name '*.lat' | wc -l)" -eq 0 ] || fail "no table of what was made"

[ $failures -eq 0 ] || exit 1
echo "make-lattice does as it says"
