/* SPDX-License-Identifier: BSD-3-Clause */
/* GIFTI documents, and the use of their arrays. */
#include "base/memory.h"
#include "loaders/surfaces/gifti.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void use_mesh(const struct gifti *gifti, bool as_stored)
{
    struct mesh mesh = {0};
    struct notes notes = {0};
    if (!gifti_mesh(&mesh, gifti, as_stored, &notes)) {
        for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
            if (mesh.triangles[i] >= mesh.vertex_count) {
                abort();
            }
        }
        if (!mesh_check(&mesh, &notes) && !mesh.triangle_count) {
            abort();
        }
    }
    mesh_finish(&mesh);
    notes_finish(&notes);
}

static void use_arrays(const struct gifti *gifti)
{
    volatile double sum = 0;
    for (size_t i = 0; i < gifti->array_count; i++) {
        const struct gifti_array *array = &gifti->arrays[i];
        size_t count = 1;
        for (size_t d = 0; d < GIFTI_RANK_LIMIT; d++) {
            count *= array->dim[d];
        }
        if (!count || count != array->count) {
            abort();
        }
        for (size_t n = 0; n < count; n++) {
            sum = sum + array->values[n];
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct gifti_options options = {.max_memory = 1 << 26};
    struct gifti gifti = {0};
    struct notes notes = {0};
    uint32_t *labels = NULL;
    size_t count;
    if (!gifti_parse(&gifti, data, size, &options, &notes)) {
        use_arrays(&gifti);
        use_mesh(&gifti, false);
        use_mesh(&gifti, true);
        if (!gifti_labels(&labels, &count, &gifti, 0, &notes)) {
            memory_free(labels);
        }
    }
    gifti_finish(&gifti);
    notes_finish(&notes);
    return 0;
}
