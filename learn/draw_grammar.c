/* SPDX-License-Identifier: GPL-3.0-or-later */
/* draw_grammar.c - a split grammar as layered cards in SVG. */
#include "learn/draw_grammar.h"

#include "core/markup.h"
#include "learn/likely_priv.h"

#include <math.h>
#include <stdbool.h>

enum {
    MOST_RULES = 6,      /* shown a symbol */
    THUMB = 120,         /* longest side of a rule's picture, px */
    PAD = 8,
    CARD = THUMB + 2 * PAD,
    HEADER = 20,
    CAPTION = 14,
    GAP_X = 18, GAP_Y = 46,
    PAGE = 1280,         /* width, px */
    MOST_DEPTH = 40,
};

static const double SMALLEST = 0.5; /* px; smaller regions are drawn as one */

typedef struct {
    double x, y, height; /* of the card */
    double w, h;         /* of a typical region of the symbol, the axiom's being 3 x 4 */
    uint32_t layer;
} card;

typedef struct {
    const sg_split_form *f;
    sg_likely likely;
    card *cards;
    uint32_t *order; /* symbols by layer, reached ones only */
    size_t nordered;
    double page_height;
    FILE *out;
} drawing;

/* Breadth first from the axiom: layers, and the size of a typical region of each symbol. */
static void find_layers(drawing *d)
{
    for (size_t x = 0; x < d->f->nsymbols; x++)
        d->cards[x].layer = SG_NONE;
    d->cards[d->f->axiom] = (card){.w = 3, .h = 4, .layer = 0};
    d->order[d->nordered++] = d->f->axiom;
    for (size_t i = 0; i < d->nordered; i++) {
        const uint32_t x = d->order[i];
        for (uint32_t r = d->likely.first[x]; r < d->likely.first[x + 1]; r++) {
            const sg_split_rule *rule = &d->f->rules[r];
            for (uint32_t k = 0; rule->op != SG_SPLIT_LEXICAL && k < rule->n; k++) {
                card *c = &d->cards[rule->rhs[k]];
                if (c->layer != SG_NONE)
                    continue;
                const double size = sg_likely_size(rule, k);
                c->layer = d->cards[x].layer + 1;
                c->w = d->cards[x].w * (rule->op == SG_SPLIT_X ? size : 1);
                c->h = d->cards[x].h * (rule->op == SG_SPLIT_Y ? size : 1);
                d->order[d->nordered++] = rule->rhs[k];
            }
        }
    }
}

static uint32_t rules_shown(const drawing *d, uint32_t x)
{
    const uint32_t n = d->likely.first[x + 1] - d->likely.first[x];
    return n < MOST_RULES ? n : MOST_RULES;
}

/* Size of a rule's picture: the typical region of its symbol, the long side THUMB, the short one not too thin. */
static void thumb_size(const drawing *d, uint32_t x, double *w, double *h)
{
    const double aspect = d->cards[x].w / d->cards[x].h;
    *w = aspect >= 1 ? THUMB : fmax(THUMB * aspect, 24);
    *h = aspect >= 1 ? fmax(THUMB / aspect, 24) : THUMB;
}

static void place_cards(drawing *d)
{
    double x = PAD, y = PAD, tallest = 0;
    uint32_t layer = 0;
    for (size_t i = 0; i < d->nordered; i++) {
        card *c = &d->cards[d->order[i]];
        double w, h;
        thumb_size(d, d->order[i], &w, &h);
        c->height = HEADER + rules_shown(d, d->order[i]) * (h + CAPTION + 4) + PAD;
        if (c->layer != layer || x + CARD > PAGE) {
            x = PAD;
            y += tallest + (c->layer != layer ? GAP_Y : GAP_X);
            tallest = 0;
            layer = c->layer;
        }
        c->x = x;
        c->y = y;
        x += CARD + GAP_X;
        tallest = fmax(tallest, c->height);
    }
    d->page_height = y + tallest + PAD;
}

static void rect(const drawing *d, double x, double y, double w, double h, uint32_t color)
{
    fprintf(d->out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#%06x\"/>\n", x, y, w + 0.05,
            h + 0.05, color);
}

static void draw_symbol(const drawing *d, uint32_t x, double x0, double y0, double w, double h, int depth);

static void draw_rule(const drawing *d, const sg_split_rule *r, double x0, double y0, double w, double h, int depth)
{
    if (r->op == SG_SPLIT_LEXICAL) {
        rect(d, x0, y0, w, h, d->f->terminal_colors[r->rhs[0]]);
        return;
    }
    double at = 0;
    for (uint32_t i = 0; i < r->n; i++) {
        const double size = sg_likely_size(r, i);
        if (r->op == SG_SPLIT_X)
            draw_symbol(d, r->rhs[i], x0 + at * w, y0, size * w, h, depth + 1);
        else
            draw_symbol(d, r->rhs[i], x0, y0 + at * h, w, size * h, depth + 1);
        at += size;
    }
}

static void draw_symbol(const drawing *d, uint32_t x, double x0, double y0, double w, double h, int depth)
{
    uint32_t r = d->likely.best[x];
    if (r == SG_NONE || w <= 0 || h <= 0)
        return;
    const sg_split_rule *rule = &d->f->rules[r];
    const bool small = w < SMALLEST || h < SMALLEST || depth > MOST_DEPTH;
    for (int i = 0; small && rule->op != SG_SPLIT_LEXICAL && i < MOST_DEPTH; i++)
        rule = &d->f->rules[d->likely.best[rule->rhs[rule->n / 2]]];
    draw_rule(d, rule, x0, y0, w, h, depth);
}

/* The most probable rules of x: shown[] is filled with n of them, by falling probability, then by index. */
static uint32_t choose_rules(const drawing *d, uint32_t x, uint32_t *shown)
{
    uint32_t n = 0;
    for (uint32_t r = d->likely.first[x]; r < d->likely.first[x + 1]; r++) {
        uint32_t at = n < MOST_RULES ? n++ : MOST_RULES;
        while (at > 0 && d->f->rules[shown[at - 1]].probability < d->f->rules[r].probability) {
            if (at < MOST_RULES)
                shown[at] = shown[at - 1];
            at--;
        }
        if (at < MOST_RULES)
            shown[at] = r;
    }
    return n;
}

static void draw_card(const drawing *d, uint32_t x)
{
    static const char *const op[] = {"split-x", "split-y", "label"};
    const card *c = &d->cards[x];
    const uint32_t nrules = d->likely.first[x + 1] - d->likely.first[x];
    double w, h, y = c->y + HEADER;
    thumb_size(d, x, &w, &h);
    fprintf(d->out,
            "<g><rect x=\"%.1f\" y=\"%.1f\" width=\"%d\" height=\"%.1f\" rx=\"5\" fill=\"#fff\" stroke=\"#889\"/>\n"
            "<text x=\"%.1f\" y=\"%.1f\" font-weight=\"bold\">",
            c->x, c->y, CARD, c->height, c->x + PAD, c->y + 14);
    sg_markup_text(d->out, d->f->symbol_names[x]);
    fprintf(d->out, "</text>\n<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\" fill=\"#667\">%u rule%s</text>\n",
            c->x + CARD - PAD, c->y + 14, nrules, nrules == 1 ? "" : "s");
    uint32_t shown[MOST_RULES];
    const uint32_t n = choose_rules(d, x, shown);
    for (uint32_t i = 0; i < n; i++) {
        const sg_split_rule *r = &d->f->rules[shown[i]];
        draw_rule(d, r, c->x + PAD, y, w, h, 0);
        fprintf(d->out, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" stroke=\"#000\"/>\n",
                c->x + PAD, y, w, h);
        fprintf(d->out, "<text x=\"%.1f\" y=\"%.1f\" fill=\"#667\">%.2f %s%s</text>\n", c->x + PAD, y + h + 12,
                r->probability, op[r->op], i + 1 == n && nrules > n ? ", and others" : "");
        y += h + CAPTION + 4;
    }
    fputs("</g>\n", d->out);
}

static bool uses(const drawing *d, uint32_t x, uint32_t y)
{
    for (uint32_t r = d->likely.first[x]; r < d->likely.first[x + 1]; r++)
        for (uint32_t k = 0; d->f->rules[r].op != SG_SPLIT_LEXICAL && k < d->f->rules[r].n; k++)
            if (d->f->rules[r].rhs[k] == y)
                return true;
    return false;
}

static void draw_lines(const drawing *d)
{
    fputs("<g fill=\"none\" stroke=\"#4a6fa5\" stroke-opacity=\"0.35\">\n", d->out);
    for (size_t i = 0; i < d->nordered; i++)
        for (size_t j = 0; j < d->nordered; j++) {
            const card *a = &d->cards[d->order[i]], *b = &d->cards[d->order[j]];
            if (i == j || b->layer <= a->layer || !uses(d, d->order[i], d->order[j]))
                continue;
            const double x0 = a->x + CARD / 2.0, y0 = a->y + a->height, x1 = b->x + CARD / 2.0, y1 = b->y;
            fprintf(d->out, "<path d=\"M%.1f %.1fC%.1f %.1f %.1f %.1f %.1f %.1f\"/>\n", x0, y0, x0, y0 + GAP_Y, x1,
                    y1 - GAP_Y, x1, y1);
        }
    fputs("</g>\n", d->out);
}

sg_status sg_draw_grammar(const sg_split_form *f, FILE *out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    drawing d = {.f = f, .out = out};
    sg_status st = sg_likely_of(f, arena, &d.likely, err);
    d.cards = SG_NEW_ARRAY(arena, card, f->nsymbols);
    d.order = SG_NEW_ARRAY(arena, uint32_t, f->nsymbols);
    if (st == SG_OK && (d.cards == NULL || d.order == NULL))
        st = SG_FAIL_NOMEM(err);
    if (st == SG_OK) {
        find_layers(&d);
        place_cards(&d);
        fprintf(out,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" viewBox=\"0 0 %d %.0f\" "
                "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"#f4f5f8\"/>\n",
                PAGE, d.page_height, PAGE, d.page_height);
        draw_lines(&d);
        for (size_t i = 0; i < d.nordered; i++)
            draw_card(&d, d.order[i]);
        fputs("</svg>\n", out);
        if (ferror(out))
            st = SG_FAIL(err, SG_EIO, "writing the picture of the grammar failed");
    }
    sg_arena_free(arena);
    return st;
}
