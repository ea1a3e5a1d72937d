/* SPDX-License-Identifier: GPL-3.0-or-later */
/* failing_new.h - makes one allocation of C++ fail: ours and those of the C++ libraries that a test is linked with. */
#ifndef SG_TESTS_FAILING_NEW_H
#define SG_TESTS_FAILING_NEW_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The k-th allocation from now on throws std::bad_alloc, counted from 0. */
void test_fail_new(size_t k);
/** No more failures; true when the one that was asked for happened. */
int test_new_failed(void);

#ifdef __cplusplus
}
#endif

#endif
