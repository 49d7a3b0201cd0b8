/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_volume VOLUME VALUES LABELS: writes the decoded voxels raw, as float32 into VALUES and, if they are labels, as
 * uint32 into LABELS, and the header's fields to stdout, for tests/oracles/compare_volumes.py. */
#include "base/memory.h"
#include "loaders/volumes/volumes.h"
#include "tests/support/label_list.h"
#include "tests/support/volume_on_job.h"

#include <stdio.h>
#include <stdlib.h>

static void print_info(const struct volume_file *file, const struct notes *notes)
{
    const conus_volume_info *info = &file->info;
    printf("dim %zu %zu %zu\nvolumes %zu\nformat %s\ntransform %s\naffine", info->dim[0], info->dim[1], info->dim[2],
           info->volume_count, info->format, info->transform);
    for (int i = 0; i < 16; i++) {
        printf(" %.17g", info->world_from_voxel[4 * (i % 4) + i / 4]);
    }
    printf("\nminimum %.17g\nmaximum %.17g\n", info->minimum, info->maximum);
    for (size_t i = 0; i < notes->count; i++) {
        printf("note %s\n", notes->lines[i]);
    }
}

static conus_status write_raw(const char *path, const void *voxels, const conus_volume_info *info)
{
    size_t count = info->dim[0] * info->dim[1] * info->dim[2];
    FILE *stream = fopen(path, "wb");
    bool written = stream && fwrite(voxels, 4, count, stream) == count;
    written = stream && fclose(stream) == 0 && written;
    return written ? CONUS_OK : fail(CONUS_ERROR_IO, "%s: cannot write", path);
}

static conus_status dump(struct volume_file *file, char **argv, struct notes *notes)
{
    uint32_t *labels = NULL;
    float *values = NULL;
    conus_status status = volume_file_values(&values, file, notes);
    if (!status) {
        status = write_raw(argv[2], values, &file->info);
    }
    if (!status) {
        print_info(file, notes);
        if (label_list_read(&labels, file)) {
            printf("unlabelled %s\n", conus_message());
        } else {
            status = write_raw(argv[3], labels, &file->info);
        }
    }
    memory_free(labels);
    memory_free(values);
    return status;
}

int main(int argc, char **argv)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    if (argc != 4) {
        fprintf(stderr, "dump_volume VOLUME VALUES LABELS\n");
        return 2;
    }
    conus_status status = volume_file_open(&file, argv[1], 0, &notes);
    if (!status) {
        status = dump(&file, argv, &notes);
    }
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    }
    notes_finish(&notes);
    volume_file_finish(&file);
    return status ? EXIT_FAILURE : EXIT_SUCCESS;
}
