/* SPDX-License-Identifier: BSD-3-Clause */
#include "atlas/area_find.h"

conus_status conus_atlas_find(uint32_t *out, const conus_atlas *atlas, const char *name)
{
    struct text text = text_from(name);
    for (size_t number = atlas->area_count + 1; number <= atlas->object_count; number++) {
        if (text_equal(text, atlas->objects[number - 1].name)) {
            *out = (uint32_t)number;
            return CONUS_OK;
        }
    }
    return text.size ? area_find(out, atlas, text) : fail(CONUS_ERROR_ARGUMENT, "name: empty, one is needed");
}
