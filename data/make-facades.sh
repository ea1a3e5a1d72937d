#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: make-facades.sh BUILD-FOLDER [FOLDER]
# Makes the bundled data set again: data/facades, or FOLDER. The label maps come out byte for byte as committed; the
# photographs do with the same OpenCV.
set -euo pipefail
build=$(cd "${1:?usage: make-facades.sh BUILD-FOLDER [FOLDER]}" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$build/data/render-facades" "$here/grammars/haussmann.sg" -o "${2:-$here/facades}" -n 48 --seed 1853 --quiet
