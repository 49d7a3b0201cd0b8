/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file study.h
 * Studies of a pose, of a device or of a region, each of which answers with a table.
 */
#ifndef CONUS_PUBLIC_STUDY_H
#define CONUS_PUBLIC_STUDY_H

#include <conus/arrays.h>
#include <conus/selection.h>
#include <conus/table.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Finds when a cone that grows admits each object, in the order of the angles. Occluded objects count; the selector's
 * range and level hold. Of voxels their centres count, of a mesh all its surface, and its inside where closed, of
 * streamlines all points of their lines, without a radius.
 * @param[out] out The columns of `conus sweep` (docs/formats.md) but query; end it with conus_table_destroy().
 * @param selector The selector.
 * @param pose Apex and axis.
 * @param widest Full opening to grow to, degrees, in (0, 180).
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another opening, and for a selector with a square aperture or a radius.
 */
CONUS_CHECKED conus_status conus_sweep(conus_table **out, const conus_selector *selector, const conus_pose *pose,
                                       double widest);

/** How far off a pose may be: independent normal errors (Eq. 14). */
typedef struct conus_jitter_options {
    size_t struct_size; /**< Its size, as #CONUS_JITTER_OPTIONS_INIT sets it; 0 = that of this version. */
    double tilt;  /**< Standard deviation of the axis's tilt about the device's x, and about its y; degrees, 0 to 90. */
    double shift; /**< Standard deviation of the position along each of its axes, mm, 0 to 1e6. */
    uint32_t samples;        /**< Poses to trace from, a power of two from 16 to 2^20; 0 = 1024. */
    conus_progress progress; /**< Called for each pose that was traced from; false ends it. NULL = no callback. */
    void *progress_user;     /**< Passed to @p progress. */
    double entry;  /**< In place of tilt and shift, of a needle (conus_plan_options): standard deviation of the device's
                      position along each of its x and y, mm, 0 to 1e6; */
    double target; /**< standard deviation of the far end along each of the device's x and y, mm, 0 to 1e6; */
    double depth;  /**< and that of the needle's depth, mm. */
} conus_jitter_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_JITTER_OPTIONS_INIT CONUS_INIT_(conus_jitter_options)

/** Traces from poses around @p pose as its errors make them. They are always the same ones: low-discrepancy samples
 * without a random seed.
 * @param[out] out The columns of `conus sweep --jitter` (docs/formats.md) but query, the most probable object first,
 * what is unassigned last; end it with conus_table_destroy(). The answer of a pose (p_hit) is the object that the
 * selector ranks best among those that pixels hit first.
 * @param selector The selector.
 * @param pose Apex and axis without errors.
 * @param angle As for conus_select().
 * @param options The errors; must be given.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range; #CONUS_ERROR_CANCELLED; the errors of
 * conus_select(). */
CONUS_CHECKED conus_status conus_jitter(conus_table **out, conus_selector *selector, const conus_pose *pose,
                                        double angle, const conus_jitter_options *options);

/** An error of poses that a study has published: standard deviations per axis, 0 where it has none (Eq. 29). */
typedef struct conus_pose_error {
    const char *name;     /**< "tms-cap". */
    double tilt_deg;      /**< As conus_jitter_options.tilt, degrees. */
    double shift;         /**< As conus_jitter_options.shift, mm. */
    double entry;         /**< As conus_jitter_options.entry, mm. */
    double target;        /**< As conus_jitter_options.target, mm. */
    double depth;         /**< As conus_jitter_options.depth, mm. */
    const char *measured; /**< What was measured, and how it was summed up. */
    const char *source;   /**< Where it is published. */
} conus_pose_error;

/** Finds a published error.
 * @param[out] out The error.
 * @param name Its name; of vr-controller with the target's width in degrees, 0 to 90: "vr-controller:4".
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an unknown name, with the closest one. */
CONUS_CHECKED conus_status conus_pose_error_find(conus_pose_error *out, const char *name);

/** The contacts on a shank that is given by its axis: rows of them, from the tip on. */
typedef struct conus_contacts {
    uint32_t count;   /**< All of them, up to 65536; 0 = they are not known. */
    uint32_t columns; /**< How many a row has, from 1. */
    double pitch;     /**< mm from row to row. */
    double tip;       /**< mm from the tip to the first row. */
} conus_contacts;

/** Follows the axis of a device through all objects, occluded or not. The selector's range and level hold; its radius,
 * resolution, engine and sampling do not matter: cells and triangles are found exactly, on the CPU. Rows are ordered by
 * entry, of equal ones by exit, then by object. Those of one object neither overlap nor touch. Those in no object fill
 * what is left of the range; without one, what is left up to the last exit, or to infinity where nothing is met. An
 * exit equals its entry where the axis crosses a surface that is not closed, and nothing says how far it is inside.
 * @param[out] out The columns of `conus query --segments` (docs/formats.md) but query; end it with
 * conus_table_destroy().
 * @param selector The selector. Where its engine is no exact one of rays, the first call makes one for it.
 * @param pose Apex and axis.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a pose that is not rigid. */
CONUS_CHECKED conus_status conus_segments(conus_table **out, conus_selector *selector, const conus_pose *pose);

/** Finds how far the axis of a device stays from each object, occluded or not: from the near end of the selector's
 * range to its far end, or without one as far as objects reach. Of voxels the distance is that to their cells (Eq. 5),
 * of a mesh to its triangles, and 0 where the needle begins inside of a closed one, of streamlines to their tubes (Eq.
 * 18). The selector's radius is the needle's; without one it is 0. Its level holds: a group is as near as the nearest
 * of it. Rows are ordered by clearance, of equal ones by depth, then by object.
 * @param[out] out The columns of `conus query --clearance` (docs/formats.md) but query; end it with
 * conus_table_destroy().
 * @param selector The selector. Its engine and resolution do not matter.
 * @param pose Apex and axis.
 * @param within Objects with a larger clearance are left out, mm, 0 or more; INFINITY = none is.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a pose that is not rigid or a number out of its range. */
CONUS_CHECKED conus_status conus_clearance(conus_table **out, conus_selector *selector, const conus_pose *pose,
                                           double within);

typedef struct conus_roi conus_roi; /**< A region of interest: voxels of a volume, or tetrahedra of a mesh. */

/** How a region of interest is read. */
typedef struct conus_roi_options {
    size_t struct_size;  /**< Its size, as #CONUS_ROI_OPTIONS_INIT sets it; 0 = that of this version. */
    double threshold;    /**< Above 0: voxels or tetrahedra with values at or above it are the region; below 0: those at
                            or below it. 0 = all but those of value 0, for a mask: with one value beside 0. */
    uint64_t max_memory; /**< As conus_load_options.max_memory; of arrays without meaning. */
    conus_log log;       /**< As conus_load_options.log. */
    void *log_user;      /**< Passed to @p log. */
} conus_roi_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_ROI_OPTIONS_INIT CONUS_INIT_(conus_roi_options)

/** Reads a region of interest. Values that are not finite belong to nothing.
 * @param[out] out The region; end it with conus_roi_destroy().
 * @param path The volume, as for conus_atlas_load(); or a mesh with fields of SimNIBS (.hdf5), where the field |E| or
 * that behind ",field=NAME" counts, and with ",tissue=A:B" only tetrahedra of these tissues.
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load() about volumes; #CONUS_ERROR_ARGUMENT for a threshold that is not
 * finite or that no voxel reaches, and where there is none though the volume is no mask; #CONUS_ERROR_DATA for a mask
 * without voxels. */
CONUS_CHECKED conus_status conus_roi_load(conus_roi **out, const char *path, const conus_roi_options *options);

/** Makes a region of interest of voxels in memory.
 * @param[out] out The region; end it with conus_roi_destroy().
 * @param voxels Copied.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a type or a dimension out of its range; else as conus_roi_load(). */
CONUS_CHECKED conus_status conus_roi_create(conus_roi **out, const conus_voxels *voxels,
                                            const conus_roi_options *options);

/** Ends a region of interest.
 * @param roi NULL is allowed. */
CONUS_API void conus_roi_destroy(conus_roi *roi);

/** Finds which objects a region of interest covers, and how much of each (Eq. 16): the largest volume first, last the
 * part in no object, of number 0. Areas and pathways may overlap: parts of the region need not sum to 1. The selector's
 * level holds; its angle, range and engine do not matter. Surfaces that are not closed have no inside and are left out.
 * Exact for voxels and closed surfaces as they are, and for tetrahedra in voxels. Volumes outside of all surfaces, and
 * in several surfaces that are reported as one area, are measured round 4 x 4 lines through each voxel; the parts of
 * tetrahedra in surfaces, round lines 0.5 mm from each other: there volume_error_mm3 estimates how far the volume is
 * off, rather too large than too small (of 81 volumes one was off by 1.04 of it); else it is 0.
 * @param[out] out The columns of `conus overlap` (docs/formats.md) but query, and always volume_error_mm3; end it with
 * conus_table_destroy(). Peaks are those of the voxels or tetrahedra that are there at least in part: the value
 * farthest from 0 on the threshold's side, of several the first in the file.
 * @param selector The selector.
 * @param roi In the space of the atlas; may end afterwards.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected. */
CONUS_CHECKED conus_status conus_overlap(conus_table **out, const conus_selector *selector, const conus_roi *roi);

/** mm: local maxima of a cluster are at least so far from each other. */
#define CONUS_MAXIMA_APART 8.0

/** Finds the clusters of a region of interest: voxels are of one cluster where they have a face, an edge or a corner in
 * common (26 neighbours). They are ordered by size, the largest first, then by peak, the highest first, then by the
 * place of the peak in the file. Of each a row of kind "cluster" comes first, the whole; then its parts in objects, as
 * conus_overlap() finds and orders those of the region: over all clusters they sum to it, about within its
 * volume_error_mm3; then its local maxima, the highest first, of kind "maximum". Such a one is a voxel, or connected
 * voxels of one value, without a higher neighbour (on the threshold's side); from the highest on those stay that are at
 * least #CONUS_MAXIMA_APART from all before them in their cluster. Its object is the one with the largest part of its
 * voxel; of equal parts the lowest number. Masks have none.
 * @param[out] out The columns of `conus overlap --clusters` (docs/formats.md) but query, and always volume_error_mm3;
 * end it with conus_table_destroy().
 * @param selector The selector. Its level holds; its angle, range and engine do not matter.
 * @param roi Of voxels, in the space of the atlas; may end afterwards.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a region of tetrahedra; else only #CONUS_ERROR_MEMORY is expected. */
CONUS_CHECKED conus_status conus_clusters(conus_table **out, const conus_selector *selector, const conus_roi *roi);

/** mm: how far from an end its area is looked for, unless told. */
#define CONUS_ENDPOINT_RADIUS 2.0

/** Finds the areas at both ends of streamlines: of all bundles that are not hidden, each streamline once for each of
 * its bundles. The selector's level holds. Streamlines have no direction: end_a is the area with the lower number;
 * where only one end has an area, end_b has none.
 *
 * The rows are about bundles: ordered by them, then by streamlines, the most first, then by end_a and end_b, none last.
 * With pairs the table has two parts. "pairs" has the columns without those of the bundle: the streamlines of all
 * bundles together, each counted once, whichever bundles it is in. Its area_a and area_b are rows of "areas", from 0,
 * which is the same for all bundles: the areas that have voxels or triangles and are not hidden, with ends or without,
 * ascending; after conus_atlas_show() with names, the areas named in the order of the names, also those without voxels
 * and triangles. The last row is that of ends in no area.
 * @param[out] out The columns of `conus connect` (docs/formats.md) but query; end it with conus_table_destroy().
 * @param selector The selector.
 * @param selection An answer of it, or of one of the same atlas: only streamlines that come into its cone, cylinder or
 * ball. NULL = all.
 * @param radius mm, up to 100: an end in no area has the nearest one within it. 0 = #CONUS_ENDPOINT_RADIUS; below 0 =
 * such an end has none.
 * @param with_pairs Whether the parts are wanted, too.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a radius out of its range, and for a selection of another atlas. */
CONUS_CHECKED conus_status conus_connectivity(conus_table **out, conus_selector *selector,
                                              const conus_selection *selection, double radius, bool with_pairs);

#ifdef __cplusplus
}
#endif

#endif
