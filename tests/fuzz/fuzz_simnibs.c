/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-hdf5's stream of a SimNIBS mesh: all tetrahedra have nodes, and a region of them has a volume. */
#include "base/memory.h"
#include "loaders/maps/maps.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct source_keys all = {.path = "mesh"};
    const conus_volume_info info = {.path = "mesh", .threshold = 1};
    conus_roi *roi = NULL;
    struct job job = {0};
    const char *copy = job_adopt(&job, memory_copy(data, size, 1));
    const struct hdf5 *hdf5 = hdf5_of_stream(&job, (struct text){copy, copy ? size : 0});
    if (job_ok(&job)) {
        struct roi_mesh mesh = simnibs_find(&job, hdf5, &all);
        mesh.nodes = job_give(&job, mesh.nodes, mesh.node_count * sizeof *mesh.nodes);
        mesh.tetrahedra = job_give(&job, mesh.tetrahedra, mesh.count * sizeof *mesh.tetrahedra);
        if (!JOB_CALL(&job, roi_create_mesh(&roi, &info, &mesh))) {
            memory_free(mesh.nodes);
            memory_free(mesh.tetrahedra);
        } else if (!(roi->mm3 > 0) || !isfinite(roi->mm3)) {
            abort();
        }
    }
    job_end(&job);
    conus_roi_destroy(roi);
    return 0;
}
