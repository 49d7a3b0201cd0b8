/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a place, in a small atlas: a point that is found is finite, and words that are refused say why. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "conus/pose.h"
#include "poses/rows/pose_row.h"
#include "tests/support/builders/place_atlas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double other[3] = {1, 2, 30};
    struct place_words words;
    if (!place_read(&words, (struct text){(const char *)data, size}) && !words.name.size) {
        abort();
    }
    conus_atlas *atlas = place_atlas();
    char *text = memory_text((const char *)data, size);
    conus_place place = {.object = UINT32_MAX};
    if (!text) {
        abort();
    }
    const conus_place_options options = {.other = other, .has_axis = size % 2};
    conus_status status = conus_place_find(&place, atlas, text, &options);
    if (status ? place.object != UINT32_MAX || !conus_message()[0] || strchr(conus_message(), '\n')
               : !isfinite(place.point[0]) || !isfinite(place.point[1]) || !isfinite(place.point[2])) {
        abort();
    }
    if (!status) {
        char said[CONUS_PLACE_TEXT];
        conus_place_text(said, &place, NULL);
    }
    memory_free(text);
    conus_atlas_destroy(atlas);
    return 0;
}
