/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene_support.h - scenes of grammars in tests. */
#ifndef SG_TESTS_SCENE_SUPPORT_H
#define SG_TESTS_SCENE_SUPPORT_H

#include "scene/scene.h"
#include "tests/grammar_support.h"
#include "tests/random_grammar.h"

typedef struct {
    sg_grammar *g;
    sg_derivation d;
    gsl_rng *rng;
    sg_scene scene;
    sg_scene_opts opts;
} test_scene;

/** Are all primitives of a scene those of another from `first` on, bit for bit? */
static inline bool test_same_primitives(const sg_scene *a, const sg_scene *b, size_t first)
{
    for (size_t i = 0; i < a->n; i++)
        if (!sg_primitive_equal(a, a->items + i, b, b->items + first + i))
            return false;
    return true;
}

/** A grammar and a derivation of it. */
static inline test_scene test_open_scene(const char *text, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = {.rng = sg_random_create(seed), .opts = SG_SCENE_OPTS_INIT};
    f.g = test_grammar(text);
    sg_derivation_init(&f.d, f.g);
    ck_ok(sg_derivation_sample(&f.d, f.rng, 1000000, &err));
    return f;
}

/** The scene of a grammar that must have one. */
static inline test_scene test_scene_of(const char *text)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_open_scene(text, 1);
    ck_ok(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err));
    return f;
}

static inline void test_close_scene(test_scene *f)
{
    sg_scene_clear(&f->scene);
    sg_derivation_clear(&f->d);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
}

/** A random grammar and a derivation of it that can be interpreted; false when this seed gives none. */
static inline bool test_random_scene(uint64_t seed, test_scene *f)
{
    random_grammar_opts opts = RANDOM_GRAMMAR_OPTS_INIT;
    opts.derivable = true;
    opts.strange_layout = false;
    *f = (test_scene){.rng = sg_random_create(seed), .opts = SG_SCENE_OPTS_INIT};
    char *text = random_grammar_text(f->rng, &opts);
    f->g = test_grammar(text);
    free(text);
    f->opts.max_places = 200000;
    sg_derivation_init(&f->d, f->g);
    for (int tries = 0; tries < 10; tries++)
        if (sg_derivation_sample(&f->d, f->rng, 3000, NULL) == SG_OK &&
            sg_scene_interpret(&f->d, &f->opts, &f->scene, NULL) == SG_OK)
            return true;
    test_close_scene(f);
    return false;
}

#endif
