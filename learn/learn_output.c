/* SPDX-License-Identifier: GPL-3.0-or-later */
/* learn_output.c - the grammar file and the JSON result. */
#include "config.h"

#include "learn/learn_output.h"

#include "core/file.h"

#include <jansson.h>
#include <string.h>

static sg_status print_language(const sg_split_form *form, FILE *out, sg_error *err)
{
    sg_grammar *g;
    SG_TRY(sg_grammar_from_split(form, &g, err));
    const sg_status st = sg_grammar_print(g, out, err);
    sg_grammar_free(g);
    return st;
}

sg_status sg_learn_write_grammar(const sg_split_form *form, const char *path, sg_error *err)
{
    const size_t length = strlen(path);
    const bool json = length > 5 && strcmp(path + length - 5, ".json") == 0;
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    const sg_status st = json ? sg_split_form_write_json(form, out.fp, err) : print_language(form, out.fp, err);
    return sg_output_end(&out, st, err);
}

static json_t *sizes_json(const sg_split_form *f)
{
    const sg_grammar_sizes s = sg_split_form_sizes(f);
    return json_pack("{s:I, s:I, s:I}", "nonterminals", (json_int_t)s.nonterminals, "rules_x", (json_int_t)s.rules_x,
                     "rules_y", (json_int_t)s.rules_y);
}

static const char *const regroups[] = {"none", "pairs", "floors"}; /* by sg_regroup_kind */

static json_t *result_json(const sg_learn_result *r, const sg_learn_opts *opts, double seconds)
{
    const sg_grammar_sizes s = sg_split_form_sizes(&r->merged);
    return json_pack(
        "{s:f, s:f, s:f, s:f, s:f, s:f, s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f, s:I, s:o, s:o, s:o, s:o, s:o}",
        "energy", r->energy.energy, "initial_energy", r->initial_energy.energy, "log_likelihood",
        r->energy.log_likelihood, "log_structure_prior", r->energy.log_structure_prior, "log_parameter_prior",
        r->energy.log_parameter_prior, "weight", opts->energy.weight, "regroup", regroups[r->regroup], "nonterminals",
        (json_int_t)s.nonterminals, "rules_x", (json_int_t)s.rules_x, "rules_y", (json_int_t)s.rules_y, "rules_lexical",
        (json_int_t)s.rules_lexical, "merges", (json_int_t)r->history.merges, "chunks", (json_int_t)r->history.chunks,
        "seconds", seconds, "energy_before_last_reestimation", r->searched_energy, "lattices_parsed",
        (json_int_t)r->parsed, "merged", sg_split_form_json(&r->merged), "grammar", sg_split_form_json(&r->finished),
        "initial", sizes_json(&r->initial), "finished", sizes_json(&r->finished), "initial_finished",
        sizes_json(&r->initial_finished));
}

sg_status sg_learn_write_json(const sg_learn_result *r, const sg_learn_opts *opts, double seconds, const char *path,
                              sg_error *err)
{
    json_t *root = result_json(r, opts, seconds);
    if (root == NULL)
        return SG_FAIL_NOMEM(err);
    sg_output out;
    sg_status st = sg_output_open(&out, path, err);
    if (st == SG_OK) {
        /* what fails here is the stream, and the commit says so */
        json_dumpf(root, out.fp, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
        fputc('\n', out.fp);
        st = sg_output_commit(&out, err);
    }
    json_decref(root);
    return st;
}
