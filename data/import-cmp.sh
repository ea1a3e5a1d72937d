#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# import-cmp.sh - the CMP facade database into a data set of ours.
#
# Example: data/import-cmp.sh base/ cmp
#
# Usage: import-cmp.sh FOLDER DATASET [option of import-labels...]
#
# 606 rectified facades (378 base, 228 extended) with twelve classes: R. Tylecek and R. Sara, "Spatial pattern templates
# for recognition of objects with regular structure", GCPR 2013; Center for Machine Perception, Czech Technical
# University in Prague, "CMP Facade Database", https://cmp.felk.cvut.cz/~tylecr1/facade/ .
#
# FOLDER is "base" or "extended" of the published archives: x.jpg is a photograph, x.png its label map (palette, values
# counted from 1), x.xml is not needed. Both folders may be imported into one data set, one after the other.
# $IMPORT_LABELS names the program where it is not on the path.
set -eu

if [ $# -lt 2 ]; then
    sed -n 's/^# \(Usage: .*\)/\1/p' "$0" >&2
    exit 2
fi
folder=$1 dataset=$2
shift 2
exec "${IMPORT_LABELS:-import-labels}" palette "$folder" -o "$dataset" --classes "$(dirname "$0")/classes/cmp.tsv" \
    --images "$folder" --base 1 "$@"
