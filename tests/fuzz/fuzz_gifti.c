/* SPDX-License-Identifier: BSD-3-Clause */
/* GIFTI documents, and the use of their arrays. */
#include "loaders/surfaces/parts.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void use_mesh(const struct gifti *gifti, bool as_stored)
{
    struct job job = {0};
    struct mesh mesh = {0};
    gifti_surface(&job, &mesh, gifti, as_stored);
    if (job_ok(&job)) {
        for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
            if (mesh.triangles[i] >= mesh.vertex_count) {
                abort();
            }
        }
        if (!mesh_check(&mesh, &job.notes) && !mesh.triangle_count) {
            abort();
        }
    }
    mesh_finish(&mesh);
    job_end(&job);
}

static void use_arrays(const struct gifti *gifti)
{
    volatile double sum = 0;
    for (size_t i = 0; i < gifti->arrays.count; i++) {
        const struct gifti_array *array = &gifti->arrays.at[i];
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
    struct job job = {.max_memory = 1 << 26};
    size_t count;
    struct gifti *gifti = gifti_read(&job, text_from_bytes(data, size), NULL);
    if (gifti) {
        use_arrays(gifti);
        use_mesh(gifti, false);
        use_mesh(gifti, true);
        gifti_settle_labels(&job, gifti);
        (void)gifti_vertices(&job, &count, gifti, 0);
    }
    job_end(&job);
    return 0;
}
