/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_rich.c - channels (features_channels.c) summed up over boxes, rows and columns, looked up here and farther
 * off.
 *
 * The table below is the set: a line takes a channel, or several that follow each other, sums it up in one way, and
 * looks the result up at a list of places. What a line is worth is measured (experiments). A change of the set, of a
 * channel or of a sum is a new version. */
#include "config.h"

#include "parse/features_channels_priv.h"
#include "parse/features_priv.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PAD 100 /* px: how far off a feature may lie */

/* ---- the table ---- */

typedef enum {
    SUM_NONE, /* the channel itself */
    SUM_MEAN, /* mean and standard deviation over a box */
    SUM_SD,
    SUM_ROW, /* mean over the row: smoothed over `box` rows */
    SUM_ROW_SD,
    SUM_COLUMN,
    SUM_COLUMN_SD,
    SUM_ABOVE, /* mean over what lies above in a strip `box` px wide, the pixel included */
    SUM_BELOW,
    SUM_LEFT,
    SUM_RIGHT,
} sum_kind;

typedef enum { AT_HERE, AT_CROSS, AT_RING, AT_WIDE, AT_FAR, AT_VERTICAL, AT_HORIZONTAL } place_kind;

/* Places, in units of a line's step. */
static const signed char places[][2] = {
    {0, 0},   {-1, 0}, {1, 0},  {0, -1}, {0, 1},                  /* here; a cross */
    {-1, -1}, {1, -1}, {-1, 1}, {1, 1},                           /* a ring */
    {-2, 0},  {2, 0},  {0, -2}, {0, 2},                           /* wide */
    {-3, 0},  {3, 0},  {0, -3}, {0, 3},                           /* far */
    {0, 0},   {0, -1}, {0, 1},  {0, -2}, {0, 2}, {0, -4}, {0, 4}, /* vertical */
    {0, 0},   {-1, 0}, {1, 0},  {-2, 0}, {2, 0}, {-4, 0}, {4, 0}, /* horizontal */
};

static const struct {
    unsigned char first, n;
} place_lists[] = {
    [AT_HERE] = {0, 1}, [AT_CROSS] = {0, 5},     [AT_RING] = {0, 9},        [AT_WIDE] = {0, 13},
    [AT_FAR] = {0, 17}, [AT_VERTICAL] = {17, 7}, [AT_HORIZONTAL] = {24, 7},
};

typedef struct {
    unsigned char channel, nchannels;
    unsigned char sum, box;     /* px, odd */
    unsigned char places, step; /* px */
} line;

static const line lines[] = {
    /* colour and filter bank, point by point */
    {SG_CHANNEL_L, 6, SUM_NONE, 0, AT_HERE, 0},
    {SG_CHANNEL_BLUR_L1, 9, SUM_NONE, 0, AT_RING, 5},
    {SG_CHANNEL_LAPLACIAN1, 8, SUM_NONE, 0, AT_CROSS, 8},
    /* boxes of colour */
    {SG_CHANNEL_L, 3, SUM_MEAN, 7, AT_RING, 7},
    {SG_CHANNEL_L, 3, SUM_MEAN, 15, AT_FAR, 15},
    {SG_CHANNEL_L, 3, SUM_MEAN, 31, AT_FAR, 31},
    {SG_CHANNEL_L, 3, SUM_MEAN, 61, AT_RING, 61},
    {SG_CHANNEL_SATURATION, 1, SUM_MEAN, 15, AT_CROSS, 15},
    {SG_CHANNEL_L, 3, SUM_SD, 7, AT_CROSS, 7},
    {SG_CHANNEL_L, 3, SUM_SD, 15, AT_RING, 15},
    {SG_CHANNEL_L, 3, SUM_SD, 31, AT_WIDE, 31},
    {SG_CHANNEL_L, 3, SUM_SD, 61, AT_RING, 61},
    /* texture: gradients, orientations, patterns in cells */
    {SG_CHANNEL_GRADIENT, 3, SUM_MEAN, 7, AT_RING, 7},
    {SG_CHANNEL_GRADIENT, 3, SUM_MEAN, 15, AT_WIDE, 15},
    {SG_CHANNEL_GRADIENT, 3, SUM_MEAN, 31, AT_FAR, 31},
    {SG_CHANNEL_ORIENTATION, 8, SUM_MEAN, 9, AT_CROSS, 9},
    {SG_CHANNEL_ORIENTATION, 8, SUM_MEAN, 21, AT_CROSS, 21},
    {SG_CHANNEL_PATTERN, 10, SUM_MEAN, 13, AT_HERE, 0},
    {SG_CHANNEL_PATTERN, 10, SUM_MEAN, 31, AT_CROSS, 31},
    {SG_CHANNEL_LAPLACIAN1, 8, SUM_SD, 15, AT_CROSS, 15},
    /* rows and columns */
    {SG_CHANNEL_L, 3, SUM_ROW, 1, AT_VERTICAL, 10},
    {SG_CHANNEL_L, 3, SUM_ROW, 15, AT_VERTICAL, 20},
    {SG_CHANNEL_L, 3, SUM_ROW_SD, 1, AT_VERTICAL, 10},
    {SG_CHANNEL_GRADIENT_X, 2, SUM_ROW, 1, AT_VERTICAL, 10},
    {SG_CHANNEL_GRADIENT_X, 2, SUM_ROW, 15, AT_VERTICAL, 20},
    {SG_CHANNEL_L, 3, SUM_COLUMN, 1, AT_HORIZONTAL, 10},
    {SG_CHANNEL_L, 3, SUM_COLUMN, 15, AT_HORIZONTAL, 20},
    {SG_CHANNEL_L, 3, SUM_COLUMN_SD, 1, AT_HORIZONTAL, 10},
    {SG_CHANNEL_GRADIENT_X, 2, SUM_COLUMN, 1, AT_HORIZONTAL, 10},
    {SG_CHANNEL_GRADIENT_X, 2, SUM_COLUMN, 15, AT_HORIZONTAL, 20},
    {SG_CHANNEL_L, 3, SUM_ABOVE, 15, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SUM_BELOW, 15, AT_HERE, 0},
    {SG_CHANNEL_GRADIENT, 3, SUM_ABOVE, 15, AT_HERE, 0},
    {SG_CHANNEL_GRADIENT, 3, SUM_BELOW, 15, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SUM_LEFT, 15, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SUM_RIGHT, 15, AT_HERE, 0},
    /* position */
    {SG_CHANNEL_X, 5, SUM_NONE, 0, AT_HERE, 0},
};
enum { NLINES = sizeof lines / sizeof lines[0] };

static size_t planes(const sg_feature_set *set)
{
    (void)set;
    size_t n = 0;
    for (size_t i = 0; i < NLINES; i++)
        n += lines[i].nchannels;
    return n;
}

static size_t count(const sg_feature_set *set)
{
    (void)set;
    size_t n = 0;
    for (size_t i = 0; i < NLINES; i++)
        n += (size_t)lines[i].nchannels * place_lists[lines[i].places].n;
    return n;
}

static size_t pad(const sg_feature_set *set)
{
    (void)set;
    return PAD;
}

/* Features go by lines, then by places, then by channels. */
static sg_feature_place place(const sg_feature_set *set, size_t f)
{
    (void)set;
    size_t plane = 0, i = 0;
    for (size_t n; f >= (n = (size_t)lines[i].nchannels * place_lists[lines[i].places].n); i++) {
        f -= n;
        plane += lines[i].nchannels;
    }
    const signed char *at = places[place_lists[lines[i].places].first + f / lines[i].nchannels];
    return (sg_feature_place){plane + f % lines[i].nchannels, at[0] * lines[i].step, at[1] * lines[i].step};
}

static const line *line_of(size_t *plane)
{
    const line *l = lines;
    for (; *plane >= l->nchannels; l++)
        *plane -= l->nchannels;
    return l;
}

static void plane_name(const sg_feature_set *set, size_t plane, char *text, size_t n)
{
    static const char *const sums[] = {[SUM_NONE] = "",
                                       [SUM_MEAN] = " mean",
                                       [SUM_SD] = " sd",
                                       [SUM_ROW] = " row mean",
                                       [SUM_ROW_SD] = " row sd",
                                       [SUM_COLUMN] = " column mean",
                                       [SUM_COLUMN_SD] = " column sd",
                                       [SUM_ABOVE] = " above",
                                       [SUM_BELOW] = " below",
                                       [SUM_LEFT] = " left",
                                       [SUM_RIGHT] = " right"};
    (void)set;
    const line *l = line_of(&plane);
    char name[32];
    sg_channel_name(l->channel + (unsigned)plane, name, sizeof name);
    if (l->sum == SUM_NONE)
        snprintf(text, n, "%s", name);
    else
        snprintf(text, n, "%s%s %u", name, sums[l->sum], l->box);
}

/* ---- sums ---- */

static float sd_of(double sum, double squares, double n)
{
    const double mean = sum / n, variance = squares / n - mean * mean;
    return variance > 0 ? (float)sqrt(variance) : 0;
}

static void square(sg_plane from, sg_plane to)
{
    for (size_t y = 0; y < from.height; y++)
        for (size_t x = 0; x < from.width; x++) {
            const float v = from.at[y * from.stride + x];
            to.at[y * to.stride + x] = v * v;
        }
}

static sg_status box_sd(sg_plane from, sg_plane to, size_t box, sg_plane work[2], sg_error *err)
{
    SG_TRY(sg_cv_box_mean(from, work[0], box, box, err));
    square(from, work[1]);
    SG_TRY(sg_cv_box_mean(work[1], to, box, box, err));
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++)
            to.at[y * to.stride + x] = sd_of(work[0].at[y * work[0].stride + x], to.at[y * to.stride + x], 1);
    return SG_OK;
}

/* Sums over rows, or columns: step is from one pixel to the next, and stride from one row, or column. */
static void whole_rows(const float *from, size_t length, size_t n, size_t step, size_t stride, double *sums)
{
    for (size_t i = 0; i < n; i++) {
        sums[2 * i] = sums[2 * i + 1] = 0;
        for (size_t k = 0; k < length; k++) {
            const double v = from[i * stride + k * step];
            sums[2 * i] += v;
            sums[2 * i + 1] += v * v;
        }
    }
}

static float smoothed(const double *sums, size_t n, size_t at, size_t box, size_t length, bool sd)
{
    const size_t half = box / 2, first = at > half ? at - half : 0, end = at + half + 1 < n ? at + half + 1 : n;
    double sum = 0, squares = 0;
    for (size_t i = first; i < end; i++) {
        sum += sums[2 * i];
        squares += sums[2 * i + 1];
    }
    const double m = (double)((end - first) * length);
    return sd ? sd_of(sum, squares, m) : (float)(sum / m);
}

static sg_status rows(sg_plane from, sg_plane to, const line *l, sg_error *err)
{
    const bool upright = l->sum == SUM_COLUMN || l->sum == SUM_COLUMN_SD;
    const size_t n = upright ? from.width : from.height, length = upright ? from.height : from.width;
    double *sums = malloc(2 * n * sizeof *sums);
    if (sums == NULL)
        return SG_FAIL_NOMEM(err);
    whole_rows(from.at, length, n, upright ? from.stride : 1, upright ? 1 : from.stride, sums);
    for (size_t i = 0; i < n; i++) {
        const float v = smoothed(sums, n, i, l->box, length, l->sum == SUM_ROW_SD || l->sum == SUM_COLUMN_SD);
        for (size_t k = 0; k < length; k++)
            to.at[upright ? k * to.stride + i : i * to.stride + k] = v;
    }
    free(sums);
    return SG_OK;
}

static void running_mean(float *at, size_t n, ptrdiff_t step)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        float *v = at + (ptrdiff_t)i * step;
        sum += *v;
        *v = (float)(sum / (double)(i + 1));
    }
}

static sg_status one_side(sg_plane from, sg_plane to, const line *l, sg_error *err)
{
    const bool upright = l->sum == SUM_ABOVE || l->sum == SUM_BELOW, back = l->sum == SUM_BELOW || l->sum == SUM_RIGHT;
    SG_TRY(sg_cv_box_mean(from, to, upright ? l->box : 1, upright ? 1 : l->box, err));
    const size_t n = upright ? to.width : to.height, length = upright ? to.height : to.width;
    const size_t across = upright ? 1 : to.stride, along = upright ? to.stride : 1;
    for (size_t i = 0; i < n; i++) {
        float *first = to.at + i * across;
        running_mean(back ? first + (length - 1) * along : first, length, back ? -(ptrdiff_t)along : (ptrdiff_t)along);
    }
    return SG_OK;
}

static void copy(sg_plane from, sg_plane to)
{
    for (size_t y = 0; y < from.height; y++)
        memcpy(to.at + y * to.stride, from.at + y * from.stride, from.width * sizeof *to.at);
}

/* work: three planes of the photograph's size; the first holds the channel. */
static sg_status sum_up(const line *l, sg_plane *work, sg_plane to, sg_error *err)
{
    switch ((sum_kind)l->sum) {
    case SUM_NONE:
        copy(work[0], to);
        return SG_OK;
    case SUM_MEAN:
        return sg_cv_box_mean(work[0], to, l->box, l->box, err);
    case SUM_SD:
        return box_sd(work[0], to, l->box, work + 1, err);
    case SUM_ROW:
    case SUM_ROW_SD:
    case SUM_COLUMN:
    case SUM_COLUMN_SD:
        return rows(work[0], to, l, err);
    default:
        return one_side(work[0], to, l, err);
    }
}

/* ---- all of them ---- */

static sg_status fill_line(sg_channels *c, const line *l, sg_plane *work, const sg_planes *out, size_t plane,
                           sg_error *err)
{
    for (unsigned k = 0; k < l->nchannels; k++) {
        const sg_plane to = {sg_planes_at(out, plane + k), out->width, out->height, out->stride};
        SG_TRY(sg_channels_make(c, l->channel + k, work[0], err));
        SG_TRY(sum_up(l, work, to, err));
    }
    return SG_OK;
}

static sg_status fill_lines(sg_channels *c, float *memory, const sg_planes *out, sg_error *err)
{
    const size_t n = out->width * out->height;
    sg_plane work[3];
    for (size_t i = 0; i < 3; i++)
        work[i] = (sg_plane){memory + i * n, out->width, out->height, out->width};
    for (size_t i = 0, plane = 0; i < NLINES; plane += lines[i++].nchannels)
        SG_TRY(fill_line(c, &lines[i], work, out, plane, err));
    return SG_OK;
}

static sg_status fill(const sg_feature_set *set, const sg_image *photo, sg_planes *out, sg_error *err)
{
    (void)set;
    sg_channels c = {0};
    float *memory = malloc(3 * out->width * out->height * sizeof *memory);
    sg_status st = memory != NULL ? sg_channels_create(photo, &c, err) : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = fill_lines(&c, memory, out, err);
    sg_channels_clear(&c);
    free(memory);
    return st;
}

const sg_feature_definition sg_features_rich = {
    .version = 1,
    .count = count,
    .planes = planes,
    .pad = pad,
    .place = place,
    .plane_name = plane_name,
    .fill = fill,
};
