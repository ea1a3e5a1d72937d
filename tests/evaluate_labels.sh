#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# evaluate-labels as a program: a worked example, classes by name, aliases, several folds, every fault at once, exit statuses.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
program=$SG_BUILD_DIR/parse/evaluate-labels
import=$SG_BUILD_DIR/data/import-labels
bytes() { printf '%b' "$1" >"$2"; }

# A data set of two folds: digits are pixel values. 0 window, 1 wall, 2 roof, 3 chimney, 9 ignored.
mkdir truth found
printf '0011\n0011\n2299\n' >truth/a.txt
printf '1111\n1111\n1111\n' >truth/b.txt
printf '0003\n' >truth/c.txt
printf '0\twindow\t#ff0000\n1\twall\t#ffff00\n2\troof\t#0000ff\n3\tchimney\t#808080\n9\tignore\t#000000\n' >all.tsv
printf '0\twindow\t#ff0000\n1\twall\t#ffff00\n2\troof\t#0000ff\n3\tignore\t#808080\n9\tignore\t#000000\n' >few.tsv
expect 0 "$import" digits truth --classes all.tsv -o set
mkdir set/folds
printf 'a\ttest\nb\ttrain\nc\ttest\n' >set/folds/1.tsv
printf 'a\ttrain\nb\ttest\nc\ttrain\n' >set/folds/2.tsv
# What was found, with a table of another order: 0 wall, 1 window, 2 chimney, 3 roof, 4 moon.
printf '1100\n1000\n3244\n' >found/a.txt
printf '0000\n0000\n0004\n' >found/b.txt
printf '1110\n' >found/c.txt
printf '0\twall\t#ffff00\n1\twindow\t#ff0000\n2\tchimney\t#808080\n3\troof\t#0000ff\n4\tmoon\t#00ff00\n' >other.tsv
expect 0 "$import" digits found --classes other.tsv -o maps.set
mv maps.set/labels maps && cp other.tsv maps/classes.tsv

# the truth against itself
expect 0 "$program" set set/labels
says out 'overall 100.00%   class average 100.00%   mean IoU 100.00%   3 maps, 26 pixels (2 more are ignored)'

# fold 1: eight of a's ten pixels are right, and three of c's four
expect 0 "$program" set maps --fold 1 --json scores.json
says out 'overall 78.57%   class average 58.93%   mean IoU 50.60%   2 maps, 14 pixels (2 more are ignored)'
says out '^window .* 85.7 .* 14.3 .* 7 '
says scores.json '"overall": 0.785714285714'
says scores.json '"chimney": 0.0'
# the published protocol: no chimney in the truth, a chimney that was found is roof
expect 0 "$program" set maps --fold 1 --classes few.tsv
says out 'other: 1 pixels that were found to be no class'
says out 'overall 84.62%'
expect 0 "$program" set maps --fold 1 --classes few.tsv --alias chimney=roof
says out 'overall 92.31%'
grep -q other: out && fail 'an alias is no other class'
# a table that is asked for: the values of the maps as the data set has them
expect 0 "$program" set maps --fold 1 --map-classes all.tsv
says out 'overall 14.29%'
mv maps/classes.tsv kept.tsv
expect 0 "$program" set maps --fold 1
says out 'overall 14.29%'
mv kept.tsv maps/classes.tsv

# several folds: pooled, mean and published
expect 2 "$program" set maps --fold 1 --classes few.tsv --alias chimney=roof --alias chimney=wall
expect 0 "$program" set maps --fold 1-2 --classes few.tsv --alias chimney=roof --json scores.json
cp out one
says out '^1 *2 *92.31 '
says out '^2 *1 *91.67 '
says out '^pooled *3 *92.00 '
says out '^mean *3 *91.99 .* 85.71 .* 95.83 *100.00$'
says out '^published *3 *91.99 .* 85.00 .* 95.50 *100.00$'
for field in '"folds": \[' '"fold_mean": {' '"published": {' '"fold": 2'; do says scores.json "$field"; done
mkdir out1 out2
cp maps/a.png maps/c.png maps/classes.tsv out1; cp maps/b.png maps/classes.tsv out2
expect 0 "$program" set out%d --fold 2 --fold 1 --classes few.tsv --alias chimney=roof
says out '^pooled *3 *92.00 '
expect 0 "$program" set maps --fold 1 --part train
says out '1 map, 12 pixels'
expect 0 "$program" set maps --names <(echo c)
says out '1 map, 4 pixels'

# JSON on standard output takes the table's place; the number of threads changes nothing
expect 0 "$program" set maps --fold 1-2 --classes few.tsv --alias chimney=roof --threads 7 --json -
same out scores.json
expect 0 "$program" set maps --fold 1-2 --classes few.tsv --alias chimney=roof --threads 1
same out one

# every fault at once
mkdir bad
cp maps/classes.tsv bad
head -c 40 maps/a.png >bad/a.png
cp maps/a.png bad/b.png
cp maps/b.png bad/c.png
expect 3 "$program" set bad
says err 'bad/a.png: the file is truncated'
says err 'bad/c.png: 4 x 3 pixels, but the truth has 4 x 1'
says err '2 faults; nothing is scored'
[ ! -s out ] || fail 'scores in spite of faults'
expect 3 "$program" set none%d --fold 1-2
[ "$(grep -c 'none1/[ac].png\|none2/b.png' err)" = 3 ] || fail 'a missing map is not named'
expect 3 "$program" none maps
expect 3 "$program" set maps --fold 3
says err '3.tsv'
expect 3 "$program" set maps --classes none.tsv
expect 3 "$program" set maps --map-classes none.tsv
printf '0\twall\n' >maps/classes.tsv
expect 3 "$program" set maps
says err 'maps/classes.tsv:1:1: error: '
cp other.tsv maps/classes.tsv

# usage
expect 2 "$program" set
expect 2 "$program" set maps more
expect 2 "$program" set maps --fold 0
expect 2 "$program" set maps --fold 2-1
expect 2 "$program" set maps --fold 1 --fold 1-2
expect 2 "$program" set maps --part test
expect 2 "$program" set maps --fold 1 --names list
expect 2 "$program" set maps --alias chimney
expect 2 "$program" set maps --alias moon=roof --map-classes all.tsv
says err "alias 'moon=roof'"
expect 0 "$program" --help
says out '^Example: evaluate-labels'

# outputs that cannot be written; no input is written over
expect 4 "$program" set maps --json none/x.json
[ ! -w /dev/full ] || expect 4 "$program" set maps --json /dev/full
[ ! -w /dev/full ] || expect 4 sh -c "'$program' set maps >/dev/full"
for input in set/classes.tsv maps/a.png set/labels/a.png maps/classes.tsv set/folds/1.tsv; do
    cp $input kept
    expect 2 "$program" set maps --fold 1 --json $input
    same $input kept
done

[ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
echo "evaluate-labels does what it says"
