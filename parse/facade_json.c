/* SPDX-License-Identifier: GPL-3.0-or-later */
/* facade_json.c - what became of a photograph, for machines. A value that cannot be made is NULL, and what it is put into
 * then fails too: so only the last step is looked at. */
#include "config.h"

#include "parse/facade_process.h"

#include <math.h>

const char *sg_move_name(sg_move_kind kind)
{
    static const char *const names[SG_MOVE_KINDS] = {"jump-fresh", "jump-copy", "resample", "reflect", "shift", "switch"};
    return names[kind];
}

/* Add to an object; a NULL object stays NULL, and one that cannot take the value becomes NULL. */
static json_t *with(json_t *o, const char *key, json_t *value)
{
    if (o != NULL && value != NULL && json_object_set_new_nocheck(o, key, value) == 0)
        return o;
    if (o == NULL || value == NULL) /* a value that was given has been let go */
        json_decref(value);
    json_decref(o);
    return NULL;
}

static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *ratio(uint64_t part, uint64_t whole)
{
    return whole > 0 ? json_real((double)part / (double)whole) : json_null();
}

static json_t *with_energy(json_t *o, const sg_energy *e)
{
    o = with(o, "energy", number(sg_energy_sum(e)));
    o = with(o, "energy_image", number(e->image));
    o = with(o, "energy_rule", number(e->rule));
    return with(o, "energy_attribute", number(e->attribute));
}

static json_t *acceptance(const sg_chain_stats *s)
{
    json_t *o = json_object();
    for (int k = 0; k < SG_MOVE_KINDS; k++)
        if (s->proposed[k] > 0)
            o = with(o, sg_move_name((sg_move_kind)k), ratio(s->accepted[k], s->proposed[k]));
    return with(o, "second-stage", ratio(s->second_accepted, s->second_proposed));
}

static json_t *run_energies(const sg_facade_outcome *out)
{
    json_t *list = json_array();
    for (size_t i = 0; list != NULL && i < out->nruns; i++)
        if (json_array_append_new(list, number(out->run_energies[i])) != 0) {
            json_decref(list);
            return NULL;
        }
    return list;
}

static json_t *with_search(json_t *o, const sg_facade_outcome *out)
{
    o = with(o, "moves", json_integer((json_int_t)out->moves));
    o = with(o, "acceptance", acceptance(&out->stats));
    o = with(o, "swap_rate", ratio(out->swaps_accepted, out->swaps_proposed));
    o = with(o, "run_energies", run_energies(out));
    o = with(o, "best_run", json_integer((json_int_t)out->best_run));
    return with(o, "samples", json_integer((json_int_t)out->nsamples));
}

static json_t *with_exact(json_t *o, const sg_facade_outcome *out)
{
    o = with(o, "energy_lattice", number(out->energy_lattice));
    o = with(o, "lattice_columns", json_integer((json_int_t)out->columns));
    o = with(o, "lattice_rows", json_integer((json_int_t)out->rows));
    return with(o, "chart_states", json_integer((json_int_t)out->states));
}

/* One object a stage, when there was more than one. */
static json_t *with_stages(json_t *o, const sg_facade_outcome *out)
{
    json_t *stages = json_object();
    int n = 0;
    for (int s = 0; s < SG_FACADE_STAGES; s++) {
        const sg_facade_stage_outcome *stage = &out->stages[s];
        if (!stage->done)
            continue;
        json_t *one = with_energy(json_object(), &stage->energy);
        one = with(one, "seconds", number(stage->seconds));
        one = with(one, "accuracy", number(stage->accuracy));
        stages = with(stages, sg_facade_stage_name((sg_facade_stage)s), one);
        n++;
    }
    if (n > 1)
        return with(o, "stages", stages);
    json_decref(stages);
    return o;
}

/* All that the photograph was not parsed for stays null. */
static json_t *failure(json_t *o, const sg_facade_outcome *out)
{
    static const char *const keys[] = {"energy",  "energy_image",     "energy_rule", "energy_attribute",
                                       "seconds", "moves_per_second", "accuracy"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        o = with(o, keys[i], json_null());
    json_t *text = json_string(out->error.msg); /* a sentence that was cut may end within a character */
    return with(o, "error", text != NULL ? text : json_string("no sentence in UTF-8"));
}

json_t *sg_facade_outcome_json(const sg_facade_photo *photo, const sg_facade_outcome *out)
{
    json_t *o = with(json_object(), "image", json_string(photo->image != NULL ? photo->image : photo->name));
    o = with(o, "name", json_string(photo->name));
    if (!out->stages[out->best].done || (out->status != SG_OK && out->status != SG_STOPPED))
        return failure(o, out);
    const sg_facade_stage_outcome *best = &out->stages[out->best];
    o = with(o, "method", json_string(sg_facade_stage_name(out->best)));
    o = with(o, "stopped", json_boolean(out->status == SG_STOPPED));
    o = with(o, "width", json_integer((json_int_t)out->width));
    o = with(o, "height", json_integer((json_int_t)out->height));
    o = with_energy(o, &best->energy);
    o = with(o, "seconds", number(out->seconds));
    o = with(o, "unary_seconds", number(out->unary_seconds));
    o = with(o, "moves_per_second", number(out->searched && out->search_seconds > 0 ? (double)out->moves / out->search_seconds : NAN));
    o = with(o, "accuracy", number(best->accuracy));
    if (out->scored)
        o = with(o, "map_accuracy", number(sg_confusion_accuracy(&out->map)));
    if (out->searched)
        o = with_search(o, out);
    if (out->stages[SG_FACADE_EXACT].done)
        o = with_exact(o, out);
    return with_stages(o, out);
}
