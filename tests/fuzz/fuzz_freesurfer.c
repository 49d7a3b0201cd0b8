/* SPDX-License-Identifier: BSD-3-Clause */
/* FreeSurfer surfaces. */
#include "loaders/surfaces/parts.h"
#include "sources/source.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    for (int as_stored = 0; as_stored < 2; as_stored++) {
        struct mesh mesh = {0};
        struct job job = {0};
        struct reader r = reader_of(&job, (struct text){(const char *)data, size});
        freesurfer_surface_read(&r, &mesh, as_stored);
        if (job_ok(&job)) {
            if (!freesurfer_is_surface(data, size) || !mesh.vertex_count || !mesh.triangle_count) {
                abort();
            }
            if (!mesh_check(&mesh, &job.notes) && !mesh.triangle_count) {
                abort();
            }
        }
        mesh_finish(&mesh);
        job_end(&job);
    }
    return 0;
}
