/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_derivation_io.c - derivations as files and back: bit for bit, or refused with a word of what is wrong. */
#include "config.h"

#include "core/random.h"
#include "derivation/derivation_io.h"
#include "derivation/derivation_move.h"
#include "grammar/fingerprint.h"
#include "scene/derivation_json.h"
#include "scene/derivation_load.h"
#include "tests/derivation_grammars.h"
#include "tests/failing_malloc.h"
#include "tests/grammar_support.h"
#include "tests/random_grammar.h"
#include "tests/temp_folder.h"

static bool same_bytes(const void *a, const void *b, size_t n)
{
    return n == 0 || memcmp(a, b, n) == 0;
}

static bool same(const sg_derivation *a, const sg_derivation *b)
{
    return a->nnodes == b->nnodes && a->nvalues == b->nvalues && a->nuniforms == b->nuniforms &&
           same_bytes(a->nodes, b->nodes, a->nnodes * sizeof *a->nodes) &&
           same_bytes(a->values, b->values, a->nvalues * sizeof *a->values) &&
           same_bytes(a->uniforms, b->uniforms, a->nuniforms * sizeof *a->uniforms);
}

/* A grammar, a derivation of it, a generator; what was written last. */
typedef struct {
    sg_grammar *g;
    sg_derivation d;
    gsl_rng *rng;
    char *text;
    size_t size;
} fixture;

static fixture open_fixture(sg_grammar *g, uint64_t seed)
{
    fixture f = {.g = g, .rng = sg_random_create(seed)};
    ck_assert_ptr_nonnull(f.rng);
    sg_derivation_init(&f.d, f.g);
    return f;
}

static fixture open_stored(uint64_t seed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(test_grammar(GRAMMAR_OF_DERIVATIONS), seed);
    ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    return f;
}

static void close_fixture(fixture *f)
{
    sg_derivation_clear(&f->d);
    gsl_rng_free(f->rng);
    sg_grammar_free(f->g);
    free(f->text);
}

static void write_json(fixture *f, bool placed)
{
    sg_error err = SG_ERROR_INIT;
    free(f->text);
    FILE *fp = open_memstream(&f->text, &f->size);
    ck_assert_ptr_nonnull(fp);
    const sg_status st = placed ? sg_derivation_write_json(&f->d, 300, 400, fp, &err)
                                : sg_derivation_write_json_tree(&f->d, fp, &err);
    ck_assert_int_eq(fclose(fp), 0);
    ck_assert_msg(st == SG_OK || (placed && st == SG_ENUMERIC), "%s", err.msg);
    if (st != SG_OK)
        f->size = 0;
}

static void must_hold(const fixture *f, sg_derivation_file *file)
{
    sg_error err = SG_ERROR_INIT;
    double log_prior = NAN;
    ck_ok(sg_derivation_log_prior(&f->d, &log_prior, &err));
    ck_assert_uint_eq(file->n, 1);
    ck_assert(same(file->items, &f->d));
    ck_assert(file->items[0].grammar == f->g);
    ck_assert(file->log_priors[0] == log_prior);
    sg_derivation_file_clear(file);
}

static void must_come_back(fixture *f)
{
    sg_error err = SG_ERROR_INIT;
    sg_derivation_file file = {0};
    sg_bytes b = {0};
    ck_ok(sg_derivation_file_encode(f->g, &f->d, 1, &b, &err));
    ck_ok(sg_derivation_file_decode(b.bytes, b.n, "test.sgd", f->g, &file, &err));
    must_hold(f, &file);
    sg_bytes_clear(&b);
    for (int placed = 0; placed < 2; placed++) {
        write_json(f, placed);
        if (f->size == 0)
            continue; /* no label scene */
        ck_ok(sg_derivation_parse_json(f->text, f->size, "test.json", f->g, &file, &err));
        must_hold(f, &file);
    }
}

/* One open node, and up to so many expansions of any open node. */
static void grow_some(fixture *f, int steps)
{
    sg_error err = SG_ERROR_INIT;
    ck_ok(sg_derivation_open(&f->d, sg_grammar_start(f->g), sg_grammar_start_args(f->g), 0, &err));
    must_come_back(f);
    for (; steps > 0 && f->d.nnodes < 3000; steps--) {
        const size_t node = gsl_rng_uniform_int(f->rng, f->d.nnodes);
        sg_rule_id rule = SG_NONE;
        if (f->d.nodes[node].rule == SG_NONE && sg_derivation_choose(&f->d, node, f->rng, &rule, &err) == SG_OK)
            sg_derivation_expand(&f->d, node, rule, f->rng, &err); /* may fail: then nothing has changed */
    }
}

START_TEST(any_derivation_comes_back_bit_for_bit)
{
    sg_error err = SG_ERROR_INIT;
    random_grammar_opts opts = RANDOM_GRAMMAR_OPTS_INIT;
    opts.derivable = true;
    gsl_rng *rng = sg_random_create((uint64_t)_i);
    char *text = random_grammar_text(rng, &opts);
    fixture f = open_fixture(test_grammar(text), (uint64_t)_i);
    for (int round = 0; round < 5; round++) {
        if (sg_derivation_sample(&f.d, f.rng, 2000, &err) == SG_OK)
            must_come_back(&f);
        grow_some(&f, 40);
        must_come_back(&f);
    }
    close_fixture(&f);
    free(text);
    gsl_rng_free(rng);
}
END_TEST

START_TEST(tied_and_placed_derivations_come_back)
{
    sg_error err = SG_ERROR_INIT;
    size_t scenes = 0;
    fixture f = open_stored((uint64_t)_i + 1);
    for (int round = 0; round < 30; round++) {
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
        must_come_back(&f);
        scenes += f.size > 0;
        grow_some(&f, 20);
        must_come_back(&f);
    }
    ck_assert_uint_gt(scenes, 3);
    close_fixture(&f);
}
END_TEST

/* Shifted sizes are what the uniforms make only up to rounding: they must be kept, not made again. */
START_TEST(values_are_kept_not_recomputed)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_fixture(test_grammar("label t start S rule S -> split x { t | t | t } sizes mean (0.3, 0.3, 0.4) sd (0.1, 0.1, 0.1)"), 3);
    ck_ok(sg_derivation_sample(&f.d, f.rng, 10, &err));
    double uniforms[8], frame[8], density = 0;
    for (int round = 0; round < 50; round++) {
        sg_node_draws draws = {uniforms, frame, NULL};
        bool inside = false;
        sg_node_shift(&f.d, 0, 0.2, f.rng, &draws, &density, &inside);
        if (!inside)
            continue;
        memcpy(f.d.uniforms, uniforms, f.d.nuniforms * sizeof *uniforms);
        memcpy(f.d.values, draws.values, f.d.nvalues * sizeof *frame);
        must_come_back(&f);
    }
    close_fixture(&f);
}
END_TEST

START_TEST(slices_keep_their_depth)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(5);
    while (f.d.nnodes < 4)
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    sg_derivation slice;
    sg_derivation_init(&slice, f.g);
    ck_ok(sg_derivation_extract(&f.d, f.d.nnodes - 1, &slice, &err));
    ck_ok(sg_derivation_copy(&f.d, &slice, &err));
    ck_assert_uint_gt(f.d.nodes[0].depth, 0);
    must_come_back(&f);
    sg_derivation_clear(&slice);
    close_fixture(&f);
}
END_TEST

START_TEST(several_derivations_in_one_file)
{
    sg_error err = SG_ERROR_INIT;
    enum { N = 4 };
    fixture f = open_stored(2);
    sg_derivation list[N];
    sg_derivation_file file = {0};
    temp_folder t = temp_folder_make();
    for (size_t i = 0; i < N; i++) {
        sg_derivation_init(list + i, f.g);
        ck_ok(sg_derivation_sample(list + i, f.rng, 100000, &err));
    }
    for (size_t n = 0; n <= N; n += N) {
        const char *path = temp_path(&t, "some.sgd");
        ck_ok(sg_derivation_file_write(path, f.g, list, n, &err));
        for (int any = 0; any < 2; any++) {
            ck_ok(any ? sg_derivation_load(path, f.g, &file, &err) : sg_derivation_file_read(path, f.g, &file, &err));
            ck_assert_uint_eq(file.n, n);
            for (size_t i = 0; i < n; i++)
                ck_assert(same(file.items + i, list + i));
            sg_derivation_file_clear(&file);
        }
    }
    for (size_t i = 0; i < N; i++)
        sg_derivation_clear(list + i);
    temp_folder_remove(&t);
    close_fixture(&f);
}
END_TEST

START_TEST(json_holds_one_or_a_list)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(2);
    temp_folder t = temp_folder_make();
    sg_derivation_file file = {0};
    write_json(&f, false);
    char *list = malloc(2 * f.size + 10);
    const int n = sprintf(list, " \n[%s,%s]", f.text, f.text);
    temp_write(&t, "list.json", list, (size_t)n);
    ck_ok(sg_derivation_load(temp_path(&t, "list.json"), f.g, &file, &err));
    ck_assert_uint_eq(file.n, 2);
    ck_assert(same(file.items, &f.d) && same(file.items + 1, &f.d));
    sg_derivation_file_clear(&file);
    free(list);
    temp_folder_remove(&t);
    close_fixture(&f);
}
END_TEST

/* The same grammar in other words is the same; a changed number is another. */
START_TEST(another_grammar_is_refused)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(3);
    char *text = test_print(f.g);
    sg_grammar *again = test_grammar(text);
    free(text);
    sg_grammar *other = test_grammar(GRAMMAR_OF_DERIVATIONS "rule V -> t\nrule T(b) -> 0 : V\n");
    sg_bytes b = {0};
    sg_derivation_file file = {0};
    ck_ok(sg_derivation_file_encode(f.g, &f.d, 1, &b, &err));
    ck_ok(sg_derivation_file_decode(b.bytes, b.n, "a.sgd", again, &file, &err));
    ck_assert(same(file.items, &f.d));
    sg_derivation_file_clear(&file);
    ck_assert_int_eq(sg_derivation_file_decode(b.bytes, b.n, "a.sgd", other, &file, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "a.sgd: byte 24: these are derivations of another grammar than 'stored'"));
    ck_assert_int_eq(sg_derivation_file_encode(other, &f.d, 1, &b, &err), SG_EINVAL);
    sg_bytes_clear(&b);
    sg_grammar_free(again);
    sg_grammar_free(other);
    close_fixture(&f);
}
END_TEST

/* A small file: every cut, every bit, and one byte more. A copy of just that size lets sanitizers see a byte too far. */
static sg_status decode_copy(const fixture *f, const unsigned char *bytes, size_t n, sg_error *err)
{
    sg_derivation_file file = {0};
    unsigned char *copy = malloc(n > 0 ? n : 1);
    if (n > 0)
        memcpy(copy, bytes, n);
    const sg_status st = sg_derivation_file_decode(copy, n, "a.sgd", f->g, &file, err);
    for (size_t i = 0; st == SG_OK && i < file.n; i++)
        test_must(sg_derivation_check(file.items + i, NULL) == SG_OK);
    sg_derivation_file_clear(&file);
    free(copy);
    return st;
}

static void mend_checksum(sg_bytes *b)
{
    const uint32_t crc = sg_bytes_checksum(b->bytes + 24, b->n - 24);
    for (size_t i = 0; i < 4; i++)
        b->bytes[12 + i] = (unsigned char)(crc >> 8 * i);
}

START_TEST(damaged_files_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored((uint64_t)_i + 1);
    while (f.d.nnodes < 3 || f.d.nnodes > 30)
        ck_ok(sg_derivation_sample(&f.d, f.rng, 100000, &err));
    sg_bytes b = {0};
    ck_ok(sg_derivation_file_encode(f.g, &f.d, 1, &b, &err));
    for (size_t n = 0; n < b.n; n++) {
        ck_assert_int_eq(decode_copy(&f, b.bytes, n, &err), SG_EINPUT);
        ck_assert_msg(strncmp(err.msg, "a.sgd: ", 7) == 0, "%s", err.msg);
    }
    size_t good = 0;
    for (size_t bit = 0; bit < 8 * b.n; bit++) {
        b.bytes[bit / 8] ^= (unsigned char)(1U << bit % 8);
        test_must(decode_copy(&f, b.bytes, b.n, &err) == SG_EINPUT);
        if (bit / 8 >= 24) { /* nor is what the checksum lets pass believed */
            mend_checksum(&b);
            const sg_status st = decode_copy(&f, b.bytes, b.n, &err);
            test_must(st == SG_OK || st == SG_EINPUT);
            good += st == SG_OK; /* the last digits of a number may be others */
            b.bytes[bit / 8] ^= (unsigned char)(1U << bit % 8);
            mend_checksum(&b);
        } else {
            b.bytes[bit / 8] ^= (unsigned char)(1U << bit % 8);
        }
    }
    ck_assert_uint_lt(good, 8 * b.n / 2);
    ck_assert_int_eq(decode_copy(&f, b.bytes, b.n, &err), SG_OK);
    sg_bytes_put(&b, 0, 1);
    ck_assert_int_eq(decode_copy(&f, b.bytes, b.n, &err), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(err.msg, "1 bytes too many"));
    sg_bytes_clear(&b);
    close_fixture(&f);
}
END_TEST

/* Sizes that the file cannot fill take no memory. */
START_TEST(no_length_is_trusted)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(1);
    sg_bytes b = {0};
    ck_ok(sg_derivation_file_encode(f.g, &f.d, 1, &b, &err));
    static const size_t sizes[] = {32, 44, 48, 52}; /* derivations, nodes, uniforms, values */
    for (size_t k = 0; k < 4; k++) {
        unsigned char kept[4];
        memcpy(kept, b.bytes + sizes[k], 4);
        memset(b.bytes + sizes[k], 0xff, 4);
        mend_checksum(&b);
        ck_assert_int_eq(decode_copy(&f, b.bytes, b.n, &err), SG_EINPUT);
        ck_assert_msg(strncmp(err.msg, "a.sgd: byte ", 12) == 0, "%s", err.msg);
        memcpy(b.bytes + sizes[k], kept, 4);
    }
    sg_bytes_clear(&b);
    close_fixture(&f);
}
END_TEST

START_TEST(bad_json_is_refused)
{
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"", "a.json:1:1: error: "},
        {"{\"rule\":0,\n\"symbol\":\"S\",}", "a.json:2:"},
        {"{\"rule\":0,\"rule\":0}", "a.json:1:"},
        {"5", "a.json:1:1: error: "},
        {"[5]", "derivation 1: node 0: error: expected an object"},
        {"{}", "\"rule\" is missing"},
        {"{\"rule\":99,\"symbol\":\"S\"}", "no rule of the grammar"},
        {"{\"rule\":-1,\"symbol\":\"S\"}", "no rule of the grammar"},
        {"{\"rule\":4294967295,\"symbol\":\"S\"}", "no rule of the grammar"},
        {"{\"rule\":0.0,\"symbol\":\"S\"}", "no rule of the grammar"},
        {"{\"rule\":0}", "\"symbol\" is missing"},
        {"{\"rule\":0,\"symbol\":\"T\"}", "expected \"S\""},
        {"{\"rule\":null,\"symbol\":\"S\"}", "\"symbol_number\""},
        {"{\"rule\":null,\"symbol\":\"S\",\"symbol_number\":77}", "\"symbol_number\""},
        {"{\"rule\":0,\"symbol\":\"S\",\"values\":[2,0.5]}", "\"uniforms\": expected an array of 1 numbers"},
        {"{\"rule\":0,\"symbol\":\"S\",\"uniforms\":[[]],\"values\":[2,0.5]}", "\"uniforms\": item 1 is no number"},
        {"{\"rule\":0,\"symbol\":\"S\",\"uniforms\":[\"one\"],\"values\":[2,0.5]}", "\"uniforms\": item 1 is no number"},
        {"{\"rule\":0,\"symbol\":\"S\",\"uniforms\":[\"nan\"],\"values\":[2,0.5]}", "a uniform is not in (0,1)"},
        {"{\"rule\":0,\"symbol\":\"S\",\"uniforms\":[0.5],\"values\":[2,0.5]}", "its values are not those"},
        {"{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1],\"children\":{}}", "\"children\" is no array"},
        {"{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1],\"children\":[7]}", "expected an object"},
        {"{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1],\"node\":1}", "\"node\" is no index"},
        {"{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1],\"depth\":-1}", "\"depth\" is no depth"},
        {"{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1],\"depth\":4294967295}", "its depth is 4294967295"},
        {"{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1],\"children\":[{\"rule\":3,\"symbol\":\"S\",\"values\":[0.1]}]}", "children"},
        {"{\"rule\":0,\"node\":1,\"children\":[{\"rule\":3,\"node\":0}]}", "parent"},
        {"{\"rule\":0,\"children\":[{\"rule\":3,\"node\":1},{\"rule\":4,\"node\":1}]}", "it comes a second time, and differs"},
        {"{\"rule\":0,\"children\":[{\"rule\":3,\"node\":2},{\"rule\":4,\"node\":2}]}", "it comes a second time, and differs"},
    };
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(1);
    sg_derivation_file file = {0};
    const char *text = cases[_i].text;
    ck_assert_uint_lt((size_t)_i, sizeof cases / sizeof *cases);
    ck_assert_int_eq(sg_derivation_parse_json(text, strlen(text), "a.json", f.g, &file, &err), SG_EINPUT);
    ck_assert_msg(strncmp(err.msg, "a.json:", 7) == 0 && strstr(err.msg, cases[_i].says) != NULL, "%s", err.msg);
    ck_assert_uint_eq(file.n, 0);
    close_fixture(&f);
}
END_TEST

START_TEST(json_nested_too_deep_is_refused)
{
    sg_error err = SG_ERROR_INIT;
    enum { DEPTH = 100000 };
    fixture f = open_fixture(test_grammar("label t start S(1) rule S(n) if n > 0 -> split x { S(n - 1) | t } rule S(n) if n <= 0 -> t"), 1);
    sg_derivation_file file = {0};
    for (int deep = 0; deep < 2; deep++) {
        ck_ok(sg_derivation_sample_subtree(&f.d, sg_grammar_start(f.g), (const double[]){deep ? DEPTH : 900}, 0, f.rng,
                                           3 * DEPTH, &err));
        if (!deep) {
            must_come_back(&f);
            continue;
        }
        write_json(&f, false);
        ck_assert_int_eq(sg_derivation_parse_json(f.text, f.size, "a.json", f.g, &file, &err), SG_EINPUT);
        ck_assert_ptr_nonnull(strstr(err.msg, "maximum parsing depth"));
    }
    close_fixture(&f);
}
END_TEST

START_TEST(files_that_cannot_be_had)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(1);
    sg_derivation_file file = {0};
    sg_derivation empty;
    sg_bytes b = {0};
    temp_folder t = temp_folder_make();
    sg_derivation_init(&empty, f.g);
    ck_assert_int_eq(sg_derivation_file_encode(f.g, &empty, 1, &b, &err), SG_EINVAL);
    ck_assert_int_eq(sg_derivation_write_json_tree(&empty, stdout, &err), SG_EINVAL);
    ck_assert_int_eq(sg_derivation_file_write("/dev/full", f.g, &f.d, 1, &err), SG_EIO);
    ck_assert_int_eq(sg_derivation_file_read(temp_path(&t, "none"), f.g, &file, &err), SG_EINPUT);
    ck_assert_int_eq(sg_derivation_load(temp_path(&t, "none"), f.g, &file, &err), SG_EINPUT);
    ck_assert_int_eq(sg_derivation_load(t.path, f.g, &file, &err), SG_EINPUT);
    FILE *fp = fopen("/dev/full", "w");
    setvbuf(fp, NULL, _IONBF, 0);
    ck_assert_int_eq(sg_derivation_write_json_tree(&f.d, fp, &err), SG_EIO);
    fclose(fp);
    sg_bytes_clear(&b);
    temp_folder_remove(&t);
    close_fixture(&f);
}
END_TEST

START_TEST(memory_may_run_out)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = open_stored(4);
    sg_bytes b = {0};
    size_t failures = 0;
    ck_ok(sg_derivation_file_encode(f.g, &f.d, 1, &b, &err));
    write_json(&f, false);
    for (int call = 0; call < 3; call++) {
        int failed = 1;
        for (size_t k = 0; failed; k++) {
            sg_derivation_file file = {0};
            sg_bytes out = {0};
            test_fail_allocation(k);
            const sg_status st = call == 0   ? sg_derivation_file_decode(b.bytes, b.n, "a", f.g, &file, &err)
                                 : call == 1 ? sg_derivation_parse_json(f.text, f.size, "a", f.g, &file, &err)
                                             : sg_derivation_file_encode(f.g, &f.d, 1, &out, &err);
            failed = test_allocation_failed();
            ck_assert_msg(st == (failed ? SG_ENOMEM : SG_OK), "call %d, allocation %zu: status %d: %s", call, k, (int)st, err.msg);
            failures += failed != 0;
            sg_derivation_file_clear(&file);
            sg_bytes_clear(&out);
        }
    }
    ck_assert_uint_gt(failures, 10);
    sg_bytes_clear(&b);
    close_fixture(&f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("derivation_io");
    TCase *there = tcase_create("there and back"), *bad = tcase_create("bad files");
    tcase_set_timeout(there, 30);
    tcase_set_timeout(bad, 30);
    tcase_add_loop_test(there, any_derivation_comes_back_bit_for_bit, 0, 60);
    tcase_add_loop_test(there, tied_and_placed_derivations_come_back, 0, 4);
    tcase_add_test(there, values_are_kept_not_recomputed);
    tcase_add_test(there, slices_keep_their_depth);
    tcase_add_test(there, several_derivations_in_one_file);
    tcase_add_test(there, json_holds_one_or_a_list);
    tcase_add_test(bad, another_grammar_is_refused);
    tcase_add_loop_test(bad, damaged_files_are_refused, 0, 3);
    tcase_add_test(bad, no_length_is_trusted);
    tcase_add_loop_test(bad, bad_json_is_refused, 0, 28);
    tcase_add_test(bad, json_nested_too_deep_is_refused);
    tcase_add_test(bad, files_that_cannot_be_had);
    tcase_add_test(bad, memory_may_run_out);
    suite_add_tcase(suite, there);
    suite_add_tcase(suite, bad);
    return test_run(suite);
}
