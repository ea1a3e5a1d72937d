#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# import-labels as a program: every kind from a tiny input, exit statuses, the import scripts.
set -u
program=${SG_BUILD_DIR:-.}/data/import-labels
scripts=${SG_SOURCE_DIR:-.}/data
. "${SG_SOURCE_DIR:-.}/tests/shell_support.sh"

printf '# index\tname\tcolour\n0\twall\t#ffff00\n1\twindow\t#ff0000\n9\tignore\t#000000\n' >classes.tsv
mkdir digits matrix labelme one
printf '0011\n0911\n' >digits/a.txt
printf '0011\r\n0911' >digits/b.txt
printf '1,1,2,2\n1,-1,2,2\n' >matrix/a.csv
printf '2 2 3 3\n2 1 3 3\n' >one/a.txt
cat >labelme/a.json <<'END'
{"imageWidth": 4, "imageHeight": 2, "shapes": [
  {"label": "wall", "points": [[0, 0], [4, 0], [4, 2], [0, 2]]},
  {"label": "window", "points": [[2, 0], [4, 2]], "shape_type": "rectangle"},
  {"label": "ignore", "points": [[1, 1], [2, 2]], "shape_type": "rectangle"}]}
END

# one picture by five ways
expect 0 "$program" digits digits -o by-digits --classes classes.tsv --quiet
expect 0 "$program" matrix matrix -o by-matrix --classes classes.tsv --base 1
says err '1 label maps in by-matrix'
expect 0 "$program" matrix one/a.txt -o by-one --classes classes.tsv --base 2
expect 0 "$program" labelme labelme -o by-labelme --classes classes.tsv
expect 0 "$program" palette by-digits/labels -o by-palette --classes classes.tsv --base 0
expect 0 "$program" rgb by-digits/labels -o by-rgb --classes classes.tsv
for set in by-matrix by-one by-labelme by-palette by-rgb; do
    same by-digits/labels/a.png $set/labels/a.png
    same by-digits/classes.tsv $set/classes.tsv
    same classes.tsv $set/classes.tsv
done
same by-digits/labels/a.png by-digits/labels/b.png

# one bad file among good ones: told, left out, status 3
printf '0011\n07x1\n' >digits/c.txt
printf '0077\n0011\n' >digits/d.txt
expect 3 "$program" digits digits -o mixed --classes classes.tsv --json mixed.json
says err 'digits/c.txt:2:3: error: '
says err 'digits/d.txt: 1 label is not in the class table: 7 (2 pixels, the first at column 2, row 0)'
says err '2 of 4 files could not be imported'
says mixed.json '"imported": 2'
says mixed.json 'digits/c.txt:2:3'
same mixed/labels/b.png by-digits/labels/b.png
absent mixed/labels/c.png
expect 3 "$program" digits digits/c.txt -o none --classes classes.tsv
absent none

# wrong usage and failures
expect 2 "$program"
expect 2 "$program" digits digits
says err 'DATASET'
expect 2 "$program" pictures digits -o x
says err 'rgb, palette, matrix, digits, labelme'
expect 2 "$program" digits digits more -o x
expect 2 "$program" digits digits -o x --base -1
expect 2 "$program" digits digits -o x --tolerance far
expect 2 "$program" digits digits -o x --nonsense
expect 3 "$program" digits nowhere -o x --classes classes.tsv
expect 3 "$program" digits digits -o x --classes nowhere.tsv
expect 3 "$program" digits digits -o x
expect 3 "$program" rgb by-rgb/labels -o by-rgb
says err 'would overwrite its own input'
expect 4 "$program" matrix matrix -o /dev/null/x --classes classes.tsv --base 1
expect 4 "$program" matrix matrix -o x --classes classes.tsv --base 1 --json /dev/full
absent nowhere
# no file may have a byte: nothing half written is left
mkdir full
(
    ulimit -f 0
    "$program" matrix matrix -o full --classes classes.tsv --base 1 --quiet >/dev/null 2>&1
    [ $? -eq 4 ]
) || { echo "FAIL: a file size limit is not status 4"; failures=$((failures + 1)); }
if [ -n "$(find full -type f)" ]; then
    echo "FAIL: a file size limit left files:"
    find full -type f
    failures=$((failures + 1))
fi
expect 0 "$program" --help
says out 'Example'
[ "$(wc -l <out)" -le 40 ] || { echo "FAIL: help of more than a screen"; failures=$((failures + 1)); }
expect 0 "$program" --version

# the scripts for published sets, on made-up files in their formats
IMPORT_LABELS=$program
export IMPORT_LABELS
mkdir ecp-text ecp-images cmp
printf '1 1 2\n0 8 2\n' >ecp-text/m.txt
printf '112\n082\n' >m.txt
# a JPEG of 3 x 2 pixels is not to be had from a shell: the smallest photograph here is a label map as PNG
expect 0 "$program" digits m.txt -o photo --classes "$scripts/classes/ecp.tsv" --base 1
cp photo/labels/m.png ecp-images/
expect 0 sh "$scripts/import-ecp.sh" ecp-text ecp-images ecp
same ecp/labels/m.png photo/labels/m.png
same ecp/images/m.png photo/labels/m.png
says ecp/classes7.tsv 'ignore.#808080'
mkdir ecp-digits
cp m.txt ecp-digits/
expect 0 sh "$scripts/import-ecp.sh" ecp-digits ecp-images ecp2
same ecp2/labels/m.png photo/labels/m.png
expect 0 sh "$scripts/import-ecp.sh" photo/labels ecp-images ecp3
same ecp3/labels/m.png photo/labels/m.png
expect 3 sh "$scripts/import-ecp.sh" cmp ecp-images ecp4
expect 2 sh "$scripts/import-ecp.sh" cmp
expect 2 sh "$scripts/import-cmp.sh" cmp
expect 3 sh "$scripts/import-cmp.sh" cmp cmp-set
cp photo/labels/m.png cmp/m.png
expect 3 sh "$scripts/import-cmp.sh" cmp cmp-set
says err 'there is no photograph'

[ $failures -eq 0 ] || echo "$failures failures"
[ $failures -eq 0 ]
