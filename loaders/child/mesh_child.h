/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Runs conus-mesh, the program that links VTK, as a child (base/child/child.h). */
#ifndef CONUS_LOADERS_CHILD_MESH_CHILD_H
#define CONUS_LOADERS_CHILD_MESH_CHILD_H

#include "base/child/child.h"
#include "loaders/child/mesh_stream.h"

/** A request: @p head, then @p size bytes at @p voxels (NULL if there are none). */
struct mesh_child_request {
    struct buffer head;
    const void *voxels;
    size_t size;
};

/** The path of conus-mesh, as child_find() has it; the environment's variable is CONUS_MESH. */
conus_status mesh_child_find(char **path);

/** Runs conus-mesh on @p request and gives each frame that it writes to @p take at once, except the end. Fails with the
 * status of @p take, or with one line about how the program failed: a crash, too much memory or time, its message on
 * stderr, a damaged stream. Whatever it returns, no process is left. */
conus_status mesh_child_run(const struct mesh_child_request *request, const struct child_limits *limits,
                            mesh_frame_take take, void *user);

#endif
