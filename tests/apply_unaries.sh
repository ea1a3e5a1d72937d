#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# apply-unaries as a program: what it writes, the same bytes with any threads, bad classifiers and photographs, signals.
set -u
learn=${SG_BUILD_DIR:-.}/parse/learn-unaries
apply=${SG_BUILD_DIR:-.}/parse/apply-unaries
. "${SG_SOURCE_DIR:-.}/tests/shell_support.sh"
facades=$SG_SOURCE_DIR/data/facades

printf 'facade001\nfacade002\n' >names
expect 0 "$learn" "$facades" --names names --features patch --patch 5 --trees 3 --depth 6 --pixels 2000 -o f.rf --quiet
[ $failures -eq 0 ] || exit 1
mkdir photos
for k in 003 004 005; do cp "$facades/images/facade$k.jpg" photos; done

# What it writes
expect 0 "$apply" f.rf photos/facade003.jpg photos/facade004.jpg -o out1 --json out.json
[ "$(find out1 -type f | sort | tr '\n' ' ')" = \
    "out1/classes.tsv out1/facade003.npy out1/facade003.png out1/facade004.npy out1/facade004.png " ] ||
    fail "not the files that should be there: $(find out1)"
same out1/classes.tsv "$facades/classes.tsv"
says out.json '"image": "photos/facade003.jpg"'
if command -v python3 >/dev/null && python3 -c 'import numpy' 2>/dev/null; then
    expect 0 python3 -c 'import numpy, json
p = numpy.load("out1/facade003.npy")
r = json.load(open("out.json"))["images"][0]
assert p.dtype == numpy.float32 and p.shape == (7, r["height"], r["width"]), p.shape
assert p.min() > 0 and abs(p.sum(0) - 1).max() < 1e-5
assert len(set(p.argmax(0).ravel())) > 2'
fi

# The same bytes with any number of threads, more of them than photographs too
for threads in 1 2 5; do
    expect 0 "$apply" f.rf photos/facade003.jpg photos/facade004.jpg -o again --threads $threads --quiet
    [ ! -s err ] || fail "--quiet is not quiet"
    diff -r out1 again >diff.out || fail "$threads threads change the files"
    rm -r again
done

# Usage
expect 0 "$apply" --help
says out 'apply-unaries'
expect 0 "$apply" --version
expect 2 "$apply"
expect 2 "$apply" f.rf -o x
expect 2 "$apply" f.rf photos/facade003.jpg
expect 2 "$apply" f.rf photos/facade003.jpg -o x --no-such-option
mkdir other
cp photos/facade003.jpg other
expect 2 "$apply" f.rf photos/facade003.jpg other/facade003.jpg -o x
says err "named 'facade003'"
absent x

# No input is overwritten
cp out1/facade003.png photos/grey.png
cp photos/grey.png kept.png
expect 2 "$apply" f.rf photos/grey.png -o photos
says err 'this is read'
same photos/grey.png kept.png
for json in x/facade003.npy ./x//facade003.png photos/../x/./classes.tsv; do
    expect 2 "$apply" f.rf photos/facade003.jpg -o x --json $json
    says err 'two results would be this file'
done
absent x
cp -r out1 link-to
ln -s link-to link
expect 2 "$apply" f.rf photos/facade003.jpg -o link --json link-to/facade003.npy
expect 2 "$apply" f.rf photos/facade003.jpg -o link-to --json link/facade003.png
diff -r out1 link-to >diff.out || fail "something was written"
expect 2 "$apply" f.rf photos/facade003.jpg -o x --json photos/facade003.jpg
expect 2 "$apply" f.rf photos/facade003.jpg -o x --json f.rf
cp photos/facade003.jpg "$(printf 'a\tb.jpg')"
expect 2 "$apply" f.rf "$(printf 'a\tb.jpg')" -o out-tab
mkdir table
cp f.rf table/classes.tsv
expect 2 "$apply" table/classes.tsv photos/facade003.jpg -o table
same f.rf table/classes.tsv
absent x

# Bad classifiers
bytes=$(wc -c <f.rf)
for n in 0 5 8 20 24 100 $((bytes / 2)) $((bytes - 1)); do
    head -c "$n" f.rf >cut.rf
    expect 3 "$apply" cut.rf photos/facade003.jpg -o x
    says err 'cut.rf: '
done
cp f.rf long.rf
printf 'x' >>long.rf
expect 3 "$apply" long.rf photos/facade003.jpg -o x
says err 'long.rf: the file is too long'
(head -c 8 f.rf && printf '\002\000\000\000' && tail -c +13 f.rf) >newer.rf
expect 3 "$apply" newer.rf photos/facade003.jpg -o x
says err 'of version 2'
(head -c $((bytes / 2)) f.rf && printf '\377\001' && tail -c +$((bytes / 2 + 3)) f.rf) >damaged.rf
expect 3 "$apply" damaged.rf photos/facade003.jpg -o x
says err 'checksum'
expect 3 "$apply" photos/facade003.jpg photos/facade003.jpg -o x
says err 'not a pixel classifier'
expect 3 "$apply" nowhere.rf photos/facade003.jpg -o x
expect 3 "$apply" photos photos/facade003.jpg -o x
absent x

# Bad photographs among good ones: they are named, the others are done
head -c 4000 photos/facade003.jpg >photos/cut.jpg
head -c 60 kept.png >photos/short.png
printf 'no picture' >photos/text.jpg
: >photos/empty.png
expect 3 "$apply" f.rf photos/cut.jpg photos/facade003.jpg photos/text.jpg photos/missing.jpg photos/short.png \
    photos/empty.png photos/facade004.jpg -o some --json some.json
for name in cut.jpg text.jpg missing.jpg short.png empty.png; do says err "photos/$name: "; done
says err '5 of 7 photographs'
diff -r out1 some >diff.out || fail "the good ones are not done as they were"
if grep -q 'cut.jpg' some.json; then fail "a bad photograph among the done ones"; fi

# The coded data ends early, but the file says that it is whole: only we speak of it
(head -c 3000 photos/facade003.jpg && printf '\377\331') >photos/closed.jpg
expect 3 "$apply" f.rf photos/closed.jpg photos/facade003.jpg -o closed --quiet
says err '^apply-unaries: photos/closed.jpg: a damaged JPEG file: '
[ "$(wc -l <err)" -eq 2 ] || fail "somebody else speaks too"
same closed/facade003.npy out1/facade003.npy
absent closed/closed.npy

# Odd ones: one pixel, grey, palette, 16 bits, alpha, CMYK
if command -v python3 >/dev/null; then
    expect 0 python3 -c 'import struct, zlib
def png(path, w, h, depth, kind, row, extra=b""):
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, depth, kind, 0, 0, 0)) + extra
                           + chunk(b"IDAT", zlib.compress((b"\0" + row) * h)) + chunk(b"IEND", b""))
png("photos/pixel.png", 1, 1, 8, 2, b"\x10\x20\x30")
png("photos/column.png", 1, 9, 8, 0, b"\x80")
png("photos/deep.png", 5, 3, 16, 2, b"\x12\x34" * 15)
png("photos/alpha.png", 5, 3, 8, 6, b"\x12\x34\x56\x80" * 5)
png("photos/huge.png", 40000, 40000, 8, 2, b"")
png("photos/wide.png", 32768, 32768, 8, 2, b"")'
    expect 0 "$apply" f.rf photos/pixel.png photos/column.png photos/deep.png photos/alpha.png photos/grey.png -o odd
    [ "$(find odd -name '*.npy' | wc -l)" -eq 5 ] || fail "not all odd ones are done"
    expect 3 "$apply" f.rf photos/huge.png photos/wide.png photos/pixel.png -o odd2
    says err 'photos/huge.png: '
    says err 'photos/wide.png: '
    [ -e odd2/pixel.npy ] || fail "the good one is not done"
fi

# One that memory does not suffice for, one whose results can have no name: the others are done
long=$(printf '%0254d' 7)
cp photos/facade004.jpg "photos/$long"
expect 3 "$apply" f.rf "photos/$long" photos/facade003.jpg -o longer
says err 'the name is too long'
same longer/facade003.npy out1/facade003.npy
if [ -e photos/huge.png ] && (ulimit -v 1000000 && "$apply" --version) >out 2>&1; then
    expect 0 python3 -c 'import struct, zlib
def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
open("photos/poster.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 7000, 7000, 8, 0, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(bytes(7001 * 7000), 1)) + chunk(b"IEND", b""))'
    (ulimit -v 1000000 && exec "$apply" f.rf photos/poster.png photos/text.jpg photos/facade003.jpg -o poster --threads 2 \
        --json poster.json) >out 2>err
    [ $? -eq 4 ] || fail "too little memory is no failure of the system"
    says err 'photos/poster.png: there is not enough memory'
    says err 'photos/text.jpg: '
    says err '2 of 3 photographs'
    same poster/facade003.npy out1/facade003.npy
    says poster.json facade003
fi

# The system fails
touch file
expect 4 "$apply" f.rf photos/facade003.jpg -o file
expect 4 "$apply" f.rf photos/facade003.jpg -o file/below
(ulimit -f 40 && "$apply" f.rf photos/facade003.jpg photos/facade004.jpg -o limited >out 2>err)
[ $? -eq 4 ] || fail "a file size limit is no failure"
[ -z "$(find limited -name '*.npy' -o -name '.*.??????')" ] || fail "half a file: $(find limited -type f)"
[ ! -e /dev/full ] || expect 4 "$apply" f.rf photos/facade003.jpg -o full --json /dev/full

# A signal ends it: 5, and what is there is whole
mkdir many
k=0
while [ $k -lt 300 ]; do
    ln -s "$work/photos/facade003.jpg" "many/m$k.jpg"
    k=$((k + 1))
done
"$apply" f.rf many/*.jpg -o stopped --quiet >out 2>err &
pid=$!
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    [ -n "$(find stopped -name '*.png' 2>/dev/null | head -n 1)" ] && break
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
[ -z "$(find stopped -name '.*.??????')" ] || fail "temporary files are left"
for file in stopped/*.npy; do same "$file" out1/facade003.npy; done

[ $failures -eq 0 ] || exit 1
echo "apply-unaries does as it says"
