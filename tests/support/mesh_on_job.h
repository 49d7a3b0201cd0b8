/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Reading surfaces and labels of vertices with a job of their own, whose error is the status. */
#ifndef CONUS_TESTS_SUPPORT_MESH_ON_JOB_H
#define CONUS_TESTS_SUPPORT_MESH_ON_JOB_H

#include "loaders/surfaces/foreign/foreign.h"
#include "loaders/surfaces/surfaces.h"

/* What was read is let go where its notes find no memory. */
static inline conus_status mesh_file_read(struct mesh *out, struct label *about, const char *path,
                                          const struct mesh_file_options *options, struct notes *notes)
{
    struct job job = {0};
    struct mesh mesh = {0};
    struct label said = {0};
    surface_read(&job, &mesh, about ? &said : NULL, path, options ? options : &(struct mesh_file_options){0});
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        mesh_finish(&mesh);
        label_finish(&said);
        return status;
    }
    *out = mesh;
    if (about) {
        *about = said;
    }
    return CONUS_OK;
}

static inline conus_status vertex_labels_read(struct vertex_labels *out, const char *path,
                                              const struct mesh_file_options *options, struct notes *notes)
{
    struct job job = {0};
    struct vertex_labels labels = {0};
    surface_labels_read(&job, &labels, path, options ? options : &(struct mesh_file_options){0});
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        vertex_labels_finish(&labels);
    } else {
        *out = labels;
    }
    return status;
}

static inline conus_status mesh_foreign_read(struct mesh *out, const char *const *paths, size_t count,
                                             enum mesh_space space, struct notes *notes)
{
    struct job job = {0};
    struct mesh meshes[8] = {0};
    const size_t most = sizeof meshes / sizeof meshes[0];
    mesh_foreign_files(&job, meshes, paths, count < most ? count : most, space);
    conus_status status = job_close(&job, notes, NULL);
    for (size_t i = 0; i < count && i < most; i++) {
        if (status) {
            mesh_finish(&meshes[i]);
        } else {
            out[i] = meshes[i];
        }
    }
    return status;
}

#endif
