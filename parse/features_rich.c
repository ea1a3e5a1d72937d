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
#include "parse/features_sums_priv.h"

#include <stdio.h>
#include <stdlib.h>

#define PAD 80 /* px: how far off a feature may lie */

/* ---- the table ---- */

typedef enum { AT_HERE, AT_CROSS, AT_PLUS, AT_VERTICAL, AT_FAR_VERTICAL, AT_ROWS, AT_COLUMNS } place_kind;

/* Places, in units of a line's step. */
static const signed char places[][2] = {
    {0, 0},  {-1, 0}, {1, 0},  {0, -1}, {0, 1},                  /* here; a cross */
    {-2, 0}, {2, 0},  {0, -2}, {0, 2},                           /* a larger one */
    {0, 0},  {0, -1}, {0, 1},                                    /* above and below, */
    {0, -4}, {0, 4},                                             /* farther, */
    {0, 0},  {0, -1}, {0, 1},  {0, -2}, {0, 2}, {0, -4}, {0, 4}, /* more densely */
    {0, 0},  {-1, 0}, {1, 0},  {-2, 0}, {2, 0}, {-4, 0}, {4, 0},
};

static const struct {
    unsigned char first, n;
} place_lists[] = {
    [AT_HERE] = {0, 1},         [AT_CROSS] = {0, 5}, [AT_PLUS] = {0, 9},     [AT_VERTICAL] = {9, 3},
    [AT_FAR_VERTICAL] = {9, 5}, [AT_ROWS] = {14, 7}, [AT_COLUMNS] = {21, 7},
};

typedef struct {
    unsigned char channel, nchannels;
    unsigned char sum, width, height; /* px, odd */
    unsigned char places, step;       /* px */
} line;

static const line lines[] = {
    /* colour and filter bank, point by point */
    {SG_CHANNEL_L, 6, SG_SUM_NONE, 0, 0, AT_HERE, 0},
    {SG_CHANNEL_BLUR_L1, 3, SG_SUM_NONE, 0, 0, AT_HERE, 0},
    {SG_CHANNEL_BLUR_L2, 3, SG_SUM_NONE, 0, 0, AT_CROSS, 5},
    {SG_CHANNEL_BLUR_L4, 3, SG_SUM_NONE, 0, 0, AT_CROSS, 10},
    {SG_CHANNEL_LAPLACIAN1, 8, SG_SUM_NONE, 0, 0, AT_HERE, 0},
    /* boxes of colour */
    {SG_CHANNEL_L, 3, SG_SUM_MEAN, 15, 15, AT_PLUS, 20},
    {SG_CHANNEL_L, 3, SG_SUM_MEAN, 31, 31, AT_PLUS, 40},
    {SG_CHANNEL_L, 3, SG_SUM_MEAN, 61, 61, AT_CROSS, 61},
    {SG_CHANNEL_L, 3, SG_SUM_SD, 7, 7, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SG_SUM_SD, 15, 15, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SG_SUM_SD, 31, 31, AT_VERTICAL, 31},
    {SG_CHANNEL_BLUR_L2, 3, SG_SUM_CONTRAST, 101, 101, AT_HERE, 0},
    {SG_CHANNEL_BLUR_L2, 1, SG_SUM_MEAN, 41, 3, AT_ROWS, 5},
    {SG_CHANNEL_BLUR_L2, 1, SG_SUM_MEAN, 3, 41, AT_COLUMNS, 5},
    /* texture: gradients, orientations and patterns in cells */
    {SG_CHANNEL_GRADIENT, 3, SG_SUM_MEAN, 7, 7, AT_HERE, 0},
    {SG_CHANNEL_GRADIENT, 3, SG_SUM_MEAN, 15, 15, AT_CROSS, 15},
    {SG_CHANNEL_GRADIENT, 3, SG_SUM_MEAN, 31, 31, AT_PLUS, 31},
    {SG_CHANNEL_ORIENTATION, 8, SG_SUM_MEAN, 9, 9, AT_HERE, 0},
    {SG_CHANNEL_ORIENTATION, 8, SG_SUM_MEAN, 21, 21, AT_VERTICAL, 21},
    {SG_CHANNEL_PATTERN, 10, SG_SUM_MEAN, 13, 13, AT_HERE, 0},
    {SG_CHANNEL_PATTERN, 10, SG_SUM_MEAN, 31, 31, AT_VERTICAL, 31},
    {SG_CHANNEL_LAPLACIAN1, 8, SG_SUM_SD, 15, 15, AT_HERE, 0},
    /* rows and columns */
    {SG_CHANNEL_L, 3, SG_SUM_ROW, 0, 15, AT_ROWS, 20},
    {SG_CHANNEL_L, 3, SG_SUM_ROW_SD, 0, 5, AT_FAR_VERTICAL, 15},
    {SG_CHANNEL_BLUR_L2, 3, SG_SUM_ROW_CONTRAST, 0, 15, AT_HERE, 0},
    {SG_CHANNEL_BLUR_L2, 3, SG_SUM_COLUMN_CONTRAST, 15, 0, AT_CROSS, 10},
    {SG_CHANNEL_GRADIENT_X, 2, SG_SUM_ROW, 0, 3, AT_FAR_VERTICAL, 10},
    {SG_CHANNEL_GRADIENT_X, 2, SG_SUM_ROW, 0, 15, AT_ROWS, 20},
    {SG_CHANNEL_GRADIENT_X, 1, SG_SUM_MEAN, 121, 5, AT_ROWS, 10},
    {SG_CHANNEL_L, 3, SG_SUM_ABOVE, 15, 0, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SG_SUM_BELOW, 15, 0, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SG_SUM_LEFT, 0, 15, AT_HERE, 0},
    {SG_CHANNEL_L, 3, SG_SUM_RIGHT, 0, 15, AT_HERE, 0},
    {SG_CHANNEL_GRADIENT, 3, SG_SUM_ABOVE, 15, 0, AT_HERE, 0},
    {SG_CHANNEL_GRADIENT, 3, SG_SUM_BELOW, 15, 0, AT_HERE, 0},
    /* position */
    {SG_CHANNEL_X, 5, SG_SUM_NONE, 0, 0, AT_HERE, 0},
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
    static const char *const sums[] = {[SG_SUM_NONE] = "",
                                       [SG_SUM_MEAN] = "mean",
                                       [SG_SUM_SD] = "sd",
                                       [SG_SUM_CONTRAST] = "less mean",
                                       [SG_SUM_ROW] = "row mean",
                                       [SG_SUM_ROW_SD] = "row sd",
                                       [SG_SUM_ROW_CONTRAST] = "less row mean",
                                       [SG_SUM_COLUMN] = "column mean",
                                       [SG_SUM_COLUMN_SD] = "column sd",
                                       [SG_SUM_COLUMN_CONTRAST] = "less column mean",
                                       [SG_SUM_ABOVE] = "above",
                                       [SG_SUM_BELOW] = "below",
                                       [SG_SUM_LEFT] = "left",
                                       [SG_SUM_RIGHT] = "right"};
    (void)set;
    const line *l = line_of(&plane);
    char name[32];
    sg_channel_name(l->channel + (unsigned)plane, name, sizeof name);
    if (l->sum == SG_SUM_NONE)
        snprintf(text, n, "%s", name);
    else if (l->width == 0 || l->height == 0)
        snprintf(text, n, "%s %s %d", name, sums[l->sum], l->width + l->height);
    else
        snprintf(text, n, "%s %s %dx%d", name, sums[l->sum], l->width, l->height);
}

/* ---- planes ---- */

/* work: three planes of the photograph's size. */
static sg_status fill_line(sg_channels *c, const line *l, sg_plane *work, const sg_planes *out, size_t plane,
                           sg_error *err)
{
    for (unsigned k = 0; k < l->nchannels; k++) {
        const sg_plane to = {sg_planes_at(out, plane + k), out->width, out->height, out->stride};
        SG_TRY(sg_channels_make(c, l->channel + k, work[0], err));
        SG_TRY(sg_sum_up(l->sum, l->width, l->height, work[0], work + 1, to, err));
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
    .version = 2,
    .count = count,
    .planes = planes,
    .pad = pad,
    .place = place,
    .plane_name = plane_name,
    .fill = fill,
};
