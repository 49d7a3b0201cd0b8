/* SPDX-License-Identifier: BSD-3-Clause */
/* From a manifest to the atlas that it describes. Every failure names the manifest and the key. */
#include "loaders/scene/load_manifest.h"

#include "atlas/frame.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/labels/label_find.h"
#include "loaders/labels/labels_on_job.h"
#include "loaders/manifest/manifest.h"
#include "loaders/maps/fsl_maps.h"
#include "loaders/maps/load_probability.h"
#include "loaders/maps/load_scalar.h"
#include "loaders/scene/area_plan.h"
#include "loaders/scene/load_context.h"
#include "loaders/scene/load_streamlines.h"
#include "loaders/scene/load_transform.h"
#include "loaders/scene/parcellations.h"
#include "sources/source.h"

#include <math.h>
#include <string.h>

/* A manifest while it is loaded. */
struct scene {
    struct load *load;
    struct job *job; /* the load's */
    const struct manifest *manifest;
    const char *path;              /* of the manifest, ending in '/' if it was made for a folder */
    const struct bytes *file;      /* its bytes; NULL if it was made up */
    const char *names;             /* where the names of areas without a parcellation come from */
    const struct named_maps *maps; /* whose table names the volumes of a file that is ATLAS, and whose user sees no
                                 manifest; NULL without one */
    bool moves;                    /* what is added moves with the areas */
    bool has_image;                /* a context that is a volume */
    struct volume_file series;     /* kept for the pathways that follow, if any is in the same file */
    const char *series_name;       /* as the manifest writes it; NULL without one */
};

/* The path of a file that the manifest names, from where this process is; NULL for none. */
static const char *path_of(const struct scene *scene, const char *name)
{
    return name ? job_beside(scene->job, scene->path, name) : NULL;
}

/* The same with what chooses a volume and places it. */
static const char *source_path(const struct scene *scene, const struct manifest_volume *source)
{
    const double *r = source->resolution;
    const char *path = path_of(scene, source->file);
    path = source->chosen ? job_format(scene->job, "%s,volume=%u", path, source->volume) : path;
    path = r[0] > 0 ? job_format(scene->job, "%s,resolution=%.17g:%.17g:%.17g", path, r[0], r[1], r[2]) : path;
    return source->orientation ? job_format(scene->job, "%s,orientation=%s", path, source->orientation) : path;
}

/* What a manifest asks for in vain is its fault, not the caller's. */
static void blame_manifest(const struct scene *scene)
{
    scene->job->status = scene->job->status == CONUS_ERROR_ARGUMENT ? CONUS_ERROR_DATA : scene->job->status;
}

typedef void add_function(struct scene *scene, size_t i);

/* Adds entry `i` of a list, or the only one: what it has become is the atlas's. A file that is ATLAS has no manifest
 * which a message could name. */
static void add_entry(struct scene *scene, const char *key, size_t i, bool is_list, add_function *add)
{
    struct job *job = scene->job;
    const struct job_mark mark = job_mark(job);
    const size_t place = scene->maps ? job->depth : job_in(job, key, is_list ? i : JOB_ALONE);
    add(scene, i);
    job_out(job, place);
    job_release(job, mark);
    if (!scene->maps) {
        blame_manifest(scene);
    }
}

static void add_entries(struct scene *scene, const char *key, size_t count, bool is_list, add_function *add)
{
    for (size_t i = 0; i < count && job_ok(scene->job); i++) {
        add_entry(scene, key, i, is_list, add);
    }
}

/* Moves what the atlas has by a transform of the manifest. */
static void move_by(struct scene *scene, size_t i)
{
    const struct manifest_transform *transform = &scene->manifest->transforms.at[i];
    const char *path = path_of(scene, transform->file);
    const conus_transform_options options = {.from = path_of(scene, transform->from),
                                             .to = path_of(scene, transform->to),
                                             .grid = path_of(scene, transform->grid),
                                             .inverse = transform->inverse,
                                             .vectors = transform->vectors,
                                             .space = transform->space,
                                             .transform = transform->transform,
                                             .max_memory = scene->load->options->max_memory};
    transform_load(scene->job, scene->load->atlas, path, &options);
}

/* Reads a parcellation, without the notes that have been made of it before. */
static void load_parcellation(const struct scene *scene, struct parcellation *part,
                              const struct manifest_parcellation *from)
{
    static const char needed[] = "a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC or OME-Zarr) or an "
                                 "FSL atlas XML of type Label";
    struct load *load = scene->load;
    conus_load_options options = *load->options;
    const size_t note_count = scene->job->notes.count;
    const char *path = source_path(scene, &from->source);
    const bool is_asked = options.labels != NULL;
    options.labels = is_asked ? options.labels : path_of(scene, from->labels);
    load_report(load, path, 1);
    scene->job->sink = from->noted ? NULL : &load->sink;
    parcellation_read(scene->job, part, path, &options, needed);
    if (from->noted) {
        notes_cut(&scene->job->notes, note_count);
    }
    scene->job->sink = &load->sink;
    parcellation_shift(scene->job, part, from->label_offset, from->hemisphere);
    if (!is_asked) {
        blame_manifest(scene);
    }
}

static void refuse_labels(const struct scene *scene, const char *labels)
{
    const struct manifest *manifest = scene->manifest;
    const size_t count = manifest->parcellations.count;
    const bool is_made_up = !path_base(scene->path)[0];
    job_fail(scene->job, CONUS_ERROR_ARGUMENT,
             count ? "--labels %s: the manifest has %zu parcellations, it can say of each (labels)"
             : manifest->maps.count
                 ? "--labels %s: areas of probabilities have the names of the atlas XML, or those of "
                   "the manifest"
             : is_made_up ? "--labels %s: a folder of surfaces is named by its files; a manifest ('conus "
                            "manifest') can name them by a table (\"files\" with \"labels\")"
                          : "--labels %s: the manifest has no parcellation that they could name",
             labels, count);
}

/* Makes an atlas of the parcellations, if there are any, with all voxels that are no surface's. */
static void create_atlas(const struct scene *scene, struct area_plan *plan)
{
    const struct manifest *manifest = scene->manifest;
    const size_t count = manifest->parcellations.count;
    const char *labels = scene->load->options->labels;
    if (labels && !scene->maps && count != 1) {
        refuse_labels(scene, labels);
    }
    if (!count) {
        load_create(scene->load, NULL, 0, NULL, scene->names);
        return;
    }
    struct parcellations all = {.parts = job_zeroed(scene->job, count, sizeof *all.parts), .source = ""};
    all.count = all.parts ? count : 0;
    for (size_t i = 0; i < all.count; i++) {
        const size_t mark =
            job_in(scene->job, manifest->single ? "parcellation" : "parcellations", manifest->single ? JOB_ALONE : i);
        load_parcellation(scene, &all.parts[i], &manifest->parcellations.at[i]);
        job_out(scene->job, mark);
    }
    parcellations_unite(scene->job, &all);
    area_plan_settle(scene->job, plan, &all, manifest->prefer);
    parcellations_join(scene->job, &all);
    parcellations_atlas(scene->load, all.parts, all.count, &all.table, all.source);
}

/* Places the Allen CCF where the manifest says, or where a folder that has only surfaces says; volumes say it by their
 * grid. */
static void place_ccf(const struct scene *scene, const struct area_plan *plan)
{
    conus_atlas *atlas = scene->load->atlas;
    const enum manifest_ccf ccf = scene->manifest->ccf;
    if (ccf != MANIFEST_CCF_UNSTATED) {
        const size_t mark = job_in(scene->job, "ccf", JOB_ALONE);
        (void)JOB_CALL(scene->job, frame_set_ccf(atlas, ccf == MANIFEST_CCF_ASR));
        job_out(scene->job, mark);
    } else if (plan->has_ccf && job_ok(scene->job) && !conus_atlas_volume(atlas, 0)) {
        (void)JOB_CALL(scene->job, frame_set_ccf(atlas, plan->ccf_from_right));
    }
}

static void load_areas(const struct scene *scene)
{
    struct load *load = scene->load;
    struct area_plan plan = {0};
    const struct job_mark mark = job_mark(scene->job);
    area_plan_make(scene->job, &plan, scene->manifest, scene->path);
    const size_t planned = area_plan_files(&plan);
    load->job.total = manifest_file_count(scene->manifest) + planned;
    struct deferred_notes deferred = load_defer_notes(load);
    create_atlas(scene, &plan);
    load_release_notes(load, &deferred);
    load->job.total -= planned - area_plan_files(&plan); /* the parcellation may have them */
    place_ccf(scene, &plan);
    if (scene->file && path_base(scene->path)[0]) {
        (void)JOB_CALL(scene->job, atlas_add_file(load->atlas, scene->path, scene->file));
    }
    atlas_take(scene->job, load->atlas);
    area_plan_load(load, &plan, scene->manifest->space);
    job_release(scene->job, mark);
}

static conus_pathway_options pathway_options(const struct scene *scene, const struct manifest_pathway *pathway,
                                             const char *name)
{
    const conus_load_options *options = scene->load->options;
    double threshold = pathway->threshold > 0 ? pathway->threshold : scene->manifest->threshold;
    return (conus_pathway_options){.threshold = pathway->bands.count ? 0 : threshold,
                                   .name = name,
                                   .max_memory = options->max_memory,
                                   .log = options->log,
                                   .log_user = options->log_user,
                                   .bands = pathway->bands.at,
                                   .band_count = pathway->bands.count};
}

static void open_series(const struct scene *scene, struct volume_file *out, const char *name)
{
    const char *path = path_of(scene, name);
    load_at(scene->load, path);
    volume_load_series(scene->job, out, path, scene->load->options->max_memory);
}

/* Adds volume `volume` of `file`; notes of opening it go to the atlas with it. */
static void add_volume(const struct scene *scene, const struct manifest_pathway *pathway, struct volume_file *file,
                       size_t volume, const char *name)
{
    const conus_pathway_options options = pathway_options(scene, pathway, name);
    load_report(scene->load, file->path, 1);
    if (job_ok(scene->job)) {
        volume_select(scene->job, file, volume);
    }
    pathway_add(scene->job, scene->load->atlas, file, &options);
}

static void add_named_volumes(const struct scene *scene, const struct manifest_pathway *pathway)
{
    struct volume_file file = {0};
    open_series(scene, &file, pathway->source.file);
    if (file.info.volume_count != pathway->names.count) {
        job_bad(scene->job, "names: has %zu entries, %s has %zu volumes: they must be as many", pathway->names.count,
                pathway->source.file, file.info.volume_count);
    }
    for (size_t i = 0; i < pathway->names.count && job_ok(scene->job); i++) {
        add_volume(scene, pathway, &file, i, pathway->names.at[i]);
    }
    volume_file_finish(&file);
}

static struct fsl_maps open_fsl(const struct scene *scene, const struct manifest_pathway *entry)
{
    struct load *load = scene->load;
    const char *xml = path_of(scene, entry->fsl);
    const char *image = path_of(scene, entry->source.file);
    load_at(load, xml);
    const struct fsl_maps maps = fsl_maps_open(scene->job, load->atlas, xml, image, load->options);
    if (job_step(scene->job)) {
        load_at(load, maps.image->path);
        (void)JOB_CALL(scene->job, notes_move(&scene->job->notes, maps.notes));
        atlas_take(scene->job, load->atlas);
        load->job.total += maps.labels->count - 1; /* it counted as one so far */
    }
    return maps;
}

static void add_fsl(const struct scene *scene, const struct manifest_pathway *pathway)
{
    struct load *load = scene->load;
    const struct fsl_maps maps = open_fsl(scene, pathway);
    for (size_t i = 0; i < maps.labels->count && job_ok(scene->job); i++) {
        const struct label *label = &maps.labels->entries[i];
        add_volume(scene, pathway, maps.image, label->number - 1, label->name);
    }
    if (job_step(scene->job)) {
        job_note(scene->job, "pathways of %s: %zu, from %s", path_base(pathway->fsl), maps.labels->count,
                 path_base(maps.image->path));
    }
    atlas_take(scene->job, load->atlas);
}

/* Adds a volume of the file for each label, whose number is that of the volume from 1. The areas' labels are these
 * numbers less `skipped` behind the labels that there are, for a single volume the next one. */
static void add_labelled(const struct scene *scene, const struct manifest_pathway *entry, struct volume_file *file,
                         const struct label_table *labels, uint32_t skipped)
{
    struct load *load = scene->load;
    uint32_t before = 0;
    for (size_t i = 0; job_ok(scene->job) && i < load->atlas->object_count; i++) {
        const uint32_t label = load->atlas->objects[i].label;
        before = label > before ? label : before;
    }
    const double asked = load->options->probability;
    const double threshold = asked > 0 ? asked : entry->threshold > 0 ? entry->threshold : 0.25; /* as of a pathway */
    struct probability_maps *maps = probability_maps_new(scene->job, file);
    for (size_t i = 0; job_ok(scene->job) && i < maps->count; i++) {
        const bool is_kept = label_table_find(labels, (uint32_t)i + 1);
        if (is_kept) {
            load_report(load, file->path, 1);
        }
        probability_maps_read(scene->job, maps, i, is_kept);
    }
    const struct probability_scale scale = probability_scale_of(scene->job, maps, entry->scale);
    for (size_t i = 0; job_ok(scene->job) && i < labels->count; i++) {
        struct label label = labels->entries[i];
        const uint32_t volume = label.number - 1;
        label.number = before + (entry->source.chosen ? 1 : label.number - skipped);
        probability_add(scene->job, load->atlas, maps, volume, &label, &scale, threshold);
    }
    if (job_ok(scene->job)) {
        job_note(scene->job, "%s: %zu area%s by probabilities of %s and more (values: %s)", path_base(file->path),
                 labels->count, labels->count == 1 ? "" : "s", NUMBER_TEXT(threshold), scale.words);
    }
    atlas_take(scene->job, load->atlas);
}

static void add_fsl_areas(const struct scene *scene, const struct manifest_pathway *entry)
{
    const struct fsl_maps maps = open_fsl(scene, entry);
    add_labelled(scene, entry, maps.image, maps.labels, maps.has_background);
}

/* The labels of the volumes that the entry means: those it names, the one it chooses, or the only one. */
static const struct label_table *label_volumes(struct job *job, const struct manifest_pathway *entry,
                                               const struct volume_file *file)
{
    struct label_table *table = labels_new(job);
    const size_t count = entry->names.count ? entry->names.count : 1;
    if (entry->names.count ? count != file->info.volume_count : !entry->source.chosen && file->info.volume_count > 1) {
        job_bad(job, "%s: has %zu volumes: names (one for each), fsl or volume is needed", entry->source.file,
                file->info.volume_count);
    }
    for (size_t i = 0; i < count && job_ok(job); i++) {
        const char *stem = path_base(file->path);
        const char *name = entry->names.count ? entry->names.at[i] : entry->name;
        struct label *label = labels_add(job, table, (uint32_t)(entry->source.chosen ? entry->source.volume : i) + 1);
        labels_set(job, &label->name, name ? text_from(name) : (struct text){stem, volume_stem_length(stem)});
    }
    return table;
}

static void add_file_areas(const struct scene *scene, const struct manifest_pathway *entry)
{
    struct volume_file file = {0};
    open_series(scene, &file, entry->source.file);
    if (scene->maps) {
        named_maps_check(scene->job, &file, scene->load->options->probability);
    }
    add_labelled(scene, entry, &file, scene->maps ? scene->maps->table : label_volumes(scene->job, entry, &file), 0);
    volume_file_finish(&file);
}

static void add_areas(struct scene *scene, size_t i)
{
    const struct manifest_pathway *entry = &scene->manifest->maps.at[i];
    if (entry->fsl) {
        add_fsl_areas(scene, entry);
    } else {
        add_file_areas(scene, entry);
    }
}

static void add_single(const struct scene *scene, const struct manifest_pathway *pathway)
{
    const conus_pathway_options options = pathway_options(scene, pathway, pathway->name);
    const char *path = source_path(scene, &pathway->source);
    load_report(scene->load, path, 1);
    pathway_load(scene->job, scene->load->atlas, path, &options);
}

/* Adds a pathway that is in the same file as its neighbours in the manifest. */
static void add_of_series(struct scene *scene, const struct manifest_pathway *pathway)
{
    const char *name = pathway->source.file;
    if (!scene->series_name || strcmp(scene->series_name, name) != 0) {
        volume_file_finish(&scene->series);
        open_series(scene, &scene->series, name);
        scene->series_name = name;
    }
    add_volume(scene, pathway, &scene->series, pathway->source.volume, pathway->name);
}

/* Whether both are volumes of a file that says by itself where it lies. */
static bool of_one_file(const struct manifest_pathway *a, const struct manifest_pathway *b)
{
    bool placed =
        a->source.orientation || b->source.orientation || a->source.resolution[0] > 0 || b->source.resolution[0] > 0;
    return a->source.chosen && b->source.chosen && !placed && strcmp(a->source.file, b->source.file) == 0;
}

static void add_pathway(struct scene *scene, size_t i)
{
    const struct manifest_pathway *pathway = &scene->manifest->pathways.at[i];
    const bool is_last = i + 1 == scene->manifest->pathways.count;
    if (pathway->moves != scene->moves) {
        return;
    }
    if (pathway->fsl) {
        add_fsl(scene, pathway);
    } else if (pathway->names.count) {
        add_named_volumes(scene, pathway);
    } else if ((i && of_one_file(pathway - 1, pathway)) || (!is_last && of_one_file(pathway, pathway + 1))) {
        add_of_series(scene, pathway);
    } else {
        add_single(scene, pathway);
    }
}

static void add_bundles(struct scene *scene, size_t i)
{
    struct load *load = scene->load;
    const struct manifest_streamlines *entry = &scene->manifest->streamlines.at[i];
    if (entry->moves == scene->moves) {
        const char *path = path_of(scene, entry->file);
        load_report(load, path, 1);
        const double radius = streamlines_radius(scene->job, entry->radius, path);
        conus_atlas *alone = streamlines_load(scene->job, path, entry->space);
        streamlines_take(scene->job, load->atlas, alone, radius, entry->name);
    }
}

/* What keeps the file `path` from being the context that the entry describes; NULL = nothing. */
static const char *refuse_context(const struct scene *scene, const struct manifest_context *entry, const char *path)
{
    if (source_format(scene->job, path, ROLE_SURFACE)) {
        return entry->transfer     ? "transfer: is for volumes, this is a surface"
               : entry->blocks > 0 ? "blocks: only voxels of a volume do, this is a surface"
               : entry->moves      ? "moves: a surface is where poses are"
                                   : NULL;
    }
    return entry->opacity != 0 ? "opacity: is for surfaces, this is none; a volume has a transfer function"
           : scene->has_image  ? "file: is no surface, and there is a volume already"
                               : NULL;
}

/* Keeps what the entry says of its transfer function. */
static void take_transfer(const struct scene *scene, const struct manifest_context *entry)
{
    char **transfer = &scene->load->atlas->transfer;
    const char *name = entry->transfer_is_file ? path_of(scene, entry->transfer) : entry->transfer;
    if (entry->transfer_is_file && !job_has_file(scene->job, name)) {
        job_fail(scene->job, CONUS_ERROR_IO, "transfer.file: %s: there is no such file", name);
    }
    memory_free(*transfer);
    *transfer = job_give(scene->job, job_format(scene->job, "%s", name), strlen(name) + 1);
}

/* Whether a context that is a volume is left out: it is not wanted, and no answer needs it. One does where it blocks
 * rays; where the atlas is moved, and compared with its head; where it would be the first volume, which says whose
 * brain it is; where something is to be noted about its place. What is left out may not be there, as it is in no
 * sidecar. */
static bool is_left_out(const struct scene *scene, const struct manifest_context *entry, const char *path)
{
    const conus_load_options *options = scene->load->options;
    const char *file = path_of(scene, entry->source.file);
    return job_ok(scene->job) && options->without_context && !(entry->blocks > 0) &&
           !scene->manifest->transforms.count && scene->load->atlas->volume_count &&
           !source_format(scene->job, path, ROLE_SURFACE) &&
           ((!file_exists(file) && !file_is_folder(file)) || context_is_plain(scene->job, scene->load->atlas, path));
}

static void set_context(struct scene *scene, size_t i)
{
    struct load *load = scene->load;
    const struct manifest_context *entry = &scene->manifest->contexts.at[i];
    const conus_context_options options = {.block_threshold = entry->blocks,
                                           .max_memory = load->options->max_memory,
                                           .log = load->options->log,
                                           .log_user = load->options->log_user,
                                           .opacity = entry->opacity};
    if (entry->moves != scene->moves) {
        return;
    }
    const char *path = source_path(scene, &entry->source);
    load_report(load, path, 1);
    const bool is_image = job_ok(scene->job) && !source_format(scene->job, path, ROLE_SURFACE);
    const char *wrong = job_ok(scene->job) ? refuse_context(scene, entry, path) : NULL;
    if (wrong) {
        job_bad(scene->job, "%s", wrong);
    }
    scene->has_image = scene->has_image || is_image;
    if (is_left_out(scene, entry, path)) {
        load->atlas->lacks_context = true;
        return;
    }
    context_load(scene->job, load->atlas, path, &options);
    if (entry->transfer && job_step(scene->job)) {
        take_transfer(scene, entry);
    }
}

/* Adds what is around the areas: that which moves with them, or that which does not. */
static void add_others(struct scene *scene, bool moves)
{
    const struct manifest *manifest = scene->manifest;
    scene->moves = moves;
    add_entries(scene, "pathways", manifest->pathways.count, true, add_pathway);
    volume_file_finish(&scene->series);
    scene->series_name = NULL;
    add_entries(scene, "streamlines", manifest->streamlines.count, true, add_bundles);
    add_entries(scene, "context", manifest->contexts.count, manifest->contexts.count > 1, set_context);
}

static void load_scene(struct scene *scene)
{
    struct load *load = scene->load;
    const struct manifest *manifest = scene->manifest;
    if (!job_step(&load->job)) { /* there may be no manifest */
        return;
    }
    scene->job = &load->job;
    struct deferred_notes deferred = load_defer_notes(load);
    const size_t place = scene->maps ? load->job.depth : job_in(&load->job, scene->path, JOB_ALONE);
    load_areas(scene);
    add_entries(scene, "probabilities", manifest->maps.count, true, add_areas);
    add_others(scene, true);
    for (size_t i = manifest->transforms.count; i > 0; i--) { /* it goes back through the last one first */
        add_entry(scene, "transform", i - 1, !manifest->single_transform, move_by);
    }
    add_others(scene, false);
    if (job_ok(scene->job) && manifest->brain) {
        load->atlas->brain = manifest->brain;
    }
    job_out(&load->job, place);
    load_release_notes(load, &deferred);
}

void manifest_load(struct load *load, const char *path, const struct bytes *file)
{
    struct job *job = &load->job;
    struct manifest manifest;
    const size_t mark = job_in(job, path, JOB_ALONE);
    manifest_parse(job, &manifest, text_from_bytes(file->data, file->size));
    job_out(job, mark);
    load_scene(
        &(struct scene){.load = load, .manifest = &manifest, .path = path, .file = file, .names = "the manifest"});
}

void manifest_load_made(struct load *load, const struct manifest *manifest, const char *path, const char *names)
{
    load_scene(&(struct scene){.load = load, .manifest = manifest, .path = path, .names = names});
}

/* Loads an entry of probabilities, whose path is in the folder of `path`, as an atlas of its own. */
static void load_entry(struct load *load, const char *path, struct manifest_pathway *entry,
                       const struct named_maps *maps)
{
    const struct manifest manifest = {.maps = {.at = entry, .count = 1}};
    const char *name = path_base(path);
    const char *folder = name == path ? "./" : job_format(&load->job, "%.*s", (int)(name - path), path);
    load_scene(&(struct scene){.load = load,
                               .manifest = &manifest,
                               .path = folder,
                               .names = maps ? maps->source : "FSL atlas XML",
                               .maps = maps});
}

void probabilities_load(struct load *load, const char *path)
{
    struct manifest_pathway entry = {.fsl = (char *)path_base(path)};
    load_entry(load, path, &entry, NULL);
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
    struct manifest_pathway entry = {.source = {.file = (char *)path_base(path),
                                                .chosen = maps->chosen,
                                                .volume = maps->table->entries[0].number - 1}};
    load_entry(load, path, &entry, maps);
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
