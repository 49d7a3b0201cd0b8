/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Checks that hold for every parser of mesh files: an accepted mesh has no indices beyond its vertices, and can
 * be checked and taken. */
#ifndef CONUS_TESTS_FUZZ_FUZZ_FOREIGN_H
#define CONUS_TESTS_FUZZ_FUZZ_FOREIGN_H

#include "loaders/surfaces/foreign/foreign_mesh.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void check_foreign(struct foreign_mesh *foreign, conus_status status)
{
    struct mesh mesh = {0};
    struct notes notes = {0};
    for (size_t i = 0; !status && i < 3 * foreign->triangle_count; i++) {
        if (foreign->triangles[i] >= foreign->vertex_count) {
            abort();
        }
    }
    if (!status && !foreign_mesh_take(&mesh, foreign) && !mesh_check(&mesh, &notes) && !mesh.triangle_count) {
        abort();
    }
    mesh_finish(&mesh);
    notes_finish(&notes);
    foreign_mesh_finish(foreign);
}

#endif
