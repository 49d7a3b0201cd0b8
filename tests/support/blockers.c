/* SPDX-License-Identifier: BSD-3-Clause */
/* A context volume of random values, and the threshold from which they block. */
#include "blockers.h"

#include "atlas/atlas.h"
#include "base/memory.h"
#include "scene.h"
#include "test.h"

void blockers_add(conus_atlas *atlas, uint64_t *random, const size_t dim[3], double share)
{
    size_t count = dim[0] * dim[1] * dim[2];
    conus_volume_info info = scene_grid(random, dim);
    float *values = memory_zeroed(count, sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < count; v++) {
        values[v] = (float)test_random(random, 0, 1);
    }
    info.role = CONUS_ROLE_CONTEXT;
    info.threshold = 1 - share;
    assert_ok(atlas_set_context(atlas, &info, values));
}
