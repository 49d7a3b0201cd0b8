/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Atlases of a few shapes, for tests of pictures. */
#ifndef CONUS_TESTS_SUPPORT_PICTURE_SCENE_H
#define CONUS_TESTS_SUPPORT_PICTURE_SCENE_H

#include "render/colour/colour.h"

enum { PICTURE_WIDTH = 80, PICTURE_HEIGHT = 60, PICTURE_PIXELS = PICTURE_WIDTH * PICTURE_HEIGHT };

/** Label (or grey value) of a world point. */
typedef double (*picture_function)(const double world[3]);

extern const double picture_identity[16];

/* Functions that several tests draw: 0 and 10 everywhere, and 1 within 20 mm of the origin. */
double picture_nothing(const double world[3]);
double picture_ten(const double world[3]);
double picture_ball_of_20(const double world[3]);

/** A grid of @p dim voxels whose middle is at world_from_grid's origin, voxel edges along its axes @p spacing long. */
conus_volume_info picture_grid(const size_t dim[3], const double spacing[3], const double world_from_grid[16]);

/** An atlas with the labels of @p labels at the voxels' centres, and around it the context of @p values, if any, on
 * @p context (NULL = the same grid). */
conus_atlas *picture_atlas(const conus_volume_info *grid, picture_function labels, const conus_volume_info *context,
                           picture_function values);

/** A rotation by @p angle about (1, 2, 3), then the translation @p to. */
void picture_rigid(double out[16], double angle, const double to[3]);

/** What draws in tests of pictures: OpenGL, or rays where $CONUS_TEST_ENGINE says so. */
conus_engine picture_engine(void);

/** Skips the running test if it needs OpenGL and there is none. */
void picture_need_engine(void);

/** A renderer by picture_engine(), which skips the test likewise. */
conus_renderer *picture_renderer(const conus_atlas *atlas, const char *transfer);

/** A camera at @p distance from the world's origin, looking at it along @p forward. */
struct camera picture_camera(const double forward[3], double distance, double field_of_view);

/** PICTURE_PIXELS of R, G, B, A, bottom row first; @p extra may be NULL. End it with memory_free(). */
float *picture_draw(conus_renderer *renderer, const struct camera *camera, const struct colour_view *extra,
                    bool smooth);

/** Eq. 8: black haze of length L in front of an object lets (1 - a)^L of its light through, wherever the planes lie.
 * Draws both atlases, which it takes over, from the front: @p hazy is @p clear with a context from 30 mm on, in front
 * of objects that begin at 20. */
void picture_check_haze(conus_atlas *clear, conus_atlas *hazy, double field_of_view);

/** Mean difference of all channels of two pictures. */
double picture_difference(const float *a, const float *b);

#endif
