/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes whose values are numbers, not names: pathways, a context, and conus_roi_load(). */
#include "loaders/maps/maps.h"

#include "atlas/fit/fit.h"
#include "atlas/space.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "base/text.h"
#include "base/tolerance.h"
#include "loaders/labels/labels.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum {
    BAND_LIMIT = 4096,  /* most bands of one volume */
    HDF5_HEAD = 1 << 16 /* where the mark of HDF5 is looked for */
};

/* "from 10 to below 20", "from 10 on", "below 20", "all values". */
static const char *ends_text(struct job *job, double from, double to)
{
    const char *low = NUMBER_TEXT(from);
    const char *high = NUMBER_TEXT(to);
    return from != -INFINITY && to != INFINITY ? job_format(job, "from %s to below %s", low, high)
           : from != -INFINITY                 ? job_format(job, "from %s on", low)
           : to != INFINITY                    ? job_format(job, "below %s", high)
                                               : "all values";
}

/* Refuses a band that can be no pathway of the volume `info`, whose minimum and maximum are known. */
static void check_band(struct job *job, const conus_band *band, const conus_volume_info *info, const conus_atlas *atlas)
{
    if (!band->name || !band->name[0]) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: the band %s has no name", info->path,
                 ends_text(job, band->low, band->high));
        return;
    }
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        if (strcmp(atlas->objects[i].name, band->name) == 0) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "%s: band %s: another pathway has that name", info->path, band->name);
        }
    }
    if (!((float)band->low < (float)band->high)) { /* as the values are kept */
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: band %s: from %s to below %s holds no value, the first is to be less",
                 info->path, band->name, NUMBER_TEXT(band->low), NUMBER_TEXT(band->high));
    }
    if (!(tolerance_least(band->low) <= info->maximum && tolerance_least(band->high) > info->minimum)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: band %s: %s, the values are from %s to %s", info->path, band->name,
                 ends_text(job, band->low, band->high), NUMBER_TEXT(info->minimum), NUMBER_TEXT(info->maximum));
    }
}

static int compare_ends(const void *a, const void *b)
{
    return compare_double(((const conus_band *)a)->low, ((const conus_band *)b)->low);
}

static int compare_band_names(const void *a, const void *b)
{
    return strcmp(((const conus_band *)a)->name, ((const conus_band *)b)->name);
}

/* Refuses bands that cannot be pathways of the volume `info` in `atlas` together: each has a name of its own and holds
 * some of the range of values, and none overlap. CONUS_ERROR_ARGUMENT with the file. */
static void check_bands(struct job *job, const conus_band *bands, size_t count, const conus_volume_info *info,
                        const conus_atlas *atlas)
{
    if (count > BAND_LIMIT) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: %zu bands, allowed are up to %d", info->path, count, BAND_LIMIT);
    }
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        check_band(job, &bands[i], info, atlas);
    }
    conus_band *sorted = job_array(job, &count, sizeof *sorted);
    if (!sorted) {
        return;
    }
    memcpy(sorted, bands, count * sizeof *sorted);
    order_sort(sorted, count, sizeof *sorted, compare_band_names);
    for (const conus_band *band = sorted + 1; band < sorted + count; band++) {
        if (compare_band_names(band - 1, band) == 0) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "%s: two bands are called %s", info->path, band->name);
        }
    }
    order_sort(sorted, count, sizeof *sorted, compare_ends);
    for (const conus_band *band = sorted + 1; band < sorted + count; band++) {
        if ((float)band->low < (float)band[-1].high) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "%s: the bands %s (%s) and %s (%s) overlap", info->path, band[-1].name,
                     ends_text(job, band[-1].low, band[-1].high), band->name, ends_text(job, band->low, band->high));
        }
    }
}

/* Warns of bands that look wrong, among those that have just become the last pathways of `atlas`: bands without voxels,
 * and bands that end at the largest value, so that no band has it. */
static void warn_of_bands(struct job *job, const conus_atlas *atlas, size_t count)
{
    const conus_object *bands = atlas->objects + (atlas->object_count - count);
    const double largest = atlas->volumes[bands->volume].info.maximum;
    bool is_taken = false;
    for (size_t i = 0; i < count; i++) {
        is_taken = is_taken || tolerance_same(bands[i].low, largest);
    }
    for (size_t i = 0; i < count; i++) {
        if (!bands[i].voxels) {
            job_note(job, "pathway %s: no voxel has a value %s", bands[i].name,
                     ends_text(job, bands[i].low, bands[i].high));
        } else if (tolerance_same(bands[i].high, largest) && !is_taken) {
            job_note(job,
                     "pathway %s: values are below %s, the largest of the volume, whose voxels are not in it; without "
                     "an upper end they are",
                     bands[i].name, NUMBER_TEXT(bands[i].high));
        }
    }
}

/* Sets Eq. 6's threshold: the one asked for, or a quarter of the scale; of a mask that never comes to it, of its
 * value. */
static void choose_threshold(struct job *job, conus_volume_info *info, const struct value_map *map, double wanted,
                             const char *name)
{
    const char *maximum = NUMBER_TEXT(info->maximum);
    if (!(info->maximum > 0)) {
        job_bad(job, "%s: its largest value is %s, a pathway needs values above 0", info->path, maximum);
    }
    if (!(wanted >= 0 && tolerance_least(wanted) <= info->maximum)) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: threshold %s, allowed is above 0 to %s, the largest value (0 = default)", info->path,
                 NUMBER_TEXT(wanted), maximum);
    }
    info->threshold = wanted;
    if (!job_ok(job) || wanted > 0) {
        return;
    }
    struct value_spread spread = {0};
    value_spread_add(&spread, map, info);
    struct value_scale scale = value_scale_of(&spread, info);
    if ((info->maximum < scale.value / 4 || scale.is_probability) && value_map_is_mask(map)) {
        scale = (struct value_scale){info->maximum < scale.value / 4 ? info->maximum : scale.value, false,
                                     "0 and one other value, taken as a mask"};
    }
    info->threshold = scale.value / 4;
    const char *threshold = NUMBER_TEXT(info->threshold);
    if (!(info->threshold > 0)) {
        job_bad(job, "%s: values up to %s: %s: give a threshold", info->path, maximum, scale.words);
    }
    uint64_t strays = 0;
    if (scale.is_probability && info->minimum >= 0 && value_spread_strays(&strays, &spread, scale.value) && strays) {
        job_note(job, "pathway %s: %llu voxels have values above the scale, %g, up to %s", name,
                 (unsigned long long)strays, scale.value, maximum);
    }
    if (tolerance_least(info->threshold) > info->maximum) {
        job_bad(job, "%s: the default threshold %s (%s) is above its largest value %s: give a threshold", info->path,
                threshold, scale.words, maximum);
    }
    job_note(job, "pathway %s: %s; threshold %s", name, scale.words, threshold);
}

/* The title of the volume in the file (but for AFNI's "#0"); else the file's name without folder and ending, and with
 * the volume where there are several. */
static const char *name_by_file(struct job *job, const struct volume_file *file)
{
    const conus_volume_info *info = &file->info;
    const char *name = path_base(info->path);
    const int length = (int)volume_stem_length(name);
    return file->title && file->title[0] != '#' ? job_format(job, "%s", file->title)
           : info->volume_count > 1             ? job_format(job, "%.*s,volume=%zu", length, name, info->volume)
                                                : job_format(job, "%.*s", length, name);
}

/* The name that FSL atlas XMLs, or a table beside the file, give to a volume. */
struct title {
    const conus_volume_info *info;
    const char *name; /* NULL = nothing names it */
    const char *from; /* the file that says so */
};

static void agree_on_title(struct job *job, struct title *title, const char *name, const char *from)
{
    if (!title->name) {
        title->name = job_format(job, "%s", name);
        title->from = job_format(job, "%s", from);
    } else if (strcasecmp(name, title->name) != 0) {
        job_bad(job,
                "%s: two label tables contradict each other: volume %zu is \"%s\" in %s, \"%s\" in %s; name it "
                "(--pathway FILE,name=NAME)",
                title->info->path, title->info->volume, title->name, title->from, name, from);
    }
}

static void take_title(struct job *job, void *user, struct fsl_atlas *atlas, const char *path, const struct bytes *file)
{
    struct title *title = user;
    size_t i = 0;
    (void)file;
    inputs_take(path);
    while (i < atlas->labels.count && atlas->labels.entries[i].number - 1 != title->info->volume) {
        i++;
    }
    if (i < atlas->labels.count && atlas->labels.entries[i].name) {
        agree_on_title(job, title, atlas->labels.entries[i].name, path_base(path));
    }
}

/* The name that is wanted, else what an FSL atlas XML or a table calls this volume, else the file's name. */
static const char *choose_name(struct job *job, const char *wanted, const struct volume_file *file)
{
    struct title title = {&file->info, NULL, NULL};
    const char *from;
    if (wanted && wanted[0]) {
        return wanted;
    }
    fsl_atlas_each(job, file->path, FSL_VOLUMES, take_title, &title);
    const char *name = label_volume_name(job, &from, title.info);
    if (name) {
        agree_on_title(job, &title, name, from);
    }
    if (title.name) {
        job_note(job, "pathway %s: named by %s", title.name, title.from);
    }
    return title.name ? title.name : name_by_file(job, file);
}

/* Sets what the values are: as asked, as the header said, or as programs call such files. */
static void choose_unit(struct job *job, conus_volume_info *info, const char *wanted)
{
    static const char *const names[][2] = {{"zstat", "z"}, {"zmap", "z"}, {"zscore", "z"},
                                           {"tstat", "t"}, {"tmap", "t"}, {"spmT", "t"},
                                           {"fstat", "F"}, {"spmF", "F"}, {"prob", "probability"}};
    const char *base = path_base(info->path);
    if (wanted && (strlen(wanted) >= sizeof info->unit || !text_is_utf8((struct text){wanted, strlen(wanted)}))) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: unit \"%s\", allowed are up to %zu bytes of UTF-8", info->path, wanted,
                 sizeof info->unit - 1);
    } else if (wanted) {
        snprintf(info->unit, sizeof info->unit, "%s", wanted);
    }
    for (size_t i = 0; i < sizeof names / sizeof *names && !info->unit[0]; i++) {
        for (const char *at = base; *at && !info->unit[0]; at++) {
            if (strncasecmp(at, names[i][0], strlen(names[i][0])) == 0) {
                snprintf(info->unit, sizeof info->unit, "%s", names[i][1]);
            }
        }
    }
}

static const double levels[] = {0.05, 0.01, 0.005, 0.001}; /* at which p is cut */
enum { LEVELS = sizeof levels / sizeof *levels };

/* The values of a map that are not 0, as p values have them. */
struct p_values {
    size_t some, taken, tenths[10]; /* taken: by the threshold */
    size_t opposite;                /* by the threshold with a minus */
    size_t below[LEVELS];           /* By a tenth of the level at most. */
    size_t whole;                   /* of labels or counts */
    float low, high, small;         /* small: the largest below a half */
};

static void p_values_add(struct p_values *p, float value, double threshold)
{
    if (value != 0 && !isnan(value)) {
        p->low = p->some ? fminf(p->low, value) : value;
        p->high = p->some ? fmaxf(p->high, value) : value;
        p->small = value < 0.5F ? fmaxf(p->small, value) : p->small;
        p->some++;
        p->taken += value >= tolerance_least(threshold);
        p->opposite += value <= -tolerance_least(threshold);
        p->whole += value == floorf(value);
        p->tenths[value > 0 && value < 1 ? (size_t)(10 * value) : 9]++;
        for (size_t i = 0; i < LEVELS; i++) {
            p->below[i] += value > 0.9 * levels[i] && value < 1.001 * levels[i];
        }
    }
}

/* Warns where a region, or a pathway, looks like the large values of a map of p values, whose small ones are meant: all
 * values are from 0 to 1 and no mask's. Either they end at a level at which p is cut, with many just below it, unlike a
 * field's or a diffusivity's few largest ones, and begin again above 1 minus it at most; or the threshold takes most.
 * One at which p is seldom cut might be of a map of probabilities; p is even where there is no effect, so each tenth
 * above the first has some. At others no inner tenth has few: of 38 simulated maps of p the least has 0.61 of their
 * mean or more, of 17 published maps of probabilities and intensities 0.23 at most. Of pathways, which are
 * probabilities, the upper tenths are also alike, as in each of 48 simulated smooth fields of a two-sided p, but in
 * none of 68 published maps; of one side with effects of the other sign they are not. */
static void warn_of_p_values(struct job *job, const conus_volume_info *info, const struct p_values *p, bool is_pathway)
{
    static const double CUT = 0.1;   /* p is seldom cut above */
    static const double LEAST = 0.5; /* of what even values have */
    static const double FULL = 0.25; /* of the mean of inner tenths: p of z by N(1, 1) has 0.29 */
    static const double ALIKE = 1.6; /* most, of least */
    bool is_cut = false;
    for (size_t i = 0; i < LEVELS; i++) {
        bool is_near = p->small > 0.975 * levels[i] && p->small < 1.001 * levels[i] && 100 * p->below[i] > p->tenths[0];
        is_cut = is_cut || (is_near && p->tenths[0] + p->tenths[9] == p->some);
    }
    bool is_even = true;
    double least = INFINITY;
    double most = 0;
    double inner = INFINITY;
    for (size_t i = 1; i < 10; i++) {
        const double count = (double)p->tenths[i];
        is_even = is_even && 10 * count >= LEAST * (double)p->some;
        inner = i < 9 ? fmin(inner, count) : inner;
        least = i > 3 ? fmin(least, count) : least;
        most = i > 3 ? fmax(most, count) : most;
    }
    const double all = (double)(p->some - p->tenths[0] - p->tenths[9]);
    bool is_likely =
        is_pathway ? is_even && most < ALIKE * least : is_even || (info->threshold <= CUT && 8 * inner > FULL * all);
    if (p->low > 0 && p->low < p->high && p->high <= 1 && (is_cut || (is_likely && 2 * p->taken > p->some))) {
        job_warn(job,
                 "%s: the %s is %.3g %% of the voxels that are not 0, and all values are from 0 to 1: of a map of p "
                 "values it has the large ones; such a map is asked as 1 - p, or as its z values",
                 info->path, is_pathway ? "pathway" : "region", 100 * (double)p->taken / (double)p->some);
    }
}

/* Warns of a threshold that may be meant of fractions, where the values may be per cent. */
static void warn_of_percent(struct job *job, const conus_volume_info *info, double threshold)
{
    if (threshold > 0 && threshold < 1 && info->minimum >= 0 && info->maximum >= 10 && info->maximum <= 100) {
        job_warn(job, "%s: values from %s to %s, and a threshold of %s: if the values are per cent, that is %s %%",
                 info->path, NUMBER_TEXT(info->minimum), NUMBER_TEXT(info->maximum), NUMBER_TEXT(threshold),
                 NUMBER_TEXT(threshold));
    }
}

static void add_one(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item)
{
    struct value_map map = {0};
    volume_map(job, &map, file);
    if (job_ok(job)) {
        const char *name = choose_name(job, item->label.name, file);
        choose_threshold(job, &file->info, &map, item->threshold, name);
        warn_of_percent(job, &file->info, item->threshold);
        struct p_values p = {0};
        const bool may_be = file->info.minimum >= 0 && file->info.maximum <= 1 &&
                            strcmp(file->info.unit, "probability") != 0; /* a word of the user, or the name */
        for (size_t i = may_be ? value_map_next(&map, 0) : map.count; i < map.count; i = value_map_next(&map, i + 1)) {
            p_values_add(&p, value_map_at(&map, i), file->info.threshold);
        }
        warn_of_p_values(job, &file->info, &p, true);
        atlas_take(job, atlas);
        (void)JOB_CALL(job, atlas_add_pathway(atlas, &file->info, &map, name));
    }
    value_map_finish(&map);
}

static void add_bands(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item)
{
    struct value_map map = {0};
    const size_t count = item->bands.count;
    if (!item->bands.at) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: bands: NULL, though there are some", file->info.path);
    } else if (item->threshold != 0 || (item->label.name && item->label.name[0])) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: bands have ends and names of their own, no threshold and name with them", file->info.path);
    }
    volume_map_or_nan(job, &map, file);
    if (job_ok(job)) {
        check_bands(job, item->bands.at, count, &file->info, atlas);
    }
    if (JOB_CALL(job, atlas_add_bands(atlas, &file->info, &map, item->bands.at, count))) {
        warn_of_bands(job, atlas, count);
        atlas_take(job, atlas);
    }
    value_map_finish(&map);
}

struct scene_item pathway_item(const conus_pathway_options *options)
{
    return (struct scene_item){.kind = ITEM_PATHWAY,
                               .label.name = (char *)options->name,
                               .threshold = options->threshold,
                               .bands = {.at = (conus_band *)options->bands, .count = options->band_count},
                               .unit = options->unit};
}

void pathway_add(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item)
{
    if (!job_ok(job)) {
        return; /* there may be no file */
    }
    file->info.role = CONUS_ROLE_SCALAR;
    file->info.threshold = 0;
    choose_unit(job, &file->info, item->unit);
    if (!job_ok(job)) {
        return;
    }
    if (item->bands.count) {
        add_bands(job, atlas, file, item);
    } else {
        add_one(job, atlas, file, item);
    }
}

void context_set(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item)
{
    conus_volume_info *info = &file->info;
    const double block = item->blocks;
    if (item->opacity != 0) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: an opacity of %g, which is for surfaces; a volume has a transfer function", info->path,
                 item->opacity);
    }
    float *values = volume_values(job, file);
    info->role = CONUS_ROLE_CONTEXT;
    info->threshold = block;
    if (block != 0 && !(block > 0 && tolerance_least(block) <= info->maximum)) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: blocks from %s on, allowed is above 0 to %s, the largest value (0 = never)", info->path,
                 NUMBER_TEXT(block), NUMBER_TEXT(info->maximum));
    }
    atlas_take(job, atlas);
    const struct box3 grid = space_grid_box(info);
    bool is_set = JOB_CALL(job, fit_note_context(&atlas->notes, atlas, info->path, &grid)) &&
                  JOB_CALL(job, fit_note(atlas, info, values)) && JOB_CALL(job, atlas_set_context(atlas, info, values));
    if (!is_set) {
        memory_free(values);
    }
}

void roi_of_volume(struct job *job, conus_roi **out, struct volume_file *file, double threshold)
{
    file->info.role = CONUS_ROLE_SCALAR;
    float *values = volume_values_or_nan(job, file);
    file->info.threshold = threshold;
    const size_t count = file->info.dim[0] * file->info.dim[1] * file->info.dim[2];
    struct p_values p = {0};
    size_t masked = 0; /* voxels of a mask */
    for (size_t i = 0; values && i < count; i++) {
        if (threshold > 0) {
            p_values_add(&p, values[i], threshold);
        }
        masked += threshold == 0 && values[i] != 0 && !isnan(values[i]);
    }
    warn_of_p_values(job, &file->info, &p, false);
    warn_of_percent(job, &file->info, threshold);
    const double part = (double)(threshold > 0 ? p.taken : masked) / (double)count;
    if (part > 0.75 && count > 100000) { /* of an image of a brain a third is brain; a cut-out is small */
        job_warn(job, "%s: the region is %.3g %% of the whole grid: is a mask inverted, or a map of p values meant?",
                 file->info.path, 100 * part);
    }
    if (p.whole && p.whole == p.some && p.low > 0 && threshold < p.high && p.low < p.high && p.high <= 1000) {
        job_note(job,
                 "all values are whole numbers, %s to %s, and those of %s and more are one region: of labels a mask "
                 "of the one that is meant is asked",
                 NUMBER_TEXT(p.low), NUMBER_TEXT(p.high), NUMBER_TEXT(threshold));
    }
    if (p.opposite) {
        job_note(job,
                 "%zu voxels have values of -%s and less, and are not in the region: a threshold of -%s takes them",
                 p.opposite, NUMBER_TEXT(threshold), NUMBER_TEXT(threshold));
    }
    if (!JOB_CALL(job, roi_create(out, &file->info, values))) {
        memory_free(values);
    }
}

/* The region in a mesh of SimNIBS, which is the last file of the job. */
static void roi_of_mesh(struct job *job, conus_roi **out, const struct hdf5 *hdf5, const struct source_keys *keys,
                        double threshold)
{
    conus_volume_info info = {.role = CONUS_ROLE_SCALAR,
                              .path = keys->path,
                              .format = "SimNIBS, HDF5",
                              .datatype = "float32",
                              .volume_count = 1,
                              .slope = 1,
                              .threshold = threshold};
    const size_t place = job_in(job, keys->path, JOB_ALONE);
    source_keys_refuse(job, keys, KEY_BIT(KEY_FIELD) | KEY_BIT(KEY_TISSUE));
    struct roi_mesh mesh = simnibs_find(job, hdf5, keys);
    job_out(job, place);
    mesh.nodes = job_give(job, mesh.nodes, mesh.node_count * sizeof *mesh.nodes);
    mesh.tetrahedra = job_give(job, mesh.tetrahedra, mesh.count * sizeof *mesh.tetrahedra);
    if (job_ok(job)) {
        memcpy(info.sha256, job->files.items[job->files.count - 1].sha256, sizeof info.sha256);
    }
    if (!JOB_CALL(job, roi_create_mesh(out, &info, &mesh))) {
        memory_free(mesh.nodes);
        memory_free(mesh.tetrahedra);
    }
}

/* The file, if it may be a mesh of SimNIBS; else NULL. MINC is known by the name of its group, which is asked first: so
 * the program that reads HDF5 is started only once. */
static struct source *open_mesh(struct job *job, const char *path)
{
    struct attempt attempt = job_try(job); /* another reader says what is wrong */
    struct source *source = source_open(job, path);
    bool may_be = source && format_find(&source->head, ROLE_REGION) && !text_mentions(source->head.bytes, "minc-2.0");
    (void)attempt_end(job, &attempt, ATTEMPT_TRY);
    return may_be ? source : NULL;
}

/* Likewise for a file; nothing where it is none of them. */
static void load_mesh_region(struct job *job, conus_roi **out, const struct source_keys *keys, double threshold)
{
    const size_t place = job_in(job, keys->path, JOB_ALONE);
    struct source *source = open_mesh(job, keys->path);
    const struct hdf5 *hdf5 = source ? hdf5_open(job, &source->file, simnibs_wanted, SIMNIBS_WANTED) : NULL;
    job_out(job, place);
    if (hdf5 && simnibs_is(hdf5)) {
        source_made_of(job, source);
        roi_of_mesh(job, out, hdf5, keys, threshold);
    }
}

conus_status conus_roi_load(conus_roi **out, const char *path, const conus_roi_options *options)
{
    struct volume_file file = {0};
    struct source_keys keys;
    conus_roi *roi = NULL;
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_roi_load: a result and a path are needed");
    }
    options = options_of(conus_roi_options, options);
    const struct note_sink sink = {options->log, options->log_user, path};
    struct job job = {.sink = &sink, .max_memory = options->max_memory};
    source_keys_read(&job, &keys, path, KEYS_VOLUME);
    if (job_ok(&job)) {
        load_mesh_region(&job, &roi, &keys, options->threshold);
    }
    if (!roi && job_ok(&job)) {
        volume_load(&job, &file, path, options->max_memory);
    }
    if (file.path && job_ok(&job)) {
        roi_of_volume(&job, &roi, &file, options->threshold);
    }
    volume_file_finish(&file);
    *out = roi ? roi : *out;
    return job_close(&job, NULL, NULL);
}
