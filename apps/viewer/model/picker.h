/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Finds objects under the mouse and at places. */
#ifndef CONUS_VIEWER_MODEL_PICKER_H
#define CONUS_VIEWER_MODEL_PICKER_H

#include "viewer/model/viewer.h"

/** The first hit of the ray from @p origin along @p direction in what the 3-D picture shows, if it is less than @p
 * limit mm away (INFINITY = anywhere). Pathways count from their threshold on. Where the context lets too little light
 * through to see anything behind, it is hit, and @p object is 0. False: no hit. */
bool viewer_pick(uint32_t *object, double contact[3], struct viewer *viewer, const double origin[3],
                 const double direction[3], double limit);
/** The first hit of such a ray in what a 3-D picture of one atlas would show, whatever its context hides, and how many
 * mm it is away; 0 and INFINITY = no hit. */
uint32_t view_atlas_pick(double *depth, struct view_atlas *view, const double origin[3], const double direction[3]);
/** The distance along such a ray to the first object that is not hidden, mm; INFINITY = there is none. */
double view_atlas_depth(struct view_atlas *view, const double origin[3], const double direction[3]);
/** The object whose voxel or closed surface holds a place in one atlas, as its cuts would name it; 0 = none. */
uint32_t view_atlas_at(struct view_atlas *view, const double place[3]);
/** The largest value of pathway @p object within a voxel of @p place; NaN of an area. */
double view_atlas_value(struct view_atlas *view, uint32_t object, const double place[3]);

#endif
