/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_pins.c - draws and choices that --given takes from chance. */
#include "config.h"

#include "sample_job.h"

#include <stdlib.h>

sg_status sample_read_pins(sample_job *j, sg_error *err)
{
    const sample_options *o = j->opts;
    if (o->ngiven == 0)
        return SG_OK;
    SG_TRY(sg_pins_create(j->g, &j->pins, err));
    j->pin_uses = calloc(o->ngiven, sizeof *j->pin_uses);
    if (j->pin_uses == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t i = 0; i < o->ngiven; i++) {
        sg_error inner = SG_ERROR_INIT;
        if (sg_pins_add(j->pins, o->given[i], &inner) != SG_OK)
            return SG_FAIL(err, inner.code, "--given %.1000s", inner.msg);
    }
    return SG_OK;
}

void sample_count_pins(sample_job *j, const sample_worker *w)
{
    for (size_t k = 0; k < sg_pins_count(j->pins); k++)
        j->pin_uses[k] += sg_pin_run_uses(w->given, k);
}

void sample_warn_of_pins(const sample_job *j)
{
    for (size_t k = 0; j->pins != NULL && k < sg_pins_count(j->pins); k++)
        if (j->pin_uses[k] == 0)
            sg_program_complain("warning: --given %s: no sample has such a node, or a later one overrides it",
                                sg_pins_text(j->pins, k));
}
