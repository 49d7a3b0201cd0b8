/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-hdf5's stream of a SimNIBS mesh: all tetrahedra have nodes, and a region of them has a volume. */
#include "base/memory.h"
#include "loaders/maps/simnibs.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct volume_selector all = {.path = (char *)"mesh"};
    const conus_volume_info info = {.path = "mesh", .threshold = 1};
    struct hdf5 *hdf5 = NULL;
    conus_roi *roi = NULL;
    struct job job = {0};
    struct bytes stream = {memory_copy(data, size, 1), size};
    if (stream.data && JOB_CALL(&job, hdf5_parse(&hdf5, &stream))) {
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
    hdf5_destroy(hdf5);
    return 0;
}
