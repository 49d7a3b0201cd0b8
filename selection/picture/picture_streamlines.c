/* SPDX-License-Identifier: BSD-3-Clause */
/* Which streamlines stand out in a picture with a cone: those that come into it (Eq. 19). */
#include "base/memory.h"
#include "selection/measure/tract_census.h"
#include "selection/picture/picture.h"

#include <string.h>

static void mark_run(void *user, const struct tract_run *run, const struct tract_part *part)
{
    (void)part;
    bool *is_pale = user;
    is_pale[run->streamline] = false;
}

/* One after the other, [streamline_count] of each tractogram, in one block. */
static conus_status find_pale(bool **block, const bool **is_pale, const conus_atlas *atlas, const struct region *region)
{
    size_t count = 0;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        count += atlas->tractograms[i].streamline_count;
    }
    bool *next = *block = memory_raw(count, sizeof **block);
    if (!next) {
        return CONUS_ERROR_MEMORY;
    }
    memset(next, true, count);
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        tract_census_walk(&atlas->tractograms[i], region, mark_run, next);
        is_pale[i] = next;
        next += atlas->tractograms[i].streamline_count;
    }
    return CONUS_OK;
}

conus_status picture_mark_streamlines(conus_renderer *renderer, const conus_selection *selection)
{
    const conus_atlas *atlas = renderer->atlas;
    if (!atlas->tractogram_count) {
        return CONUS_OK;
    }
    bool *block = NULL;
    const bool **is_pale = memory_zeroed(atlas->tractogram_count, sizeof(void *));
    conus_status status = is_pale ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && selection) {
        status = find_pale(&block, is_pale, atlas, &selection->region);
    }
    status = status ? status : renderer_paint_streamlines(renderer, is_pale);
    memory_free(is_pale);
    memory_free(block);
    return status;
}
