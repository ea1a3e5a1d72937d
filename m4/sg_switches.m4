# SG_FUZZERS: --enable-fuzzers makes tests/fuzz_* targets of libFuzzer, with the sanitizers on; clang has it.
AC_DEFUN([SG_FUZZERS], [
  AC_ARG_ENABLE([fuzzers],
    [AS_HELP_STRING([--enable-fuzzers], [build the fuzzers for libFuzzer (CC=clang CXX=clang++), with --enable-sanitizers])],
    [sg_fuzzers=$enableval], [sg_fuzzers=no])
  AS_IF([test "x$sg_fuzzers" = xyes], [
    AC_MSG_CHECKING([whether $CC has libFuzzer])
    sg_saved_cflags=$CFLAGS
    CFLAGS="$CFLAGS -fsanitize=fuzzer"
    AC_LINK_IFELSE([AC_LANG_SOURCE([[#include <stddef.h>
#include <stdint.h>
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return size > 0 && data[0] == 0 ? 0 : 0; }]])],
      [AC_MSG_RESULT([yes])],
      [AC_MSG_RESULT([no])
       AC_MSG_ERROR([--enable-fuzzers needs clang and its libFuzzer: CC=clang CXX=clang++, libclang-rt-*-dev])])
    CFLAGS=$sg_saved_cflags
    SG_CFLAGS="$SG_CFLAGS -fsanitize=fuzzer-no-link"; SG_CXXFLAGS="$SG_CXXFLAGS -fsanitize=fuzzer-no-link"])
  AM_CONDITIONAL([FUZZERS], [test "x$sg_fuzzers" = xyes])
])

# SG_SANITIZERS: --enable-sanitizers builds with AddressSanitizer and UndefinedBehaviorSanitizer.
AC_DEFUN([SG_SANITIZERS], [
  AC_ARG_ENABLE([sanitizers], [AS_HELP_STRING([--enable-sanitizers], [build with ASan and UBSan])],
    [sg_sanitizers=$enableval], [sg_sanitizers=$sg_fuzzers])
  AS_IF([test "x$sg_sanitizers" = xyes], [
    sg_san="-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer"
    SG_CFLAGS="$SG_CFLAGS $sg_san"; SG_CXXFLAGS="$SG_CXXFLAGS $sg_san"; SG_LDFLAGS="$SG_LDFLAGS $sg_san"])
  AC_SUBST([SG_LDFLAGS])
])

# SG_COVERAGE: --enable-coverage instruments the code for gcov.
AC_DEFUN([SG_COVERAGE], [
  AC_ARG_ENABLE([coverage], [AS_HELP_STRING([--enable-coverage], [instrument the code for gcov])],
    [sg_coverage=$enableval], [sg_coverage=no])
  AS_IF([test "x$sg_coverage" = xyes], [
    SG_CFLAGS="$SG_CFLAGS --coverage"; SG_CXXFLAGS="$SG_CXXFLAGS --coverage"
    SG_LDFLAGS="$SG_LDFLAGS --coverage"])
])

# SG_SWITCH_ARENA_DEBUG: --enable-arena-debug makes each arena allocation a malloc, so that ASan sees it.
AC_DEFUN([SG_SWITCH_ARENA_DEBUG], [
  AC_ARG_ENABLE([arena-debug], [AS_HELP_STRING([--enable-arena-debug], [make each arena allocation a malloc of its own])],
    [sg_arena_debug=$enableval], [sg_arena_debug=no])
  AS_IF([test "x$sg_arena_debug" = xyes],
    [AC_DEFINE([SG_ARENA_DEBUG], [1], [each arena allocation is a malloc of its own])])
])
