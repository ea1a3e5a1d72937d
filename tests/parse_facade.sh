#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# parse-facade as a program: facades sampled from a grammar are found again; batches, threads, faults, signals, exit statuses.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
PATH=$SG_BUILD_DIR/src:$SG_BUILD_DIR/parse:$SG_BUILD_DIR/learn:$SG_BUILD_DIR/data:$PATH
export PATH
grammars=$SG_SOURCE_DIR/data/grammars
have_python=false
if command -v python3 >/dev/null; then have_python=true; fi
# holds FILE CONDITION: a Python expression over d, the JSON in the file
holds() {
    $have_python || return 0
    python3 -c "
import json, math, sys
d = json.load(open('$1'))
sys.exit(not ($2))" || fail "not so in $1: $2"
}

# Six sampled facades whose photographs are the labels' colours, and a forest that has seen four of them.
expect 0 sample-grammar "$grammars/arcade.sg" -n 6 -o set --dataset --formats labels,rgb --size 60x80 --name f
mkdir set/folds
printf 'f-0001\ttrain\nf-0002\ttrain\nf-0003\ttrain\nf-0004\tvalid\nf-0005\ttest\nf-0006\ttest\n' >set/folds/1.tsv
expect 0 learn-unaries set --fold 1 -o f.rf --features patch --patch 3 --trees 3 --depth 8 --quiet
cp "$grammars/arcade.sg" g.sg
quick='--runs 2 --iterations 500 --chains 2 --quiet'

# ---- what is found, and what is written ----
expect 0 parse-facade g.sg -u f.rf set --fold 1 -o found --iterations 4000 --runs 2 --chains 3 --formats labels --quiet --json found.json
holds found.json "all(r['accuracy'] > 0.95 for r in d)"
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf set --fold 1 -o res $quick --json res.json
says out '^all 2: accuracy [0-9.]*% (MAP [0-9.]*%), class average'
for name in f-0005 f-0006; do
    for ending in png overlay.png json trace.tsv marginals.npy lines.tsv uncertainty.png; do
        [ -s res/$name.$ending ] || fail "res/$name.$ending was not written"
    done
done
[ "$(ls res | wc -l)" = 15 ] || fail "more files than expected: $(ls res)"
holds res.json "[r['image'].rsplit('/')[-1] for r in d] == ['f-0005.png', 'f-0006.png'] and all(
    abs(r['energy'] - r['energy_image'] - r['energy_rule'] - r['energy_attribute']) < 1e-6 and
    r['accuracy'] > 0.5 and r['moves'] == 2 * 500 * 2 and r['moves_per_second'] > 0 and r['seconds'] > 0 and
    len(r['run_energies']) == 2 and abs(min(r['run_energies']) - r['energy']) < 1e-6 * abs(r['energy']) and
    all(0 <= v <= 1 for v in list(r['acceptance'].values()) + [r['swap_rate']] if v is not None) for r in d)"
holds res/f-0005.json "d['rect'] == [0, 0, 60, 80] and d['symbol'] == 'Front' and abs(sum(d['sizes']) - 1) < 1e-9 and \
    abs(d['energy'] - json.load(open('res.json'))[0]['energy']) < 1e-9"
says res/f-0005.lines.tsv '^orientation	position	from	to	before	after	share	mean	sd$'
says res/f-0005.lines.tsv '^horizontal	'
says res/f-0005.trace.tsv '^run	iteration	energy	'
expect 0 evaluate-labels set res --fold 1
says out 'class average'

# the shares of the marginals sum to 1 in every pixel
$have_python && { python3 - <<'END' || fail 'marginals do not sum to 1'; }
import struct
data = open('res/f-0005.marginals.npy', 'rb').read()
start = 10 + struct.unpack('<H', data[8:10])[0]
assert b"'shape': (7, 80, 60)" in data[:start]
v = struct.unpack('<%df' % (7 * 4800), data[start:])
assert all(abs(sum(v[c * 4800 + i] for c in range(7)) - 1) < 1e-6 for i in range(4800))
END

# ---- the same bytes: any number of threads, alone or among others, in any order, by -u or by -p ----
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf set/images/f-0006.png set/images/f-0005.png -o again $quick --threads 1
diff -r res again >/dev/null || fail 'threads or order change the results'
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf set/images/f-0005.png -o alone $quick --threads 3
for file in alone/*; do same "$file" "res/${file#alone/}"; done
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf set/images/f-0005.png -o seed $quick --seed 2
cmp -s seed/f-0005.trace.tsv res/f-0005.trace.tsv && fail 'the seed changes nothing'
expect 0 apply-unaries f.rf set/images/*.png -o npy
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p npy set/images/f-0005.png -o byp $quick
for file in alone/*; do same "$file" "byp/${file#alone/}"; done
# names without a photograph: no overlay
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p npy f-0005 f-0006 -o names $quick --truth set
says out '^all 2: '
absent names/f-0005.overlay.png
same names/f-0005.png res/f-0005.png
# probabilities and results in one folder
cp -r npy both
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p both f-0005 -o both $quick
same both/classes.tsv npy/classes.tsv
same both/f-0005.png res/f-0005.png

# ---- options ----
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p npy f-0005 -o few $quick --formats labels,derivation --truth set/labels --classes set/classes.tsv --json -
mv out few.json
holds few.json "d[0]['samples'] == 0 and d[0]['accuracy'] > 0.5"
[ "$(ls few | tr '\n' ' ')" = 'classes.tsv f-0005.json f-0005.png ' ] || fail "--formats: $(ls few)"
for hard in '--hard' '--hard 0.994' '--hard=0.994'; do
    # shellcheck disable=SC2086
    expect 0 parse-facade g.sg $hard -p npy f-0005 -o hard $quick --formats labels,trace
    if [ -e hard.trace ]; then same hard.trace hard/f-0005.trace.tsv; fi
    cp hard/f-0005.trace.tsv hard.trace
done
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p npy f-0005 --hard -o hard $quick --formats trace
same hard.trace hard/f-0005.trace.tsv
for some in '--unary-weight 0.1 --no-delayed-rejection --depth-base 2 --share jump-copy=0 --anneal 20 --burn-in 0.9 --tries 1' \
    '--share shift=3 --swap-every 50 --tempering 2 --samples 4 --floor 0.01 --time 100 --reflect-step 0.2 --shift-step 0.3'; do
    # shellcheck disable=SC2086
    expect 0 parse-facade g.sg -p npy f-0005 -o opt $quick $some
    cmp -s opt/f-0005.trace.tsv res/f-0005.trace.tsv && fail "no effect: $some"
done
expect 0 parse-facade g.sg -p npy f-0005 -o opt --time 0.3 --iterations 1000000000 --runs 1 --chains 2 --json opt.json
holds opt.json "d[0]['moves'] < 2e9 and d[0]['samples'] > 0"

# ---- exact, and the gap ----
expect 0 parse-facade g.sg -p npy f-0005 -o exact --method exact --json exact.json --truth set
holds exact.json "d[0]['method'] == 'exact' and d[0]['moves_per_second'] is None and d[0]['accuracy'] > 0.9"
absent exact/f-0005.trace.tsv; absent exact/f-0005.marginals.npy
# shellcheck disable=SC2086
expect 2 parse-facade g.sg -p npy f-0005 -o gap --gap --method exact
expect 0 parse-facade g.sg -p npy f-0005 -o gap --gap $quick --json gap.json --truth set
says out '^  mcmc_from_exact '
holds gap.json "sorted(d[0]['stages']) == ['exact', 'mcmc', 'mcmc_from_exact']"
holds gap.json "d[0]['energy'] == min(s['energy'] for s in d[0]['stages'].values())"
holds gap.json "d[0]['stages']['mcmc_from_exact']['energy'] <= d[0]['stages']['exact']['energy'] + 1e-6"
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p npy f-0005 -o start --start exact $quick --json start.json
holds start.json "sorted(d[0]['stages']) == ['exact', 'mcmc_from_exact']"
for method in ga smc sosmc foo; do
    expect 2 parse-facade g.sg -p npy f-0005 -o y --method $method
    says err "'$method' is none of mcmc, exact$"
done

# what an earlier parse of the same name left and this one does not make goes; nothing else does
cp -r res old
echo mine >old/f-0005.txt
expect 0 parse-facade g.sg -p npy f-0005 -o old --method exact --formats labels
[ "$(cd old && echo f-0005*)" = 'f-0005.json f-0005.png f-0005.txt' ] || fail "beside a new parse: $(ls old)"
same old/f-0006.lines.tsv res/f-0006.lines.tsv
cp set/images/f-0005.png old/f-0005.overlay.png
expect 2 parse-facade g.sg -u f.rf set/images/f-0005.png old/f-0005.overlay.png -o old --formats derivation
same old/f-0005.overlay.png set/images/f-0005.png

# a data set with a photograph that has no label map, one that is there twice, a label map at fault
cp -r set odd
cp odd/images/f-0001.png odd/images/extra.png
expect 0 parse-facade g.sg -u f.rf odd -o odd.out --method exact --formats labels
[ "$(grep -c 'note: odd/images: left out, since there is no label map: extra.png$' err)" = 1 ] || fail 'an unlabelled photograph is not named'
absent odd.out/extra.png
cp odd/images/f-0001.png odd/images/f-0001.jpg
expect 3 parse-facade g.sg -u f.rf odd -o odd2.out --method exact
says err 'odd/images/f-0001.png: there is odd/images/f-0001.jpg too'
rm odd/images/f-0001.jpg
head -c 60 set/labels/f-0002.png >odd/labels/f-0002.png
expect 3 parse-facade g.sg -u f.rf odd -o odd2.out --method exact
says err 'odd/labels/f-0002.png: '
absent odd2.out

# nothing to score, nothing to say
sed 's/^\([0-9]*\)	[^	]*/\1	ignore/' set/classes.tsv >none.tsv
printf '99\twall\t#ffffff\n' >>none.tsv
expect 0 parse-facade g.sg -p npy f-0005 -o none --method exact --truth set/labels --classes none.tsv
if grep -q nan out; then fail 'a number that is none'; fi
if grep -q '^all' out; then fail 'a score of nothing'; fi

# ---- a batch with bad photographs: the others are parsed as if alone ----
mkdir photos
cp set/images/*.png photos
head -c 100 photos/f-0003.png >photos/short.png
echo 'no picture' >photos/text.jpg
# shellcheck disable=SC2086
expect 3 parse-facade g.sg -u f.rf photos/f-0006.png photos/short.png photos/gone.jpg photos/text.jpg photos/f-0005.png -o batch $quick --json batch.json
says err 'photos/short.png: the file is truncated'
says err 'photos/gone.jpg: No such file'
says err 'photos/text.jpg: '
says err '3 of 5 photographs were not parsed'
for file in res/*; do same "$file" "batch/${file#res/}"; done
[ "$(ls batch | wc -l)" = 15 ] || fail "a bad photograph left something: $(ls batch)"
holds batch.json "[r['energy'] is None for r in d] == [False, True, True, True, False] and 'truncated' in d[1]['error']"
# one whose results can have no name, one that memory does not suffice for
long=$(printf '%0245d' 7)
cp set/images/f-0005.png "photos/$long.png"
# shellcheck disable=SC2086
expect 3 parse-facade g.sg -u f.rf "photos/$long.png" set/images/f-0005.png -o long $quick
says err 'the name is too long for its results'
for file in alone/*; do same "$file" "long/${file#alone/}"; done
if $have_python && (ulimit -v 1000000 && parse-facade --version) >out 2>&1; then
    expect 0 python3 -c 'import struct, zlib
def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
open("photos/poster.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 7000, 7000, 8, 0, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(bytes(7001 * 7000), 1)) + chunk(b"IEND", b""))'
    # shellcheck disable=SC2086
    (ulimit -v 1000000 && exec parse-facade g.sg -u f.rf photos/poster.png photos/text.jpg set/images/f-0005.png -o poster $quick --threads 2) >out 2>err
    [ $? = 4 ] || fail 'too little memory is no failure of the system'
    says err 'photos/poster.png: there is not enough memory'
    says err '1 of 3 photographs were parsed'
    for file in alone/*; do same "$file" "poster/${file#alone/}"; done
fi
# every kind of bad input
cp -r npy bad; head -c 1000 npy/f-0001.npy >bad/f-0001.npy; cp npy/f-0002.npy bad/wide.npy; cp set/labels/f-0003.png bad/f-0003.npy
# shellcheck disable=SC2086
expect 3 parse-facade g.sg -p bad f-0001 f-0003 f-0004 -o y $quick
says err 'bad/f-0001.npy: the file is truncated'
says err 'bad/f-0003.npy: no NumPy array file'
[ -e y/f-0004.png ] || fail 'the good one was not parsed'
printf '0\twall\t#ffff00\n' >bad/classes.tsv
expect 3 parse-facade g.sg -p bad f-0004 -o y
says err 'labels of the grammar that are no classes of the pixels: pier, arch, ledge, window, cornice, urn (those are wall)'
{ cat npy/classes.tsv; printf '200\tmoon\t#000001\n'; } >bad/classes.tsv
expect 3 parse-facade g.sg -p bad f-0004 -o y
says err 'note: the grammar has no label for moon'
says err 'bad/f-0004.npy: 7 values a pixel, but there are 8 classes'
sample-grammar "$grammars/arcade.sg" -o big --dataset --formats labels,rgb --size 70x80 --name f-000 >/dev/null 2>&1
# shellcheck disable=SC2086
cp npy/f-0005.npy bad/f-000-0001.npy; cp npy/classes.tsv bad
expect 3 parse-facade g.sg -p bad big/images/*.png -o y
says err '60 x 80 pixels, but big/images/.* has 70 x 80'
cp big/labels/*.png f-0005.png
mkdir truth; mv f-0005.png truth
# shellcheck disable=SC2086
expect 3 parse-facade g.sg -p npy f-0005 f-0006 -o y --truth truth $quick
says err 'truth/f-0005.png: 70 x 80 pixels, but the photograph has 60 x 80'
says err 'truth/f-0006.png: No such file'
expect 3 parse-facade "$grammars/office.sg" -u f.rf set/images/f-0005.png -o y
says err 'office.sg: labels of the grammar that are no classes of the pixels: column, lobby, .*(those are pier, arch, '
head -c 500 f.rf >cut.rf
expect 3 parse-facade g.sg -u cut.rf set/images/f-0005.png -o y
expect 3 parse-facade g.sg -u g.sg set/images/f-0005.png -o y
expect 3 parse-facade none.sg -u f.rf set/images/f-0005.png -o y
expect 3 parse-facade g.sg -p none f-0005 -o y
expect 3 parse-facade g.sg -p npy nosuch -o y
says err 'npy/nosuch.npy: '
expect 3 parse-facade g.sg -p npy nosuch.png -o y
says err 'nosuch.png: '
# a file of an array's name is no photograph
echo notes >f-0005
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -p npy f-0005 -o named $quick
rm f-0005
# a photograph through a pipe
mkfifo piped.png
cat set/images/f-0005.png >piped.png &
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf piped.png -o piped $quick
rm piped.png
# folders and lists
mkdir photographs; cp set/images/f-0005.png photographs
expect 3 parse-facade g.sg -u f.rf photographs -o y
says err 'photographs: this folder is no data set'
: >nobody
expect 3 parse-facade g.sg -u f.rf set --names nobody -o y
says err 'nobody: no name in it$'
cp set/images/f-0005.png "$(printf 'a\tb.png')"
expect 2 parse-facade g.sg -u f.rf "$(printf 'a\tb.png')" -o y
says err 'a name with a control character'
expect 3 parse-facade g.sg -u f.rf set --fold 2 -o y
# a photograph of one pixel; one of something else
mkdir one; printf '0' >one/dot.txt; printf '0\tpier\t#8a7f70\n' >one.tsv
expect 0 import-labels digits one --classes one.tsv -o one.set
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf one.set/labels/dot.png -o dot $quick
[ -s dot/dot.uncertainty.png ] || fail 'one pixel has no results'
expect 0 sample-grammar "$grammars/office.sg" -o other --formats rgb --size 50x50 --name other
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf other/*.rgb.png -o other.out $quick

# a grammar that cannot fill the picture
{ grep '^label\|^grammar' g.sg; printf 'start S\nrule S -> split y { 500: wall | ~1: pier }\n'; } >tall.sg
# shellcheck disable=SC2086
expect 1 parse-facade tall.sg -u f.rf set/images/f-0005.png set/images/f-0006.png -o y $quick
says err 'f-0005: '
says err '2 of 2 photographs were not parsed'
says err '.sg:[0-9]*: error: deriving S: the parts of a split are larger than its scope'
expect 3 parse-facade tall.sg -u f.rf set/images/f-0005.png -o y --method exact
# one that makes no label scene at all
printf 'start A\nrule A -> draw(1)\n' >walk.sg
expect 1 parse-facade walk.sg -u f.rf set/images/f-0005.png -o y
says err '.sg:2: error: deriving .*A: .* no place in a label scene'

# ---- usage ----
image=set/images/f-0005.png
expect 2 parse-facade g.sg -u f.rf -o y
expect 2 parse-facade g.sg $image -o y
expect 2 parse-facade g.sg -u f.rf -p npy $image -o y
expect 2 parse-facade g.sg -u f.rf $image
expect 2 parse-facade g.sg -u f.rf $image other/f-0005.jpg -o y
says err "two photographs are called f-0005"
expect 2 parse-facade g.sg -u f.rf $image -o y --fold 1
expect 2 parse-facade g.sg -u f.rf set -o y --fold 1 --names list
expect 2 parse-facade g.sg -u f.rf set -o y --part test
expect 2 parse-facade g.sg -u f.rf $image -o y --method exact --start exact
expect 2 parse-facade g.sg -u f.rf $image -o y --formats labels,sound
expect 2 parse-facade g.sg -u f.rf $image -o y --share turn=1
expect 2 parse-facade g.sg -u f.rf $image -o y --share shift
expect 2 parse-facade g.sg -u f.rf $image -o y --share jump-fresh=0 --share jump-copy=0 --share resample=0 --share reflect=0 \
    --share shift=0 --share switch=0
expect 2 parse-facade g.sg -u f.rf $image -o y --method exact --start prior
expect 2 parse-facade g.sg -u f.rf $image -o y --hard=0.1
says err '^parse-facade: --hard 0.1: with'
expect 2 parse-facade g.sg -u f.rf $image -o y --hard=1
expect 2 parse-facade g.sg -u f.rf $image -o y --floor 0.5
says err '^parse-facade: --floor 0.5: with'
expect 2 parse-facade g.sg -u f.rf $image -o y --burn-in 1
expect 0 parse-facade --help
says out '^Example: parse-facade'

# ---- outputs ----
echo file >file
for folder in file file/x /proc/nothing; do expect 4 parse-facade g.sg -u f.rf $image -o $folder; done
# shellcheck disable=SC2086
[ ! -w /dev/full ] || expect 4 parse-facade g.sg -u f.rf $image -o y $quick --json /dev/full
# shellcheck disable=SC2086
[ ! -w /dev/full ] || expect 4 sh -c "parse-facade g.sg -u f.rf $image -o y $quick >/dev/full"
# shellcheck disable=SC2086
(ulimit -f 1; parse-facade g.sg -u f.rf $image set/images/f-0006.png -o small $quick) >out 2>err
[ $? = 4 ] || fail 'a file size limit is no failure of the system'
[ -z "$(find small -name '.*' -type f)" ] || fail 'a temporary file is left'
# no input is written over, and no result by another
mkdir self; cp $image self; cp f.rf self/f-0005.json
expect 2 parse-facade g.sg -u f.rf self/f-0005.png -o self
says err 'self/f-0005.png: this is read'
expect 2 parse-facade g.sg -u self/f-0005.json $image -o self --formats derivation
same self/f-0005.json f.rf
cp npy/f-0005.npy npy/f-0005.overlay.npy
expect 2 parse-facade g.sg -p npy f-0005 f-0005.overlay -o y
says err 'y/f-0005.overlay.png: two results would be this file'
expect 2 parse-facade g.sg -p npy f-0005 -o y --json npy/classes.tsv
for json in fresh/f-0005.json ./fresh/f-0005.trace.tsv npy/../fresh//classes.tsv; do
    expect 2 parse-facade g.sg -p npy f-0005 -o fresh --json $json
    says err 'two results would be this file'
done
absent fresh

# ---- signals ----
parse-facade g.sg -u f.rf set -o stopped --iterations 1000000000 --runs 2 --chains 2 --quiet --json stopped.json >out 2>err &
pid=$!
for _ in $(seq 100); do [ -e stopped/classes.tsv ] && break; sleep 0.1; done
sleep 2
kill -INT $pid
wait $pid
[ $? = 5 ] || fail 'an interrupted run does not end with 5'
[ -s stopped/f-0001.png ] && [ -s stopped/f-0001.json ] || fail 'the best so far was not written'
absent stopped/f-0002.png
holds stopped.json "len(d) == 1 and d[0]['stopped'] and d[0]['energy'] < 1e6"
# before anything is parsed
mkfifo pipe
parse-facade g.sg -u f.rf pipe set/images/f-0005.png -o early --quiet >out 2>err &
pid=$!
for _ in $(seq 100); do [ -e early/classes.tsv ] && break; sleep 0.1; done
kill -INT $pid
timeout 10 sh -c 'echo nothing >pipe'
wait $pid
[ $? = 5 ] || fail 'an early interrupt does not end with 5'
says err 'stopped before a photograph was parsed'
if grep -q 'is written' err; then fail 'nothing was written'; fi
# killed at any moment: what is there is whole
# shellcheck disable=SC2086
expect 0 parse-facade g.sg -u f.rf set -o whole $quick
for delay in 0.05 0.1 0.2 0.3 0.5; do
    rm -rf killed
    # shellcheck disable=SC2086
    parse-facade g.sg -u f.rf set -o killed $quick >/dev/null 2>&1 &
    pid=$!
    sleep $delay
    kill -KILL $pid 2>/dev/null
    wait $pid 2>/dev/null
    [ ! -d killed ] || for file in killed/*; do [ ! -e "$file" ] || same "$file" "whole/${file#killed/}"; done
done

$have_python || echo "without python3 the numbers were not looked at"
[ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
echo "parse-facade does what it says"
