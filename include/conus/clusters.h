/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file clusters.h
 * The clusters of a region of interest: which areas and pathways each covers (Eq. 16), and its local maxima.
 */
#ifndef CONUS_PUBLIC_CLUSTERS_H
#define CONUS_PUBLIC_CLUSTERS_H

#include <conus/overlap.h>

#ifdef __cplusplus
extern "C" {
#endif

/** mm: local maxima of a cluster are at least so far from each other. */
#define CONUS_MAXIMA_APART 8.0

/**
 * Finds the clusters of a region of interest: voxels are of one cluster where they have a face, an edge or a corner in
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
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a region of tetrahedra; else only #CONUS_ERROR_MEMORY is expected.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_clusters(conus_table **out, const conus_selector *selector, const conus_roi *roi);

#ifdef __cplusplus
}
#endif

#endif
