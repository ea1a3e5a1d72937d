#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# demo.sh - install what is missing, build, learn a grammar from the bundled facades, sample new ones, parse photographs, show all on one page.
set -euo pipefail
start=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")"
. scripts/setup.sh
. scripts/demo-steps.sh

usage() {
    cat <<'TXT'
Usage: ./demo.sh [OPTION]...
Install what is missing (through apt), build, learn a split grammar from the bundled facades, sample new facades from it, parse
photographs with it, and write one page with the pictures: out/demo/index.html.

  --output FOLDER  where the page goes (default out/demo)
  --seed N         seed of learning and sampling (default 1)
  --help
TXT
}

out=out/demo
seed=1
while [ $# -gt 0 ]; do
    case $1 in
        --output)
            out=${2:?--output wants a folder}
            case $out in /*) ;; *) out=$start/$out ;; esac
            shift 2 ;;
        --seed) seed=${2:?--seed wants a number}; shift 2 ;;
        --help) usage; exit 0 ;;
        *) usage >&2; exit 2 ;;
    esac
done

# shellcheck disable=SC2086
install_missing $needs_build $needs_demo
bootstrap
configure_in build
build_in build all

make_demo build "$out" "$seed"
say
say "The page:  $(cd "$out" && pwd)/index.html"
