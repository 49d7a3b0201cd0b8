/* SPDX-License-Identifier: BSD-3-Clause */
/* Refuses bands of values that are none, and notes those that look wrong. */
#include "loaders/maps/bands.h"

#include "base/memory.h"
#include "base/text_number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ENDS_SIZE = 2 * TEXT_NUMBER_SIZE + 24 };

/* "from 10 to below 20", "from 10 on", "below 20", "all values". */
static const char *ends_text(char out[ENDS_SIZE], const conus_band *band)
{
    char low[TEXT_NUMBER_SIZE];
    char high[TEXT_NUMBER_SIZE];
    text_number(low, band->low);
    text_number(high, band->high);
    if (band->low == -INFINITY) {
        snprintf(out, ENDS_SIZE, band->high == INFINITY ? "all values" : "below %s", high);
    } else if (band->high == INFINITY) {
        snprintf(out, ENDS_SIZE, "from %s on", low);
    } else {
        snprintf(out, ENDS_SIZE, "from %s to below %s", low, high);
    }
    return out;
}

static conus_status check_name(const conus_band *band, const conus_volume_info *info, const conus_atlas *atlas)
{
    char ends[ENDS_SIZE];
    if (!band->name || !band->name[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the band %s has no name", info->path, ends_text(ends, band));
    }
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        if (strcmp(atlas->objects[i].name, band->name) == 0) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: band %s: another pathway has that name", info->path, band->name);
        }
    }
    return CONUS_OK;
}

static conus_status check_ends(const conus_band *band, const conus_volume_info *info)
{
    char ends[ENDS_SIZE];
    char low[TEXT_NUMBER_SIZE];
    char high[TEXT_NUMBER_SIZE];
    if (!((float)band->low < (float)band->high)) { /* as the values are kept */
        return fail(CONUS_ERROR_ARGUMENT, "%s: band %s: from %s to below %s holds no value, the first is to be less",
                    info->path, band->name, text_number(low, band->low), text_number(high, band->high));
    }
    return (float)band->low <= (float)info->maximum && (float)band->high > (float)info->minimum
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "%s: band %s: %s, the values are from %s to %s", info->path, band->name,
                      ends_text(ends, band), text_number(low, info->minimum), text_number(high, info->maximum));
}

static int compare_ends(const void *a, const void *b)
{
    const conus_band *first = a;
    const conus_band *second = b;
    return (first->low > second->low) - (first->low < second->low);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(((const conus_band *)a)->name, ((const conus_band *)b)->name);
}

/* Of those that each are fine. Sorts them. */
static conus_status check_together(conus_band *bands, size_t count, const conus_volume_info *info)
{
    char ends[2][ENDS_SIZE];
    qsort(bands, count, sizeof *bands, compare_names);
    for (size_t i = 1; i < count; i++) {
        if (compare_names(&bands[i - 1], &bands[i]) == 0) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: two bands are called %s", info->path, bands[i].name);
        }
    }
    qsort(bands, count, sizeof *bands, compare_ends);
    for (size_t i = 1; i < count; i++) {
        if ((float)bands[i].low < (float)bands[i - 1].high) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: the bands %s (%s) and %s (%s) overlap", info->path,
                        bands[i - 1].name, ends_text(ends[0], &bands[i - 1]), bands[i].name,
                        ends_text(ends[1], &bands[i]));
        }
    }
    return CONUS_OK;
}

conus_status bands_check(const conus_band *bands, size_t count, const conus_volume_info *info, const conus_atlas *atlas)
{
    if (count > BAND_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %zu bands, allowed are up to %d", info->path, count, BAND_LIMIT);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        status = check_name(&bands[i], info, atlas);
        status = status ? status : check_ends(&bands[i], info);
    }
    conus_band *sorted = status ? NULL : memory_copy(bands, count, sizeof *bands);
    if (!sorted) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    status = check_together(sorted, count, info);
    memory_free(sorted);
    return status;
}

/* Whether nothing but its upper end keeps the largest value out of the last @p count pathways. */
static bool ends_at_the_largest(const conus_atlas *atlas, const conus_object *band, size_t count)
{
    float largest = (float)atlas->volumes[band->volume].info.maximum;
    bool is_taken = false;
    for (size_t i = atlas->object_count - count; i < atlas->object_count; i++) {
        is_taken = is_taken || (float)atlas->objects[i].low == largest;
    }
    return (float)band->high == largest && !is_taken;
}

conus_status bands_note(struct notes *notes, const conus_atlas *atlas, size_t count)
{
    conus_status status = CONUS_OK;
    for (size_t i = atlas->object_count - count; i < atlas->object_count && !status; i++) {
        const conus_object *object = &atlas->objects[i];
        const conus_band band = {object->low, object->high, object->name};
        char ends[ENDS_SIZE];
        if (!object->voxels) {
            status = notes_warn(notes, "pathway %s: no voxel has a value %s", object->name, ends_text(ends, &band));
        } else if (ends_at_the_largest(atlas, object, count)) {
            char high[TEXT_NUMBER_SIZE];
            status = notes_warn(notes,
                                "pathway %s: values are below %s, the largest of the volume, whose voxels are not in "
                                "it; without an upper end they are",
                                object->name, text_number(high, object->high));
        }
    }
    return status;
}
