#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# import-ecp.sh - the Ecole Centrale Paris facades database into a data set of ours.
#
# Example: data/import-ecp.sh annotations/ images/ ecp
#
# Usage: import-ecp.sh ANNOTATIONS IMAGES DATASET [option of import-labels...]
#
# 104 rectified Haussmannian facades, monge_*.jpg (O. Teboul, "Shape grammar parsing: application to image-based
# modeling", 2011, Ecole Centrale Paris, "Facades Database"), with the corrected annotation of A. Martinovic, M. Mathias,
# J. Weissenberg and L. Van Gool, "A three-layered approach to facade parsing", ECCV 2012 (KU Leuven, VISICS). Fetch both
# from their authors; they are for research, with citation, and are not passed on here.
#
# ANNOTATIONS holds one file a facade, of one of these kinds, told by their endings and contents:
#   *.png   colours: window ff0000, wall ffff00, balcony 8000ff, door ff8000, roof 0000ff, sky 80ffff, shop 00ff00,
#           chimney 808080, void 000000
#   *.txt   a digit a pixel, or numbers with blanks or commas between: 1 to 8 in that order, 0 void
# A name that is longer than the photograph's is cut with --suffix: x_labels.png goes with x.jpg by --suffix _labels.
# The data set gets classes7.tsv too, the published protocol of seven classes: use it with --classes.
# $IMPORT_LABELS names the program where it is not on the path.
set -eu

if [ $# -lt 3 ]; then
    sed -n 's/^# \(Usage: .*\)/\1/p' "$0" >&2
    exit 2
fi
annotations=$1 images=$2 dataset=$3
shift 3
here=$(dirname "$0")

# the first file that the pattern finds, or nothing
first() {
    for file in "$@"; do
        if [ -f "$file" ]; then
            printf '%s\n' "$file"
            return
        fi
    done
}

text=$(first "$annotations"/*.txt)
if [ -n "$(first "$annotations"/*.png "$annotations"/*.PNG)" ]; then
    kind=rgb base=
elif [ -z "$text" ]; then
    echo "import-ecp.sh: $annotations: neither *.png nor *.txt in it" >&2
    exit 3
elif head -n 1 "$text" | grep -q '[0-9][ 	,;][ 	]*[0-9]'; then
    kind=matrix base=--base=1
else
    kind=digits base=--base=1
fi

status=0
"${IMPORT_LABELS:-import-labels}" "$kind" "$annotations" -o "$dataset" --classes "$here/classes/ecp.tsv" \
    --images "$images" ${base:+"$base"} "$@" || status=$?
if [ -d "$dataset" ]; then
    cp "$here/classes/ecp7.tsv" "$dataset/classes7.tsv"
fi
exit $status
