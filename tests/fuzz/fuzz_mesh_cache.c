/* SPDX-License-Identifier: BSD-3-Clause */
/* An entry of the cache of meshes that somebody else may have written: as it is, and with a valid tail. */
#include "base/memory.h"
#include "loaders/child/mesh_cache.h"
#include "loaders/child/mesh_stream.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { TAIL = 24 };

static conus_status take(void *user, const struct mesh_frame *frame)
{
    struct mesh mesh = {0};
    struct mesh_shape shape;
    struct notes notes = {0};
    (void)user;
    if (frame->kind == MESH_FRAME_FAILURE) {
        return CONUS_OK;
    }
    conus_status status = mesh_take_frame(&mesh, frame, "entry", &notes, NULL);
    status = status ? status : mesh_measure(&shape, &mesh);
    mesh_finish(&mesh);
    notes_finish(&notes);
    return status;
}

/* docs/formats.md: magic, u64 size, u32 CRC-32, four zeros; written here by hand. */
static void seal(uint8_t *entry, size_t size)
{
    uint32_t sum = libdeflate_crc32(0, entry, size);
    memset(entry + size, 0, TAIL);
    memcpy(entry + size, "CONUSMC1", 8);
    for (int i = 0; i < 8; i++) {
        entry[size + 8 + (size_t)i] = (uint8_t)((uint64_t)size >> 8 * i);
    }
    for (int i = 0; i < 4; i++) {
        entry[size + 16 + (size_t)i] = (uint8_t)(sum >> 8 * i);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t content = mesh_cache_content(data, size);
    if (content != SIZE_MAX && (size < TAIL || content != size - TAIL)) {
        abort();
    }
    uint8_t *entry = memory_raw(size + TAIL, 1);
    if (!entry) {
        return 0;
    }
    if (size) {
        memcpy(entry, data, size);
    }
    seal(entry, size);
    if (mesh_cache_content(entry, size + TAIL) != size) {
        abort();
    }
    conus_status status = mesh_stream_read(entry, size, take, NULL);
    entry[size ? data[0] % (size + TAIL) : TAIL - 1] ^= 0x40;
    if (mesh_cache_content(entry, size + TAIL) != SIZE_MAX) {
        abort();
    }
    memory_free(entry);
    return status == CONUS_OK || *conus_message() ? 0 : -1;
}
