#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# sample-grammar as a user runs it: what is written, the same bytes for any number of threads, exit statuses.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
sample=$SG_BUILD_DIR/src/sample-grammar
grammars=$SG_SOURCE_DIR/data/grammars
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*"; cat "$work/err" 2>/dev/null; exit 1; }

expect() { # STATUS COMMAND...: the command ends with this status, and says why when it is not 0
    local want=$1 got
    shift
    "$@" >"$work/out" 2>"$work/err"
    got=$?
    [ "$got" -eq "$want" ] || fail "status $got, not $want: $*"
    [ "$want" -eq 0 ] || [ -s "$work/err" ] || fail "no word of what is wrong: $*"
}

# What a run writes.
expect 0 "$sample" "$grammars/haussmann.sg" -n 3 -o "$work/a" --size 60x80 --sheet 2x2 --json "$work/a.json" --quiet
for i in 1 2 3; do
    for suffix in png rgb.png svg lat json; do
        [ -s "$work/a/haussmann-000$i.$suffix" ] || fail "no haussmann-000$i.$suffix"
    done
done
[ -s "$work/a/sheet.png" ] && [ -s "$work/a/classes.tsv" ] || fail "no sheet or no class table"
[ "$(find "$work/a" -type f | wc -l)" -eq 17 ] || fail "other files than expected: $(ls -A "$work/a")"
for class in window wall balcony door roof sky shop; do
    grep -qP "^\d+\t$class\t#[0-9a-f]{6}\$" "$work/a/classes.tsv" || fail "no class $class"
    grep -q "\"$class\"" "$work/a.json" || fail "no area of $class in the report"
done
[ "$(grep -c '"log_prior"' "$work/a.json")" -eq 3 ] || fail "the report has no three samples"
head -c 8 "$work/a/haussmann-0001.lat" | grep -q '^lattice ' || fail "no lattice"

# The same seed gives the same bytes, whatever the threads; another seed gives others.
expect 0 "$sample" "$grammars/haussmann.sg" -n 3 -o "$work/b" --size 60x80 --sheet 2x2 --json "$work/b.json" --threads 2 --quiet
expect 0 "$sample" "$grammars/haussmann.sg" -n 3 -o "$work/c" --size 60x80 --sheet 2x2 --json "$work/c.json" --threads 1
diff -r "$work/a" "$work/b" >/dev/null || fail "two threads write other bytes"
diff -r "$work/a" "$work/c" >/dev/null || fail "one thread writes other bytes"
cmp -s "$work/b.json" "$work/c.json" || fail "the report depends on the threads"
expect 0 "$sample" "$grammars/haussmann.sg" -n 3 -o "$work/d" --size 60x80 --seed 2 --sheet 2x2
cmp -s "$work/a/haussmann-0001.png" "$work/d/haussmann-0001.png" && fail "another seed writes the same"
# Sample i depends on the seed and i alone.
expect 0 "$sample" "$grammars/haussmann.sg" -n 2 -o "$work/e" --size 60x80 --formats json,svg
cmp -s "$work/a/haussmann-0002.json" "$work/e/haussmann-0002.json" || fail "a sample depends on their number"
[ "$(find "$work/e" -type f | wc -l)" -eq 4 ] || fail "formats that were not asked for"

# The data set layout.
for grammar in arcade ecp office haussmann; do
    expect 0 "$sample" "$grammars/$grammar.sg" -n 2 -o "$work/set-$grammar" --dataset --name "x"
    (cd "$work/set-$grammar" && find . -type f | sort | tr '\n' ' ') >"$work/list"
    [ "$(cat "$work/list")" = "./classes.tsv ./labels/x-0001.png ./labels/x-0002.png " ] || fail "data set: $(cat "$work/list")"
done
expect 0 "$sample" "$grammars/arcade.sg" -o "$work/f" --dataset --formats labels,rgb --json -
[ -s "$work/f/images/arcade-0001.png" ] || fail "no picture in the data set"
grep -q '"philox4x32-10"' "$work/out" || fail "the report does not name its generator"

# Meshes: of models in space, and of label scenes too.
printf 'limit depth 5\nstart T\nrule T -> draw(uniform(1, 2)) [ turn(30) T ] roll(90) T\nrule T at limit -> insert(sphere)\n' >"$work/plant.sg"
expect 0 "$sample" "$work/plant.sg" -n 3 -o "$work/m1" --name p --formats obj --json "$work/m.json" --threads 1
expect 0 "$sample" "$work/plant.sg" -n 3 -o "$work/m2" --name p --formats obj --threads 2
expect 0 "$sample" "$work/plant.sg" -o "$work/m3" --name p --formats obj --detail 1
diff -r "$work/m1" "$work/m2" >/dev/null || fail "two threads write other meshes"
[ "$(find "$work/m1" -type f | wc -l)" -eq 6 ] || fail "other meshes than expected: $(ls -A "$work/m1")"
for i in 1 2 3; do
    faces=$(grep -c '^f ' "$work/m1/p-000$i.obj")
    grep -q "\"faces\": $faces,\$" "$work/m.json" || fail "$faces faces are not in the report"
    grep -q "^mtllib p-000$i.mtl\$" "$work/m1/p-000$i.obj" || fail "the mesh does not name its materials"
    [ "$(grep -c '^newmtl ' "$work/m1/p-000$i.mtl")" -eq "$(grep '^usemtl ' "$work/m1/p-000$i.obj" | sort -u | wc -l)" ] ||
        fail "materials that are missing or not used"
done
[ "$(grep -c '^f ' "$work/m3/p-0001.obj")" -lt "$(grep -c '^f ' "$work/m1/p-0001.obj")" ] || fail "less detail has no fewer faces"
expect 0 "$sample" "$grammars/haussmann.sg" -o "$work/m4" --formats obj,svg --scope 300x400x0 --size 300x400
[ "$(grep -c '<rect ' "$work/m4/haussmann-0001.svg")" -eq "$(grep -c '^f ' "$work/m4/haussmann-0001.obj")" ] ||
    fail "the mesh of a facade has not one face a rectangle"
expect 3 "$sample" "$work/plant.sg" -o "$work/m5" --formats obj,svg # no labels
# The same as binary glTF, with what is written beside it.
expect 0 "$sample" "$work/plant.sg" -n 3 -o "$work/m7" --name p --formats gltf,obj --threads 2 --json "$work/m7.json"
expect 0 "$sample" "$work/plant.sg" -n 3 -o "$work/m8" --name p --formats gltf --threads 1
[ "$(find "$work/m7" -type f | wc -l)" -eq 9 ] && [ "$(find "$work/m8" -type f | wc -l)" -eq 3 ] ||
    fail "other glTF files than expected"
for i in 1 2 3; do
    cmp -s "$work/m7/p-000$i.glb" "$work/m8/p-000$i.glb" || fail "two threads write other glTF"
    cmp -s "$work/m7/p-000$i.obj" "$work/m1/p-000$i.obj" || fail "glTF changes the OBJ"
    [ "$(head -c 4 "$work/m7/p-000$i.glb")" = glTF ] || fail "no glTF"
done
cmp -s "$work/m.json" "$work/m7.json" || fail "glTF changes the report"
# Mesh files stand beside the grammar; they are read only where meshes are written or counted, and never overwritten.
mkdir "$work/mesh"
printf 'label t\nstart S\nrule S -> size(2, 2, 2) insert("parts/tent.obj")\n' >"$work/mesh/g.sg"
expect 3 "$sample" "$work/mesh/g.sg" -o "$work/m9" --formats obj
grep -q "mesh/g.sg:3: error: insert(parts/tent.obj): there is no mesh file $work/mesh/parts/tent.obj" "$work/err" ||
    fail "no place of the insert"
[ ! -e "$work/m9" ] || fail "a missing mesh leaves a folder"
expect 3 "$sample" "$work/mesh/g.sg" --stats
expect 0 "$sample" "$work/mesh/g.sg" -o "$work/m9" --formats derivation
mkdir "$work/mesh/parts"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 4 3\nf 1 2 4\nf 2 3 9\n' >"$work/mesh/parts/tent.obj"
expect 3 "$sample" "$work/mesh/g.sg" -o "$work/m10" --formats gltf
grep -q 'parts/tent.obj:8:7: error: ' "$work/err" || fail "no place of the fault in the mesh"
sed -i 's/3 9/3 4/' "$work/mesh/parts/tent.obj"
expect 0 "$sample" "$work/mesh/g.sg" -o "$work/m10" --name y --formats gltf,obj
[ "$(grep -c '^f ' "$work/m10/y-0001.obj")" -eq 4 ] || fail "the mesh that is inserted has not four faces"
expect 0 "$sample" "$work/mesh/g.sg" --table -
[ "$(awk -F'\t' '$1 == "mean" { print $11, $12 }' "$work/out")" = "4 4" ] || fail "the table counts another mesh than is written"
cp "$work/mesh/parts/tent.obj" "$work/mesh/parts/x-0001.obj"
sed -i 's/tent/x-0001/' "$work/mesh/g.sg"
expect 2 "$sample" "$work/mesh/g.sg" -o "$work/mesh/parts" --name x --formats obj
cmp -s "$work/mesh/parts/tent.obj" "$work/mesh/parts/x-0001.obj" || fail "a mesh that is read was overwritten"
for bad in "--scope 1x1" "--scope 1x-1x1" "--scope 1x1xnan" "--scope 1x1x1x" "--scope 0x10x5x2" "--scope 1xx1" "--scope 0x1p3x1" "--detail 16"; do
    # shellcheck disable=SC2086
    expect 2 "$sample" "$work/plant.sg" -o "$work/m6" --formats obj $bad
done
expect 3 "$sample" "$grammars/street.sg" -o "$work/m6" --formats json
grep -q 'street.sg: the grammar has 0 labels.*; obj, gltf' "$work/err" || fail "no word of what can be written of it"
# 20x0x10 is a flat lot, and no hexadecimal number.
printf 'start A\nrule A -> extrude(3) insert(box)\n' >"$work/lot.sg"
expect 0 "$sample" "$work/lot.sg" -o "$work/lot" --formats obj --scope 20x0x10
grep -q '^v 20 3 10' "$work/lot/"*.obj || fail "no box of 20 by 3 by 10"

# Pictures of models in space: what is written when nothing is said, the same bytes for any number of threads, views.
png_size() { od -A n -t u1 -j 16 -N 8 "$1" | awk '{ print $3 * 256 + $4 "x" $7 * 256 + $8 }'; }
listing() { find "$1" -type f | sort | xargs -n1 basename | tr '\n' ' '; }
expect 0 "$sample" "$work/plant.sg" -n 2 -o "$work/r1" --name p --size 60x40 --threads 1
expect 0 "$sample" "$work/plant.sg" -n 2 -o "$work/r2" --name p --size 60x40 --threads 5
diff -r "$work/r1" "$work/r2" >/dev/null || fail "five threads draw other pictures"
[ "$(listing "$work/r1")" = "p-0001.mtl p-0001.obj p-0001.render.png p-0002.mtl p-0002.obj p-0002.render.png sheet.png " ] ||
    fail "of models in space there is by default: $(listing "$work/r1")"
[ "$(png_size "$work/r1/p-0001.render.png")" = 60x40 ] || fail "a picture of another size"
[ "$(png_size "$work/r1/sheet.png")" = 156x64 ] || fail "a sheet of another size"
cmp -s "$work/r1/p-0001.obj" "$work/m1/p-0001.obj" || fail "drawing changes the mesh that is written"
expect 0 "$sample" "$work/plant.sg" -n 2 -o "$work/r3" --name p --size 60x40 --formats sheet
[ "$(listing "$work/r3")" = "sheet.png " ] && cmp -s "$work/r1/sheet.png" "$work/r3/sheet.png" || fail "a sheet alone is another"
for view in "--view 35,-20" "--view 125,18" "--view -35,18" "--projection orthographic"; do
    # shellcheck disable=SC2086
    expect 0 "$sample" "$work/plant.sg" -o "$work/r4" --name p --size 60x40 --formats render $view
    [ "$(listing "$work/r4")" = "p-0001.render.png " ] || fail "there is more than a picture: $(listing "$work/r4")"
    cmp -s "$work/r1/p-0001.render.png" "$work/r4/p-0001.render.png" && fail "$view changes nothing"
done
expect 0 "$sample" "$work/plant.sg" -o "$work/r4" --name p --size 60x40 --formats render --view 35,18 --projection perspective
cmp -s "$work/r1/p-0001.render.png" "$work/r4/p-0001.render.png" || fail "the default view is another"
printf 'start S\nrule S -> nothing\n' >"$work/empty.sg"
expect 0 "$sample" "$work/empty.sg" -o "$work/r5" --name empty --size 1x1
[ "$(png_size "$work/r5/empty-0001.render.png")" = 1x1 ] || fail "an empty model has no picture"
expect 0 "$sample" "$grammars/haussmann.sg" -o "$work/r6" --size 60x80 --scope 15x20x0 --formats render,sheet
cmp -s "$work/r6/sheet.png" "$work/r6/haussmann-0001.render.png" && fail "the sheet of a label scene is no label map"
for bad in "--view 35" "--view 35,91" "--view 400,0" "--view x,y" "--view 1,2,3" "--view nan,0" "--view 0x1,0" "--projection flat"; do
    # shellcheck disable=SC2086
    expect 2 "$sample" "$work/plant.sg" -o "$work/m6" $bad
done
[ ! -e "$work/m6" ] || fail "wrong usage leaves a folder"
# Stored derivations, in both forms, give what was sampled, and are stored the same again.
expect 0 "$sample" "$grammars/haussmann.sg" -n 3 -o "$work/kept" --size 60x80 --formats derivation
[ "$(find "$work/kept" -type f | sort | xargs -n1 basename | tr '\n' ' ')" = "haussmann-0001.sgd haussmann-0002.sgd haussmann-0003.sgd " ] ||
    fail "derivations: $(ls -A "$work/kept")"
for from in kept/haussmann-0002.sgd a/haussmann-0002.json; do
    rm -rf "$work/shown"
    expect 0 "$sample" "$grammars/haussmann.sg" --from "$work/$from" -o "$work/shown" --size 60x80 --json "$work/shown.json" \
        --formats all,derivation
    for suffix in png rgb.png svg lat json; do
        cmp -s "$work/a/haussmann-0002.$suffix" "$work/shown/haussmann-0001.$suffix" || fail "$from shows another $suffix"
    done
    cmp -s "$work/kept/haussmann-0002.sgd" "$work/shown/haussmann-0001.sgd" || fail "$from is stored otherwise"
    grep -q '"from"' "$work/shown.json" && ! grep -q '"seed"' "$work/shown.json" || fail "the report of $from"
done
(echo '['; cat "$work/a/haussmann-0001.json"; echo ,; cat "$work/a/haussmann-0003.json"; echo ']') |
    expect 0 "$sample" "$grammars/haussmann.sg" --from - -o "$work/two" --formats labels --size 60x80 || exit 1
cmp -s "$work/a/haussmann-0003.png" "$work/two/haussmann-0002.png" || fail "an array of derivations is not shown"
expect 3 "$sample" "$grammars/office.sg" --from "$work/kept/haussmann-0001.sgd" -o "$work/g"
grep -q "haussmann-0001.sgd: byte 24: these are derivations of another grammar than 'office'" "$work/err" || fail "another grammar"
expect 3 "$sample" "$grammars/office.sg" --from "$work/a/haussmann-0001.json" -o "$work/g"
expect 3 "$sample" "$grammars/haussmann.sg" --from "$work/none.sgd" -o "$work/g"
for n in 0 7 30 100; do
    head -c $n "$work/kept/haussmann-0001.sgd" >"$work/cut.sgd"
    expect 3 "$sample" "$grammars/haussmann.sg" --from "$work/cut.sgd" -o "$work/g"
    grep -q 'cut.sgd: ' "$work/err" || fail "a cut file is not named"
done
printf '{"rule":0,\n"symbol"}' >"$work/bad.json"
expect 3 "$sample" "$grammars/haussmann.sg" --from "$work/bad.json" -o "$work/g"
grep -q 'bad.json:2:9: error: ' "$work/err" || fail "no line and column of the error"
echo '[]' >"$work/bad.json"
expect 3 "$sample" "$grammars/haussmann.sg" --from "$work/bad.json" -o "$work/g"
expect 2 "$sample" "$grammars/haussmann.sg" --from "$work/kept/haussmann-0001.sgd" -n 2 -o "$work/g"
expect 1 "$sample" "$grammars/haussmann.sg" --from "$work/kept/haussmann-0001.sgd" --max-nodes 3 -o "$work/few"
expect 2 "$sample" "$grammars/haussmann.sg" --from "$work/kept/haussmann-0001.sgd" --formats derivation -o "$work/kept"
[ ! -e "$work/g" ] || fail "a bad file of derivations leaves a folder"

# Help, version, wrong usage.
expect 0 "$sample" --help
[ "$(wc -l <"$work/out")" -le 35 ] && grep -q '^Example: ' "$work/out" || fail "help is no screen with an example"
expect 0 "$sample" --version
expect 2 "$sample"
expect 2 "$sample" "$grammars/arcade.sg"
expect 2 "$sample" "$grammars/arcade.sg" "$grammars/arcade.sg" -o "$work/g"
for bad in "-n 0" "-n x" "--size 10" "--size 0x4" "--size 3x-4" "--size 40000x2" "--size 30000x30000" "--sheet 4" \
    "--formats tiff" "--formats=" "--max-nodes 0" "--name a/b" "--threads 0" "--nonsense"; do
    # shellcheck disable=SC2086
    expect 2 "$sample" "$grammars/arcade.sg" -o "$work/g" $bad
done
[ ! -e "$work/g" ] || fail "wrong usage leaves a folder"

# Bad grammars: the place is told.
expect 3 "$sample" "$work/none.sg" -o "$work/g"
printf 'label t\nstart S\nrule S -> split x { t | }\n' >"$work/bad.sg"
expect 3 "$sample" "$work/bad.sg" -o "$work/g"
grep -q 'bad.sg:3:' "$work/err" || fail "no line of the error"
[ ! -e "$work/g" ] || fail "a bad grammar leaves a folder"

# Work that fails: too many nodes, and what is no label scene. The path of the derivation is told.
printf 'label t\nstart S\nrule S -> 0.99 : split x { S | S } -> 0.01 : t\n' >"$work/large.sg"
expect 1 "$sample" "$work/large.sg" -o "$work/h" --max-nodes 1000
grep -q 'sample 1: .*S > S > .*more than 1000 nodes' "$work/err" || fail "no path to the error"
printf 'label t\nstart S\nrule S -> split z { t | t }\n' >"$work/deep.sg"
expect 1 "$sample" "$work/deep.sg" -o "$work/h" --formats labels

# Outputs that cannot be written.
expect 4 "$sample" "$grammars/arcade.sg" -o /dev/full
expect 4 "$sample" "$grammars/arcade.sg" -o "$work/a.json/folder"
expect 4 "$sample" "$grammars/arcade.sg" -o "$work/i" --json /dev/full
expect 4 "$sample" "$grammars/arcade.sg" -o "$work/i" --json "$work/none/report.json"
(ulimit -f 1 && expect 4 "$sample" "$grammars/arcade.sg" -o "$work/j" --formats svg,rgb --size 3000x3000) || exit 1
[ -z "$(find "$work/j" -name '*.rgb.png*' -o -name '.*.png.*')" ] || fail "half a file is left: $(ls -A "$work/j")"
if [ -e /dev/full ]; then
    "$sample" "$grammars/arcade.sg" -o "$work/k" --json - >/dev/full 2>"$work/err"
    [ $? -eq 4 ] || fail "a full standard output is not noticed"
fi

# The grammar is never overwritten.
cp "$grammars/arcade.sg" "$work/arcade-0001.json"
expect 2 "$sample" "$work/arcade-0001.json" -o "$work"
cmp -s "$grammars/arcade.sg" "$work/arcade-0001.json" || fail "the grammar was overwritten"

# An interrupt ends the run with what is there, all of it whole.
"$sample" "$grammars/haussmann.sg" -n 100000 -o "$work/l" --formats svg,sheet --size 30x40 --quiet --json "$work/l.json" 2>"$work/err" &
pid=$!
for _ in $(seq 100); do
    sleep 0.05
    [ -e "$work/l/haussmann-0005.svg" ] && break
done
kill -INT "$pid"
wait "$pid"
[ $? -eq 5 ] || fail "an interrupt does not end with 5"
[ -s "$work/l/sheet.png" ] && [ -s "$work/l.json" ] || fail "an interrupt loses what was found"
[ -z "$(find "$work/l" -name '.*.svg.*')" ] || fail "an interrupt leaves half a file"
n=$(grep -c '"log_prior"' "$work/l.json")
[ "$n" -ge 5 ] && [ "$n" -eq "$(find "$work/l" -name '*.svg' | wc -l)" ] || fail "the report has $n samples"
echo "sample-grammar: all well"
