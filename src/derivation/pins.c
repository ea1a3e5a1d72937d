/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pins.c - pins from text. Symbols may have blanks, brackets and points in their names ("maybe(0.5) A"), so at each place the
 * longest name of a symbol that stands there is taken. */
#include "config.h"

#include "derivation/pins_priv.h"

#include "core/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LIST = 600 };

/* A list for a sentence, cut where it becomes too long. */
typedef struct {
    char text[MAX_LIST];
    size_t n;
    bool cut;
} listing;

static void list_name(listing *l, const char *name)
{
    const size_t length = strlen(name);
    l->cut = l->cut || l->n + length + 8 > sizeof l->text;
    if (!l->cut)
        l->n += (size_t)snprintf(l->text + l->n, sizeof l->text - l->n, "%s%s", l->n > 0 ? ", " : "", name);
}

static const char *listed(listing *l)
{
    if (l->cut)
        snprintf(l->text + l->n, sizeof l->text - l->n, ", ...");
    return l->n > 0 ? l->text : "none";
}

static const char *skip_blanks(const char *p)
{
    return p + strspn(p, " \t");
}

/* Can a symbol's name end in front of this? */
static bool is_end(const char *p)
{
    return strchr("#:.=>", *skip_blanks(p)) != NULL; /* or the text's end */
}

/* The non-terminal with the longest name that stands at p. */
static sg_sym longest_symbol(const sg_grammar *g, const char *p, size_t *length)
{
    sg_sym found = SG_NONE;
    *length = 0;
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++) {
        const sg_symbol *symbol = sg_grammar_symbol(g, s);
        const size_t n = strlen(symbol->name);
        if (symbol->kind == SG_SYMBOL_NONTERMINAL && n > *length && strncmp(p, symbol->name, n) == 0 && is_end(p + n)) {
            found = s;
            *length = n;
        }
    }
    return found;
}

static sg_status no_symbol(const sg_grammar *g, const char *text, const char *p, sg_error *err)
{
    listing l = {.n = 0};
    for (sg_sym s = 0; s < sg_grammar_symbol_count(g); s++)
        if (sg_grammar_symbol(g, s)->kind == SG_SYMBOL_NONTERMINAL)
            list_name(&l, sg_grammar_symbol(g, s)->name);
    return SG_FAIL(err, SG_EINVAL, "'%.80s': no symbol at '%.40s'; the symbols are: %s", text, p, listed(&l));
}

static sg_status bad_form(const char *text, const char *what, sg_error *err)
{
    return SG_FAIL(err, SG_EINVAL, "'%.80s': %s; a pin is NODE.DRAW=VALUE or NODE=RULE, as in 'A > B#2.h=3'", text, what);
}

/* A whole number from 1 on; NULL when there is none. */
static const char *read_number(const char *p, size_t *number)
{
    char *end;
    p = skip_blanks(p);
    if (*p < '0' || *p > '9')
        return NULL;
    *number = strtoul(p, &end, 10);
    return *number >= 1 && *number < UINT32_MAX ? end : NULL;
}

static const char *read_step(const sg_grammar *g, const char *p, sg_pin_step *step)
{
    size_t length;
    *step = (sg_pin_step){SG_NONE, 0};
    if (*p == '(') { /* (N more) */
        const char *end = read_number(p + 1, &step->skipped);
        if (end != NULL && strncmp(end, " more)", 6) == 0)
            return end + 6;
    }
    step->skipped = 0;
    step->symbol = longest_symbol(g, p, &length);
    return step->symbol != SG_NONE ? p + length : NULL;
}

static sg_status read_path(const sg_grammar *g, const char **at, sg_pin *pin, sg_error *err)
{
    for (const char *p = *at;; p++) {
        p = skip_blanks(p);
        if (!SG_GROW(pin->steps, pin->steps_capacity, pin->nsteps + 1))
            return SG_FAIL_NOMEM(err);
        const char *end = read_step(g, p, pin->steps + pin->nsteps);
        if (end == NULL)
            return no_symbol(g, pin->text, p, err);
        pin->nsteps++;
        p = skip_blanks(end);
        if (*p == '>')
            continue;
        *at = p;
        return pin->steps[pin->nsteps - 1].symbol != SG_NONE ? SG_OK : bad_form(pin->text, "the path ends with no symbol", err);
    }
}

static sg_sym symbol_of(const sg_pin *pin)
{
    return pin->steps[pin->nsteps - 1].symbol;
}

static sg_status rule_of(const sg_grammar *g, const sg_pin *pin, size_t number, sg_rule_id *rule, sg_error *err)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol_of(pin));
    if (number > s->nrules)
        return SG_FAIL(err, SG_EINVAL, "'%.80s': %.60s has %u rule%s, not %zu", pin->text, s->name, (unsigned)s->nrules,
                       s->nrules == 1 ? "" : "s", number);
    *rule = s->first_rule + (sg_rule_id)(number - 1);
    return SG_OK;
}

/* #K and :RULE */
static sg_status read_selectors(const sg_grammar *g, const char **at, sg_pin *pin, sg_error *err)
{
    const char *p = *at;
    size_t number;
    if (*p == '#') {
        p = read_number(p + 1, &pin->occurrence);
        if (p == NULL)
            return bad_form(pin->text, "a whole number from 1 on follows #", err);
        p = skip_blanks(p);
    }
    if (*p == ':') {
        p = read_number(p + 1, &number);
        if (p == NULL)
            return bad_form(pin->text, "the number of a rule, from 1 on, follows :", err);
        SG_TRY(rule_of(g, pin, number, &pin->rule, err));
        p = skip_blanks(p);
    }
    *at = p;
    return SG_OK;
}

/* One number, or several with commas between, in brackets or not. */
static sg_status read_values(const char *p, sg_pin *pin, sg_error *err)
{
    p = skip_blanks(p);
    const bool bracket = *p == '(';
    p += bracket;
    for (;; p++) {
        char *end;
        const double value = strtod(p, &end);
        if (end == p || !isfinite(value))
            return bad_form(pin->text, "the value is no number", err);
        if (!SG_GROW(pin->values, pin->values_capacity, pin->nvalues + 1))
            return SG_FAIL_NOMEM(err);
        pin->values[pin->nvalues++] = value;
        p = skip_blanks(end);
        if (*p != ',')
            break;
    }
    p = skip_blanks(p + (bracket && *p == ')'));
    return *p == '\0' ? SG_OK : bad_form(pin->text, "something follows the value", err);
}

bool sg_pin_means_draw(const sg_pin *p, const sg_rule *r, uint32_t k)
{
    const sg_draw *draw = r->draws + k;
    if (p->draw == NULL || draw->nvalues != p->nvalues)
        return false;
    if (draw->name != NULL && strcmp(draw->name, p->draw) == 0)
        return true;
    size_t number;
    const char *end = read_number(p->draw, &number);
    return end != NULL && *end == '\0' && number == (size_t)k + 1;
}

static bool has_draw(const sg_pin *pin, const sg_rule *r)
{
    for (uint32_t k = 0; k < r->ndraws; k++)
        if (sg_pin_means_draw(pin, r, k))
            return true;
    return false;
}

static void list_draws(const sg_grammar *g, const sg_pin *pin, sg_rule_id id, listing *l)
{
    const sg_rule *r = sg_grammar_rule(g, id);
    const sg_symbol *s = sg_grammar_symbol(g, symbol_of(pin));
    for (uint32_t k = 0; k < r->ndraws; k++) {
        char item[160], name[100], sizes[40] = "", where[40] = " at the limit";
        if (r->draws[k].name != NULL)
            snprintf(name, sizeof name, "%.90s", r->draws[k].name);
        else
            snprintf(name, sizeof name, "%u", (unsigned)(k + 1));
        if (r->draws[k].kind == SG_DRAW_SIMPLEX)
            snprintf(sizes, sizeof sizes, " (%u sizes)", (unsigned)r->draws[k].nvalues);
        if (id != s->completion)
            snprintf(where, sizeof where, " in rule %u", (unsigned)(id - s->first_rule + 1));
        snprintf(item, sizeof item, "%s%s%s", name, sizes, where);
        list_name(l, item);
    }
}

/* Some rule that the pin is about must have the draw. */
static sg_status check_draw(const sg_grammar *g, const sg_pin *pin, sg_error *err)
{
    const sg_symbol *s = sg_grammar_symbol(g, symbol_of(pin));
    listing l = {.n = 0};
    for (uint32_t i = 0; i <= s->nrules; i++) {
        const sg_rule_id id = i < s->nrules ? s->first_rule + i : s->completion;
        if (id == SG_NONE || (pin->rule != SG_NONE && pin->rule != id))
            continue;
        if (has_draw(pin, sg_grammar_rule(g, id)))
            return SG_OK;
        list_draws(g, pin, id, &l);
    }
    return SG_FAIL(err, SG_EINVAL, "'%.80s': %.60s has no draw '%.40s' of %zu value%s; its draws are: %s", pin->text, s->name,
                   pin->draw, pin->nvalues, pin->nvalues == 1 ? "" : "s", listed(&l));
}

static char *copy_text(const char *text, size_t n)
{
    char *copy = malloc(n + 1);
    if (copy == NULL)
        return NULL;
    memcpy(copy, text, n);
    copy[n] = '\0';
    return copy;
}

static sg_status read_draw(const sg_grammar *g, const char *p, const char *equals, sg_pin *pin, sg_error *err)
{
    p = skip_blanks(p);
    size_t n = (size_t)(equals - p);
    while (n > 0 && (p[n - 1] == ' ' || p[n - 1] == '\t'))
        n--;
    if (n == 0)
        return bad_form(pin->text, "the name of a draw follows the point", err);
    pin->draw = copy_text(p, n);
    if (pin->draw == NULL)
        return SG_FAIL_NOMEM(err);
    SG_TRY(read_values(equals + 1, pin, err));
    return check_draw(g, pin, err);
}

static sg_status read_choice(const sg_grammar *g, const char *p, sg_pin *pin, sg_error *err)
{
    size_t number;
    const char *end = read_number(p, &number);
    if (end == NULL || *skip_blanks(end) != '\0')
        return bad_form(pin->text, "the number of a rule, from 1 on, follows NODE=", err);
    if (pin->rule != SG_NONE)
        return bad_form(pin->text, "a rule is chosen by its symbol", err);
    return rule_of(g, pin, number, &pin->choice, err);
}

static sg_status read_pin(const sg_grammar *g, sg_pin *pin, sg_error *err)
{
    const char *p = pin->text;
    SG_TRY(read_path(g, &p, pin, err));
    SG_TRY(read_selectors(g, &p, pin, err));
    const char *equals = strchr(p, '=');
    if (equals == NULL)
        return bad_form(pin->text, "= is missing", err);
    if (*p == '.')
        return read_draw(g, p + 1, equals, pin, err);
    return p == equals ? read_choice(g, p + 1, pin, err) : bad_form(pin->text, "neither . nor = follows the node", err);
}

static void clear_pin(sg_pin *pin)
{
    free(pin->text);
    free(pin->steps);
    free(pin->draw);
    free(pin->values);
}

sg_status sg_pins_create(const sg_grammar *g, sg_pins **out, sg_error *err)
{
    sg_pins *p = calloc(1, sizeof *p);
    if (p != NULL)
        p->concerns = calloc(sg_grammar_symbol_count(g), sizeof *p->concerns);
    if (p == NULL || p->concerns == NULL) {
        free(p);
        return SG_FAIL_NOMEM(err);
    }
    p->grammar = g;
    *out = p;
    return SG_OK;
}

void sg_pins_free(sg_pins *p)
{
    if (p == NULL)
        return;
    for (size_t i = 0; i < p->n; i++)
        clear_pin(p->items + i);
    free(p->items);
    free(p->concerns);
    free(p);
}

sg_status sg_pins_add(sg_pins *p, const char *text, sg_error *err)
{
    sg_pin pin = {.text = copy_text(text, strlen(text)), .rule = SG_NONE, .choice = SG_NONE};
    sg_status st = pin.text != NULL && SG_GROW(p->items, p->capacity, p->n + 1) ? SG_OK : SG_FAIL_NOMEM(err);
    if (st == SG_OK)
        st = read_pin(p->grammar, &pin, err);
    if (st != SG_OK) {
        clear_pin(&pin);
        return st;
    }
    p->concerns[symbol_of(&pin)] = true;
    p->items[p->n++] = pin;
    return SG_OK;
}

size_t sg_pins_count(const sg_pins *p)
{
    return p->n;
}

const char *sg_pins_text(const sg_pins *p, size_t pin)
{
    return p->items[pin].text;
}
