/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a place, in a small atlas: a point that is found is finite, and words that are refused say why. */
#include "atlas/atlas.h"
#include "base/memory.h"
#include "conus/arrays.h"
#include "conus/place.h"
#include "poses/place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_atlas *make_atlas(void)
{
    static uint8_t labels[12 * 4 * 4];
    static const conus_label names[] = {{.number = 1, .name = "Core_L", .abbreviation = "C.L"},
                                        {.number = 2, .name = "Core_R", .abbreviation = "C.R"},
                                        {.number = 3, .name = "1, 2, 3"},
                                        {.number = 17, .name = "17"},
                                        {.number = 4, .name = "Area Fp1 (left)"},
                                        {.number = 5, .name = "L_A1_ROI"},
                                        {.number = 6, .name = "R_A1_ROI"}};
    conus_voxels voxels = {.data = labels, .type = CONUS_SCALAR_UINT8, .dim = {12, 4, 4}};
    const double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -5.5, 0, 0, 1};
    conus_atlas *atlas = NULL;
    memcpy(voxels.world_from_voxel, matrix, sizeof matrix);
    for (size_t i = 0; i < sizeof labels; i++) {
        static const uint8_t by_x[] = {1, 1, 1, 3, 4, 17, 17, 5, 6, 2, 2, 2};
        labels[i] = by_x[i % 12];
    }
    if (conus_atlas_create(&atlas, &voxels, names, sizeof names / sizeof names[0], NULL)) {
        abort();
    }
    return atlas;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double other[3] = {1, 2, 30};
    struct place_words words;
    if (!place_read(&words, (struct text){(const char *)data, size}) && !words.name.size) {
        abort();
    }
    conus_atlas *atlas = make_atlas();
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
