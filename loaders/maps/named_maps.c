/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes that a table names are probabilities, unless something speaks against it: values as in a scan, volumes that
 * are all above 0 at the same places, as images of one thing are, or values that look like labels. */
#include "loaders/maps/named_maps.h"

#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/labels/label_cells.h"
#include "loaders/labels/label_volumes.h"
#include "loaders/volumes/grey.h"
#include "loaders/volumes/volume_selector.h"
#include "loaders/volumes/volume_values.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void named_maps_finish(struct named_maps *maps)
{
    label_table_finish(&maps->table);
    memory_free(maps->source);
    file_sums_finish(&maps->read);
    notes_finish(&maps->notes);
}

static conus_status find_names(struct named_maps *out, const conus_volume_info *info, const conus_load_options *options)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    const char *labels = options->labels;
    struct label_table *table = labels_new(&job);
    const struct label_use use = {.info = info, .max_memory = options->max_memory};
    const char *from = label_volume_table(&job, table, labels, &use);
    if (labels && !from) {
        job_fail(&job, CONUS_ERROR_ARGUMENT,
                 "%s: has %zu volumes, --labels %s does not name them: needed is another name for each number from "
                 "0 to %zu, or from 1 to %zu; FILE,volume=K chooses one",
                 info->path, info->volume_count, path_base(labels), info->volume_count - 1, info->volume_count);
    }
    if (from) {
        char *source = job_format(&job, "names of the volumes in %s", from);
        label_drop_background(&job, table);
        out->source = job_give(&job, source, strlen(source) + 1);
        out->table = *table;
        *table = (struct label_table){0};
    }
    return job_close(&job, &out->notes, &out->read);
}

/* The volume is called as its file is. */
static conus_status name_one(struct named_maps *out, const struct volume_selector *selector)
{
    static const char source[] = "the file's name";
    const char *name = path_base(selector->path);
    struct label *label = label_table_add(&out->table, (uint32_t)selector->volume + 1);
    out->source = memory_text(source, strlen(source));
    out->chosen = selector->chosen;
    out->is_one = true;
    return label && out->source ? label_set_text(&label->name, (struct text){name, volume_stem_length(name)})
                                : CONUS_ERROR_MEMORY;
}

conus_status named_maps_find(struct named_maps *out, const struct probe *probe, const char *path,
                             const conus_load_options *options)
{
    struct named_maps maps = {0};
    struct volume_selector selector = {0};
    conus_volume_info info = {0};
    conus_status status = volume_selector_parse(&selector, path);
    bool is_volume = !status && !options->labels_anyway && /* each volume is one of labels */
                     probe->reader == READER_VOLUME && probe->first != '<';
    bool stated = is_volume && (options->probability > 0 || named_maps_is_probseg(selector.path));
    bool has_header = is_volume && probe->is_open && !volume_bytes_header(&info, path, &probe->stored);
    bool is_whole = !selector.chosen && has_header && info.volume_count > 1;
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK; /* its reader says what is wrong with it */
    if (is_whole) {
        info.path = selector.path;
        status = find_names(&maps, &info, options);
        if (!status && stated && !maps.table.count) {
            status =
                fail(CONUS_ERROR_ARGUMENT,
                     "%s: has %zu volumes of probabilities, as its name or --probability states, and nothing names "
                     "them: --labels FILE does, FILE,volume=K takes one",
                     selector.path, info.volume_count);
        }
    } else if (!status && stated) {
        status = !options->labels ? name_one(&maps, &selector)
                                  : fail(CONUS_ERROR_ARGUMENT,
                                         "%s: one volume of probabilities is called as its file is, --labels names all "
                                         "volumes of a file",
                                         path);
    }
    volume_selector_finish(&selector);
    if (status) {
        named_maps_finish(&maps);
        return status;
    }
    *out = maps;
    return CONUS_OK;
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
static conus_status look_like_labels(bool *labels, const struct volume_file *file, const float *values)
{
    const size_t *dim = file->info.dim;
    struct grey_result result = {0};
    struct label_voxels voxels = {0};
    uint32_t *numbers = memory_raw(dim[0] * dim[1] * dim[2], sizeof *numbers);
    conus_status status = numbers ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < dim[0] * dim[1] * dim[2]; i++) {
        numbers[i] = (uint32_t)values[i];
    }
    status = status ? status : label_voxels_of(&voxels, numbers, dim[0] * dim[1] * dim[2]);
    status = status ? status : grey_judge(&result, &voxels, dim, &(struct grey_claims){0});
    *labels = !result.grey;
    label_voxels_finish(&voxels);
    memory_free(numbers);
    return status;
}

static conus_status add_findings(struct findings *findings, const struct volume_file *file, const float *values)
{
    const conus_volume_info *info = &file->info;
    size_t fractions = 0;
    size_t positive = 0;
    bool labels = false;
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
    conus_status status = ask ? look_like_labels(&labels, file, values) : CONUS_OK;
    findings->like_labels += labels;
    return status;
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

static conus_status check_findings(const struct findings *findings, const struct volume_file *file)
{
    static const double most = 2.0 / 3;
    char reason[200];
    double part = overlap(findings, &file->info);
    if (findings->minimum < -TOLERANCE || findings->maximum > most_percent) {
        snprintf(reason, sizeof reason, "values from %.9g to %.9g are not probabilities, 0 to 1 or percent",
                 findings->minimum, findings->maximum);
    } else if (findings->fractions <= findings->positive / 100 && findings->like_labels) {
        snprintf(reason, sizeof reason, "the whole numbers in %zu of them may be labels", findings->like_labels);
    } else if (part > most) {
        snprintf(
            reason, sizeof reason,
            "where one is above 0, %.0f %% of the others are, too, as in images of one thing; of areas up to 67 %% are",
            100 * part);
    } else {
        return CONUS_OK;
    }
    return fail(CONUS_ERROR_DATA,
                "%s: a table names its %zu volumes, but %s; FILE,volume=K chooses one, --probability T takes them for "
                "areas by probabilities",
                file->path, file->info.volume_count, reason);
}

bool named_maps_is_probseg(const char *path)
{
    static const char ending[] = "_probseg";
    const char *name = path_base(path);
    size_t length = volume_stem_length(name);
    return length >= strlen(ending) && strncmp(name + length - strlen(ending), ending, strlen(ending)) == 0;
}

conus_status named_maps_check(struct volume_file *file, double asked, struct notes *notes)
{
    struct findings findings = {.minimum = INFINITY, .maximum = -INFINITY};
    if (asked > 0 || named_maps_is_probseg(file->path)) {
        return CONUS_OK;
    }
    const size_t *dim = file->info.dim;
    findings.above = memory_zeroed(dim[0] * dim[1] * dim[2], sizeof *findings.above);
    conus_status status = findings.above ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < file->info.volume_count; i++) {
        float *values = NULL;
        status = volume_file_select(file, i);
        status = status ? status : volume_file_values(&values, file, notes);
        status = status ? status : add_findings(&findings, file, values);
        memory_free(values);
    }
    status = status ? status : check_findings(&findings, file);
    memory_free(findings.above);
    return status;
}
