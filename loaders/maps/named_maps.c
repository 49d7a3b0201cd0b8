/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes that a table names are probabilities, unless something speaks against it: values as in a scan, volumes that
 * are all above 0 at the same places, as images of one thing are, or values that look like labels. */
#include "loaders/maps/maps.h"

#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/labels/label_format.h"
#include "loaders/labels/labels.h"
#include "loaders/volumes/volumes.h"
#include "sources/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct label_table no_table = {0};

/* The names that a table gives to all volumes. */
static struct named_maps find_names(struct job *job, const conus_volume_info *info, const conus_load_options *options)
{
    struct named_maps out = {.table = &no_table};
    struct label_table *table = labels_new(job);
    const char *labels = options->labels;
    const struct label_use use = {.info = info};
    struct attempt attempt = job_try(job); /* what is noted is the atlas's, if it gets these names */
    const char *from = label_volume_table(job, table, labels, &use);
    if (labels && !from) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: has %zu volumes, --labels %s does not name them: needed is another name for each number from 0 "
                 "to %zu, or from 1 to %zu; FILE,volume=K chooses one",
                 info->path, info->volume_count, path_base(labels), info->volume_count - 1, info->volume_count);
    }
    label_drop_background(job, table);
    if (job_ok(job) && table->count) {
        out.table = table;
        out.source = job_format(job, "names of the volumes in %s", from);
        out.notes = attempt_notes(job, &attempt);
        attempt_end(job, &attempt, ATTEMPT_KEEP);
    } else {
        attempt_end(job, &attempt, ATTEMPT_SILENT);
    }
    return out;
}

static bool is_chosen(const struct source_keys *keys)
{
    return keys->given & KEY_BIT(KEY_VOLUME);
}

/* The volume is called as its file is. */
static struct named_maps name_one(struct job *job, const struct source_keys *keys)
{
    const char *name = path_base(keys->path);
    struct label_table *table = labels_new(job);
    labels_set(job, &labels_add(job, table, (uint32_t)keys_value(keys, KEY_VOLUME)->numbers[0] + 1)->name,
               (struct text){name, volume_stem_length(name)});
    return (struct named_maps){job_ok(job) ? table : &no_table, "the file's name", NULL, is_chosen(keys), true};
}

struct named_maps named_maps_find(struct job *job, const struct source *source, const char *path,
                                  const conus_load_options *options)
{
    struct named_maps maps = {.table = &no_table};
    struct source_keys keys;
    conus_volume_info info = {0};
    struct attempt attempt = job_try(job); /* its reader says what is wrong with it */
    source_keys_read(job, &keys, path, KEYS_VOLUME);
    bool is_volume = job_ok(job) && !options->labels_anyway && /* each volume is one of labels */
                     source_scene(source) == FORMAT_OTHER && source_first(source) != '<';
    const struct volume_wish wish = {.source = source, .is_header_only = true, .is_peek = true};
    const struct volume_input *v = is_volume && source->is_open ? volume_open(job, path, &wish) : NULL;
    if (v) {
        info = v->header.info;
    }
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    bool stated = is_volume && (options->probability > 0 || named_maps_is_probseg(keys.path));
    if (!is_chosen(&keys) && info.volume_count > 1) {
        info.path = keys.path;
        maps = find_names(job, &info, options);
        if (stated && !maps.table->count) {
            job_fail(job, CONUS_ERROR_ARGUMENT,
                     "%s: has %zu volumes of probabilities, as its name or --probability states, and nothing names "
                     "them: --labels FILE does, FILE,volume=K takes one",
                     keys.path, info.volume_count);
        }
    } else if (stated && options->labels) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: one volume of probabilities is called as its file is, --labels names all volumes of a file",
                 path);
    } else if (stated) {
        maps = name_one(job, &keys);
    }
    return maps;
}

static const double most_percent = 100 * (1 + TOLERANCE);

/* Sums over all volumes. */
struct findings {
    uint16_t *above; /* [voxels] In how many volumes the value is above 0. */
    double minimum, maximum;
    size_t fractions, positive; /* Voxels with no whole number, and above 0. */
    size_t like_labels;         /* Volumes of whole numbers that do not look like an image. */
};

/* Whether the values, all of them whole numbers, look like labels. */
static bool look_like_labels(struct job *job, const struct volume_file *file, const float *values)
{
    const size_t *dim = file->info.dim;
    struct label_voxels voxels = {0};
    size_t count = dim[0] * dim[1] * dim[2];
    uint32_t *numbers = job_array(job, &count, sizeof *numbers);
    for (size_t i = 0; i < count; i++) {
        numbers[i] = (uint32_t)values[i];
    }
    (void)JOB_CALL(job, label_voxels_of(&voxels, numbers, count));
    const struct grey_result result = grey_judge(job, &voxels, dim, &(struct grey_claims){0});
    label_voxels_finish(&voxels);
    return job_ok(job) && !result.grey;
}

static void add_findings(struct job *job, struct findings *findings, const struct volume_file *file,
                         const float *values)
{
    const conus_volume_info *info = &file->info;
    size_t fractions = 0;
    size_t positive = 0;
    findings->minimum = fmin(findings->minimum, info->minimum);
    findings->maximum = fmax(findings->maximum, info->maximum);
    for (size_t i = 0; i < info->dim[0] * info->dim[1] * info->dim[2]; i++) {
        findings->above[i] = (uint16_t)(findings->above[i] + (values[i] > 0));
        double value = (double)values[i];
        fractions += tolerance_whole(value, fabs(value)) != rint(value);
        positive += value > 0;
    }
    findings->fractions += fractions;
    findings->positive += positive;
    bool ask =
        fractions <= positive / 100 && info->minimum >= 0 && info->maximum > 1.5 && info->maximum <= most_percent;
    findings->like_labels += ask && look_like_labels(job, file, values);
}

/* The mean share of the other volumes above 0, over the voxels where one is above 0. */
static double overlap(const struct findings *findings, const conus_volume_info *info)
{
    double places = 0;
    double others = 0;
    for (size_t i = 0; i < info->dim[0] * info->dim[1] * info->dim[2]; i++) {
        places += findings->above[i] > 0;
        others += findings->above[i] > 0 ? findings->above[i] - 1 : 0;
    }
    return places > 0 ? others / places / (double)(info->volume_count - 1) : 0;
}

/* Words for what speaks against probabilities, "" if nothing does. */
static const char *find_reason(struct job *job, const struct findings *findings, const conus_volume_info *info)
{
    static const double most = 2.0 / 3;
    double part = overlap(findings, info);
    if (findings->minimum < -TOLERANCE || findings->maximum > most_percent) {
        return job_format(job, "values from %.9g to %.9g are not probabilities, 0 to 1 or percent", findings->minimum,
                          findings->maximum);
    }
    if (findings->fractions <= findings->positive / 100 && findings->like_labels) {
        return job_format(job, "the whole numbers in %zu of them may be labels", findings->like_labels);
    }
    return part > most ? job_format(job,
                                    "where one is above 0, %.0f %% of the others are, too, as in images of one thing; "
                                    "of areas up to 67 %% are",
                                    100 * part)
                       : "";
}

bool named_maps_is_probseg(const char *path)
{
    static const char ending[] = "_probseg";
    const char *name = path_base(path);
    size_t length = volume_stem_length(name);
    return length >= strlen(ending) && strncmp(name + length - strlen(ending), ending, strlen(ending)) == 0;
}

void named_maps_check(struct job *job, struct volume_file *file, double asked)
{
    struct findings findings = {.minimum = INFINITY, .maximum = -INFINITY};
    if (!job_ok(job) || asked > 0 || named_maps_is_probseg(file->path)) {
        return;
    }
    const conus_volume_info *info = &file->info;
    struct job_mark mark = job_mark(job);
    findings.above = job_zeroed(job, info->dim[0] * info->dim[1] * info->dim[2], sizeof *findings.above);
    for (size_t i = 0; job_ok(job) && i < info->volume_count; i++) {
        struct job_mark volume = job_mark(job);
        volume_select(job, file, i);
        float *values = volume_values(job, file);
        if (values && job_adopt(job, values)) {
            add_findings(job, &findings, file, values);
        }
        job_release(job, volume);
    }
    const char *reason = job_ok(job) ? find_reason(job, &findings, info) : "";
    if (reason[0]) {
        job_bad(job,
                "%s: a table names its %zu volumes, but %s; FILE,volume=K chooses one, --probability T takes them for "
                "areas by probabilities",
                file->path, info->volume_count, reason);
    }
    job_release(job, mark);
}
