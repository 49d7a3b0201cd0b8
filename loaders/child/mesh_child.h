/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Runs conus-mesh, the program that links VTK, with limits on memory, processor time and waiting, so that a reader
 * that crashes or never ends costs an error line and nothing else. */
#ifndef CONUS_LOADERS_CHILD_MESH_CHILD_H
#define CONUS_LOADERS_CHILD_MESH_CHILD_H

#include "base/buffer.h"
#include "loaders/child/mesh_stream.h"

struct mesh_child_limits {
    uint64_t memory;  /**< Address space in bytes, of conus-mesh and of one mesh here.             */
    uint32_t seconds; /**< Processor time of all its threads. */
    uint32_t wait;    /**< Seconds until it must have ended; a busy machine gives it a small part. */
};

/** A request: @p head, then @p size bytes at @p voxels (NULL if there are none). */
struct mesh_child_request {
    struct buffer head;
    const void *voxels;
    size_t size;
};

/** The path of conus-mesh: $CONUS_MESH, else beside the running program, else in $PATH. CONUS_ERROR_UNSUPPORTED where
 * there is none. memory_free() it. */
conus_status mesh_child_find(char **path);

/** Runs conus-mesh on @p request and gives every frame of what it writes to @p take as it comes, the end excepted.
 * Fails with what @p take returns, or with one line about what became of the program: a crash, too much memory or time,
 * what it said on stderr, a stream that is none. Whatever it returns, no process is left. */
conus_status mesh_child_run(const struct mesh_child_request *request, const struct mesh_child_limits *limits,
                            mesh_frame_take take, void *user);

#endif
