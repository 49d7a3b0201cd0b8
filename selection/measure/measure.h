/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a region or a cone holds of each object: voxels, solids, streamlines, distances, and the results. */
#ifndef CONUS_SELECTION_MEASURE_MEASURE_H
#define CONUS_SELECTION_MEASURE_MEASURE_H

#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "selection/cone/cone.h"
#include "selection/evidence/evidence.h"
#include "selection/region/region.h"
#include "selection/weight/weight.h"

#include <math.h>
#include <stdatomic.h>

/* The rows of a parcellation, along whichever axis, as runs of voxels of one object each. They take a small part of
 * its labels' memory, so that more of them stays near the processor. */

/** A zeroed one has no runs. */
struct label_runs {
    int axes[3];       /**< That of the rows; then those along which row comes after row, and slice after slice. */
    uint32_t *rows;    /**< [dim[axes[1]] dim[axes[2]] + 1] the first run of each row, and one past the last of all;
                            NULL = none. */
    uint16_t *starts;  /**< [runs] the index along axes[0] at which it begins; more than the last may be read. */
    uint16_t *objects; /**< [runs] */
};

/** Finds the runs of @p volume along @p axis; the volume must not change from now on. There are no runs where they
 * would take more than half a byte a voxel or 64 MB, beside 4 bytes a row, where indices or objects have more than 16
 * bits, or without memory. */
void label_runs_init(struct label_runs *out, const struct volume *volume, int axis);
void label_runs_finish(struct label_runs *runs);

/** How many voxels hold the object of the first, among @p count in a row from the linear index @p first on. */
size_t label_run_length(const struct volume *volume, size_t first, size_t count);

/** Tells the processor that a row will be asked for. */
static inline void label_runs_fetch(const struct label_runs *runs, size_t row)
{
    __builtin_prefetch(runs->starts + runs->rows[row]);
    __builtin_prefetch(runs->objects + runs->rows[row]);
}

/** Gives the run that holds index @p first of a row, and the one that holds @p last. */
void label_runs_between(uint32_t out[2], const struct label_runs *runs, size_t row, size_t first, size_t last);

/* The census (Eq. 10): which voxels have their centre in a region, and what they amount to for each object. Exact:
 * the voxels are those for which region_has() holds, to the last bit. */

/** @p count voxels of @p volume in the region, from indices @p at on along i. */
typedef void (*census_row)(void *user, const struct volume *volume, const size_t at[3], size_t count);

/** Calls @p row for all voxels of @p volume in @p region, in the order in which they are stored. */
void census_walk(const struct region *region, const struct volume *volume, census_row row, void *user);

/** The same for those in @p box only. */
void census_walk_box(const struct region *region, const struct volume *volume, const struct object_box *box,
                     census_row row, void *user);

/** The sums over the voxels of an object in a region. */
struct census_count {
    uint64_t voxels;
    uint64_t index[3];     /**< Sums of their i, j and k.                                                   */
    double value, maximum; /**< Sum and largest of their values; 0 of a parcellation's.                     */
    double moment[3];      /**< Sums of value times i, j, k.                                                */
};

/** How the labels of a parcellation are read, by all threads. */
struct census_labels {
    atomic_size_t counted;     /**< Voxels that have been, in all regions, without runs. */
    atomic_bool has_runs;      /**< They were found, and can be read.                    */
    struct label_runs runs[3]; /**< Along each axis; some may have none. */
};

/** Counts of all objects, kept between regions: so the cost of a query depends on what is in its region, not on the
 * size of the atlas. */
struct census {
    struct census_count *counts; /**< [object_count + 1]; [0]: voxels of the parcellation that are no object's. */
    uint32_t *touched;           /**< Objects with voxels, in ascending order; 0 is not among them.         */
    size_t touched_count;
    struct census_labels *labels; /**< [volume_count] Not owned. */
    size_t object_count;
};

/** Makes @p out [volume_count], for any number of censuses of @p atlas at once. */
conus_status census_labels_create(struct census_labels **out, const conus_atlas *atlas);
/** The atlas may be gone; it had @p count volumes. */
void census_labels_destroy(struct census_labels *labels, size_t count);

/** Reserves capacity for the objects of @p atlas, whose @p labels must live as long; a zeroed census is ready for it.
 */
conus_status census_prepare(struct census *census, const conus_atlas *atlas, struct census_labels *labels);
void census_finish(struct census *census);

/** Forgets the last region's counts and takes those of @p region. The context takes no part. */
void census_take(struct census *census, const conus_atlas *atlas, const struct region *region);

/** Whether voxels of @p object count by their values: in a pathway, which is the more there the higher they are. In a
 * band of values they say what is there, not how much. */
bool census_is_weighted(const conus_atlas *atlas, uint32_t object);

/** World position of the centroid of the voxels of @p object, weighted by value where census_is_weighted(). */
void census_centroid(double out[3], const struct census *census, const conus_atlas *atlas, uint32_t object);

/* The census of streamlines (Eq. 19): which of them come into a region, and what they amount to for each bundle. It
 * goes by the tractogram's tree, but the order of that changes no bit. */

/** The part of a run of segments in a region, and, added up, that of the streamlines of a bundle. */
struct tract_part {
    uint64_t whole_mm, parts; /**< Length: mm, and 2^-40 mm; whole numbers, whose sum has no order.             */
    uint32_t streamlines;     /**< For a run 1. */
    uint32_t streamline;      /**< Which one has the point nearest to the region's origin;                      */
    uint64_t point;           /**< that is on the segment from this point of the tractogram on,                 */
    double s;                 /**< so far along it, 0 to 1,                                                     */
    double square;            /**< and this is the square of its distance, mm^2. Of equal ones the first point. */
    double near[3];           /**< It, in the world, mm.                                                        */
};

/** Length, mm. */
double tract_part_length(const struct tract_part *part);

/** A run that lies partly in the region, and its part there. */
typedef void (*tract_run_inside)(void *user, const struct tract_run *run, const struct tract_part *part);

/** Calls @p visit for all runs of @p tractogram with a part in @p region, in the order of its tree. */
void tract_census_walk(const struct tractogram *tractogram, const struct region *region, tract_run_inside visit,
                       void *user);

/** Finds which streamlines of bundle @p number come into @p region: their numbers in the tractogram, from 0, ascending,
 * in @p out, to be ended with memory_free(). CONUS_ERROR_MEMORY. */
conus_status tract_census_list(uint32_t **out, size_t *count, const conus_atlas *atlas, uint32_t number,
                               const struct region *region);

/** Whose the streamlines are, hidden or not, and how bundles run. It follows from the atlas and does not change:
 * selectors of all threads share it. */
struct tract_index {
    struct tract_owners {
        uint32_t all;      /**< The bundle of all streamlines; 0 where there are groups. Then                     */
        uint64_t *first;   /**< [streamline_count + 1] bundles[first[k]] to before bundles[first[k + 1]]          */
        uint32_t *bundles; /**< have streamline k.                                                                */
        size_t before;     /**< How many streamlines the tractograms before have.                                 */
    } * of;                /**< [tractogram_count]                                                                */
    double (*ends)[2][3];  /**< [object_count + 1] Ends of a bundle's longest streamline, of equal ones the first; in
                              the world, mm. */
    size_t tractogram_count;
    size_t streamline_count; /**< In all tractograms. */
};

/** Takes as long as it takes to read the points of all bundles. CONUS_ERROR_MEMORY. */
conus_status tract_index_create(struct tract_index **out, const conus_atlas *atlas);
void tract_index_destroy(struct tract_index *index);

/** How far along its streamline the nearest point of bundle @p number is, 0 to 1 of its length, where that is turned so
 * as to run like the bundle's longest one. NAN of a streamline without a length. */
double tract_index_along(const struct tract_index *index, const conus_atlas *atlas, uint32_t number,
                         const struct tract_part *part);

/** Counts of all objects, kept between regions, so that a query costs what is near it. A zeroed one is ready for
 * tract_census_prepare(). */
struct tract_census {
    struct tract_part *parts; /**< [object_count + 1] */
    uint32_t *touched;        /**< Bundles with a streamline in the region, in ascending order. */
    size_t touched_count;
    uint32_t *seen;  /**< [streamline_count of the index] Number of the last region in which it was. */
    uint32_t region; /**< Number of the last one. */
};

/** Reserves capacity for what @p index has of @p atlas. */
conus_status tract_census_prepare(struct tract_census *census, const struct tract_index *index,
                                  const conus_atlas *atlas);
void tract_census_finish(struct tract_census *census);

/** Forgets the last region's counts and takes those of @p region. Hidden bundles are left out. */
void tract_census_take(struct tract_census *census, const struct tract_index *index, const conus_atlas *atlas,
                       const struct region *region);

/* The part of closed surfaces' inside that lies in a region (Eq. 10): their census, as that of voxels is. */

struct solid_block;

/** The surface of an object whose volume is known, and its triangles in blocks. */
struct solid {
    uint32_t object;
    const struct mesh *mesh; /**< The atlas's. */
    uint32_t *triangles;     /**< Its triangles, block by block. */
    struct solid_block *blocks;
    size_t block_count;
};

/** Those of an atlas, which they must not outlive. Only read once they are made. A zeroed one is empty. */
struct solids {
    struct solid *solids;
    size_t count, capacity;
};

/** Appends the surface of @p object, which has a volume (mesh_shape.has_volume). CONUS_ERROR_MEMORY. */
conus_status solids_add(struct solids *solids, uint32_t object, const struct mesh *mesh);
void solids_finish(struct solids *solids);

/** mm^3 of the inside of @p solid in the region: 0 to its whole volume, and 0 for what rounding could be. */
double solid_volume(const struct solid *solid, const struct region_solid *region);

/* The distance of each object from a point: to the cells of its voxels or to its surface. */

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

/* How far a needle stays from objects: from the cells of their voxels, their triangles, their tubes (Eq. 21). */

/** Distances of objects, or of groups of them; kept between needles. A zeroed one is ready for clearance_prepare(). */
struct clearance {
    struct clearance_found {
        double distance; /**< mm; INFINITY if none was found.                                                     */
        double depth;    /**< Where the needle is so near, the least depth.                                       */
        double point[3]; /**< The nearest point there, world mm.                                                  */
        uint64_t source; /**< The volume, mesh or tractogram that has it, in the order in which they are asked,   */
        uint64_t part;   /**< and its voxel, triangle or point there: of equal ones the lowest.                   */
    } * found;           /**< [object_count + 1]                                                                  */
    uint32_t *touched;   /**< Those that are found, in no order.                                                  */
    size_t touched_count;
    size_t object_count;
};

/** Reserves capacity for the objects of @p atlas. */
conus_status clearance_prepare(struct clearance *clearance, const conus_atlas *atlas);
void clearance_finish(struct clearance *clearance);

/** The voxels of one object in a cube of CLEARANCE_BRICK^3 voxels: the first and last along each axis. */
struct clearance_brick {
    uint32_t object;
    uint32_t first[3], last[3];
};
enum { CLEARANCE_BRICK = 4 };

/** Where the objects of an atlas are. It follows from the atlas and does not change: all threads share it. */
struct clearance_index {
    struct clearance_brick *bricks; /**< [brick_count] By object. */
    size_t brick_count;
    struct bvh *trees; /**< [object_count + 1] The box of the object's triangles in the world, or of its bricks in
                          indices; empty for a bundle, and for an object that has no shape or is hidden. */
    size_t object_count;
    double low[3], high[3]; /**< Round all that can be near, world mm; low above high where that is nothing. */
};

/** Looks at all voxels and triangles. CONUS_ERROR_MEMORY. */
conus_status clearance_index_create(struct clearance_index **out, const conus_atlas *atlas);
/** NULL is fine. */
void clearance_index_destroy(struct clearance_index *index);

/** The query to an atlas. */
struct clearance_question {
    const conus_atlas *atlas;
    const struct clearance_index *index;
    const struct tract_index *tracts; /**< Its streamlines' owners; NULL leaves bundles out. */
    const uint32_t *groups; /**< [object_count + 1] What each object counts as, a number up to object_count: the least
                               of a group is found. 0 = it takes no part. NULL = all count as 1: only the nearest of
                               all objects is found. */
    double limit;           /**< mm: what is farther is not found; finite. */
};

/** Forgets the last needle's and finds all groups that are no farther from @p needle than the limit. An answer does not
 * depend on the limit, nor on what else is asked. The context takes no part, and nothing that is hidden. */
void clearance_take(struct clearance *clearance, const struct clearance_question *question,
                    const struct needle *needle);

/* How much of a weight falls on each object of a region (Eq. 33). */

struct gathering;

/** Sums of one object. Voxels are an object's own, rays those of what it is reported as. */
struct dose {
    bool touched;
    double voxels, values,
        voxels_above;                 /**< Sums of W, and of W times value, over its voxels; cells above the level. */
    double rays, on_rays, rays_above; /**< Of a surface what of it rays pass, or of its volume in a ball, of a bundle
                                           lengths: alone, times W, and above the level. */
    uint32_t lines_above;             /**< Streamlines of a bundle that come to places above the level. */
    double largest;                   /**< The largest W; */
    double at[3];                     /**< where, world mm, */
    size_t voxel;                     /**< in which voxel: of equal ones the lowest. */
    uint32_t last_pixel;              /**< The last one whose ray passes it, and how far it is counted, mm. */
    double last_exit;
};

/** Kept between regions. A zeroed one is ready for doses_prepare(). */
struct doses {
    struct dose *of; /**< [object_count + 1] Those that are touched. */
    uint32_t *touched;
    size_t touched_count;
    uint32_t *seen;  /**< [streamline_count of the index] Number of the last region in which it was above the level. */
    uint32_t region; /**< Number of the last one. */
    double whole, whole_above; /**< Integrals over the last region; infinite where it has no end. */
    double level;              /**< W from which on a place is above; NaN where there is none. */
    struct region measured;    /**< Whose integrals these are, */
    double measured_level;     /**< and with which level. */
};

/** Keeps the larger one of the largest weight and @p value at @p world, of equal ones that of the lower voxel. */
void dose_note_largest(struct dose *dose, double value, const double world[3], size_t voxel);

conus_status doses_prepare(struct doses *doses, const conus_atlas *atlas, const struct tract_index *index);
void doses_finish(struct doses *doses);

/** Forgets the last region's doses and takes those of the region of @p gathering, whose census was taken. */
void doses_take(struct doses *doses, const struct gathering *gathering);

/** Sets shares, and the row of what is unassigned, of @p count results whose doses are set. */
void doses_share(conus_result *results, size_t count, const struct doses *doses, const conus_atlas *atlas);

/* From evidence to one result per object hit. */

struct statistics {
    conus_result *results; /**< In order of object number, then what hit nothing (object 0); kind,
                              rank and score are still to be set. */
    size_t count;
};

void statistics_finish(struct statistics *statistics);

/** Sums per object over pixels and rays, with a place for all objects: so the cost of a query depends on what it hits,
 * not on the size of the atlas. A zeroed one is ready for statistics_gather(). */
struct tally {
    struct tallied *objects; /**< [object_count + 1]; number 0 is what hit nothing.        */
    uint32_t *touched;       /**< [object_count + 1] Numbers of those that are not zeroed, */
    size_t touched_count;    /**< of which there are so many.                              */
    size_t object_count;
};

/** Reserves capacity for objects up to @p object_count. */
conus_status tally_prepare(struct tally *tally, size_t object_count);
void tally_finish(struct tally *tally);

/** The input of statistics_gather(). */
struct gathering {
    const conus_atlas *atlas;
    const struct cone *cone;
    const struct aperture *aperture; /**< Prepared for the cone; NULL where there are no pixels. */
    const struct evidence *evidence;
    const struct soft *soft;     /**< Weights of pixels, of a cone with evidence; NULL = none.         */
    const struct layers *layers; /**< Sorted; NULL = visible only.                                     */
    const struct census *census; /**< The voxels in the cone or ball; with layers or near.           */
    const struct near *near;     /**< The objects near to a ball's centre; with its census.                        */
    const struct tract_census *tracts; /**< The streamlines there, with a census; NULL = there is no bundle. */
    const struct tract_index *tract_index;
    const struct solids *solids; /**< Surfaces whose inside is counted; with a census. NULL = none. */
    const struct region *region; /**< In which it is; with solids.                                 */
    const conus_weight *weight;  /**< NULL = none. */
    const struct doses *doses;   /**< With a weight and a census; taken. Else NULL. */
    const double *whole;         /**< [object_count + 1] Whole volumes of the objects, with layers, mm^3.  */
    const uint32_t *group;       /**< [object_count + 1] As what each object is reported; NULL = itself. */
};

/** Gathers the results. For each object that an in-cone pixel hit first: pixels, share (Eq. 4), nearest distance,
 * smallest offset and contact (Eq. 11). With layers also pierced pixels, entry, exit and path length; and by census or
 * triangles (Eq. 10) what lies in the cone. An object with a voxel or some of its inside there has a result even if no
 * ray hits it; so has a bundle with a streamline there (Eq. 19). A ball has no pixels: its distance and contact are
 * those of the nearest points. @p tally is prepared for the atlas's objects. */
conus_status statistics_gather(struct statistics *out, const struct gathering *gathering, struct tally *tally);

/** The result of an object about which nothing is known. */
conus_result statistics_empty_result(uint32_t number);

#endif
