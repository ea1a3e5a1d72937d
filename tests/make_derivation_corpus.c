/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make_derivation_corpus.c - writes the seeds of the derivation fuzzers: after a change of a format, run
 * make_derivation_corpus tests/corpus in the source folder. Not run by any test. */
#include "config.h"

#include "core/file.h"
#include "core/random.h"
#include "scene/derivation_json.h"
#include "tests/derivation_grammars.h"
#include "tests/fuzz.h"

#include <string.h>

enum { SEEDS = 8, LARGEST = 25 }; /* nodes */

static void write_json(const char *folder, const char *name, const sg_derivation *d, bool placed)
{
    char path[4096];
    sg_output out;
    snprintf(path, sizeof path, "%s/derivation_json/%s", folder, name);
    fuzz_must(sg_output_open(&out, path, NULL) == SG_OK);
    const sg_status st = placed ? sg_derivation_write_json(d, 30, 40, out.fp, NULL)
                                : sg_derivation_write_json_tree(d, out.fp, NULL);
    if (st == SG_OK)
        fuzz_must(sg_output_commit(&out, NULL) == SG_OK);
    else
        sg_output_discard(&out); /* no label scene */
}

static void write_binary(const char *folder, const char *name, const sg_derivation *list, size_t n)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/derivation_binary/%s", folder, name);
    fuzz_must(sg_derivation_file_write(path, list->grammar, list, n, NULL) == SG_OK);
}

static void open_some(sg_derivation *d, gsl_rng *rng, int steps)
{
    const sg_grammar *g = d->grammar;
    fuzz_must(sg_derivation_open(d, sg_grammar_start(g), sg_grammar_start_args(g), 0, NULL) == SG_OK);
    for (size_t i = 0; i < d->nnodes && steps > 0; i++) {
        sg_rule_id rule = SG_NONE;
        if (d->nodes[i].rule != SG_NONE || sg_derivation_choose(d, i, rng, &rule, NULL) != SG_OK)
            continue;
        fuzz_must(sg_derivation_expand(d, i, rule, rng, NULL) == SG_OK);
        steps--;
    }
}

int main(int argc, char **argv)
{
    static const char text[] = GRAMMAR_OF_DERIVATIONS;
    sg_grammar *g = NULL;
    sg_derivation d[2];
    gsl_rng *rng = sg_random_create(1);
    fuzz_must(argc == 2 && rng != NULL && sg_grammar_parse(text, strlen(text), "stored", &g, NULL) == SG_OK);
    sg_derivation_init(d, g);
    sg_derivation_init(d + 1, g);
    for (int i = 0; i < SEEDS; i++) {
        char name[32];
        do
            fuzz_must(sg_derivation_sample(d, rng, 100000, NULL) == SG_OK);
        while (d->nnodes > LARGEST);
        open_some(d + 1, rng, i);
        snprintf(name, sizeof name, "whole-%d.sgd", i);
        write_binary(argv[1], name, d, 1);
        snprintf(name, sizeof name, "open-%d.sgd", i);
        write_binary(argv[1], name, d + 1, 1);
        snprintf(name, sizeof name, "whole-%d.json", i);
        write_json(argv[1], name, d, false);
        snprintf(name, sizeof name, "placed-%d.json", i);
        write_json(argv[1], name, d, true);
        snprintf(name, sizeof name, "open-%d.json", i);
        write_json(argv[1], name, d + 1, false);
    }
    write_binary(argv[1], "two.sgd", d, 2);
    write_binary(argv[1], "none.sgd", d, 0);
    sg_derivation_clear(d);
    sg_derivation_clear(d + 1);
    gsl_rng_free(rng);
    sg_grammar_free(g);
    return EXIT_SUCCESS;
}
