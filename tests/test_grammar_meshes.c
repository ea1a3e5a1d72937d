/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_grammar_meshes.c - every grammar in data/grammars, whichever there are: models of a few seeds, in a few scopes, have
 * sound meshes at each level of detail, and glTF files that keep the rules. */
#include "config.h"

#include "core/random.h"
#include "scene/assets.h"
#include "scene/mesh_gltf.h"
#include "tests/gltf_check.h"
#include "tests/mesh_check.h"
#include "tests/support.h"

#include <glob.h>
#include <string.h>

enum { SEEDS = 3, MAX_TRIES = 30, MAX_NODES = 20000, MAX_PLACES = 100000, DETAILS = 3, LARGE = 2000 };

static glob_t grammars;

typedef struct {
    sg_grammar *g;
    sg_derivation d;
    gsl_rng *rng;
    sg_scene scene;
    sg_mesh mesh;
    sg_assets *assets;
    const char *path;
} model;

static void check_gltf(const model *m, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    char *bytes = NULL;
    size_t n = 0;
    gltf_counts counts = {0};
    FILE *out = open_memstream(&bytes, &n);
    ck_ok(sg_mesh_gltf_write(&m->mesh, out, &err));
    fclose(out);
    const char *rule = gltf_check((const unsigned char *)bytes, n, &counts);
    ck_assert_msg(rule == NULL, "%s, seed %d, glTF: %s", m->path, (int)seed, rule);
    ck_assert((counts.triangles > 0) == (m->mesh.nfaces > 0));
    free(bytes);
}

static void check_levels(model *m, uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    size_t last = SIZE_MAX;
    opts.assets = m->assets;
    for (opts.detail = 0; opts.detail < DETAILS; opts.detail++) {
        ck_ok(sg_mesh_from_scene(&m->scene, &opts, &m->mesh, &err));
        const char *wrong = mesh_check(&m->mesh, NULL);
        ck_assert_msg(wrong == NULL, "%s, seed %d, detail %u: %s", m->path, (int)seed, opts.detail, wrong);
        ck_assert_uint_le(m->mesh.nfaces, last);
        last = m->mesh.nfaces;
        if (opts.detail == 0 || m->scene.n < LARGE)
            check_gltf(m, seed);
    }
}

/* A large model is looked at in one scope, and no other of its grammar then.
 * @return false: this derivation is too large for a test */
static bool try_seed(model *m, uint64_t seed)
{
    static const double scopes[][3] = {{1, 1, 1}, {20, 15, 0}, {12, 0, 30}};
    sg_error err = SG_ERROR_INIT;
    sg_random_stream(m->rng, seed, 0, 0);
    if (sg_derivation_sample(&m->d, m->rng, MAX_NODES, &err) != SG_OK)
        return false;
    m->scene.n = 0;
    for (size_t i = 0; i < sizeof scopes / sizeof *scopes && m->scene.n < LARGE; i++) {
        sg_scene_opts opts = SG_SCENE_OPTS_INIT;
        memcpy(opts.size, scopes[i], sizeof opts.size);
        opts.max_places = MAX_PLACES;
        if (sg_scene_interpret(&m->d, &opts, &m->scene, &err) != SG_OK)
            return false;
        check_levels(m, seed);
    }
    return true;
}

START_TEST(grammars_have_sound_meshes)
{
    sg_error err = SG_ERROR_INIT;
    model m = {.path = grammars.gl_pathv[_i], .rng = sg_random_create(1)};
    int done = 0;
    ck_ok(sg_grammar_load(m.path, &m.g, &err));
    ck_ok(sg_assets_load(m.g, m.path, &m.assets, &err));
    sg_derivation_init(&m.d, m.g);
    for (uint64_t seed = 1; seed <= MAX_TRIES && done < SEEDS && !(done > 0 && m.scene.n >= LARGE); seed++)
        done += try_seed(&m, seed);
    ck_assert_msg(done == SEEDS || (done > 0 && m.scene.n >= LARGE), "%s: only %d models are small enough", m.path, done);
    sg_mesh_clear(&m.mesh);
    sg_scene_clear(&m.scene);
    sg_derivation_clear(&m.d);
    gsl_rng_free(m.rng);
    sg_assets_free(m.assets);
    sg_grammar_free(m.g);
}
END_TEST

static Suite *grammar_meshes_suite(void)
{
    Suite *s = suite_create("grammar_meshes");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, grammars_have_sound_meshes, 0, (int)grammars.gl_pathc);
    suite_add_tcase(s, all);
    return s;
}

int main(void)
{
    char pattern[4096];
    snprintf(pattern, sizeof pattern, "%s/data/grammars/*.sg", test_folder("SG_SOURCE_DIR"));
    if (glob(pattern, 0, NULL, &grammars) != 0) {
        fprintf(stderr, "%s: no grammars\n", pattern);
        return EXIT_FAILURE;
    }
    const int status = test_run(grammar_meshes_suite());
    globfree(&grammars);
    return status;
}
