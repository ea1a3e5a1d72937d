/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_node.c - fields of a node; jansson prints strings and numbers. */
#include "scene/json_node.h"

#include <jansson.h>
#include <math.h>

/* Print a value and let it go. */
static sg_status print_value(json_t *v, FILE *out, sg_error *err)
{
    if (v == NULL)
        return SG_FAIL_NOMEM(err);
    const int failed = json_dumpf(v, out, JSON_ENCODE_ANY | JSON_COMPACT);
    json_decref(v);
    return failed == 0 ? SG_OK : SG_FAIL(err, SG_EIO, "writing a derivation failed");
}

static json_t *number(double x)
{
    if (isfinite(x))
        return json_real(x);
    return json_string(isnan(x) ? (signbit(x) ? "-nan" : "nan") : x < 0 ? "-inf" : "inf");
}

sg_status sg_json_numbers(const double *x, size_t n, FILE *out, sg_error *err)
{
    json_t *list = json_array();
    for (size_t i = 0; list != NULL && i < n; i++) {
        if (json_array_append_new(list, number(x[i])) != 0) {
            json_decref(list);
            list = NULL;
        }
    }
    return print_value(list, out, err);
}

sg_status sg_json_name(const char *name, FILE *out, sg_error *err)
{
    return print_value(json_string(name), out, err);
}

sg_status sg_json_node_begin(const sg_derivation *d, size_t node, FILE *out, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    if (n->rule < SG_RULE_EMPTY)
        fprintf(out, "{\"rule\":%u", (unsigned)n->rule);
    else
        fprintf(out, "{\"rule\":%s,\"symbol_number\":%u", n->rule == SG_NONE ? "null" : "\"empty\"", (unsigned)n->symbol);
    fputs(",\"symbol\":", out);
    SG_TRY(sg_json_name(sg_grammar_symbol(d->grammar, n->symbol)->name, out, err));
    if (node == 0 && n->depth > 0)
        fprintf(out, ",\"depth\":%u", (unsigned)n->depth);
    return SG_OK;
}

sg_status sg_json_node_end(const sg_derivation *d, size_t node, FILE *out, sg_error *err)
{
    const sg_node *n = d->nodes + node;
    const bool last = node + 1 == d->nnodes;
    const size_t nuniforms = (last ? d->nuniforms : n[1].uniforms) - n->uniforms;
    const size_t nvalues = (last ? d->nvalues : n[1].values) - n->values;
    if (nuniforms > 0) {
        fputs(",\"uniforms\":", out);
        SG_TRY(sg_json_numbers(d->uniforms + n->uniforms, nuniforms, out, err));
    }
    if (nvalues > 0) {
        fputs(",\"values\":", out);
        SG_TRY(sg_json_numbers(d->values + n->values, nvalues, out, err));
    }
    fputs(",\"children\":[", out);
    return SG_OK;
}
