/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A .dlabel.nii as a file, one map of it, and what that says of vertices and voxels. */
#ifndef CONUS_LOADERS_CIFTI_CIFTI_FILE_H
#define CONUS_LOADERS_CIFTI_CIFTI_FILE_H

#include "loaders/cifti/cifti.h"

/** One map of a file. What it points to is the job's. */
struct cifti_choice {
    struct cifti cifti; /**< Without values. */
    size_t map;
    struct label_table table; /**< Of the map, sorted; label 0 is nothing. */
    uint32_t *labels;         /**< [cifti.count] of the grayordinates; 0 = no area. */
};

/** Parses @p file and takes the map @p wanted (map_choice_make()). NULL after a failure. */
struct cifti_choice *cifti_choose(struct job *job, const struct bytes *file, struct text wanted);

/** The surface that GIFTI calls @p structure, or NULL. */
const struct cifti_model *cifti_choice_surface(const struct cifti_choice *choice, const char *structure);

/** Whether the file has voxels. */
bool cifti_choice_has_voxels(const struct cifti_choice *choice);

/** The labels that @p model has, or all voxels where that is NULL: *count, sorted, each once, without 0. */
uint32_t *cifti_list(struct job *job, size_t *count, const struct cifti_choice *choice,
                     const struct cifti_model *model);

/** Labels of all vertices of the surface @p model: [model->vertex_count], 0 for those that the file leaves out. The
 * empty @p table gets what the map says of those that there are. NULL after a failure. */
uint32_t *cifti_vertices(struct job *job, struct label_table *table, const struct cifti_choice *choice,
                         const struct cifti_model *model);

/** Labels of all voxels of the volume, [dim[0] dim[1] dim[2]], i fastest, likewise. The hemisphere of a label is that
 * of the structures that have it, if it is one. */
uint32_t *cifti_voxels(struct job *job, struct label_table *table, const struct cifti_choice *choice);

/** A file, opened by its path with ",map=K" or ",map=NAME" behind it. */
struct cifti_file {
    const char *path; /**< Without what chooses the map. */
    char sha256[65];  /**< SHA-256 of the file as it is stored. */
    struct cifti_choice *choice;
};

/** Opens @p path, a .dlabel.nii (FORMAT_CIFTI), plain or gzip. Notes and errors carry the path. NULL after a failure.
 */
struct cifti_file *cifti_file_open(struct job *job, const char *path);

#endif
