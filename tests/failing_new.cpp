/* SPDX-License-Identifier: GPL-3.0-or-later */
/* failing_new.cpp - failing_new.h: the process's operator new, OpenCV's too. */
#include "tests/failing_new.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace
{
std::atomic<size_t> asked{0}, fail_at{static_cast<size_t>(-1)};
}

void test_fail_new(size_t k)
{
    asked = 0;
    fail_at = k;
}

int test_new_failed(void)
{
    const int happened = asked > fail_at;
    fail_at = static_cast<size_t>(-1);
    return happened;
}

void *operator new(size_t n)
{
    if (asked++ == fail_at)
        throw std::bad_alloc();
    void *p = std::malloc(n > 0 ? n : 1);
    if (p == nullptr)
        throw std::bad_alloc();
    return p;
}

void operator delete(void *p) noexcept
{
    std::free(p);
}

void operator delete(void *p, size_t) noexcept
{
    std::free(p);
}
