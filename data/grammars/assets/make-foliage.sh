#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Make the sprays of leaves that the grammars of trees insert: NAME.obj and NAME.mtl in this folder. A spray stands on its
# stalk, in the middle of the bottom of its box, and grows along y.
# usage: make-foliage.sh
set -eu
cd "$(dirname "$0")"

# spray NAME LEAVES FROM TO LOW HIGH LENGTH WIDTH FOLD FLAT COLOURS
# Leaves stand from FROM to TO along the stalk (of length 1), lean away from it by LOW to HIGH degrees, and are folded up
# by FOLD (of their length). FLAT is the depth of the spray beside its breadth. COLOURS are taken in turn.
spray() {
    awk -v name="$1" -v n="$2" -v from="$3" -v to="$4" -v low="$5" -v high="$6" -v length_="$7" -v width="$8" -v fold="$9" \
        -v flat="${10}" -v colours="${11}" '
    # 0 to 1: a linear congruential generator, the same everywhere
    function draw() { seed = (seed * 1103 + 12345) % 65536; return seed / 65536 }
    function hex(s) { return index("0123456789abcdef", substr(s, 1, 1)) * 16 + index("0123456789abcdef", substr(s, 2, 1)) - 17 }
    function vertex(x, y, z) {
        vx[++nv] = x; vy[nv] = y; vz[nv] = z * flat
        if (x * x > wide * wide) wide = x < 0 ? -x : x
        if (vz[nv] * vz[nv] > deep * deep) deep = vz[nv] < 0 ? -vz[nv] : vz[nv]
        if (y > high_) high_ = y
    }
    # A leaf in four corners: stalk, left, tip, right. u: along it, s: to its side, c: up
    function leaf(y, around, lean, l, w,    ux, uy, uz, sx, sz, cx, cy, cz, m) {
        ux = sin(lean) * cos(around); uy = cos(lean); uz = sin(lean) * sin(around)
        sx = -sin(around); sz = cos(around)
        cx = -cos(lean) * cos(around); cy = sin(lean); cz = -cos(lean) * sin(around)
        m = 0.45 * l
        vertex(0, y, 0)
        vertex(m * ux + w / 2 * sx + fold * l * cx, y + m * uy + fold * l * cy, m * uz + w / 2 * sz + fold * l * cz)
        vertex(l * ux, y + l * uy, l * uz)
        vertex(m * ux - w / 2 * sx + fold * l * cx, y + m * uy + fold * l * cy, m * uz - w / 2 * sz + fold * l * cz)
    }
    BEGIN {
        seed = n * 97 + 11; pi = atan2(0, -1); ncolours = split(colours, colour, " ")
        for (i = 0; i < n; i++)
            leaf(from + (to - from) * (n > 1 ? i / (n - 1) : 1), i * 2.39996 + draw() * 0.8,
                 (low + (high - low) * draw()) * pi / 180, length_ * (0.8 + 0.4 * draw()), width * (0.8 + 0.4 * draw()))
        obj = name ".obj"; mtl = name ".mtl"
        print "# SPDX-License-Identifier: GPL-3.0-or-later\n# " obj " - " n " leaves; made by make-foliage.sh." >obj
        printf("# Undistorted it is %.2f broad and %.2f deep for a length of 1.\n", 2 * wide / high_, 2 * deep / high_) >obj
        print "mtllib " mtl >obj
        for (i = 1; i <= nv; i++)
            printf("v %.4f %.4f %.4f\n", vx[i] / (2 * wide) + 0.5, (vy[i] > 0 ? vy[i] : 0) / high_,
                   vz[i] / (2 * deep) + 0.5) >obj
        for (c = 1; c <= ncolours; c++) {
            printf "usemtl leaf-%d\n", c >obj
            for (i = c - 1; i < n; i += ncolours)
                printf "f %d %d %d\nf %d %d %d\n", 4 * i + 1, 4 * i + 4, 4 * i + 3, 4 * i + 1, 4 * i + 3, 4 * i + 2 >obj
        }
        print "# SPDX-License-Identifier: GPL-3.0-or-later" >mtl
        for (c = 1; c <= ncolours; c++)
            printf "newmtl leaf-%d\nKd %.4f %.4f %.4f\n", c, hex(substr(colour[c], 1)) / 255, hex(substr(colour[c], 3)) / 255,
                   hex(substr(colour[c], 5)) / 255 >mtl
    }'
}

spray oak-spray     14 0.15 0.95 35 85 0.42 0.27 0.06 1    "7fb34a 6ea03f a3c65c"
spray acacia-spray  14 0.10 0.95 30 100 0.55 0.20 0.04 0.6 "98b858 86a84e b3c76a"
spray willow-spray   6 0.00 0.75 20 50 0.90 0.20 0.05 1    "a2c05a 91b350 b9cf6c"
spray poplar-spray  12 0.15 0.95 40 90 0.40 0.32 0.05 1    "90c058 7fb04c b0d26e"
spray spruce-spray  26 0.00 0.85 35 60 0.34 0.07 0.00 0.6  "6aa266 5a9058 8abb74"
