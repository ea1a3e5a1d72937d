/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_scene.c - derivations as primitives in space: known coordinates, slices, statuses, failing memory. */
#include "core/array.h"
#include "scene/label_scene.h"
#include "tests/failing_malloc.h"
#include "tests/scene_support.h"

static const sg_primitive *item(const test_scene *f, size_t i, sg_primitive_kind kind)
{
    ck_assert_uint_lt(i, f->scene.n);
    ck_assert_uint_eq(f->scene.items[i].kind, kind);
    return f->scene.items + i;
}

static void check_point(const sg_primitive *p, double a, double b, double c, double x, double y, double z)
{
    double at[3];
    sg_frame_point(&p->frame, a, b, c, at);
    ck_assert_msg(fabs(at[0] - x) < 1e-9 && fabs(at[1] - y) < 1e-9 && fabs(at[2] - z) < 1e-9,
                  "(%g, %g, %g), not (%g, %g, %g)", at[0], at[1], at[2], x, y, z);
}

static void check_corner(const test_scene *f, const sg_primitive *p, size_t k, double along, double x, double y, double z)
{
    const double(*c)[2] = sg_primitive_corners(&f->scene, p);
    if (c == NULL || k >= p->ncorners)
        ck_abort_msg("it has no such corner");
    else
        check_point(p, c[k][0], c[k][1], along, x, y, z);
}

static void check_segment(const test_scene *f, size_t i, const double *from, const double *to)
{
    const sg_primitive *p = item(f, i, SG_PRIMITIVE_SEGMENT);
    check_point(p, 0, 0, 0, from[0], from[1], from[2]);
    check_point(p, 0, p->size[1], 0, to[0], to[1], to[2]);
}

#define V(x, y, z) ((const double[]){x, y, z})

/* Heading up, the turtle's left is -x and its up is z. */
START_TEST(the_turtle_turns_pitches_and_rolls)
{
    test_scene f =
        test_scene_of("start S\nrule S -> [ turn(90) draw(2) ] [ pitch(90) draw(3) ] [ roll(90) turn(90) draw(4) ] "
                      "move(1) draw(-2) [ turn(-90) move(1) draw(1) ]\n");
    ck_assert_uint_eq(f.scene.n, 5);
    check_segment(&f, 0, V(0, 0, 0), V(-2, 0, 0));
    check_segment(&f, 1, V(0, 0, 0), V(0, 0, -3));
    check_segment(&f, 2, V(0, 0, 0), V(0, 0, 4)); /* left has rolled to up */
    check_segment(&f, 3, V(0, 1, 0), V(0, -1, 0));
    check_segment(&f, 4, V(1, -1, 0), V(2, -1, 0));
    test_close_scene(&f);
}
END_TEST

/* A segment begins as wide as the one before it ends; what moves away begins a new chain. */
START_TEST(segments_share_radii_at_joints)
{
    test_scene f = test_scene_of(
        "start S\nrule S -> width(0.4) draw(1) T width(0.2) [ turn(30) draw(1) ] draw(1) move(0.5) width(-1) draw(1)\n"
        "rule T -> turn(20) width(0.1) draw(1) width(0.06) draw(0) draw(1)\n");
    static const double want[6][2] = {{0.2, 0.2}, {0.2, 0.1}, {0.2, 0.1}, {0, 0}, {0.2, 0.05}, {0.05, 0.03}};
    ck_assert_uint_eq(f.scene.n, 6);
    for (size_t i = 0; i < 6; i++)
        for (int k = 0; k < 2; k++)
            ck_assert_double_eq_tol(item(&f, i, SG_PRIMITIVE_SEGMENT)->radius[k], want[i][k], 1e-12);
    ck_assert_uint_eq(f.scene.items[0].node, 0);
    ck_assert_uint_eq(f.scene.items[4].node, 1);
    test_close_scene(&f);
}
END_TEST

/* A heading at angle a to T = (0, -1, 0) is bent by e sin(a) radians towards it after each segment. */
START_TEST(tropism_bends_by_its_torque)
{
    test_scene f = test_scene_of("start S\nrule S -> turn(-60) tropism(0, -2, 0, 0.1) draw(1) draw(1)\n");
    const double a = acos(-1) / 3, b = a + 0.2 * sin(a);
    check_segment(&f, 0, V(0, 0, 0), V(sin(a), cos(a), 0));
    check_segment(&f, 1, V(sin(a), cos(a), 0), V(sin(a) + sin(b), cos(a) + cos(b), 0));
    test_close_scene(&f);
    f = test_scene_of("start S\nrule S -> tropism(0, -1, 0, 0.5) draw(1) draw(1)\n"); /* against T: no torque */
    check_segment(&f, 1, V(0, 1, 0), V(0, 2, 0));
    test_close_scene(&f);
}
END_TEST

START_TEST(scopes_are_moved_turned_and_sized)
{
    test_scene f = test_scene_of(
        "start S\nrule S -> translate(1, 2, 3) rotate(0, 90, 0) size(2, 3, 4) scale(1, 2, -1) insert(box) "
        "scale(1, 1, 5) insert(box) size(1, 2, 3) insert(box) rotate(90, 0, 90) insert(cone) size(0, 2, 3) "
        "insert(\"a.obj\") insert(sphere)\n");
    ck_assert_uint_eq(f.scene.n, 5);                           /* the sphere is flat */
    const sg_primitive *p = item(&f, 0, SG_PRIMITIVE_POLYGON); /* depth 0 */
    check_point(p, 1, 0, 0, 1, 2, 2);
    check_point(p, 0, 1, 0, 1, 3, 3);
    ck_assert_uint_eq(p->ncorners, 4);
    check_corner(&f, p, 2, 0, 1, 8, 1);
    p = item(&f, 2, SG_PRIMITIVE_BOX);
    check_point(p, 0, 0, 1, 2, 2, 3);
    ck_assert(p->size[0] == 1 && p->size[1] == 2 && p->size[2] == 3);
    p = item(&f, 3, SG_PRIMITIVE_CYLINDER); /* about its x, then about its own z */
    check_point(p, 1, 0, 0, 2, 2, 3);
    ck_assert(p->radius[0] == 1 && p->radius[1] == 0);
    p = item(&f, 4, SG_PRIMITIVE_MESH);
    ck_assert_str_eq(sg_grammar_string(f.g, p->mesh), "a.obj");
    test_close_scene(&f);
}
END_TEST

/* One zero size: a rectangle that looks outwards. Two: nothing. */
START_TEST(flat_scopes_are_rectangles)
{
    test_scene f = test_scene_of(
        "label t #ff0000\nstart S\nrule S -> size(2, 3, 0) t size(2, 0, 3) t size(0, 2, 3) t size(0, 0, 1) t\n");
    ck_assert_uint_eq(f.scene.n, 3);
    static const double normal[3][3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    for (size_t i = 0; i < 3; i++) {
        const sg_primitive *p = item(&f, i, SG_PRIMITIVE_LABEL);
        ck_assert_str_eq(sg_grammar_symbol(f.g, p->label)->name, "t");
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq(p->frame.z[k], normal[i][k]);
    }
    test_close_scene(&f);
}
END_TEST

START_TEST(splits_cut_along_all_axes)
{
    test_scene f = test_scene_of("label a\nlabel b\nlabel c\nstart S\n"
                                 "rule S -> size(10, 4, 6) split x { 2 : split z { ~1 : a | '0.5 : b } | ~1 : nothing "
                                 "| ~3 : repeat y 2 { c } }\n");
    ck_assert_uint_eq(f.scene.n, 4);
    check_point(item(&f, 0, SG_PRIMITIVE_BOX), 0, 0, 3, 0, 0, 3);
    check_point(item(&f, 1, SG_PRIMITIVE_BOX), 0, 0, 3, 0, 0, 6);
    check_point(item(&f, 2, SG_PRIMITIVE_BOX), 6, 2, 6, 10, 2, 6);
    check_point(item(&f, 3, SG_PRIMITIVE_BOX), 6, 2, 6, 10, 4, 6);
    test_close_scene(&f);
    /* Parts that are larger than the scope are cut off at its end, parts that do not fill it leave the rest empty. */
    f = test_scene_of("label a\nstart S\nrule S -> size(3, 1, 1) split x { 2 : a | 2 : a | 1 : B } C split z { 1 : "
                      "nothing | 1 : B } split y { '0.25 : a }\n"
                      "rule B -> draw(2)\nrule C -> draw(1)\n");
    ck_assert_uint_eq(f.scene.n, 4);
    ck_assert_double_eq_tol(item(&f, 1, SG_PRIMITIVE_BOX)->size[0], 1, 1e-9); /* shares are multiples of 2^-40 */
    ck_assert_double_eq(item(&f, 3, SG_PRIMITIVE_BOX)->size[1], 0.25);
    ck_assert_double_eq(item(&f, 2, SG_PRIMITIVE_SEGMENT)->size[1],
                        1); /* successors that are passed over do not shift those behind them */
    test_close_scene(&f);
}
END_TEST

/* Six faces look outwards; each goes to the first part that takes it, and all places of a part are the same derivation.
 */
START_TEST(components_are_faces)
{
    test_scene f = test_scene_of("label t\nlabel u\nlabel v\nstart S\n"
                                 "rule S -> translate(1, 1, 1) size(2, 3, 4) components { top : t | side : U | back : "
                                 "u | all : v | front : u } W\n"
                                 "rule U -> 0.5 : u -> 0.5 : u u\nrule W -> draw(1)\n");
    static const double centre[6][3] = {{2, 4, 3}, {2, 2.5, 5}, {2, 2.5, 1}, {1, 2.5, 3}, {3, 2.5, 3}, {2, 1, 3}};
    static const double normal[6][3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}};
    const size_t each = (f.scene.n - 3) / 4;
    ck_assert(each == 1 || each == 2);
    for (size_t i = 0; i < 6; i++) {
        const size_t at = i == 0 ? 0 : i < 5 ? 1 + (i - 1) * each : 1 + 4 * each;
        const sg_primitive *p = item(&f, at, SG_PRIMITIVE_LABEL);
        check_point(p, p->size[0] / 2, p->size[1] / 2, 0, centre[i][0], centre[i][1], centre[i][2]);
        for (int k = 0; k < 3; k++)
            ck_assert_double_eq(p->frame.z[k], normal[i][k]);
    }
    item(&f, f.scene.n - 1, SG_PRIMITIVE_SEGMENT); /* what follows finds its own child */
    test_close_scene(&f);
}
END_TEST

/* A repeat derives children anew, but each face of a part shows the same ones; in a piece of the scope no segment ends.
 */
START_TEST(repeats_on_faces_are_alike)
{
    test_scene f = test_scene_of("start S\nrule S -> draw(1) size(1, 2, 1) components { side : repeat y 2 { A } } A\n"
                                 "rule A -> width(uniform(0, 1)) draw(1)\n");
    ck_assert_uint_eq(f.scene.n, 1 + 4 * 2 + 1);
    ck_assert_uint_eq(f.d.nnodes, 1 + 2 + 1);
    for (size_t i = 1; i < 9; i++) {
        const sg_primitive *p = item(&f, i, SG_PRIMITIVE_SEGMENT);
        ck_assert_uint_eq(p->node, i % 2 == 1 ? 1 : 2);
        ck_assert_double_eq(p->radius[0], p->radius[1]);
    }
    ck_assert_uint_eq(item(&f, 9, SG_PRIMITIVE_SEGMENT)->node, 3);
    ck_assert_double_eq(item(&f, 9, SG_PRIMITIVE_SEGMENT)->radius[0], 0.05);
    test_close_scene(&f);
}
END_TEST

START_TEST(extrusions_are_solids_unless_taken_over)
{
    test_scene f =
        test_scene_of("label t\nlabel r\nstart S\n"
                      "rule S -> [ size(2, 3, 0) extrude(0.5) set_label(t) ] [ size(2, 3, 0) extrude(-1) ] "
                      "[ size(2, 0, 3) extrude(4) set_label(r) hip_roof(45) ] [ size(1, 1, 0) extrude(1) t ]\n");
    ck_assert_uint_eq(f.scene.n, 5);
    check_point(item(&f, 0, SG_PRIMITIVE_BOX), 2, 3, 0.5, 2, 3, 0.5);
    ck_assert_str_eq(sg_grammar_symbol(f.g, f.scene.items[0].label)->name, "t");
    check_point(item(&f, 1, SG_PRIMITIVE_BOX), 0, 0, 0, 0, 0, -1);
    ck_assert_uint_eq(f.scene.items[1].label, SG_NONE);
    check_point(item(&f, 2, SG_PRIMITIVE_HIP), 1, 1, 1, 1, 5, 1);
    check_point(item(&f, 3, SG_PRIMITIVE_BOX), 2, 4, 3, 2, 4, 3);
    item(&f, 4, SG_PRIMITIVE_BOX);
    test_close_scene(&f);
}
END_TEST

/* The ridge follows the longer side; an overhang widens the roof. */
START_TEST(roofs_stand_on_faces_and_tops)
{
    test_scene f =
        test_scene_of("start S\nrule S -> size(6, 2, 4) gable_roof(45) hip_roof(45, 1) flat_roof() flat_roof(0.5) "
                      "size(4, 6, 0) gable_roof(45) gable_roof(-3) hip_roof(10, -2)\n");
    ck_assert_uint_eq(f.scene.n, 6);
    const sg_primitive *p = item(&f, 0, SG_PRIMITIVE_PRISM);
    ck_assert(p->ncorners == 3 && p->size[0] == 4 && p->size[2] == 6);
    check_corner(&f, p, 2, 0, 0, 4, 2); /* the ridge, over the long side */
    check_corner(&f, p, 2, 6, 6, 4, 2);
    p = item(&f, 1, SG_PRIMITIVE_HIP);
    check_point(p, 3, 3, 3, 2, 5, 2); /* ends of the ridge: half a width from the ends of the roof */
    check_point(p, 3, 3, 5, 4, 5, 2);
    check_point(item(&f, 2, SG_PRIMITIVE_POLYGON), 6, 4, 0, 6, 2, 0);
    check_point(item(&f, 3, SG_PRIMITIVE_BOX), 6, 4, 0.5, 6, 2.5, 0);
    p = item(&f, 4, SG_PRIMITIVE_PRISM); /* on a face that looks along z */
    check_corner(&f, p, 2, 0, 2, 6, 2);
    check_corner(&f, p, 2, 6, 2, 0, 2);
    item(&f, 5, SG_PRIMITIVE_POLYGON);
    test_close_scene(&f);
}
END_TEST

START_TEST(materials_are_named_coloured_or_those_of_labels)
{
    test_scene f = test_scene_of("label t #102030\nstart S\nrule S -> insert(box) t set_material(#405060) t "
                                 "set_material(brick) t insert(box)\n");
    static const uint32_t color[] = {0xc8c8c8, 0x102030, 0x405060, 0x102030, 0xc8c8c8};
    for (size_t i = 0; i < 5; i++) {
        const char *name;
        ck_assert_uint_eq(sg_scene_material(f.g, f.scene.items + i, &name), color[i]);
        ck_assert(i < 3 ? name == NULL : name != NULL && strcmp(name, "brick") == 0);
    }
    test_close_scene(&f);
    /* a declared one has its own colour, whatever label it is on */
    f = test_scene_of("material brick #a03020\nmaterial glass #a0c0d0\nlabel t #102030\nstart S\n"
                      "rule S -> set_material(brick) insert(box) t set_material(glass) t set_material(stone) t\n");
    static const uint32_t declared[] = {0xa03020, 0xa03020, 0xa0c0d0, 0x102030};
    static const char *const names[] = {"brick", "brick", "glass", "stone"};
    for (size_t i = 0; i < 4; i++) {
        const char *name;
        ck_assert_uint_eq(sg_scene_material(f.g, f.scene.items + i, &name), declared[i]);
        ck_assert_str_eq(name, names[i]);
    }
    test_close_scene(&f);
}
END_TEST

START_TEST(tied_siblings_are_placed_at_every_occurrence)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_open_scene("tied\nlabel a\nlabel b\nstart S\nrule S -> split x { A | b | A } repeat y 2 { A }\n"
                                   "rule A -> split y { a | b } sizes mean (0.3, 0.7) sd (0.1, 0.1)\n",
                                   (uint64_t)_i + 1);
    sg_scene_states states = {0};
    const sg_scene_state first = sg_scene_first_state(&f.opts);
    ck_ok(sg_scene_interpret_slice(&f.d, 0, &first, &f.opts, &f.scene, &states, &err));
    ck_assert_uint_eq(f.scene.n, 9);
    ck_assert_double_eq(f.scene.items[0].size[1], f.scene.items[3].size[1]);
    ck_assert_uint_eq(f.scene.items[0].node, f.scene.items[3].node);
    ck_assert_double_eq_tol(f.scene.items[3].frame.origin[0], 2.0 / 3, 1e-9);
    ck_assert(f.scene.items[5].node != f.scene.items[7].node); /* derived anew in a repeat */
    sg_scene_states_clear(&states);
    test_close_scene(&f);
}
END_TEST

/* The same facade by both interpreters: rectangles agree to the last bit but for the direction of y. */
START_TEST(label_scenes_agree)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f =
        test_open_scene("label t\nlabel u\nstart S\nrule S -> split x { 10 : t | ~1 : A | '0.2 : t | ~2 : A }\n"
                        "rule A -> split y { t | u | t } sizes mean (0.3, 0.4, 0.3) sd (0.2, 0.2, 0.2)\n",
                        (uint64_t)_i + 1);
    sg_label_scene labels = {0};
    f.opts = (sg_scene_opts){{100, 50, 0}, 1, 1000};
    ck_ok(sg_label_scene_interpret(&labels, &f.d, 100, 50, &err));
    ck_ok(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err));
    ck_assert_uint_eq(labels.nrects, f.scene.n);
    for (size_t i = 0; i < f.scene.n; i++) {
        const sg_primitive *p = item(&f, i, SG_PRIMITIVE_LABEL);
        size_t found = 0;
        for (size_t k = 0; k < labels.nrects; k++) {
            const sg_label_rect *r = labels.rects + k;
            found += r->label == p->label && fabs(r->x0 - p->frame.origin[0]) < 1e-9 &&
                     fabs(50 - r->y1 - p->frame.origin[1]) < 1e-9 && fabs(r->x1 - r->x0 - p->size[0]) < 1e-9 &&
                     fabs(r->y1 - r->y0 - p->size[1]) < 1e-9;
        }
        ck_assert_uint_eq(found, 1);
    }
    sg_label_scene_clear(&labels);
    test_close_scene(&f);
}
END_TEST

/* ---- slices, on random grammars ---- */

/* Where the primitives of place i end. */
static size_t end_of(const sg_scene *scene, const sg_scene_states *s, size_t i)
{
    const size_t next = i + s->places[i].length;
    return next < s->n ? s->places[next].first : scene->n;
}

/* Each place, interpreted by itself from its state, gives what stands in the whole, and its own places. */
static void check_slice(const test_scene *f, const sg_scene_states *whole, size_t i)
{
    sg_error err = SG_ERROR_INIT;
    const sg_scene_place *p = whole->places + i;
    sg_scene part = {0};
    sg_scene_states inner = {0};
    test_must_ok(sg_scene_interpret_slice(&f->d, p->node, &p->state, &f->opts, &part, &inner, &err));
    test_must(part.n == end_of(&f->scene, whole, i) - p->first);
    test_must(test_same_primitives(&part, &f->scene, p->first));
    test_must(inner.n == p->length && inner.places[0].parent == 0);
    for (size_t k = 0; k < inner.n; k++) {
        const sg_scene_place *a = inner.places + k, *b = p + k;
        test_must(a->node == b->node && a->length == b->length && a->first + p->first == b->first);
        test_must(sg_scene_state_equal(&a->state, &b->state));
        test_must(k == 0 || a->parent == b->parent);
    }
    sg_scene_clear(&part);
    sg_scene_states_clear(&inner);
}

static void check_primitive(const test_scene *f, const sg_primitive *p)
{
    test_must(p->kind < SG_PRIMITIVE_COUNT && p->node < f->d.nnodes);
    test_must(fabs(sg_vec_dot(p->frame.x, p->frame.y)) < 1e-12 && fabs(sg_vec_length(p->frame.z) - 1) < 1e-12);
    test_must(p->label == SG_NONE || sg_grammar_symbol(f->g, p->label)->kind == SG_SYMBOL_LABEL);
    test_must(p->kind != SG_PRIMITIVE_BOX || (p->size[0] > 0 && p->size[1] > 0 && p->size[2] > 0));
    test_must(p->kind != SG_PRIMITIVE_HIP || (p->size[2] >= p->size[0] && p->size[1] > 0));
    test_must(p->kind != SG_PRIMITIVE_SEGMENT || p->size[1] > 0);
}

START_TEST(the_whole_is_the_concatenation_of_slices)
{
    sg_error err = SG_ERROR_INIT;
    for (uint64_t k = 0; k < 20; k++) {
        test_scene f;
        if (!test_random_scene((uint64_t)_i * 20 + k + 1, &f))
            continue;
        sg_scene again = {0};
        sg_scene_states states = {0};
        const sg_scene_state first = sg_scene_first_state(&f.opts);
        ck_ok(sg_scene_interpret_slice(&f.d, 0, &first, &f.opts, &again, &states, &err));
        ck_assert_uint_eq(again.n, f.scene.n);
        test_must(test_same_primitives(&again, &f.scene, 0));
        for (size_t i = 0; i < f.scene.n; i++)
            check_primitive(&f, f.scene.items + i);
        const size_t step = 1 + states.n / 50;
        for (size_t i = 0; i < states.n; i += step)
            check_slice(&f, &states, i);
        sg_scene_clear(&again);
        sg_scene_states_clear(&states);
        test_close_scene(&f);
    }
}
END_TEST

/* The scene after a splice at `node`, from the old one: new slices where the node stands, the rest as it was. */
static void patch(const test_scene *f, const sg_scene_states *states, size_t node, ptrdiff_t grown, sg_scene *out)
{
    sg_error err = SG_ERROR_INIT;
    size_t at = 0;
    for (size_t i = 0; i <= states->n; i++) {
        if (i < states->n && states->places[i].node != node)
            continue;
        const size_t stop = i < states->n ? states->places[i].first : f->scene.n;
        const size_t begin = out->n;
        test_must_ok(sg_scene_append(out, &f->scene, at, stop - at, &err));
        for (size_t k = begin; k < out->n; k++)
            if (out->items[k].node > node)
                out->items[k].node = (uint32_t)((ptrdiff_t)out->items[k].node + grown);
        if (i == states->n)
            break;
        at = end_of(&f->scene, states, i);
        test_must_ok(sg_scene_interpret_slice(&f->d, node, &states->places[i].state, &f->opts, out, NULL, &err));
    }
}

/* What an incremental score relies on. */
START_TEST(a_splice_changes_its_slices_alone)
{
    for (uint64_t k = 0; k < 20; k++) {
        sg_error err = SG_ERROR_INIT;
        test_scene f;
        if (!test_random_scene((uint64_t)_i * 20 + k + 1, &f))
            continue;
        sg_scene old = {0}, fresh = {0}, patched = {0};
        sg_scene_states states = {0};
        const sg_scene_state first = sg_scene_first_state(&f.opts);
        ck_ok(sg_scene_interpret_slice(&f.d, 0, &first, &f.opts, &old, &states, &err));
        const size_t node = gsl_rng_uniform_int(f.rng, f.d.nnodes), before = f.d.nnodes;
        const sg_node n = f.d.nodes[node];
        sg_derivation slice;
        sg_derivation_init(&slice, f.g);
        const double *args = f.d.values + n.values;
        if (sg_derivation_sample_subtree(&slice, n.symbol, args, n.depth, f.rng, 3000, NULL) == SG_OK) {
            ck_ok(sg_derivation_splice(&f.d, node, &slice, &err));
            if (sg_scene_interpret(&f.d, &f.opts, &fresh, NULL) == SG_OK) {
                patch(&f, &states, node, (ptrdiff_t)f.d.nnodes - (ptrdiff_t)before, &patched);
                test_must(patched.n == fresh.n);
                test_must(test_same_primitives(&patched, &fresh, 0));
            }
        }
        sg_derivation_clear(&slice);
        sg_scene_clear(&old);
        sg_scene_clear(&fresh);
        sg_scene_clear(&patched);
        sg_scene_states_clear(&states);
        test_close_scene(&f);
    }
}
END_TEST

START_TEST(most_random_grammars_make_scenes)
{
    size_t good = 0, primitives = 0, kinds[SG_PRIMITIVE_COUNT] = {0};
    for (uint64_t seed = 1; seed <= 300; seed++) {
        test_scene f;
        if (!test_random_scene(seed, &f))
            continue;
        good++;
        primitives += f.scene.n;
        for (size_t i = 0; i < f.scene.n; i++)
            kinds[f.scene.items[i].kind]++;
        test_close_scene(&f);
    }
    ck_assert_msg(good > 200, "%zu of 300", good);
    ck_assert_uint_gt(primitives, 1000);
    ck_assert(kinds[SG_PRIMITIVE_SEGMENT] && kinds[SG_PRIMITIVE_BOX] && kinds[SG_PRIMITIVE_PRISM] &&
              kinds[SG_PRIMITIVE_HIP] && kinds[SG_PRIMITIVE_POLYGON] && kinds[SG_PRIMITIVE_LABEL] &&
              kinds[SG_PRIMITIVE_MESH]);
}
END_TEST

/* A chain much deeper than a C stack would bear, and frames that stay orthonormal all along it. */
START_TEST(deep_derivations_take_no_stack)
{
    test_scene f = test_scene_of(
        "limit depth 300000\nstart S\nrule S -> turn(7) pitch(5) draw(0.01) S\nrule S at limit -> insert(box)\n");
    ck_assert_uint_eq(f.scene.n, 300001 + 1);
    const sg_frame *last = &f.scene.items[f.scene.n - 1].frame;
    ck_assert_double_eq_tol(sg_vec_length(last->x), 1, 1e-12);
    ck_assert_double_eq_tol(sg_vec_dot(last->x, last->y), 0, 1e-12);
    test_close_scene(&f);
}
END_TEST

/* ---- statuses ---- */

static void check_fails(const char *text, size_t max_places, const char *sentence)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_open_scene(text, 1);
    f.opts.max_places = max_places;
    ck_assert_int_eq(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err), SG_ENUMERIC);
    ck_assert_msg(strstr(err.msg, sentence) != NULL, "%s", err.msg);
    ck_assert_ptr_nonnull(strstr(err.msg, ": error: deriving S"));
    ck_assert_uint_eq(f.scene.n, 0);
    test_close_scene(&f);
}

START_TEST(what_cannot_be_is_refused)
{
    check_fails("start S(0)\nrule S(a) -> draw(1) draw(1 / a)\n", 100, "no finite number");
    check_fails("start S(0)\nrule S(a) -> draw(1) turn(a / a)\n", 100, "no finite number");
    check_fails("start S\nrule S -> insert(box) scale(1e300, 1, 1) scale(1e300, 1, 1) insert(box)\n", 100,
                "beyond all numbers");
    check_fails("start S\nrule S -> insert(box) hip_roof(90)\n", 100, "90 degrees");
    check_fails("start S\nrule S -> a ~ normal(9, 1) split x { -a : insert(box) }\n", 100, "negative or no number");
    check_fails("start S\nrule S -> draw(1) draw(1) draw(1)\n", 3, "more symbols and primitives");
    check_fails("start S\nrule S -> A A A\nrule A -> draw(1)\n", 3, "more symbols and primitives");
    check_fails("label t\nstart S\nrule S -> repeat x 1000000 { insert(box) }\n", 1000, "more symbols and primitives");
}
END_TEST

START_TEST(arguments_are_checked_and_open_nodes_are_empty)
{
    sg_error err = SG_ERROR_INIT;
    test_scene f = test_scene_of("limit depth 1\nstart S\nrule S -> draw(1) A\nrule A -> draw(2) A\n");
    const sg_scene_state first = sg_scene_first_state(&f.opts);
    ck_assert_uint_eq(f.scene.n, 2); /* the second A is cut at the limit */
    ck_assert_int_eq(sg_scene_interpret_slice(&f.d, f.d.nnodes, &first, &f.opts, &f.scene, NULL, &err), SG_EINVAL);
    ck_assert_uint_eq(f.scene.n, 2);
    ck_ok(sg_derivation_open(&f.d, sg_grammar_start(f.g), NULL, 0, &err));
    ck_ok(sg_scene_interpret(&f.d, &f.opts, &f.scene, &err));
    ck_assert_uint_eq(f.scene.n, 0);
    sg_derivation none;
    sg_derivation_init(&none, f.g);
    ck_assert_int_eq(sg_scene_interpret(&none, &f.opts, &f.scene, &err), SG_EINVAL);
    test_close_scene(&f);
}
END_TEST

START_TEST(each_allocation_may_fail)
{
    test_scene f = test_open_scene("label t\nstart S\nrule S -> repeat x 20 { A } draw(1) components { side : A }\n"
                                   "rule A -> draw(1) t B\nrule B -> insert(sphere)\n",
                                   1);
    size_t failures = 0;
    for (bool failed = true; failed;) {
        sg_error err = SG_ERROR_INIT;
        sg_scene scene = {0};
        sg_scene_states states = {0};
        const sg_scene_state first = sg_scene_first_state(&f.opts);
        test_fail_allocation(failures);
        const sg_status st = sg_scene_interpret_slice(&f.d, 0, &first, &f.opts, &scene, &states, &err);
        failed = test_allocation_failed();
        ck_assert_int_eq(st, failed ? SG_ENOMEM : SG_OK);
        ck_assert(!failed || (scene.n == 0 && states.n == 0));
        failures += failed;
        sg_scene_clear(&scene);
        sg_scene_states_clear(&states);
    }
    ck_assert_uint_gt(failures, 6);
    test_close_scene(&f);
}
END_TEST

static Suite *scene_suite(void)
{
    Suite *s = suite_create("scene");
    TCase *known = tcase_create("known"), *slices = tcase_create("slices"), *faults = tcase_create("faults");
    tcase_add_test(known, the_turtle_turns_pitches_and_rolls);
    tcase_add_test(known, segments_share_radii_at_joints);
    tcase_add_test(known, tropism_bends_by_its_torque);
    tcase_add_test(known, scopes_are_moved_turned_and_sized);
    tcase_add_test(known, flat_scopes_are_rectangles);
    tcase_add_test(known, splits_cut_along_all_axes);
    tcase_add_test(known, components_are_faces);
    tcase_add_test(known, repeats_on_faces_are_alike);
    tcase_add_test(known, extrusions_are_solids_unless_taken_over);
    tcase_add_test(known, roofs_stand_on_faces_and_tops);
    tcase_add_test(known, materials_are_named_coloured_or_those_of_labels);
    tcase_add_loop_test(known, tied_siblings_are_placed_at_every_occurrence, 0, 4);
    tcase_add_loop_test(known, label_scenes_agree, 0, 8);
    tcase_add_loop_test(slices, the_whole_is_the_concatenation_of_slices, 0, 20);
    tcase_add_loop_test(slices, a_splice_changes_its_slices_alone, 0, 20);
    tcase_add_test(slices, most_random_grammars_make_scenes);
    tcase_add_test(slices, deep_derivations_take_no_stack);
    tcase_add_test(faults, what_cannot_be_is_refused);
    tcase_add_test(faults, arguments_are_checked_and_open_nodes_are_empty);
    tcase_add_test(faults, each_allocation_may_fail);
    suite_add_tcase(s, known);
    suite_add_tcase(s, slices);
    suite_add_tcase(s, faults);
    return s;
}

int main(void)
{
    return test_run(scene_suite());
}
