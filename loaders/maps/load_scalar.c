/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes whose values are numbers, not names: conus_atlas_add_pathway(), the volume of conus_atlas_set_context(), and
 * conus_roi_load(). */
#include "loaders/maps/load_scalar.h"

#include "atlas/atlas.h"
#include "atlas/fit/box_fit.h"
#include "atlas/fit/fit.h"
#include "base/buffer.h"
#include "base/files/file_trace.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/text_number.h"
#include "base/tolerance.h"
#include "loaders/labels/fsl_find.h"
#include "loaders/labels/label_volumes.h"
#include "loaders/maps/simnibs.h"
#include "loaders/volumes/volume_values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum {
    BAND_LIMIT = 4096,  /* most bands of one volume */
    HDF5_HEAD = 1 << 16 /* where the mark of HDF5 is looked for */
};

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

static conus_status check_band(const conus_band *band, const conus_volume_info *info, const conus_atlas *atlas)
{
    char ends[ENDS_SIZE];
    char low[TEXT_NUMBER_SIZE];
    char high[TEXT_NUMBER_SIZE];
    if (!band->name || !band->name[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the band %s has no name", info->path, ends_text(ends, band));
    }
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        if (strcmp(atlas->objects[i].name, band->name) == 0) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: band %s: another pathway has that name", info->path, band->name);
        }
    }
    if (!((float)band->low < (float)band->high)) { /* as the values are kept */
        return fail(CONUS_ERROR_ARGUMENT, "%s: band %s: from %s to below %s holds no value, the first is to be less",
                    info->path, band->name, text_number(low, band->low), text_number(high, band->high));
    }
    return tolerance_least(band->low) <= info->maximum && tolerance_least(band->high) > info->minimum
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

static int compare_band_names(const void *a, const void *b)
{
    return strcmp(((const conus_band *)a)->name, ((const conus_band *)b)->name);
}

/* No two bands may have one name, or overlap. Each is valid by itself. Sorts them. */
static conus_status check_together(conus_band *bands, size_t count, const conus_volume_info *info)
{
    char ends[2][ENDS_SIZE];
    qsort(bands, count, sizeof *bands, compare_band_names);
    for (size_t i = 1; i < count; i++) {
        if (compare_band_names(&bands[i - 1], &bands[i]) == 0) {
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

/* Whether bands can be pathways of the volume info, whose minimum and maximum are known, in atlas: each has a
 * name of its own and holds some of the range of values, and none overlap. CONUS_ERROR_ARGUMENT with the file. */
static conus_status bands_check(const conus_band *bands, size_t count, const conus_volume_info *info,
                                const conus_atlas *atlas)
{
    if (count > BAND_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %zu bands, allowed are up to %d", info->path, count, BAND_LIMIT);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        status = check_band(&bands[i], info, atlas);
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
    double largest = atlas->volumes[band->volume].info.maximum;
    bool is_taken = false;
    for (size_t i = atlas->object_count - count; i < atlas->object_count; i++) {
        is_taken = is_taken || tolerance_same(atlas->objects[i].low, largest);
    }
    return tolerance_same(band->high, largest) && !is_taken;
}

/* Notes bands that look wrong, among those that have just become the last pathways of atlas: bands without voxels, and
 * bands that end at the largest value, so that no band has it. */
static conus_status bands_note(struct notes *notes, const conus_atlas *atlas, size_t count)
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

/* Eq. 6's threshold: the one asked for, or a quarter of the scale; of a mask that never comes to it, of its value. */
static conus_status choose_threshold(struct volume_file *file, const struct value_map *map, double wanted,
                                     const char *name, struct notes *notes)
{
    conus_volume_info *info = &file->info;
    char threshold[TEXT_NUMBER_SIZE];
    char maximum[TEXT_NUMBER_SIZE];
    text_number(maximum, info->maximum);
    if (!(info->maximum > 0)) {
        return fail(CONUS_ERROR_DATA, "%s: its largest value is %s, a pathway needs values above 0", info->path,
                    maximum);
    }
    if (!(wanted >= 0 && tolerance_least(wanted) <= info->maximum)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: threshold %s, allowed is above 0 to %s, the largest value (0 = default)",
                    info->path, text_number(threshold, wanted), maximum);
    }
    struct value_spread spread = {0};
    value_spread_add(&spread, map, info);
    struct value_scale scale = value_scale_of(&spread, info);
    if (info->maximum < scale.value / 4 && value_map_is_mask(map)) {
        scale = (struct value_scale){info->maximum, false, "0 and one other value, taken as a mask"};
    }
    info->threshold = wanted > 0 ? wanted : scale.value / 4;
    text_number(threshold, info->threshold);
    if (!(info->threshold > 0)) {
        return fail(CONUS_ERROR_DATA, "%s: values up to %s: %s: give a threshold", info->path, maximum, scale.words);
    }
    uint64_t strays = 0;
    if (!(wanted > 0) && scale.is_probability && info->minimum >= 0 &&
        value_spread_strays(&strays, &spread, scale.value) && strays &&
        notes_warn(notes, "pathway %s: %llu voxels have values above the scale, %g, up to %s", name,
                   (unsigned long long)strays, scale.value, maximum)) {
        return CONUS_ERROR_MEMORY;
    }
    if (tolerance_least(info->threshold) > info->maximum) {
        return fail(CONUS_ERROR_DATA,
                    "%s: the default threshold %s (%s) is above its largest value %s: give a threshold", info->path,
                    threshold, scale.words, maximum);
    }
    return wanted > 0 ? CONUS_OK : notes_add(notes, "pathway %s: %s; threshold %s", name, scale.words, threshold);
}

/* The title of the volume in the file (but for AFNI's "#0"); else the file's name without folder and ending, and with
 * the volume where there are several. */
static conus_status name_by_file(struct buffer *out, const struct volume_file *file)
{
    const conus_volume_info *info = &file->info;
    if (file->title && file->title[0] != '#') {
        buffer_text(out, file->title);
        return buffer_status(out);
    }
    const char *name = path_base(info->path);
    buffer_append(out, name, volume_stem_length(name));
    if (info->volume_count > 1) {
        buffer_format(out, ",volume=%zu", info->volume);
    }
    return buffer_status(out);
}

/* The name that FSL atlas XMLs, or a table beside the file, give to a volume. */
struct title {
    const conus_volume_info *info;
    struct buffer *name;
    struct buffer from; /* the file that says so */
};

static conus_status agree_on_title(struct title *title, const char *name, const char *from)
{
    if (!title->from.size) {
        buffer_text(title->name, name);
        buffer_text(&title->from, from);
        return buffer_status(title->name);
    }
    return strcasecmp(name, title->name->data) == 0
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "%s: two label tables contradict each other: volume %zu is \"%s\" in %s, \"%s\" in %s; name it "
                      "(--pathway FILE,name=NAME)",
                      title->info->path, title->info->volume, title->name->data, title->from.data, name, from);
}

static void take_title(struct job *job, void *user, struct fsl_atlas *atlas, const char *path, const struct bytes *file)
{
    struct title *title = user;
    (void)file;
    file_trace_take(path);
    for (size_t i = 0; i < atlas->labels.count; i++) {
        const struct label *label = &atlas->labels.entries[i];
        if (label->number - 1 == title->info->volume) {
            (void)(label->name && JOB_CALL(job, agree_on_title(title, label->name, path_base(path))));
            return;
        }
    }
}

/* The name that is wanted, else what an FSL atlas XML or a table calls this volume, else the file's name. */
static conus_status choose_name(struct buffer *out, const char *wanted, const struct volume_file *file,
                                struct notes *notes)
{
    struct title title = {.info = &file->info, .name = out};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    const char *from = NULL;
    if (wanted && wanted[0]) {
        buffer_text(out, wanted);
        return buffer_status(out);
    }
    fsl_atlas_each(&job, file->path, FSL_VOLUMES, take_title, &title);
    const char *name = label_volume_name(&job, &from, title.info);
    (void)(from && JOB_CALL(&job, agree_on_title(&title, name, from)));
    conus_status status = job_close(&job, notes, NULL);
    status = status ? status : buffer_status(&title.from);
    if (!status) {
        status = title.from.size ? notes_add(notes, "pathway %s: named by %s", out->data, title.from.data)
                                 : name_by_file(out, file);
    }
    buffer_finish(&title.from);
    return status;
}

static conus_status add_one(conus_atlas *atlas, struct volume_file *file, const conus_pathway_options *options,
                            struct notes *notes)
{
    struct buffer name = {0};
    struct value_map map = {0};
    conus_status status = volume_file_map(&map, file, notes);
    status = status ? status : choose_name(&name, options->name, file, notes);
    const char *words = name.data;
    status = status ? status : choose_threshold(file, &map, options->threshold, words, notes);
    status = status ? status : notes_move(&atlas->notes, notes);
    status = status ? status : atlas_add_pathway(atlas, &file->info, &map, words);
    value_map_finish(&map);
    buffer_finish(&name);
    return status;
}

static conus_status add_bands(conus_atlas *atlas, struct volume_file *file, const conus_pathway_options *options,
                              struct notes *notes)
{
    struct value_map map = {0};
    size_t before = atlas->object_count;
    if (!options->bands || options->threshold != 0 || (options->name && options->name[0])) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %s", file->info.path,
                    options->bands ? "bands have ends and names of their own, no threshold and name with them"
                                   : "bands: NULL, though there are some");
    }
    conus_status status = volume_file_map_or_nan(&map, file, notes);
    status = status ? status : bands_check(options->bands, options->band_count, &file->info, atlas);
    status = status ? status : atlas_add_bands(atlas, &file->info, &map, options->bands, options->band_count);
    status = status ? status : bands_note(notes, atlas, options->band_count);
    status = status ? status : notes_move(&atlas->notes, notes);
    if (status && atlas->object_count > before) { /* a note failed */
        atlas_cut_objects(atlas, before);
        volume_finish(&atlas->volumes[--atlas->volume_count]);
    }
    value_map_finish(&map);
    return status;
}

conus_status pathway_add(conus_atlas *atlas, struct volume_file *file, const conus_pathway_options *options,
                         struct notes *notes)
{
    size_t note_count = atlas->notes.count;
    file->info.role = CONUS_ROLE_SCALAR;
    file->info.threshold = 0;
    conus_status status =
        options->band_count ? add_bands(atlas, file, options, notes) : add_one(atlas, file, options, notes);
    if (status) {
        notes_cut(&atlas->notes, note_count);
    }
    return status;
}

conus_status conus_atlas_add_pathway(conus_atlas *atlas, const char *path, const conus_pathway_options *options)
{
    struct volume_file file = {0};
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_pathway: an atlas and a path are needed");
    }
    options = options_of(conus_pathway_options, options);
    const struct note_sink sink = {options->log, options->log_user, path};
    struct notes notes = {.sink = &sink};
    conus_status status = volume_file_open_cached(&file, path, options->max_memory, options->cache, &notes);
    status = status ? status : pathway_add(atlas, &file, options, &notes);
    notes_finish(&notes);
    volume_file_finish(&file);
    return status;
}

static conus_status choose_block(conus_volume_info *info, double wanted)
{
    char threshold[TEXT_NUMBER_SIZE];
    char maximum[TEXT_NUMBER_SIZE];
    bool fits = wanted > 0 && tolerance_least(wanted) <= info->maximum;
    info->threshold = wanted;
    return wanted == 0 || fits ? CONUS_OK
                               : fail(CONUS_ERROR_ARGUMENT,
                                      "%s: blocks from %s on, allowed is above 0 to %s, the largest value (0 = never)",
                                      info->path, text_number(threshold, wanted), text_number(maximum, info->maximum));
}

conus_status context_set(conus_atlas *atlas, struct volume_file *file, const conus_context_options *options,
                         struct notes *notes)
{
    float *values = NULL;
    size_t note_count = atlas->notes.count;
    conus_status status = options->opacity == 0
                              ? volume_file_values(&values, file, notes)
                              : fail(CONUS_ERROR_ARGUMENT,
                                     "%s: an opacity of %g, which is for surfaces; a volume has a transfer function",
                                     file->info.path, options->opacity);
    if (!status) {
        file->info.role = CONUS_ROLE_CONTEXT;
        status = choose_block(&file->info, options->block_threshold);
    }
    status = status ? status : notes_move(&atlas->notes, notes);
    const struct fit_box grid = fit_box_of_grid(&file->info);
    status = status ? status : fit_note_context(atlas, file->info.path, &grid);
    status = status ? status : fit_note(atlas, &file->info, values);
    status = status ? status : atlas_set_context(atlas, &file->info, values);
    if (status) {
        memory_free(values);
        notes_cut(&atlas->notes, note_count);
    }
    return status;
}

conus_status roi_of_volume(conus_roi **out, struct volume_file *file, double threshold, struct notes *notes)
{
    float *values = NULL;
    file->info.role = CONUS_ROLE_SCALAR;
    conus_status status = volume_file_values_or_nan(&values, file, notes);
    file->info.threshold = threshold;
    status = status ? status : roi_create(out, &file->info, values);
    if (status) {
        memory_free(values);
    }
    return status;
}

/* The region in a mesh of SimNIBS. */
static conus_status roi_of_mesh(conus_roi **out, const struct hdf5 *hdf5, const struct volume_selector *selector,
                                const struct file_sums *sums, double threshold, struct notes *notes)
{
    struct roi_mesh mesh = {0};
    conus_volume_info info = {.role = CONUS_ROLE_SCALAR,
                              .path = selector->path,
                              .format = "SimNIBS, HDF5",
                              .datatype = "float32",
                              .volume_count = 1,
                              .slope = 1,
                              .threshold = threshold};
    memcpy(info.sha256, sums->items[0].sha256, sizeof info.sha256);
    struct notes own = {0};
    conus_status status = simnibs_find(&mesh, hdf5, selector, &own);
    if (status) {
        notes_finish(&own);
        return fail_in(status, selector->path);
    }
    status = notes_move_in(notes, &own, selector->path);
    notes_finish(&own);
    status = status ? status : roi_create_mesh(out, &info, &mesh);
    if (status) {
        memory_free(mesh.nodes);
        memory_free(mesh.tetrahedra);
    }
    return status;
}

/* Likewise for a file; nothing where it is none of them. MINC is known by the name of its group, which is asked first:
 * so the program that reads HDF5 is started only once. */
static conus_status load_mesh_region(conus_roi **out, const struct volume_selector *selector,
                                     const conus_roi_options *options, struct notes *notes)
{
    struct open_file file;
    struct bytes head = {0};
    struct file_sums sums = {0};
    struct hdf5 *hdf5 = NULL;
    conus_status status = file_read_head(&head, selector->path, HDF5_HEAD);
    bool may_be = !status && hdf5_is(head.data, head.size) &&
                  !text_mentions((struct text){(const char *)head.data, head.size}, "minc-2.0");
    bytes_finish(&head);
    if (!may_be) {
        return CONUS_OK; /* another reader says what is wrong */
    }
    status = file_open(&file, selector->path);
    if (status) {
        return status;
    }
    status = hdf5_read(&hdf5, &file, simnibs_wanted, SIMNIBS_WANTED, options->max_memory);
    if (!status && simnibs_is(hdf5)) {
        status = file_sums_add_open(&sums, &file);
        status = status ? status : roi_of_mesh(out, hdf5, selector, &sums, options->threshold, notes);
    }
    hdf5_destroy(hdf5);
    file_sums_finish(&sums);
    file_close(&file);
    return status;
}

conus_status conus_roi_load(conus_roi **out, const char *path, const conus_roi_options *options)
{
    struct volume_file file = {0};
    struct volume_selector selector = {0};
    conus_roi *roi = NULL;
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_roi_load: a result and a path are needed");
    }
    options = options_of(conus_roi_options, options);
    conus_status status = volume_selector_parse(&selector, path);
    if (status) {
        return status;
    }
    const struct note_sink sink = {options->log, options->log_user, path};
    struct notes notes = {.sink = &sink};
    status = load_mesh_region(&roi, &selector, options, &notes);
    if (!status && !roi) {
        status = volume_file_open_cached(&file, path, options->max_memory, options->cache, &notes);
        status = status ? status : roi_of_volume(&roi, &file, options->threshold, &notes);
    }
    notes_finish(&notes);
    volume_file_finish(&file);
    volume_selector_finish(&selector);
    *out = status ? *out : roi;
    return status;
}
