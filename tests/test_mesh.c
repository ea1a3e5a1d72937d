/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_mesh.c - meshes of scenes: known shapes and volumes, closed surfaces, normals, levels of detail, OBJ files. */
#include "config.h"

#include "scene/mesh_obj.h"
#include "scene/mesh_priv.h"
#include "tests/failing_malloc.h"
#include "tests/mesh_check.h"
#include "tests/scene_support.h"
#include "tests/temp_folder.h"

static const double pi = 3.14159265358979323846;

static sg_mesh mesh_of(const sg_scene *scene, unsigned radial, unsigned detail)
{
    sg_error err = SG_ERROR_INIT;
    sg_mesh mesh = {0};
    const sg_mesh_opts opts = {radial, detail, NULL};
    ck_ok(sg_mesh_from_scene(scene, &opts, &mesh, &err));
    return mesh;
}

/* Faces that stand alone, of a mesh that keeps all rules. */
static size_t check_mesh(const sg_mesh *m)
{
    size_t nopen = 0;
    const char *wrong = mesh_check(m, &nopen);
    ck_assert_msg(wrong == NULL, "%s", wrong);
    return nopen;
}

/* ---- the rules find what breaks them ---- */

static void check_broken(sg_mesh *m, const char *want)
{
    const char *wrong = mesh_check(m, NULL);
    ck_assert_msg(wrong != NULL && strcmp(wrong, want) == 0, "%s, not %s", wrong != NULL ? wrong : "all well", want);
    sg_mesh_clear(m);
}

static sg_mesh box_mesh(void)
{
    test_scene f = test_scene_of("start S\nrule S -> insert(box)\n");
    sg_mesh m = mesh_of(&f.scene, 8, 0);
    test_close_scene(&f);
    ck_assert_uint_eq(check_mesh(&m), 0);
    return m;
}

START_TEST(a_broken_mesh_is_found)
{
    sg_mesh m = box_mesh();
    m.vertices[3][1] = NAN;
    check_broken(&m, "a place that is not finite");
    m = box_mesh();
    m.uvs[3][1] = INFINITY;
    check_broken(&m, "a texture coordinate that is not finite");
    m = box_mesh();
    m.normals[3][1] += 0.01;
    check_broken(&m, "a normal that is not of length 1");
    m = box_mesh();
    m.faces[2].ncorners = 2;
    check_broken(&m, "a face that is neither triangle nor quadrilateral");
    m = box_mesh();
    m.faces[2].corner[1].uv = (uint32_t)m.nuvs;
    check_broken(&m, "an index that is too large");
    m = box_mesh();
    m.faces[2].corner[1].vertex = m.faces[2].corner[3].vertex;
    check_broken(&m, "a face with a vertex twice");
    m = box_mesh();
    for (int i = 0; i < 4; i++)
        memcpy(m.vertices[m.faces[2].corner[i].vertex], (double[]){i, 0, 0}, sizeof *m.vertices);
    check_broken(&m, "a face without area");
    m = box_mesh();
    for (int i = 0; i < 4; i++)
        m.faces[2].corner[i].normal = m.faces[1].corner[0].normal;
    check_broken(&m, "normals against the winding");
    m = box_mesh();
    m.faces[2].group = 1;
    check_broken(&m, "a face outside its group");
    m = box_mesh();
    m.groups[0].material = 1;
    check_broken(&m, "a group without a material");
    m = box_mesh();
    m.groups[0].n--;
    check_broken(&m, "faces without a group");
    m = box_mesh();
    m.groups[0].name = "";
    check_broken(&m, "a group's name that is no text");
    m = box_mesh();
    m.materials[0].name = "\xff";
    check_broken(&m, "a material's name that is no text");
    m = box_mesh();
    m.materials[0].color = 0x1000000;
    check_broken(&m, "a material whose colour is none");
    m = box_mesh();
    m.faces[2] = m.faces[3];
    check_broken(&m, "a face twice");
    m = box_mesh();
    const sg_mesh_corner swap = m.faces[2].corner[1]; /* looks inwards, and its normals with it */
    m.faces[2].corner[1] = m.faces[2].corner[3];
    m.faces[2].corner[3] = swap;
    for (int i = 0; i < 3; i++)
        m.normals[swap.normal][i] *= -1;
    check_broken(&m, "an edge twice in one direction");
    m = box_mesh();
    m.nfaces = m.groups[0].n = 5;
    check_broken(&m, "a surface with a hole");
    m = box_mesh();
    for (size_t i = 0; i < m.nvertices; i++)
        m.vertices[i][0] *= -1;
    for (size_t i = 0; i < m.nnormals; i++)
        for (int k = 1; k < 3; k++)
            m.normals[i][k] *= -1;
    check_broken(&m, "a closed surface that looks inwards");
}
END_TEST

/* ---- known shapes ---- */

static void check_shape(const char *body, unsigned radial, size_t vertices, size_t faces, size_t open, double want)
{
    char text[500];
    snprintf(text, sizeof text, "label t\nstart S\nrule S -> translate(3, -1, 2) rotate(10, 20, 30) %s\n", body);
    test_scene f = test_scene_of(text);
    sg_mesh m = mesh_of(&f.scene, radial, 0);
    ck_assert_uint_eq(m.nvertices, vertices);
    ck_assert_uint_eq(m.nfaces, faces);
    ck_assert_uint_eq(check_mesh(&m), open);
    if (open == 0)
        ck_assert_double_eq_tol(mesh_volume(&m), want, 1e-9);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}

START_TEST(shapes_have_their_volumes)
{
    const double octagon = 8 * sin(pi / 4) / 2; /* of radius 1 */
    check_shape("size(2, 3, 4) insert(box)", 8, 8, 6, 0, 24);
    check_shape("size(2, 3, 4) insert(\"tree.obj\")", 8, 8, 6, 0, 24);
    check_shape("size(2, 3, 4) insert(cylinder)", 8, 18, 24, 0, 3 * octagon * 1 * 2);
    check_shape("size(2, 3, 4) insert(cone)", 8, 10, 16, 0, octagon * 1 * 2);
    check_shape("size(4, 1, 6) gable_roof(45)", 8, 6, 5, 0, 4 * 2 / 2.0 * 6);
    check_shape("size(6, 1, 4) hip_roof(45)", 8, 6, 5, 0, 4.0 * 4 * 2 / 3 + 4 * 2 / 2.0 * 2);
    check_shape("size(4, 1, 4) hip_roof(45)", 8, 5, 5, 0, 4.0 * 4 * 2 / 3);
    check_shape("size(4, 1, 4) flat_roof(0.5)", 8, 8, 6, 0, 8);
    check_shape("size(4, 1, 4) flat_roof()", 8, 4, 1, 1, 0);
    check_shape("size(4, 1, 0) t", 8, 4, 1, 1, 0);
    check_shape("width(2) draw(3)", 8, 18, 24, 0, 3 * octagon);
    check_shape("width(2) draw(3) draw(2)", 8, 26, 32, 0, 5 * octagon);
    check_shape("width(2) draw(3) width(0) draw(3)", 8, 18, 24, 0, 4 * octagon);
    check_shape("width(2) draw(3) turn(100) draw(3)", 8, 36, 48, 0, 6 * octagon);
    check_shape("width(2) draw(0.1) turn(60) draw(0.1)", 8, 36, 48, 0, 0.2 * octagon); /* too short for a bend */
    check_shape("width(0) draw(3)", 8, 0, 0, 0, 0);
    check_shape("width(2) draw(0.0000000001) size(1, 1, 0.0000000001) insert(box)", 8, 0, 0, 0, 0);
}
END_TEST

/* Finer spheres come closer to the ball, and their normals to its radii. */
START_TEST(spheres_are_round)
{
    test_scene f = test_scene_of("start S\nrule S -> translate(-1, -1, -1) size(2, 2, 2) insert(sphere)\n");
    double last = 0;
    for (unsigned radial = 4; radial <= 64; radial *= 2) {
        sg_mesh m = mesh_of(&f.scene, radial, 0);
        ck_assert_uint_eq(check_mesh(&m), 0);
        ck_assert_double_gt(mesh_volume(&m), last);
        last = mesh_volume(&m);
        for (size_t i = 0; i < m.nfaces; i++)
            for (uint32_t k = 0; k < m.faces[i].ncorners; k++) {
                const double *v = m.vertices[m.faces[i].corner[k].vertex];
                test_must(fabs(sg_vec_length(v) - 1) < 1e-12);
                test_must(fabs(v[1]) > 0.999999 || sg_vec_dot(v, m.normals[m.faces[i].corner[k].normal]) > 1 - 1e-9);
            }
        sg_mesh_clear(&m);
    }
    ck_assert_double_eq_tol(last, 4 * pi / 3, 0.02);
    test_close_scene(&f);
}
END_TEST

static const char plant[] =
    "limit depth 6\nstart T(1)\n"
    "rule T(l) -> width(l / 5) tropism(0, -1, 0, 0.1) draw(l) turn(uniform(-20, 20)) draw(l) "
    "[ turn(40) set_material(twig) T(l * 0.7) ] [ roll(120) turn(35) T(l * 0.6) ] roll(90) T(l * 0.8)\n"
    "rule T(l) at limit -> size(0.2, 0.2, 0.2) insert(sphere)\n";

/* A strand goes on along the straightest branch; each segment continues one other at most. */
START_TEST(strands_share_rings)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(
        "start S\nrule S -> width(0.2) draw(1) [ turn(40) draw(1) ] turn(10) draw(1) [ A ] turn(-5) draw(1)\n"
        "rule A -> draw(1)\n");
    sg_mesh_strands s;
    ck_ok(sg_mesh_strands_find(&f.scene, &s, &err));
    ck_assert(s.next[0] == 2 && s.next[1] == SG_NONE && s.next[2] == 4 && s.next[3] == SG_NONE);
    ck_assert(!s.inner[0] && !s.inner[1] && s.inner[2] && !s.inner[3] && s.inner[4]);
    sg_mesh_strands_clear(&s);
    sg_mesh m = mesh_of(&f.scene, 6, 0);
    ck_assert_uint_eq(m.nvertices, (4 * 6 + 2) + 2 * (2 * 6 + 2));
    ck_assert_uint_eq(check_mesh(&m), 0);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

/* Whether n vertices from `at` on are a ring about this centre with this radius. */
static bool is_ring(const sg_mesh *m, size_t at, unsigned n, const double *centre, double radius)
{
    double sum[3] = {0, 0, 0}, d[3];
    for (size_t i = at; i < at + n; i++) {
        sg_vec_add(sum, 1.0 / n, m->vertices[i], sum);
        sg_vec_add(m->vertices[i], -1, centre, d);
        if (fabs(sg_vec_length(d) - radius) > 1e-9)
            return false;
    }
    sg_vec_add(sum, -1, centre, d);
    return sg_vec_length(d) < 1e-9;
}

static bool has_ring(const sg_mesh *m, unsigned n, const double *centre, double radius)
{
    for (size_t at = 0; at + n <= m->nvertices; at++)
        if (is_ring(m, at, n, centre, radius))
            return true;
    return false;
}

/* At all levels of detail a ring stands at every joint of the skeleton, with its radius. */
START_TEST(levels_of_detail_share_one_skeleton)
{
    test_scene f = test_scene_of(plant);
    static const unsigned sides[] = {16, 8, 4, 3, 3};
    size_t last = SIZE_MAX;
    for (unsigned detail = 0; detail < 5; detail++) {
        sg_mesh m = mesh_of(&f.scene, 16, detail);
        ck_assert(m.nfaces < last || detail == 4);
        last = m.nfaces;
        size_t nsegments = 0;
        for (size_t i = 0; i < f.scene.n && nsegments < 40; i++) {
            const sg_primitive *p = f.scene.items + i;
            double end[3];
            if (p->kind != SG_PRIMITIVE_SEGMENT)
                continue;
            sg_frame_point(&p->frame, 0, p->size[1], 0, end);
            test_must(has_ring(&m, sides[detail], p->frame.origin, p->radius[0]));
            test_must(has_ring(&m, sides[detail], end, p->radius[1]));
            nsegments++;
        }
        ck_assert_uint_eq(check_mesh(&m), 0);
        ck_assert_uint_eq(m.ngroups, 2);
        sg_mesh_clear(&m);
    }
    test_close_scene(&f);
}
END_TEST

static size_t count_flat(const sg_scene *s)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        n += s->items[i].kind == SG_PRIMITIVE_LABEL || s->items[i].kind == SG_PRIMITIVE_POLYGON;
    return n;
}

START_TEST(random_scenes_have_sound_meshes)
{
    for (uint64_t k = 0; k < 20; k++) {
        sg_error err = SG_ERROR_INIT;
        test_scene f;
        sg_mesh m = {0};
        const sg_mesh_opts opts = {3 + (unsigned)k % 5, (unsigned)k % 2, NULL};
        if (!test_random_scene((uint64_t)_i * 20 + k + 1, &f))
            continue;
        if (f.scene.n < 5000) {
            test_must_ok(sg_mesh_from_scene(&f.scene, &opts, &m, &err));
            ck_assert_uint_le(check_mesh(&m), count_flat(&f.scene));
        }
        sg_mesh_clear(&m);
        test_close_scene(&f);
    }
}
END_TEST

START_TEST(plants_have_sound_meshes)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_open_scene(plant, (uint64_t)_i + 1);
    ck_ok(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err));
    sg_mesh m = mesh_of(&f.scene, 7, 0);
    ck_assert_uint_eq(check_mesh(&m), 0);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

/* ---- groups, materials and files ---- */

static const char house[] = "label wall #ffffff\nlabel \"red roof\" #ff0000\nstart S\n"
                            "rule S -> size(4, 3, 6) wall set_label(\"red roof\") gable_roof(45) set_label(wall) "
                            "set_material(brick) size(1, 5, 1) insert(box) insert(\"my tree.obj\")\n";

START_TEST(groups_are_by_material_and_name)
{
    test_scene f = test_scene_of(house);
    sg_mesh m = mesh_of(&f.scene, 8, 0);
    static const char *const names[] = {"wall", "red roof", "wall", "my tree.obj"};
    static const size_t nfaces[] = {6, 5, 6, 6};
    ck_assert_uint_eq(m.ngroups, 4);
    for (size_t k = 0; k < 4; k++) {
        ck_assert_str_eq(m.groups[k].name, names[k]);
        ck_assert_uint_eq(m.groups[k].n, nfaces[k]);
    }
    ck_assert_uint_eq(m.nmaterials, 3);
    ck_assert_str_eq(m.materials[m.groups[2].material].name, "brick");
    ck_assert_uint_eq(m.materials[m.groups[1].material].color, 0xff0000);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

static char *written(const sg_mesh *m, bool materials)
{
    sg_error err = SG_ERROR_INIT;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    ck_ok(materials ? sg_mesh_mtl_write(m, out, &err) : sg_mesh_obj_write(m, "x.mtl", out, &err));
    fclose(out);
    return text;
}

static size_t count_lines(const char *text, const char *begin)
{
    size_t n = strncmp(text, begin, strlen(begin)) == 0;
    for (const char *p = text; (p = strchr(p, '\n')) != NULL; p++)
        n += strncmp(p + 1, begin, strlen(begin)) == 0;
    return n;
}

START_TEST(a_quad_is_written_to_the_letter)
{
    test_scene f = test_scene_of("label t #ff8000\nstart S\nrule S -> rotate(0, 90, 0) size(2, 1, 0) t\n");
    sg_mesh m = mesh_of(&f.scene, 8, 0);
    char *obj = written(&m, false), *mtl = written(&m, true);
    ck_assert_str_eq(obj,
                     "mtllib x.mtl\nv 0 0 0\nv 0 0 -2\nv 0 1 -2\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 2 1\nvt 0 1\nvn 1 0 0\n"
                     "g t\nusemtl ff8000\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
    ck_assert_str_eq(mtl, "newmtl ff8000\nKd 1.0000 0.5020 0.0000\nKs 0 0 0\nillum 1\n");
    free(obj);
    free(mtl);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

START_TEST(files_hold_the_whole_mesh)
{
    test_scene f = test_scene_of(house);
    sg_mesh m = mesh_of(&f.scene, 8, 0);
    char *obj = written(&m, false), *again = written(&m, false), *mtl = written(&m, true);
    ck_assert_str_eq(obj, again);
    ck_assert(count_lines(obj, "v ") == m.nvertices && count_lines(obj, "vt ") == m.nuvs);
    ck_assert(count_lines(obj, "vn ") == m.nnormals && count_lines(obj, "f ") == m.nfaces);
    ck_assert(count_lines(obj, "g red_roof\nusemtl ff0000\n") == 1 && count_lines(obj, "usemtl brick_ffffff\n") == 2);
    ck_assert(count_lines(obj, "g my_tree.obj\n") == 1 && count_lines(mtl, "newmtl ") == 3);
    free(obj);
    free(again);
    free(mtl);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

START_TEST(two_files_are_saved)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(house);
    sg_mesh m = mesh_of(&f.scene, 8, 0);
    const temp_folder t = temp_folder_make();
    char *obj = written(&m, false);
    size_t n;
    ck_ok(sg_mesh_obj_save(&m, temp_path(&t, "x.obj"), &err));
    unsigned char *bytes = temp_read(&t, "x.obj", &n);
    ck_assert(n == strlen(obj) && memcmp(bytes, obj, n) == 0);
    free(bytes);
    free(temp_read(&t, "x.mtl", &n));
    ck_assert_uint_gt(n, 0);
    ck_assert_int_eq(sg_mesh_obj_save(&m, temp_path(&t, "x.ply"), &err), SG_EINVAL);
    ck_assert_int_eq(sg_mesh_obj_save(&m, "obj", &err), SG_EINVAL);
    ck_assert_int_eq(sg_mesh_obj_save(&m, temp_path(&t, "none/x.obj"), &err), SG_EIO);
    char *path = malloc(5001);
    memset(path, 'a', 5000);
    memcpy(path + 4996, ".obj", 5);
    ck_assert_int_eq(sg_mesh_obj_save(&m, path, &err), SG_EIO);
    free(path);
    free(obj);
    temp_folder_remove(&t);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

START_TEST(a_full_disk_is_told)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of(house);
    sg_mesh m = mesh_of(&f.scene, 8, 0);
    for (int k = 0; k < 2; k++) {
        FILE *full = fopen("/dev/full", "w");
        ck_assert_ptr_nonnull(full);
        setvbuf(full, NULL, _IONBF, 0);
        ck_assert_int_eq(k == 0 ? sg_mesh_obj_write(&m, NULL, full, &err) : sg_mesh_mtl_write(&m, full, &err), SG_EIO);
        fclose(full);
    }
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

START_TEST(bad_options_and_bad_numbers_are_refused)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of("start S\nrule S -> insert(box) translate(1e200, 0, 0) insert(sphere)\n");
    sg_mesh m = {0};
    sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    ck_assert_int_eq(sg_mesh_from_scene(&f.scene, &opts, &m, &err), SG_ENUMERIC);
    ck_assert_uint_eq(m.nfaces, 0);
    f.scene.n = 1;
    ck_ok(sg_mesh_from_scene(&f.scene, &opts, &m, &err));
    for (unsigned k = 0; k < 2; k++) {
        opts.radial = k == 0 ? 2 : 1025;
        ck_assert_int_eq(sg_mesh_from_scene(&f.scene, &opts, &m, &err), SG_EINVAL);
        ck_assert_uint_eq(m.nfaces + m.nvertices + m.ngroups, 0);
    }
    sg_mesh_clear(&m);
    test_close_scene(&f);
}
END_TEST

START_TEST(each_allocation_may_fail)
{
    test_scene f =
        test_scene_of("label t\nstart S\nrule S -> draw(1) draw(1) insert(sphere) insert(box) size(1, 1, 0) t "
                      "set_material(a) t set_material(b) t set_material(c) t set_material(d) t\n");
    size_t failures = 0;
    for (bool failed = true; failed;) {
        sg_error err = SG_ERROR_INIT;
        sg_mesh m = {0};
        const sg_mesh_opts opts = SG_MESH_OPTS_INIT;
        test_fail_allocation(failures);
        const sg_status st = sg_mesh_from_scene(&f.scene, &opts, &m, &err);
        failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        ck_assert(!failed || m.nfaces == 0);
        failures += failed;
        sg_mesh_clear(&m);
    }
    ck_assert_uint_gt(failures, 10);
    test_close_scene(&f);
}
END_TEST

static Suite *mesh_suite(void)
{
    Suite *s = suite_create("mesh");
    TCase *shapes = tcase_create("shapes"), *files = tcase_create("files");
    tcase_add_test(shapes, a_broken_mesh_is_found);
    tcase_add_test(shapes, shapes_have_their_volumes);
    tcase_add_test(shapes, spheres_are_round);
    tcase_add_test(shapes, strands_share_rings);
    tcase_add_test(shapes, levels_of_detail_share_one_skeleton);
    tcase_add_loop_test(shapes, random_scenes_have_sound_meshes, 0, 20);
    tcase_add_loop_test(shapes, plants_have_sound_meshes, 0, 5);
    tcase_add_test(files, groups_are_by_material_and_name);
    tcase_add_test(files, a_quad_is_written_to_the_letter);
    tcase_add_test(files, files_hold_the_whole_mesh);
    tcase_add_test(files, two_files_are_saved);
    tcase_add_test(files, a_full_disk_is_told);
    tcase_add_test(files, bad_options_and_bad_numbers_are_refused);
    tcase_add_test(files, each_allocation_may_fail);
    suite_add_tcase(s, shapes);
    suite_add_tcase(s, files);
    return s;
}

int main(void)
{
    return test_run(mesh_suite());
}
