#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# weber-penn.sg: its 73 parameters; each stem knows where up is, through curves, splits and branchings; other trees than
# the preset's come out too.
set -u
: "${SG_SOURCE_DIR:?}" "${SG_BUILD_DIR:?}"
# shellcheck source=tests/shell_support.sh
. "$SG_SOURCE_DIR/tests/shell_support.sh"
sample=$SG_BUILD_DIR/src/sample-grammar
grammar=$SG_SOURCE_DIR/data/grammars/weber-penn.sg
cp -r "$SG_SOURCE_DIR/data/grammars/assets" .

[ "$(grep -c '^const ' "$grammar")" -eq 73 ] || fail "not 73 parameters"

# The grammar on standard input, with other parameters: NAME=VALUE...
with() {
    local script=
    for setting; do
        grep -q "^const ${setting%%=*} = " "$grammar" || fail "no parameter ${setting%%=*}"
        script+="s/^const ${setting%%=*} = [^ ]*/const ${setting%%=*} = ${setting#*=}/;"
    done
    sed "$script"
}

# Largest distance from the vertical of the edges of length 1 that have the colour of plumb lines, and how many there are.
plumb() { # FILE.obj
    awk -v mtl="${1%.obj}.mtl" '
        BEGIN {
            while ((getline line < mtl) > 0) {
                split(line, word, " ")
                if (word[1] == "newmtl") name = word[2]
                if (word[1] == "Kd" && word[2] > 0.9 && word[3] < 0.1 && word[4] > 0.9) wanted = name
            }
        }
        $1 == "v" { n++; x[n] = $2; y[n] = $3; z[n] = $4 }
        $1 == "usemtl" { on = $2 == wanted }
        $1 == "f" && on {
            for (i = 2; i <= NF; i++) {
                a = $i + 0; b = (i < NF ? $(i + 1) : $2) + 0
                h = (x[a] - x[b]) ^ 2 + (z[a] - z[b]) ^ 2; l = sqrt(h + (y[a] - y[b]) ^ 2)
                if (l < 0.9 || l > 1.1) continue
                edges++
                if (h > worst) worst = h
            }
        }
        END { print (sqrt(worst) < 1e-5 && edges > 1000 ? "upright" : "off"), sqrt(worst), edges + 0 }' "$1"
}

# A line of length 1 from the end of each stem, up as the stem sees it.
lines='set_material(#ff00ff) roll(deg(atan2(gx, gz))) pitch(-deg(atan2(hypot(gx, gz), gy))) move(0.001) width(0.01) draw(1)'
for tree in "DownAngle0=20 RotateV0=0" "BaseSplits=2 SegSplits2=0.3 SplitAngleV2=20" "Rotate1=-80 CurveBack1=60 AttractionUp=-2" \
    "Branches0=3 DownAngle0=15 DownAngleV1=30 SegSplits1=1"; do
    # shellcheck disable=SC2086
    with Leaves=0 $tree <"$grammar" |
        sed "/^rule Onwards.*if i >= /,/nothing/s/-> nothing/-> $lines/" >plumb.sg
    grep -q 'ff00ff' plumb.sg || fail "no plumb lines"
    expect 0 "$sample" plumb.sg -n 1 -o plumb --name plumb --formats obj --quiet
    result=$(plumb plumb/plumb-0001.obj)
    [ "${result%% *}" = upright ] || fail "$tree: $result"
done

# Ends of ranges.
for tree in "Shape=0 Taper0=0 Taper1=1.5" "Shape=1 Taper0=2.5 LobeDepth=0 PruneRatio=1" "Shape=2 BaseSize=0 PruneRatio=0" \
    "Shape=3 Levels=2 Leaves=40 LeafDistrib=8" "Shape=4 Levels=1 Leaves=40" "Shape=5 BranchDist1=5 BranchDist2=0" \
    "Shape=6 CurveRes0=1 CurveRes1=1 CurveRes2=1" "Shape=8 ScaleV=0.001 LengthV2=0 Branches2=1" "Flare=0 Scale=0.5 ScaleV=0.1"; do
    # shellcheck disable=SC2086
    with $tree <"$grammar" >other.sg
    expect 0 "$sample" other.sg -n 2 -o other --formats obj --detail 3 --quiet
done

[ $failures -eq 0 ] && echo "weber-penn: all well"
exit $((failures > 0))
