/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The exact walk of rays through a volume's cells (Eq. 5), skipping what is known to be empty.
 *
 * A ray is a point and a direction per mm in index space. It crosses the plane between cells b - 1 and b of axis a at
 * t_a(b) = (b - 1/2 - o_a) * (1 / d_a), evaluated as written. All its crossings, sorted by t and then by axis, make the
 * sequence of its cells; so the cell after any crossing is a function of that crossing alone, however it was reached,
 * and a skip to it gives the same bits as stepping there. */
#ifndef CONUS_SELECTION_ENGINE_VOXELS_TRAVERSE_H
#define CONUS_SELECTION_ENGINE_VOXELS_TRAVERSE_H

#include "selection/engine/voxels/distance_map.h"
#include "selection/evidence/evidence.h"

#include <stdalign.h>

/** A ray, prepared. An axis along which it does not move has direction 0, inverse infinity, sign 1, and the centre of
 * its cell for origin. */
struct traverse_ray {
    double origin[3];
    double direction[3];
    double inverse[3];
    double sign[3]; /**< +1 or -1 */
};

/** Where a ray is: in the cell with these indices (whole numbers) since @p t mm. */
struct traverse_place {
    double cell[3];
    double t;
};

/** 1 + the radius of the empty box there; at most 0 where an object is. */
static inline int traverse_code(const struct distance_map *map, const struct traverse_place *place)
{
    const double *cell = place->cell;
    return map->codes[distance_map_at(map, (size_t)cell[0], (size_t)cell[1], (size_t)cell[2])] - (int)map->shift;
}

/** The voxel there, its linear index. */
static inline size_t traverse_voxel(const struct distance_map *map, const struct traverse_place *place)
{
    const double *cell = place->cell;
    return (size_t)cell[0] + map->dim[0] * ((size_t)cell[1] + map->dim[1] * (size_t)cell[2]);
}

/** The first voxel with an object. */
struct traverse_contact {
    double t;        /**< mm to the entry into its cell; 0 if the ray starts in it; INFINITY = none. */
    uint64_t voxel;  /**< Linear index i + dim0 (j + dim1 k); UINT64_MAX = none.                     */
    uint32_t object; /**< The object there, for a hit by a labelled map.                                 */
};

/** Index of the cell [i - 1/2, i + 1/2) that holds @p x. */
double traverse_cell(double x);

void traverse_ray_init(struct traverse_ray *out, const double origin[3], const double direction[3]);

/** The ray's first place in the map's box; false if it misses it. */
bool traverse_enter(const struct distance_map *map, const struct traverse_ray *ray, struct traverse_place *out);

/** Leaves the box of @p radius cells around @p place, which must be empty; false if the ray is out of the map's box
 * then. */
bool traverse_skip(const struct distance_map *map, const struct traverse_ray *ray, double radius,
                   struct traverse_place *place);

/** Walks one ray; gives up beyond @p limit mm. */
struct traverse_contact traverse_one(const struct distance_map *map, const struct traverse_ray *ray, double limit);

/** Appends to @p out the intervals of @p pixel's ray inside the objects of @p volume, whose map @p map is: runs of
 * cells with the same object, to the exit from the last one (Eq. 10). In the first cell beyond @p limit mm it ends. */
conus_status traverse_pierce(struct layers *out, const struct distance_map *map, const struct volume *volume,
                             const struct traverse_ray *ray, double limit, uint32_t pixel);

enum { TRAVERSE_BUNDLE = 256, TRAVERSE_LANES = 16 };

/** Origins farther away than so many voxels, grids with more voxels along an edge and maps with more codes need
 * traverse_one(). */
#define TRAVERSE_FAR 0x1p25
enum { TRAVERSE_EDGE = 1 << 20, TRAVERSE_CODES = INT32_MAX, TRAVERSE_THERE = -1 };

/** Rays, neighbours side by side: what a kernel walks at once. The caller fills in what is before `index_from_world`.
 */
struct traverse_bundle {
    size_t count;                                     /**< Number of rays, at most TRAVERSE_BUNDLE. */
    alignas(64) double direction[3][TRAVERSE_BUNDLE]; /**< In the world, unit length.               */
    double limit[TRAVERSE_BUNDLE];                    /**< Give up beyond, mm.                      */
    const double *from; /**< [count] Kernels may begin there, mm, padded; NULL = at the origin. See `t`. */
    double origin[3];   /**< In the world, of all rays;               */
    bool is_apart;      /**< unless each has its own:                 */
    double origins[3][TRAVERSE_BUNDLE];
    const double *index_from_world;                /**< The volume's matrix, and                                 */
    double start[3];                               /**< the origin in its index space, or                        */
    alignas(64) double starts[3][TRAVERSE_BUNDLE]; /**< the origins, and                                         */
    double low[3], high[3];                        /**< their box, and                                           */
    bool starts_inside;                    /**< whether that is in the map's: traverse_bundle_trace() sets these. */
    alignas(64) double t[TRAVERSE_BUNDLE]; /**< Out: as in struct traverse_contact; with `from`, TRAVERSE_THERE where
                                              the ray is in that voxel at `from`, and surely not at its border.  */
    uint64_t voxel[TRAVERSE_BUNDLE];
    uint32_t object[TRAVERSE_BUNDLE]; /**< Out: what is there, of hits. */
};

/** Ray @p i in index space. */
struct traverse_ray traverse_bundle_at(const struct traverse_bundle *bundle, size_t i);

/** Walks ray @p i alone. Sets the object only by a labelled map. */
void traverse_bundle_ray(const struct distance_map *map, struct traverse_bundle *bundle, size_t i);

/** All intervals of a bundle's rays: what a kernel lists at once. */
struct traverse_piercing {
    const struct distance_map *uniform; /**< The volume's uniform map.                   */
    const struct volume *volume;
    const size_t *pixel; /**< The pixel of each ray.                                */
    struct layers *out;
    size_t count; /**< Number of rays: those behind them repeat the last. Set by traverse_bundle_pierce(). */
    bool again[TRAVERSE_BUNDLE]; /**< Out: rays for traverse_pierce(): they have no intervals in @p out.           */
};

/** One way to trace bundles. Kernels need `count` to be a multiple of TRAVERSE_LANES and near origins;
 * traverse_bundle_trace() sees to both. */
struct traverse_kernel {
    const char *name; /**< "avx512" */
    bool (*is_supported)(void);
    /** Sets the objects only by a labelled map. */
    void (*trace)(const struct distance_map *map, struct traverse_bundle *bundle);
    /** May be NULL; then rays are pierced one by one. */
    conus_status (*pierce)(struct traverse_piercing *piercing, struct traverse_bundle *bundle);
};

/* By instruction set: traverse_avx512.c, traverse_avx2.c, traverse_plain.c; all of them from traverse_lanes.h. */
void traverse_trace_avx512(const struct distance_map *map, struct traverse_bundle *bundle);
void traverse_trace_avx2(const struct distance_map *map, struct traverse_bundle *bundle);
void traverse_trace_plain(const struct distance_map *map, struct traverse_bundle *bundle);
conus_status traverse_pierce_avx512(struct traverse_piercing *piercing, struct traverse_bundle *bundle);
conus_status traverse_pierce_avx2(struct traverse_piercing *piercing, struct traverse_bundle *bundle);
conus_status traverse_pierce_plain(struct traverse_piercing *piercing, struct traverse_bundle *bundle);

/** Entry @p index of the table of kernels, the fastest first; NULL past the last. The last runs on any machine. */
const struct traverse_kernel *traverse_kernel(size_t index);

/** The fastest that this machine can run. */
const struct traverse_kernel *traverse_best_kernel(void);

/** traverse_pierce() for each ray of a bundle, with the same intervals; of several rays also beyond their limits.
 * @p map is the volume's distance map. */
conus_status traverse_bundle_pierce(const struct traverse_kernel *kernel, const struct distance_map *map,
                                    struct traverse_piercing *piercing, struct traverse_bundle *bundle);

/** Walks the rays through @p volume, whose map @p map is, labelled or not. */
void traverse_bundle_trace(const struct traverse_kernel *kernel, const struct distance_map *map,
                           const struct volume *volume, struct traverse_bundle *bundle);

#endif
