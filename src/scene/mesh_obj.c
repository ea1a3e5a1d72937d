/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mesh_obj.c - meshes as Wavefront OBJ. */
#include "scene/mesh_obj.h"

#include "core/file.h"

#include <math.h>
#include <string.h>

/* Also takes the sign from zeros. */
static double snap(double x)
{
    return fabs(x) < 5e-7 ? 0 : x;
}

/* Names are one word in these files. */
static void write_name(FILE *out, const char *name)
{
    for (const char *p = name; *p != '\0'; p++)
        fputc((unsigned char)*p <= ' ' || *p == '#' || *p == '\\' || *p == 127 ? '_' : *p, out);
}

/* A named material has its colour in its name where labels give it one: names alone need not tell materials apart. */
static void write_material_name(FILE *out, const sg_mesh_material *m)
{
    if (m->name != NULL) {
        write_name(out, m->name);
        fputc('_', out);
    }
    fprintf(out, "%06x", (unsigned)m->color);
}

static void write_vertices(const sg_mesh *m, FILE *out)
{
    for (size_t i = 0; i < m->nvertices; i++)
        fprintf(out, "v %.7g %.7g %.7g\n", snap(m->vertices[i][0]), snap(m->vertices[i][1]), snap(m->vertices[i][2]));
    for (size_t i = 0; i < m->nuvs; i++)
        fprintf(out, "vt %.7g %.7g\n", snap(m->uvs[i][0]), snap(m->uvs[i][1]));
    for (size_t i = 0; i < m->nnormals; i++)
        fprintf(out, "vn %.7g %.7g %.7g\n", snap(m->normals[i][0]), snap(m->normals[i][1]), snap(m->normals[i][2]));
}

static void write_face(const sg_mesh_face *f, FILE *out)
{
    fputc('f', out);
    for (uint32_t i = 0; i < f->ncorners; i++)
        fprintf(out, " %lu/%lu/%lu", f->corner[i].vertex + 1UL, f->corner[i].uv + 1UL, f->corner[i].normal + 1UL);
    fputc('\n', out);
}

static void write_group(const sg_mesh *m, const sg_mesh_group *g, bool materials, FILE *out)
{
    if (g->n == 0)
        return;
    fputs("g ", out);
    if (g->name != NULL)
        write_name(out, g->name);
    else
        write_material_name(out, m->materials + g->material);
    if (materials) {
        fputs("\nusemtl ", out);
        write_material_name(out, m->materials + g->material);
    }
    fputc('\n', out);
    for (size_t i = g->first; i < g->first + g->n; i++)
        write_face(m->faces + i, out);
}

sg_status sg_mesh_obj_write(const sg_mesh *mesh, const char *library, FILE *out, sg_error *err)
{
    if (library != NULL)
        fprintf(out, "mtllib %s\n", library);
    write_vertices(mesh, out);
    for (size_t k = 0; k < mesh->ngroups; k++)
        write_group(mesh, mesh->groups + k, library != NULL, out);
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing a mesh failed") : SG_OK;
}

sg_status sg_mesh_mtl_write(const sg_mesh *mesh, FILE *out, sg_error *err)
{
    for (size_t i = 0; i < mesh->nmaterials; i++) {
        const uint32_t c = mesh->materials[i].color;
        fputs(i > 0 ? "\nnewmtl " : "newmtl ", out);
        write_material_name(out, mesh->materials + i);
        fprintf(out, "\nKd %.4f %.4f %.4f\nKs 0 0 0\nillum 1\n", (c >> 16) / 255.0, (c >> 8 & 255) / 255.0,
                (c & 255) / 255.0);
    }
    return ferror(out) ? SG_FAIL(err, SG_EIO, "writing materials failed") : SG_OK;
}

static sg_status save_materials(const sg_mesh *mesh, const char *path, sg_error *err)
{
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    return sg_output_end(&out, sg_mesh_mtl_write(mesh, out.fp, err), err);
}

/* The materials come first: a mesh that is there has them. */
sg_status sg_mesh_obj_save(const sg_mesh *mesh, const char *path, sg_error *err)
{
    char materials[4096];
    const size_t length = strlen(path);
    if (length < 4 || strcmp(path + length - 4, ".obj") != 0)
        return SG_FAIL(err, SG_EINVAL, "%s: the name of a mesh ends in .obj", path);
    if (length >= sizeof materials)
        return SG_FAIL(err, SG_EIO, "%.200s...: the path is too long", path);
    memcpy(materials, path, length + 1);
    memcpy(materials + length - 3, "mtl", 3);
    SG_TRY(save_materials(mesh, materials, err));
    const char *slash = strrchr(materials, '/');
    sg_output out;
    SG_TRY(sg_output_open(&out, path, err));
    return sg_output_end(&out, sg_mesh_obj_write(mesh, slash != NULL ? slash + 1 : materials, out.fp, err), err);
}
