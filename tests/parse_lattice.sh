#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# parse-lattice as a program: both grammar forms, both modes, derivations, JSON, re-estimation, exit statuses.
set -u
program=${SG_BUILD_DIR:-.}/parse/parse-lattice
. "${SG_SOURCE_DIR:-.}/tests/shell_support.sh"
have_python=false
if command -v python3 >/dev/null; then have_python=true; fi

# holds WHAT: the condition given as a Python expression over d, the JSON of `out`
holds() {
    $have_python || return 0
    python3 -c "
import json, math, sys
d = json.load(open('out'))
sys.exit(not ($1))" || { echo "FAIL: not so: $1"; cat out; failures=$((failures + 1)); }
}

cat >g.json <<'END'
{"format":"shapegram-grammar","version":1,"axiom":"S",
 "terminals":[{"name":"window","color":"#ff0000"},{"name":"wall","color":"#ffff00"}],
 "rules":[{"lhs":"S","op":"split-y","rhs":["R","S"],"probability":0.5},
          {"lhs":"S","op":"split-y","rhs":["R","R"],"probability":0.5},
          {"lhs":"R","op":"split-x","rhs":["A","B","A"],"probability":0.75},
          {"lhs":"R","op":"split-x","rhs":["A","A"],"probability":0.25},
          {"lhs":"A","op":"terminal","rhs":["wall"],"probability":1.0},
          {"lhs":"B","op":"terminal","rhs":["window"],"probability":1.0}]}
END
printf 'lattice 3 3\nx 0 10 30 40\ny 0 5 10 20\nwall window wall\nwall window wall\nwall window wall\n' >a.lat
printf 'lattice 2 2\nwall wall\nwall wall\n' >b.lat
printf 'lattice 2 2\nwall wall\nwall door\n' >c.lat
printf 'lattice 2 2\nwall wall\nwall\n' >bad.lat

expect 0 "$program" g.json a.lat b.lat
says out '^a.lat	-2.24934057848	-2.24934057848	'
says out '^b.lat	-3.4657359028	'
expect 0 "$program" g.json a.lat b.lat --json -
holds "[r['lattice'] for r in d] == ['a.lat', 'b.lat']"
holds "abs(d[0]['log_inside'] - math.log(.5 * .5 * .75 ** 3)) < 1e-12 and abs(d[0]['log_viterbi'] - d[0]['log_inside']) < 1e-12"
holds "all(r['states'] > 0 and r['seconds'] >= 0 for r in d)"

# outside the language: null for both, the others parsed, status 1
expect 1 "$program" g.json c.lat a.lat --json -
holds "d[0]['log_inside'] is None and d[0]['log_viterbi'] is None and d[1]['log_inside'] < 0"
says err 'c.lat is outside the language'
expect 1 "$program" g.json c.lat a.lat --derivation --json -
holds "d[0]['derivation'] is None and d[1]['derivation']['rect'] == [0, 0, 3, 3]"

# derivations: text and JSON; sizes come from the pixel boundaries
expect 0 "$program" g.json a.lat --derivation
says out '^S -> split-y  columns 1-3 rows 1-3$'
says out '^    B -> label window  columns 2-2 rows 1-1$'
expect 0 "$program" g.json a.lat --derivation --json -
holds "d[0]['derivation']['rule'] == 0 and d[0]['derivation']['sizes'] == [0.25, 0.75]"
holds "d[0]['derivation']['children'][0]['children'][1] == {'rule': 5, 'symbol': 'B', 'rect': [1, 0, 2, 1], 'label': 'window'}"

# regions: one derivation more for each way to cut the rows
expect 0 "$program" g.json a.lat --mode region --json -
holds "d[0]['log_inside'] > d[0]['log_viterbi'] and abs(d[0]['log_viterbi'] - math.log(.5 * .75 ** 2)) < 1e-12"

# re-estimation: the likelihood rises, the grammar that is written gives what was promised
expect 0 "$program" g.json a.lat b.lat --em 50 -o new.sg --mode region
$have_python && { python3 - <<'END' || { echo "FAIL: the likelihood fell"; cat out; failures=$((failures + 1)); }
rows = [l.split('\t') for l in open('out')]
trace = [float(r[1]) for r in rows if len(r) == 2 and r[0].isdigit()]
assert len(trace) > 2 and all(b >= a - 1e-9 for a, b in zip(trace, trace[1:]))
total = sum(float(r[1]) for r in rows if r[0].endswith('.lat'))
assert abs(total - trace[-1]) < 1e-8
END
}
grep '\.lat' out >promised
expect 0 "$program" new.sg a.lat b.lat --mode region
grep '\.lat' out >kept
same promised kept
expect 0 "$program" g.json b.lat --em 5 --em-mode viterbi --alpha 2
says out 'log_posterior'
expect 1 "$program" g.json a.lat c.lat --em 5 -o none.sg
says err 'lattice 2 is outside the language'
[ ! -e none.sg ] || { echo "FAIL: none.sg was written"; failures=$((failures + 1)); }

# one grammar in both forms, any number of threads: the same bytes
lattices=
for i in 1 2 3 4 5 6 7 8 9; do cp a.lat "a$i.lat"; cp b.lat "b$i.lat"; lattices="$lattices a$i.lat b$i.lat"; done
# shellcheck disable=SC2086
expect 0 "$program" g.json $lattices --derivation --threads 1
cp out one
# shellcheck disable=SC2086
expect 0 "$program" g.json $lattices --derivation --threads 7
same one out

# bad input
expect 3 "$program" g.json bad.lat
says err '^parse-lattice: bad.lat:3'
expect 3 "$program" g.json missing.lat
says err 'missing.lat'
expect 3 "$program" missing.sg a.lat
printf '{"format":"shapegram-grammar","version":1,"axiom":"S","terminals":[],"rules":[' >broken.json
expect 3 "$program" broken.json a.lat
says err '^parse-lattice: broken.json:1:'
expect 2 "$program" g.json
expect 2 "$program" g.json a.lat --mode pixel
expect 2 "$program" g.json a.lat --alpha 2
expect 2 "$program" g.json a.lat --em 0
expect 4 "$program" g.json a.lat --json /no/such/folder/x.json
[ ! -w /dev/full ] || expect 4 "$program" g.json a.lat --json /dev/full
[ ! -w /dev/full ] || { "$program" g.json a.lat >/dev/full 2>err; [ $? -eq 4 ] || { echo "FAIL: full disk"; failures=$((failures + 1)); }; }
expect 0 "$program" --help
says out '^Example: parse-lattice'
expect 0 "$program" --version

$have_python || echo "without python3 the numbers were not looked at"
[ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
echo "parse-lattice does what it says"
