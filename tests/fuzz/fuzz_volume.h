/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A volume's file of any bytes, as fuzz targets of volumes read it. */
#ifndef CONUS_TESTS_FUZZ_FUZZ_VOLUME_H
#define CONUS_TESTS_FUZZ_FUZZ_VOLUME_H

#include "base/memory.h"
#include "loaders/labels/labels.h"
#include "loaders/volumes/text/text_volume.h"
#include "loaders/volumes/volumes.h"
#include "tests/support/label_list.h"
#include "tests/support/volume_on_job.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { FUZZ_MEMORY = 1 << 20 };

/** The path of a file in memory that holds @p data until the next call; NULL where there is none. */
static inline const char *fuzz_path(const uint8_t *data, size_t size)
{
    static char path[64];
    static int file = -1;
    file = file < 0 ? memfd_create("fuzz", 0) : file;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    return file >= 0 && !ftruncate(file, 0) && pwrite(file, data, size, 0) == (ssize_t)size ? path : NULL;
}

/** Aborts if an accepted header breaks a promise to its readers. */
static inline void fuzz_check_header(const struct volume_header *header)
{
    const conus_volume_info *info = &header->info;
    size_t size = info->dim[0] * info->dim[1] * info->dim[2] * volume_datatype_size(header->datatype);
    if (!info->volume_count || !size || size != header->volume_size || !isfinite(info->slope) ||
        !isfinite(info->intercept)) {
        abort();
    }
    for (int i = 0; i < 16; i++) {
        if (!isfinite(info->world_from_voxel[i])) {
            abort();
        }
    }
}

/* Reads the header, and what names labels in it. */
static inline void fuzz_header(const char *path)
{
    struct job job = {.max_memory = FUZZ_MEMORY};
    size_t sum = 0;
    struct volume_input *v = volume_open(&job, path, &(struct volume_wish){.is_header_only = true});
    if (v) {
        fuzz_check_header(&v->header);
        volume_choose(&job, v, true, false);
        for (size_t i = 0; i < v->extension_count; i++) {
            for (size_t k = 0; k < v->extensions[i].size; k++) {
                sum += v->extensions[i].data[k]; /* every byte must be readable */
            }
        }
        if (v->text) {
            text_volume_labels(&job, labels_new(&job), v->text, 0);
        }
    }
    if (sum > 255 * (size_t)FUZZ_MEMORY) {
        abort();
    }
    job_end(&job);
}

/* If they are labels, the values must be the same, and so must the labels that replace the voxels. */
static inline void fuzz_decode(struct volume_file *file, struct notes *notes)
{
    uint32_t *labels = NULL;
    struct label_voxels taken = {0};
    float *values = NULL;
    conus_status status = label_list_read(&labels, file);
    if (!volume_file_values(&values, file, notes) && !status) {
        for (size_t v = 0; v < file->voxels.size / volume_datatype_size(file->datatype); v++) {
            if (!(fabs((double)labels[v] - (double)values[v]) <= fmax(1.0 / 16, 1e-7 * labels[v]))) {
                abort();
            }
        }
    }
    conus_status again = volume_file_take_labels(&taken, file);
    for (size_t v = 0; !again && !status && v < taken.count; v++) {
        if (label_voxels_at(&taken, v) != labels[v]) {
            abort();
        }
    }
    label_voxels_finish(&taken);
    memory_free(labels);
    memory_free(values);
}

/** Reads @p data as a file, if they begin like one of the format: volume 0 alone and as one of all, which must be the
 * same. */
static inline void fuzz_volume(const uint8_t *data, size_t size, enum format_id format)
{
    struct volume_file alone = {0};
    struct volume_file series = {0};
    struct notes notes = {0};
    char chosen[128];
    const conus_load_options options = {.max_memory = FUZZ_MEMORY};
    const char *path =
        format_id_of(&(struct bytes){(uint8_t *)data, size}, ROLE_VOLUME) == format ? fuzz_path(data, size) : NULL;
    if (!path) {
        return;
    }
    snprintf(chosen, sizeof chosen, "%s,volume=0%s", path,
             format == FORMAT_TIFF ? ",resolution=25,orientation=asr" : "");
    fuzz_header(chosen);
    const bool has_series = !volume_file_open_series(&series, chosen, &options, &notes);
    const bool has_one = !volume_file_open(&alone, chosen, FUZZ_MEMORY, &notes);
    if (has_series && has_one &&
        (series.voxels.size != alone.voxels.size ||
         memcmp(series.voxels.data, alone.voxels.data, alone.voxels.size) != 0)) {
        abort();
    }
    if (has_one) {
        fuzz_decode(&alone, &notes);
    }
    notes_finish(&notes);
    volume_file_finish(&series);
    volume_file_finish(&alone);
}

#endif
