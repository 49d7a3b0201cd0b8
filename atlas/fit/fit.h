/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Whether what was moved or added fits the atlas: a head, areas, streamlines, any box. */
#ifndef CONUS_ATLAS_FIT_FIT_H
#define CONUS_ATLAS_FIT_FIT_H

#include "atlas/atlas.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"

/* The head in a context. */

enum { HEAD_CELLS = 128 }; /**< Along an axis: of a larger grid every second voxel counts, or every third. */

struct head {
    const struct volume *context; /**< Borrowed. */
    double threshold;             /**< The least value of the head. */
    size_t step[3], dim[3];       /**< Voxels to a cell, and cells. */
    uint8_t *inside;              /**< Per cell. */
};

/** Finds the head: the voxels from a threshold on, by Otsu's method (least variance within both classes, 256 bins), and
 * those that these enclose along two of the grid's three axes: a skull encloses the brain. */
conus_status head_make(struct head *out, const struct volume *context);
void head_finish(struct head *head);

/** Sets @p marks, all 0 before, of those values [dim] to 1 that lie between the first and the last one of @p threshold
 * or more along two axes or three. */
void enclose(uint8_t *marks, const float *values, double threshold, const size_t dim[3]);

/** Whether the world point @p point is in the context's grid, and if so, whether it is in the head. */
bool head_grid_has(bool *in_head, const struct head *head, const double point[3]);

enum { SURFACE_HEAD_CELLS = 120 }; /**< Voxels along the longest edge of the box around the surfaces. */

/** Fills @p out with 1 in voxels whose centre is in a closed surface of atlas->context_surfaces, and 0 elsewhere: cubes
 * over the box around these surfaces. No values where none is closed. CONUS_ERROR_MEMORY. */
conus_status surface_head_make(struct volume *out, const conus_atlas *atlas);

/* Points that represent the areas of an atlas. */

enum { AREA_POINTS = 1 << 17 }; /**< At most so many. */

struct area_points {
    double *at; /**< [count][3] World mm. */
    size_t count;
};

/** The centres of the areas' voxels, sampled evenly if there are more than AREA_POINTS; for an atlas of surfaces their
 * vertices. Hidden objects do not count. There may be none. */
conus_status area_points_make(struct area_points *out, const conus_atlas *atlas);
void area_points_finish(struct area_points *points);

/** The mean of the points; there is at least one. */
void area_points_centre(double out[3], const struct area_points *points);

/* Whether a moved atlas lies in the head of its context, and whether it would in another way. */

/** The fractions of the points in the context's grid and in its head, 0 to 1. */
struct fit {
    double in_grid, in_head;
};

/** The fit of points that @p move moves. There is at least one point. */
struct fit fit_of(const struct head *head, const struct area_points *points, const double move[16]);

/** Adds a warning to the notes of an atlas that was moved and gets a context of these @p values (borrowed, one per
 * voxel): if another reading of its transform brings it into the head clearly better, or if less than half of it is in
 * the head and no other reading is better. CONUS_ERROR_MEMORY. */
conus_status fit_note(conus_atlas *atlas, const conus_volume_info *info, float *values);

/** The same for the surfaces around the areas, of which the last has just been added: the inside of closed ones is the
 * head. Nothing if none is closed, if there is one hemisphere only, or beside a context volume, which shows more. */
conus_status fit_note_surfaces(conus_atlas *atlas);

/* Compares the box of something beside the areas with that of the areas. */

/** The box, world mm, around the areas of @p atlas, of its volumes, of its surfaces or of both; empty without any. */
struct box3 fit_box_of_areas(const conus_atlas *atlas, bool volumes, bool surfaces);

/** Adds a warning to @p notes if the longest side of @p box is 250 times that of @p areas or more, or a 250th or less:
 * then one of the two is in micrometres or metres, since no brain is so much larger than an area. @p words say what is
 * in the box, "bundle AF". *@p said tells whether there is a warning; none if a box is empty. CONUS_ERROR_MEMORY. */
conus_status fit_note_size(bool *said, struct notes *notes, const char *words, const struct box3 *box,
                           const struct box3 *areas);

/** The same for a context of @p atlas; and a warning if its box does not touch that of the areas: it is
 * in another space. For an atlas that was moved fit_note() says that. */
conus_status fit_note_context(struct notes *notes, const conus_atlas *atlas, const char *words, const struct box3 *box);

/* Compares the place of streamlines with that of the areas. */

/** Adds a warning to @p notes about the bundle @p name, streamlines that are to be added to @p atlas: if their size
 * suggests other units (fit_note_size()); else if all their coordinates look like voxel indices and the file does not
 * state mm; else if a twentieth of their points more was in the box around the areas before the atlas was moved; else
 * if less than half of them are in that box. Nothing without areas or points. CONUS_ERROR_MEMORY. */
conus_status tract_fit_note(struct notes *notes, const conus_atlas *atlas, const struct tractogram *tractogram,
                            const char *name);

#endif
