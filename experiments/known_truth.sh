#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Known truth: grammars are learned from label lattices drawn from three shipped grammars, ten seeds each; energies beside the
# truth's, and two-sample tests of what the grammars make. (haussmann.sg is left out: its siblings are tied and its labels
# cover regions, so it makes no lattices of cells, and the truth would be outside of what is searched.)
# usage: known_truth.sh [known_truth options...]    (SG_BUILD_DIR, SG_SOURCE_DIR)
set -eu
grammars=${SG_SOURCE_DIR:-$(dirname "$0")/..}/data/grammars
exec "${SG_BUILD_DIR:-build}"/experiments/known_truth "$@" "$grammars"/office.sg "$grammars"/arcade.sg "$grammars"/terrace.sg
