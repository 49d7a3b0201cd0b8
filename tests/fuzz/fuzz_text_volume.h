/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The part that fuzz targets of volumes with a text header share: they read the header, then voxels from the
 * other bytes. */
#ifndef CONUS_TESTS_FUZZ_FUZZ_TEXT_VOLUME_H
#define CONUS_TESTS_FUZZ_FUZZ_TEXT_VOLUME_H

#include "fuzz_volume.h"

#include "loaders/volumes/volume_text.h"

/** Reads volume 0 alone and all volumes, if they take at most a mebibyte: they must be the same. */
static inline void fuzz_text_voxels(const struct volume_header *header, const uint8_t *data, size_t size)
{
    enum { MOST = 1 << 20 };
    struct bytes found[2] = {{0}, {0}};
    conus_status status[2];
    if (header->volume_size > MOST || header->info.volume_count > MOST / header->volume_size) {
        return;
    }
    for (int all = 0; all < 2; all++) {
        struct stored stored = {.bytes = {memory_copy(data, size, 1), size}};
        struct gzip_range range = {0};
        status[all] =
            stored.bytes.data ? volume_text_voxels(&found[all], &range, header, &stored, all) : CONUS_ERROR_MEMORY;
        stored_finish(&stored);
    }
    if (status[0] != status[1] && !status[0] + !status[1] == 1 && status[0] != CONUS_ERROR_MEMORY &&
        status[1] != CONUS_ERROR_MEMORY) {
        abort();
    }
    if (!status[0] && !status[1]) {
        if (found[0].size != header->volume_size || memcmp(found[0].data, found[1].data, found[0].size) != 0) {
            abort();
        }
        struct volume_header plain = *header;
        plain.offset = 0;
        fuzz_decode(&plain, found[0].data, found[0].size);
    }
    bytes_finish(&found[0]);
    bytes_finish(&found[1]);
}

/** Reads @p data as the file of a header, and the labels that it has. */
static inline void fuzz_text_file(const uint8_t *data, size_t size, enum format_id format)
{
    struct volume_header header;
    struct notes notes = {0};
    struct label_table table = {0};
    const struct bytes head = {(uint8_t *)data, size};
    if (!volume_text_parse(&header, format, &head, &notes)) {
        fuzz_check_header(&header);
        fuzz_text_voxels(&header, data, size);
        if (!text_volume_labels(&table, header.text, 0, &notes)) {
            label_table_finish(&table);
        }
        volume_text_finish(&header.text);
    }
    notes_finish(&notes);
}

#endif
