/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file overlap.h
 * Which areas and pathways a region of interest covers: a lesion, an activation, a tract's end (Eq. 16).
 */
#ifndef CONUS_PUBLIC_OVERLAP_H
#define CONUS_PUBLIC_OVERLAP_H

#include <conus/arrays.h>
#include <conus/selection.h>
#include <conus/table.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

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

/**
 * Reads a region of interest. Values that are not finite belong to nothing.
 * @param[out] out The region; end it with conus_roi_destroy().
 * @param path The volume, as for conus_atlas_load(); or a mesh with fields of SimNIBS (.hdf5), where the field |E| or
 * that behind ",field=NAME" counts, and with ",tissue=A:B" only tetrahedra of these tissues.
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load() about volumes; #CONUS_ERROR_ARGUMENT for a threshold that is not
 * finite or that no voxel reaches, and where there is none though the volume is no mask; #CONUS_ERROR_DATA for a mask
 * without voxels.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_roi_load(conus_roi **out, const char *path, const conus_roi_options *options);

/**
 * Makes a region of interest of voxels in memory.
 * @param[out] out The region; end it with conus_roi_destroy().
 * @param voxels Copied.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a type or a dimension out of its range; else as conus_roi_load().
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_roi_create(conus_roi **out, const conus_voxels *voxels,
                                            const conus_roi_options *options);

/**
 * Ends a region of interest.
 * @param roi NULL is allowed.
 * @threads One at a time for each @p roi.
 * @since 0.1
 */
CONUS_API void conus_roi_destroy(conus_roi *roi);

/**
 * Describes the volume of a region of interest; of tetrahedra a grid of 2 mm that they lie in.
 * @param roi The region.
 * @return Its threshold is the one that holds, 0 of a mask. Borrowed from the region.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_volume_info *conus_roi_volume(const conus_roi *roi);

/**
 * Counts the voxels, or the tetrahedra, of a region of interest.
 * @param roi NULL counts 0.
 * @return At least 1.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API uint64_t conus_roi_voxels(const conus_roi *roi);

/**
 * Finds which objects a region of interest covers, and how much of each (Eq. 16): the largest volume first, last the
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
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_overlap(conus_table **out, const conus_selector *selector, const conus_roi *roi);

#ifdef __cplusplus
}
#endif

#endif
