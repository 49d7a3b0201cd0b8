/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The paper's scene: many tori of 16 x 16 subdivisions, turned at random on a cubic grid, and cones into it. */
#ifndef CONUS_BENCH_TORUS_TORUS_SCENE_H
#define CONUS_BENCH_TORUS_TORUS_SCENE_H

#include "atlas/atlas.h"
#include "selection/cone/cone.h"
#include "selection/engine/triangles/mesh_rays.h"

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

#endif
