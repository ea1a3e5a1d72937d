/* SPDX-License-Identifier: GPL-3.0-or-later */
/* label_svg.c - label scenes as scalable vector graphics. */
#include "scene/label_svg.h"

#include "core/markup.h"

static void write_label(const sg_label_scene *scene, const sg_grammar *g, sg_sym label, FILE *out)
{
    bool open = false;
    for (size_t i = 0; i < scene->nrects; i++) {
        const sg_label_rect *r = scene->rects + i;
        if (r->label != label || r->x1 <= r->x0 || r->y1 <= r->y0)
            continue;
        if (!open) {
            fprintf(out, "<g fill=\"#%06x\"><title>", (unsigned)sg_grammar_symbol(g, label)->color);
            sg_markup_text(out, sg_grammar_symbol(g, label)->name);
            fputs("</title>\n", out);
            open = true;
        }
        fprintf(out, "<rect x=\"%.6g\" y=\"%.6g\" width=\"%.6g\" height=\"%.6g\"/>\n", r->x0, r->y0, r->x1 - r->x0,
                r->y1 - r->y0);
    }
    if (open)
        fputs("</g>\n", out);
}

sg_status sg_label_svg_write(const sg_label_scene *scene, const sg_grammar *g, FILE *out, sg_error *err)
{
    /* Crisp edges: with smoothing, neighbours would let the background shine through their common edge. */
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.10g\" height=\"%.10g\" viewBox=\"0 0 %.10g %.10g\" "
            "shape-rendering=\"crispEdges\">\n",
            scene->width, scene->height, scene->width, scene->height);
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++)
        if (sg_grammar_symbol(g, s)->kind == SG_SYMBOL_LABEL)
            write_label(scene, g, s, out);
    fputs("</svg>\n", out);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a picture failed") : SG_OK;
}
