/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_check.h - binary glTF files held against the rules of the specification: those that concern files without
 * animations, skins, cameras and pictures, and some of our own (all is used, lists are not empty, names are there). */
#ifndef SG_TESTS_GLTF_CHECK_H
#define SG_TESTS_GLTF_CHECK_H

#include <stddef.h>

typedef struct {
    size_t vertices, triangles, meshes, primitives, materials, nodes;
} gltf_counts;

/** @param counts  out, when all is well; may be NULL
 *  @return NULL, or the rule that is broken first, in a few words */
const char *gltf_check(const unsigned char *bytes, size_t n, gltf_counts *counts);

#endif
