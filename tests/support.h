/* SPDX-License-Identifier: GPL-3.0-or-later */
/* support.h - what every Check program of ours begins and ends with. */
#ifndef SG_TESTS_SUPPORT_H
#define SG_TESTS_SUPPORT_H

#include <check.h>
#include <stdio.h>
#include <stdlib.h>

/** Folder with the sources ($SG_SOURCE_DIR), the build, and the shared data sets; "." where unset. */
static inline const char *test_folder(const char *variable)
{
    const char *folder = getenv(variable);
    return folder != NULL ? folder : ".";
}

/** Run the suite; the exit status of the test program. Each test runs in a process of its own. */
static inline int test_run(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/** A statement that must return SG_OK, with the sentence when it does not; needs `sg_error err` in scope. */
#define ck_ok(expr)                                                                                                    \
    do {                                                                                                               \
        const sg_status ck_status_ = (expr);                                                                           \
        ck_assert_msg(ck_status_ == SG_OK, "%s: status %d: %s", #expr, (int)ck_status_, err.msg);                      \
    } while (0)

/** The same without a word to the runner when all is well: for loops, where that would cost more than the rest. */
#define test_must(condition)                                                                                           \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            ck_abort_msg("%s:%d: %s", __FILE__, __LINE__, #condition);                                                 \
    } while (0)
#define test_must_ok(expr)                                                                                             \
    do {                                                                                                               \
        const sg_status test_status_ = (expr);                                                                         \
        if (test_status_ != SG_OK)                                                                                     \
            ck_abort_msg("%s:%d: %s: status %d: %s", __FILE__, __LINE__, #expr, (int)test_status_, err.msg);           \
    } while (0)

#endif
