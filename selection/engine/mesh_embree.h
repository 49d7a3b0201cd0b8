/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Embree's scene of the surfaces, for those who send rays into it. */
#ifndef CONUS_SELECTION_ENGINE_MESH_EMBREE_H
#define CONUS_SELECTION_ENGINE_MESH_EMBREE_H

#include "selection/engine/embree.h"
#include "selection/engine/mesh_rays.h"

#include <pthread.h>

struct surface {
    const struct mesh *mesh;
    const uint32_t *triangles;     /**< Of the mesh, */
    const float *positions;        /**< so that both are at hand. */
    const double *mesh_from_world; /**< NULL = the identity */
};

struct mesh_rays {
    RTCDevice device;
    RTCScene scene;
    struct surface *surfaces;      /**< [count] */
    double (*mesh_from_world)[16]; /**< [count] if any surface has one */
    double low[3], high[3];        /**< Bounds of everything. */
    double slack;                  /**< mm */
    double cell;                   /**< mm: how far apart triangles are. */
    pthread_mutex_t noting;        /**< An error: several threads may send rays at once. */
    _Atomic(enum RTCError) error;  /**< Embree's first. */
    char message[160];             /**< Written before it. */
};

/** CONUS_OK, or what Embree has complained about so far. */
conus_status mesh_embree_status(const struct mesh_rays *rays);

#endif
