/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The checks of the volume fuzz targets once a header is read. */
#ifndef CONUS_TESTS_FUZZ_FUZZ_VOLUME_H
#define CONUS_TESTS_FUZZ_FUZZ_VOLUME_H

#include "base/memory.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_header.h"
#include "loaders/volumes/volume_values.h"
#include "tests/support/label_list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/** Decodes volume 0 if @p data holds all of it. If it is a volume of labels, the values must be the same, and so must
 * the labels that replace the voxels. */
static inline void fuzz_decode(const struct volume_header *header, const uint8_t *data, size_t size)
{
    if (header->offset > size || header->volume_size > size - header->offset) {
        return;
    }
    struct volume_file file = {.info = header->info, .datatype = header->datatype, .swapped = header->swapped};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    struct label_voxels taken = {0};
    float *values = NULL;
    file.path = memory_text("fuzz", 4);
    file.voxels.data = memory_raw(header->volume_size, 1);
    file.voxels.size = header->volume_size;
    if (file.path && file.voxels.data) {
        memcpy(file.voxels.data, data + header->offset, header->volume_size);
        conus_status status = label_list_read(&labels, &file);
        if (!volume_file_values(&values, &file, &notes) && !status) {
            for (size_t v = 0; v < header->volume_size / volume_datatype_size(header->datatype); v++) {
                if (!(fabs((double)labels[v] - (double)values[v]) <= fmax(1.0 / 16, 1e-7 * labels[v]))) {
                    abort();
                }
            }
        }
        conus_status again = volume_file_take_labels(&taken, &file);
        for (size_t v = 0; !again && !status && v < taken.count; v++) {
            if (label_voxels_at(&taken, v) != labels[v]) {
                abort();
            }
        }
    }
    label_voxels_finish(&taken);
    memory_free(labels);
    memory_free(values);
    notes_finish(&notes);
    volume_file_finish(&file);
}

#endif
