/* SPDX-License-Identifier: BSD-3-Clause */
/* TRX archives. Checksums of stored files are corrected first: otherwise no change would be read. */
#include "fuzz_tractogram.h"

#include "base/formats/packed.h"
#include "base/memory.h"
#include "loaders/tracts/tracts.h"

#include <string.h>
#include <zlib.h>

enum { LIMIT = 1 << 22 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void put_u32(uint8_t *to, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        to[i] = (uint8_t)(value >> 8 * i);
    }
}

/* In the directory, an entry's name is 46 bytes behind its beginning, the checksum 16, the place of the file's header
 * 42; in that header the checksum is at 14. */
static void mend(struct bytes *archive)
{
    struct job job = {0};
    const struct zip zip = zip_parse(&job, archive->data, archive->size);
    for (size_t i = 0; i < zip.count; i++) {
        const struct zip_entry *entry = &zip.entries[i];
        uint8_t *central = archive->data + ((const uint8_t *)entry->name.data - archive->data) - 46;
        size_t header = 0;
        for (int b = 3; b >= 0; b--) {
            header = header << 8 | central[42 + b];
        }
        if (!entry->is_packed && header < archive->size) {
            uint32_t sum = (uint32_t)crc32(0, archive->data + entry->at, (uInt)entry->stored);
            put_u32(central + 16, sum);
            put_u32(archive->data + header + 14, sum);
        }
    }
    job_end(&job);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    struct bytes archive = {memory_copy(data, size, 1), size};
    struct job job = {.max_memory = LIMIT};
    mend(&archive);
    tract_file_parse(&job, &tractogram, (struct text){(const char *)archive.data, archive.size});
    if (!job_close(&job, &notes, NULL)) {
        fuzz_tractogram_read(&tractogram);
    }
    tractogram_finish(&tractogram);
    bytes_finish(&archive);
    notes_finish(&notes);
    return 0;
}
