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
for header in core/status.h core/random.h; do
    grep -qx "$header" <<<"$headers" || fail "$header is not installed"
done
if grep -E '_priv\.h$' <<<"$headers"; then fail "private headers are installed"; fi
for header in $headers; do
    printf '#include "%s"\n' "$header" >"$work/one.c"
    # shellcheck disable=SC2086
    $SG_CC -std=c17 -Wall -Wextra -Werror -fsyntax-only $cflags "$work/one.c" || fail "$header does not compile by itself"
done

cat >"$work/small.c" <<'C'
#include "core/arena.h"
#include "core/random.h"
#include "core/file.h"
#include <stdio.h>

int main(void)
{
    sg_arena *arena = sg_arena_create();
    gsl_rng *rng = sg_random_create(1);
    const double u = sg_random_uniform(rng);
    char *text = NULL;
    size_t length = 0;
    sg_error err = SG_ERROR_INIT;
    const sg_status st = sg_file_read("no such file.sg", 1000, arena, &text, &length, &err);
    printf("%d %s\n", u > 0 && u < 1, err.msg);
    gsl_rng_free(rng);
    sg_arena_free(arena);
    return st == SG_EINPUT && text == NULL ? 0 : 1;
}
C
# shellcheck disable=SC2086
$SG_CC -std=c17 $cflags -o "$work/small" "$work/small.c" ${SG_LINK_FLAGS:-} $libs || fail "linking with: $libs"
"$work/small" || fail "the small program failed"

for program in "$root"/bin/*; do
    [ -e "$program" ] || continue
    "$program" --version | grep -q shapegram || fail "$program --version"
done

$make -C "$SG_BUILD_DIR" uninstall DESTDIR="$work" >"$work/uninstall.log" 2>&1 || { cat "$work/uninstall.log"; fail "make uninstall"; }
left=$(find "$root" ! -type d)
[ -z "$left" ] || fail "left by make uninstall: $left"
echo "$(wc -l <<<"$headers") headers installed, linked with: $libs"
