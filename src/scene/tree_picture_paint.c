/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_picture_paint.c - drawn trees in pixels. */
#include "config.h"

#include "image/cv_drawing.h"
#include "scene/tree_picture_priv.h"

#include <gsl/gsl_math.h>
#include <math.h>
#include <string.h>

static const double MAX_SIDE = 16384, MAX_PIXELS = 64e6;
static const uint32_t EDGE = 0x909090, OUTLINE = 0x303030, GREY = 0x606060;

typedef struct {
    const sg_tree_picture *p;
    double scale;
    sg_image *im;
    sg_error *err;
} painting;

static sg_status stroke(painting *w, double (*xy)[2], size_t n, bool closed, uint32_t color)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 2; k++)
            xy[i][k] *= w->scale;
    return sg_cv_stroke(w->im, &xy[0][0], n, closed, w->scale, color, w->err);
}

/* As in the SVG. */
static sg_status paint_edge(painting *w, const sg_tree_mark *m)
{
    const sg_tree_mark *up = w->p->marks + m->parent;
    double xy[4][2] = {{up->x, up->y + up->height / 2},
                       {up->x, w->p->level_bottom[up->level]},
                       {m->x, w->p->level_top[m->level]},
                       {m->x, m->y - m->height / 2}};
    return stroke(w, xy, 4, false, EDGE);
}

/* A box, or one whose left and right sides are half circles. */
static sg_status paint_shape(painting *w, const sg_tree_mark *m, double y)
{
    enum { ARC = 12 };
    double xy[2 * (ARC + 1)][2];
    size_t n = 0;
    const double half = m->width / 2, high = SG_TREE_BOX_PX / 2;
    if (m->shape == SG_TREE_TERMINAL) {
        for (; n < 4; n++) {
            xy[n][0] = m->x + (n == 1 || n == 2 ? half : -half);
            xy[n][1] = y + (n >= 2 ? high : -high);
        }
    } else {
        for (int side = 1; side >= -1; side -= 2)
            for (int i = 0; i <= ARC; i++, n++) {
                const double t = M_PI * ((double)i / ARC - 0.5);
                xy[n][0] = m->x + side * (half - high + high * cos(t));
                xy[n][1] = y + side * high * sin(t);
            }
    }
    double inner[2 * (ARC + 1)][2];
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 2; k++)
            inner[i][k] = xy[i][k] * w->scale;
    SG_TRY(sg_cv_fill(w->im, &inner[0][0], n, m->fill, w->err));
    return stroke(w, xy, n, true, OUTLINE);
}

static sg_status paint_text(painting *w, const char *text, size_t n, double x, double y, double size, size_t columns,
                            bool from_left, uint32_t color)
{
    char line[512];
    snprintf(line, sizeof line, "%.*s", (int)n, text);
    const double width = (double)columns * SG_TREE_ADVANCE * size;
    return sg_cv_text(w->im, line, x * w->scale, y * w->scale, size * w->scale, width * w->scale, from_left, color, w->err);
}

static sg_status paint_beside(painting *w, const sg_tree_mark *m)
{
    size_t k = 0;
    for (const char *line = m->beside; *line != '\0'; k++) {
        const size_t n = strcspn(line, "\n");
        SG_TRY(paint_text(w, line, n, m->x + m->width / 2 + SG_TREE_BESIDE_PX, m->y - m->height / 2 + sg_tree_beside_line(k),
                          SG_TREE_SMALL_PX, m->beside_columns, true, GREY));
        line += n + (line[n] == '\n');
    }
    return SG_OK;
}

static sg_status paint_mark(painting *w, const sg_tree_mark *m)
{
    const double left = m->x - (double)m->columns * SG_TREE_ADVANCE * SG_TREE_LETTER_PX / 2;
    const uint32_t color = m->shape == SG_TREE_ELIDED ? GREY : sg_tree_is_dark(m->fill) ? 0xffffff : 0;
    double y = m->y - m->height / 2 + SG_TREE_BOX_PX / 2;
    for (const char *line = m->text; *line != '\0'; y += SG_TREE_BOX_PX) {
        const size_t n = strcspn(line, "\n");
        if (m->shape != SG_TREE_ELIDED)
            SG_TRY(paint_shape(w, m, y));
        SG_TRY(paint_text(w, line, n, left, y, SG_TREE_LETTER_PX, m->columns, false, color));
        line += n + (line[n] == '\n');
    }
    return paint_beside(w, m);
}

static sg_status paint(painting *w)
{
    for (size_t i = 1; i < w->p->n; i++)
        SG_TRY(paint_edge(w, w->p->marks + i));
    for (size_t i = 0; i < w->p->n; i++)
        SG_TRY(paint_mark(w, w->p->marks + i));
    return SG_OK;
}

sg_status sg_tree_picture_paint(const sg_tree_picture *p, double scale, sg_image *out, sg_error *err)
{
    scale = fmin(scale, fmin(fmin(MAX_SIDE / p->width, MAX_SIDE / p->height), sqrt(MAX_PIXELS / (p->width * p->height))));
    sg_image im;
    SG_TRY(sg_image_create((size_t)fmax(1, p->width * scale), (size_t)fmax(1, p->height * scale), &im, err));
    memset(im.rgb, 255, 3 * im.width * im.height);
    painting w = {p, scale, &im, err};
    const sg_status st = paint(&w);
    if (st == SG_OK)
        *out = im;
    else
        sg_image_clear(&im);
    return st;
}
