/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skeleton.h - straight skeletons of small polygons: what hip roofs are made of. Every edge moves inwards at the same speed;
 * what it sweeps is its face of the roof, as high at each place as the time at which it came by.
 * Source: Aichholzer, Aurenhammer, Alberts and Gaertner, "A novel type of skeleton for polygons" (1995). */
#ifndef SG_SCENE_SKELETON_H
#define SG_SCENE_SKELETON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SG_SKELETON_CORNERS = 12, SG_SKELETON_NODES = 2 * SG_SKELETON_CORNERS };

typedef struct {
    size_t ncorners;
    uint8_t corner[SG_SKELETON_NODES]; /* nodes, counterclockwise; first the two ends of the edge */
} sg_skeleton_face;

typedef struct {
    size_t nnodes;
    double node[SG_SKELETON_NODES][3];          /* x, y, time; the corners of the polygon come first */
    sg_skeleton_face face[SG_SKELETON_CORNERS]; /* of the edge from corner i to i + 1 */
    double height;                              /* the last time */
} sg_skeleton;

/** The skeleton of a simple counterclockwise polygon of 3 to SG_SKELETON_CORNERS corners. Events are simulated one by one,
 *  those of one time in any order; at the end all faces must be simple polygons that together have the area of the whole.
 *  @return false when they do not: the polygon is not simple, or too many events fall together */
bool sg_skeleton_find(const double (*p)[2], size_t n, sg_skeleton *s);

/** Hip ends become gables: the point of each triangular face goes out along its ridge until it stands over its edge, where
 *  it does so between the ends of the edge. The face then stands upright; those beside it stay in their planes.
 *  @param p  the polygon of the skeleton
 *  @return how many there are: a pyramid, say, has none */
size_t sg_skeleton_raise_gables(const double (*p)[2], size_t n, sg_skeleton *s);

#endif
