/* SPDX-License-Identifier: BSD-3-Clause */
/* Arbitrary bytes in the place of conus-mesh's stream. */
#include "loaders/extraction/parts.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_status take(void *user, const struct mesh_frame *frame)
{
    struct mesh mesh = {0};
    struct notes notes = {0};
    (void)user;
    if (frame->triangles != frame->positions + 12 * frame->vertex_count ||
        frame->size != MESH_FRAME_HEADER_SIZE + frame->text.size + 12 * (frame->vertex_count + frame->triangle_count)) {
        abort();
    }
    if (frame->kind == MESH_FRAME_MESH && mesh_from_frame(&mesh, frame) == CONUS_OK &&
        mesh_check(&mesh, &notes) == CONUS_OK && mesh.triangle_count == 0) {
        abort();
    }
    mesh_finish(&mesh);
    notes_finish(&notes);
    return CONUS_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct mesh_frames frames = {.take = take};
    size_t used = 0;
    size_t wanted = 0;
    conus_status status = mesh_frames_take(&frames, &used, &wanted, data, size);
    if (used > size || (!status && used + wanted <= size)) {
        abort();
    }
    return status == CONUS_OK || *conus_message() ? 0 : -1;
}
