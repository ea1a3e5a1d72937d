# SG_COMPILER_FLAGS
# Probe each warning by itself, so that an older or other compiler gets those that it knows.
# -Wextra brings gcc's -Wimplicit-fallthrough; clang's would find it in the macros of uthash.
# Sets SG_CFLAGS and SG_CXXFLAGS. --enable-werror makes warnings fatal.
AC_DEFUN([SG_COMPILER_FLAGS], [
  AC_ARG_ENABLE([werror], [AS_HELP_STRING([--enable-werror], [make every compiler warning an error])],
    [sg_werror=$enableval], [sg_werror=no])
  SG_CFLAGS=
  SG_CXXFLAGS=
  AC_LANG_PUSH([C])
  sg_save_flags=$CFLAGS
  for sg_try in -std=gnu17 -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes \
      -Wold-style-definition -Wpointer-arith -Wcast-qual -Wwrite-strings -Wvla -Wundef -Wformat=2 \
      -Wredundant-decls -Wnull-dereference -Wduplicated-cond -Wlogical-op \
      -ffp-contract=off -fno-math-errno; do
    AC_MSG_CHECKING([whether $CC takes $sg_try])
    CFLAGS="$sg_save_flags -Werror $sg_try"
    AC_COMPILE_IFELSE([AC_LANG_PROGRAM([], [])],
      [SG_CFLAGS="$SG_CFLAGS $sg_try"; AC_MSG_RESULT([yes])], [AC_MSG_RESULT([no])])
  done
  CFLAGS=$sg_save_flags
  AC_LANG_POP([C])
  AC_LANG_PUSH([C++])
  sg_save_flags=$CXXFLAGS
  for sg_try in -std=gnu++17 -Wall -Wextra -Wshadow -ffp-contract=off; do
    AC_MSG_CHECKING([whether $CXX takes $sg_try])
    CXXFLAGS="$sg_save_flags -Werror $sg_try"
    AC_COMPILE_IFELSE([AC_LANG_PROGRAM([], [])],
      [SG_CXXFLAGS="$SG_CXXFLAGS $sg_try"; AC_MSG_RESULT([yes])], [AC_MSG_RESULT([no])])
  done
  CXXFLAGS=$sg_save_flags
  AC_LANG_POP([C++])
  AS_IF([test "x$sg_werror" = xyes], [SG_CFLAGS="$SG_CFLAGS -Werror"; SG_CXXFLAGS="$SG_CXXFLAGS -Werror"])
  AC_SUBST([SG_CFLAGS])
  AC_SUBST([SG_CXXFLAGS])
])
