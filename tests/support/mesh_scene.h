/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Meshes of known shape for tests, and the first triangle along a ray found by trying every one in double. */
#ifndef CONUS_TESTS_SUPPORT_MESH_SCENE_H
#define CONUS_TESTS_SUPPORT_MESH_SCENE_H

#include "selection/engine/triangles/mesh_rays.h"

/** An atlas without objects. End it with conus_atlas_destroy(). */
conus_atlas *mesh_scene_atlas(void);

struct cone mesh_scene_cone(const double origin[3], const double target[3], double degrees, uint32_t resolution);

/** First hits of the rays engine. End it with evidence_finish(). */
void mesh_scene_trace(struct evidence *out, const conus_atlas *atlas, const struct cone *cone);

/** The answer of a selector with @p options to the cone. End it with conus_selection_destroy(). */
conus_selection *mesh_scene_select(const conus_atlas *atlas, const conus_selector_options *options,
                                   const struct cone *cone);

/** A closed box along the axes. */
struct mesh mesh_scene_box(const double low[3], const double high[3]);

/** Turns all triangles around. */
void mesh_scene_turn(struct mesh *mesh);

/** Joins two meshes, which are taken over, into one. */
struct mesh mesh_scene_join(struct mesh *a, struct mesh *b);

/** A closed sphere of @p rings x @p sectors quadrilaterals (triangles at the poles), inscribed. */
struct mesh mesh_scene_sphere(const double centre[3], double radius, unsigned rings, unsigned sectors);

/** A closed torus round the z axis: tube of radius @p tube round a circle of radius @p ring. */
struct mesh mesh_scene_torus(double ring, double tube, unsigned sectors, unsigned sides);

/** @p count triangles within @p size mm of 0, each as large as @p edge says, now and then a thin sliver. */
struct mesh mesh_scene_soup(uint64_t *state, size_t count, double size, double edge);

/** Adds three soups of up to 30 triangles, 6 mm big, within 12 mm of the origin, to @p atlas. */
void mesh_scene_add_soups(conus_atlas *atlas, uint64_t *state);

/** Appends @p mesh (taken over) as an area. */
void mesh_scene_add(conus_atlas *atlas, struct mesh *mesh);

/** Five spheres around one centre: of 50 mm, and of 0.0004 to 0.1 mm less. */
conus_atlas *mesh_scene_nested(void);

/** The paper's mixed scene: eleven areas of 234,444 triangles and a pathway; a ray hits the nearer one first. */
conus_atlas *mesh_scene_brain(void);

/** A cone from inside, near or 1e5 mm away, at a point of a scene of @p size mm round 0. */
struct cone mesh_scene_random_cone(uint64_t *state, double size);

/** The first triangle along a ray (Eq. 9); object 0 = none. */
struct mesh_hit {
    uint32_t object;
    uint64_t triangle;
    double t;
};
struct mesh_hit mesh_scene_first(const conus_atlas *atlas, const double origin[3], const double direction[3]);

/** All triangles that a ray passes, by distance, up to @p limit of them; pixel and object stay 0. */
size_t mesh_scene_all(struct crossing *out, size_t limit, const struct mesh *mesh, const double origin[3],
                      const double direction[3]);

/** Smallest distance in mm between a ray's line and the edges of a triangle. */
double mesh_scene_edge_distance(const struct mesh *mesh, size_t triangle, const double origin[3],
                                const double direction[3]);

#endif
