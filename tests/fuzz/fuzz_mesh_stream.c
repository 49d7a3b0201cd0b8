/* SPDX-License-Identifier: BSD-3-Clause */
/* Arbitrary bytes in the place of conus-mesh's stream. */
#include "loaders/child/mesh_stream.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_status take(void *user, const struct mesh_frame *frame)
{
    struct mesh mesh = {0};
    struct notes notes = {0};
    (void)user;
    if (frame->size != (size_t)(frame->triangles - frame->bytes) + 12 * frame->triangle_count) {
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
    conus_status status = mesh_stream_read(data, size, take, NULL);
    return status == CONUS_OK || *conus_message() ? 0 : -1;
}
