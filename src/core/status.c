/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status.c - statuses, sentences, exit codes. */
#include "core/status.h"

#include <stdarg.h>
#include <stdio.h>

sg_status sg_fail(sg_error *err, sg_status code, const char *format, ...)
{
    if (err == NULL)
        return code;
    va_list ap;
    va_start(ap, format);
    vsnprintf(err->msg, sizeof err->msg, format, ap);
    va_end(ap);
    err->code = code;
    return code;
}

int sg_exit_code(sg_status status)
{
    switch (status) {
    case SG_OK:
        return 0;
    case SG_ENOPARSE:
    case SG_ENUMERIC:
        return 1;
    case SG_EINVAL:
        return 2;
    case SG_EINPUT:
        return 3;
    case SG_ENOMEM:
    case SG_EIO:
        return 4;
    case SG_STOPPED:
        return 5;
    }
    return 1;
}
