/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The distance of each object from a point: to the cells of its voxels or to its surface. */
#ifndef CONUS_SELECTION_MEASURE_NEAR_H
#define CONUS_SELECTION_MEASURE_NEAR_H

#include "atlas/atlas.h"
#include "selection/region/region.h"

#include <math.h>

/** Nearest points of objects to a ball's centre; kept between balls. A zeroed one is ready for near_prepare(). */
struct near {
    struct near_object {
        double distance; /**< mm; INFINITY if none was found.                                                   */
        double point[3]; /**< World position.                                                                   */
        double value;  /**< Value of the voxel whose cell that is; NAN where the volume has no values, and of a mesh. */
    } * objects;       /**< [object_count + 1]                                                                */
    uint32_t *touched; /**< Objects within the ball.                                                          */
    size_t touched_count;
    size_t object_count;
};

/** Reserves capacity for the objects of @p atlas. */
conus_status near_prepare(struct near *near, const conus_atlas *atlas);
void near_finish(struct near *near);

/** Forgets what was found. */
void near_clear(struct near *near);

/** Notes that a point of @p object is so near, and the value there. */
void near_note(struct near *near, uint32_t object, double distance, const double point[3], double value);

/** Forgets the last ball's and finds all objects of @p atlas no farther from the centre of @p ball than its radius. 0
 * in an object: in one of its cells (Eq. 5), or where its surface winds around the point by half a turn or more. */
void near_take(struct near *near, const conus_atlas *atlas, const struct region *ball);

/** The cells of a volume (Eq. 5) as distances see them. */
struct near_cells {
    double gram[3][3]; /**< Dot products of the axes, mm^2.                    */
    double reach;      /**< From a cell's centre to its farthest corner, mm. */
};

void near_cells_init(struct near_cells *out, const struct volume *volume);

/** Offset, in voxels, from @p at to the nearest point of the cell of voxel @p cell; both are indices. Returns the
 * distance in mm, or INFINITY (and @p out untouched) where that is surely more than @p limit. */
double near_cell(double out[3], struct near_cells *cells, const double cell[3], const double at[3], double limit);

/** near_box() of axes that are not perpendicular. */
double near_skew_box(double out[3], double box[2][3], double gram[3][3]);

/** Offset to the point nearest to the origin of the parallelepiped of @p box, low and high ends along three axes whose
 * dot products are @p gram: in units of the axes. Returns the distance. */
static inline double near_box(double out[3], double box[2][3], double gram[3][3])
{
    double square = 0;
    if (gram[0][1] != 0 || gram[1][2] != 0 || gram[2][0] != 0) {
        return near_skew_box(out, box, gram);
    }
    for (int a = 0; a < 3; a++) {
        out[a] = box[0][a] > 0 ? box[0][a] : box[1][a] < 0 ? box[1][a] : 0;
        square += out[a] * (gram[a][a] * out[a]);
    }
    return sqrt(square);
}

#endif
