#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# learn-unaries as a program: what it writes, the same bytes with any threads, exit statuses, bad input, signals.
set -u
learn=${SG_BUILD_DIR:-.}/parse/learn-unaries
apply=${SG_BUILD_DIR:-.}/parse/apply-unaries
. "${SG_SOURCE_DIR:-.}/tests/shell_support.sh"
facades=$SG_SOURCE_DIR/data/facades

# A small data set of the bundled facades, for there are faults to be made in it
mkdir set set/images set/labels set/folds
cp "$facades/classes.tsv" set
for k in 001 002 003 004; do
    cp "$facades/images/facade$k.jpg" set/images
    cp "$facades/labels/facade$k.png" set/labels
done
printf 'facade001\ttrain\nfacade002\ttrain\nfacade003\tvalid\nfacade004\ttest\n' >set/folds/1.tsv
printf 'facade001\ttrain\nfacade004\ttest\n' >set/folds/2.tsv
small="--features patch --patch 5 --trees 3 --depth 6 --pixels 2000"
# shellcheck disable=SC2086
quick() { "$learn" set $small "$@"; }

# What it writes and says
expect 0 quick -o one.rf --fold 1 --json one.json
says err 'learn-unaries: 2 photographs, 75 features; 3 trees'
says err '1 validation photographs: overall'
says one.json '"prior_exponent"'
says one.json '"feature": "R'
if command -v python3 >/dev/null; then
    expect 0 python3 -c 'import json
r = json.load(open("one.json"))
f = r["forest"]
assert f["trees"] == 3 and f["nfeatures"] == 75 and f["patch"] == 5 and f["leaves"] == (f["nodes"] + 3) / 2
assert r["train_images"] == 2 and r["valid_images"] == 1 and r["calibration"]["fitted"]
n = sum(r["sample_pixels"].values())
assert 1950 <= n <= 2000, n
for k, count in r["sample_pixels"].items():
    assert min(r["train_pixels"][k], 2000 // 140) <= count <= r["train_pixels"][k], k
assert sum(u["nodes"] for u in r["uses"]) == f["nodes"] - f["leaves"]
assert 0.3 < r["valid"]["overall"] <= 1
v, b = r["valid"], r["valid_before"]
assert v["overall"] + v["class_average"] >= b["overall"] + b["class_average"]'
fi

# The same bytes with any number of threads, with the same seed, and others with another
expect 0 quick -o two.rf --fold 1 --threads 1 --quiet
[ ! -s err ] || fail "--quiet is not quiet"
same one.rf two.rf
expect 0 quick -o two.rf --fold 1 --threads 3
same one.rf two.rf
expect 0 quick -o two.rf --fold 1 --seed 2
if cmp -s one.rf two.rf; then fail "the seed changes nothing"; fi

# Which photographs: names, a fold without validation part, the first N
printf 'facade001\nfacade002\n' >names
expect 0 quick -o two.rf --names names
says err '2 photographs'
expect 0 quick -o two.rf --fold 2 --json -
says out '"fitted": false'
says out '"train_images": 1'
expect 0 quick -o two.rf --fold 1 --max-images 1
says err 'learn-unaries: 1 photographs'
expect 0 quick -o two.rf --max-images 2
says err 'learn-unaries: 2 photographs'
expect 0 quick -o two.rf --fold 1 --balanced --json two.json
says two.json '"prior_exponent": 0'
expect 0 quick -o - --names names
[ "$(head -c 8 out)" = sgforest ] || fail "no classifier on standard output"

# Usage
expect 0 "$learn" --help
says out 'learn-unaries'
expect 0 "$learn" --version
expect 2 "$learn"
expect 2 "$learn" set
expect 2 "$learn" set set -o x
expect 2 quick -o x --depth 26
expect 2 quick -o x --depth 0
expect 2 quick -o x --trees 0
expect 2 quick -o x --trees many
expect 2 quick -o x --pixels 0
expect 2 quick -o x --patch 4
says err 'not odd'
expect 2 quick -o x --patch 65
expect 2 "$learn" set -o x --features rich --patch 5
says err 'belongs to'
expect 2 quick -o x --features some
expect 2 quick -o x --active 76
expect 2 quick -o x --fold 1 --names names
expect 2 quick -o x --json x
expect 2 quick -o x --json set/../x
says err 'need a file each'
expect 2 quick -o - --json -
expect 2 quick -o x --no-such-option
absent x

# No input is overwritten
cp -r set before
for file in classes.tsv folds/1.tsv images/facade001.jpg labels/facade003.png; do
    expect 2 quick --fold 1 -o "set/$file"
    says err 'this is read'
    expect 2 quick --fold 1 -o x --json "set/$file"
done
cp names kept
expect 2 quick --names names -o names
same names kept
diff -r set before >diff.out || fail "an input was changed"
absent x

# Bad input: all faults by name, before any work
bad() { # FILE: learning from the broken copy names it
    expect 3 "$learn" broken --features patch -o x --fold 1
    says err "$1"
    absent x
    rm -r broken
}
expect 3 "$learn" nowhere -o x
expect 3 quick -o x --names nowhere
expect 3 quick -o x --classes nowhere
expect 3 quick -o x --fold 7
cp -r set broken
head -c 3000 set/images/facade001.jpg >broken/images/facade001.jpg
head -c 100 set/labels/facade003.png >broken/labels/facade003.png
expect 3 "$learn" broken --features patch -o x --fold 1
says err 'facade001.jpg'
bad 'facade003.png'
cp -r set broken
rm broken/images/facade002.jpg
bad 'facade002.jpg'
cp -r set broken
cp set/images/facade004.jpg broken/images/facade003.jpg
bad 'facade003.jpg'
cp -r set broken
printf '0\twindow\t#ff0000\n' >broken/classes.tsv
bad 'not in the class table'
cp -r set broken
printf '0\tignore\t#000000\n1\tignore\t#000000\n2\tignore\t#000000\n3\tignore\t#000000\n4\tignore\t#000000\n5\tignore\t#000000\n6\tignore\t#000000\n7\tdoor\t#ffffff\n' >broken/classes.tsv
bad 'every pixel is ignored'

# One class alone, and classes that do not occur, are no fault
printf '0\twall\t#ff0000\n1\twall\t#ff0000\n2\twall\t#ff0000\n3\twall\t#ff0000\n4\twall\t#ff0000\n5\twall\t#ff0000\n6\twall\t#ff0000\n7\tmoat\t#0000ff\n' >wall.tsv
expect 0 quick --fold 1 --classes wall.tsv -o wall.rf --json wall.json
says wall.json '"moat": null'
expect 0 "$apply" wall.rf set/images/facade004.jpg -o wall --quiet
expect 0 quick --fold 1 --classes wall.tsv --balanced -o wall.rf

# The system fails
touch file
expect 4 quick -o file/below --fold 1
if [ -e /dev/full ]; then
    expect 4 quick -o /dev/full --fold 2
    says err '/dev/full'
    expect 4 quick -o x --fold 2 --json /dev/full
    rm -f x
fi
# Two blocks and not none: the OpenMP of clang keeps a small file in shared memory, and dies where it may not.
(ulimit -f 2 && quick -o limited.rf --fold 2 >out 2>err)
[ $? -eq 4 ] || fail "a file size limit is no failure"
absent limited.rf

# A signal ends it: 5, and what is there is a whole classifier, or nothing is
"$learn" set -o stopped.rf --features patch --trees 100000 --pixels 3000 --fold 1 >out 2>err &
pid=$!
sleep 1
kill -INT $pid 2>/dev/null
wait $pid
status=$?
[ $status -eq 5 ] || fail "status $status after SIGINT"
says err 'stopped'
if [ -e stopped.rf ]; then
    expect 0 "$apply" stopped.rf set/images/facade004.jpg -o stopped --quiet
else
    says err 'nothing is written'
fi
[ -z "$(find . -name '.*.??????')" ] || fail "temporary files are left"

[ $failures -eq 0 ] || exit 1
echo "learn-unaries does as it says"
