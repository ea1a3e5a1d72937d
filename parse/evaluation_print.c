/* SPDX-License-Identifier: GPL-3.0-or-later */
/* evaluation_print.c - tables have one column a class, as wide as its name. */
#include "config.h"

#include "parse/evaluation_print.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* ---- tables ---- */

static int column_width(const char *name)
{
    const int n = (int)strlen(name);
    return n < 6 ? 6 : n;
}

static int longest_name(const sg_classes *classes)
{
    int width = 6;
    for (size_t k = 0; k < classes->nclasses; k++)
        width = column_width(classes->names[k]) > width ? column_width(classes->names[k]) : width;
    return width;
}

/* A share in per cent, or a dash. */
static void print_share(double share, int width, int digits, FILE *out)
{
    if (isnan(share))
        fprintf(out, " %*s", width, "-");
    else
        fprintf(out, " %*.*f", width, digits, 100 * share);
}

static void print_row(const sg_confusion *c, const sg_scores *s, const sg_classes *classes, size_t k, bool others,
                      FILE *out)
{
    const size_t n = c->nclasses;
    fprintf(out, "%-*s", longest_name(classes), classes->names[k]);
    for (size_t f = 0; f < n; f++)
        print_share(s->entries[k * (n + 1) + f], column_width(classes->names[f]), 1, out);
    if (others)
        print_share(s->entries[k * (n + 1) + n], 6, 1, out);
    fprintf(out, "  %10" PRIu64, sg_confusion_pixels(c, k));
    print_share(s->iou[k], 6, 1, out);
    fputc('\n', out);
}

static void print_sum(const sg_confusion *c, const sg_scores *s, FILE *out)
{
    uint64_t pixels = 0;
    for (size_t k = 0; k < c->nclasses; k++)
        pixels += sg_confusion_pixels(c, k);
    if (pixels == 0) {
        fprintf(out, "no pixel to score in %zu map%s\n", c->nmaps, c->nmaps == 1 ? "" : "s");
        return;
    }
    fprintf(out, "overall %.2f%%   class average %.2f%%   mean IoU %.2f%%   %zu map%s, %" PRIu64 " pixels", 100 * s->overall,
            100 * s->class_average, 100 * s->mean_iou, c->nmaps, c->nmaps == 1 ? "" : "s", pixels);
    if (c->ignored > 0)
        fprintf(out, " (%" PRIu64 " more are ignored)", c->ignored);
    fputc('\n', out);
}

void sg_confusion_print(const sg_confusion *c, const sg_scores *s, const sg_classes *classes, FILE *out)
{
    const uint64_t others = sg_confusion_unclassed(c);
    fprintf(out, "%-*s", longest_name(classes), "truth");
    for (size_t k = 0; k < c->nclasses; k++)
        fprintf(out, " %*s", column_width(classes->names[k]), classes->names[k]);
    fprintf(out, "%s  %10s %6s\n", others > 0 ? "  other" : "", "pixels", "IoU");
    for (size_t k = 0; k < c->nclasses; k++)
        print_row(c, s, classes, k, others > 0, out);
    if (others > 0)
        fprintf(out, "other: %" PRIu64 " pixels that were found to be no class of the truth's; they count as errors\n", others);
    print_sum(c, s, out);
}

void sg_scores_print_heading(const char *first, const sg_classes *classes, FILE *out)
{
    fprintf(out, "%-10s %5s %8s %9s %8s  ", first, "maps", "overall", "class av.", "mean IoU");
    for (size_t k = 0; k < classes->nclasses; k++)
        fprintf(out, " %*s", column_width(classes->names[k]), classes->names[k]);
    fputc('\n', out);
}

void sg_scores_print_line(const char *name, size_t nmaps, const sg_classes *classes, const sg_scores *s, FILE *out)
{
    fprintf(out, "%-10s %5zu", name, nmaps);
    print_share(s->overall, 8, 2, out);
    print_share(s->class_average, 9, 2, out);
    print_share(s->mean_iou, 8, 2, out);
    fputs("  ", out);
    for (size_t k = 0; k < s->nclasses; k++)
        print_share(s->recall[k], column_width(classes->names[k]), 2, out);
    fputc('\n', out);
}

/* ---- JSON; a value that could not be made leaves a gap, which `whole` finds out ---- */

static json_t *share_json(double share)
{
    return isnan(share) ? json_null() : json_real(share);
}

static json_t *by_class(const double *share, const sg_classes *classes)
{
    json_t *o = json_object();
    for (size_t k = 0; o != NULL && k < classes->nclasses; k++)
        if (json_object_set_new(o, classes->names[k], share_json(share[k])) != 0) {
            json_decref(o);
            return NULL;
        }
    return o;
}

/* Rows of n values each, `stride` apart; counts in place of shares where they are given. */
static json_t *rows_json(const double *shares, const uint64_t *counts, size_t n, size_t stride)
{
    json_t *rows = json_array();
    bool good = rows != NULL;
    for (size_t k = 0; good && k < n; k++) {
        json_t *row = json_array();
        for (size_t f = 0; good && f < n; f++) {
            const size_t i = k * stride + f;
            good = json_array_append_new(row, counts != NULL ? json_integer((json_int_t)counts[i]) : share_json(shares[i])) == 0;
        }
        good = json_array_append_new(rows, row) == 0 && good;
    }
    if (good)
        return rows;
    json_decref(rows);
    return NULL;
}

static bool add_counts(json_t *o, const sg_confusion *c, const sg_classes *classes)
{
    json_t *others = json_object();
    bool good = others != NULL;
    for (size_t k = 0; good && k < c->nclasses; k++) {
        const uint64_t n = c->counts[k * (c->nclasses + 1) + c->nclasses];
        good = json_object_set_new(others, classes->names[k], json_integer((json_int_t)n)) == 0;
    }
    good = json_object_set_new(o, "counts", rows_json(NULL, c->counts, c->nclasses, c->nclasses + 1)) == 0 && good;
    good = json_object_set_new(o, "unclassed", others) == 0 && good;
    good = json_object_set_new(o, "ignored", json_integer((json_int_t)c->ignored)) == 0 && good;
    return json_object_set_new(o, "maps", json_integer((json_int_t)c->nmaps)) == 0 && good;
}

json_t *sg_scores_json(const sg_confusion *c, const sg_scores *s, const sg_classes *classes)
{
    json_t *o = json_object();
    bool good = o != NULL;
    good = good && json_object_set_new(o, "overall", share_json(s->overall)) == 0;
    good = good && json_object_set_new(o, "class_average", share_json(s->class_average)) == 0;
    good = good && json_object_set_new(o, "mean_iou", share_json(s->mean_iou)) == 0;
    good = good && json_object_set_new(o, "per_class", by_class(s->recall, classes)) == 0;
    good = good && json_object_set_new(o, "iou_per_class", by_class(s->iou, classes)) == 0;
    good = good && json_object_set_new(o, "confusion", rows_json(s->entries, NULL, s->nclasses, s->nclasses + 1)) == 0;
    good = good && (c == NULL || add_counts(o, c, classes));
    if (good)
        return o;
    json_decref(o);
    return NULL;
}
