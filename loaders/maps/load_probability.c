/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of probabilistic atlases: which number means "certainly", and volumes divided by it. */
#include "loaders/maps/load_probability.h"

#include "base/text.h"
#include "base/tolerance.h"
#include "loaders/volumes/volume_values.h"

#include <math.h>
#include <string.h>

/* Words for a scale, as notes have it. */
static const char *scale_words(double value)
{
    return value == 1 ? "0 to 1" : value == 100 ? "percent" : value == UINT8_MAX ? "0 to 255" : "0 to 65535";
}

/* The spread over all volumes, and whether each has 0 and one other value. */
static conus_status find_spread(struct value_spread *spread, bool *masks, struct volume_file *file, struct notes *notes)
{
    conus_status status = CONUS_OK;
    *masks = true;
    for (size_t i = 0; !status && i < file->info.volume_count; i++) {
        struct value_map map = {0};
        status = volume_file_select(file, i);
        status = status ? status : volume_file_map(&map, file, notes);
        if (!status) {
            value_spread_add(spread, &map, &file->info);
            *masks = *masks && value_map_is_mask(&map);
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
    bool masks;
    uint64_t strays;
    struct value_spread spread = {0};
    struct probability_scale scale = {stated, "as stated"};
    conus_status status = find_spread(&spread, &masks, file, notes);
    if (status) {
        return status;
    }
    text_number(number, spread.largest);
    if (!(stated > 0) && masks && spread.least >= 0 && spread.largest > 1 + TOLERANCE) {
        *out = (struct probability_scale){0, "masks, since each volume has 0 and one other value, taken for 1"};
        return CONUS_OK;
    }
    if (!(stated > 0)) {
        const struct value_scale found = value_scale_of(&spread, &file->info);
        if (!found.is_probability) {
            return fail(CONUS_ERROR_DATA,
                        "%s: its largest value is %s, probabilities are 0 to 1, percent, or over the range of uint8 or "
                        "uint16%s%s; a manifest can state the scale",
                        file->path, number, found.value > 0 ? "" : ": ", found.value > 0 ? "" : found.words);
        }
        scale = (struct probability_scale){found.value, scale_words(found.value)};
    }
    if (!value_spread_strays(&strays, &spread, scale.value)) {
        return spread.least < 0 && spread.largest <= scale.value
                   ? fail(CONUS_ERROR_DATA, "%s: its least value is %s, no probability is below 0", file->path,
                          text_number(number, spread.least))
                   : fail(CONUS_ERROR_DATA, "%s: its largest value is %s, allowed is up to the scale, %s", file->path,
                          number, text_number(most, scale.value));
    }
    if (strays) {
        char least[TEXT_NUMBER_SIZE];
        status = notes_warn(notes,
                            "%s: %llu voxels have values below 0 or above the scale, %s (from %s to %s): they count as "
                            "the nearest of these",
                            file->path, (unsigned long long)strays, text_number(most, scale.value),
                            text_number(least, spread.least), number);
    }
    *out = status ? *out : scale;
    return status;
}

static void divide_values(struct volume_file *file, struct value_map *map, double stated)
{
    double own = file->info.maximum > 0 ? file->info.maximum : 1;
    double scale = stated > 0 ? stated : own;
    value_map_divide(map, scale);
    file->info.slope /= scale;
    file->info.intercept /= scale;
    file->info.minimum = fmax(file->info.minimum / scale, 0);
    file->info.maximum = fmin(file->info.maximum / scale, 1);
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
        if (!(file->info.maximum >= tolerance_least(threshold))) {
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
