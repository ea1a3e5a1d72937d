# SPDX-License-Identifier: GPL-3.0-or-later
# usage: awk -f lattice-svg.awk classes.tsv NAME.lat >NAME.svg
# A label lattice as a picture: each cell in the colour of its label, with all lines of the lattice over it.
FNR == NR { if ($1 ~ /^[0-9]+$/) color[$2] = $3; next }
$1 == "#" || NF == 0 { next }
$1 == "lattice" { width = $2; height = $3; next }
$1 == "x" { for (i = 0; i <= width; i++) x[i] = $(i + 2); next }
$1 == "y" { for (j = 0; j <= height; j++) y[j] = $(j + 2); next }
{ for (i = 0; i < width; i++) label[rows, i] = $(i + 1); rows++ }
END {
    if (rows != height || height == 0) { print "not a lattice" >"/dev/stderr"; exit 1 }
    w = x[width] - x[0]; h = y[height] - y[0]
    printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" height=\"%d\">\n", w, h, w, h
    for (j = 0; j < height; j++)
        for (i = 0; i < width; i++)
            printf "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"%s\"/>\n", x[i] - x[0], y[j] - y[0],
                x[i + 1] - x[i], y[j + 1] - y[j], color[label[j, i]]
    path = ""
    for (i = 0; i <= width; i++) path = path sprintf("M%d 0V%d", x[i] - x[0], h)
    for (j = 0; j <= height; j++) path = path sprintf("M0 %dH%d", y[j] - y[0], w)
    printf "<path d=\"%s\" stroke=\"#000\" stroke-width=\"0.6\" stroke-opacity=\"0.55\" fill=\"none\"/>\n</svg>\n", path
}
