/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a level, except those that open files, on an atlas of three depths, plain or merged. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void need(conus_status status)
{
    if (status) {
        abort();
    }
}

static conus_atlas *make_atlas(unsigned kind)
{
    static const struct {
        const char *name, *abbreviation;
        uint32_t parent;
    } areas[] = {{"Brain", "BR", 0},   {"Cortex", "CTX", 1},      {"Area_L", "A_L", 2},
                 {"Area_R", "A_R", 2}, {"V1, layer 4", "V14", 2}, {"Thalamus", "TH", 1},
                 {"7", "", 6},         {"Same", "", 0},           {"Same", "", 0}};
    conus_atlas *atlas = NULL;
    need(atlas_create_empty(&atlas, "here"));
    for (uint32_t i = 0; i < sizeof areas / sizeof areas[0]; i++) {
        const conus_object area = {.kind = CONUS_KIND_AREA,
                                   .label = i + 11,
                                   .name = areas[i].name,
                                   .abbreviation = areas[i].abbreviation,
                                   .parent = areas[i].parent};
        need(atlas_add_group(atlas, &area));
    }
    need(kind % 2 ? conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED) : CONUS_OK);
    return atlas;
}

/* With every level an area is reported as itself or as one of its ancestors. */
static void check(const conus_atlas *atlas, const struct level *level)
{
    const uint32_t *group = level_group(level);
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        uint32_t at = number;
        while (at && at != group[number]) {
            at = atlas->objects[at - 1].parent;
        }
        if (!at || group[group[number]] != group[number]) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (!size || memchr(data, '@', size)) {
        return 0;
    }
    conus_atlas *atlas = make_atlas(data[0]);
    struct level *level = NULL;
    char *spec = memory_text((const char *)data + 1, size - 1);
    if (!spec) {
        abort();
    }
    if (!level_create(&level, atlas, spec)) {
        check(atlas, level);
    } else if (strchr(conus_message(), '\n') && !memchr(data, '\n', size)) {
        abort();
    }
    level_destroy(level);
    memory_free(spec);
    conus_atlas_destroy(atlas);
    return 0;
}
