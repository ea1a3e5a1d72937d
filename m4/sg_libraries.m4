# One macro a library; each sets X_CFLAGS and X_LIBS or stops with the Debian package to install.

AC_DEFUN([SG_NEED], [AC_MSG_ERROR([$1 is missing; on Debian and Ubuntu: apt-get install $2])])

AC_DEFUN([SG_PROG_FLEX_BISON], [
  AC_PROG_LEX([noyywrap])
  AC_PROG_YACC
  # The tarball carries the generated files: only a checkout needs the generators.
  AS_IF([test ! -f "$srcdir/src/grammar/sg_parser.c" && test "x$YACC" != "xbison -y"], [SG_NEED([bison], [bison])])
  AS_IF([test ! -f "$srcdir/src/grammar/sg_scanner.c" && test "x$LEX" != xflex], [SG_NEED([flex], [flex])])
])

AC_DEFUN([SG_LIB_GSL], [PKG_CHECK_MODULES([GSL], [gsl >= 2.5], [], [SG_NEED([GSL], [libgsl-dev])])
  # GSL's own CBLAS is not wanted: OpenBLAS brings one.
  GSL_LIBS=`AS_ECHO(["$GSL_LIBS"]) | $SED 's/-lgslcblas//'`])

AC_DEFUN([SG_LIB_LAPACKE], [
  PKG_CHECK_MODULES([OPENBLAS], [openblas], [], [SG_NEED([OpenBLAS], [libopenblas-dev])])
  PKG_CHECK_MODULES([LAPACKE], [lapacke], [], [SG_NEED([LAPACKE], [liblapacke-dev])])])

AC_DEFUN([SG_LIB_PNG], [PKG_CHECK_MODULES([PNG], [libpng >= 1.6], [], [SG_NEED([libpng], [libpng-dev])])])

AC_DEFUN([SG_LIB_JPEG], [PKG_CHECK_MODULES([JPEG], [libjpeg >= 1.5], [], [SG_NEED([libjpeg], [libjpeg-dev])])])

AC_DEFUN([SG_LIB_ZLIB], [PKG_CHECK_MODULES([ZLIB], [zlib], [], [SG_NEED([zlib], [zlib1g-dev])])])

AC_DEFUN([SG_LIB_JANSSON], [PKG_CHECK_MODULES([JANSSON], [jansson >= 2.10], [], [SG_NEED([jansson], [libjansson-dev])])])

# Only the OpenCV modules that the shims use: the whole list costs every program its start-up time.
AC_DEFUN([SG_LIB_OPENCV], [
  PKG_CHECK_MODULES([OPENCV], [opencv4 >= 4.5], [], [SG_NEED([OpenCV], [libopencv-dev])])
  sg_opencv_dirs=
  for sg_flag in $OPENCV_LIBS; do
    AS_CASE([$sg_flag], [-L*], [sg_opencv_dirs="$sg_opencv_dirs $sg_flag"])
  done
  OPENCV_LIBS="$sg_opencv_dirs -lopencv_ml -lopencv_imgcodecs -lopencv_imgproc -lopencv_core"])

AC_DEFUN([SG_LIB_RANDOM123], [
  AC_CHECK_HEADER([Random123/philox.h], [], [SG_NEED([Random123], [librandom123-dev])])])

AC_DEFUN([SG_LIB_UTHASH], [AC_CHECK_HEADER([uthash.h], [], [SG_NEED([uthash], [uthash-dev])])])

# Only "make check" needs Check.
AC_DEFUN([SG_LIB_CHECK], [
  PKG_CHECK_MODULES([CHECK], [check >= 0.12], [sg_have_check=yes],
    [sg_have_check=no; AC_MSG_WARN([Check is missing, so "make check" cannot run; on Debian and Ubuntu: apt-get install check])])
  AM_CONDITIONAL([HAVE_CHECK], [test "x$sg_have_check" = xyes])])
