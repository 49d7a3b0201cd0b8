/* SPDX-License-Identifier: BSD-3-Clause */
/* Public facts about an atlas's tractograms. */
#include "atlas/atlas.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

/* Copies as much of `whole` as the caller's struct has. */
static void fill(void *out, size_t known, const void *whole, size_t size)
{
    memcpy(out, whole, known && known < size ? known : size);
}

size_t conus_atlas_tractogram_count(const conus_atlas *atlas)
{
    return atlas ? atlas->tractogram_count : 0;
}

conus_status conus_atlas_tractogram(conus_tractogram_info *out, const conus_atlas *atlas, size_t index)
{
    if (!out || index >= conus_atlas_tractogram_count(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "tractogram %zu, there are %zu", index, conus_atlas_tractogram_count(atlas));
    }
    const struct tractogram *tractogram = &atlas->tractograms[index];
    conus_tractogram_info whole = {.struct_size = out->struct_size,
                                   .path = tractogram->path,
                                   .format = tractogram->format,
                                   .sha256 = tractogram->sha256,
                                   .streamlines = tractogram->streamline_count,
                                   .points = tractogram->point_count,
                                   .radius = tractogram->radius,
                                   .half = !tractogram->points && tractogram->halves,
                                   .scalars = tractogram->scalar_count};
    for (uint32_t k = 0; k < tractogram->streamline_count; k++) {
        whole.length_mm += tractogram_length(tractogram, k);
    }
    for (int a = 0; a < 3; a++) {
        whole.low[a] = tractogram->point_count ? tractogram->low[a] : NAN;
        whole.high[a] = tractogram->point_count ? tractogram->high[a] : NAN;
    }
    for (size_t i = atlas->object_count; i > atlas->area_count; i--) {
        const struct object_place *place = &atlas->places[i - 1];
        if (place->is_bundle && place->index == index) {
            whole.bundle = i;
            whole.bundles++;
        }
    }
    fill(out, out->struct_size, &whole, sizeof whole);
    return CONUS_OK;
}

conus_status conus_atlas_tractogram_scalar(conus_tract_scalar *out, const conus_atlas *atlas, size_t index,
                                           size_t scalar)
{
    size_t count = index < conus_atlas_tractogram_count(atlas) ? atlas->tractograms[index].scalar_count : 0;
    if (!out || scalar >= count) {
        return fail(CONUS_ERROR_ARGUMENT, "scalar %zu of tractogram %zu, there are %zu", scalar, index, count);
    }
    const struct tract_scalar *found = &atlas->tractograms[index].scalars[scalar];
    const conus_tract_scalar whole = {.struct_size = out->struct_size,
                                      .name = found->name,
                                      .per_point = found->per_point,
                                      .components = found->components,
                                      .values = found->values};
    fill(out, out->struct_size, &whole, sizeof whole);
    return CONUS_OK;
}
