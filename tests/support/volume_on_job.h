/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Functions of volumes on a job, as tests of theirs call them: each with a job of its own. */
#ifndef CONUS_TESTS_SUPPORT_VOLUME_ON_JOB_H
#define CONUS_TESTS_SUPPORT_VOLUME_ON_JOB_H

#include "base/memory.h"
#include "loaders/volumes/volumes.h"

static inline conus_status volume_file_open(struct volume_file *out, const char *path, uint64_t max_memory,
                                            struct notes *notes)
{
    struct job job = {0};
    struct volume_file file = {0};
    volume_load(&job, &file, path, max_memory);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        volume_file_finish(&file);
    } else {
        *out = file;
    }
    return status;
}

static inline conus_status volume_file_open_labels(struct volume_file *out, struct label_voxels *labels,
                                                   const char *path, const conus_load_options *options,
                                                   const char *needed, struct notes *notes)
{
    struct job job = {0};
    struct volume_file file = {0};
    volume_load_labels(&job, &file, labels, path, NULL, options, needed);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        volume_file_finish(&file);
    } else {
        *out = file;
    }
    return status;
}

static inline conus_status volume_file_take_labels(struct label_voxels *out, struct volume_file *file)
{
    struct job job = {0};
    volume_take_labels(&job, out, file);
    return job_close(&job, NULL, NULL);
}

static inline conus_status volume_file_values(float **out, struct volume_file *file, struct notes *notes)
{
    struct job job = {0};
    float *values = volume_values(&job, file);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        memory_free(values);
    } else {
        *out = values;
    }
    return status;
}

static inline conus_status volume_file_map(struct value_map *out, struct volume_file *file, struct notes *notes)
{
    struct job job = {0};
    struct value_map map = {0};
    volume_map(&job, &map, file);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        value_map_finish(&map);
    } else {
        *out = map;
    }
    return status;
}

static inline conus_status volume_file_map_or_nan(struct value_map *out, struct volume_file *file, struct notes *notes)
{
    struct job job = {0};
    struct value_map map = {0};
    volume_map_or_nan(&job, &map, file);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        value_map_finish(&map);
    } else {
        *out = map;
    }
    return status;
}

static inline conus_status volume_file_open_series(struct volume_file *out, const char *path,
                                                   const conus_load_options *options, struct notes *notes)
{
    struct job job = {0};
    struct volume_file file = {0};
    volume_load_series(&job, &file, path, options->max_memory);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        volume_file_finish(&file);
    } else {
        *out = file;
    }
    return status;
}

static inline conus_status volume_file_select(struct volume_file *file, size_t volume)
{
    struct job job = {0};
    volume_select(&job, file, volume);
    return job_close(&job, NULL, NULL);
}

static inline conus_status volume_file_labels(struct label_voxels *out, struct volume_file *file)
{
    struct job job = {0};
    volume_labels(&job, out, file);
    return job_close(&job, NULL, NULL);
}

static inline conus_status volume_file_values_or_nan(float **out, struct volume_file *file, struct notes *notes)
{
    struct job job = {0};
    float *values = volume_values_or_nan(&job, file);
    conus_status status = job_close(&job, notes, NULL);
    if (status) {
        memory_free(values);
        return status;
    }
    *out = values;
    return CONUS_OK;
}

#endif
