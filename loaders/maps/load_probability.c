/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of probabilistic atlases: which number means "certainly", and volumes divided by it. */
#include "loaders/maps/load_probability.h"

#include "base/text.h"
#include "loaders/volumes/volume_values.h"

#include <math.h>
#include <string.h>

/* Whether the file stores whole numbers of this type, unscaled. */
static bool is_stored_as(const conus_volume_info *info, const char *datatype)
{
    return strcmp(info->datatype, datatype) == 0 && info->slope == 1 && info->intercept == 0;
}

/* Probabilities are stored as 0 to 1, as percent, or over the whole range of an unsigned type. */
static conus_status choose_scale(struct probability_scale *out, const conus_volume_info *info, double maximum)
{
    char number[TEXT_NUMBER_SIZE];
    if (maximum <= 1) {
        *out = (struct probability_scale){1, "0 to 1"};
    } else if (maximum <= 100) {
        *out = (struct probability_scale){100, "percent"};
    } else if (is_stored_as(info, "uint8")) {
        *out = (struct probability_scale){UINT8_MAX, "0 to 255"};
    } else if (is_stored_as(info, "uint16") && maximum > UINT16_MAX / 2) {
        *out = (struct probability_scale){UINT16_MAX, "0 to 65535"};
    } else {
        return fail(CONUS_ERROR_DATA,
                    "%s: its largest value is %s, probabilities are 0 to 1, percent, or over the range of uint8 or "
                    "uint16; a manifest can state the scale",
                    info->path, text_number(number, maximum));
    }
    return CONUS_OK;
}

/* Facts that all volumes share. */
struct range {
    double least, largest;
    bool masks; /* Each has 0 and one other value. */
};

static conus_status find_range(struct range *range, struct volume_file *file, struct notes *notes)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < file->info.volume_count; i++) {
        struct value_map map = {0};
        status = volume_file_select(file, i);
        status = status ? status : volume_file_map(&map, file, notes);
        if (!status) {
            range->least = fmin(range->least, file->info.minimum);
            range->largest = fmax(range->largest, file->info.maximum);
            range->masks = range->masks && value_map_is_mask(&map);
        }
        value_map_finish(&map);
    }
    return status;
}

conus_status probability_scale_of(struct probability_scale *out, struct volume_file *file, double stated,
                                  struct notes *notes)
{
    char number[TEXT_NUMBER_SIZE];
    char most[TEXT_NUMBER_SIZE];
    struct range range = {.masks = true};
    struct probability_scale scale = {stated, "as stated"};
    conus_status status = find_range(&range, file, notes);
    if (!status && range.least < 0) {
        status = fail(CONUS_ERROR_DATA, "%s: its least value is %s, no probability is below 0", file->path,
                      text_number(number, range.least));
    }
    if (!status && !(stated > 0) && range.masks && range.largest > 1) {
        *out = (struct probability_scale){0, "masks, since each volume has 0 and one other value, taken for 1"};
        return CONUS_OK;
    }
    status = status || stated > 0 ? status : choose_scale(&scale, &file->info, range.largest);
    if (!status && range.largest > scale.value) {
        status = fail(CONUS_ERROR_DATA, "%s: its largest value is %s, allowed is up to the scale, %s", file->path,
                      text_number(number, range.largest), text_number(most, scale.value));
    }
    if (!status) {
        *out = scale;
    }
    return status;
}

static void divide_values(struct volume_file *file, struct value_map *map, double stated)
{
    double own = file->info.maximum > 0 ? file->info.maximum : 1;
    double scale = stated > 0 ? stated : own;
    value_map_divide(map, scale);
    file->info.slope /= scale;
    file->info.intercept /= scale;
    file->info.minimum /= scale;
    file->info.maximum /= scale;
}

conus_status probability_add(conus_atlas *atlas, struct volume_file *file, size_t volume, const struct label *label,
                             const struct probability_scale *scale, double threshold, struct notes *notes)
{
    char digits[LABEL_DIGITS];
    const conus_object area = label_object(label, atlas->object_count, digits);
    size_t note_count = atlas->notes.count;
    struct value_map map = {0};
    conus_status status = volume_file_select(file, volume);
    status = status ? status : volume_file_map(&map, file, notes);
    if (!status) {
        const conus_volume_info stored = file->info;
        divide_values(file, &map, scale->value);
        file->info.role = CONUS_ROLE_PROBABILITY;
        file->info.threshold = threshold;
        if (!((float)file->info.maximum >= (float)threshold)) {
            status = notes_add(notes, "%s has no voxels: its largest probability is %.4g, the threshold %.4g",
                               area.name, file->info.maximum, threshold);
        }
        status = status ? status : notes_move(&atlas->notes, notes);
        status = status ? status : atlas_add_probabilistic_area(atlas, &file->info, &map, &area);
        file->info = stored;
    }
    if (status) {
        value_map_finish(&map);
        notes_cut(&atlas->notes, note_count);
    }
    return status;
}
