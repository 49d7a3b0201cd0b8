/* SPDX-License-Identifier: BSD-3-Clause */
/* conus-hdf5's stream of a SimNIBS mesh: all tetrahedra have nodes, and a region of them has a volume. */
#include "base/memory.h"
#include "loaders/maps/simnibs.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct volume_selector all = {0};
    const conus_volume_info info = {.path = "mesh", .threshold = 1};
    struct hdf5 *hdf5 = NULL;
    struct roi_mesh mesh = {0};
    conus_roi *roi = NULL;
    struct notes notes = {0};
    struct bytes stream = {memory_copy(data, size, 1), size};
    conus_status status = stream.data ? hdf5_parse(&hdf5, &stream) : CONUS_ERROR_MEMORY;
    status = status ? status : simnibs_find(&mesh, hdf5, &all, &notes);
    status = status ? status : roi_create_mesh(&roi, &info, &mesh);
    if (status) {
        memory_free(mesh.nodes);
        memory_free(mesh.tetrahedra);
    } else if (!(roi->mm3 > 0) || !isfinite(roi->mm3)) {
        abort();
    }
    conus_roi_destroy(roi);
    notes_finish(&notes);
    hdf5_destroy(hdf5);
    return 0;
}
