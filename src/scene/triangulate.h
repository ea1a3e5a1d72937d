/* SPDX-License-Identifier: GPL-3.0-or-later */
/* triangulate.h - polygons in the plane cut into triangles, ear by ear (Meisters, "Polygons have ears", 1975). */
#ifndef SG_SCENE_TRIANGULATE_H
#define SG_SCENE_TRIANGULATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Twice the signed area of a triangle; positive: counterclockwise. */
double sg_triangle_area(const double *a, const double *b, const double *c);

/** Signed area of a polygon that is simple; positive: counterclockwise. */
double sg_polygon_area(const double (*p)[2], size_t n);

/** Does each corner of a counterclockwise polygon turn left? */
bool sg_polygon_convex(const double (*p)[2], size_t n);

/** Cut a simple counterclockwise polygon into n - 2 triangles that use its corners alone, by cutting off ears (Meisters,
 *  "Polygons have ears", 1975); a convex one is cut from its first corner. O(n^2) where ears are found soon, and never
 *  more than 4 n^2 looks at a corner: with more, and for polygons that are not simple, the cut is from the first corner
 *  too, and triangles may overlap.
 *  @param triangles  out [n - 2], counterclockwise
 *  @param left       work space [n]
 *  @return false when no cut into ears was found */
bool sg_triangulate(const double (*p)[2], size_t n, uint32_t (*triangles)[3], uint32_t *left);

#endif
