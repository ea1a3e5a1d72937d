# SPDX-License-Identifier: GPL-3.0-or-later
# setup.sh - what check.sh and demo.sh share: packages, bootstrap, configure, build. To be sourced, from the top folder.
# A step that fails shows the end of its log and ends the script. Steps whose work is done already do nothing.

say() { printf '%s\n' "$*"; }
die() { printf '%s: %s\n' "${0##*/}" "$*" >&2; exit 1; }

# run_step TITLE LOG COMMAND...: quiet when it works, the end of the log when it does not.
run_step() {
    local title=$1 log=$2 start=$SECONDS
    shift 2
    mkdir -p "$(dirname "$log")"
    printf '== %s ...' "$title"
    if "$@" >"$log" 2>&1 </dev/null; then
        printf ' done (%d s)\n' $((SECONDS - start))
    else
        printf ' FAILED\n'
        tail -n 40 "$log" >&2
        die "$title failed; the whole log is in $log"
    fi
}

# What is needed, as PROBE:WHAT:PACKAGE. Probes ask for the thing itself, so other systems and hand-made installations
# count as well.
needs_build='command:gcc:gcc command:g++:g++ command:make:make command:autoreconf:autoconf command:automake:automake
command:pkg-config:pkg-config command:flex:flex command:bison:bison command:xz:xz-utils module:gsl:libgsl-dev
module:openblas:libopenblas-dev module:lapacke:liblapacke-dev module:libpng:libpng-dev module:libjpeg:libjpeg-dev
module:zlib:zlib1g-dev module:jansson:libjansson-dev module:opencv4:libopencv-dev header:Random123/philox.h:librandom123-dev header:uthash.h:uthash-dev'
needs_check='module:check:check command:mandoc:mandoc command:dot:graphviz command:assimp:assimp-utils'
needs_demo='command:dot:graphviz'
needs_clang='command:clang:clang command:clang++:clang header:omp.h:libomp-dev'

has_header() {
    local folder
    for folder in /usr/include /usr/local/include /usr/lib/llvm-*/lib/clang/*/include; do
        [ -f "$folder/$1" ] && return 0
    done
    return 1
}

is_there() { # PROBE WHAT
    case $1 in
        command) command -v "$2" >/dev/null ;;
        module) command -v pkg-config >/dev/null && pkg-config --exists "$2" ;;
        header) has_header "$2" ;;
    esac
}

missing_packages() { # NEED...
    local need probe what package
    for need in "$@"; do
        IFS=: read -r probe what package <<<"$need"
        is_there "$probe" "$what" || printf '%s\n' "$package"
    done | sort -u
}

apt_install() { # PREFIX PACKAGE...: PREFIX is sudo or empty
    local as_root=$1
    shift
    $as_root apt-get -q update &&
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends install "$@"
}

# install_missing NEED...: through apt; where that cannot be done, print the command that would and stop.
install_missing() {
    local packages as_root=
    packages=$(missing_packages "$@" | tr '\n' ' ')
    packages=${packages% }
    [ -n "$packages" ] || return 0
    local by_hand="apt-get update && apt-get install --no-install-recommends $packages"
    if ! command -v apt-get >/dev/null; then
        say "These packages are missing, and there is no apt-get here. On Debian or Ubuntu they come with"
        say "    $by_hand"
        die "install what they hold, then run this again"
    fi
    if [ "$(id -u)" != 0 ]; then
        if [ -t 0 ]; then as_root=sudo; else as_root='sudo -n'; fi
        # The password is asked for here and not behind a log file.
        if ! command -v sudo >/dev/null || ! $as_root -v; then
            say "Packages are missing, and this user cannot install them. As root:"
            say "    $by_hand"
            die "then run this again"
        fi
    fi
    say "Packages to install: $packages"
    # shellcheck disable=SC2086
    run_step "installing packages" build/log/packages.log apt_install "$as_root" $packages
}

cores() { nproc 2>/dev/null || getconf _NPROCESSORS_ONLN; }

# bootstrap: a checkout has no configure; a tarball has.
bootstrap() {
    local file
    for file in configure Makefile.in config.h.in build-aux/install-sh; do
        if [ ! -e "$file" ] || [ configure.ac -nt configure ]; then
            run_step "making configure" build/log/bootstrap.log autoreconf --force --install
            return
        fi
    done
}

# configure_in FOLDER OPTION...: again only when the options or configure itself changed.
configure_in() {
    local folder=$1
    shift
    mkdir -p "$folder"
    if [ -f "$folder/config.status" ] && [ -f "$folder/Makefile" ] && [ ! configure -nt "$folder/config.status" ] &&
        [ "$(cat "$folder/.options" 2>/dev/null)" = "$*" ]; then
        return 0
    fi
    [ ! -f config.status ] || die "this folder itself is configured; run 'make distclean' in it first"
    run_step "configuring in $folder/" "$folder/log/configure.log" configure_here "$folder" "$@"
    printf '%s' "$*" >"$folder/.options"
}

configure_here() { # FOLDER OPTION...
    (cd "$1" && shift && ../configure "$@")
}

build_in() { # FOLDER TARGET...
    local folder=$1
    shift
    run_step "building in $folder/ on $(cores) cores" "$folder/log/build.log" make -C "$folder" -j"$(cores)" "$@"
}
