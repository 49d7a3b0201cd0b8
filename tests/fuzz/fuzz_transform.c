/* SPDX-License-Identifier: BSD-3-Clause */
/* Transforms of all programs: an accepted one moves points to points. */
#include "base/geometry/math3.h"
#include "loaders/transform/transform.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const struct bytes file = {(uint8_t *)data, size};
    const enum format_id id = format_id_of(&file, ROLE_TRANSFORM);
    if (id == FORMAT_HDF5 || id == FORMAT_NIFTI || id == FORMAT_NRRD || id == FORMAT_METAIMAGE) {
        return -1; /* their readers open the file */
    }
    for (size_t chosen = 0; chosen < 2; chosen++) {
        struct transform_chain made = {0};
        double p[3] = {1, 2, 3};
        struct job job = {0};
        transform_read(&job, &made, source_of_memory(&job, "file.txt", (struct text){(const char *)data, size}),
                       &(conus_transform_options){.transform = chosen});
        if (job_close(&job, NULL, NULL)) {
            transform_chain_finish(&made);
            continue;
        }
        const double *m = made.matrix;
        double inverse[16];
        if (!mat4_invert_affine(inverse, m) || m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) {
            abort();
        }
        for (int i = 0; i < 3 && made.count; i++) { /* a node, a place between nodes, and one outside */
            const double q[3] = {1 + 0.5 * i, 1.25, 1.75};
            mat4_point(p, made.fields[0].world_from_voxel, q);
            (void)deformation_point(p, &made.fields[0], p);
        }
        transform_chain_finish(&made);
    }
    return 0;
}
