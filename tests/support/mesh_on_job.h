/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reading surfaces and labels of vertices with a job of their own, whose error is the status. */
#ifndef CONUS_TESTS_SUPPORT_MESH_ON_JOB_H
#define CONUS_TESTS_SUPPORT_MESH_ON_JOB_H

#include "loaders/surfaces/foreign/mesh_foreign.h"
#include "loaders/surfaces/mesh_file.h"

static inline conus_status mesh_file_read(struct mesh *out, struct label *about, const char *path,
                                          const struct mesh_file_options *options, struct notes *notes)
{
    struct job job = {0};
    surface_read(&job, out, about, path, options ? options : &(struct mesh_file_options){0});
    return job_close(&job, notes, NULL);
}

static inline conus_status vertex_labels_read(struct vertex_labels *out, const char *path,
                                              const struct mesh_file_options *options, struct notes *notes)
{
    struct job job = {0};
    surface_labels_read(&job, out, path, options ? options : &(struct mesh_file_options){0});
    return job_close(&job, notes, NULL);
}

static inline conus_status mesh_foreign_read(struct mesh *out, const char *const *paths, size_t count,
                                             enum mesh_space space, struct notes *notes)
{
    struct job job = {0};
    mesh_foreign_files(&job, out, paths, count, space);
    return job_close(&job, notes, NULL);
}

#endif
