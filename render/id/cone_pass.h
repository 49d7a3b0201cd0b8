/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Cones whose rays the device makes: a cone goes up as its place. Either it adds up, per object, what they hit first in
 * volumes (Eq. 4, Eq. 11), and rows come down; or the ID pass walks them, and pixels or intervals do. With the bits of
 * the rays engine and its statistics. Needs a current context throughout. */
#ifndef CONUS_RENDER_ID_CONE_PASS_H
#define CONUS_RENDER_ID_CONE_PASS_H

#include "render/id/id_pass.h"

/** Where a cone is: the columns of world_from_device, right, up, back and apex; the radius of a cylinder, else 0. And
 * which shape it has. */
struct cone_place {
    double columns[4][3], radius;
    uint32_t shape, unused;
};

/** A ray of a shape. */
struct cone_aim {
    double right, up, forward; /**< Unit direction in the device's frame. */
    double u, v;               /**< In the buffer (Eq. 3).                */
    uint32_t rank, unused;     /**< Of its pixel among those of its part, to count. */
};

enum { CONE_PART = 256 };

/** Beside the number of a pixel. */
#define CONE_BORDER 0x80000000U

/** A pixel of the shape; those of a part by ascending number, as many as the part has rays. */
struct cone_spot {
    double weight;          /**< Sums of them must be exact where there are several parts.           */
    uint32_t pixel, square; /**< Row-major, with CONE_BORDER if a neighbour is in no cone; n^2 r^2. */
};

/** What the pixels of a part hit first of one object. */
struct cone_row {
    double nearest, contact;       /**< mm along the rays, INFINITY for object 0. */
    double weight;                 /**< Sum.                                      */
    uint32_t object, own;          /**< As reported, and as its contact hit it.   */
    uint32_t pixels, pixel, voxel; /**< How many; the contact's two.                      */
    uint32_t border;               /**< CONE_BORDER if one of them has it; else 0.        */
};

/** The rows of a part of a cone. */
struct cone_head {
    uint32_t first, count;
};

/** After a failure all but its end is lost. */
struct cone_pass;

/** @p out is NULL on a driver that does not round each `precise` operation, which some thousand numbers show: such rays
 * would be others than the CPU's. The volumes of @p id_pass, which must outlive it, are searched. */
conus_status cone_pass_create(struct cone_pass **out, struct id_pass *id_pass);
/** NULL is fine. */
void cone_pass_destroy(struct cone_pass *pass);

/** Sets as what each object is counted: @p groups[k] for object k. */
conus_status cone_pass_set_groups(struct cone_pass *pass, const uint32_t *groups, size_t group_count);

/** Adds a shape of @p rays rays, as number @p known: the device has as many of that many rays, to count with, which
 * need
 * @p spots, or to list, where it is NULL. After a failure it has none. */
conus_status cone_pass_add_shape(struct cone_pass *pass, const struct cone_aim *aims, const struct cone_spot *spots,
                                 size_t rays, size_t known);

/** Counts for @p cones cones, whose rays are walked CONE_PART by CONE_PART: those of a part should be neighbours. Part
 * p of cone c has (*heads)[c * parts + p], parts = rays / CONE_PART rounded up. Both are borrowed until the next call.
 * Volumes have at most 2^32 - 1 voxels each. */
conus_status cone_pass_count(struct cone_pass *pass, const struct cone_place *places, uint32_t cones, uint32_t rays,
                             const struct cone_head **heads, const struct cone_row **rows);

/** Lists the next rays that are made: ray k is ray @p list[k] % rays of cone list[k] / rays; @p count of them, of which
 * the device has the first @p known. */
conus_status cone_pass_list(struct cone_pass *pass, const struct cone_place *places, uint32_t cones, uint32_t rays,
                            const uint32_t *list, size_t known, uint32_t count);

/** Makes the listed rays in volume number @p volume, for the next id_pass_trace() or id_pass_pierce(); after
 * id_pass_begin() for as many. */
conus_status cone_pass_make_rays(struct cone_pass *pass, size_t volume);

#endif
