/* SPDX-License-Identifier: GPL-3.0-or-later */
/* print-grammar.c - a grammar as canonical text, in the exchange form, as a drawn graph, or how large it is. */
#include "config.h"

#include "core/file.h"
#include "grammar/grammar_counts.h"
#include "grammar/split.h"
#include "program/program.h"
#include "program/program_grammar.h"

static const char help[] =
    "Example: print-grammar --dot facade.sg | dot -Tsvg -o facade.svg\n"
    "\n"
    "Usage: print-grammar [OPTION]... GRAMMAR\n"
    "Print a grammar (the language *.sg or the exchange form; - is standard input) as canonical text.\n"
    "Reading checks everything: an error names file, line and column, and shows the line. So does\n"
    "a warning, which stops nothing: a guard that never holds, a weight that can be negative.\n"
    "\n"
    "  --json             the exchange form (JSON), for split grammars\n"
    "  --dot              a graph for Graphviz: symbols, what each may produce and how probably\n"
    "  --counts           how large it is: NAME<TAB>COUNT, of symbols, rules, draws and so on\n"
    "  -o, --output FILE  write to FILE (default -, standard output)\n"
    "  --help, --version\n"
    "\n"
    "Exit status: 0 done, 2 wrong usage, 3 bad grammar, 4 the system failed.\n";

typedef enum { AS_TEXT, AS_JSON, AS_DOT, AS_COUNTS } form;

enum { OPT_DOT = SG_OPT_OWN, OPT_COUNTS };

typedef struct {
    form as;
    const char *output, *grammar;
} options;

/* The form that an option asks for, AS_TEXT when it is about something else. */
static form form_of(int option)
{
    return option == SG_OPT_JSON ? AS_JSON : option == OPT_DOT ? AS_DOT : option == OPT_COUNTS ? AS_COUNTS : AS_TEXT;
}

/* The exit status to end with now, or -1 to go on. */
static int read_options(int argc, char **argv, options *o)
{
    static const struct option known[] = {{"json", no_argument, NULL, SG_OPT_JSON},
                                          {"dot", no_argument, NULL, OPT_DOT},
                                          {"counts", no_argument, NULL, OPT_COUNTS},
                                          {"output", required_argument, NULL, 'o'},
                                          {"help", no_argument, NULL, SG_OPT_HELP},
                                          {"version", no_argument, NULL, SG_OPT_VERSION},
                                          {NULL, 0, NULL, 0}};
    sg_common_opts common = SG_COMMON_OPTS_INIT;
    for (int c; (c = getopt_long(argc, argv, "o:", known, NULL)) != -1;) {
        const form as = form_of(c);
        if (as != AS_TEXT && o->as != AS_TEXT && o->as != as)
            return sg_program_usage("--json, --dot and --counts exclude each other");
        if (as != AS_TEXT)
            o->as = as;
        else if (c == 'o')
            o->output = optarg;
        else
            switch (sg_program_option(c, optarg, help, &common)) {
            case SG_OPTION_EXIT_OK:
                return sg_program_end(SG_OK, NULL);
            default:
                return 2;
            }
    }
    if (optind + 1 != argc)
        return sg_program_usage(optind == argc ? "which grammar?" : "one grammar at a time");
    o->grammar = argv[optind];
    return -1;
}

static sg_status print_json(const sg_grammar *g, FILE *out, sg_error *err)
{
    sg_arena *arena = sg_arena_create();
    sg_split_form split;
    if (arena == NULL)
        return SG_FAIL_NOMEM(err);
    sg_status st = sg_split_form_of(g, arena, &split, err);
    if (st == SG_OK)
        st = sg_split_form_write_json(&split, out, err);
    sg_arena_free(arena);
    return st;
}

static sg_status print_counts(const sg_grammar *g, FILE *out, sg_error *err)
{
    const sg_grammar_counts c = sg_grammar_count(g);
    const struct {
        const char *name;
        size_t count;
    } lines[] = {{"symbols", c.nonterminals + c.labels}, {"nonterminals", c.nonterminals}, {"labels", c.labels},
                 {"hidden", c.hidden},                   {"rules", c.rules},               {"arguments", c.arguments},
                 {"draws", c.draws},                     {"operations", c.operations},     {"successors", c.successors}};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        fprintf(out, "%s\t%zu\n", lines[i].name, lines[i].count);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing failed") : SG_OK;
}

static sg_status print_as(form as, const sg_grammar *g, FILE *out, sg_error *err)
{
    switch (as) {
    case AS_JSON:
        return print_json(g, out, err);
    case AS_DOT:
        return sg_grammar_print_dot(g, out, err);
    case AS_COUNTS:
        return print_counts(g, out, err);
    case AS_TEXT:
        break;
    }
    return sg_grammar_print(g, out, err);
}

static sg_status print(const options *o, const sg_grammar *g, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, o->output, err));
    return sg_output_end(&out, print_as(o->as, g, out.fp, err), err);
}

int main(int argc, char **argv)
{
    options o = {AS_TEXT, "-", NULL};
    sg_error err = SG_ERROR_INIT;
    sg_program_begin("print-grammar");
    const int done = read_options(argc, argv, &o);
    if (done >= 0)
        return done;
    sg_grammar *g = NULL;
    sg_status st = sg_program_load_grammar(o.grammar, &g, &err);
    if (st == SG_OK)
        st = sg_program_spare_grammar(o.output, o.grammar, g, &err);
    if (st == SG_OK)
        st = print(&o, g, &err);
    sg_grammar_free(g);
    return sg_program_end(st, &err);
}
