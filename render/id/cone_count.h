/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * What the rays of many cones of one shape hit first in volumes, added up per object on the device (Eq. 4, Eq. 11): a
 * cone goes up as its place, and its rows come down. With the bits of the rays engine and its statistics. Needs a
 * current context throughout. */
#ifndef CONUS_RENDER_ID_CONE_COUNT_H
#define CONUS_RENDER_ID_CONE_COUNT_H

#include "render/id/id_pass.h"

/** Where a cone is: the columns of world_from_device, and the radius of a cylinder, else 0. And which shape it has. */
struct cone_place {
    double right[3], up[3], back[3], apex[3], radius;
    uint32_t shape, unused;
};

/** A ray of the shape. Neighbours should be neighbours: CONE_PART of them are walked together. */
struct cone_aim {
    double right, up, forward; /**< Unit direction in the device's frame. */
    double u, v;               /**< In the buffer (Eq. 3).                */
    uint32_t rank, unused;     /**< Of its pixel among those of its part. */
};

enum { CONE_PART = 256 };

/** A pixel of the shape; those of a part by ascending number, as many as the part has rays. */
struct cone_spot {
    double weight;          /**< Sums of them must be exact where there are several parts. */
    uint32_t pixel, square; /**< Row-major; n^2 r^2.                                       */
};

/** What the pixels of a part hit first of one object. */
struct cone_row {
    double nearest, contact;               /**< mm along the rays, INFINITY for object 0. */
    double weight;                         /**< Sum.                                      */
    uint32_t object, own;                  /**< As reported, and as its contact hit it.   */
    uint32_t pixels, pixel, voxel, unused; /**< How many; the contact's two.              */
};

/** The rows of a part of a cone. */
struct cone_head {
    uint32_t first, count;
};

struct cone_count;

/** @p out is NULL on a driver that does not round each `precise` operation, which some thousand numbers show: such rays
 * would be others than the CPU's. @p groups[k] is as what object k is reported. @p volumes of @p pass, which must
 * outlive it, are searched, with at most 2^32 - 1 voxels each; @p voxel_from_world [volumes] are their matrices. */
conus_status cone_count_create(struct cone_count **out, const struct id_pass *pass, const uint32_t *groups,
                               size_t group_count, const double *const *voxel_from_world, size_t volumes);
/** NULL is fine. */
void cone_count_destroy(struct cone_count *count);

/** Sets the shapes of the next cones, of @p rays rays each, shape after shape. The first @p known of @p shapes are
 * those that it has. After a failure it has none. */
conus_status cone_count_set_shapes(struct cone_count *count, const struct cone_aim *aims, const struct cone_spot *spots,
                                   uint32_t rays, size_t known, size_t shapes);

/** Counts for @p cones cones. Part p of cone c has (*heads)[c * parts + p], parts = rays / CONE_PART rounded up. Both
 * are borrowed until the next call. */
conus_status cone_count_run(struct cone_count *count, const struct cone_place *places, uint32_t cones,
                            const struct cone_head **heads, const struct cone_row **rows);

#endif
