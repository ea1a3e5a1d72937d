/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.c - the page that shows what learning did. */
#include "learn/report.h"

#include "core/file.h"
#include "core/markup.h"
#include "learn/chart_priv.h"
#include "learn/draw_grammar.h"

#include <stdlib.h>

static const char style[] =
    "body{font:15px/1.45 system-ui,sans-serif;color:#223;background:#fff;max-width:1320px;margin:0 auto;padding:1.5em}"
    "h1{font-size:1.6em;margin:0 0 .6em}h2{font-size:1.15em;margin:1.8em 0 .5em;border-bottom:1px solid #ccd}"
    "table{border-collapse:collapse;margin:.4em 2em .4em 0}td,th{padding:.15em .8em;text-align:right}"
    "td:first-child,th:first-child{text-align:left;padding-left:0}tbody tr:nth-child(odd){background:#f3f5f9}"
    ".row{display:flex;flex-wrap:wrap;align-items:flex-start}"
    ".pictures{display:flex;flex-wrap:wrap;gap:10px}.pictures figure{margin:0;font-size:.8em;text-align:center}"
    ".pictures img{height:190px;border:1px solid #ccd;display:block;image-rendering:auto}"
    ".scroll{max-height:24em;overflow:auto;display:inline-block}.wide{overflow-x:auto}";

sg_grammar_sizes sg_split_form_sizes(const sg_split_form *f)
{
    sg_grammar_sizes s = {.nonterminals = f->nsymbols};
    for (size_t i = 0; i < f->nrules; i++) {
        s.rules_x += f->rules[i].op == SG_SPLIT_X;
        s.rules_y += f->rules[i].op == SG_SPLIT_Y;
        s.rules_lexical += f->rules[i].op == SG_SPLIT_LEXICAL;
    }
    return s;
}

static void write_lines(FILE *out, const char *title, const sg_report_line *lines, size_t n)
{
    if (n == 0)
        return;
    fprintf(out, "<table><thead><tr><th colspan=\"2\">%s</th></tr></thead><tbody>\n", title);
    for (size_t i = 0; i < n; i++) {
        fputs("<tr><td>", out);
        sg_markup_text(out, lines[i].name);
        fputs("</td><td>", out);
        sg_markup_text(out, lines[i].value);
        fputs("</td></tr>\n", out);
    }
    fputs("</tbody></table>\n", out);
}

static void write_size_row(FILE *out, const char *name, const sg_split_form *f)
{
    if (f == NULL)
        return;
    const sg_grammar_sizes s = sg_split_form_sizes(f);
    fprintf(out, "<tr><td>%s</td><td>%zu</td><td>%zu</td><td>%zu</td><td>%zu</td></tr>\n", name, s.nonterminals,
            s.rules_x, s.rules_y, s.rules_lexical);
}

static void write_sizes(FILE *out, const sg_report *r)
{
    fputs("<table><thead><tr><th>Grammar</th><th>non-terminals</th><th>split-x rules</th><th>split-y rules</th>"
          "<th>lexical rules</th></tr></thead><tbody>\n",
          out);
    write_size_row(out, "initial", r->initial);
    write_size_row(out, "merged", r->merged);
    write_size_row(out, "finished", r->finished);
    fputs("</tbody></table>\n", out);
}

static void write_steps(FILE *out, const sg_report *r)
{
    fputs("<div class=\"scroll\"><table><thead><tr><th>step</th><th>change</th><th>energy (nats)</th><th>difference</th>"
          "<th>non-terminals</th><th>split-x</th><th>split-y</th></tr></thead><tbody>\n",
          out);
    for (size_t i = 0; i < r->nsteps; i++) {
        const sg_report_step *s = &r->steps[i];
        fprintf(out, "<tr><td>%zu</td><td style=\"text-align:left\">", i);
        sg_markup_text(out, s->what);
        fprintf(out, "</td><td>%.2f</td><td>%.2f</td><td>%zu</td><td>%zu</td><td>%zu</td></tr>\n", s->energy,
                i > 0 ? s->energy - r->steps[i - 1].energy : 0.0, s->nonterminals, s->rules_x, s->rules_y);
    }
    fputs("</tbody></table></div>\n", out);
}

static void write_charts(FILE *out, const sg_report *r, double *values)
{
    fputs("<div class=\"row\">\n", out);
    for (size_t i = 0; i < r->nsteps; i++)
        values[i] = r->steps[i].energy;
    sg_chart_write(out, values, r->nsteps, "Energy (nats)", "step of the search");
    for (size_t i = 0; i < r->nsteps; i++)
        values[i] = (double)r->steps[i].nonterminals;
    sg_chart_write(out, values, r->nsteps, "Non-terminals", "step of the search");
    fputs("</div>\n", out);
}

static void write_pictures(FILE *out, const char *title, const sg_report_picture *p, size_t n)
{
    if (n == 0)
        return;
    fprintf(out, "<h2>%s</h2>\n<div class=\"pictures\">\n", title);
    for (size_t i = 0; i < n; i++) {
        fputs("<figure><a href=\"", out);
        sg_markup_text(out, p[i].file);
        fputs("\"><img src=\"", out);
        sg_markup_text(out, p[i].file);
        fputs("\" alt=\"\"></a>", out);
        sg_markup_text(out, p[i].caption);
        fputs("</figure>\n", out);
    }
    fputs("</div>\n", out);
}

static void write_labels(FILE *out, const sg_split_form *f)
{
    fputs("<p>", out);
    for (size_t t = 0; t < f->nterminals; t++) {
        fprintf(out, "<span style=\"display:inline-block;width:1em;height:1em;background:#%06x;border:1px solid #889;"
                     "vertical-align:-.15em\"></span> ",
                f->terminal_colors[t]);
        sg_markup_text(out, f->terminal_names[t]);
        fputs(" &nbsp; ", out);
    }
    fputs("</p>\n", out);
}

static sg_status write_page(FILE *out, const sg_report *r, double *values, sg_error *err)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>", out);
    sg_markup_text(out, r->title);
    fprintf(out, "</title><style>%s</style></head><body>\n<h1>", style);
    sg_markup_text(out, r->title);
    fputs("</h1>\n<div class=\"row\">\n", out);
    write_lines(out, "Settings", r->settings, r->nsettings);
    write_lines(out, "Result", r->results, r->nresults);
    write_sizes(out, r);
    fputs("</div>\n", out);
    write_labels(out, r->finished);
    write_pictures(out, "Samples of the learned grammar", r->samples, r->nsamples);
    fputs("<h2>Search</h2>\n", out);
    write_charts(out, r, values);
    write_steps(out, r);
    write_pictures(out, "Lattices that it was learned from", r->lattices, r->nlattices);
    fputs("<h2>Grammar</h2>\n<p>Each card is a non-terminal; each picture in it is a rule, drawn as its most probable "
          "derivation with mean sizes, and its probability. Lines lead to the symbols that a symbol's rules use.</p>\n"
          "<div class=\"wide\">\n",
          out);
    SG_TRY(sg_draw_grammar(r->finished, out, err));
    fputs("</div>\n</body></html>\n", out);
    return SG_OK;
}

static sg_status write_picture(const char *path, const sg_split_form *f, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    const sg_status st = sg_draw_grammar(f, out.fp, err);
    if (st == SG_OK)
        return sg_output_commit(&out, err);
    sg_output_discard(&out);
    return st;
}

static sg_status write_index(const char *path, const sg_report *r, sg_error *err)
{
    double *values = calloc(r->nsteps + 1, sizeof *values);
    if (values == NULL)
        return SG_FAIL_NOMEM(err);
    sg_output out;
    sg_status st = sg_output_open(&out, path, err);
    if (st == SG_OK) {
        st = write_page(out.fp, r, values, err);
        if (st == SG_OK)
            st = sg_output_commit(&out, err);
        else
            sg_output_discard(&out);
    }
    free(values);
    return st;
}

sg_status sg_report_write(const char *folder, const sg_report *r, sg_error *err)
{
    char path[4096];
    const int n = snprintf(path, sizeof path, "%s/grammar.svg", folder);
    if (n < 0 || (size_t)n >= sizeof path)
        return SG_FAIL(err, SG_EIO, "%.200s...: the path is too long", folder);
    SG_TRY(write_picture(path, r->finished, err));
    snprintf(path, sizeof path, "%s/index.html", folder);
    return write_index(path, r, err);
}
