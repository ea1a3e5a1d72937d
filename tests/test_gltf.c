/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_gltf.c - binary glTF files of several scenes keep the rules of the specification and hold what the mesh holds; a
 * file that breaks a rule is found, for each rule. */
#include "config.h"

#include "scene/mesh_gltf.h"
#include "tests/failing_malloc.h"
#include "tests/gltf_check.h"
#include "tests/scene_support.h"
#include "tests/temp_folder.h"

#include <jansson.h>

static const char plant[] =
    "limit depth 6\nlabel leaf #30a030\nstart T(1)\n"
    "rule T(l) -> width(l / 5) tropism(0, -1, 0, 0.1) draw(l) turn(uniform(-20, 20)) draw(l) "
    "[ turn(40) set_material(twig) T(l * 0.7) ] [ roll(120) turn(35) T(l * 0.6) ] roll(90) T(l * 0.8)\n"
    "rule T(l) at limit -> size(0.2, 0.2, 0.2) insert(sphere) size(0.2, 0.2, 0) leaf\n";
static const char house[] = "label wall #ffffff\nlabel \"dach ü\" #ff8000\nstart S\n"
                            "rule S -> size(4, 3, 6) wall set_label(\"dach ü\") gable_roof(45) set_label(wall) "
                            "set_material(brick) size(1, 5, 1) insert(box) set_material(#000000) insert(cone)\n";
static const char quad[] = "label t #ff8000\nstart S\nrule S -> rotate(0, 90, 0) size(2, 1, 0) t\n";

typedef struct {
    unsigned char *bytes;
    size_t n;
} file;

static file written(const sg_mesh *m)
{
    sg_error err = SG_ERROR_INIT;
    file f = {0};
    FILE *out = open_memstream((char **)&f.bytes, &f.n);
    ck_ok(sg_mesh_gltf_write(m, out, &err));
    fclose(out);
    return f;
}

static sg_mesh mesh_of(const char *text, uint64_t seed, unsigned radial)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_open_scene(text, seed);
    sg_mesh m = {0};
    sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    opts.radial = radial;
    ck_ok(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err));
    ck_ok(sg_mesh_from_scene(&f.scene, &opts, &m, &err));
    for (size_t i = 0; i < m.ngroups; i++) /* the grammar goes, its names with it */
        m.groups[i].name = m.groups[i].name != NULL ? "named" : NULL;
    for (size_t i = 0; i < m.nmaterials; i++)
        m.materials[i].name = NULL;
    test_close_scene(&f);
    return m;
}

static file file_of(const char *text, uint64_t seed, unsigned radial)
{
    sg_mesh m = mesh_of(text, seed, radial);
    const file f = written(&m);
    sg_mesh_clear(&m);
    return f;
}

static size_t count_triangles(const sg_mesh *m)
{
    size_t n = 0;
    for (size_t i = 0; i < m->nfaces; i++)
        n += m->faces[i].ncorners - 2;
    return n;
}

static void check_scene(const char *text, uint64_t seed, unsigned radial)
{
    gltf_counts counts = {0};
    sg_mesh m = mesh_of(text, seed, radial);
    const file f = written(&m);
    const char *rule = gltf_check(f.bytes, f.n, &counts);
    ck_assert_msg(rule == NULL, "%s", rule);
    ck_assert_uint_eq(counts.triangles, count_triangles(&m));
    ck_assert_uint_eq(counts.nodes, counts.meshes);
    ck_assert_uint_ge(counts.vertices, m.nvertices);
    free(f.bytes);
    sg_mesh_clear(&m);
}

START_TEST(files_keep_the_rules)
{
    check_scene(quad, 1, 3);
    check_scene(house, 1, 12);
    for (uint64_t seed = 1; seed <= 5; seed++)
        check_scene(plant, seed, 7);
    check_scene("start S\nrule S -> insert(sphere)\n", 1, 300); /* indices of 32 bits */
}
END_TEST

START_TEST(random_scenes_keep_the_rules)
{
    for (uint64_t k = 0; k < 20; k++) {
        sg_error err = SG_ERROR_INIT;
        test_scene s;
        sg_mesh m = {0};
        const sg_mesh_opts opts = SG_MESH_OPTS_INIT;
        if (!test_random_scene((uint64_t)_i * 20 + k + 1, &s))
            continue;
        if (s.scene.n < 2000 && sg_mesh_from_scene(&s.scene, &opts, &m, &err) == SG_OK) {
            const file f = written(&m);
            gltf_counts counts = {0};
            const char *rule = gltf_check(f.bytes, f.n, &counts);
            ck_assert_msg(rule == NULL, "seed %d, %d: %s", _i, (int)k, rule);
            ck_assert_uint_eq(counts.triangles, count_triangles(&m));
            free(f.bytes);
        }
        sg_mesh_clear(&m);
        test_close_scene(&s);
    }
}
END_TEST

/* 16-bit indices go to 65534. */
START_TEST(indices_are_as_wide_as_they_must_be)
{
    for (unsigned wide = 0; wide < 2; wide++) {
        const file f = file_of(wide ? "start S\nrule S -> repeat x 2730 { insert(box) } repeat x 4 { size(1, 1, 0) insert(box) }\n"
                                    : "start S\nrule S -> repeat x 2730 { insert(box) } repeat x 3 { size(1, 1, 0) insert(box) }\n",
                               1, 3); /* 24 vertices each, and 4 of what is flat: 65532 and 65536 */
        const char *json = (const char *)f.bytes + 20;
        ck_assert(gltf_check(f.bytes, f.n, NULL) == NULL);
        ck_assert((strstr(json, "\"componentType\":5125") != NULL) == (wide == 1));
        ck_assert((strstr(json, "\"componentType\":5123") != NULL) == (wide == 0));
        free(f.bytes);
    }
}
END_TEST

/* ---- what the file says ---- */

static json_t *json_of(const file *f)
{
    json_error_t error;
    json_t *root = json_loadb((const char *)f->bytes + 20, f->bytes[12] | (size_t)f->bytes[13] << 8, 0, &error);
    ck_assert_ptr_nonnull(root);
    return root;
}

START_TEST(a_quad_is_written_to_the_letter)
{
    const file f = file_of(quad, 1, 3);
    const char want[] =
        "{\"asset\":{\"generator\":\"shapegram\",\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"name\":\"named\",\"mesh\":0}],\"meshes\":[{\"name\":\"named\",\"primitives\":[{\"attributes\":"
        "{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2},\"indices\":3,\"material\":0}]}],\"materials\":[{\"name\":"
        "\"ff8000\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1.0,0.215861,0.0,1.0],\"metallicFactor\":0.0,"
        "\"roughnessFactor\":1.0},\"doubleSided\":true}],\"accessors\":[{\"bufferView\":0,\"byteOffset\":0,"
        "\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0.0,0.0,-2.0],\"max\":[0.0,1.0,0.0]},"
        "{\"bufferView\":1,\"byteOffset\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},{\"bufferView\":2,"
        "\"byteOffset\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},{\"bufferView\":3,\"byteOffset\":0,"
        "\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,"
        "\"byteLength\":48,\"byteStride\":12,\"target\":34962},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":48,"
        "\"byteStride\":12,\"target\":34962},{\"buffer\":0,\"byteOffset\":96,\"byteLength\":32,\"byteStride\":8,"
        "\"target\":34962},{\"buffer\":0,\"byteOffset\":128,\"byteLength\":12,\"target\":34963}],\"buffers\":[{"
        "\"byteLength\":140}]}";
    const size_t n = sizeof want - 1;
    ck_assert(f.n == 20 + (n + 3) / 4 * 4 + 8 + 140);
    ck_assert_msg(memcmp(f.bytes + 20, want, n) == 0, "%.*s", (int)(f.n - 20), f.bytes + 20);
    const unsigned char *bin = f.bytes + f.n - 140;
    static const float places[12] = {0, 0, 0, 0, 0, -2, 0, 1, -2, 0, 1, 0}, uvs[8] = {0, 1, 2, 1, 2, 0, 0, 0};
    static const unsigned char indices[12] = {0, 0, 1, 0, 2, 0, 0, 0, 2, 0, 3, 0};
    ck_assert(memcmp(bin, places, 48) == 0 && memcmp(bin + 96, uvs, 32) == 0 && memcmp(bin + 128, indices, 12) == 0);
    free(f.bytes);
}
END_TEST

/* One mesh a name, one primitive a material in it; names are those of the grammar. */
START_TEST(names_and_materials_are_those_of_the_scene)
{
    sg_error err = SG_ERROR_INIT;
    test_scene s = test_scene_of(house);
    sg_mesh m = {0};
    const sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    ck_ok(sg_mesh_from_scene(&s.scene, &opts, &m, &err));
    const file f = written(&m);
    gltf_counts counts = {0};
    ck_assert(gltf_check(f.bytes, f.n, &counts) == NULL);
    ck_assert(counts.meshes == 2 && counts.primitives == 4 && counts.materials == 4);
    json_t *root = json_of(&f), *meshes = json_object_get(root, "meshes"), *materials = json_object_get(root, "materials");
    static const char *const names[] = {"wall", "dach ü"}, *const colors[] = {"ffffff", "brick", "000000", "ff8000"};
    for (size_t i = 0; i < 2; i++)
        ck_assert_str_eq(json_string_value(json_object_get(json_array_get(meshes, i), "name")), names[i]);
    for (size_t i = 0; i < 4; i++)
        ck_assert_str_eq(json_string_value(json_object_get(json_array_get(materials, i), "name")), colors[i]);
    json_decref(root);
    free(f.bytes);
    sg_mesh_clear(&m);
    test_close_scene(&s);
}
END_TEST

START_TEST(a_scene_may_be_empty)
{
    gltf_counts counts = {0};
    const file f = file_of("start S\nrule S -> nothing\n", 1, 3);
    ck_assert(gltf_check(f.bytes, f.n, &counts) == NULL);
    ck_assert(counts.nodes == 0 && counts.vertices == 0);
    free(f.bytes);
}
END_TEST

START_TEST(the_same_mesh_gives_the_same_bytes)
{
    const file a = file_of(plant, 3, 7), b = file_of(plant, 3, 7);
    ck_assert(a.n == b.n && memcmp(a.bytes, b.bytes, a.n) == 0);
    free(a.bytes);
    free(b.bytes);
}
END_TEST

/* ---- broken files ---- */

static void put_u32(unsigned char *p, size_t x)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(x >> 8 * i);
}

/* The file with the first `from` in its JSON replaced, and lengths that fit. */
static file with_json(const file *f, const char *from, const char *to)
{
    const size_t length = f->bytes[12] | (size_t)f->bytes[13] << 8, rest = f->n - 20 - length;
    char json[4000], *at;
    memcpy(json, f->bytes + 20, length);
    json[length] = '\0';
    ck_assert_msg((at = strstr(json, from)) != NULL, "no %s", from);
    char after[4000];
    strcpy(after, at + strlen(from));
    strcpy(at, to);
    strcat(json, after);
    size_t n = strlen(json);
    while (json[n - 1] == ' ')
        n--;
    while (n % 4 != 0)
        json[n++] = ' ';
    file out = {malloc(20 + n + rest), 20 + n + rest};
    memcpy(out.bytes, f->bytes, 20);
    memcpy(out.bytes + 20, json, n);
    memcpy(out.bytes + 20 + n, f->bytes + 20 + length, rest);
    put_u32(out.bytes + 8, out.n);
    put_u32(out.bytes + 12, n);
    return out;
}

static void check_broken(const file *f, const char *want)
{
    const char *rule = gltf_check(f->bytes, f->n, NULL);
    ck_assert_msg(rule != NULL && strcmp(rule, want) == 0, "%s, not %s", rule != NULL ? rule : "all well", want);
}

static const struct {
    const char *from, *to, *rule;
} faults[] = {
    {"\"version\":\"2.0\"", "\"version\":\"1.0\"", "asset version"},
    {"\"shapegram\"", "\"other\"", "generator"},
    {"{\"asset\"", "{\"asset\":1,\"asset\"", "JSON"},
    {"{\"asset\"", " {\"asset\"", "JSON begins with a brace"},
    {"\"byteLength\":140}]}", "\"byteLength\":140}]}\n", "JSON is padded with spaces"},
    {"\"nodes\":[0]", "\"nodes\":[]", "a list is not empty"},
    {"\"nodes\":[0]", "\"nodes\":[1]", "a node that is there"},
    {"\"scenes\":[", "\"scenes\":[{},", "one scene"},
    {"\"nodes\":[0]", "\"extras\":[0]", "all is used"},
    {"\"name\":\"named\",\"mesh\":0", "\"mesh\":0", "nodes have names"},
    {"\"mesh\":0", "\"mesh\":1", "a mesh that is there"},
    {"\"meshes\":[{\"name\":\"named\"", "\"meshes\":[{\"name\":\"\"", "meshes have names"},
    {"\"POSITION\":0", "\"POSITION\":4", "an accessor that is there"},
    {"\"POSITION\":0", "\"POSITION\":-1", "an accessor that is there"},
    {"\"NORMAL\":1", "\"TANGENT\":1", "an attribute is missing"},
    {"\"NORMAL\":1", "\"NORMAL\":2", "type of an attribute"},
    {"\"indices\":3,\"material\":0", "\"indices\":3,\"material\":1", "a material that is there"},
    {"\"indices\":3", "\"mode\":5,\"indices\":3", "triangles"},
    {"\"indices\":3", "\"indices\":2", "target of a buffer view"},
    {"\"name\":\"ff8000\",", "", "materials have names"},
    {"[1.0,0.215861,0.0,1.0]", "[1.0,0.215861,0.0]", "a base colour of four numbers"},
    {"0.215861", "1.215861", "a base colour from 0 to 1"},
    {"\"roughnessFactor\":1.0", "\"roughnessFactor\":2.0", "factors from 0 to 1"},
    {"\"materials\":[", "\"materials\":[{\"name\":\"x\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1],"
                        "\"metallicFactor\":0,\"roughnessFactor\":1}},",
     "all is used"},
    {"\"bufferView\":3", "\"bufferView\":4", "a buffer view that is there"},
    {"\"byteOffset\":0,\"componentType\":5126", "\"byteOffset\":2,\"componentType\":5126", "alignment of an accessor"},
    {"\"byteOffset\":0,\"componentType\":5126", "\"byteOffset\":4,\"componentType\":5126", "an accessor stays in its view"},
    {"\"count\":6", "\"count\":9", "an accessor stays in its view"},
    {"\"count\":6", "\"count\":5", "whole triangles"},
    {"\"count\":6", "\"count\":3", "all vertices are used"},
    {"\"count\":6", "\"count\":0", "count of an accessor"},
    {"\"count\":4", "\"count\":3", "attributes of one length"},
    {"\"count\":4", "\"count\":1", "min and max are those of the data"},
    {"\"count\":4,\"type\":\"VEC3\"}", "\"count\":3,\"type\":\"VEC3\"}", "attributes of one length"},
    {"\"type\":\"VEC2\"", "\"type\":\"VEC9\"", "type of an accessor"},
    {"5123", "5122", "type of indices"},
    {"5123", "5124", "type of an accessor"},
    {"\"min\":[0.0,0.0,-2.0],", "", "positions have a min and max"},
    {"\"min\":[0.0,0.0,-2.0]", "\"min\":[0.0,0.0,-1.5]", "min and max are those of the data"},
    {"\"max\":[0.0,1.0,0.0]", "\"max\":[0.0,1.0,0.0000001]", "min and max are those of the data"},
    {"\"max\":[0.0,1.0,0.0]", "\"max\":[0.0,1.0]", "size of min and max"},
    {"\"byteStride\":12", "\"byteStride\":13", "stride of a buffer view"},
    {"\"byteStride\":8", "\"byteStride\":4", "an accessor stays in its view"},
    {"\"byteLength\":12,", "\"byteLength\":12,\"byteStride\":4,", "indices have no stride"},
    {"\"target\":34963", "\"target\":34962", "target of a buffer view"},
    {"\"byteOffset\":128,\"byteLength\":12", "\"byteOffset\":129,\"byteLength\":11", "alignment of an accessor"},
    {"\"byteOffset\":128,\"byteLength\":12", "\"byteOffset\":128,\"byteLength\":16", "a buffer view stays in the buffer"},
    {"\"byteOffset\":128,\"byteLength\":12", "\"byteOffset\":-4,\"byteLength\":12", "a buffer view's place"},
    {"\"buffer\":0", "\"buffer\":1", "a buffer that is there"},
    {"[{\"byteLength\":140}]", "[{\"byteLength\":144}]", "length of the buffer"},
    {"[{\"byteLength\":140}]", "[{\"byteLength\":136}]", "length of the buffer"},
    {"[{\"byteLength\":140}]", "[{\"byteLength\":140,\"uri\":\"x\"}]", "the buffer is the binary chunk"},
};

START_TEST(broken_json_is_found)
{
    const file f = file_of(quad, 1, 3);
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        const file broken = with_json(&f, faults[i].from, faults[i].to);
        check_broken(&broken, faults[i].rule);
        free(broken.bytes);
    }
    free(f.bytes);
}
END_TEST

/* Bytes from the beginning, or where negative from the end, that are replaced by one value. */
static const struct {
    long at;
    unsigned char value;
    const char *rule;
} wrong_bytes[] = {
    {0, 'G', "magic"},
    {4, 1, "container version"},
    {8, 1, "length of the file"},
    {12, 3, "length of the JSON chunk"},
    {15, 255, "length of the JSON chunk"},
    {16, 'j', "the first chunk is JSON"},
    {-148, 4, "length of the binary chunk"},
    {-144, 'X', "the second chunk is binary"},
    {-12, 4, "indices in range"},
    {-137, 0x7f, "min and max are those of the data"}, /* a large coordinate */
    {-92 + 3, 0x40, "normals of length 1"},
};

START_TEST(broken_bytes_are_found)
{
    const file f = file_of(quad, 1, 3);
    ck_assert(gltf_check(f.bytes, f.n, NULL) == NULL);
    for (size_t i = 0; i < sizeof wrong_bytes / sizeof *wrong_bytes; i++) {
        unsigned char *p = f.bytes + (wrong_bytes[i].at < 0 ? (long)f.n : 0) + wrong_bytes[i].at;
        const unsigned char before = *p;
        *p = wrong_bytes[i].value;
        check_broken(&f, wrong_bytes[i].rule);
        *p = before;
    }
    const file padded = with_json(&f, "[{\"byteLength\":140}]", "[{\"byteLength\":138}]");
    check_broken(&padded, "the binary chunk is padded with zeros"); /* there the last index stands */
    free(padded.bytes);
    f.bytes[f.n - 12] = f.bytes[f.n - 11] = 255;
    check_broken(&f, "no index restarts a primitive");
    f.bytes[f.n - 12] = f.bytes[f.n - 11] = 0;
    memset(f.bytes + f.n - 139, 255, 3); /* the first coordinate is NaN */
    check_broken(&f, "finite numbers");
    for (size_t n = 0; n < f.n; n++) /* cut off anywhere */
        ck_assert(gltf_check(f.bytes, n, NULL) != NULL);
    free(f.bytes);
}
END_TEST

/* ---- failures ---- */

START_TEST(places_beyond_glTF_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    sg_mesh m = mesh_of("start S\nrule S -> translate(1e39, 0, 0) size(1e38, 1e38, 1e38) insert(box)\n", 1, 3);
    FILE *out = fopen("/dev/null", "w");
    ck_assert_int_eq(sg_mesh_gltf_write(&m, out, &err), SG_ENUMERIC);
    fclose(out);
    sg_mesh_clear(&m);
}
END_TEST

START_TEST(a_file_appears_whole_or_not_at_all)
{
    sg_error err = SG_ERROR_INIT;
    sg_mesh m = mesh_of(house, 1, 7), far = mesh_of("start S\nrule S -> size(1e39, 1e39, 1e39) insert(box)\n", 1, 3);
    const temp_folder t = temp_folder_make();
    const file f = written(&m);
    size_t n;
    ck_ok(sg_mesh_gltf_save(&m, temp_path(&t, "x.glb"), &err));
    ck_assert_int_eq(sg_mesh_gltf_save(&far, temp_path(&t, "x.glb"), &err), SG_ENUMERIC);
    unsigned char *bytes = temp_read(&t, "x.glb", &n);
    ck_assert(n == f.n && memcmp(bytes, f.bytes, n) == 0);
    ck_assert_int_eq(sg_mesh_gltf_save(&m, temp_path(&t, "none/x.glb"), &err), SG_EIO);
    FILE *full = fopen("/dev/full", "w");
    setvbuf(full, NULL, _IONBF, 0);
    ck_assert_int_eq(sg_mesh_gltf_write(&m, full, &err), SG_EIO);
    fclose(full);
    free(bytes);
    free(f.bytes);
    temp_folder_remove(&t);
    sg_mesh_clear(&m);
    sg_mesh_clear(&far);
}
END_TEST

START_TEST(each_allocation_may_fail)
{
    sg_mesh m = mesh_of(house, 1, 7);
    FILE *out = fopen("/dev/null", "w");
    size_t failures = 0;
    for (bool failed = true; failed; failures += failed) {
        sg_error err = SG_ERROR_INIT;
        test_fail_allocation(failures);
        const sg_status st = sg_mesh_gltf_write(&m, out, &err);
        failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
    }
    ck_assert_uint_gt(failures, 10);
    fclose(out);
    sg_mesh_clear(&m);
}
END_TEST

static Suite *gltf_suite(void)
{
    Suite *s = suite_create("gltf");
    TCase *rules = tcase_create("rules"), *broken = tcase_create("broken");
    tcase_add_test(rules, files_keep_the_rules);
    tcase_add_loop_test(rules, random_scenes_keep_the_rules, 0, 10);
    tcase_add_test(rules, indices_are_as_wide_as_they_must_be);
    tcase_add_test(rules, a_quad_is_written_to_the_letter);
    tcase_add_test(rules, names_and_materials_are_those_of_the_scene);
    tcase_add_test(rules, a_scene_may_be_empty);
    tcase_add_test(rules, the_same_mesh_gives_the_same_bytes);
    tcase_add_test(broken, broken_json_is_found);
    tcase_add_test(broken, broken_bytes_are_found);
    tcase_add_test(broken, places_beyond_glTF_are_refused);
    tcase_add_test(broken, a_file_appears_whole_or_not_at_all);
    tcase_add_test(broken, each_allocation_may_fail);
    suite_add_tcase(s, rules);
    suite_add_tcase(s, broken);
    return s;
}

int main(void)
{
    return test_run(gltf_suite());
}
