/* SPDX-License-Identifier: GPL-3.0-or-later */
/* render.c - the mean of pictures with one sample in each pixel. */
#include "scene/render.h"

#include "scene/shade.h"
#include "scene/srgb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More triangles than this, and light comes from fewer directions. */
static const size_t many_triangles = 60000;
/* Light reflected by what is white. */
static const double whitest = 0.9;

typedef struct {
    const sg_mesh *mesh, *casts;
    const sg_camera *camera;
    const sg_render_opts *opts;
    sg_lights lights;
    sg_ball ball;
    double ground; /* height */
    double background[3], on_ground[3]; /* colour, and the light on open ground */
    double (*materials)[3];
    size_t sky, sun; /* directions for each sample */
    size_t width, height;
    float *sum; /* [height][width][3] */
    sg_error *err;
} painter;

/* Work space of one thread, and a picture of one sample in each pixel. */
typedef struct {
    sg_raster raster;
    sg_light_maps maps;
    sg_shade_points seen;
    sg_error err;
} easel;

static void place_sun(painter *p)
{
    const double degree = 0.017453292519943295, *right = p->camera->frame.x;
    const double camera = atan2(-right[2], right[0]), aside = p->opts->sun_azimuth * degree;
    const double a = camera < 0 ? camera + aside : camera - aside, e = p->opts->sun_elevation * degree;
    p->lights = (sg_lights)SG_LIGHTS_INIT;
    p->lights.sun[0] = sin(a) * cos(e);
    p->lights.sun[1] = sin(e);
    p->lights.sun[2] = cos(a) * cos(e);
}

static void plan_light(painter *p)
{
    const size_t triangles = 2 * p->casts->nfaces + 1;
    const bool huge = triangles > 8 * many_triangles;
    const size_t least = huge ? 2 : 5;
    const size_t affordable = p->opts->sky * many_triangles / triangles;
    p->sky = affordable < p->opts->sky ? (affordable > least ? affordable : least) : p->opts->sky;
    p->sky = p->sky < p->opts->sky ? p->sky : p->opts->sky;
    p->sun = huge && p->opts->sun > 1 ? 1 : p->opts->sun;
}

static double lowest(const sg_mesh *m)
{
    double y = 0;
    for (size_t i = 0; i < m->nvertices; i++)
        y = i == 0 ? m->vertices[i][1] : fmin(y, m->vertices[i][1]);
    return y;
}

static sg_status open_painter(painter *p)
{
    const sg_light_point open_ground = {.normal = {0, 1, 0}};
    place_sun(p);
    plan_light(p);
    p->ball = sg_ball_of(p->mesh);
    p->ground = lowest(p->mesh);
    sg_srgb_to_linear(p->opts->background, p->background);
    sg_light_sum(&p->lights, &open_ground, p->on_ground);
    SG_TRY(sg_image_check_size(p->width, p->height, p->err));
    p->sum = calloc(p->width * p->height, 3 * sizeof *p->sum);
    p->materials = malloc((p->mesh->nmaterials + 1) * sizeof *p->materials);
    if (p->sum == NULL || p->materials == NULL)
        return SG_FAIL_NOMEM(p->err);
    for (size_t i = 0; i < p->mesh->nmaterials; i++) {
        sg_srgb_to_linear(p->mesh->materials[i].color, p->materials[i]);
        for (int k = 0; k < 3; k++)
            p->materials[i][k] *= whitest;
    }
    return SG_OK;
}

static void close_painter(painter *p)
{
    free(p->sum);
    free(p->materials);
}

static sg_status open_easel(const painter *p, easel *e)
{
    *e = (easel){.err = SG_ERROR_INIT};
    SG_TRY(sg_raster_create(p->width, p->height, true, &e->raster, &e->err));
    return sg_light_maps_create(&p->lights, &e->maps, &e->err);
}

static void close_easel(easel *e)
{
    sg_raster_clear(&e->raster);
    sg_light_maps_clear(&e->maps);
    sg_shade_points_clear(&e->seen);
}

/* The ground has the colour of the background, and darkens by what of its light is hidden. */
static void point_color(const painter *p, const sg_light_point *point, uint32_t material, double *rgb)
{
    sg_light_sum(&p->lights, point, rgb);
    for (int k = 0; k < 3; k++)
        rgb[k] *= material == SG_SHADE_GROUND ? p->background[k] / p->on_ground[k] : p->materials[material][k];
}

static void add_colors(painter *p, const sg_shade_points *seen)
{
    for (size_t i = 0; i < p->width * p->height; i++) {
        double rgb[3] = {p->background[0], p->background[1], p->background[2]};
        if (seen->materials[i] != SG_SHADE_NOTHING)
            point_color(p, seen->points + i, seen->materials[i], rgb);
        for (size_t k = 0; k < 3; k++)
            p->sum[3 * i + k] += rgb[k] < 1 ? (float)rgb[k] : 1;
    }
}

static double mirrored_bits(size_t i)
{
    double x = 0;
    for (double place = 0.5; i > 0; i /= 2, place /= 2)
        x += place * (double)(i % 2);
    return x;
}

/* Sample s of n stands in a row and in a column of its own: Hammersley's points. */
static sg_status draw_picture(const painter *p, size_t s, easel *e)
{
    const double n = (double)p->opts->samples, offset[2] = {((double)s + 0.5) / n, mirrored_bits(s) + 0.5 / n};
    const sg_shade_view view = {p->mesh, p->camera, &p->ball, sg_shadow_map_lift(p->lights.sun_side),
                                p->opts->ground && p->mesh->nfaces > 0 ? &p->ground : NULL};
    sg_raster_wipe(&e->raster);
    SG_TRY(sg_raster_draw(&e->raster, p->mesh, p->camera, offset, &e->err));
    SG_TRY(sg_shade_find(&e->raster, &view, offset, &e->seen, &e->err));
    return sg_light_gather(&p->lights, p->casts, &p->ball, &e->maps, s * p->sky, p->sky, s * p->sun, p->sun, e->seen.points,
                           p->width * p->height, &e->err);
}

/* As many as are asked for, as there is work for, and as there should be memory for. */
static int thread_count(const painter *p)
{
    const double most = 1e9, maps = 4.0 * (double)(p->lights.sky_side * p->lights.sky_side +
                                                   p->lights.sun_side * p->lights.sun_side);
    const double one = 52.0 * (double)p->width * (double)p->height + maps;
    return (int)fmax(1, fmin(fmin((double)p->opts->threads, (double)p->opts->samples), most / one));
}

/* Sums of rounded numbers depend on their order: pictures are added up in theirs, whoever draws them. */
static sg_status add_pictures(painter *p)
{
    const int threads = thread_count(p);
    sg_status st = SG_OK; /* of the first that failed */
#pragma omp parallel num_threads(threads) if (threads > 1)
    {
        easel e;
        const sg_status opened = open_easel(p, &e);
#pragma omp for ordered schedule(dynamic, 1)
        for (size_t s = 0; s < p->opts->samples; s++) {
            const sg_status drawn = opened != SG_OK                          ? opened
                                    : sg_progress_stopped(p->opts->progress) ? SG_STOPPED
                                                                             : draw_picture(p, s, &e);
#pragma omp ordered
            {
                if (st == SG_OK && drawn == SG_OK)
                    add_colors(p, &e.seen);
                else if (st == SG_OK) {
                    st = drawn;
                    if (p->err != NULL)
                        *p->err = e.err;
                }
            }
        }
        close_easel(&e);
    }
    return st;
}

static sg_status paint(painter *p, sg_image *im)
{
    SG_TRY(open_painter(p));
    SG_TRY(add_pictures(p));
    for (size_t i = 0; i < 3 * im->width * im->height; i++)
        im->rgb[i] = sg_srgb_of_linear((double)p->sum[i] / (double)p->opts->samples);
    return SG_OK;
}

sg_status sg_render_mesh(const sg_mesh *mesh, const sg_mesh *casts, const sg_camera *camera, const sg_render_opts *opts,
                         sg_image *im, sg_error *err)
{
    if (opts->samples < 1 || opts->samples > 256 || opts->sky > 1024 || opts->sun > 1024)
        return SG_FAIL(err, SG_EINVAL, "a picture of %zu samples in a pixel, with light from %zu directions", opts->samples,
                       opts->sky + opts->sun);
    painter p = {.mesh = mesh, .casts = casts != NULL ? casts : mesh, .camera = camera, .opts = opts,
                 .width = im->width, .height = im->height, .err = err};
    const sg_status st = paint(&p, im);
    close_painter(&p);
    return st;
}
