/* SPDX-License-Identifier: BSD-3-Clause */
/* Wavefront OBJ: every triangle has an object, every object a triangle, and no two the same name. */
#include "fuzz_foreign.h"

static void check_objects(const struct foreign_mesh *mesh, const struct obj_objects *objects)
{
    size_t next = 0; /* objects are numbered as they come first */
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        if (objects->owners[i] > next) {
            abort();
        }
        next += objects->owners[i] == next;
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
    struct foreign_mesh mesh = {0};
    struct obj_objects objects = {0};
    conus_status status = obj_parse(&mesh, &objects, data, size);
    if (!status) {
        check_objects(&mesh, &objects);
    }
    obj_objects_finish(&objects);
    check_foreign(&mesh, status);
    return 0;
}
