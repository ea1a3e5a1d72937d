/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress.h - how long library calls say how far they are, and hear that they should stop. */
#ifndef SG_CORE_PROGRESS_H
#define SG_CORE_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

/** Passed to long calls; a zeroed one does nothing. */
typedef struct sg_progress {
    /** done of total units (total 0: not known) of the step named; called often, must be cheap. */
    void (*report)(struct sg_progress *self, const char *step, size_t done, size_t total);
    /** True when the work should end with what it has: the call then returns SG_STOPPED. */
    bool (*stop)(struct sg_progress *self);
    void *user;
} sg_progress;

static inline void sg_progress_report(sg_progress *p, const char *step, size_t done, size_t total)
{
    if (p != NULL && p->report != NULL)
        p->report(p, step, done, total);
}

static inline bool sg_progress_stopped(sg_progress *p)
{
    return p != NULL && p->stop != NULL && p->stop(p);
}

#endif
