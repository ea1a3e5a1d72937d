#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Every program against bad input, clumsy users and full disks: the right exit status, a message that names the file, no
# half file, no input written over, the same bytes from any number of threads. The tests of each program go deeper.
set -u
: "${SG_BUILD_DIR:?}" "${SG_SOURCE_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
PATH=$SG_BUILD_DIR/data:$SG_BUILD_DIR/parse:$SG_BUILD_DIR/learn:$SG_BUILD_DIR/src:$PATH
programs="import-labels make-lattice learn-grammar parse-lattice print-grammar sample-grammar learn-unaries apply-unaries"

none_half() { # FOLDER: no temporary and no empty file
    left=$(find "$1" -type f \( -name '.*' -o -size 0 \))
    [ -z "$left" ] || fail "left behind: $left"
}
bytes() { printf '%b' "$1" >"$2"; } # octal escapes

# ---- a small data set, its lattices and its grammar ----
mkdir maps
for k in 1 2 3; do
    awk -v k=$k 'BEGIN { for (y = 0; y < 30; y++) { s = ""
        for (x = 0; x < 24; x++) s = s (y < 4 ? 0 : (x % 8 >= 2 && x % 8 < 4 + k && y % 9 >= 5) ? 2 : 1)
        print s } }' >maps/f$k.txt
done
printf '0\tsky\t#0000ff\n1\twall\t#ffff00\n2\twindow\t#ff0000\n3\tignore\t#000000\n' >c.tsv
expect 0 import-labels digits maps --classes c.tsv -o set
expect 0 make-lattice set -o lat
expect 0 learn-grammar set -o g.sg
expect 0 learn-grammar set -o g.json
[ $failures -eq 0 ] || exit 1
cp -r set set.kept; cp -r lat lat.kept; cp g.sg g.kept

# ---- usage ----
for p in $programs; do
    expect 0 "$p" --help
    [ "$(head -c 8 out)" = 'Example:' ] || fail "$p --help does not begin with an example"
    expect 0 "$p" --version
    says out "^$p (shapegram) "
    expect 2 "$p"
    says err "Try '$p --help'"
    expect 2 "$p" --no-such-option
    for option in --help --version; do
        expect 4 sh -c "$p $option >/dev/full"
    done
done
for number in nan inf -1 1e999 '' 5x 99999999999999999999; do
    expect 2 make-lattice set -o x --mu "$number"
    expect 2 sample-grammar g.sg -o x --seed "$number"
    expect 2 sample-grammar g.sg -o x --size "${number}x3"
done
expect 2 learn-grammar set -o x.sg --weight nan
expect 2 learn-grammar set -o x.sg --max-images -1
expect 2 parse-lattice g.sg lat/f1.lat --em 0
expect 2 import-labels rgb maps --classes c.tsv -o x --tolerance inf
expect 2 sample-grammar g.sg -o x --seed 18446744073709551615
expect 2 make-lattice set -o x --part test
expect 2 make-lattice set -o x --cells 3 --mu 4
expect 2 learn-grammar set -o x.sg --initial x.sg
expect 2 learn-grammar set -o x.sg --json x.sg
expect 2 learn-grammar set lat -o x.sg
expect 2 print-grammar g.sg --json --dot
expect 2 print-grammar g.sg g.sg
expect 2 import-labels digits maps --classes c.tsv -o ''
expect 2 import-labels pictures maps --classes c.tsv -o x
expect 2 sample-grammar g.sg -o x --name a/b
absent x; absent x.sg

# ---- no run writes over what it reads ----
expect 2 parse-lattice --mode region g.sg lat/f1.lat --em 1 -o g.sg
expect 2 parse-lattice --mode region g.sg lat/f1.lat lat/f2.lat --json lat/f2.lat
expect 2 print-grammar g.sg -o g.sg
expect 2 learn-grammar lat -o ./lat/f1.lat
expect 2 learn-grammar set -o set/labels/f1.png
expect 2 learn-grammar set -o y.sg --initial set/classes.tsv
expect 2 learn-grammar set -o y.sg --json set/classes.tsv
expect 2 make-lattice set -o set/labels --pictures
expect 2 make-lattice set -o x --json set/labels/f2.png
expect 2 sample-grammar g.sg -o x --json g.sg
expect 2 import-labels digits maps --classes c.tsv -o x --json maps/f1.txt
expect 2 import-labels digits maps --classes c.tsv -o x --json c.tsv
cp g.sg learned-0001.json
expect 2 sample-grammar learned-0001.json -o .
diff -r set set.kept >/dev/null && diff -r lat lat.kept >/dev/null && cmp -s g.sg g.kept || fail 'an input was written over'
absent y.sg

# ---- outputs that cannot be written ----
echo file >file
for bad in /dev/full none/out lat ''; do
    expect 4 learn-grammar set -o "$bad"
    expect 4 print-grammar g.sg -o "$bad"
    expect 4 parse-lattice g.sg lat/f1.lat --mode region --json "$bad"
    [ "$bad" != /dev/full ] || says err '/dev/full: No space left on device'
    expect 4 make-lattice set -o x --json "$bad"
    expect 4 import-labels digits maps --classes c.tsv -o x --json "$bad"
    expect 4 sample-grammar g.sg -o x --json "$bad"
done
for folder in file file/x /proc/nothing ''; do
    expect 4 make-lattice set -o "$folder"
    expect 4 sample-grammar g.sg -o "$folder"
    expect 4 learn-grammar set -o y.sg --report "$folder"
done
expect 4 import-labels digits maps --classes c.tsv -o file
says err 'file: Not a directory'
for command in 'print-grammar g.sg' 'learn-grammar set -o -' 'parse-lattice g.sg lat/f1.lat --mode region' 'make-lattice set -o x'; do
    expect 4 sh -c "$command >/dev/full"
    says err 'standard output: No space left on device'
    expect 4 sh -c "$command >&-"
    (trap '' PIPE; $command; echo $? >status) 2>err | : # the reader is gone, or takes too little to notice
    case $(cat status) in 0 | 4) ;; *) fail "status $(cat status) after the reader left: $command" ;; esac
done
expect 3 sh -c 'print-grammar - <&-'
expect 0 sh -c 'learn-grammar set -o closed.sg --report closed <&- >&- 2>&-'
same closed.sg g.sg
printf 'old' >old
for blocks in 0 1; do
    (ulimit -f $blocks; print-grammar g.json -o old) >/dev/null 2>err
    [ $? = 4 ] || fail "print-grammar under a file size limit"
    [ "$(cat old)" = old ] || fail 'a file size limit changed the output'
    mkdir -p limited
    (ulimit -f $blocks; make-lattice set -o limited/l --pictures | cat; learn-grammar set -o limited/l.sg --report limited/r
        sample-grammar g.sg -o limited/s; import-labels digits maps --classes c.tsv -o limited/i) >/dev/null 2>&1
    none_half limited
done

# ---- inputs that are not there, or something else ----
for bad in none maps g.sg ''; do
    expect 3 make-lattice "$bad" -o x
    expect 3 learn-grammar "$bad" -o y.sg
done
for bad in none lat /dev/null lat/f1.lat; do
    expect 3 print-grammar "$bad"
    expect 3 sample-grammar "$bad" -o x
    expect 3 parse-lattice "$bad" lat/f1.lat
    [ "$bad" = lat/f1.lat ] || expect 3 parse-lattice g.sg lat/f2.lat "$bad"
    expect 3 import-labels digits maps --classes "$bad" -o y
    expect 3 learn-grammar set -o y.sg --names "$bad"
    expect 3 make-lattice set -o y --classes "$bad"
done
expect 3 make-lattice set -o y --fold 1
expect 3 learn-grammar lat -o y.sg --fold 1
expect 3 import-labels digits maps --classes c.tsv -o y --images none
expect 3 import-labels digits lat --classes c.tsv -o y
absent y; absent y.sg

# ---- grammars ----
head='label a #ff0000 label b #00ff00 start S '
bad_grammar() { # LINE:COL GRAMMAR
    printf '%s' "$2" >bad.sg
    expect 3 print-grammar bad.sg
    says err "bad.sg:$1: error: "
}
bad_grammar 1:1 ''
bad_grammar 1:51 "${head}rule S -> 0.5 : a -> 0.4 : b"
bad_grammar 1:62 "${head}rule S -> 1.5 : a -> -0.5 : b"
bad_grammar 1:51 "${head}rule S -> nan : a"
bad_grammar 1:51 "${head}rule S -> 1e999 : a"
bad_grammar 1:46 "${head}rule S -> S"
bad_grammar 1:58 "${head}rule S -> a rule U -> b"
bad_grammar 1:51 "${head}rule S -> X"
bad_grammar 1:80 "${head}rule S -> split x { a | b } sizes mean (0.5, 0.6) sd (0.1, 0.1)"
bad_grammar 1:95 "${head}rule S -> split x { a | b } sizes mean (0.5, 0.5) sd (nan, 0.1)"
bad_grammar 1:307 "${head}rule S -> $(printf '%0500d' 0 | tr 0 '(')"
expect 3 sample-grammar bad.sg -o y
expect 3 parse-lattice bad.sg lat/f1.lat
bytes 'label a\nrule S -> \377' bad.sg
expect 3 print-grammar bad.sg
says err 'bad.sg:2:11: error: byte 0xff is no UTF-8'
# hostile ones: refused before time, stack or memory run out
many() { seq 1 "$1" | sed "s;.*;$2;" | tr -d '\n'; } # N TEXT: & is the number
hostile() { # MESSAGE: of bad.sg
    expect 3 print-grammar bad.sg
    says err "bad.sg:.*$1"
    expect 3 sample-grammar bad.sg -o y
    says err "bad.sg:.*$1"
    absent y
}
head -c 100000000 /dev/zero | tr '\000' '#' >bad.sg
hostile 'larger than the 16777216 bytes'
(printf '%s' "${head}rule S -> "; many 10000 '[') >bad.sg
hostile '1:307: error: brackets nested more than 256 deep'
(printf '%s' "${head}rule S -> "; many 10000 'split x {') >bad.sg
hostile 'brackets nested more than 256 deep'
(printf '%s' "${head}rule S -> "; many 100000 '-') >bad.sg
hostile 'nested too deep'
(printf '%s' "${head}rule S -> "; many 100000 '1+'; echo 1:a) >bad.sg
hostile 'an expression of more than 1000 levels'
(echo 'function f0(x) = x'; many 60 'function g&(x) = x + x '; echo 'const c = g61(1)') >bad.sg
hostile "unknown function or distribution 'g61'"
(printf '%s' "${head}rule S(p"; many 20000 ', p&'; echo ') -> a') >bad.sg
hostile 'more than 1000 parameters'
(printf '%s' "${head}rule S -> "; many 20000 'd& ~ uniform(0, 1) '; echo 'a') >bad.sg
hostile 'more than 1000 draws in a rule'
(printf '%s' "tied ${head}rule T(x) -> a rule S -> split x { a"; many 20000 '| T(&)'; echo '}') >bad.sg
hostile 'more than 5000 different successors'
(printf '%s' "${head}rule S -> split x { a"; many 3000 '| b'; printf '} sizes mean (0'; many 3000 ', 1'; printf ') sd (0'; many 3000 ', 1'; echo ')') >bad.sg
hostile 'sizes for 3001 parts'
(printf '%s' "${head}rule S -> "; many 100000 9; echo ': a') >bad.sg
hostile 'is out of the range of numbers'
echo "${head}limit depth 1e300 rule S -> a" >bad.sg
hostile 'the depth limit must be a whole number'
echo "${head}function f(x) = f(x) rule S -> f(1) : a" >bad.sg
hostile "'f'"
echo "${head}rule S -> split x { S | S }" >bad.sg
hostile "'S' is unproductive"
printf 'label a start S \355\240\200' >bad.sg
hostile 'is no UTF-8'
printf 'label a start S \000 rule S -> a' >bad.sg
hostile 'control character 0x00'
many 10000 '[' >bad.sg
hostile "1:1: error: found '\\['"
many 10000 '{"a":' >bad.sg
hostile 'maximum parsing depth reached'
many 100000 '[],' | sed 's/^/{"a":[/; s/$/[]]}/' >bad.sg
hostile '"format" is missing'
(printf '%s' "${head}rule S -> "; many 10000 '('; printf 1; many 10000 ')'; echo ': a') >bad.sg
hostile '1:307: error: brackets nested more than 256 deep'
(printf '%s' "${head}rule S -> "; many 10000 'repeat x 2 {'; printf a; many 10000 '}') >bad.sg
hostile 'brackets nested more than 256 deep'
(printf '%s' "${head}rule S -> draw("; many 10000 'sin('; printf 1; many 10000 ')') >bad.sg
hostile 'brackets nested more than 256 deep'
echo "${head}rule S -> repeat x 1e9 { a }" >bad.sg
hostile '1:60: error: the repeat count is 1e+09; expected a number from 0 to 1000000'
echo "${head}rule S -> draw(1e-999)" >bad.sg
hostile '1e-999 is too small'
echo "${head}rule S -> draw(1e308 * 10)" >bad.sg
hostile '1:56: error: an argument is not finite: its value is inf'
printf 'label a\nlabel \303(' >bad.sg
hostile '2:7: error: byte 0xc3 is no UTF-8'
printf 'label a\nlabel \364\220\200\200' >bad.sg
hostile '2:7: error: byte 0xf4 is no UTF-8'
# recursion without end: known when read, or stopped in the run with the path that it took
echo 'label a start S(1) rule S(x) if x > 0 -> split x { S(x + 1) | a } rule S(x) if x <= 0 -> a' >bad.sg
hostile "1:25: error: 'S' is unproductive: no choice of its rules that can be used ever ends"
echo 'label a limit depth 5 start S rule S -> S rule S at limit -> split x { S | S }' >bad.sg
hostile "this rule 'at limit' of 'S' never ends"
cat >endless.sg <<'END'
label a
start S(1)
rule S(x) if x > 0 -> step ~ normal(3, 1) split x { S(x + step) | a }
rule S(x) if x <= 0 -> a
END
expect 0 print-grammar endless.sg
expect 1 sample-grammar endless.sg -o endless --max-nodes 100000
says err 'endless.sg:3: error: deriving S(1) > S(.*) > ([0-9]* more) > .*: more than 100000 nodes'
[ -z "$(find endless -name '*-0001*')" ] || fail 'a run that failed left something'
echo 'label a start S rule S -> 0.7 : split x { S | S } -> 0.3 : a' >endless.sg
expect 1 sample-grammar endless.sg -n 8 -o endless --max-nodes 100000
says err 'endless.sg:1: error: deriving S > S > S > ([0-9]* more) > .*: more than 100000 nodes'
# warnings change neither what is written nor the status
echo 'label a start S rule S -> u ~ uniform(0, 1) T(u) rule T(u) -> u - 0.001 : a -> 1 : a rule T(u) if u > 1 -> a' >odd.sg
expect 0 print-grammar odd.sg
says err 'print-grammar: odd.sg:1:99: warning: this guard never holds, as u is from 0 to 1'
says out 'rule T(u)'
expect 0 sample-grammar odd.sg -o odd
says err 'sample-grammar: odd.sg:1:99: warning: '
echo 'label a start S rule S -> repeat x 1e6 { repeat y 1e6 { repeat x 0 { T } } } rule T -> a' >endless.sg
expect 1 sample-grammar endless.sg -o endless
says err 'its repeats place more than 16777216 blocks'
bad_exchange() { # SED
    sed "$1" g.json >bad.json
    if cmp -s bad.json g.json; then fail "nothing changed by $1"; fi
    expect 3 print-grammar bad.json
    says err 'bad.json:'
}
bad_exchange 's/"version": 1/"version": 2/'
bad_exchange 's/"axiom": "S"/"axiom": 5/'
bad_exchange 's/"axiom": "S"/"axiom": "Q"/'
bad_exchange 's/"probability": 1/"probability": 0.7/'
bad_exchange 's/"probability": 1/"probability": NaN/'
bad_exchange 's/"probability": 1/"probability": null/'
bad_exchange 's/"rules": \[/"rules": [1,/'
bad_exchange 's/"terminals": \[/"terminals": [[],/'
bad_exchange 's/"op": "split-y"/"op": "split-z"/'
bad_exchange '$d'
printf '{"a":%.0s' $(seq 5000) >bad.json
expect 3 print-grammar bad.json

# ---- lattices ----
bad_lattice() { # LINE:COL LATTICE
    bytes "$2" bad.lat
    expect 3 parse-lattice g.sg lat/f1.lat bad.lat
    says err "bad.lat:$1: error: "
}
bad_lattice 1:1 ''
bad_lattice 1:9 'lattice 0 1\n'
bad_lattice 1:9 'lattice 99999999999 1\n'
bad_lattice 1:9 'lattice nan 1\n'
bad_lattice 2:2 'lattice 2 1\na\n'
bad_lattice 2:4 'lattice 2 2\na b\n'
bad_lattice 2:7 'lattice 2 1\nx 0 5 5\ny 0 1\na b\n'
bad_lattice 2:3 'lattice 2 1\na \0377\n'
bad_lattice 2:3 'lattice 2 1\na \0000\n'
printf 'lattice 1 1\nmoon\n' >outside.lat
expect 1 parse-lattice g.sg outside.lat lat/f1.lat --mode region --json out.json
says out.json '"log_inside": null'
[ "$(grep -c '"lattice"' out.json)" = 2 ] || fail 'one lattice outside the language stops the others'
expect 1 parse-lattice g.sg outside.lat --em 3 -o y.sg
absent y.sg
# labels may be called what learned symbols are called
mkdir named; printf 'lattice 4 2\nS R1 C1 K1\nR1 C1 S S\n' >named/a.lat
expect 0 learn-grammar named -o named.sg --chunk --report named.report
expect 0 print-grammar named.sg
# a lattice of many pixels is drawn smaller
mkdir vast; printf 'lattice 2 1\nx 0 1 2000000000\ny 0 3\na b\n' >vast/a.lat
expect 0 learn-grammar vast -o y.sg --report vast.report
rm y.sg

# ---- data sets; PNG chunks are written by hand ----
png() { # WIDTH HEIGHT DEPTH COLOUR-TYPE FILE: a header that promises more than the file holds; no byte may be over 127
    bytes "\\0211PNG\\r\\n\\032\\n\\0000\\0000\\0000\\015IHDR$1$2\\00$3\\00$4\\0000\\0000\\0000\\0000\\0000\\0000\\0000" "$5"
}
variant() { rm -rf bad; cp -r set.kept bad; }
bad_set() { # TEXT: both programs say it, and nothing is written
    expect 3 make-lattice bad -o y
    says err "$1"
    expect 3 learn-grammar bad -o y.sg
    says err "$1"
    absent y; absent y.sg
}
variant; rm bad/labels/*; bad_set 'the data set is empty'
variant; head -c 60 set/labels/f1.png >bad/labels/f1.png; : >bad/labels/f2.png; echo x >bad/labels/f3.png; bad_set 'f1.png: the file is truncated'
says err 'f2.png: the file is empty'; says err 'f3.png: no PNG file'; says err '3 faults'
variant; png '\0177\0000\0000\0000' '\0177\0000\0000\0000' 10 0 bad/labels/f1.png; bad_set 'f1.png'
variant; sed -i '/wall/d' bad/classes.tsv; bad_set 'label 1 is not in the class table'
variant; printf '0\tx\n' >bad/classes.tsv; bad_set 'classes.tsv:1:1: error: '
variant; bytes '0\t\0377\t#000000\n' bad/classes.tsv; bad_set 'one word of UTF-8'
variant; mkdir bad/images; cp set/labels/f1.png bad/images/f1.png; echo x >bad/images/f2.jpg; expect 0 make-lattice bad -o x
variant; mkdir bad/folds; printf 'f1\ttrain\nf1\ttest\n../f2\ttrain\nf3\n' >bad/folds/1.tsv
expect 3 make-lattice bad -o y --fold 1
says err '1.tsv:2:1: error: '; says err '1.tsv:3:1: error: '; says err '1.tsv:4:1: error: '
variant; rm bad/labels/f2.png bad/labels/f3.png; mv bad/labels/f1.png "bad/labels/-- a b.png"
expect 0 make-lattice bad -o x --json out.json
expect 0 learn-grammar bad -o one.sg --report one
expect 0 parse-lattice one.sg "x/-- a b.lat" --mode region
long=$(printf '%0250d' 7); variant; mv bad/labels/f1.png "bad/labels/$long.png"
expect 0 make-lattice bad -o x
[ -e "x/$long.lat" ] || fail 'a long name has no lattice'
mkdir tiny; echo 1 >tiny/a.txt
expect 0 import-labels digits tiny --classes c.tsv -o tiny.set # one image, one class, one pixel
variant; mkdir bad/images; cp tiny.set/labels/a.png bad/images/f2.png; bad_set 'images/f2.png: 1 x 1 pixels, but bad/labels/f2.png has 24 x 30'
expect 0 make-lattice tiny.set -o tiny.lat --loss --pictures
expect 0 learn-grammar tiny.set -o tiny.sg --report tiny.report
expect 0 sample-grammar tiny.sg -o tiny.samples --size 1x1
expect 0 parse-lattice tiny.sg tiny.lat/a.lat

# ---- imports ----
bad_import() { # KIND SUFFIX TEXT MESSAGE
    rm -rf one; mkdir one; bytes "$3" one/a.$2
    expect 3 import-labels "$1" one --classes c.tsv -o y
    says err "$4"
    absent y
}
bad_import digits txt '' 'no values'
bad_import digits txt '01\n0\n' 'a.txt:2:2: error: '
bad_import digits txt '01\n09\n' '9 (1 pixel, the first at column 1, row 1)'
bad_import matrix txt '0 1.5\n' 'a.txt:1:3: error: '
bad_import matrix txt '0 nan\n' 'a.txt:1:3: error: '
bad_import labelme json '{"imageWidth":5,"imageHeight":5,"shapes":[1]}' 'shape 1'
bad_import labelme json '{' 'a.json:1:'
bad_import rgb png 'no png' 'no PNG file'
bad_import palette png '' 'the file is empty'
cp -r set/labels one.images
printf '00\n00\n' >one/f1.txt
expect 3 import-labels digits one --classes c.tsv -o y --images one.images
says err '2 x 2 pixels, but one.images/f1.png has 24 x 30'

# ---- same seed, same bytes, any number of threads ----
for n in 1 3; do
    mkdir t$n
    expect 0 make-lattice set -o t$n/lat --pictures --threads $n
    expect 0 learn-grammar set -o t$n/g.sg --initial t$n/i.sg --search beam --chunk --threads $n
    expect 0 learn-grammar set -o t$n/a.sg --search anneal --walks 2 --threads $n
    expect 0 parse-lattice g.sg lat/*.lat --mode region --derivation --threads $n
    cp out t$n/parsed
    expect 0 parse-lattice g.sg lat/*.lat --mode region --em 3 -o t$n/em.sg --threads $n
    expect 0 sample-grammar g.sg -n 6 -o t$n/samples --json t$n/samples.json --size 40x50 --threads $n
    expect 0 import-labels digits maps --classes c.tsv -o t$n/import --threads $n
done
diff -r t1 t3 >out 2>&1 || fail 'the number of threads changes the bytes'

if [ $failures -gt 0 ]; then echo "$failures failures"; fi
[ $failures -eq 0 ]
