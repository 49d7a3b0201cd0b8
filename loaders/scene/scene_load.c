/* SPDX-License-Identifier: BSD-3-Clause */
/* From a scene to the atlas that it describes. Every failure names the manifest and the key. */
#include "loaders/scene/parts.h"

#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/labels/labels.h"
#include "loaders/maps/maps.h"
#include "loaders/scene/scene.h"
#include "sources/source.h"

#include <math.h>
#include <string.h>

/* A scene while it is loaded. */
struct loading {
    struct load *load;
    struct job *job; /* the load's */
    const struct scene *scene;
    const char *path;              /* of the manifest, ending in '/' if it was made for a folder */
    const struct bytes *file;      /* its bytes; NULL if it was made up */
    const char *names;             /* where the names of areas without a parcellation come from; NULL: as planned */
    const struct named_maps *maps; /* whose table names the volumes of a file that is ATLAS; NULL without one */
    bool is_file;                  /* the scene is a file that is ATLAS, and its user sees no manifest */
    bool has_image;                /* a context that is a volume */
    struct volume_file series;     /* kept for the pathways that follow, if any is in the same file */
    const char *series_name;       /* as the manifest writes it; NULL without one */
};

/* The path of a file that an item names, from where this process is; NULL for none. */
static const char *path_of(const struct loading *loading, const char *name)
{
    return name ? job_beside(loading->job, loading->path, name) : NULL;
}

/* The same with what chooses a volume and places it. */
static const char *source_path(const struct loading *loading, const struct scene_item *item)
{
    const double *r = item->resolution;
    const char *path = path_of(loading, item->file);
    path = item->volume ? job_format(loading->job, "%s,volume=%zu", path, item->volume - 1) : path;
    path = r[0] > 0 ? job_format(loading->job, "%s,resolution=%.17g:%.17g:%.17g", path, r[0], r[1], r[2]) : path;
    return item->orientation ? job_format(loading->job, "%s,orientation=%s", path, item->orientation) : path;
}

/* What a manifest asks for in vain is its fault, not the caller's. */
static void blame_manifest(const struct loading *loading)
{
    loading->job->status = loading->job->status == CONUS_ERROR_ARGUMENT ? CONUS_ERROR_DATA : loading->job->status;
}

typedef void add_function(struct loading *loading, const struct scene_item *item);

/* Adds an item: what it has become is the atlas's. */
static void add_item(struct loading *loading, const struct scene_item *item, add_function *add)
{
    struct job *job = loading->job;
    const struct job_mark mark = job_mark(job);
    const size_t place = job_in(job, item->list, item->index);
    add(loading, item);
    job_out(job, place);
    job_release(job, mark);
    if (!loading->is_file) {
        blame_manifest(loading);
    }
}

static void move_by(struct loading *loading, const struct scene_item *item)
{
    const conus_transform_options options = {.from = path_of(loading, item->from),
                                             .to = path_of(loading, item->to),
                                             .grid = path_of(loading, item->grid),
                                             .inverse = item->inverse,
                                             .vectors = item->vectors,
                                             .space = item->space,
                                             .transform = item->transform,
                                             .max_memory = loading->load->options->max_memory};
    transform_load(loading->job, loading->load->atlas, path_of(loading, item->file), &options);
}

/* Reads a parcellation, without the notes that have been made of it before. */
static void load_parcellation(const struct loading *loading, struct parcellation *part, const struct scene_item *item)
{
    static const char needed[] = "a labelled volume (" VOLUME_NAMES " or OME-Zarr) or an FSL atlas XML of type Label";
    struct load *load = loading->load;
    struct job *job = loading->job;
    conus_load_options options = *load->options;
    const size_t mark = job_in(job, item->list, item->index);
    const char *path = source_path(loading, item);
    const bool is_asked = options.labels != NULL;
    options.labels = is_asked ? options.labels : path_of(loading, item->labels);
    load_report(load, path, 1);
    const struct attempt attempt = job_try(job);
    parcellation_read(job, part, path, &options, needed);
    if (item->noted) {
        notes_cut(&job->notes, attempt.notes);
    }
    attempt_end(job, &attempt, ATTEMPT_KEEP);
    parcellation_shift(job, part, item->label_offset, item->label.hemisphere);
    if (!is_asked) {
        blame_manifest(loading);
    }
    job_out(job, mark);
}

static void refuse_labels(const struct loading *loading, const char *labels, size_t parcellations)
{
    const bool is_made_up = !path_base(loading->path)[0];
    job_fail(loading->job, CONUS_ERROR_ARGUMENT,
             parcellations ? "--labels %s: the manifest has %zu parcellations, it can say of each (labels)"
             : scene_count(loading->scene, ITEM_PROBABILITIES)
                 ? "--labels %s: areas of probabilities have the names of the atlas XML, or those of "
                   "the manifest"
             : is_made_up ? "--labels %s: a folder of surfaces is named by its files; a manifest ('conus "
                            "manifest') can name them by a table (\"files\" with \"labels\")"
                          : "--labels %s: the manifest has no parcellation that they could name",
             labels, parcellations);
}

/* Makes an atlas of the parcellations, if there are any, with all voxels that are no surface's. */
static void create_atlas(const struct loading *loading, struct area_plan *plan)
{
    const struct scene *scene = loading->scene;
    struct job *job = loading->job;
    const size_t count = scene_count(scene, ITEM_PARCELLATION);
    const char *labels = loading->load->options->labels;
    if (labels && !loading->is_file && count != 1) {
        refuse_labels(loading, labels, count);
    }
    if (!count) {
        load_create(loading->load, NULL, 0, NULL, loading->names ? loading->names : plan->names);
        return;
    }
    struct parcellations all = {.parts = job_zeroed(job, count, sizeof *all.parts), .source = ""};
    struct scene_item *item = NULL;
    while (all.parts && (item = scene_next(scene, ITEM_PARCELLATION, item))) {
        load_parcellation(loading, &all.parts[all.count++], item);
    }
    parcellations_unite(job, &all);
    area_plan_settle(job, plan, &all, scene->prefer);
    parcellations_join(job, &all);
    parcellations_atlas(loading->load, all.parts, all.count, &all.table, all.source);
}

/* Places the Allen CCF where the manifest says, or where a folder that has only surfaces says; volumes say it by their
 * grid. */
static void place_ccf(const struct loading *loading, const struct area_plan *plan)
{
    conus_atlas *atlas = loading->load->atlas;
    const enum scene_ccf ccf = loading->scene->ccf;
    if (ccf != SCENE_CCF_UNSTATED) {
        const size_t mark = job_in(loading->job, "ccf", JOB_ALONE);
        (void)JOB_CALL(loading->job, frame_set_ccf(atlas, ccf == SCENE_CCF_ASR));
        job_out(loading->job, mark);
    } else if (plan->has_ccf && job_ok(loading->job) && !conus_atlas_volume(atlas, 0)) {
        (void)JOB_CALL(loading->job, frame_set_ccf(atlas, plan->ccf_from_right));
    }
}

static void load_areas(const struct loading *loading)
{
    struct load *load = loading->load;
    struct area_plan plan = {0};
    const struct job_mark mark = job_mark(loading->job);
    area_plan_make(loading->job, &plan, loading->scene, loading->path);
    const size_t planned = area_plan_files(&plan);
    load->job.total = scene_file_count(loading->scene) + planned;
    struct deferred_notes deferred = load_defer_notes(load);
    create_atlas(loading, &plan);
    load_release_notes(load, &deferred);
    load->job.total -= planned - area_plan_files(&plan); /* the parcellation may have them */
    place_ccf(loading, &plan);
    if (loading->file && path_base(loading->path)[0]) {
        (void)JOB_CALL(loading->job, atlas_add_file(load->atlas, loading->path, loading->file));
    }
    atlas_take(loading->job, load->atlas);
    area_plan_load(load, &plan, loading->scene->space);
    job_release(loading->job, mark);
}

/* The pathway of a volume of the item, with the threshold that it has where it states none. */
static struct scene_item one_pathway(const struct loading *loading, const struct scene_item *item, char *name)
{
    struct scene_item one = *item;
    const bool states = item->threshold != 0 || item->bands.count;
    one.label.name = name;
    one.threshold = states ? item->threshold : loading->scene->threshold;
    return one;
}

static void open_series(const struct loading *loading, struct volume_file *out, const char *name)
{
    const char *path = path_of(loading, name);
    load_at(loading->load, path);
    volume_load_series(loading->job, out, path, loading->load->options->max_memory);
}

/* Adds volume `volume` of `file`; notes of opening it go to the atlas with it. */
static void add_volume(const struct loading *loading, const struct scene_item *item, struct volume_file *file,
                       size_t volume, char *name)
{
    const struct scene_item one = one_pathway(loading, item, name);
    load_report(loading->load, file->path, 1);
    if (job_ok(loading->job)) {
        volume_select(loading->job, file, volume);
    }
    pathway_add(loading->job, loading->load->atlas, file, &one);
}

static struct fsl_maps open_fsl(const struct loading *loading, const struct scene_item *item)
{
    struct load *load = loading->load;
    const char *xml = path_of(loading, item->fsl);
    const char *image = path_of(loading, item->file);
    load_at(load, xml);
    const struct fsl_maps maps = fsl_maps_open(loading->job, load->atlas, xml, image, load->options);
    if (job_step(loading->job)) {
        load_at(load, maps.image->path);
        (void)JOB_CALL(loading->job, notes_move(&loading->job->notes, maps.notes));
        atlas_take(loading->job, load->atlas);
        load->job.total += maps.labels->count - 1; /* it counted as one so far */
    }
    return maps;
}

/* The labels of the volumes that the item means: those it names, the one it chooses, or the only one. */
static const struct label_table *label_volumes(struct job *job, const struct scene_item *item,
                                               const struct volume_file *file)
{
    struct label_table *table = labels_new(job);
    const size_t count = item->names.count ? item->names.count : 1;
    const size_t volumes = job_ok(job) ? file->info.volume_count : count;
    if (item->kind == ITEM_PATHWAY && count != volumes) {
        job_bad(job, "names: has %zu entries, %s has %zu volumes: they must be as many", count, item->file, volumes);
    } else if (item->names.count ? count != volumes : !item->volume && volumes > 1) {
        job_bad(job, "%s: has %zu volumes: names (one for each), fsl or volume is needed", item->file, volumes);
    }
    for (size_t i = 0; i < count && job_ok(job); i++) {
        const char *stem = path_base(file->path);
        const char *name = item->names.count ? item->names.at[i] : item->label.name;
        struct label *label = labels_add(job, table, (uint32_t)(item->volume ? item->volume - 1 : i) + 1);
        labels_set(job, &label->name, name ? text_from(name) : (struct text){stem, volume_stem_length(stem)});
    }
    return table;
}

/* The volumes that the item means, with names: of an FSL atlas, or of its file. */
static struct fsl_maps open_maps(const struct loading *loading, const struct scene_item *item)
{
    static const struct label_table none = {0};
    if (item->fsl) {
        return open_fsl(loading, item);
    }
    struct job *job = loading->job;
    struct fsl_maps maps = {.labels = &none, .image = volume_file_new(job)};
    if (maps.image) {
        open_series(loading, maps.image, item->file);
        if (loading->maps) {
            named_maps_check(job, maps.image, loading->load->options->probability);
        }
        maps.labels = loading->maps ? loading->maps->table : label_volumes(job, item, maps.image);
    }
    return maps;
}

static void add_named(const struct loading *loading, const struct scene_item *item)
{
    struct job *job = loading->job;
    const struct fsl_maps maps = open_maps(loading, item);
    for (size_t i = 0; job_ok(job) && i < maps.labels->count; i++) {
        const struct label *label = &maps.labels->entries[i];
        add_volume(loading, item, maps.image, label->number - 1, item->fsl ? label->name : item->names.at[i]);
    }
    if (item->fsl && job_step(job)) {
        job_note(job, "pathways of %s: %zu, from %s", path_base(item->fsl), maps.labels->count,
                 path_base(maps.image->path));
    }
    atlas_take(job, loading->load->atlas);
}

/* Adds an area for each label, whose number is that of the volume from 1. The areas' labels are these numbers, less 1
 * behind a background, and behind the labels that there are; for a single volume the next one. */
static void add_areas(struct loading *loading, const struct scene_item *item)
{
    struct load *load = loading->load;
    struct job *job = loading->job;
    const struct fsl_maps of = open_maps(loading, item);
    uint32_t before = 0;
    for (size_t i = 0; job_ok(job) && i < load->atlas->object_count; i++) {
        const uint32_t label = load->atlas->objects[i].label;
        before = label > before ? label : before;
    }
    const double asked = load->options->probability;
    const double threshold = asked > 0 ? asked : item->threshold > 0 ? item->threshold : 0.25; /* as of a pathway */
    struct probability_maps *maps = job_ok(job) ? probability_maps_new(job, of.image) : NULL;
    for (size_t i = 0; job_ok(job) && i < maps->count; i++) {
        const bool is_kept = label_table_find(of.labels, (uint32_t)i + 1);
        if (is_kept) {
            load_report(load, of.image->path, 1);
        }
        probability_maps_read(job, maps, i, is_kept);
    }
    const struct probability_scale scale = probability_scale_of(job, maps, item->scale);
    for (size_t i = 0; job_ok(job) && i < of.labels->count; i++) {
        struct label label = of.labels->entries[i];
        const uint32_t volume = label.number - 1;
        label.number = before + (item->volume ? 1 : label.number - of.has_background);
        probability_add(job, load->atlas, maps, volume, &label, &scale, threshold);
    }
    if (job_ok(job)) {
        job_note(job, "%s: %zu area%s by probabilities of %s and more (values: %s)", path_base(of.image->path),
                 of.labels->count, of.labels->count == 1 ? "" : "s", NUMBER_TEXT(threshold), scale.words);
    }
    atlas_take(job, load->atlas);
}

static void add_single(const struct loading *loading, const struct scene_item *item)
{
    const struct scene_item one = one_pathway(loading, item, item->label.name);
    struct volume_file file = {0};
    const char *path = source_path(loading, item);
    load_report(loading->load, path, 1);
    volume_load(loading->job, &file, path, loading->job->max_memory);
    pathway_add(loading->job, loading->load->atlas, &file, &one);
    volume_file_finish(&file);
}

/* Adds a pathway that is in the same file as its neighbours in the manifest. */
static void add_of_series(struct loading *loading, const struct scene_item *item)
{
    const char *name = item->file;
    if (!loading->series_name || strcmp(loading->series_name, name) != 0) {
        volume_file_finish(&loading->series);
        open_series(loading, &loading->series, name);
        loading->series_name = name;
    }
    add_volume(loading, item, &loading->series, item->volume - 1, item->label.name);
}

/* Whether both are volumes of a file that says by itself where it lies. */
static bool of_one_file(const struct scene_item *a, const struct scene_item *b)
{
    const bool is_placed = a->orientation || b->orientation || a->resolution[0] > 0 || b->resolution[0] > 0;
    return a->kind == b->kind && a->volume && b->volume && !is_placed && strcmp(a->file, b->file) == 0;
}

static void add_pathway(struct loading *loading, const struct scene_item *item)
{
    const struct scene_item *first = loading->scene->items.at;
    const struct scene_item *last = first + loading->scene->items.count - 1;
    if (item->fsl || item->names.count) {
        add_named(loading, item);
    } else if ((item > first && of_one_file(item - 1, item)) || (item < last && of_one_file(item, item + 1))) {
        add_of_series(loading, item);
    } else {
        add_single(loading, item);
    }
}

static void add_bundles(struct loading *loading, const struct scene_item *item)
{
    const char *path = path_of(loading, item->file);
    load_report(loading->load, path, 1);
    const double radius = streamlines_radius(loading->job, item->radius, path);
    conus_atlas *alone = streamlines_load(loading->job, path, item->space);
    streamlines_take(loading->job, loading->load->atlas, alone, radius, item->label.name);
}

/* What keeps a surface, or a volume, from being the context that the item describes; NULL = nothing. */
static const char *refuse_context(const struct loading *loading, const struct scene_item *item, bool is_surface)
{
    if (is_surface) {
        return item->transfer || item->transfer_file ? "transfer: is for volumes, this is a surface"
               : item->blocks > 0                    ? "blocks: only voxels of a volume do, this is a surface"
               : item->moves                         ? "moves: a surface is where poses are"
                                                     : NULL;
    }
    return item->opacity != 0   ? "opacity: is for surfaces, this is none; a volume has a transfer function"
           : loading->has_image ? "file: is no surface, and there is a volume already"
                                : NULL;
}

static void take_transfer(const struct loading *loading, const struct scene_item *item)
{
    char **transfer = &loading->load->atlas->transfer;
    const char *name = item->transfer ? item->transfer : path_of(loading, item->transfer_file);
    if (!item->transfer && !job_has_file(loading->job, name)) {
        job_fail(loading->job, CONUS_ERROR_IO, "transfer.file: %s: there is no such file", name);
    }
    memory_free(*transfer);
    *transfer = job_give(loading->job, job_format(loading->job, "%s", name), strlen(name) + 1);
}

/* Whether a context that is a volume is left out: it is not wanted, and no answer needs it. One does where it blocks
 * rays; where the atlas is moved, and compared with its head; where it would be the first volume, which says whose
 * brain it is; where something is to be noted about its place. What is left out may not be there, as it is in no
 * sidecar. */
static bool is_left_out(const struct loading *loading, const struct scene_item *item, const char *path)
{
    const char *file = path_of(loading, item->file);
    const conus_atlas *atlas = loading->load->atlas;
    return job_ok(loading->job) && loading->load->options->without_context && !(item->blocks > 0) &&
           !scene_count(loading->scene, ITEM_TRANSFORM) && atlas->volume_count &&
           ((!file_exists(file) && !file_is_folder(file)) || context_is_plain(loading->job, atlas, path));
}

static void set_context(struct loading *loading, const struct scene_item *item)
{
    struct load *load = loading->load;
    struct job *job = loading->job;
    const char *path = source_path(loading, item);
    load_report(load, path, 1);
    const bool is_surface = source_format(job, path, ROLE_SURFACE);
    const char *wrong = loading->is_file ? NULL : refuse_context(loading, item, is_surface);
    if (wrong) {
        job_bad(job, "%s", wrong);
    }
    loading->has_image = loading->has_image || !is_surface;
    if (!is_surface && is_left_out(loading, item, path)) {
        load->atlas->lacks_context = true;
        return;
    }
    context_load(job, load->atlas, path, is_surface, item);
    if ((item->transfer || item->transfer_file) && job_step(job)) {
        take_transfer(loading, item);
    }
}

/* What is added to the areas, in this order. A transform moves all that is there by then, what is said to move, too,
 * and the atlas goes back through the last one first. */
static const struct step {
    enum item_kind kind;
    bool moves;
    add_function *add;
} steps[] = {{ITEM_PROBABILITIES, false, add_areas}, {ITEM_PATHWAY, true, add_pathway},
             {ITEM_STREAMLINES, true, add_bundles},  {ITEM_CONTEXT, true, set_context},
             {ITEM_TRANSFORM, false, move_by},       {ITEM_PATHWAY, false, add_pathway},
             {ITEM_STREAMLINES, false, add_bundles}, {ITEM_CONTEXT, false, set_context}};

static void take_step(struct loading *loading, const struct step *step)
{
    const struct scene *scene = loading->scene;
    for (size_t i = 0; i < scene->items.count && job_ok(loading->job); i++) {
        const size_t at = step->kind == ITEM_TRANSFORM ? scene->items.count - 1 - i : i;
        const struct scene_item *item = &scene->items.at[at];
        if (item->kind == step->kind && item->moves == step->moves) {
            add_item(loading, item, step->add);
        }
    }
    volume_file_finish(&loading->series);
    loading->series_name = NULL;
}

static void load_scene(struct loading *loading)
{
    struct load *load = loading->load;
    struct job *job = &load->job;
    if (!job_step(job)) { /* there may be no scene */
        return;
    }
    loading->job = job;
    struct deferred_notes deferred = load_defer_notes(load);
    const size_t place = job_in(job, loading->is_file ? NULL : loading->path, JOB_ALONE);
    load_areas(loading);
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        take_step(loading, &steps[i]);
    }
    if (job_ok(job) && loading->scene->brain) {
        load->atlas->brain = loading->scene->brain;
    }
    job_out(job, place);
    load_release_notes(load, &deferred);
}

void manifest_load(struct load *load, const char *path, const struct bytes *file)
{
    struct scene scene;
    const size_t mark = job_in(&load->job, path, JOB_ALONE);
    scene_read(&load->job, &scene, text_from_bytes(file->data, file->size));
    job_out(&load->job, mark);
    scene.image = scene.image ? job_beside(&load->job, path, scene.image) : NULL;
    load_scene(&(struct loading){.load = load, .scene = &scene, .path = path, .file = file, .names = "the manifest"});
}

void scene_load(struct load *load, const struct scene *scene, const char *path, const char *names)
{
    load_scene(&(struct loading){.load = load, .scene = scene, .path = path, .names = names, .is_file = !names});
}

conus_status scene_add_item(conus_atlas *atlas, const char *path, const struct scene_item *item,
                            const conus_load_options *options)
{
    struct load load;
    struct scene_item own = *item;
    struct scene scene = {.items = {.at = &own, .count = 1}};
    struct loading loading = {.load = &load, .job = &load.job, .scene = &scene, .path = "", .is_file = true};
    const struct atlas_mark mark = atlas_mark(atlas);
    load_begin(&load, path, options);
    load.atlas = atlas;
    own.file = (char *)path;
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        take_step(&loading, &steps[i]);
    }
    conus_status status = atlas_close(&load.job, atlas, mark);
    memory_free(load.path);
    return status;
}

/* Loads probabilities, whose path is in the folder of `path`, as an atlas of its own. */
static void load_item(struct load *load, const char *path, struct scene_item item, const struct named_maps *maps)
{
    const char *name = path_base(path);
    const char *folder = name == path ? "./" : job_format(&load->job, "%.*s", (int)(name - path), path);
    item.kind = ITEM_PROBABILITIES;
    item.list = maps ? NULL : "probabilities";
    load_scene(&(struct loading){.load = load,
                                 .scene = &(struct scene){.items = {.at = &item, .count = 1}},
                                 .path = folder,
                                 .names = maps ? maps->source : "FSL atlas XML",
                                 .maps = maps,
                                 .is_file = maps});
}

void probabilities_load(struct load *load, const char *path)
{
    load_item(load, path, (struct scene_item){.fsl = (char *)path_base(path)}, NULL);
}

/* Whether the largest value of @p info, as it is stored, is the number of an area of @p table. A map of 0 and 1 is a
 * mask, whatever is called 1. */
static bool table_names_the_largest(const struct label_table *table, const conus_volume_info *info)
{
    const double stored = (info->maximum - info->intercept) / info->slope;
    const double whole = tolerance_whole(stored, stored);
    const bool is_label = whole > 1 && whole <= UINT32_MAX && whole == rint(whole);
    const struct label *label = is_label ? label_table_find(table, (uint32_t)whole) : NULL;
    return label && label->name;
}

/* One map has no labels: a table in or beside its file may tell that it is none. */
static void doubt_by_table(struct load *load)
{
    struct job *job = &load->job;
    const char *source = "";
    struct label_table *table = labels_new(job);
    if (!job_step(job)) {
        return;
    }
    const struct label_volume volume = {.info = &load->atlas->volumes[0].info};
    const struct attempt attempt = job_try(job);
    label_table_of_volume(job, table, &source, &volume, NULL);
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    const char *name = path_base(volume.info->path);
    if (!job_ok(job) || !table->count) {
        return;
    }
    if (table_names_the_largest(table, volume.info) && !named_maps_is_probseg(volume.info->path)) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: --probability states that its values are probabilities, but %s names %zu label%s, its largest "
                 "value among them; without --probability the values are labels; of probabilities a file called "
                 "X_probseg.nii.gz has no doubt",
                 name, source, table->count, table->count > 1 ? "s" : "");
    } else {
        job_note(job, "%s: its values are stated to be probabilities, so %s, which names %zu labels, is not used", name,
                 source, table->count);
    }
}

void named_maps_load(struct load *load, const char *path, const struct named_maps *maps)
{
    struct job *job = &load->job;
    const double asked = load->options->probability;
    load_item(load, path,
              (struct scene_item){.file = (char *)path_base(path),
                                  .volume = maps->chosen ? maps->table->entries[0].number : 0},
              maps);
    if (job_ok(job) && maps->is_one && asked > 0 && !load->atlas->objects[0].voxels) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "%s: --probability states that its values are probabilities, but none is %g or more (up to %g)", path,
                 asked, load->atlas->volumes[0].info.maximum);
    }
    if (maps->notes) {
        (void)JOB_CALL(job, notes_move(&job->notes, maps->notes));
    }
    if (maps->is_one) {
        doubt_by_table(load);
    }
}
