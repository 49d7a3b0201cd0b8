/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Checks that hold for every parser of mesh files: an accepted mesh has no indices beyond its vertices, and can
 * be checked and taken. */
#ifndef CONUS_TESTS_FUZZ_FUZZ_FOREIGN_H
#define CONUS_TESTS_FUZZ_FUZZ_FOREIGN_H

#include "loaders/surfaces/foreign/foreign.h"
#include "loaders/surfaces/foreign/parts.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void check_build(struct mesh_build *build)
{
    struct job *job = build->sink.job;
    struct mesh mesh = {0};
    for (size_t i = 0; job_ok(job) && i < 3 * build->triangles.count; i++) {
        if (build->triangles.at[i / 3].corners[i % 3] >= build->sink.vertices.count) {
            abort();
        }
    }
    mesh_build_give(&mesh, build);
    if (JOB_CALL(job, mesh_check(&mesh, &job->notes)) && !mesh.triangle_count) {
        abort();
    }
    mesh_finish(&mesh);
    job_end(job);
}

static inline void check_foreign(mesh_parser *parse, const uint8_t *data, size_t size)
{
    struct job job = {.max_memory = 1 << 24};
    struct mesh_build build = mesh_build_of(&job);
    parse(&build.sink, (struct text){(const char *)data, size});
    check_build(&build);
}

#endif
