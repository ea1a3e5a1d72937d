/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tree_picture_svg.c - drawn trees as scalable vector graphics. Texts have their length said, so that they fit whatever
 * font there is. */
#include "scene/tree_picture_priv.h"

#include "core/markup.h"

#include <string.h>

static void put_text(FILE *out, const char *text, size_t n, size_t columns, double x, double y, double size, const char *style)
{
    char line[512];
    snprintf(line, sizeof line, "%.*s", (int)n, text);
    fprintf(out, "<text x=\"%.6g\" y=\"%.6g\" font-size=\"%g\" textLength=\"%.6g\" lengthAdjust=\"spacingAndGlyphs\"%s>", x,
            y + 0.35 * size, size, (double)columns * SG_TREE_ADVANCE * size, style);
    sg_markup_text(out, line);
    fputs("</text>\n", out);
}

static size_t columns_of(const char *text, size_t n)
{
    size_t columns = 0;
    for (size_t i = 0; i < n; i++)
        columns += ((unsigned char)text[i] & 0xC0) != 0x80;
    return columns;
}

static void put_beside(FILE *out, const sg_tree_mark *m)
{
    size_t k = 0;
    for (const char *line = m->beside; *line != '\0'; k++) {
        const size_t n = strcspn(line, "\n");
        put_text(out, line, n, columns_of(line, n), m->x + m->width / 2 + SG_TREE_BESIDE_PX,
                 m->y - m->height / 2 + sg_tree_beside_line(k), SG_TREE_SMALL_PX, " fill=\"#606060\"");
        line += n + (line[n] == '\n');
    }
}

static void put_box(FILE *out, const sg_tree_mark *m, const char *text, size_t n, double y)
{
    const double high = SG_TREE_BOX_PX / 2, width = (double)columns_of(text, n) * SG_TREE_ADVANCE * SG_TREE_LETTER_PX;
    if (m->shape != SG_TREE_ELIDED)
        fprintf(out,
                "<rect x=\"%.6g\" y=\"%.6g\" width=\"%.6g\" height=\"%.6g\" rx=\"%.6g\" fill=\"#%06x\" stroke=\"#303030\"/>\n",
                m->x - m->width / 2, y - high, m->width, 2 * high, m->shape == SG_TREE_NONTERMINAL ? high : 0, (unsigned)m->fill);
    put_text(out, text, n, columns_of(text, n), m->x - width / 2, y, SG_TREE_LETTER_PX,
             m->shape == SG_TREE_ELIDED ? " fill=\"#606060\"" : sg_tree_is_dark(m->fill) ? " fill=\"#ffffff\"" : "");
}

static void put_mark(FILE *out, const sg_tree_mark *m)
{
    double y = m->y - m->height / 2 + SG_TREE_BOX_PX / 2;
    for (const char *line = m->text; *line != '\0'; y += SG_TREE_BOX_PX) {
        const size_t n = strcspn(line, "\n");
        put_box(out, m, line, n, y);
        line += n + (line[n] == '\n');
    }
    put_beside(out, m);
}

/* Straight down to the end of the row, over to the child in the space between rows, and down to it. */
static void put_edge(FILE *out, const sg_tree_picture *p, const sg_tree_mark *m)
{
    const sg_tree_mark *up = p->marks + m->parent;
    fprintf(out, "M%.6g %.6gV%.6gL%.6g %.6gV%.6g\n", up->x, up->y + up->height / 2, p->level_bottom[up->level], m->x,
            p->level_top[m->level], m->y - m->height / 2);
}

sg_status sg_tree_picture_svg(const sg_tree_picture *p, FILE *out, sg_error *err)
{
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.10g\" height=\"%.10g\" viewBox=\"0 0 %.10g %.10g\" "
            "font-family=\"DejaVu Sans Mono, Menlo, Consolas, monospace\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n<path fill=\"none\" stroke=\"#909090\" d=\"",
            p->width, p->height, p->width, p->height);
    for (size_t i = 1; i < p->n; i++)
        put_edge(out, p, p->marks + i);
    fputs("\"/>\n", out);
    for (size_t i = 0; i < p->n; i++)
        put_mark(out, p->marks + i);
    fputs("</svg>\n", out);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a picture failed") : SG_OK;
}
