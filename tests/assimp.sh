#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Meshes as an independent reader (assimp) sees them: glTF and OBJ files hold the faces, vertices and materials we wrote.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
. "$SG_SOURCE_DIR/tests/shell_support.sh"
command -v assimp >/dev/null || { echo "assimp is not installed (Debian: assimp-utils)"; echo; exit 77; }
sample=$SG_BUILD_DIR/src/sample-grammar

# number WORD FILE: what assimp counts
number() { sed -n "s/^$1: *\([0-9]*\).*/\1/p" "$2" | head -n 1; }

# triangles FILE.obj: its faces, cut into triangles
triangles() { awk '$1 == "f" { n += NF - 3 } END { print n + 0 }' "$1"; }

# corners FILE.obj: different corners in each pair of group and material, which are the vertices of glTF
corners() { awk '$1 == "g" { g = $2 } $1 == "usemtl" { m = $2 }
    $1 == "f" { for (i = 2; i <= NF; i++) if (!((g, m, $i) in seen)) { seen[g, m, $i] = 1; n++ } } END { print n + 0 }' "$1"; }

# equal WHAT OURS THEIRS
equal() { [ -n "$2" ] && [ "$2" = "$3" ] || fail "$1: we have $2, assimp has $3"; }

# close POINT POINT: as assimp shows them
close() { printf '%s\n' "$1" "$2" | tr -d '()' | awk 'NF != 5 { bad = 1 } { for (i = 1; i <= 3; i++) x[NR, i] = $(i + 2) }
    END { if (bad) exit 1; for (i = 1; i <= 3; i++) { d = x[1, i] - x[2, i]; m = x[1, i] < 0 ? -x[1, i] : x[1, i]
        if (d > 1e-6 * (1 + m) || -d > 1e-6 * (1 + m)) exit 1 } exit NR != 2 }'; }

check() { # NAME: NAME.glb and NAME.obj
    expect 0 assimp info "$1.glb" --raw
    cp out glb.info
    equal "$1.glb triangles" "$(triangles "$1.obj")" "$(number Faces glb.info)"
    equal "$1.glb vertices" "$(corners "$1.obj")" "$(number Vertices glb.info)"
    equal "$1.glb materials" "$(grep -c '^newmtl ' "$1.mtl")" "$(($(number Materials glb.info) - 1))" # and its default one
    expect 0 assimp info "$1.obj" --raw
    cp out obj.info
    equal "$1.obj faces" "$(grep -c '^f ' "$1.obj")" "$(number Faces obj.info)"
    for corner in Minimum Maximum; do # the same place in both; OBJ files have seven digits
        close "$(grep "^$corner point" obj.info)" "$(grep "^$corner point" glb.info)" || fail "$1: $corner points differ"
    done
    # With the index of every vertex looked at, normals of length 1, and so on.
    expect 0 assimp info "$1.glb"
    grep -qi 'validation failed\|error' out err && fail "assimp finds faults in $1.glb"
}

cat >plant.sg <<'SG'
limit depth 6
label leaf #30a030
start T(1)
rule T(l) -> width(l / 5) draw(l) turn(uniform(-20, 20)) draw(l) [ turn(40) set_material(twig) T(l * 0.7) ] roll(90) T(l * 0.8)
rule T(l) at limit -> size(0.2, 0.2, 0.2) insert(sphere) size(0.2, 0.2, 0) leaf
SG
cat >house.sg <<'SG'
label wall #ffffff
label "red roof" #ff8000
start S
rule S -> size(4, 3, 6) wall set_label("red roof") hip_roof(uniform(30, 50)) set_material(#306090) size(1, 5, 1) insert(cone)
SG
for name in plant house; do
    expect 0 "$sample" $name.sg -n 2 -o o --name $name --formats obj,gltf --quiet
    for i in 1 2; do check o/$name-000$i; done
done
for grammar in "$SG_SOURCE_DIR"/data/grammars/*.sg; do
    name=$(basename "$grammar" .sg)
    expect 0 "$sample" "$grammar" -o g --name "$name" --formats obj,gltf --quiet
    check "g/$name-0001"
done
[ $failures -eq 0 ]
