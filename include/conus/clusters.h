/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file clusters.h
 * The clusters of a region of interest: which areas and pathways each covers (Eq. 16), and its local maxima.
 */
#ifndef CONUS_PUBLIC_CLUSTERS_H
#define CONUS_PUBLIC_CLUSTERS_H

#include <conus/overlap.h>

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** mm: local maxima of a cluster are at least so far from each other. */
#define CONUS_MAXIMA_APART 8.0

typedef struct conus_clusters conus_clusters; /**< The clusters of a region of interest. */

/** What a row is about. */
typedef enum conus_cluster_part {
    CONUS_CLUSTER_WHOLE = 1, /**< The cluster. */
    CONUS_CLUSTER_COVERAGE,  /**< Its part in one area or pathway, or in none. */
    CONUS_CLUSTER_MAXIMUM    /**< A local maximum of it. */
} conus_cluster_part;

/** A row of a cluster. Voxels are of one cluster where they have a face, an edge or a corner in common: 26 neighbours.
 */
typedef struct conus_cluster_row {
    conus_kind kind;         /**< Kind of the object; #CONUS_KIND_UNASSIGNED: none, and of a whole cluster. */
    uint32_t object;         /**< Number in the atlas, as it is reported (level), or 0. Of a maximum the object with the
                                largest part of its voxel; of equal parts the lowest number. */
    conus_cluster_part part; /**< What the row is about. */
    uint32_t cluster;        /**< Number of the cluster, from 1. */
    uint64_t voxels;         /**< Of a whole cluster: how many it has. Else 0. */
    double volume;           /**< mm³: of the cluster; of the part of it that is in the object. NaN of a maximum. */
    double fraction;         /**< Of a coverage: that part of the object, as conus_coverage.fraction. Else NaN. */
    double cluster_fraction; /**< That part of the cluster, 1 of a whole one. NaN of a maximum. */
    double peak; /**< The value farthest from 0 on the threshold's side, in the cluster or in that part of it; of
                    a maximum its value. */
    double peak_point[3]; /**< Centre of the voxel that has it, world mm; of several the first in the file. */
    double centre[3];    /**< Of a whole cluster: centre of mass, the voxels weighted by the size of their values, world
                            mm. Else NaN. */
    double volume_error; /**< As conus_coverage.volume_error. */
} conus_cluster_row;

/**
 * Finds the clusters of a region of interest. A part of a cluster in an object is found as conus_overlap_create() finds
 * that of the region: over all clusters they sum to it, about within its volume_error. A local maximum is a voxel, or
 * connected voxels of one value, without a higher neighbour (on the threshold's side); from the highest on those stay
 * that are at least #CONUS_MAXIMA_APART from all before them in their cluster. Masks have none.
 * @param[out] out The clusters; end it with conus_clusters_destroy().
 * @param selector The selector. Its level holds; its angle, range and engine do not matter.
 * @param roi Of voxels, in the space of the atlas; may end afterwards.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a region of tetrahedra; else only #CONUS_ERROR_MEMORY is expected.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_clusters_create(conus_clusters **out, const conus_selector *selector,
                                                 const conus_roi *roi);

/**
 * Ends clusters.
 * @param clusters NULL is allowed.
 * @threads One at a time for each @p clusters.
 * @since 0.1
 */
CONUS_API void conus_clusters_destroy(conus_clusters *clusters);

/**
 * Counts the rows. Clusters are ordered by size, the largest first, then by peak, the highest first, then by the place
 * of the peak in the file. Of each the whole comes first, then its coverages in the order of conus_overlap_coverage(),
 * then its maxima, the highest first.
 * @param clusters NULL counts 0.
 * @return How many rows there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_clusters_count(const conus_clusters *clusters);

/**
 * Gives row @p index.
 * @param clusters The clusters.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the clusters.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_cluster_row *conus_clusters_row(const conus_clusters *clusters, size_t index);

#ifdef __cplusplus
}
#endif

#endif
