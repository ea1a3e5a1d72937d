/* SPDX-License-Identifier: GPL-3.0-or-later */
/* evaluation.c - counting pixels, and what is divided by what. */
#include "config.h"

#include "parse/evaluation.h"

#include <math.h>
#include <string.h>

/* ---- confusion ---- */

sg_status sg_confusion_create(size_t nclasses, sg_arena *arena, sg_confusion *out, sg_error *err)
{
    uint64_t *counts = SG_NEW_ARRAY(arena, uint64_t, nclasses * (nclasses + 1));
    if (counts == NULL)
        return SG_FAIL_NOMEM(err);
    *out = (sg_confusion){nclasses, 0, counts, 0};
    return SG_OK;
}

sg_status sg_confusion_add(sg_confusion *c, const sg_label_map *truth, const sg_label_map *found,
                           const uint8_t class_of[256], sg_error *err)
{
    const size_t n = c->nclasses;
    if (truth->width != found->width || truth->height != found->height)
        return SG_FAIL(err, SG_EINVAL, "%zu x %zu pixels, but the truth has %zu x %zu", found->width, found->height,
                       truth->width, truth->height);
    for (size_t i = 0; i < truth->width * truth->height; i++) {
        const uint8_t t = truth->labels[i], f = class_of[found->labels[i]];
        if (t < n)
            c->counts[t * (n + 1) + (f < n ? f : n)]++;
        else
            c->ignored++;
    }
    c->nmaps++;
    return SG_OK;
}

void sg_confusion_merge(const sg_confusion *from, sg_confusion *to)
{
    for (size_t i = 0; i < to->nclasses * (to->nclasses + 1); i++)
        to->counts[i] += from->counts[i];
    to->nmaps += from->nmaps;
    to->ignored += from->ignored;
}

uint64_t sg_confusion_pixels(const sg_confusion *c, size_t class)
{
    uint64_t sum = 0;
    for (size_t k = 0; k <= c->nclasses; k++)
        sum += c->counts[class * (c->nclasses + 1) + k];
    return sum;
}

uint64_t sg_confusion_unclassed(const sg_confusion *c)
{
    uint64_t sum = 0;
    for (size_t k = 0; k < c->nclasses; k++)
        sum += c->counts[k * (c->nclasses + 1) + c->nclasses];
    return sum;
}

/* ---- classes by name ---- */

/* The found class that an alias is about, and the name it counts as. */
static sg_status read_alias(const sg_classes *found, const sg_classes *truth, const char *alias, int *class,
                            const char **name, sg_error *err)
{
    const char *equals = strchr(alias, '=');
    if (equals == NULL)
        return SG_FAIL(err, SG_EINVAL, "'%s' is no alias: NAME=OTHER", alias);
    *class = -1;
    for (size_t i = 0; i < found->nclasses; i++)
        if (strlen(found->names[i]) == (size_t)(equals - alias) &&
            strncmp(found->names[i], alias, (size_t)(equals - alias)) == 0)
            *class = (int)i;
    if (*class < 0)
        return SG_FAIL(err, SG_EINVAL, "alias '%s': the label maps found have no class %.*s", alias,
                       (int)(equals - alias), alias);
    *name = equals + 1;
    if (sg_classes_find(truth, *name) < 0)
        return SG_FAIL(err, SG_EINVAL, "alias '%s': the truth has no class %s", alias, *name);
    return SG_OK;
}

sg_status sg_evaluation_classes(const sg_classes *found, const sg_classes *truth, const char *const *aliases,
                                size_t naliases, uint8_t class_of[256], sg_error *err)
{
    const char *names[SG_MAX_CLASSES];
    for (size_t i = 0; i < found->nclasses; i++)
        names[i] = found->names[i];
    for (size_t a = 0; a < naliases; a++) {
        int class = 0;
        const char *name = NULL;
        SG_TRY(read_alias(found, truth, aliases[a], &class, &name, err));
        names[class] = name;
    }
    for (size_t v = 0; v < 256; v++) {
        const uint8_t f = found->class_of[v];
        const int t = f < found->nclasses ? sg_classes_find(truth, names[f]) : -1;
        class_of[v] = t >= 0 ? (uint8_t)t : SG_CLASS_UNKNOWN;
    }
    return SG_OK;
}

/* ---- scores ---- */

static size_t block_size(size_t nclasses)
{
    return nclasses * (nclasses + 3);
}

static sg_status create_scores(size_t nclasses, sg_arena *arena, sg_scores *out, sg_error *err)
{
    double *block = SG_NEW_ARRAY(arena, double, block_size(nclasses));
    if (block == NULL)
        return SG_FAIL_NOMEM(err);
    *out = (sg_scores){nclasses, NAN, NAN, NAN, block, block + nclasses, block + 2 * nclasses};
    return SG_OK;
}

/* Running mean of numbers, with what is none left out. */
typedef struct {
    double sum;
    size_t n;
} mean;

static void mean_add(mean *m, double x)
{
    if (isnan(x))
        return;
    m->sum += x;
    m->n++;
}

static double mean_value(const mean *m)
{
    return m->n > 0 ? m->sum / (double)m->n : NAN;
}

static uint64_t found_as(const sg_confusion *c, size_t class)
{
    uint64_t sum = 0;
    for (size_t k = 0; k < c->nclasses; k++)
        sum += c->counts[k * (c->nclasses + 1) + class];
    return sum;
}

static void score_class(const sg_confusion *c, size_t k, sg_scores *s)
{
    const size_t width = c->nclasses + 1;
    const uint64_t pixels = sg_confusion_pixels(c, k), right = c->counts[k * width + k];
    const uint64_t either = pixels + found_as(c, k) - right;
    for (size_t f = 0; f < width; f++)
        s->entries[k * width + f] = pixels > 0 ? (double)c->counts[k * width + f] / (double)pixels : NAN;
    s->recall[k] = s->entries[k * width + k];
    s->iou[k] = either > 0 ? (double)right / (double)either : NAN;
}

sg_status sg_scores_of(const sg_confusion *c, sg_arena *arena, sg_scores *out, sg_error *err)
{
    uint64_t right = 0, all = 0;
    mean recall = {0}, iou = {0};
    SG_TRY(create_scores(c->nclasses, arena, out, err));
    for (size_t k = 0; k < c->nclasses; k++) {
        score_class(c, k, out);
        mean_add(&recall, out->recall[k]);
        mean_add(&iou, out->iou[k]);
        right += c->counts[k * (c->nclasses + 1) + k];
        all += sg_confusion_pixels(c, k);
    }
    out->overall = all > 0 ? (double)right / (double)all : NAN;
    out->class_average = mean_value(&recall);
    out->mean_iou = mean_value(&iou);
    return SG_OK;
}

sg_status sg_scores_mean(const sg_scores *folds, size_t n, sg_arena *arena, sg_scores *out, sg_error *err)
{
    mean overall = {0}, average = {0}, iou = {0};
    if (n == 0)
        return SG_FAIL(err, SG_EINVAL, "no fold to take a mean of");
    SG_TRY(create_scores(folds[0].nclasses, arena, out, err));
    for (size_t i = 0; i < block_size(out->nclasses); i++) {
        mean m = {0};
        for (size_t f = 0; f < n; f++)
            mean_add(&m, folds[f].recall[i]); /* where the block begins */
        out->recall[i] = mean_value(&m);
    }
    for (size_t f = 0; f < n; f++) {
        mean_add(&overall, folds[f].overall);
        mean_add(&average, folds[f].class_average);
        mean_add(&iou, folds[f].mean_iou);
    }
    out->overall = mean_value(&overall);
    out->class_average = mean_value(&average);
    out->mean_iou = mean_value(&iou);
    return SG_OK;
}

/* In whole numbers: 29 of 100 pixels are 29 per cent, which 100 * 0.29 is a little less than. */
static void cut_entries(const sg_confusion *c, sg_scores *s)
{
    for (size_t k = 0; k < c->nclasses; k++) {
        const uint64_t pixels = sg_confusion_pixels(c, k);
        for (size_t i = k * (c->nclasses + 1); pixels > 0 && i < (k + 1) * (c->nclasses + 1); i++)
            s->entries[i] = (double)(100 * c->counts[i] / pixels) / 100;
    }
}

sg_status sg_scores_published(const sg_confusion *folds, size_t n, sg_arena *arena, sg_scores *out, sg_error *err)
{
    sg_scores *cut = SG_NEW_ARRAY(arena, sg_scores, n + 1);
    mean average = {0};
    if (cut == NULL)
        return SG_FAIL_NOMEM(err);
    for (size_t f = 0; f < n; f++) {
        SG_TRY(sg_scores_of(&folds[f], arena, &cut[f], err));
        cut_entries(&folds[f], &cut[f]);
    }
    SG_TRY(sg_scores_mean(cut, n, arena, out, err));
    for (size_t k = 0; k < out->nclasses; k++) {
        out->recall[k] = out->entries[k * (out->nclasses + 1) + k];
        out->iou[k] = NAN;
        mean_add(&average, out->recall[k]);
    }
    out->class_average = mean_value(&average);
    out->mean_iou = NAN;
    return SG_OK;
}
