/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of probabilistic atlases: which number means "certainly", and volumes divided by it. */
#include "loaders/maps/maps.h"

#include "base/text.h"
#include "base/tolerance.h"
#include "loaders/volumes/volumes.h"

#include <math.h>

static const char *scale_words(double value)
{
    return value == 1 ? "0 to 1" : value == 100 ? "percent" : value == UINT8_MAX ? "0 to 255" : "0 to 65535";
}

static void finish_maps(void *given)
{
    struct probability_maps *maps = given;
    for (size_t i = 0; maps->volumes && i < maps->count; i++) {
        value_map_finish(&maps->volumes[i].map);
    }
}

struct probability_maps *probability_maps_new(struct job *job, struct volume_file *file)
{
    struct probability_maps *maps = job_new(job, struct probability_maps);
    if (maps) {
        *maps = (struct probability_maps){.file = file, .count = file->info.volume_count, .masks = true};
        maps->volumes = job_zeroed(job, maps->count, sizeof *maps->volumes);
        job_own(job, finish_maps, maps);
    }
    return job_ok(job) ? maps : NULL;
}

void probability_maps_read(struct job *job, struct probability_maps *maps, size_t volume, bool kept)
{
    struct value_map map = {0};
    if (job_ok(job)) {
        volume_select(job, maps->file, volume);
        volume_map(job, &map, maps->file);
    }
    if (job_ok(job)) {
        value_spread_add(&maps->spread, &map, &maps->file->info);
        maps->masks = maps->masks && value_map_is_mask(&map);
        if (kept) {
            maps->volumes[volume] = (struct probability_map){maps->file->info, map};
            return;
        }
    }
    value_map_finish(&map);
}

/* Refuses values that are none of the scale, and warns of a few. */
static void check_strays(struct job *job, const struct value_spread *spread, double scale, const char *path)
{
    uint64_t strays = 0;
    const char *least = NUMBER_TEXT(spread->least);
    const char *largest = NUMBER_TEXT(spread->largest);
    const char *most = NUMBER_TEXT(scale);
    if (value_spread_strays(&strays, spread, scale)) {
        if (strays) {
            job_note(job,
                     "%s: %llu voxels have values below 0 or above the scale, %s (from %s to %s): they count as the "
                     "nearest of these",
                     path, (unsigned long long)strays, most, least, largest);
        }
    } else if (spread->least < 0 && spread->largest <= scale) {
        job_bad(job, "%s: its least value is %s, no probability is below 0", path, least);
    } else {
        job_bad(job, "%s: its largest value is %s, allowed is up to the scale, %s", path, largest, most);
    }
}

struct probability_scale probability_scale_of(struct job *job, const struct probability_maps *maps, double stated)
{
    struct probability_scale scale = {stated, "as stated"};
    if (!job_ok(job)) {
        return scale;
    }
    const struct value_spread spread = maps->spread;
    const struct volume_file *file = maps->file;
    if (!(stated > 0)) {
        if (maps->masks && spread.least >= 0 && spread.largest > 1 + TOLERANCE) {
            return (struct probability_scale){0, "masks, since each volume has 0 and one other value, taken for 1"};
        }
        const struct value_scale found = value_scale_of(&spread, &file->info);
        if (!found.is_probability) {
            job_bad(job,
                    "%s: its largest value is %s, probabilities are 0 to 1, percent, or over the range of uint8 or "
                    "uint16%s%s; a manifest can state the scale",
                    file->path, NUMBER_TEXT(spread.largest), found.value > 0 ? "" : ": ",
                    found.value > 0 ? "" : found.words);
        }
        scale = (struct probability_scale){found.value, scale_words(found.value)};
    }
    check_strays(job, &spread, scale.value, file->path);
    return scale;
}

static void divide_values(conus_volume_info *info, struct value_map *map, double stated)
{
    double own = info->maximum > 0 ? info->maximum : 1;
    double scale = stated > 0 ? stated : own;
    value_map_divide(map, scale);
    info->slope /= scale;
    info->intercept /= scale;
    info->minimum = fmax(info->minimum / scale, 0);
    info->maximum = fmin(info->maximum / scale, 1);
}

void probability_add(struct job *job, conus_atlas *atlas, struct probability_maps *maps, size_t volume,
                     const struct label *label, const struct probability_scale *scale, double threshold)
{
    char digits[LABEL_DIGITS];
    if (job_ok(job) && volume >= maps->count) {
        volume_select(job, maps->file, volume); /* says that it is not there */
    }
    if (!job_ok(job)) {
        return;
    }
    struct probability_map *of = &maps->volumes[volume];
    const conus_object area = label_object(label, atlas->object_count, digits);
    conus_volume_info info = of->info;
    info.path = maps->file->path; /* that of its own may have been opened again */
    divide_values(&info, &of->map, scale->value);
    info.role = CONUS_ROLE_PROBABILITY;
    info.threshold = threshold;
    if (!(info.maximum >= tolerance_least(threshold))) {
        job_note(job, "%s has no voxels: its largest probability is %.4g, the threshold %.4g", area.name, info.maximum,
                 threshold);
    }
    atlas_take(job, atlas);
    (void)JOB_CALL(job, atlas_add_probabilistic_area(atlas, &info, &of->map, &area));
}
