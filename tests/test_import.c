/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_import.c - label maps of other projects: one made-up input a kind, and every way that one can be bad. */
#include "config.h"

#include "core/file.h"
#include "data/import.h"
#include "image/classes.h"
#include "image/cv_image.h"
#include "image/png_io.h"
#include "tests/png_make.h"
#include "tests/support.h"
#include "tests/temp_folder.h"

#include <string.h>
#include <unistd.h>

enum { MAX_FAULTS = 16 };

typedef struct {
    temp_folder t;
    sg_import_opts o;
    sg_import_result result;
    sg_error err;
    size_t nfaults;
    char faults[MAX_FAULTS][1024];
    char source[300], dataset[300], table[300];
} fixture;

static void take_fault(void *user, const char *sentence)
{
    fixture *f = user;
    ck_assert_uint_lt(f->nfaults, MAX_FAULTS);
    snprintf(f->faults[f->nfaults++], sizeof f->faults[0], "%s", sentence);
}

/* src/ to fill, and classes wall 0, window 1, door 5, void 9. */
static fixture *make(sg_import_kind kind)
{
    fixture *f = calloc(1, sizeof *f);
    f->t = temp_folder_make();
    temp_mkdir(&f->t, "src");
    temp_text(&f->t, "c.tsv", "0\twall\t#ffff00\n1\twindow\t#ff0000\n5\tfront-door\t#0000ff\n9\tignore\t#000000\n");
    snprintf(f->source, sizeof f->source, "%s/src", f->t.path);
    snprintf(f->dataset, sizeof f->dataset, "%s/set", f->t.path);
    snprintf(f->table, sizeof f->table, "%s/c.tsv", f->t.path);
    f->o = (sg_import_opts)SG_IMPORT_OPTS_INIT;
    f->o.kind = kind;
    f->o.source = f->source;
    f->o.dataset = f->dataset;
    f->o.classes_file = f->table;
    return f;
}

static void finish(fixture *f)
{
    temp_folder_remove(&f->t);
    free(f);
}

static sg_status import(fixture *f)
{
    f->nfaults = 0;
    f->err = (sg_error)SG_ERROR_INIT;
    return sg_import_run(&f->o, take_fault, f, NULL, &f->result, &f->err);
}

static void import_well(fixture *f, size_t n)
{
    const sg_status st = import(f);
    ck_assert_msg(st == SG_OK, "%s; %s", f->err.msg, f->faults[0]);
    ck_assert_uint_eq(f->result.imported, n);
    ck_assert_uint_eq(f->result.found, n);
}

/* The only file is bad, and the sentence holds the word; no label map was made of it. */
static void import_badly(fixture *f, const char *word)
{
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_uint_eq(f->result.imported, 0);
    ck_assert_uint_eq(f->nfaults, 1);
    ck_assert_msg(strstr(f->faults[0], word) != NULL, "'%s' lacks '%s'", f->faults[0], word);
    ck_assert(!sg_file_exists(temp_path(&f->t, "set/labels/a.png")));
}

/* labels/NAME.png has this size and these indices, a digit a pixel. */
static void expect_map(fixture *f, const char *name, size_t width, size_t height, const char *digits)
{
    char file[64];
    sg_error err = SG_ERROR_INIT;
    sg_label_map m;
    snprintf(file, sizeof file, "set/labels/%s.png", name);
    ck_ok(sg_png_read_labels(temp_path(&f->t, file), &m, &err));
    ck_assert_uint_eq(m.width, width);
    ck_assert_uint_eq(m.height, height);
    ck_assert_uint_eq(strlen(digits), width * height);
    for (size_t i = 0; i < width * height; i++)
        ck_assert_msg(m.labels[i] == (uint8_t)(digits[i] - '0'), "%s: pixel %zu is %d, not %c", name, i,
                      (int)m.labels[i], digits[i]);
    sg_label_map_clear(&m);
}

static void add_photo(fixture *f, const char *file, size_t width, size_t height)
{
    sg_image im;
    ck_assert_int_eq(sg_image_create(width, height, &im, NULL), SG_OK);
    if (strstr(file, ".png") != NULL)
        ck_assert_int_eq(sg_png_write_rgb(temp_path(&f->t, file), &im, NULL), SG_OK);
    else
        ck_assert_int_eq(sg_photo_write_jpeg(temp_path(&f->t, file), &im, 90, NULL), SG_OK);
    sg_image_clear(&im);
}

/* ---- colours ---- */

static void add_colors(fixture *f, const char *file, size_t width, size_t height, const uint32_t *colors)
{
    sg_image im;
    ck_assert_int_eq(sg_image_create(width, height, &im, NULL), SG_OK);
    for (size_t i = 0; i < width * height; i++)
        sg_image_set(&im, i % width, i / width, colors[i]);
    ck_assert_int_eq(sg_png_write_rgb(temp_path(&f->t, file), &im, NULL), SG_OK);
    sg_image_clear(&im);
}

START_TEST(colours_become_indices)
{
    fixture *f = make(SG_IMPORT_RGB);
    add_colors(f, "src/a.png", 3, 2, (uint32_t[]){0xffff00, 0xff0000, 0x0000ff, 0x000000, 0xffff00, 0xffff00});
    add_colors(f, "src/b.PNG", 1, 1, (uint32_t[]){0x0000ff});
    temp_text(&f->t, "src/readme.txt", "passed over");
    import_well(f, 2);
    expect_map(f, "a", 3, 2, "015900");
    expect_map(f, "b", 1, 1, "5");
    sg_classes c;
    sg_image im;
    ck_assert_int_eq(sg_classes_read(temp_path(&f->t, "set/classes.tsv"), &c, NULL), SG_OK);
    ck_assert_uint_eq(c.nclasses, 3);
    ck_assert_uint_eq(c.class_of[9], SG_CLASS_IGNORE);
    sg_classes_clear(&c);
    /* the palette has the colours: what was written is a colour label map again */
    ck_assert_int_eq(sg_png_read_rgb(temp_path(&f->t, "set/labels/a.png"), &im, NULL), SG_OK);
    ck_assert_mem_eq(im.rgb, ((unsigned char[]){255, 255, 0, 255, 0, 0, 0, 0, 255, 0, 0, 0}), 12);
    sg_image_clear(&im);
    f->o.classes_file = NULL; /* now the data set has a table of its own */
    import_well(f, 2);
    finish(f);
}
END_TEST

START_TEST(unknown_colours_are_counted_together)
{
    fixture *f = make(SG_IMPORT_RGB);
    add_colors(f, "src/a.png", 3, 2, (uint32_t[]){0xffff00, 0xff0001, 0x0000fe, 0x0000fe, 0xffff00, 0x0000fe});
    import_badly(f, "2 colours are not in the class table: #0000fe (3 pixels, the first at column 2, row 0), "
                    "#ff0001 (1 pixel, the first at column 1, row 0)");
    f->o.tolerance = 0.99;
    import_badly(f, "2 colours");
    f->o.tolerance = 1;
    import_well(f, 1);
    expect_map(f, "a", 3, 2, "015505");
    f->o.tolerance = 0;
    uint32_t many[100];
    for (uint32_t i = 0; i < 100; i++)
        many[i] = 0x123400 + i;
    add_colors(f, "src/a.png", 10, 10, many);
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->faults[0], "100 colours are not in the class table: #123400 (1 pixel"));
    ck_assert_ptr_nonnull(strstr(f->faults[0], " and 92 more"));
    f->o.tolerance = 442; /* everything is near something: the nearest counts */
    many[0] = 0xff8000;
    add_colors(f, "src/a.png", 1, 1, many);
    import_well(f, 1);
    expect_map(f, "a", 1, 1, "0"); /* ff8000 lies nearer to ffff00 than to ff0000 by one step of green */
    finish(f);
}
END_TEST

START_TEST(colours_must_tell_classes_apart)
{
    fixture *f = make(SG_IMPORT_RGB);
    temp_text(&f->t, "c.tsv", "0\twall\t#ffff00\n1\twindow\t#ffff00\n");
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "indices 0 and 1 one colour, #ffff00"));
    f->o.kind = SG_IMPORT_PALETTE; /* here colours do not matter */
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "no file in it ends in .png"));
    finish(f);
}
END_TEST

/* ---- values ---- */

START_TEST(palettes_are_counted_from_their_base)
{
    fixture *f = make(SG_IMPORT_PALETTE);
    const unsigned char rows[2][4] = {{1, 2, 6, 0}, {2, 2, 1, 10}};
    f->o.base = 1;
    png_make(temp_path(&f->t, "src/a.png"), 4, 2, 8, PNG_COLOR_TYPE_PALETTE, 0, rows[0], 4);
    png_make(temp_path(&f->t, "src/b.png"), 4, 2, 8, PNG_COLOR_TYPE_GRAY, 1, rows[0], 4);
    const unsigned char bits[1][1] = {{0x6c}}; /* 2 bits a pixel: 1 2 3 0 */
    png_make(temp_path(&f->t, "src/c.png"), 2, 1, 2, PNG_COLOR_TYPE_GRAY, 0, bits[0], 1);
    import_well(f, 3);
    expect_map(f, "a", 4, 2, "01591109");
    expect_map(f, "b", 4, 2, "01591109");
    expect_map(f, "c", 2, 1, "01");
    f->o.base = 0;
    unlink(temp_path(&f->t, "src/b.png"));
    unlink(temp_path(&f->t, "src/c.png"));
    unlink(temp_path(&f->t, "set/labels/a.png"));
    import_badly(f, "3 labels are not in the class table: 2 (3 pixels, the first at column 1, row 0), 6 (1 pixel, the "
                    "first at column 2, row 0), 10 (1 pixel");
    temp_text(&f->t, "d.tsv", "0\twall\t#ffff00\n1\twindow\t#ff0000\n5\tdoor\t#0000ff\n");
    f->o.classes_file = temp_path(&f->t, "d.tsv"); /* nothing to make void of */
    f->o.dataset = temp_path(&f->t, "other");
    f->o.base = 1;
    import_badly(f, "2 labels are not in the class table: 0 (1 pixel, the first at column 3, row 0), 10 (1 pixel");
    finish(f);
}
END_TEST

static const struct {
    sg_import_kind kind;
    int base;
    const char *text;
    size_t width, height;
    const char *digits;
} texts[] = {
    {SG_IMPORT_MATRIX, 0, "0 1 5\n9 0 1\n", 3, 2, "015901"},
    {SG_IMPORT_MATRIX, 0, "0,1,5\r\n9,0,1", 3, 2, "015901"},
    {SG_IMPORT_MATRIX, 0, "\t0\t1 ,\t5\n  9; 0;1;\n\n", 3, 2, "015901"},
    {SG_IMPORT_MATRIX, 1, "-1 1 2\n 6 0 10\n", 3, 2, "901599"},
    {SG_IMPORT_MATRIX, 0, "# a remark\n0.000e+00 1.0 5.\n0 0 +1\n", 3, 2, "015001"},
    {SG_IMPORT_MATRIX, 0, "1", 1, 1, "1"},
    {SG_IMPORT_DIGITS, 0, "0159\n1111\n", 4, 2, "01591111"},
    {SG_IMPORT_DIGITS, 1, "1260\r\n2222  \r\n", 4, 2, "01591111"},
    {SG_IMPORT_DIGITS, 0, "5", 1, 1, "5"},
};

START_TEST(texts_become_maps)
{
    fixture *f = make(texts[_i].kind);
    f->o.base = texts[_i].base;
    temp_text(&f->t, "src/a.txt", texts[_i].text);
    import_well(f, 1);
    expect_map(f, "a", texts[_i].width, texts[_i].height, texts[_i].digits);
    finish(f);
}
END_TEST

static const struct {
    sg_import_kind kind;
    const char *text, *word;
} bad_texts[] = {
    {SG_IMPORT_MATRIX, "0 1 5\n9 0\n", "a.txt:2:4: error: 2 values, but the rows before have 3"},
    {SG_IMPORT_MATRIX, "0 1\n9 0 1\n", "a.txt:2:5: error: more than the 2 values"},
    {SG_IMPORT_MATRIX, "0 x 1\n", "a.txt:1:3: error: 'x' is no whole number"},
    {SG_IMPORT_MATRIX, "0 0.5 1\n", "a.txt:1:3: error: '0.5' is no whole number"},
    {SG_IMPORT_MATRIX, "0,,1\n", "a.txt:1:3: error: '' is no whole number"},
    {SG_IMPORT_MATRIX, "0 nan\n", "'nan' is no whole number"},
    {SG_IMPORT_MATRIX, "0 1e30\n", "'1e30' is no whole number"},
    {SG_IMPORT_MATRIX, "0 1x\n", "a.txt:1:4: error: 'x' after a number"},
    {SG_IMPORT_MATRIX, "0 7 300\n7 7 -1\n",
     "2 labels are not in the class table: 7 (3 pixels, the first at column 1, row 0), 300 (1 pixel, the first at column "
     "2, row 0)"},
    {SG_IMPORT_MATRIX, "", "no values"},
    {SG_IMPORT_DIGITS, "01a\n", "a.txt:1:3: error: 'a' is no digit"},
    {SG_IMPORT_DIGITS, "0 1\n", "a.txt:1:2: error: ' ' is no digit"},
    {SG_IMPORT_DIGITS, "011\n01\n", "a.txt:2:3: error: 2 values"},
    {SG_IMPORT_DIGITS, "01\n011\n", "a.txt:2:3: error: more than the 2"},
    {SG_IMPORT_DIGITS, "013\n", "label is not in the class table: 3"},
    {SG_IMPORT_DIGITS, "\n\n", "no values"},
};

START_TEST(bad_texts_are_refused_with_their_place)
{
    fixture *f = make(bad_texts[_i].kind);
    temp_text(&f->t, "src/a.txt", bad_texts[_i].text);
    import_badly(f, bad_texts[_i].word);
    finish(f);
}
END_TEST

START_TEST(rows_have_a_limit)
{
    fixture *f = make(SG_IMPORT_DIGITS);
    const size_t n = SG_IMAGE_MAX_SIDE + 1;
    char *row = malloc(n);
    memset(row, '1', n);
    temp_write(&f->t, "src/a.txt", row, n);
    import_badly(f, "more than the 32768 values that a row may have");
    temp_write(&f->t, "src/a.txt", "01\0", 3);
    import_badly(f, "NUL");
    free(row);
    finish(f);
}
END_TEST

/* ---- LabelMe ---- */

static const char *const shapes_file =
    "{\"version\": \"5\", \"imageWidth\": 6, \"imageHeight\": 4, \"imageData\": null, \"shapes\": [\n"
    " {\"label\": \"window\", \"points\": [[1, 0], [5, 0], [5, 3], [1, 3]], \"shape_type\": \"polygon\"},\n"
    " {\"label\": \"front door\", \"points\": [[4, 4], [2, 2.0]], \"shape_type\": \"rectangle\"},\n"
    " {\"label\": \"ignore\", \"points\": [[0, 3], [1, 3], [1, 4], [0, 4]]}]}\n";

START_TEST(shapes_are_drawn_in_their_order)
{
    fixture *f = make(SG_IMPORT_LABELME);
    f->o.background = "wall";
    temp_text(&f->t, "src/a.json", shapes_file);
    import_well(f, 1);
    expect_map(f, "a", 6, 4, "011110011110015510905500");
    f->o.background = NULL; /* then it is void */
    temp_text(&f->t, "src/a.json",
              "{\"imageWidth\": 20, \"imageHeight\": 20, \"shapes\": [{\"label\": \"window\", \"shape_type\": "
              "\"circle\", \"points\": [[10, 10], [16, 10]]}]}");
    import_well(f, 1);
    sg_label_map m;
    size_t n = 0;
    ck_assert_int_eq(sg_png_read_labels(temp_path(&f->t, "set/labels/a.png"), &m, NULL), SG_OK);
    for (size_t i = 0; i < 400; i++) {
        ck_assert(m.labels[i] == 1 || m.labels[i] == 9);
        n += m.labels[i] == 1;
    }
    ck_assert_uint_ge(n, 106); /* pi r^2 is 113 */
    ck_assert_uint_le(n, 120);
    sg_label_map_clear(&m);
    finish(f);
}
END_TEST

START_TEST(sizes_come_from_the_photograph_when_a_file_lacks_them)
{
    fixture *f = make(SG_IMPORT_LABELME);
    f->o.background = "wall";
    temp_text(&f->t, "src/a.json", "{\"imageWidth\": null, \"shapes\": []}");
    import_badly(f, "no imageWidth in it, and no photograph");
    add_photo(f, "src/a.jpg", 3, 2);
    f->o.images = f->source;
    import_well(f, 1);
    expect_map(f, "a", 3, 2, "000000");
    ck_assert(sg_file_exists(temp_path(&f->t, "set/images/a.jpg")));
    finish(f);
}
END_TEST

static const struct {
    const char *text, *word;
} bad_shapes[] = {
    {"{\"imageWidth\": 2,\n \"imageHeight\": 2, \"shapes\": [", "a.json:2:"},
    {"", "a.json:1:0: error"},
    {"[]", "no imageWidth"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2}", "no list of shapes"},
    {"{\"imageWidth\": 0, \"imageHeight\": 2, \"shapes\": []}", "imageWidth is no number of pixels"},
    {"{\"imageWidth\": 2, \"imageHeight\": 99999, \"shapes\": []}", "imageHeight is no number of pixels"},
    {"{\"imageWidth\": 32768, \"imageHeight\": 32768, \"shapes\": []}", "too many"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [7]}", "shape 1: no label"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\"}]}", "shape 1: no points"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\", \"points\": []}]}", "no points"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\", \"points\": [[1,2],[3]]}]}",
     "point 2 is no pair"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\", \"points\": [[1,2],[3,\"x\"]]}]}",
     "point 2 is no pair"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\", \"points\": [[1,2],[3,4]]}]}",
     "shape 1: a polygon of 2 corners"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\", \"points\": [[1,2],[3,4],[1e300,0]]}]}",
     "corner at 1e+300"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"wall\", \"points\": [[1,2],[3,4]], "
     "\"shape_type\": \"line\"}]}",
     "a line of 2 points is no area"},
    {"{\"imageWidth\": 2, \"imageHeight\": 2, \"shapes\": [{\"label\": \"cat\", \"points\": [[1,2]]}, {\"label\": "
     "\"dog\", \"points\": [[1,2]]}, {\"label\": \"dog\", \"points\": [[1,2]]}]}",
     "2 class names are not in the class table: 'dog' (2 shapes), 'cat' (1 shape)"},
};

START_TEST(bad_annotations_are_refused)
{
    fixture *f = make(SG_IMPORT_LABELME);
    temp_text(&f->t, "src/a.json", bad_shapes[_i].text);
    import_badly(f, bad_shapes[_i].word);
    finish(f);
}
END_TEST

START_TEST(the_background_must_be_a_class)
{
    fixture *f = make(SG_IMPORT_LABELME);
    f->o.background = "sky";
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "'sky'"));
    f->o.background = NULL;
    temp_text(&f->t, "c.tsv", "0\twall\t#ffff00\n");
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "'ignore'"));
    finish(f);
}
END_TEST

/* ---- the import as a whole ---- */

START_TEST(photographs_are_copied_by_name)
{
    fixture *f = make(SG_IMPORT_DIGITS);
    char images[300];
    size_t n, k;
    temp_mkdir(&f->t, "photos");
    snprintf(images, sizeof images, "%s/photos", f->t.path);
    f->o.images = images;
    f->o.suffix = "_labels";
    for (const char *p = "abcdef"; *p != '\0'; p++) {
        char file[32];
        snprintf(file, sizeof file, "src/%c%s.txt", *p, *p == 'b' ? "" : "_labels");
        temp_text(&f->t, file, "01\n10\n55\n");
    }
    add_photo(f, "photos/a.jpg", 2, 3);
    add_photo(f, "photos/b.png", 2, 3);
    add_photo(f, "photos/c.JPEG", 2, 3);
    add_photo(f, "photos/d.jpg", 3, 2); /* lies across */
    add_photo(f, "photos/e.jpg", 2, 3);
    unsigned char *bytes = temp_read(&f->t, "photos/e.jpg", &n);
    temp_write(&f->t, "photos/e.jpg", bytes, n - 30);
    free(bytes);
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_uint_eq(f->result.found, 6);
    ck_assert_uint_eq(f->result.imported, 3);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "3 of 6 files"));
    ck_assert_uint_eq(f->nfaults, 3);
    ck_assert_ptr_nonnull(strstr(f->faults[0], "d_labels.txt: 2 x 3 pixels, but"));
    ck_assert_ptr_nonnull(strstr(f->faults[1], "photos/e.jpg: the file is truncated"));
    ck_assert_ptr_nonnull(strstr(f->faults[2], "there is no photograph"));
    ck_assert(sg_file_exists(temp_path(&f->t, "set/images/b.png")));
    ck_assert(sg_file_exists(temp_path(&f->t, "set/images/c.jpg")));
    ck_assert(!sg_file_exists(temp_path(&f->t, "set/images/d.jpg")));
    ck_assert(!sg_file_exists(temp_path(&f->t, "set/labels/d.png")));
    expect_map(f, "c", 2, 3, "011055");
    bytes = temp_read(&f->t, "photos/a.jpg", &n);
    unsigned char *copy = temp_read(&f->t, "set/images/a.jpg", &k);
    ck_assert_uint_eq(n, k);
    ck_assert_mem_eq(bytes, copy, n);
    free(bytes);
    free(copy);
    finish(f);
}
END_TEST

START_TEST(inputs_are_never_overwritten)
{
    fixture *f = make(SG_IMPORT_RGB);
    char images[300];
    size_t n, k;
    temp_mkdir(&f->t, "set");
    temp_mkdir(&f->t, "set/labels");
    temp_mkdir(&f->t, "set/images");
    add_colors(f, "set/labels/a.png", 1, 1, (uint32_t[]){0xff0000});
    unsigned char *before = temp_read(&f->t, "set/labels/a.png", &n);
    snprintf(f->source, sizeof f->source, "%s/set/labels", f->t.path);
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->faults[0], "set/labels/a.png: the import would overwrite its own input"));
    unsigned char *after = temp_read(&f->t, "set/labels/a.png", &k);
    ck_assert_uint_eq(n, k);
    ck_assert_mem_eq(before, after, n);
    free(before);
    free(after);
    snprintf(f->source, sizeof f->source, "%s/src", f->t.path);
    add_colors(f, "src/a.png", 1, 1, (uint32_t[]){0xff0000});
    add_photo(f, "set/images/a.jpg", 1, 1);
    snprintf(images, sizeof images, "%s/set/images", f->t.path);
    f->o.images = images;
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->faults[0], "set/images/a.jpg: the import would overwrite its own input"));
    /* the label map itself is not taken for its photograph */
    snprintf(images, sizeof images, "%s/src", f->t.path);
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->faults[0], "there is no photograph"));
    finish(f);
}
END_TEST

START_TEST(a_data_set_keeps_its_class_table)
{
    fixture *f = make(SG_IMPORT_DIGITS);
    temp_text(&f->t, "src/a.txt", "01\n");
    import_well(f, 1);
    temp_text(&f->t, "c.tsv", "1\twall\t#ffff00\n0\twindow\t#ff0000\n5\tfront-door\t#0000ff\n9\tignore\t#000000\n");
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "another class table"));
    f->o.dataset = temp_path(&f->t, "fresh");
    f->o.classes_file = NULL;
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "no class table yet"));
    f->o.classes_file = temp_path(&f->t, "none.tsv");
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert(!sg_folder_exists(temp_path(&f->t, "fresh")));
    finish(f);
}
END_TEST

START_TEST(single_files_and_bad_names)
{
    fixture *f = make(SG_IMPORT_DIGITS);
    temp_text(&f->t, "src/one.map", "01\n");
    snprintf(f->source, sizeof f->source, "%s/src/one.map", f->t.path);
    import_well(f, 1); /* a file that is named may have any ending */
    expect_map(f, "one", 2, 1, "01");
    snprintf(f->source, sizeof f->source, "%s/src", f->t.path);
    temp_text(&f->t, "src/a..b.txt", "01\n");
    import_badly(f, "cannot be a name");
    unlink(temp_path(&f->t, "src/a..b.txt"));
    temp_text(&f->t, "src/b.csv", "01\n");
    temp_text(&f->t, "src/b.txt", "00\n");
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_uint_eq(f->result.imported, 1);
    ck_assert_ptr_nonnull(strstr(f->faults[0], "b.txt:"));
    ck_assert_ptr_nonnull(strstr(f->faults[0], "b.csv has the same name"));
    expect_map(f, "b", 2, 1, "01");
    snprintf(f->source, sizeof f->source, "%s/none", f->t.path);
    ck_assert_int_eq(import(f), SG_EINPUT);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "No such file"));
    finish(f);
}
END_TEST

static bool stop_at_once(sg_progress *p)
{
    (void)p;
    return true;
}

START_TEST(an_import_can_fail_and_be_stopped)
{
    fixture *f = make(SG_IMPORT_DIGITS);
    temp_text(&f->t, "src/a.txt", "01\n");
    f->o.dataset = "/dev/null/set";
    ck_assert_int_eq(import(f), SG_EIO);
    ck_assert_ptr_nonnull(strstr(f->err.msg, "/dev/null"));
    sg_progress p = {NULL, stop_at_once, NULL};
    f->o.dataset = f->dataset;
    ck_assert_int_eq(sg_import_run(&f->o, NULL, NULL, &p, &f->result, &f->err), SG_STOPPED);
    ck_assert(!sg_folder_exists(f->dataset));
    finish(f);
}
END_TEST

/* Bad PNG files of every sort, for both kinds that read them. */
START_TEST(bad_pngs_are_refused)
{
    fixture *f = make(_i != 0 ? SG_IMPORT_RGB : SG_IMPORT_PALETTE);
    const unsigned char rows[3][9] = {{0, 1, 5, 0, 1, 5, 0, 1, 5}, {1, 1, 1, 1, 1, 1, 1, 1, 1}, {0}};
    size_t n;
    png_make(temp_path(&f->t, "src/a.png"), 9, 3, 8, PNG_COLOR_TYPE_PALETTE, 0, rows[0], 9);
    unsigned char *bytes = temp_read(&f->t, "src/a.png", &n);
    for (size_t k = 0; k < n; k += k < 64 || k + 64 > n ? 1 : 41) {
        temp_write(&f->t, "src/a.png", bytes, k);
        import_badly(f, k == 0 ? "empty" : "truncated");
    }
    bytes[n - 14] ^= 1; /* CRC of the pixels */
    temp_write(&f->t, "src/a.png", bytes, n);
    import_badly(f, "CRC");
    bytes[n - 14] ^= 1;
    bytes[16] = 1; /* 16 million wide */
    temp_write(&f->t, "src/a.png", bytes, n);
    import_badly(f, "too many");
    free(bytes);
    if (_i == 0) {
        const unsigned char pixel[8] = {0};
        png_make(temp_path(&f->t, "src/a.png"), 1, 1, 16, PNG_COLOR_TYPE_GRAY, 0, pixel, 8);
        import_badly(f, "16 bits");
        png_make(temp_path(&f->t, "src/a.png"), 1, 1, 8, PNG_COLOR_TYPE_RGB, 0, pixel, 8);
        import_badly(f, "RGB");
    }
    finish(f);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("import");
    TCase *tc = tcase_create("import");
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, colours_become_indices);
    tcase_add_test(tc, unknown_colours_are_counted_together);
    tcase_add_test(tc, colours_must_tell_classes_apart);
    tcase_add_test(tc, palettes_are_counted_from_their_base);
    tcase_add_loop_test(tc, texts_become_maps, 0, sizeof texts / sizeof texts[0]);
    tcase_add_loop_test(tc, bad_texts_are_refused_with_their_place, 0, sizeof bad_texts / sizeof bad_texts[0]);
    tcase_add_test(tc, rows_have_a_limit);
    tcase_add_test(tc, shapes_are_drawn_in_their_order);
    tcase_add_test(tc, sizes_come_from_the_photograph_when_a_file_lacks_them);
    tcase_add_loop_test(tc, bad_annotations_are_refused, 0, sizeof bad_shapes / sizeof bad_shapes[0]);
    tcase_add_test(tc, the_background_must_be_a_class);
    tcase_add_test(tc, photographs_are_copied_by_name);
    tcase_add_test(tc, inputs_are_never_overwritten);
    tcase_add_test(tc, a_data_set_keeps_its_class_table);
    tcase_add_test(tc, single_files_and_bad_names);
    tcase_add_test(tc, an_import_can_fail_and_be_stopped);
    tcase_add_loop_test(tc, bad_pngs_are_refused, 0, 2);
    suite_add_tcase(suite, tc);
    return test_run(suite);
}
