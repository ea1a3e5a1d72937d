/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sample_output.c - the files that sample-grammar writes for a sample. */
#include "config.h"

#include "sample_job.h"

#include "core/file.h"
#include "image/png_io.h"
#include "parse/scene_lattice.h"
#include "scene/derivation_json.h"
#include "scene/label_svg.h"
#include "scene/mesh_gltf.h"
#include "scene/mesh_obj.h"
#include "scene/render.h"

#include <string.h>

static bool is_input(const char *input, const char *output)
{
    return input != NULL && sg_file_exists(output) && sg_file_same(input, output);
}

sg_status sample_check_not_input(const sample_job *j, const char *path, sg_error *err)
{
    bool grammar = is_input(j->opts->grammar, path);
    for (size_t i = 0; i < sg_grammar_import_count(j->g) && !grammar; i++)
        grammar = is_input(sg_grammar_import(j->g, i), path);
    if (grammar || is_input(j->opts->from, path))
        return SG_FAIL(err, SG_EINVAL, "%s: %s read; choose another folder or --name", path,
                       grammar ? "this is a grammar that is" : "these are the derivations that are");
    if (j->assets != NULL && sg_assets_has_file(j->assets, path))
        return SG_FAIL(err, SG_EINVAL, "%s: this mesh, or its materials, is read; choose another folder or --name", path);
    return SG_OK;
}

static sg_status path_of(const sample_job *j, const char *folder, size_t i, const char *suffix, char *path, size_t size,
                         sg_error *err)
{
    const int n = snprintf(path, size, "%s/%s%s-%04zu%s", j->opts->folder, folder, j->name, i + 1, suffix);
    if (n < 0 || (size_t)n >= size)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
    return sample_check_not_input(j, path, err);
}

static sg_status write_labels(const sample_job *j, const sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    sg_label_map map;
    SG_TRY(path_of(j, j->opts->dataset ? "labels/" : "", i, ".png", path, sizeof path, err));
    SG_TRY(sg_label_map_create(j->opts->width, j->opts->height, &map, err));
    sg_label_scene_raster(&w->scene, j->value_of, &map);
    const sg_status st = sg_png_write_labels(path, &map, j->classes.index_colors, j->classes.nclasses, err);
    sg_label_map_clear(&map);
    return st;
}

static sg_status write_rgb(const sample_job *j, const sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    sg_image im;
    const bool dataset = j->opts->dataset;
    SG_TRY(path_of(j, dataset ? "images/" : "", i, dataset ? ".png" : ".rgb.png", path, sizeof path, err));
    SG_TRY(sg_image_create(j->opts->width, j->opts->height, &im, err));
    sg_label_scene_paint(&w->scene, j->g, &im);
    const sg_status st = sg_png_write_rgb(path, &im, err);
    sg_image_clear(&im);
    return st;
}

/* A text file, by one of the writers below. */
static sg_status write_text(const sample_job *j, sample_worker *w, size_t i, const char *suffix,
                            sg_status (*write)(const sample_job *, sample_worker *, FILE *, sg_error *), sg_error *err)
{
    char path[4096];
    sg_output out;
    SG_TRY(path_of(j, "", i, suffix, path, sizeof path, err));
    SG_TRY(sg_output_open(&out, path, err));
    const sg_status st = write(j, w, out.fp, err);
    if (st == SG_OK)
        return sg_output_commit(&out, err);
    sg_output_discard(&out);
    return st;
}

static sg_status print_svg(const sample_job *j, sample_worker *w, FILE *fp, sg_error *err)
{
    return sg_label_svg_write(&w->scene, j->g, fp, err);
}

static sg_status print_lattice(const sample_job *j, sample_worker *w, FILE *fp, sg_error *err)
{
    sg_lattice l;
    sg_arena_reset(w->arena);
    SG_TRY(sg_lattice_of_scene(&w->scene, j->g, j->opts->width, j->opts->height, w->arena, &l, err));
    return sg_lattice_write(&l, fp, err);
}

static sg_status print_derivation(const sample_job *j, sample_worker *w, FILE *fp, sg_error *err)
{
    SG_TRY(sg_derivation_write_json(&w->d, (double)j->opts->width, (double)j->opts->height, fp, err));
    fputc('\n', fp);
    return SG_OK;
}

sg_mesh_opts sample_mesh_opts(const sample_job *j)
{
    sg_mesh_opts mesh = SG_MESH_OPTS_INIT;
    mesh.detail = (unsigned)j->opts->detail;
    mesh.assets = j->assets;
    return mesh;
}

static sg_status make_mesh(const sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    const sg_mesh_opts mesh = sample_mesh_opts(j);
    sg_scene_opts scene = SG_SCENE_OPTS_INIT;
    memcpy(scene.size, j->opts->scope, sizeof scene.size);
    SG_TRY(sg_scene_interpret(&w->d, &scene, &w->space, err));
    SG_TRY(sg_mesh_from_scene(&w->space, &mesh, &w->mesh, err));
    j->stats[i].faces = w->mesh.nfaces;
    return SG_OK;
}

/* The materials stand beside it, and are an output too. */
static sg_status write_obj(const sample_job *j, const sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    SG_TRY(path_of(j, "", i, ".mtl", path, sizeof path, err));
    SG_TRY(path_of(j, "", i, ".obj", path, sizeof path, err));
    return sg_mesh_obj_save(&w->mesh, path, err);
}

static sg_status write_gltf(const sample_job *j, const sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    SG_TRY(path_of(j, "", i, ".glb", path, sizeof path, err));
    return sg_mesh_gltf_save(&w->mesh, path, err);
}

static sg_status render(const sample_job *j, sample_worker *w, size_t i, size_t width, size_t height, sg_image *im,
                        sg_error *err)
{
    enum { SMALL = 20000 /* faces */ };
    sg_mesh_opts mesh = sample_mesh_opts(j);
    sg_render_opts opts = SG_RENDER_OPTS_INIT;
    opts.threads = j->render_threads;
    opts.progress = j->progress;
    mesh.radial *= j->stats[i].faces < SMALL ? 2 : 1; /* what is small can afford to be round */
    SG_TRY(sg_image_create(width, height, im, err));
    const sg_status st = sg_render_scene(&w->space, &mesh, &j->opts->view, &opts, &w->mesh, im, err);
    if (st != SG_OK)
        sg_image_clear(im);
    return st;
}

/* A picture that is as large as those on the sheet goes there too. */
static sg_status write_render(const sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    sg_image im;
    SG_TRY(path_of(j, "", i, ".render.png", path, sizeof path, err));
    SG_TRY(render(j, w, i, j->opts->width, j->opts->height, &im, err));
    const sg_status st = sg_png_write_rgb(path, &im, err);
    if (st == SG_OK && j->opts->in_space && i < j->nthumbs && im.width == j->thumb_width && im.height == j->thumb_height)
        j->thumbs[i] = im;
    else
        sg_image_clear(&im);
    return st;
}

/* Models in space are drawn once their mesh is written: drawing may change it. */
static sg_status write_space(const sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    const bool on_sheet = j->opts->in_space && i < j->nthumbs;
    if (!(j->opts->formats & (SAMPLE_OBJ | SAMPLE_GLTF | SAMPLE_RENDER)) && !on_sheet)
        return SG_OK;
    SG_TRY(make_mesh(j, w, i, err));
    if (j->opts->formats & SAMPLE_OBJ)
        SG_TRY(write_obj(j, w, i, err));
    if (j->opts->formats & SAMPLE_GLTF)
        SG_TRY(write_gltf(j, w, i, err));
    if (j->opts->formats & SAMPLE_RENDER)
        SG_TRY(write_render(j, w, i, err));
    if (on_sheet && j->thumbs[i].rgb == NULL)
        SG_TRY(render(j, w, i, j->thumb_width, j->thumb_height, j->thumbs + i, err));
    return SG_OK;
}

static sg_status write_stored(const sample_job *j, const sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    SG_TRY(path_of(j, "", i, ".sgd", path, sizeof path, err));
    return sg_derivation_file_write(path, j->g, &w->d, 1, err);
}

static sg_status write_tree(const sample_job *j, const sample_worker *w, size_t i, sg_error *err)
{
    char path[4096];
    sg_output out;
    sg_image im;
    sg_tree_picture p;
    SG_TRY(sg_tree_picture_make(&w->d, &j->opts->tree, &p, err));
    sg_status st = path_of(j, "", i, ".tree.svg", path, sizeof path, err);
    if (st == SG_OK)
        st = sg_output_open(&out, path, err);
    if (st == SG_OK)
        st = sg_output_end(&out, sg_tree_picture_svg(&p, out.fp, err), err);
    if (st == SG_OK)
        st = path_of(j, "", i, ".tree.png", path, sizeof path, err);
    if (st == SG_OK)
        st = sg_tree_picture_paint(&p, 2, &im, err);
    sg_tree_picture_clear(&p);
    if (st != SG_OK)
        return st;
    st = sg_png_write_rgb(path, &im, err);
    sg_image_clear(&im);
    return st;
}

sg_status sample_write(const sample_job *j, sample_worker *w, size_t i, sg_error *err)
{
    const unsigned f = j->opts->formats;
    if (f & SAMPLE_LABELS)
        SG_TRY(write_labels(j, w, i, err));
    if (f & SAMPLE_RGB)
        SG_TRY(write_rgb(j, w, i, err));
    if (f & SAMPLE_SVG)
        SG_TRY(write_text(j, w, i, ".svg", print_svg, err));
    if (f & SAMPLE_LAT)
        SG_TRY(write_text(j, w, i, ".lat", print_lattice, err));
    if (f & SAMPLE_JSON)
        SG_TRY(write_text(j, w, i, ".json", print_derivation, err));
    SG_TRY(write_space(j, w, i, err));
    if (f & SAMPLE_DERIVATION)
        SG_TRY(write_stored(j, w, i, err));
    if (f & SAMPLE_TREE)
        SG_TRY(write_tree(j, w, i, err));
    return SG_OK;
}

sg_status sample_make_folders(const sample_job *j, sg_error *err)
{
    char path[4096];
    if (j->opts->folder == NULL)
        return SG_OK;
    SG_TRY(sg_folder_create(j->opts->folder, err));
    static const struct {
        unsigned format;
        const char *name;
    } folders[] = {{SAMPLE_LABELS, "labels"}, {SAMPLE_RGB, "images"}};
    for (size_t k = 0; k < 2 && j->opts->dataset; k++) {
        if (!(j->opts->formats & folders[k].format))
            continue;
        if (snprintf(path, sizeof path, "%s/%s", j->opts->folder, folders[k].name) >= (int)sizeof path)
            return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
        SG_TRY(sg_folder_create(path, err));
    }
    if (!(j->opts->formats & SAMPLE_LABELS))
        return SG_OK;
    if (snprintf(path, sizeof path, "%s/classes.tsv", j->opts->folder) >= (int)sizeof path)
        return SG_FAIL(err, SG_EIO, "%s: the path is too long", j->opts->folder);
    SG_TRY(sample_check_not_input(j, path, err));
    return sg_classes_write(path, &j->classes, err);
}

