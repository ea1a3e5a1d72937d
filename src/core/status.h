/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status.h - how a library call says that it failed.
 * A call returns a status and writes one sentence into the caller's sg_error. Nothing here prints, exits or keeps
 * a last error of its own. */
#ifndef SG_CORE_STATUS_H
#define SG_CORE_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    SG_OK,
    SG_EINVAL,   /* the caller's arguments make no sense */
    SG_EINPUT,   /* a file that was read is missing or bad */
    SG_ENOPARSE, /* a lattice or an image is outside the language */
    SG_ENUMERIC, /* no convergence, a singular matrix, a non-finite value */
    SG_ENOMEM,
    SG_EIO,     /* writing failed: disk full, no permission */
    SG_STOPPED, /* a signal or a limit ended the work; what was found so far is valid */
} sg_status;

typedef struct {
    sg_status code;
    char msg[1024];
} sg_error;

#define SG_ERROR_INIT {SG_OK, {0}}

/** Write the sentence and return the code. err may be NULL; an error that is there already is replaced.
 *  FILE:LINE:COL comes first in the sentence where there is a line. */
sg_status sg_fail(sg_error *err, sg_status code, const char *format, ...) __attribute__((format(printf, 3, 4)));

#define SG_FAIL(err, code, ...) sg_fail((err), (code), __VA_ARGS__)

/** The sentence for a failed allocation. */
#define SG_FAIL_NOMEM(err) sg_fail((err), SG_ENOMEM, "out of memory")

/** Return the status of EXPR from the calling function unless it is SG_OK. */
#define SG_TRY(expr)                                                                                                   \
    do {                                                                                                               \
        const sg_status sg_try_status_ = (expr);                                                                       \
        if (sg_try_status_ != SG_OK)                                                                                   \
            return sg_try_status_;                                                                                     \
    } while (0)

/** Exit status of a program that ends with this status: the one mapping (0 done, 1 failed, 2 usage, 3 bad input,
 *  4 system, 5 stopped). */
int sg_exit_code(sg_status status);

#ifdef __cplusplus
}
#endif

#endif
