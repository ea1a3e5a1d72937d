#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# learn-grammar as a program: lattices and a data set made here, exit statuses, bad input, threads, signals.
set -u
program=${SG_BUILD_DIR:-.}/learn/learn-grammar
print=${SG_BUILD_DIR:-.}/src/print-grammar
import=${SG_BUILD_DIR:-.}/data/import-labels
. "${SG_SOURCE_DIR:-.}/tests/shell_support.sh"

valid() { "$print" "$1" >out 2>err || fail "$1 is no valid grammar"; }

# lattices FOLDER N: facades of sky, floors of windows with or without balconies, a shop
lattices() {
    mkdir "$1"
    k=1
    while [ $k -le "$2" ]; do
        awk -v k=$k 'BEGIN {
            w = 3 + 2 * (k % 3); f = 2 + k % 2
            print "lattice", w, 2 + 2 * f
            for (y = 0; y < 2 + 2 * f; y++) {
                line = ""
                for (x = 0; x < w; x++) {
                    c = "wall"
                    if (y == 0) c = "sky"
                    else if (y == 1 + 2 * f) c = "shop"
                    else if (x % 2 == 1) c = y % 2 == 1 ? "window" : ((k + int(y / 2)) % 3 ? "balcony" : "wall")
                    if ((k * 7 + x * 3 + y * 5) % 53 == 0) c = "wall"
                    line = line (x ? " " : "") c
                }
                print line
            }
        }' >"$1/f$k.lat"
        k=$((k + 1))
    done
}

lattices lat 12
expect 0 "$program" lat -o g.sg
says err 'non-terminals'
valid g.sg
expect 0 "$program" lat -o g2.sg --quiet
[ ! -s err ] || fail "--quiet is not quiet"
cmp -s g.sg g2.sg || fail "the same run gives another grammar"
expect 0 "$program" lat -o - --quiet
cmp -s out g.sg || fail "standard output has another grammar"

# The same bytes with any number of threads, and whatever the search
for option in "--search lookahead" "--search beam --beam 3" "--search anneal --walks 2" "--chunk" "--reestimate every" \
    "--data-term viterbi --alpha 1.5" "--length-prior none" "--share none" "--share collapsed" "--no-regroup" \
    "--regroup pairs --compatible labels" "--tied" "--concentration pooled,1000" "--concentration 20" "--weight 2" "--weight 0" "--max-images 0" "--max-images 1"; do
    # shellcheck disable=SC2086
    expect 0 "$program" lat -o one.sg --json one.json --initial one0.sg --threads 1 $option
    # shellcheck disable=SC2086
    expect 0 "$program" lat -o two.sg --threads 2 $option
    cmp -s one.sg two.sg || fail "threads change the grammar with '$option'"
    valid one.sg
    valid one0.sg
done
expect 0 "$program" lat -o tied.sg --tied
says tied.sg tied

# JSON: the fields that are relied on, and that the energy is what its parts say
expect 0 "$program" lat -o g.json --json r.json --data-term viterbi --alpha 2 --weight 0.5
valid g.json
for field in energy initial_energy log_likelihood log_structure_prior log_parameter_prior weight nonterminals rules_x \
    rules_y rules_lexical merges seconds merged grammar initial; do
    says r.json "^ \"$field\":"
done
awk '/^ "/ { sub(/,$/, "", $2); v[$1] = $2 }
    END { d = v["\"energy\":"] + v["\"weight\":"] * (v["\"log_structure_prior\":"] + v["\"log_parameter_prior\":"]) + v["\"log_likelihood\":"]
          exit !(d < 1e-6 && d > -1e-6 && v["\"log_parameter_prior\":"] != 0) }' r.json || fail "the energy is not that of its parts"

# Report
expect 0 "$program" lat -o g.sg --report deep/report
for file in index.html grammar.svg lattices/f1.png samples/1.png; do
    [ -s "deep/report/$file" ] || fail "the report has no $file"
done
if grep -qi 'https\{0,1\}://' deep/report/index.html && grep -i 'https\{0,1\}://' deep/report/index.html | grep -qv 'www.w3.org'; then
    fail "the report needs the network"
fi

# A data set, its folds and names
if [ -x "$import" ]; then
    mkdir maps
    for k in 1 2 3; do
        awk -v k=$k 'BEGIN { for (y = 0; y < 30; y++) { line = ""; for (x = 0; x < 40; x++)
            line = line (y < 6 ? 2 : y >= 24 ? 3 : (x % (8 + k) < 4 && y % 9 > 3 ? 0 : 1)); print line } }' >"maps/m$k.txt"
    done
    printf '0\twindow\t#ff0000\n1\twall\t#ffff00\n2\tsky\t#80ffff\n3\tshop\t#00ff00\n' >classes.tsv
    expect 0 "$import" digits maps -o set --classes classes.tsv
    expect 0 "$program" set -o set.sg --report setreport
    valid set.sg
    says set.sg 'label window #ff0000'
    mkdir set/folds
    printf 'm2\ttrain\nm1\ttest\n' >set/folds/1.tsv
    expect 0 "$program" set -o fold.sg --fold 1 --cells 30
    says err '1 lattices'
    printf 'm3\nm1\n' >names
    expect 0 "$program" set -o named.sg --names names --accuracy 0.95
    says err '2 lattices'
    expect 3 "$program" set -o x.sg --fold 2
    cp -r set bad
    printf 'no picture' >bad/labels/m1.png
    head -c 60 set/labels/m2.png >bad/labels/m2.png
    expect 3 "$program" bad -o x.sg
    says err 'm1.png'
    says err 'm2.png'
    mkdir empty empty/labels
    cp classes.tsv empty
    expect 3 "$program" empty -o x.sg
fi

# Small input: one lattice, one class, one cell
mkdir single
printf 'lattice 1 1\nwall\n' >single/a.lat
expect 0 "$program" single -o single.sg --report singlereport
valid single.sg
mkdir plain
printf 'lattice 3 2\nwall wall wall\nwall wall wall\n' >plain/a.lat
printf 'lattice 2 1\nwall wall\n' >plain/b.lat
for option in "" "--search beam" "--chunk" "--reestimate every --weight 3"; do
    # shellcheck disable=SC2086
    expect 0 "$program" plain -o plain.sg $option
    valid plain.sg
done

# Usage
expect 0 "$program" --help
says out 'learn-grammar'
expect 0 "$program" --version
for bad in "" "lat" "lat lat -o x.sg" "lat -o x.sg --weight -1" "lat -o x.sg --weight nan" "lat -o x.sg --alpha 0" \
    "lat -o x.sg --share some" "lat -o x.sg --search best" "lat -o x.sg --data-term viterbi --alpha 0.5" \
    "lat -o x.sg --cells 3 --accuracy 0.5" "lat -o x.sg --fold 1 --names n" "lat -o - --json -" "lat -o x.sg --max-images x" \
    "lat -o x.sg --concentration 1,x" "lat -o x.sg --concentration -3" "lat -o x.sg --concentration 1,2,3" \
    "lat -o x.sg --nothing" "lat -o x.sg --json ./x.sg" "lat -o lat/../x.sg --initial x.sg" "lat -o y.sg --initial x.sg --json .//x.sg" \
    "lat -o x/index.html --report x" "lat -o x.sg --report x --json lat/../x/grammar.svg"; do
    # shellcheck disable=SC2086
    expect 2 "$program" $bad
done
absent x.sg

# Bad input
expect 3 "$program" nowhere -o x.sg
says err nowhere
mkdir nothing
expect 3 "$program" nothing -o x.sg
says err 'nothing'
expect 3 "$program" lat -o x.sg --fold 1
expect 3 "$program" lat -o x.sg --names nowhere
cp -r lat broken
printf 'lattice 2 2\nwall wall\nwall\n' >broken/f5.lat
expect 3 "$program" broken -o x.sg
says err 'f5.lat:3'
printf '0\twall\t#ffff00\n' >few.tsv
expect 3 "$program" lat -o x.sg --classes few.tsv
absent x.sg

# The system fails
expect 4 "$program" lat -o nowhere/x.sg
expect 4 "$program" lat -o x.sg --json nowhere/x.json
absent x.sg
touch file
expect 4 "$program" lat -o x.sg --report file
if [ -e /dev/full ]; then
    expect 4 "$program" lat -o /dev/full
    says err '/dev/full'
    expect 4 "$program" lat -o x.sg --json /dev/full
    "$program" lat -o - --quiet >/dev/full 2>err
    [ $? -eq 4 ] || fail "a full standard output is no failure"
fi
rm -f x.sg
(ulimit -f 0 && "$program" lat -o small.sg >out 2>err)
[ $? -eq 4 ] || fail "a file size limit is no failure"
absent small.sg
[ -z "$(find . -name '.*.??????')" ] || fail "something is left behind: $(find . -name '.*.??????')"

# A signal ends a search that would take long: 5, with the best so far
lattices many 150
"$program" many -o stopped.sg --max-images 0 --share none --search beam --beam 200 --report stoppedreport --json stopped.json \
    --quiet >out 2>err &
pid=$!
sleep 1
kill -INT $pid
wait $pid
[ $? -eq 5 ] || fail "SIGINT gives another status"
valid stopped.sg
says stopped.json '"energy"'

# A kill leaves nothing half
"$program" many -o killed.sg --max-images 0 --share none --search beam --beam 200 --quiet >out 2>err &
pid=$!
sleep 0.5
kill -KILL $pid
wait $pid 2>/dev/null
absent killed.sg

[ $failures -eq 0 ] || { echo "$failures failures"; exit 1; }
echo "learn-grammar does what its page says"
