/* SPDX-License-Identifier: BSD-3-Clause */
/* Wavefront OBJ: every triangle has an object, every object a triangle, and no two the same name. */
#include "fuzz_foreign.h"

static void check_objects(const struct mesh_build *mesh, const struct mesh_objects *objects)
{
    size_t next = 0; /* objects are numbered as they come first */
    for (size_t i = 0; i < mesh->triangles.count; i++) {
        if (mesh->owners.at[i] > next) {
            abort();
        }
        next += mesh->owners.at[i] == next;
    }
    if (next != objects->count) {
        abort();
    }
    for (size_t i = 0; i < objects->count; i++) {
        for (size_t k = 0; k < i; k++) {
            if (text_compare(objects->names[i], objects->names[k]) == 0) {
                abort();
            }
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    struct mesh_build mesh = mesh_build_of(&job);
    obj_parse(&mesh.sink, (struct text){(const char *)data, size});
    const struct mesh_objects objects = mesh_build_objects(&mesh);
    if (job_ok(&job)) {
        check_objects(&mesh, &objects);
    }
    check_build(&mesh);
    return 0;
}
