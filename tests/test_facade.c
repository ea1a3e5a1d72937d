/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_facade.c - a facade parsed from label costs: planted problems, stages, samples, marginals, lines, which photographs. */
#include "config.h"

#include "core/random.h"
#include "image/png_io.h"
#include "parse/facade.h"
#include "parse/facade_lines.h"
#include "parse/facade_photos.h"
#include "parse/unaries.h"
#include "tests/failing_malloc.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static sg_error err;
static gsl_rng *rng;

static void set_up(void)
{
    rng = sg_random_create(1);
    ck_assert_ptr_nonnull(rng);
}

static void tear_down(void)
{
    gsl_rng_free(rng);
}

/* ---- a planted facade: a sample of a grammar, seen through noise ---- */

typedef struct {
    sg_grammar *g;
    sg_classes classes;
    uint32_t *channel;
    uint8_t *value_of;
    sg_derivation d;
    sg_label_map map;
    sg_float_map costs;
} planted;

static void load_grammar(planted *p, const char *name)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/data/grammars/%s", test_folder("SG_SOURCE_DIR"), name);
    ck_ok(sg_grammar_load(path, &p->g, &err));
    const size_t n = sg_grammar_symbol_count(p->g);
    p->channel = calloc(n, sizeof *p->channel);
    p->value_of = calloc(n, 1);
    ck_assert(p->channel != NULL && p->value_of != NULL);
    ck_ok(sg_label_classes(p->g, &p->classes, p->value_of, &err));
    ck_ok(sg_unaries_channels(p->g, &p->classes, p->channel, &err));
}

/* A pixel looks like its label, but with the chance of `noise` like another one. */
static void see(planted *p, double noise)
{
    const size_t n = p->map.width * p->map.height, k = p->classes.nclasses;
    ck_ok(sg_float_map_create(k, p->map.height, p->map.width, &p->costs, &err));
    for (size_t i = 0; i < n; i++) {
        const bool wrong = gsl_rng_uniform(rng) < noise;
        const size_t seen = wrong ? gsl_rng_uniform_int(rng, k) : p->map.labels[i];
        for (size_t c = 0; c < k; c++)
            p->costs.values[c * n + i] = (float)(c == seen ? 1 - noise : noise / (double)(k - 1));
    }
    sg_unaries_to_costs(&p->costs);
}

static planted plant(const char *grammar, size_t width, size_t height, double noise)
{
    planted p = {0};
    sg_label_scene scene = {0};
    load_grammar(&p, grammar);
    sg_derivation_init(&p.d, p.g);
    ck_ok(sg_derivation_sample(&p.d, rng, 100000, &err));
    ck_ok(sg_label_scene_interpret(&scene, &p.d, (double)width, (double)height, &err));
    ck_ok(sg_label_map_create(width, height, &p.map, &err));
    sg_label_scene_raster(&scene, p.value_of, &p.map);
    sg_label_scene_clear(&scene);
    see(&p, noise);
    return p;
}

static void planted_clear(planted *p)
{
    sg_float_map_clear(&p->costs);
    sg_label_map_clear(&p->map);
    sg_derivation_clear(&p->d);
    sg_classes_clear(&p->classes);
    free(p->channel);
    free(p->value_of);
    sg_grammar_free(p->g);
}

/* Cost of a derivation's pixels, one by one. */
static double slow_image_energy(const planted *p, const sg_derivation *d, sg_label_map *map)
{
    sg_label_scene scene = {0};
    double sum = 0;
    const size_t n = map->width * map->height;
    ck_ok(sg_label_scene_interpret(&scene, d, (double)map->width, (double)map->height, &err));
    sg_label_scene_raster(&scene, p->value_of, map);
    sg_label_scene_clear(&scene);
    for (size_t i = 0; i < n; i++)
        sum += (double)p->costs.values[map->labels[i] * n + i];
    return sum;
}

static double slow_energy(const planted *p, const sg_derivation *d)
{
    sg_label_map map;
    double rules, density;
    ck_ok(sg_label_map_create(p->map.width, p->map.height, &map, &err));
    ck_ok(sg_derivation_log_prior(d, &rules, &err));
    ck_ok(sg_derivation_log_density(d, &density, &err));
    const double e = slow_image_energy(p, d, &map) - rules - density;
    sg_label_map_clear(&map);
    return e;
}

static sg_facade_opts small_opts(void)
{
    sg_facade_opts o = SG_FACADE_OPTS_INIT;
    o.search.runs = 2;
    o.search.iterations = 4000;
    o.search.chains = 4;
    o.search.threads = 1;
    o.samples = 32;
    return o;
}

static size_t count_wrong(const planted *p, const sg_derivation *d)
{
    sg_label_map map;
    size_t wrong = 0;
    ck_ok(sg_label_map_create(p->map.width, p->map.height, &map, &err));
    slow_image_energy(p, d, &map);
    for (size_t i = 0; i < map.width * map.height; i++)
        wrong += map.labels[i] != p->map.labels[i];
    sg_label_map_clear(&map);
    return wrong;
}

static const char *const GRAMMARS[] = {"arcade.sg", "office.sg"};

/* With a third of the pixels wrong the parse is at least as good as the truth by energy, and nearly the truth by pixels. */
START_TEST(planted_facades_are_found)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    planted p = plant(GRAMMARS[_i % 2], 60, 80, 0.33);
    sg_facade_opts o = small_opts();
    o.search.seed = (uint64_t)_i + 1;
    o.search.iterations = 10000;
    sg_facade_parse parse;
    ck_ok(sg_facade_run(p.g, &p.costs, p.channel, &o, NULL, &parse, &err));
    const sg_facade_result *r = &parse.results[SG_FACADE_SEARCH];
    ck_assert(r->done && parse.best == SG_FACADE_SEARCH && parse.searched);
    ck_ok(sg_derivation_check(&r->derivation, &err));
    const double found = slow_energy(&p, &r->derivation), truth = slow_energy(&p, &p.d);
    ck_assert_double_eq_tol(sg_energy_sum(&r->energy), found, 1e-4 * fabs(found));
    ck_assert_msg(found <= truth + 1, "seed %d: energy %g, that of the truth %g", _i, found, truth);
    const size_t wrong = count_wrong(&p, &r->derivation);
    ck_assert_msg(wrong < 60 * 80 / 50, "seed %d: %zu of 4800 pixels are wrong", _i, wrong);
    sg_facade_parse_clear(&parse);
    planted_clear(&p);
}
END_TEST

START_TEST(stages_are_those_asked_for)
{
    planted p = plant(GRAMMARS[_i % 2], 40, 50, 0.3);
    sg_facade_opts o = small_opts();
    sg_facade_parse parse;
    for (int s = 0; s < SG_FACADE_STAGES; s++)
        o.stages[s] = (_i >> s & 1) != 0;
    const sg_status st = sg_facade_run(p.g, &p.costs, p.channel, &o, NULL, &parse, &err);
    if (_i == 0) {
        ck_assert_int_eq(st, SG_EINVAL);
        sg_facade_parse_clear(&parse);
        planted_clear(&p);
        return;
    }
    ck_ok(st);
    const bool exact = o.stages[SG_FACADE_EXACT] || o.stages[SG_FACADE_SEARCH_FROM_EXACT];
    ck_assert_int_eq(parse.results[SG_FACADE_EXACT].done, exact);
    ck_assert_int_eq(parse.results[SG_FACADE_SEARCH].done, o.stages[SG_FACADE_SEARCH]);
    ck_assert_int_eq(parse.results[SG_FACADE_SEARCH_FROM_EXACT].done, o.stages[SG_FACADE_SEARCH_FROM_EXACT]);
    const double best = sg_energy_sum(&parse.results[parse.best].energy);
    for (int s = 0; s < SG_FACADE_STAGES; s++) {
        const sg_facade_result *r = &parse.results[s];
        if (!r->done)
            continue;
        const double slow = slow_energy(&p, &r->derivation);
        ck_assert_double_eq_tol(sg_energy_sum(&r->energy), slow, 1e-4 * fabs(slow));
        ck_assert_double_ge(sg_energy_sum(&r->energy), best);
    }
    if (o.stages[SG_FACADE_SEARCH_FROM_EXACT])
        ck_assert_double_le(sg_energy_sum(&parse.results[SG_FACADE_SEARCH_FROM_EXACT].energy),
                            sg_energy_sum(&parse.results[SG_FACADE_EXACT].energy) + 1e-6);
    ck_assert_int_eq(parse.searched, _i != 1);
    ck_assert_int_eq(parse.samples.nsamples > 0, parse.searched);
    ck_assert_int_eq(parse.columns > 0 && parse.rows > 0 && parse.states > 0, exact);
    sg_facade_parse_clear(&parse);
    planted_clear(&p);
}
END_TEST

/* A progress that stops when it is asked the n-th time. */
typedef struct {
    size_t asked, limit;
} patience;

static bool out_of_patience(sg_progress *self)
{
    patience *p = self->user;
    return p->asked++ >= p->limit;
}

START_TEST(stopped_at_any_time_the_best_so_far_is_there)
{
    planted p = plant("arcade.sg", 40, 50, 0.3);
    sg_facade_opts o = small_opts();
    patience pat = {0, (size_t)_i};
    sg_progress progress = {NULL, out_of_patience, &pat};
    sg_facade_parse parse;
    o.stages[SG_FACADE_SEARCH_FROM_EXACT] = true;
    ck_assert_int_eq(sg_facade_run(p.g, &p.costs, p.channel, &o, &progress, &parse, &err), SG_STOPPED);
    const double best = sg_energy_sum(&parse.results[parse.best].energy);
    ck_assert(parse.results[parse.best].done && isfinite(best));
    const double slow = slow_energy(&p, &parse.results[parse.best].derivation);
    ck_assert_double_eq_tol(best, slow, 1e-4 * fabs(slow));
    sg_facade_parse_clear(&parse);
    planted_clear(&p);
}
END_TEST

START_TEST(threads_and_runs_do_not_change_the_result)
{
    planted p = plant("office.sg", 40, 50, 0.3);
    sg_facade_opts o = small_opts();
    sg_facade_parse one, two;
    sg_float_map a, b;
    ck_ok(sg_facade_run(p.g, &p.costs, p.channel, &o, NULL, &one, &err));
    o.search.threads = 3;
    ck_ok(sg_facade_run(p.g, &p.costs, p.channel, &o, NULL, &two, &err));
    ck_assert(sg_energy_sum(&one.results[one.best].energy) == sg_energy_sum(&two.results[two.best].energy));
    ck_ok(sg_facade_samples_marginals(&one.samples, &a, &err));
    ck_ok(sg_facade_samples_marginals(&two.samples, &b, &err));
    ck_assert_mem_eq(a.values, b.values, a.channels * a.height * a.width * sizeof *a.values);
    sg_float_map_clear(&a);
    sg_float_map_clear(&b);
    sg_facade_parse_clear(&one);
    sg_facade_parse_clear(&two);
    planted_clear(&p);
}
END_TEST

START_TEST(seeds_differ_by_name_and_seed)
{
    uint64_t seen[400];
    size_t n = 0;
    for (uint64_t seed = 0; seed < 20; seed++)
        for (int k = 0; k < 20; k++) {
            char name[32];
            snprintf(name, sizeof name, "facade%03d", k);
            seen[n] = sg_facade_seed(seed, name);
            ck_assert_uint_eq(seen[n], sg_facade_seed(seed, name));
            for (size_t i = 0; i < n; i++)
                ck_assert_uint_ne(seen[i], seen[n]);
            n++;
        }
}
END_TEST

/* ---- samples ---- */

enum { CHANNELS = 7, WIDTH = 23, HEIGHT = 31, MOST = 16 };

static void add_sample(sg_facade_samples *s, const planted *p, uint32_t run, uint64_t iteration)
{
    sg_derivation d;
    sg_derivation_init(&d, p->g);
    ck_ok(sg_derivation_sample(&d, rng, 100000, &err));
    ck_ok(sg_facade_samples_add(s, run, iteration, &d, &err));
    sg_derivation_clear(&d);
}

START_TEST(samples_thin_out_evenly)
{
    planted p = {0};
    sg_facade_samples s;
    load_grammar(&p, "arcade.sg");
    sg_facade_samples_init(&s, WIDTH, HEIGHT, p.channel, p.classes.nclasses, MOST, 10);
    for (uint64_t it = 10; it <= 10 * (uint64_t)(_i + 1); it += 10)
        for (uint32_t run = 0; run < 3; run++)
            add_sample(&s, &p, run, it);
    const size_t per_run = s.nsamples / 3, offered = (size_t)_i + 1;
    ck_assert_uint_eq(s.nsamples % 3, 0);
    ck_assert_uint_le(per_run, MOST);
    ck_assert(offered <= MOST ? per_run == offered : per_run >= MOST / 2);
    for (size_t i = 0; i < s.nsamples; i++) {
        ck_assert_uint_eq(s.samples[i].run, i % 3);
        ck_assert_uint_eq(s.samples[i].iteration, s.interval * (i / 3 + 1));
        /* the rectangles of every sample that is left tile the picture */
        size_t area = 0;
        for (size_t k = 0; k < s.samples[i].nrects; k++) {
            const sg_pixel_rect *r = &s.rects[s.samples[i].first + k];
            area += (size_t)(r->x1 - r->x0) * (size_t)(r->y1 - r->y0);
        }
        ck_assert_uint_eq(area, WIDTH * HEIGHT);
    }
    sg_facade_samples_clear(&s);
    planted_clear(&p);
}
END_TEST

START_TEST(marginals_are_shares_of_the_window)
{
    planted p = {0};
    sg_facade_samples s;
    sg_float_map m;
    sg_label_map map;
    load_grammar(&p, "arcade.sg");
    ck_assert_uint_eq(p.classes.nclasses, CHANNELS);
    sg_facade_samples_init(&s, WIDTH, HEIGHT, p.channel, CHANNELS, MOST, 1);
    ck_assert_int_eq(sg_facade_samples_marginals(&s, &m, &err), SG_EINVAL);
    for (uint64_t it = 1; it <= 12; it++)
        add_sample(&s, &p, 0, it);
    ck_ok(sg_label_map_create(WIDTH, HEIGHT, &map, &err));
    size_t count[CHANNELS][WIDTH * HEIGHT] = {{0}};
    for (size_t i = 4; i < 9; i++) {
        ck_assert_uint_eq(s.samples[i].iteration, i + 1);
        sg_facade_samples_raster(&s, i, &map);
        for (size_t k = 0; k < WIDTH * HEIGHT; k++)
            count[map.labels[k]][k]++;
    }
    sg_facade_samples_window(&s, 4, 9); /* 5, 6, 7, 8, 9 */
    ck_assert_uint_eq(s.nsamples, 5);
    ck_ok(sg_facade_samples_marginals(&s, &m, &err));
    ck_assert(m.channels == CHANNELS && m.height == HEIGHT && m.width == WIDTH);
    float entropy[WIDTH * HEIGHT];
    sg_marginals_entropy(&m, entropy);
    for (size_t k = 0; k < WIDTH * HEIGHT; k++) {
        double sum = 0, h = 0;
        for (size_t c = 0; c < CHANNELS; c++) {
            const double share = (double)count[c][k] / 5;
            ck_assert_double_eq_tol(m.values[c * WIDTH * HEIGHT + k], share, 1e-7);
            sum += (double)m.values[c * WIDTH * HEIGHT + k];
            h -= share > 0 ? share * log(share) : 0;
        }
        ck_assert_double_eq_tol(sum, 1, 1e-6);
        ck_assert_double_eq_tol(entropy[k], h, 1e-5);
    }
    sg_label_map_clear(&map);
    sg_float_map_clear(&m);
    sg_facade_samples_clear(&s);
    planted_clear(&p);
}
END_TEST

/* ---- lines ---- */

static sg_label_map random_map(size_t width, size_t height)
{
    sg_label_map m;
    ck_ok(sg_label_map_create(width, height, &m, &err));
    for (int k = 0; k < 6; k++) {
        const size_t x0 = gsl_rng_uniform_int(rng, width), y0 = gsl_rng_uniform_int(rng, height);
        const uint8_t label = (uint8_t)gsl_rng_uniform_int(rng, 3);
        for (size_t y = y0; y < height && y < y0 + 7; y++)
            for (size_t x = x0; x < width && x < x0 + 7; x++)
                m.labels[y * width + x] = label;
    }
    return m;
}

START_TEST(lines_are_all_of_the_boundary_once)
{
    gsl_rng_set(rng, (unsigned long)_i + 1);
    const size_t width = 1 + gsl_rng_uniform_int(rng, 20), height = 1 + gsl_rng_uniform_int(rng, 20);
    sg_label_map m = random_map(width, height);
    sg_facade_line *lines = NULL;
    size_t n = 0, boundary = 0, covered = 0;
    ck_ok(sg_facade_lines_find(&m, &lines, &n, &err));
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            boundary += x > 0 && m.labels[y * width + x] != m.labels[y * width + x - 1];
            boundary += y > 0 && m.labels[y * width + x] != m.labels[(y - 1) * width + x];
        }
    for (size_t k = 0; k < n; k++) {
        const sg_facade_line *l = &lines[k];
        covered += l->to - l->from;
        ck_assert(l->from < l->to && l->at > 0 && isnan(l->share));
        for (size_t i = 0; i < k; i++) /* none touches another: they would be one */
            ck_assert(lines[i].vertical != l->vertical || lines[i].at != l->at || lines[i].to < l->from || l->to < lines[i].from);
        size_t before[3] = {0}, after[3] = {0};
        for (size_t i = l->from; i < l->to; i++) {
            const size_t x = l->vertical ? l->at : i, y = l->vertical ? i : l->at;
            const uint8_t a = m.labels[y * width + x], b = m.labels[l->vertical ? y * width + x - 1 : (y - 1) * width + x];
            ck_assert_uint_ne(a, b);
            after[a]++;
            before[b]++;
        }
        for (int c = 0; c < 3; c++)
            ck_assert(before[c] <= before[l->before] && after[c] <= after[l->after]);
    }
    ck_assert_uint_eq(covered, boundary);
    free(lines);
    sg_label_map_clear(&m);
}
END_TEST

/* A sample with one vertical boundary at each of the places. */
static void add_stripes(sg_facade_samples *s, const uint16_t *at, size_t n)
{
    static sg_pixel_rect rects[64];
    s->rects = rects;
    const size_t first = s->nrects;
    for (size_t k = 0; k <= n; k++) {
        const uint16_t x0 = k > 0 ? at[k - 1] : 0, x1 = k < n ? at[k] : (uint16_t)s->width;
        rects[s->nrects++] = (sg_pixel_rect){x0, 0, x1, (uint16_t)s->height, (uint8_t)(k % 2)};
    }
    s->samples[s->nsamples++] = (sg_facade_sample){0, s->nsamples + 1, first, n + 1};
}

START_TEST(lines_have_the_spread_of_the_samples)
{
    static sg_facade_sample room[8];
    sg_facade_samples s = {.width = 60, .height = 10, .nchannels = 2, .samples = room};
    /* the first line at 20, 18, 23, and once out of reach; the second at 40 always */
    add_stripes(&s, (const uint16_t[]){20, 40}, 2);
    add_stripes(&s, (const uint16_t[]){18, 40}, 2);
    add_stripes(&s, (const uint16_t[]){23, 40}, 2);
    add_stripes(&s, (const uint16_t[]){26, 40}, 2);
    sg_label_map m;
    sg_facade_line *lines = NULL;
    size_t n = 0;
    ck_ok(sg_label_map_create(60, 10, &m, &err));
    sg_facade_samples_raster(&s, 0, &m);
    ck_ok(sg_facade_lines_find(&m, &lines, &n, &err));
    ck_assert_uint_eq(n, 2);
    ck_ok(sg_facade_lines_judge(lines, n, &s, &err));
    const double mean = (20 + 18 + 23) / 3.0;
    const double variance = ((20 - mean) * (20 - mean) + (18 - mean) * (18 - mean) + (23 - mean) * (23 - mean)) / 3;
    ck_assert(lines[0].vertical && lines[0].at == 20 && lines[0].from == 0 && lines[0].to == 10);
    ck_assert_double_eq_tol(lines[0].share, 0.75, 1e-12);
    ck_assert_double_eq_tol(lines[0].mean, mean, 1e-12);
    ck_assert_double_eq_tol(lines[0].sd, sqrt(variance), 1e-9);
    ck_assert(lines[1].share == 1 && lines[1].mean == 40 && lines[1].sd == 0);
    /* no sample has it: a share of 0 and no place; no samples: not even a share */
    s.nsamples = 0;
    add_stripes(&s, NULL, 0);
    ck_ok(sg_facade_lines_judge(lines, n, &s, &err));
    ck_assert(lines[0].share == 0 && isnan(lines[0].mean) && isnan(lines[0].sd));
    s.nsamples = 0;
    ck_ok(sg_facade_lines_judge(lines, n, &s, &err));
    ck_assert_double_nan(lines[0].share);
    free(lines);
    sg_label_map_clear(&m);
}
END_TEST

START_TEST(half_of_a_line_is_enough)
{
    static sg_facade_sample room[4];
    static sg_pixel_rect rects[8] = {{0, 0, 6, 5, 1}, {6, 0, 12, 5, 0}, {0, 5, 12, 10, 0},   /* half of it, one px away */
                                     {0, 0, 7, 4, 1}, {7, 0, 12, 4, 0}, {0, 4, 12, 10, 0}}; /* less than half */
    sg_facade_samples s = {.width = 12, .height = 10, .nchannels = 2, .samples = room, .nsamples = 2, .rects = rects};
    room[0] = (sg_facade_sample){0, 1, 0, 3};
    room[1] = (sg_facade_sample){0, 2, 3, 3};
    sg_facade_line line = {.vertical = true, .at = 7, .from = 0, .to = 10};
    ck_ok(sg_facade_lines_judge(&line, 1, &s, &err));
    ck_assert(line.share == 0.5 && line.mean == 6 && line.sd == 0);
    /* horizontal lines are judged alike */
    sg_facade_line across = {.vertical = false, .at = 4, .from = 0, .to = 6};
    ck_ok(sg_facade_lines_judge(&across, 1, &s, &err));
    ck_assert(across.share == 1 && across.mean == 4.5 && across.sd == 0.5);
}
END_TEST

/* ---- which photographs ---- */

typedef struct {
    temp_folder t;
    sg_arena *arena;
    sg_dataset_opts dataset;
    sg_facade_photo_opts opts;
    sg_facade_photos photos;
    size_t nfaults;
} folder;

static void count_fault(void *user, const char *sentence)
{
    (void)sentence;
    ((folder *)user)->nfaults++;
}

static folder *make_folder(void)
{
    folder *f = calloc(1, sizeof *f);
    ck_assert_ptr_nonnull(f);
    f->t = temp_folder_make();
    f->arena = sg_arena_create();
    f->dataset = (sg_dataset_opts)SG_DATASET_OPTS_INIT;
    f->opts.dataset = &f->dataset;
    ck_assert_ptr_nonnull(f->arena);
    return f;
}

static void remove_folder(folder *f)
{
    temp_folder_remove(&f->t);
    sg_arena_free(f->arena);
    free(f);
}

static sg_status list(folder *f, const char *const *args, size_t n)
{
    char *copy[8];
    for (size_t i = 0; i < n; i++)
        copy[i] = sg_arena_string(f->arena, args[i]);
    return sg_facade_photos_list(copy, n, &f->opts, f->arena, count_fault, f, &f->photos, &err);
}

START_TEST(photographs_have_the_names_of_their_files)
{
    folder *f = make_folder();
    ck_ok(list(f, (const char *const[]){"a/b.jpg", "c.d.png", ".hidden", "plain", "/x/y.JPEG"}, 5));
    static const char *const names[] = {"b", "c.d", ".hidden", "plain", "y"};
    ck_assert_uint_eq(f->photos.n, 5);
    for (size_t i = 0; i < 5; i++) {
        ck_assert_str_eq(f->photos.items[i].name, names[i]);
        ck_assert(f->photos.items[i].image != NULL && f->photos.items[i].probabilities == NULL && f->photos.items[i].truth == NULL);
    }
    ck_assert_int_eq(list(f, (const char *const[]){"a/b.jpg", "c.png", "d/b.png"}, 3), SG_EINVAL);
    ck_assert(strstr(err.msg, "called b,") != NULL && strstr(err.msg, "a/b.jpg") != NULL && strstr(err.msg, "d/b.png") != NULL);
    static const char *const bad[] = {"", "a/", "..", "."};
    for (size_t i = 0; i < 4; i++) {
        const sg_status st = list(f, &bad[i], 1);
        ck_assert_msg(st == SG_EINVAL || st == SG_EINPUT, "'%s': %d", bad[i], (int)st);
    }
    remove_folder(f);
}
END_TEST

START_TEST(probabilities_may_stand_alone)
{
    folder *f = make_folder();
    temp_text(&f->t, "alone.npy", "x");
    temp_text(&f->t, "with.dot.npy", "x");
    f->opts.probabilities = f->t.path;
    f->opts.truth = "truth";
    ck_ok(list(f, (const char *const[]){"alone", "with.dot", "other.jpg"}, 3));
    const sg_facade_photo *p = f->photos.items;
    ck_assert(strcmp(p[0].name, "alone") == 0 && p[0].image == NULL && p[0].probabilities != NULL);
    ck_assert(strcmp(p[1].name, "with.dot") == 0 && p[1].image == NULL);
    ck_assert(strcmp(p[2].name, "other") == 0 && p[2].image != NULL && strstr(p[2].probabilities, "/other.npy") != NULL);
    ck_assert_str_eq(p[0].truth, "truth/alone.png");
    remove_folder(f);
}
END_TEST

static void add_labels(folder *f, const char *name)
{
    char file[64];
    uint32_t colors[256] = {0};
    sg_label_map m;
    snprintf(file, sizeof file, "labels/%s.png", name);
    ck_ok(sg_label_map_create(3, 2, &m, &err));
    ck_ok(sg_png_write_labels(temp_path(&f->t, file), &m, colors, 256, &err));
    sg_label_map_clear(&m);
}

START_TEST(data_sets_bring_their_photographs_and_truth)
{
    folder *f = make_folder();
    temp_mkdir(&f->t, "labels");
    temp_mkdir(&f->t, "folds");
    add_labels(f, "a");
    add_labels(f, "b");
    temp_text(&f->t, "classes.tsv", "0\twall\t#ffff00\n");
    temp_text(&f->t, "folds/1.tsv", "a\ttrain\nb\ttest\n");
    const char *const args[] = {"x.jpg", f->t.path};
    ck_ok(list(f, args, 2));
    ck_assert(f->photos.n == 3 && f->photos.ndatasets == 1);
    ck_assert_str_eq(f->photos.items[2].name, "b");
    ck_assert(strstr(f->photos.items[2].image, "/images/b.jpg") != NULL && strstr(f->photos.items[2].truth, "/labels/b.png") != NULL);
    ck_assert_ptr_null(f->photos.items[0].truth);
    f->dataset.fold = 1;
    f->dataset.part = SG_SPLIT_TEST;
    f->opts.truth = f->t.path; /* a data set is truth for others too */
    ck_ok(list(f, args, 2));
    ck_assert_uint_eq(f->photos.n, 2);
    ck_assert(strstr(f->photos.items[0].truth, "/labels/x.png") != NULL);
    f->dataset.fold = 2;
    ck_assert_int_eq(list(f, args, 2), SG_EINPUT);
    ck_assert_uint_gt(f->nfaults, 0);
    remove_folder(f);
}
END_TEST

START_TEST(results_replace_nothing)
{
    folder *f = make_folder();
    temp_text(&f->t, "in", "x");
    temp_text(&f->t, "old", "y");
    ck_assert_int_eq(symlink(temp_path(&f->t, "in"), temp_path(&f->t, "link")), 0);
    const char *in = sg_arena_string(f->arena, temp_path(&f->t, "in")), *old = sg_arena_string(f->arena, temp_path(&f->t, "old"));
    const char *link = sg_arena_string(f->arena, temp_path(&f->t, "link")), *fresh = sg_arena_string(f->arena, temp_path(&f->t, "new"));
    const char *const inputs[] = {NULL, in, "/none/there", "/dev/null"};
    ck_ok(sg_facade_spare_files((const char *const[]){old, fresh, "/dev/null"}, 3, inputs, 4, &err));
    ck_assert_int_eq(sg_facade_spare_files((const char *const[]){fresh, old, fresh}, 3, inputs, 4, &err), SG_EINVAL);
    ck_assert_ptr_nonnull(strstr(err.msg, "/new: two results"));
    ck_assert_int_eq(sg_facade_spare_files((const char *const[]){fresh, in}, 2, inputs, 4, &err), SG_EINVAL);
    ck_assert_int_eq(sg_facade_spare_files((const char *const[]){fresh, link}, 2, inputs, 4, &err), SG_EINVAL);
    ck_assert_ptr_nonnull(strstr(err.msg, "/link: this is read"));
    ck_ok(sg_facade_spare_files(NULL, 0, NULL, 0, &err));
    remove_folder(f);
}
END_TEST

/* ---- lack of memory ---- */

static sg_status run_and_judge(const planted *p, const sg_facade_opts *o)
{
    sg_facade_parse parse = {0};
    sg_float_map marginals = {0};
    sg_facade_line *lines = NULL;
    size_t n = 0;
    sg_status st = sg_facade_run(p->g, &p->costs, p->channel, o, NULL, &parse, &err);
    if (st == SG_OK)
        st = sg_facade_samples_marginals(&parse.samples, &marginals, &err);
    if (st == SG_OK)
        st = sg_facade_lines_find(&p->map, &lines, &n, &err);
    if (st == SG_OK)
        st = sg_facade_lines_judge(lines, n, &parse.samples, &err);
    free(lines);
    sg_float_map_clear(&marginals);
    sg_facade_parse_clear(&parse);
    return st;
}

START_TEST(each_allocation_may_fail)
{
    planted p = plant("arcade.sg", 12, 12, 0.1);
    sg_facade_opts o = small_opts();
    o.search = (sg_metropolis_opts)SG_METROPOLIS_OPTS_INIT;
    o.search.runs = 1;
    o.search.chains = 2;
    o.search.iterations = 20;
    o.search.swap_every = 5;
    o.search.tries = 3;
    o.search.threads = 1;
    size_t failed = 0;
    for (size_t k = 0;; k++) {
        test_fail_allocation(k);
        const sg_status st = run_and_judge(&p, &o);
        if (!test_allocation_failed()) {
            ck_assert_int_eq(st, SG_OK);
            break;
        }
        failed++;
        ck_assert_msg(st == SG_ENOMEM, "allocation %zu: status %d: %s", k, (int)st, err.msg);
    }
    ck_assert_uint_gt(failed, 20);
    planted_clear(&p);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("facade");
    TCase *tc = tcase_create("facade");
    tcase_set_timeout(tc, 60);
    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_loop_test(tc, planted_facades_are_found, 0, 6);
    tcase_add_loop_test(tc, stages_are_those_asked_for, 0, 8);
    tcase_add_loop_test(tc, stopped_at_any_time_the_best_so_far_is_there, 0, 4);
    tcase_add_test(tc, threads_and_runs_do_not_change_the_result);
    tcase_add_test(tc, seeds_differ_by_name_and_seed);
    tcase_add_loop_test(tc, samples_thin_out_evenly, 0, 70);
    tcase_add_test(tc, marginals_are_shares_of_the_window);
    tcase_add_loop_test(tc, lines_are_all_of_the_boundary_once, 0, 40);
    tcase_add_test(tc, lines_have_the_spread_of_the_samples);
    tcase_add_test(tc, half_of_a_line_is_enough);
    tcase_add_test(tc, photographs_have_the_names_of_their_files);
    tcase_add_test(tc, probabilities_may_stand_alone);
    tcase_add_test(tc, data_sets_bring_their_photographs_and_truth);
    tcase_add_test(tc, results_replace_nothing);
    tcase_add_test(tc, each_allocation_may_fail);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
