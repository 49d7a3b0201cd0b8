/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The torus scene of the paper, and the passes that draw it. */
#ifndef CONUS_BENCH_TORUS_TORUS_H
#define CONUS_BENCH_TORUS_TORUS_H

#include "atlas/atlas.h"
#include "selection/cone/cone.h"
#include "selection/engine/engine.h"
#include "selection/engine/triangles/mesh_rays.h"

/* The paper's scene: many tori of 16 x 16 subdivisions, turned at random on a cubic grid, and cones into it. */

enum { TORUS_RESOLUTION = 16, TORUS_TRIANGLES = 512 };

/** Radius of the sphere round one torus, and from one to the next along the grid, mm. */
#define TORUS_RADIUS 5.0
#define TORUS_SPACING 12.5

/** Radius of the circle in the middle of a torus's tube, mm. */
#define TORUS_RING 3.5

struct torus_scene {
    struct mesh torus; /**< Round its own z axis.                        */
    size_t count;
    double (*places)[16]; /**< [count] world_from_torus, rigid.             */
    double side;          /**< The cube's of all tori, mm; its middle is at 0. */
};

/** End it with torus_scene_finish(). */
conus_status torus_scene_init(struct torus_scene *out, size_t count);
void torus_scene_finish(struct torus_scene *scene);

/** Writes @p count cones from outside one corner into the cube; the same for every scene of this size. */
void torus_scene_cones(struct cone *out, const struct torus_scene *scene, size_t count, double angle_deg);

/** One torus at all its places. */
conus_status torus_scene_rays(struct mesh_rays **out, const struct torus_scene *scene);

/** The tori as an atlas: an area each, with triangles of its own. */
conus_status torus_scene_atlas(conus_atlas **out, const struct torus_scene *scene);

/* The torus scene as the paper draws it, every torus into a frame and into the device's buffer; and the engines that
 * are compared with it, all on one number of tori. */

struct torus_pass;

/** Draws a frame of @p size pixels, all tori in colour, lit per pixel, without culling, and does not wait for it. The
 * target is made anew when the size changes. */
conus_status torus_pass_frame(struct torus_pass *pass, const uint32_t size[2]);

/** Waits for all that has been drawn. */
conus_status torus_pass_wait(struct torus_pass *pass);

/** Part of the last frame that shows a torus. */
conus_status torus_pass_coverage(double *out, struct torus_pass *pass);

const char *torus_pass_device(const struct torus_pass *pass);

/** The ways to select from one number of tori. */
enum torus_way { TORUS_ALL_DRAWN, TORUS_GL, TORUS_RAYS, TORUS_WAYS };

struct torus_round {
    struct torus_scene scene;
    conus_atlas *atlas;     /**< NULL where the tori are too many for triangles of their own: then TORUS_RAYS has */
    struct mesh_rays *rays; /**< placed ones, and there is no TORUS_GL.                                          */
    struct torus_pass *pass;
    struct engine *engines[TORUS_WAYS];
};

/** CONUS_ERROR_GL where there is no OpenGL. End it with torus_round_finish() even if this fails. */
conus_status torus_round_init(struct torus_round *out, size_t count, bool placed);
void torus_round_finish(struct torus_round *round);

/** "20000 tori, gl engine" */
void torus_round_name(char *out, size_t size, const struct torus_round *round, enum torus_way way);

#endif
