#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# "make install" as a user finds it: every installed header compiles with the flags of pkg-config, a small program links
# and runs, every program answers, and "make uninstall" leaves nothing.
set -u
: "${SG_BUILD_DIR:?}" "${SG_CC:?}" "${SG_PREFIX:?}" "${SG_LIBDIR:?}"
work=$(mktemp -d) || exit 99
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*"; exit 1; }

make=${MAKE:-make}
# The outer make's flags (its job server among them) are not for this one.
unset MAKEFLAGS MFLAGS MAKELEVEL
$make -C "$SG_BUILD_DIR" install DESTDIR="$work" >"$work/install.log" 2>&1 || { cat "$work/install.log"; fail "make install"; }
root=$work$SG_PREFIX
export PKG_CONFIG_PATH=$work$SG_LIBDIR/pkgconfig
query() { pkg-config --define-variable=prefix="$root" "$@" shapegram; }
[ -f "$work$SG_LIBDIR/libshapegram.a" ] || fail "no library"
cflags=$(query --cflags) && libs=$(query --libs) || fail "pkg-config"

headers=$(cd "$root/include/shapegram" && find . -name '*.h' | sed 's|^\./||' | sort)
[ -n "$headers" ] || fail "no headers"
for header in core/status.h core/random.h grammar/grammar.h derivation/derivation.h image/image.h scene/label_scene.h \
    parse/lattice.h parse/earley.h learn/merge.h; do
    grep -qx "$header" <<<"$headers" || fail "$header is not installed"
done
if grep -E '_priv\.h$' <<<"$headers"; then fail "private headers are installed"; fi
for header in $headers; do
    printf '#include "%s"\n' "$header" >"$work/one.c"
    # shellcheck disable=SC2086
    $SG_CC -std=c17 -Wall -Wextra -Werror -fsyntax-only $cflags "$work/one.c" || fail "$header does not compile by itself"
done

cat >"$work/small.c" <<'C'
/* Reads a grammar, samples it, and prints the number of rectangles. */
#include "core/random.h"
#include "derivation/derivation.h"
#include "scene/label_scene.h"
#include <stdio.h>

int main(int argc, char **argv)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *grammar = NULL;
    sg_derivation derivation;
    sg_label_scene scene = {0};
    if (argc != 2 || sg_grammar_load(argv[1], &grammar, &err) != SG_OK) {
        fprintf(stderr, "%s\n", err.msg);
        return 1;
    }
    gsl_rng *rng = sg_random_create(1);
    sg_derivation_init(&derivation, grammar);
    sg_status st = sg_derivation_sample(&derivation, rng, 100000, &err);
    if (st == SG_OK)
        st = sg_label_scene_interpret(&scene, &derivation, 300, 400, &err);
    printf("%zu rectangles\n", scene.nrects);
    const int good = st == SG_OK && scene.nrects > 10;
    sg_label_scene_clear(&scene);
    sg_derivation_clear(&derivation);
    gsl_rng_free(rng);
    sg_grammar_free(grammar);
    return good ? 0 : 1;
}
C
# shellcheck disable=SC2086
$SG_CC -std=c17 $cflags -o "$work/small" "$work/small.c" ${SG_LINK_FLAGS:-} $libs || fail "linking with: $libs"
"$work/small" "$root/share/shapegram/grammars/haussmann.sg" || fail "the small program failed"

for file in vim/syntax/shapegram.vim vim/ftdetect/shapegram.vim vscode/package.json vscode/language-configuration.json \
    vscode/syntaxes/shapegram.tmLanguage.json; do
    [ -s "$root/share/shapegram/editors/$file" ] || fail "editors/$file is not installed"
done
for page in "$root"/share/man/man1/*.1; do
    [ -x "$root/bin/$(basename "$page" .1)" ] || fail "$page is of no program"
done
for program in "$root"/bin/*; do
    [ -f "$root/share/man/man1/${program##*/}.1" ] || fail "$program has no manual page"
    "$program" --version | grep -q shapegram || fail "$program --version"
done

$make -C "$SG_BUILD_DIR" uninstall DESTDIR="$work" >"$work/uninstall.log" 2>&1 || { cat "$work/uninstall.log"; fail "make uninstall"; }
left=$(find "$root" ! -type d)
[ -z "$left" ] || fail "left by make uninstall: $left"
echo "$(wc -l <<<"$headers") headers installed, linked with: $libs"
