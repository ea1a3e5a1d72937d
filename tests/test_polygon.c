/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_polygon.c - scopes that are polygons: prisms, their faces, roofs over them, as scenes and as meshes. */
#include "config.h"

#include "scene/mesh.h"
#include "scene/skeleton.h"
#include "tests/mesh_check.h"
#include "tests/scene_support.h"

#define L_SHAPE "polygon(0, 0, 1, 0, 1, 0.4, 1/3, 0.4, 1/3, 1, 0, 1)"

static sg_mesh mesh_of(const sg_scene *scene)
{
    sg_error err = SG_ERROR_INIT;
    sg_mesh mesh = {0};
    const sg_mesh_opts opts = SG_MESH_OPTS_INIT;
    ck_ok(sg_mesh_from_scene(scene, &opts, &mesh, &err));
    return mesh;
}

static const char *program(const char *body)
{
    static char text[4000];
    snprintf(text, sizeof text,
             "label t\nlabel w\nlabel b\nstart S\nrule S -> translate(3, -1, 2) rotate(10, 20, 30) %s\n", body);
    return text;
}

static void check_volume(const char *body, double volume, size_t nprimitives)
{
    test_scene f = test_scene_of(program(body));
    sg_mesh m = mesh_of(&f.scene);
    size_t nopen = 1;
    const char *wrong = mesh_check(&m, &nopen);
    ck_assert_msg(wrong == NULL && nopen == 0, "%s: %s", body, wrong != NULL ? wrong : "open faces");
    ck_assert_msg(fabs(mesh_volume(&m) - volume) <= 1e-9 * (1 + fabs(volume)), "%s: %.12g, not %.12g", body,
                  mesh_volume(&m), volume);
    ck_assert_uint_eq(f.scene.n, nprimitives);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}

static void check_area(const char *body, double area, size_t nprimitives)
{
    test_scene f = test_scene_of(program(body));
    sg_mesh m = mesh_of(&f.scene);
    size_t nopen = 0;
    const char *wrong = mesh_check(&m, &nopen);
    ck_assert_msg(wrong == NULL && nopen == nprimitives, "%s: %s", body, wrong != NULL ? wrong : "closed");
    double sum = 0;
    for (size_t i = 0; i < m.nfaces; i++)
        for (uint32_t k = 1; k + 1 < m.faces[i].ncorners; k++) {
            double a[3], b[3], c[3];
            const sg_mesh_corner *corner = m.faces[i].corner;
            sg_vec_add(m.vertices[corner[k].vertex], -1, m.vertices[corner[0].vertex], a);
            sg_vec_add(m.vertices[corner[k + 1].vertex], -1, m.vertices[corner[0].vertex], b);
            sg_vec_cross(a, b, c);
            sum += sg_vec_length(c) / 2;
        }
    ck_assert_msg(fabs(sum - area) < 1e-9 * (1 + area), "%s: %.12g, not %.12g", body, sum, area);
    ck_assert_uint_eq(f.scene.n, nprimitives);
    sg_mesh_clear(&m);
    test_close_scene(&f);
}

/* An L of 6 by 5, its legs 2 wide: area 18. */
START_TEST(prisms_have_their_volumes)
{
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3)", 18 * 3, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(-3)", 18 * 3, 1);
    check_volume("size(6, 5, 0) " L_SHAPE " extrude(3) t", 18 * 3, 1);
    check_volume("size(6, 0, 5) polygon(0, 0, 0, 1, 1/3, 1, 1/3, 0.4, 1, 0.4, 1, 0) extrude(3)", 18 * 3,
                 1); /* clockwise */
    check_volume("size(6, 7, 5) " L_SHAPE " extrude(3)", 18 * 3, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) insert(box) scale(2, 2, 1) insert(box)", 18 * 3 * 5, 2);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) split z { 1 : t | ~1 : t | '0.1 : t }", 18 * 3, 3);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) repeat z 4 { t }", 18 * 3, 4);
    check_volume("size(6, 0, 5) polygon(0.5, 0, 1, 0.5, 0.5, 1, 0, 0.5) extrude(2)", 6 * 5 / 2.0 * 2, 1);
    check_volume("size(6, 0, 5) polygon(0, 0, 0.5, 0, 0, 0.5) extrude(2)", 3 * 2.5 / 2 * 2, 1); /* the scope shrinks */
    check_volume("size(6, 0, 5) polygon(0, 0, 1, 0, 1, 1, 0, 1) extrude(2)", 6 * 5 * 2, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " flat_roof(0.5)", 18 * 0.5, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) S2\nrule S2 -> flat_roof(0.5) t", 18 * 3.5, 2); /* inherited */
    check_volume("size(6, 0, 5) polygon(0, 0, 1, 0, 1, 1, 0, 1) polygon(0, 0, 1, 0, 0, 1) extrude(2)", 6 * 5 / 2.0 * 2,
                 1);
    check_area("size(6, 0, 5) " L_SHAPE " t", 18, 1);
    check_area("size(6, 0, 5) " L_SHAPE " insert(box)", 18, 1);
    check_area("size(6, 0, 5) " L_SHAPE " flat_roof()", 18, 1);
    check_area("size(0, 0, 5) " L_SHAPE " t", 0, 0);
}
END_TEST

/* The walls have the length of the outline, 22. */
START_TEST(components_are_the_faces)
{
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { side : w }", 22 * 3, 6);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { top : t }", 18, 1);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { bottom : b }", 18, 1);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { all : b }", 22 * 3 + 2 * 18, 8);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { front : w }", 6 * 3, 1);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { right : w }", (2 + 3) * 3, 2);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { back : w }", (4 + 2) * 3, 2);
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { left : w | all : nothing }", 5 * 3, 1);
    check_area("size(6, 0, 5) " L_SHAPE " components { top : t | all : w }", 18, 1); /* flat: it has no others */
    check_area("size(6, 0, 5) " L_SHAPE " extrude(3) components { top : polygon(0, 0, 1, 0, 0, 1) t }", 15, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) components { bottom : extrude(1) }", 18, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) components { side : extrude(0.5) }", 22 * 3 * 0.5, 6);
}
END_TEST

static void check_frame(const sg_primitive *p, const double *origin, const double *x, const double *z)
{
    double d[3];
    sg_vec_add(p->frame.origin, -1, origin, d);
    ck_assert_double_lt(sg_vec_length(d), 1e-12);
    ck_assert_double_eq_tol(sg_vec_dot(p->frame.x, x), 1, 1e-12);
    ck_assert_double_eq_tol(sg_vec_dot(p->frame.z, z), 1, 1e-12);
}

/* On the ground x runs to the right, y to the back and z up; walls stand upright and look outwards. */
START_TEST(faces_stand_where_they_should)
{
    test_scene f =
        test_scene_of("label t\nstart S\nrule S -> size(6, 0, 5) " L_SHAPE " extrude(3) components { all : t }\n");
    ck_assert_uint_eq(f.scene.n, 8);
    const sg_primitive *p = f.scene.items;
    check_frame(p, (double[]){0, 0, 5}, (double[]){1, 0, 0}, (double[]){0, 0, 1});
    check_frame(p + 1, (double[]){6, 0, 5}, (double[]){0, 0, -1}, (double[]){1, 0, 0});
    check_frame(p + 3, (double[]){2, 0, 3}, (double[]){0, 0, -1}, (double[]){1, 0, 0});
    check_frame(p + 5, (double[]){0, 0, 0}, (double[]){0, 0, 1}, (double[]){-1, 0, 0});
    ck_assert(p[1].size[0] == 2 && p[1].size[1] == 3 && p[1].ncorners == 0 && p[1].kind == SG_PRIMITIVE_LABEL);
    check_frame(p + 6, (double[]){0, 3, 5}, (double[]){1, 0, 0}, (double[]){0, 1, 0});
    check_frame(p + 7, (double[]){0, 0, 0}, (double[]){1, 0, 0}, (double[]){0, -1, 0});
    ck_assert(p[6].ncorners == 6 && p[7].ncorners == 6 && p[6].kind == SG_PRIMITIVE_POLYGON);
    test_close_scene(&f);
}
END_TEST

/* Volumes by hand: slope 1 over w by l makes w^2 (3 l - w) / 12; legs of the L that are as wide share a pyramid's. */
START_TEST(hip_roofs_have_their_volumes)
{
    const double l = 2 * 2 * (3 * 6 - 2) / 12.0 + 2 * 2 * (3 * 5 - 2) / 12.0 - 4 / 3.0;
    check_volume("size(4, 0, 4) polygon(0, 0, 1, 0, 1, 1, 0, 1) hip_roof(45)", 4.0 * 4 * 2 / 3, 1);
    check_volume("size(6, 0, 4) polygon(0, 0, 1, 0, 1, 1, 0, 1) hip_roof(45)", 4 * 4 * (3 * 6 - 4) / 12.0, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " hip_roof(45)", l, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " hip_roof(30)", l * tan(30 * 0.017453292519943295), 1);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) hip_roof(45)", l + 18 * 3, 2);
    check_volume("size(6, 0, 5) " L_SHAPE " extrude(3) components { top : hip_roof(45) }", l, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " scale(2, 2, 1) hip_roof(45)", 8 * l, 1);
    /* With an overhang of 0.5 the legs are 3 wide, 7 and 6 long. */
    check_volume("size(6, 0, 5) " L_SHAPE " hip_roof(45, 0.5)",
                 3 * 3 * (3 * 7 - 3) / 12.0 + 3 * 3 * (3 * 6 - 3) / 12.0 - 3 * 3 * 1.5 / 3, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " hip_roof(45, -0.5)",
                 1 * 1 * (3 * 5 - 1) / 12.0 + 1 * 1 * (3 * 4 - 1) / 12.0 - 1 * 1 * 0.5 / 3, 1);
    check_area("size(6, 0, 5) " L_SHAPE " hip_roof(0)", 18, 1);
}
END_TEST

/* A gable end of a roof 2 wide holds 2^3 / 24 more than a hip end. */
START_TEST(gable_roofs_have_their_volumes)
{
    const double l = 2 * 2 * (3 * 6 - 2) / 12.0 + 2 * 2 * (3 * 5 - 2) / 12.0 - 4 / 3.0;
    check_volume("size(6, 0, 5) " L_SHAPE " gable_roof(45)", l + 2 * 8 / 24.0, 1);
    check_volume("size(6, 0, 5) " L_SHAPE " gable_roof(30)", (l + 2 * 8 / 24.0) * tan(30 * 0.017453292519943295), 1);
    check_volume("size(6, 0, 4) polygon(0, 0, 1, 0, 1, 1, 0, 1) gable_roof(45)", 4 * 2 / 2.0 * 6, 1);
    check_volume("size(4, 0, 6) polygon(0, 0, 1, 0, 1, 1, 0, 1) gable_roof(45, 1)", 6 * 3 / 2.0 * 8, 1);
    check_volume("size(4, 0, 4) polygon(0, 0, 1, 0, 1, 1, 0, 1) gable_roof(45)", 4.0 * 4 * 2 / 3, 1); /* a pyramid */
    check_volume(
        "size(6, 0, 6) polygon(1/3, 0, 2/3, 0, 2/3, 1/3, 1, 1/3, 1, 2/3, 2/3, 2/3, 2/3, 1, 1/3, 1, 1/3, 2/3, 0, 2/3, "
        "0, 1/3, 1/3, 1/3) gable_roof(45)",
        2 * (2 * 1 / 2.0 * 6) - 4 / 3.0, 1); /* a cross: two that share a pyramid */
}
END_TEST

/* Polygons of four corners have the roofs that boxes have. */
START_TEST(a_rectangle_is_a_polygon_too)
{
    static const char *const sizes[] = {"size(6, 1, 4)", "size(4, 1, 6)", "size(4, 1, 4)"};
    for (size_t i = 0; i < 3; i++) {
        char one[200], two[200];
        snprintf(one, sizeof one, "%s hip_roof(37, 0.3)", sizes[i]);
        snprintf(two, sizeof two, "%s polygon(0, 0, 1, 0, 1, 1, 0, 1) hip_roof(37, 0.3)", sizes[i]);
        test_scene f = test_scene_of(program(one));
        sg_mesh m = mesh_of(&f.scene);
        check_volume(two, mesh_volume(&m), 1);
        sg_mesh_clear(&m);
        test_close_scene(&f);
    }
}
END_TEST

static void check_fails(const char *body, const char *sentence)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_open_scene(program(body), 1);
    ck_assert_int_eq(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err), SG_ENUMERIC);
    ck_assert_msg(strstr(err.msg, "test.sg:5: error: deriving S: ") == err.msg && strstr(err.msg, sentence) != NULL, "%s",
                  err.msg);
    ck_assert_uint_eq(f.scene.n, 0);
    test_close_scene(&f);
}

START_TEST(what_cannot_be_is_told_with_its_rule)
{
    check_fails("polygon(0, 0, 1, 1, 1, 0, 0, 1)", "cross or touch");
    check_fails("polygon(0, 0, 1, 0, 0.5, 0)", "cross or touch");
    check_fails("polygon(0, 0, 1, 0, 1, 0, 0, 1)", "cross or touch");
    check_fails("polygon(0, 0, 1, 0, 1, 1, 0.5, 0, 0, 1)", "cross or touch"); /* a corner on a side */
    check_fails("size(6, 0, 5) " L_SHAPE " extrude(3) split x { t | t }", "cut along z alone");
    check_fails("size(6, 0, 5) " L_SHAPE " extrude(3) repeat y 2 { t }", "cut along z alone");
    test_scene f =
        test_open_scene("start S\nrule S -> A\nrule A -> B\n\nrule B -> polygon(0, 0, 1, 1, 1, 0, 0, 1)\n", 1);
    sg_error err = SG_ERROR_INIT;
    ck_assert_int_eq(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err), SG_ENUMERIC);
    ck_assert_msg(strstr(err.msg, "test.sg:5: error: deriving S > A > B: ") == err.msg, "%s", err.msg);
    test_close_scene(&f);
    check_fails("size(6, 0, 5) " L_SHAPE " hip_roof(90)", "90 degrees");
    check_fails("size(6, 0, 5) " L_SHAPE " hip_roof(45, -1.1)", "overhang is too large");
    check_fails("size(6, 0, 6) polygon(0, 0, 1, 0, 1, 1, 2/3, 1, 2/3, 0.5, 1/3, 0.5, 1/3, 1, 0, 1) hip_roof(45, 1.1)",
                "overhang");
}
END_TEST

START_TEST(corners_come_in_pairs)
{
    static const char *const bad[] = {"polygon(0, 0, 1, 0, 1, 1, 0)", "polygon(0, 0, 1, 1)",
                                      "polygon(1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1)"};
    for (size_t i = 0; i < 3; i++) {
        sg_error err = SG_ERROR_INIT;
        sg_grammar *g = NULL;
        const char *text = program(bad[i]);
        ck_assert_int_eq(sg_grammar_parse(text, strlen(text), "x.sg", &g, &err), SG_EINPUT);
        ck_assert(strstr(err.msg, "x.sg:5:") == err.msg && strstr(err.msg, "polygon takes") != NULL);
    }
}
END_TEST

/* Random stars, as prisms with roofs; and every slice interpreted by itself is what the whole has there. */
START_TEST(random_polygons_have_sound_meshes)
{
    sg_error err = SG_ERROR_INIT;
    gsl_rng *rng = sg_random_create((uint64_t)_i + 1);
    for (int k = 0; k < 40; k++) {
        char body[2000] = "size(9, 0, 7) polygon(";
        const unsigned n = 3 + (unsigned)gsl_rng_uniform_int(rng, SG_PRIMITIVE_CORNERS - 2);
        for (unsigned i = 0; i < n; i++) {
            const double r = n == 3 ? 0.5 : 0.2 + 0.3 * gsl_rng_uniform(rng),
                         a = 6.283185307179586 * (i + 0.5 * gsl_rng_uniform(rng)) / n;
            snprintf(body + strlen(body), 100, "%s%.4f, %.4f", i > 0 ? ", " : "", 0.5 + r * cos(a), 0.5 + r * sin(a));
        }
        strcat(body, ") extrude(4) split z { 1 : A | 2 : A | ~1 : A }\n"
                     "rule A -> [ components { side : Wall | bottom : t } ] hip_roof(40) B\nrule B -> gable_roof(50)\n"
                     "rule Wall -> split x { w | ~2 : extrude(0.1) | w }\n");
        test_scene f = test_scene_of(program(body));
        sg_mesh m = mesh_of(&f.scene);
        const char *wrong = mesh_check(&m, NULL);
        ck_assert_msg(wrong == NULL, "%s: %s", body, wrong);
        sg_scene_states states = {0};
        sg_scene again = {0};
        const sg_scene_state first = sg_scene_first_state(&f.opts);
        f.scene.n = 0;
        ck_ok(sg_scene_interpret_slice(&f.d, 0, &first, &f.opts, &f.scene, &states, &err));
        for (size_t i = 0; i < states.n; i++) {
            again.n = 0;
            ck_ok(sg_scene_interpret_slice(&f.d, states.places[i].node, &states.places[i].state, &f.opts, &again, NULL,
                                           &err));
            test_must(test_same_primitives(&again, &f.scene, states.places[i].first));
        }
        sg_scene_states_clear(&states);
        sg_scene_clear(&again);
        sg_mesh_clear(&m);
        test_close_scene(&f);
    }
    gsl_rng_free(rng);
}
END_TEST

static Suite *polygon_suite(void)
{
    Suite *s = suite_create("polygon");
    TCase *all = tcase_create("all");
    tcase_add_test(all, prisms_have_their_volumes);
    tcase_add_test(all, components_are_the_faces);
    tcase_add_test(all, faces_stand_where_they_should);
    tcase_add_test(all, hip_roofs_have_their_volumes);
    tcase_add_test(all, gable_roofs_have_their_volumes);
    tcase_add_test(all, a_rectangle_is_a_polygon_too);
    tcase_add_test(all, what_cannot_be_is_told_with_its_rule);
    tcase_add_test(all, corners_come_in_pairs);
    tcase_add_loop_test(all, random_polygons_have_sound_meshes, 0, 5);
    suite_add_tcase(s, all);
    return s;
}

int main(void)
{
    return test_run(polygon_suite());
}
