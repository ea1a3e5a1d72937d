/* SPDX-License-Identifier: GPL-3.0-or-later */
/* features_sums.c - sums of a channel over boxes, rows, columns and strips. */
#include "config.h"

#include "parse/features_sums_priv.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* ---- boxes ---- */

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

static sg_status box_sd(sg_plane from, sg_plane to, size_t width, size_t height, const sg_plane work[2], sg_error *err)
{
    SG_TRY(sg_cv_box_mean(from, work[0], width, height, err));
    square(from, work[1]);
    SG_TRY(sg_cv_box_mean(work[1], to, width, height, err));
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++) {
            float *v = &to.at[y * to.stride + x];
            *v = sd_of((double)work[0].at[y * work[0].stride + x], (double)*v, 1);
        }
    return SG_OK;
}

/* to = from - to */
static void subtract(sg_plane from, sg_plane to)
{
    for (size_t y = 0; y < to.height; y++)
        for (size_t x = 0; x < to.width; x++) {
            float *v = &to.at[y * to.stride + x];
            *v = from.at[y * from.stride + x] - *v;
        }
}

/* ---- whole rows and columns ---- */

/* A photograph seen in rows, or on its side. */
typedef struct {
    size_t n, length;     /* rows, and pixels of each */
    size_t across, along; /* floats from a row to the next, and from a pixel to the next */
} direction;

static direction direction_of(sg_plane p, bool columns)
{
    return columns ? (direction){p.width, p.height, 1, p.stride} : (direction){p.height, p.width, p.stride, 1};
}

/* Sum and sum of squares of each. */
static void add_up(const float *from, const direction *d, double *sums)
{
    for (size_t i = 0; i < d->n; i++) {
        double sum = 0, squares = 0;
        for (size_t k = 0; k < d->length; k++) {
            const double v = (double)from[i * d->across + k * d->along];
            sum += v;
            squares += v * v;
        }
        sums[2 * i] = sum;
        sums[2 * i + 1] = squares;
    }
}

static float smoothed(const double *sums, const direction *d, size_t at, size_t box, bool sd)
{
    const size_t half = box / 2, first = at > half ? at - half : 0, end = at + half + 1 < d->n ? at + half + 1 : d->n;
    double sum = 0, squares = 0;
    for (size_t i = first; i < end; i++) {
        sum += sums[2 * i];
        squares += sums[2 * i + 1];
    }
    const double n = (double)((end - first) * d->length);
    return sd ? sd_of(sum, squares, n) : (float)(sum / n);
}

static sg_status whole_rows(sg_plane from, sg_plane to, bool columns, size_t box, bool sd, sg_error *err)
{
    const direction in = direction_of(from, columns), out = direction_of(to, columns);
    double *sums = malloc(2 * in.n * sizeof *sums);
    if (sums == NULL)
        return SG_FAIL_NOMEM(err);
    add_up(from.at, &in, sums);
    for (size_t i = 0; i < in.n; i++) {
        const float v = smoothed(sums, &in, i, box, sd);
        for (size_t k = 0; k < in.length; k++)
            to.at[i * out.across + k * out.along] = v;
    }
    free(sums);
    return SG_OK;
}

/* ---- one side ---- */

static void running_mean(float *at, size_t n, ptrdiff_t step)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        float *v = at + (ptrdiff_t)i * step;
        sum += (double)*v;
        *v = (float)(sum / (double)(i + 1));
    }
}

/* to holds means across the strip. */
static void one_side(sg_plane to, bool columns, bool back)
{
    const direction d = direction_of(to, columns);
    const ptrdiff_t step = (ptrdiff_t)d.along;
    for (size_t i = 0; i < d.n; i++) {
        float *first = to.at + i * d.across;
        running_mean(back ? first + (d.length - 1) * d.along : first, d.length, back ? -step : step);
    }
}

/* ---- all of them ---- */

static void copy(sg_plane from, sg_plane to)
{
    for (size_t y = 0; y < from.height; y++)
        memcpy(to.at + y * to.stride, from.at + y * from.stride, from.width * sizeof *to.at);
}

sg_status sg_sum_up(sg_sum sum, size_t width, size_t height, sg_plane channel, const sg_plane work[2], sg_plane to,
                    sg_error *err)
{
    switch (sum) {
    case SG_SUM_NONE:
        copy(channel, to);
        break;
    case SG_SUM_SD:
        return box_sd(channel, to, width, height, work, err);
    case SG_SUM_ROW:
    case SG_SUM_ROW_SD:
    case SG_SUM_ROW_CONTRAST:
        SG_TRY(whole_rows(channel, to, false, height, sum == SG_SUM_ROW_SD, err));
        break;
    case SG_SUM_COLUMN:
    case SG_SUM_COLUMN_SD:
    case SG_SUM_COLUMN_CONTRAST:
        SG_TRY(whole_rows(channel, to, true, width, sum == SG_SUM_COLUMN_SD, err));
        break;
    case SG_SUM_ABOVE:
    case SG_SUM_BELOW:
        SG_TRY(sg_cv_box_mean(channel, to, width, 1, err));
        one_side(to, true, sum == SG_SUM_BELOW);
        break;
    case SG_SUM_LEFT:
    case SG_SUM_RIGHT:
        SG_TRY(sg_cv_box_mean(channel, to, 1, height, err));
        one_side(to, false, sum == SG_SUM_RIGHT);
        break;
    case SG_SUM_MEAN:
    case SG_SUM_CONTRAST:
        SG_TRY(sg_cv_box_mean(channel, to, width, height, err));
        break;
    }
    if (sum == SG_SUM_CONTRAST || sum == SG_SUM_ROW_CONTRAST || sum == SG_SUM_COLUMN_CONTRAST)
        subtract(channel, to);
    return SG_OK;
}
