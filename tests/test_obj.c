/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_obj.c - mesh files: what is read, what is refused and where, polygons as triangles, and meshes that grammars
 * insert. */
#include "config.h"

#include "scene/assets.h"
#include "scene/mesh_obj.h"
#include "scene/triangulate.h"
#include "tests/failing_malloc.h"
#include "tests/mesh_check.h"
#include "tests/scene_support.h"
#include "tests/temp_folder.h"

static sg_obj parsed(const char *text)
{
    sg_error err = SG_ERROR_INIT;
    sg_obj obj;
    ck_ok(sg_obj_parse(text, strlen(text), "x.obj", &obj, &err));
    return obj;
}

/* ---- statements ---- */

static const char tent[] = "# a tent\r\nmtllib x.mtl\r\no tent\ng a b\ns off\n"
                           "v 0 0 0\nv +4.0 0 0 1.0\nv 4 0 6 0.1 0.2 0.3\nv 0 0 6\n\tv 2 3. -0e0\nv 2 \\\n .3e1 \\\r\n 6\n"
                           "vt 0 0\nvt 1\nvt .5 1 0\nvn 0 -2 0\nvn 0 0 0\n"
                           "f 1 2 3 4 # floor\nusemtl red cloth\nf -6/1 -2/3 2/2\nf 3//1 6//1 4//2\n"
                           "usemtl blue\nf 2/1/1 5/2/1 6/3/1 3/1/1\nusemtl red cloth\nf 1 4 6 5\nl 1 2\np 1\n";

START_TEST(statements_are_read)
{
    sg_obj obj = parsed(tent);
    ck_assert(obj.nvertices == 6 && obj.nuvs == 3 && obj.nnormals == 2 && obj.nfaces == 5 && obj.nmaterials == 2);
    ck_assert(obj.vertices[5][0] == 2 && obj.vertices[5][1] == 3 && obj.vertices[5][2] == 6);
    ck_assert(obj.uvs[1][0] == 1 && obj.uvs[1][1] == 0 && obj.uvs[2][0] == 0.5);
    ck_assert(obj.normals[0][1] == -1 && sg_vec_length(obj.normals[1]) == 0);
    const sg_mesh_face *f = obj.faces;
    ck_assert(f[0].ncorners == 4 && f[0].corner[3].vertex == 3 && f[0].corner[0].uv == SG_NONE && f[0].group == SG_NONE);
    ck_assert(f[1].ncorners == 3 && f[1].corner[0].vertex == 0 && f[1].corner[1].vertex == 4 && f[1].corner[1].uv == 2);
    ck_assert(f[2].corner[2].normal == 1 && f[2].corner[2].uv == SG_NONE && f[2].group == 0);
    ck_assert(f[3].corner[2].normal == 0 && f[3].corner[2].uv == 2 && f[3].group == 1 && f[4].group == 0);
    ck_assert_str_eq(obj.materials[0].name, "red cloth");
    ck_assert(obj.nlibraries == 1 && strcmp(obj.libraries[0].name, "x.mtl") == 0 && obj.materials[0].color == SG_NONE);
    ck_assert(obj.low[1] == 0 && obj.high[0] == 4 && obj.high[1] == 3 && obj.high[2] == 6);
    sg_obj_clear(&obj);
    obj = parsed("");
    ck_assert(obj.nfaces == 0 && obj.high[0] == 0);
    sg_obj_clear(&obj);
}
END_TEST

START_TEST(colours_are_read)
{
    sg_error err = SG_ERROR_INIT;
    sg_obj obj = parsed(tent);
    static const char library[] = "Kd 1 1 1\nnewmtl blue\nNs 10\nKd 0 0.502 1\nillum 2\nmap_Kd x.png\n\nnewmtl other\n"
                                  "Kd 0.5\nnewmtl red cloth\nKd spectral x.rfl\nKd 2 -1 0.4\n";
    ck_ok(sg_obj_parse_materials(library, strlen(library), "x.mtl", &obj, &err));
    ck_assert_uint_eq(obj.materials[0].color, 0xff0066);
    ck_assert_uint_eq(obj.materials[1].color, 0x0080ff);
    ck_assert_uint_eq(obj.nmaterials, 2);
    static const char bad[] = "newmtl blue\nKd 0 x 1\n";
    ck_assert_int_eq(sg_obj_parse_materials(bad, strlen(bad), "y.mtl", &obj, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, "y.mtl:2:6: error: found 'x'") == err.msg, "%s", err.msg);
    sg_obj_clear(&obj);
}
END_TEST

static const struct {
    const char *text, *sentence;
} faults[] = {
    {"v 0 0\n", "x.obj:1:6: error: found the end of the line; expected a number"},
    {"v 0 0 a\n", "x.obj:1:7: error: found 'a'"},
    {"v 0 0 0x10\n", "x.obj:1:7: error: found '0x10'"},
    {"v 0 0 nan\n", "x.obj:1:7: error: found 'nan'"},
    {"v 0 0 1e\n", "x.obj:1:7: error: found '1e'"},
    {"v 0 0 1e31\n", "x.obj:1:7: error: a number over"},
    {"v 0 0 1e999\n", "x.obj:1:7: error: a number over"},
    {"v 0 0 0 0 0 0 0 0\n", "x.obj:1:17: error: too many numbers"},
    {"vn 0 0 0 1\n", "x.obj:1:10: error: too many"},
    {"vt\n", "x.obj:1:3: error: found the end"},
    {"v 0 0 0\n\nf 1 1\n", "x.obj:3:6: error: a face of 2 corners"},
    {"v 0 0 0\nf 1 2 1\n", "x.obj:2:5: error: there is 1 vertex so far, and no number 2"},
    {"v 0 0 0\nf 1 0 1\n", "x.obj:2:5: error: there is 1 vertex so far, and no number 0"},
    {"v 0 0 0\nf 1 -2 1\n", "x.obj:2:5: error: there is 1 vertex so far, and no number -2"},
    {"v 0 0 0\nf 1 99999999999999999999999 1\n", "x.obj:2:5: error: there is 1 vertex so far"},
    {"f 1 2 3\n", "x.obj:1:3: error: there are 0 vertices so far, and no number 1"},
    {"v 0 0 0\nf 1/1 1 1\n", "x.obj:2:5: error: there are 0 texture coordinates so far"},
    {"v 0 0 0\nf 1//1 1 1\n", "x.obj:2:6: error: there are 0 normals"},
    {"v 0 0 0\nf 1/ 1 1\n", "x.obj:2:5: error: expected the number of a texture coordinate"},
    {"v 0 0 0\nf 1// 1 1\n", "x.obj:2:6: error: expected the number of a normal"},
    {"v 0 0 0\nf 1.5 1 1\n", "x.obj:2:4: error: expected a blank"},
    {"v 0 0 0\nf x 1 1\n", "x.obj:2:3: error: expected the number of a vertex"},
    {"usemtl\n", "x.obj:1:7: error: found the end of the line; expected a name"},
    {"usemtl a\xff\n", "x.obj:1:8: error: a name that is no UTF-8"},
    {"# x\ncurv 0 1\n", "x.obj:2:1: error: found 'curv'"},
};

START_TEST(faults_are_told_with_their_places)
{
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        sg_error err = SG_ERROR_INIT;
        sg_obj obj;
        ck_assert_int_eq(sg_obj_parse(faults[i].text, strlen(faults[i].text), "x.obj", &obj, &err), SG_EINPUT);
        ck_assert_msg(strstr(err.msg, faults[i].sentence) == err.msg, "%s", err.msg);
        ck_assert(obj.nfaces == 0 && obj.vertices == NULL);
    }
    sg_error err = SG_ERROR_INIT;
    sg_obj obj;
    ck_assert_int_eq(sg_obj_parse("v 0 0 0\n\0", 9, "x.obj", &obj, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, "x.obj:2:1: error: a byte 0") == err.msg, "%s", err.msg);
    char *long_face = malloc(3 * 300 + 20);
    strcpy(long_face, "v 0 0 0\nf");
    for (int i = 0; i < 257; i++)
        strcat(long_face, " 1");
    ck_assert_int_eq(sg_obj_parse(long_face, strlen(long_face), "x.obj", &obj, &err), SG_EINPUT);
    ck_assert(strstr(err.msg, "more than 256 corners") != NULL);
    free(long_face);
    char *many = malloc(4097 * 16 + 1), *end = many;
    for (int i = 0; i < 4097; i++)
        end += sprintf(end, "usemtl %d\n", i);
    ck_assert_int_eq(sg_obj_parse(many, strlen(many), "x.obj", &obj, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, "x.obj:4097:8: error: more than 4096 materials") == err.msg, "%s", err.msg);
    free(many);
}
END_TEST

/* ---- polygons ---- */

static double polygon_area(const double (*p)[2], size_t n)
{
    double sum = 0;
    for (size_t i = 1; i + 1 < n; i++)
        sum += sg_triangle_area(p[0], p[i], p[i + 1]) / 2;
    return sum;
}

/* Triangles that are all counterclockwise and have the polygon's area together cannot overlap. */
static void check_cut(const double (*p)[2], size_t n)
{
    uint32_t triangles[64][3], left[64];
    double sum = 0;
    ck_assert(sg_triangulate(p, n, triangles, left));
    for (size_t i = 0; i + 2 < n; i++) {
        const double area = sg_triangle_area(p[triangles[i][0]], p[triangles[i][1]], p[triangles[i][2]]) / 2;
        ck_assert_double_gt(area, 0);
        sum += area;
    }
    ck_assert_double_eq_tol(sum, polygon_area(p, n), 1e-12 * fmax(1, sum));
}

START_TEST(polygons_are_cut_into_ears)
{
    static const double l[6][2] = {{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 5}, {0, 5}};
    static const double in_line[5][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}};
    static const double comb[8][2] = {{0, 0}, {6, 0}, {6, 3}, {4, 1}, {3, 3}, {2, 1}, {1, 3}, {0, 1}};
    check_cut(l, 6);
    check_cut(in_line, 5);
    check_cut(comb, 8);
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    for (int k = 0; k < 50; k++) { /* stars about the origin */
        double p[40][2];
        const size_t n = 4 + gsl_rng_uniform_int(rng, 37);
        for (size_t i = 0; i < n; i++) {
            const double r = 0.1 + gsl_rng_uniform(rng), t = 6.283185307179586 * (double)i / (double)n;
            p[i][0] = r * cos(t);
            p[i][1] = r * sin(t);
        }
        check_cut((const double(*)[2])p, n);
    }
    gsl_rng_free(rng);
    uint32_t triangles[4][3], left[4];
    static const double crossed[4][2] = {{0, 0}, {2, 2}, {2, 0}, {0, 2.5}};
    static const double point[4][2] = {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
    ck_assert(!sg_triangulate(point, 4, triangles, left));
    sg_triangulate(crossed, 4, triangles, left); /* nothing is promised but that it ends */
}
END_TEST

START_TEST(polygons_of_files_become_triangles_and_quadrilaterals)
{
    static const char head[] = "v 0 0 1\nv 4 0 1\nv 4 2 1\nv 2 2 1\nv 2 5 1\nv 0 5 1\n";
    static const struct {
        const char *face;
        size_t n;
        uint32_t ncorners;
    } cases[] = {{"f 1 2 3 4 5 6\n", 4, 3}, {"f 6 5 4 3 2 1\n", 4, 3}, {"f 1 2 3 6\n", 1, 4}, {"f 1 2 4 5\n", 2, 3},
                 {"f 1 2 2 3\n", 1, 3},     {"f 1 1 2\n", 0, 0},       {"f 1 2 1\n", 0, 0},   {"f 1 2 3 1\n", 1, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[200];
        snprintf(text, sizeof text, "%s%s", head, cases[i].face);
        sg_obj obj = parsed(text);
        ck_assert_uint_eq(obj.nfaces, cases[i].n);
        for (size_t k = 0; k < obj.nfaces; k++)
            ck_assert_uint_eq(obj.faces[k].ncorners, cases[i].ncorners);
        sg_obj_clear(&obj);
    }
}
END_TEST

/* ---- meshes in scenes ---- */

static const char pyramid[] = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 3 0\nusemtl sand\nf 1 2 3 4\nf 2 1 5\n"
                              "usemtl stone\nf 3 2 5\nf 4 3 5\nusemtl plain\nf 1 4 5\n";

typedef struct {
    temp_folder t;
    test_scene scene;
    sg_assets *assets;
    sg_mesh mesh;
} fixture;

static fixture open_fixture(const char *text, const char *file, const char *mesh)
{
    sg_error err = SG_ERROR_INIT;
    fixture f = {.t = temp_folder_make()};
    sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    temp_text(&f.t, file, mesh);
    temp_text(&f.t, "x.mtl", "newmtl sand\nKd 1 0.5 0\nnewmtl stone\nKd 0.2 0.2 0.2\n");
    f.scene = test_scene_of(text);
    ck_ok(sg_assets_load(f.scene.g, temp_path(&f.t, "g.sg"), &f.assets, &err));
    opts.assets = f.assets;
    ck_ok(sg_mesh_from_scene(&f.scene.scene, &opts, &f.mesh, &err));
    return f;
}

static void close_fixture(fixture *f)
{
    sg_mesh_clear(&f->mesh);
    sg_assets_free(f->assets);
    test_close_scene(&f->scene);
    temp_folder_remove(&f->t);
}

START_TEST(meshes_fill_their_scopes)
{
    char text[500];
    snprintf(text, sizeof text, "mtllib x.mtl\n%s", pyramid);
    fixture f = open_fixture("label t #010203\nstart S\nrule S -> set_label(t) translate(5, 6, 7) size(2, 3, 4) "
                             "insert(\"p.obj\") translate(5, 0, 0) rotate(0, 30, 0) insert(\"p.obj\")\n",
                             "p.obj", text);
    const sg_mesh *m = &f.mesh;
    size_t nopen = 1;
    const char *wrong = mesh_check(m, &nopen);
    ck_assert_msg(wrong == NULL, "%s", wrong);
    ck_assert(nopen == 0 && m->nfaces == 10);
    ck_assert_double_eq_tol(mesh_volume(m), 2 * 2 * 3 * 4 / 3.0, 1e-9);
    ck_assert(m->ngroups == 3 && m->nmaterials == 3);
    static const uint32_t colors[] = {0xff8000, 0x333333, 0x010203}; /* the last one has none of its own */
    for (size_t k = 0; k < 3; k++) {
        ck_assert_str_eq(m->groups[k].name, "p.obj");
        ck_assert_uint_eq(m->materials[m->groups[k].material].color, colors[k]);
    }
    ck_assert_str_eq(m->materials[0].name, "sand");
    static const double tip[3] = {6, 9, 9};
    ck_assert(fabs(m->vertices[4][0] - tip[0]) < 1e-12 && fabs(m->vertices[4][1] - tip[1]) < 1e-12 &&
              fabs(m->vertices[4][2] - tip[2]) < 1e-12);
    close_fixture(&f);
}
END_TEST

/* A flat mesh stands in the middle; a solid does not fit into a flat scope. Normals of the file stay across the surface. */
START_TEST(flat_meshes_and_normals)
{
    fixture f = open_fixture("start S\nrule S -> size(2, 4, 6) insert(\"leaf.obj\") size(2, 4, 0) insert(\"leaf.obj\") "
                             "size(2, 0, 4) insert(\"leaf.obj\")\n",
                             "leaf.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 1 0 1\nvn 0 0 -1\nf 1//1 2//1 3//2 4\n");
    const sg_mesh *m = &f.mesh;
    ck_assert(m->nfaces == 2 && m->vertices[0][2] == 3 && m->vertices[4][2] == 0);
    const double *n = m->normals[m->faces[0].corner[0].normal];
    ck_assert_double_eq_tol(n[0] / n[2], 0.5, 1e-12); /* the scope is twice as wide */
    ck_assert(m->normals[m->faces[0].corner[2].normal][2] == 1 && m->normals[m->faces[0].corner[3].normal][2] == 1);
    ck_assert(mesh_check(m, NULL) == NULL);
    ck_assert(m->uvs[m->faces[0].corner[2].uv][0] == 2 && m->uvs[m->faces[0].corner[2].uv][1] == 4);
    close_fixture(&f);
}
END_TEST

/* What we write is read back, and fills its own box as before. */
START_TEST(our_files_are_read_back)
{
    sg_error err = SG_ERROR_INIT;
    test_scene s = test_scene_of("start S\nrule S -> insert(sphere) set_material(#ff0000) size(2, 3, 4) hip_roof(30)\n");
    sg_mesh m = {0};
    const sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    const temp_folder t = temp_folder_make();
    sg_obj obj;
    ck_ok(sg_mesh_from_scene(&s.scene, &opts, &m, &err));
    ck_ok(sg_mesh_obj_save(&m, temp_path(&t, "x.obj"), &err));
    ck_ok(sg_obj_load(temp_path(&t, "x.obj"), &obj, &err));
    ck_assert(obj.nvertices == m.nvertices && obj.nnormals == m.nnormals && obj.nuvs == m.nuvs && obj.nfaces == m.nfaces);
    ck_assert(obj.nmaterials == 2 && obj.materials[0].color == 0xc8c8c8 && obj.materials[1].color == 0xff0000);
    for (size_t i = 0; i < m.nfaces; i++)
        for (uint32_t k = 0; k < m.faces[i].ncorners; k++)
            test_must(memcmp(m.faces[i].corner + k, obj.faces[i].corner + k, sizeof m.faces[i].corner[k]) == 0);
    for (size_t i = 0; i < m.nvertices; i++)
        for (int k = 0; k < 3; k++)
            test_must(fabs(m.vertices[i][k] - obj.vertices[i][k]) < 1e-6);
    sg_obj_clear(&obj);
    sg_mesh_clear(&m);
    temp_folder_remove(&t);
    test_close_scene(&s);
}
END_TEST

/* ---- files that are missing or bad ---- */

static void check_assets(const temp_folder *t, const char *text, sg_status want, const char *sentence)
{
    sg_error err = SG_ERROR_INIT;
    sg_grammar *g = test_grammar(text);
    sg_assets *a = NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s/g.sg", t->path);
    ck_assert_int_eq(sg_assets_load(g, path, &a, &err), want);
    ck_assert_msg(want == SG_OK || (strstr(err.msg, sentence) != NULL && strstr(err.msg, t->path) == err.msg), "%s", err.msg);
    sg_assets_free(a);
    sg_grammar_free(g);
}

START_TEST(missing_and_bad_files_are_told)
{
    const temp_folder t = temp_folder_make();
    temp_text(&t, "bad.obj", "v 0 0 0\nf 1 2 3\n");
    temp_text(&t, "none.obj", "v 0 0 0\n");
    temp_text(&t, "lib.obj", "v 0 0 0\nmtllib no.mtl\nf 1 1 1\n");
    check_assets(&t, "start S\nrule S -> insert(box) insert(sphere) insert(cone) insert(cylinder)\n", SG_OK, NULL);
    check_assets(&t, "start S\nrule S -> insert(box)\n  insert(\"no.obj\")\n", SG_EINPUT,
                 "/g.sg:2: error: insert(no.obj): there is no mesh file ");
    check_assets(&t, "start S\nrule S -> insert(\"bad.obj\")\n", SG_EINPUT, "/bad.obj:2:5: error: there is 1 vertex so far");
    check_assets(&t, "start S\nrule S -> insert(\"none.obj\")\n", SG_EINPUT, "/none.obj: this mesh has no faces");
    check_assets(&t, "start S\nrule S -> insert(\"lib.obj\")\n", SG_EINPUT, "/lib.obj:2:8: error: there is no material library ");
    temp_folder_remove(&t);
}
END_TEST

/* What an imported grammar inserts stands beside it; a fault is told where it stands. */
START_TEST(imported_grammars_have_meshes_of_their_own)
{
    sg_error err = SG_ERROR_INIT;
    const temp_folder t = temp_folder_make();
    sg_grammar *g = NULL;
    sg_assets *a = NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s/g.sg", t.path);
    ck_assert_int_eq(mkdir(temp_path(&t, "sub"), 0777), 0);
    temp_text(&t, "g.sg", "label t\nimport Tree \"sub/tree.sg\"\nstart S\nrule S -> Tree\n");
    temp_text(&t, "sub/tree.sg", "start T\n\nrule T -> insert(\"leaf.obj\")\n");
    ck_ok(sg_grammar_load(path, &g, &err));
    ck_assert_int_eq(sg_assets_load(g, path, &a, &err), SG_EINPUT);
    ck_assert_msg(strstr(err.msg, "/sub/tree.sg:3: error: insert(sub/leaf.obj): there is no mesh file ") != NULL, "%s", err.msg);
    temp_text(&t, "sub/leaf.obj", pyramid);
    ck_ok(sg_assets_load(g, path, &a, &err));
    sg_assets_free(a);
    sg_grammar_free(g);
    temp_folder_remove(&t);
}
END_TEST

START_TEST(files_that_are_read_are_known)
{
    char text[500];
    snprintf(text, sizeof text, "mtllib x.mtl\n%s", pyramid);
    fixture f = open_fixture("start S\nrule S -> insert(\"./p.obj\")\n", "p.obj", text);
    ck_assert(sg_assets_has_file(f.assets, temp_path(&f.t, "p.obj")) && sg_assets_has_file(f.assets, temp_path(&f.t, "x.mtl")));
    temp_text(&f.t, "other.obj", pyramid);
    ck_assert(!sg_assets_has_file(f.assets, temp_path(&f.t, "other.obj")));
    close_fixture(&f);
}
END_TEST

START_TEST(each_allocation_may_fail)
{
    const temp_folder t = temp_folder_make();
    char text[500], path[1024];
    snprintf(text, sizeof text, "mtllib x.mtl\nvn 0 1 0\nvt 1 1\n%s", pyramid);
    temp_text(&t, "p.obj", text);
    temp_text(&t, "x.mtl", "newmtl sand\nKd 1 1 1\n");
    snprintf(path, sizeof path, "%s/g.sg", t.path);
    test_scene f = test_scene_of("start S\nrule S -> insert(\"p.obj\")\n");
    size_t failures = 0;
    for (bool failed = true; failed; failures += failed) {
        sg_error err = SG_ERROR_INIT;
        sg_assets *a = NULL;
        sg_mesh m = {0};
        sg_mesh_opts opts = SG_MESH_OPTS_INIT;
        test_fail_allocation(failures);
        sg_status st = sg_assets_load(f.g, path, &a, &err);
        opts.assets = a;
        if (st == SG_OK)
            st = sg_mesh_from_scene(&f.scene, &opts, &m, &err);
        failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        sg_mesh_clear(&m);
        sg_assets_free(a);
    }
    ck_assert_uint_gt(failures, 15);
    test_close_scene(&f);
    temp_folder_remove(&t);
}
END_TEST

static Suite *obj_suite(void)
{
    Suite *s = suite_create("obj");
    TCase *all = tcase_create("all");
    tcase_add_test(all, statements_are_read);
    tcase_add_test(all, colours_are_read);
    tcase_add_test(all, faults_are_told_with_their_places);
    tcase_add_loop_test(all, polygons_are_cut_into_ears, 0, 5);
    tcase_add_test(all, polygons_of_files_become_triangles_and_quadrilaterals);
    tcase_add_test(all, meshes_fill_their_scopes);
    tcase_add_test(all, flat_meshes_and_normals);
    tcase_add_test(all, our_files_are_read_back);
    tcase_add_test(all, missing_and_bad_files_are_told);
    tcase_add_test(all, imported_grammars_have_meshes_of_their_own);
    tcase_add_test(all, files_that_are_read_are_known);
    tcase_add_test(all, each_allocation_may_fail);
    suite_add_tcase(s, all);
    return s;
}

int main(void)
{
    return test_run(obj_suite());
}
