/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Meshes cut into clusters of neighbouring triangles, so that one test can leave out what a view cannot show.
 * They are laid out for drawing without a draw call, an attribute or a query per triangle: a triangle's last corner is
 * a vertex of its own, whose number is the triangle's. */
#ifndef CONUS_RENDER_ID_CLUSTERS_H
#define CONUS_RENDER_ID_CLUSTERS_H

#include "atlas/surface/mesh.h"

/** So many triangles of one mesh are a cluster, at most; so many clusters in a row, from whichever meshes, are a group,
 * and so many a range. */
enum { CLUSTER_TRIANGLES = 16, CLUSTER_GROUP = 8, CLUSTER_RANGE = 256 };

/** At most CLUSTER_TRIANGLES neighbours of one mesh. */
struct cluster {
    uint32_t first, count; /**< Triangles in drawing order. */
    uint32_t object;
};

struct clusters {
    size_t cluster_count;
    struct cluster *cluster; /**< [cluster_count] sorted by `first`.                                          */
    size_t group_count;
    float *balls; /**< [cluster_count + group_count][4] centre and radius, mm, of a ball around each cluster and each
                       group; NULL once dropped. */
    size_t range_count;
    float *range_balls; /**< [range_count][4] likewise; stays.                                                */
    size_t triangle_count;
    uint32_t *triangle; /**< [triangle_count] number in its mesh, by drawing order.                           */
    size_t vertex_count;
    float *positions;  /**< [vertex_count][3]; NULL once dropped.                                             */
    uint32_t *corners; /**< [triangle_count][3] vertices; the last one's number is the triangle's; likewise.  */
};

/** Object number k is meshes[k - 1]; NULL = it is no mesh. Neighbouring meshes come in a row. */
conus_status clusters_init(struct clusters *out, const struct mesh *const *meshes, size_t count);
void clusters_finish(struct clusters *clusters);

/** Frees balls, positions and corners once a driver has a copy. */
void clusters_drop_triangles(struct clusters *clusters);

/** The cluster of the triangle that is drawn as number @p triangle. */
const struct cluster *clusters_find(const struct clusters *clusters, uint32_t triangle);

#endif
