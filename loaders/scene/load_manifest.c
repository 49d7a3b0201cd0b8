/* SPDX-License-Identifier: BSD-3-Clause */
/* From a manifest to the atlas that it describes. Every failure names the manifest and the key. */
#include "loaders/scene/load_manifest.h"

#include "atlas/frame.h"
#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/label_find.h"
#include "loaders/manifest/manifest.h"
#include "loaders/maps/fsl_maps.h"
#include "loaders/maps/load_probability.h"
#include "loaders/maps/load_scalar.h"
#include "loaders/scene/area_plan.h"
#include "loaders/scene/load_streamlines.h"
#include "loaders/scene/parcellations.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A manifest while it is loaded. */
struct loading {
    const struct manifest *manifest;
    const char *path;         /* of the manifest, ending in '/' if it was made for a folder */
    const struct bytes *file; /* its bytes; NULL if it was made up */
    const char *names;        /* where the names of areas without a parcellation come from */
    const conus_load_options *options;
    conus_atlas *atlas;
    struct volume_file series; /* kept for the pathways that follow, if any is in the same file */
    const char *series_name;   /* as the manifest writes it; NULL without one */
    struct load_progress *progress;
    struct named_maps *maps; /* whose table names the volumes of a file that is ATLAS; NULL without one */
};

/* After a failure puts manifest, key and entry in front of the message. What a manifest asks for in vain is its fault,
 * not the caller's. */
static conus_status fail_at(conus_status status, const struct loading *loading, const char *key, size_t entry)
{
    status = fail_in_entry(status == CONUS_ERROR_ARGUMENT ? CONUS_ERROR_DATA : status, key, entry);
    return status ? fail_in(status, loading->path) : CONUS_OK;
}

static conus_status move_by(struct loading *loading, const struct manifest_transform *transform)
{
    enum { FILES = 4 };
    const char *const given[FILES] = {transform->file, transform->from, transform->to, transform->grid};
    char *paths[FILES] = {NULL};
    bool whole = true;
    for (size_t i = 0; i < FILES; i++) {
        paths[i] = given[i] ? file_beside(loading->path, given[i]) : NULL;
        whole = whole && (paths[i] || !given[i]);
    }
    const conus_transform_options options = {.from = paths[1],
                                             .to = paths[2],
                                             .grid = paths[3],
                                             .inverse = transform->inverse,
                                             .vectors = transform->vectors,
                                             .space = transform->space,
                                             .transform = transform->transform,
                                             .max_memory = loading->options->max_memory};
    conus_status status = whole ? conus_atlas_transform(loading->atlas, paths[0], &options) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < FILES; i++) {
        memory_free(paths[i]);
    }
    return status;
}

/* Moves what the atlas has by the transforms of the manifest; after an error some of them may be done. */
static conus_status move_atlas(struct loading *loading)
{
    const struct manifest *manifest = loading->manifest;
    conus_status status = CONUS_OK;
    for (size_t i = manifest->transform_count; !status && i > 0; i--) { /* the atlas goes back through the last first */
        status = move_by(loading, &manifest->transforms[i - 1]);
        status = fail_at(status, loading, "transform", manifest->single_transform ? FAIL_ALONE : i - 1);
    }
    return status;
}

/* The path of `source` from where this process is, with what chooses a volume and places it; NULL without memory. */
static char *source_path(const struct loading *loading, const struct manifest_volume *source)
{
    char *path = file_beside(loading->path, source->file);
    struct buffer selected = {0};
    buffer_text(&selected, path ? path : "");
    if (source->chosen) {
        buffer_format(&selected, ",volume=%u", source->volume);
    }
    if (source->resolution[0] > 0) {
        const double *r = source->resolution;
        buffer_format(&selected, ",resolution=%.17g:%.17g:%.17g", r[0], r[1], r[2]);
    }
    if (source->orientation) {
        buffer_format(&selected, ",orientation=%s", source->orientation);
    }
    selected.failed = selected.failed || !path;
    memory_free(path);
    return selected.failed ? (buffer_finish(&selected), NULL) : selected.data;
}

/* Reads a parcellation, without the notes that have been made of it before. */
static conus_status load_parcellation(struct parcellation *part, struct loading *loading,
                                      const struct manifest_parcellation *from)
{
    static const char needed[] = "a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC or OME-Zarr) or an "
                                 "FSL atlas XML of type Label";
    const struct note_sink *sink = part->notes.sink;
    conus_load_options options = *loading->options;
    char *labels = from->labels && !options.labels ? file_beside(loading->path, from->labels) : NULL;
    char *path = source_path(loading, &from->source);
    conus_status status = path && (labels || !from->labels || options.labels) ? CONUS_OK : CONUS_ERROR_MEMORY;
    options.labels = labels ? labels : options.labels;
    part->notes.sink = from->noted ? NULL : sink;
    status = status ? status : load_progress_report(loading->progress, path, 1);
    status = status ? status : parcellation_read(part, path, &options, needed);
    status = status ? status : parcellation_shift(part, from->label_offset, from->hemisphere);
    memory_free(path);
    memory_free(labels);
    if (from->noted) {
        notes_cut(&part->notes, 0);
        part->notes.sink = sink;
    }
    if (status == CONUS_ERROR_ARGUMENT && !loading->options->labels) { /* as in fail_at() */
        status = CONUS_ERROR_DATA;
    }
    return status;
}

static conus_status load_parcellations(struct parcellations *all, struct loading *loading)
{
    const struct manifest *manifest = loading->manifest;
    conus_status status = parcellations_reserve(all, manifest->parcellation_count, &loading->progress->sink);
    for (size_t i = 0; !status && i < all->count; i++) {
        status = load_parcellation(&all->parts[i], loading, &manifest->parcellations[i]);
        status = manifest->single ? fail_in_entry(status, "parcellation", FAIL_ALONE)
                                  : fail_in_entry(status, "parcellations", i);
    }
    return status ? status : parcellations_unite(all);
}

static conus_status refuse_labels(const struct loading *loading)
{
    const char *labels = loading->options->labels;
    if (loading->manifest->map_count) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "--labels %s: areas of probabilities have the names of the atlas XML, or "
                    "those of the manifest",
                    labels);
    }
    bool made_up = !path_base(loading->path)[0];
    return made_up ? fail(CONUS_ERROR_ARGUMENT,
                          "--labels %s: a folder of surfaces is named by its files; a manifest ('conus manifest') can "
                          "name them by a table (\"files\" with \"labels\")",
                          labels)
                   : fail(CONUS_ERROR_ARGUMENT, "--labels %s: the manifest has no parcellation that they could name",
                          labels);
}

/* Makes an atlas of the parcellations, if there are any, with all voxels that are no surface's. */
static conus_status create_atlas(struct loading *loading, struct area_plan *plan)
{
    struct parcellations all = {0};
    size_t count = loading->manifest->parcellation_count;
    if (!count && loading->options->labels && !loading->maps) {
        return refuse_labels(loading);
    }
    if (!count) {
        conus_status status = atlas_create_empty(&loading->atlas, loading->names);
        if (!status) {
            loading->atlas->notes.sink = &loading->progress->sink;
        }
        return status;
    }
    if (count > 1 && loading->options->labels) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "--labels %s: the manifest has %zu parcellations, it can say of each (labels)",
                    loading->options->labels, count);
    }
    conus_status status = load_parcellations(&all, loading);
    status = status ? status : area_plan_settle(plan, &all, loading->manifest->prefer);
    status = status ? status : parcellations_join(&all);
    status = status ? status : parcellations_atlas(&loading->atlas, &all);
    status = status ? status : file_sums_move(&plan->read, &all.read);
    parcellations_finish(&all);
    return status;
}

/* Places the Allen CCF where the manifest says, or where a folder that has only surfaces says; volumes say it by their
 * grid. */
static conus_status place_ccf(struct loading *loading, const struct area_plan *plan)
{
    enum manifest_ccf ccf = loading->manifest->ccf;
    if (ccf == MANIFEST_CCF_UNSTATED) {
        bool has_only_surfaces = !conus_atlas_volume(loading->atlas, 0);
        return plan->has_ccf && has_only_surfaces ? frame_set_ccf(loading->atlas, plan->ccf_from_right) : CONUS_OK;
    }
    conus_status status = frame_set_ccf(loading->atlas, ccf == MANIFEST_CCF_ASR);
    return status ? fail_in(status, "ccf") : CONUS_OK;
}

static conus_status load_areas(struct loading *loading)
{
    struct area_plan plan = {.max_memory = loading->options->max_memory};
    struct notes notes = {.sink = &loading->progress->sink};
    conus_status status = area_plan_make(&plan, loading->manifest, loading->path, &notes);
    size_t planned = area_plan_files(&plan);
    loading->progress->total = manifest_file_count(loading->manifest) + planned;
    status = status ? status : create_atlas(loading, &plan);
    loading->progress->total -= planned - area_plan_files(&plan); /* the parcellation may have them */
    status = status ? status : place_ccf(loading, &plan);
    status = status ? status : notes_move(&loading->atlas->notes, &notes);
    if (!status && loading->file && path_base(loading->path)[0]) {
        status = atlas_add_file(loading->atlas, loading->path, loading->file);
    }
    status = status ? status : file_sums_move(&loading->atlas->files, &plan.read);
    status = status
                 ? status
                 : area_plan_load(&plan, loading->atlas, loading->manifest->space, loading->options, loading->progress);
    area_plan_finish(&plan);
    notes_finish(&notes);
    return status ? fail_in(status, loading->path) : CONUS_OK;
}

static conus_pathway_options pathway_options(const struct loading *loading, const struct manifest_pathway *pathway,
                                             const char *name)
{
    double threshold = pathway->threshold > 0 ? pathway->threshold : loading->manifest->threshold;
    return (conus_pathway_options){.threshold = pathway->band_count ? 0 : threshold,
                                   .name = name,
                                   .max_memory = loading->options->max_memory,
                                   .log = loading->options->log,
                                   .log_user = loading->options->log_user,
                                   .bands = pathway->bands,
                                   .band_count = pathway->band_count};
}

/* Adds volume `volume` of `file`; notes of opening it go to the atlas with it. */
static conus_status add_volume(struct loading *loading, const struct manifest_pathway *pathway,
                               struct volume_file *file, size_t volume, const char *name, struct notes *notes)
{
    const conus_pathway_options options = pathway_options(loading, pathway, name);
    conus_status status = load_progress_report(loading->progress, file->path, 1);
    status = status ? status : volume_file_select(file, volume);
    return status ? status : pathway_add(loading->atlas, file, &options, notes);
}

static conus_status add_named_volumes(struct loading *loading, const struct manifest_pathway *pathway)
{
    struct volume_file file = {0};
    struct notes notes = {.sink = &loading->progress->sink};
    char *path = file_beside(loading->path, pathway->source.file);
    conus_status status = path ? load_progress_at(loading->progress, path) : CONUS_ERROR_MEMORY;
    status = status ? status : volume_file_open_series(&file, path, loading->options, &notes);
    if (!status && file.info.volume_count != pathway->name_count) {
        status = fail(CONUS_ERROR_DATA, "names: has %zu entries, %s has %zu volumes: they must be as many",
                      pathway->name_count, pathway->source.file, file.info.volume_count);
    }
    for (size_t i = 0; !status && i < pathway->name_count; i++) {
        status = add_volume(loading, pathway, &file, i, pathway->names[i], &notes);
    }
    volume_file_finish(&file);
    notes_finish(&notes);
    memory_free(path);
    return status;
}

static conus_status open_fsl(struct fsl_maps *out, struct loading *loading, const struct manifest_pathway *entry)
{
    char *xml = file_beside(loading->path, entry->fsl);
    char *image = entry->source.file ? file_beside(loading->path, entry->source.file) : NULL;
    conus_status status = xml && (image || !entry->source.file) ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : load_progress_at(loading->progress, xml);
    status = status ? status : fsl_maps_open(out, loading->atlas, xml, image, loading->options);
    if (!status) {
        status = load_progress_at(loading->progress, out->image.path);
        status = status ? status : notes_move(&loading->atlas->notes, &out->notes);
        out->notes.sink = &loading->progress->sink;
    }
    memory_free(xml);
    memory_free(image);
    return status;
}

static conus_status add_fsl(struct loading *loading, const struct manifest_pathway *pathway)
{
    struct fsl_maps maps = {0};
    conus_status status = open_fsl(&maps, loading, pathway);
    loading->progress->total += status ? 0 : maps.atlas.labels.count - 1; /* it counted as one so far */
    for (size_t i = 0; !status && i < maps.atlas.labels.count; i++) {
        const struct label *label = &maps.atlas.labels.entries[i];
        status = add_volume(loading, pathway, &maps.image, label->number - 1, label->name, &maps.notes);
    }
    status = status ? status
                    : notes_add(&loading->atlas->notes, "pathways of %s: %zu, from %s", path_base(pathway->fsl),
                                maps.atlas.labels.count, path_base(maps.image.path));
    fsl_maps_finish(&maps);
    return status;
}

/* Adds a volume of the file for each label, whose number is that of the volume from 1. The areas' labels are these
 * numbers less `skipped` behind the labels that there are, for a single volume the next one. */
static conus_status add_labelled(struct loading *loading, const struct manifest_pathway *entry,
                                 struct volume_file *file, const struct label_table *labels, uint32_t skipped,
                                 struct notes *notes)
{
    char words[TEXT_NUMBER_SIZE];
    const conus_atlas *atlas = loading->atlas;
    uint32_t before = 0;
    for (size_t i = 0; i < atlas->object_count; i++) {
        before = atlas->objects[i].label > before ? atlas->objects[i].label : before;
    }
    const double asked = loading->options->probability;
    const double threshold = asked > 0 ? asked : entry->threshold > 0 ? entry->threshold : 0.25; /* as of a pathway */
    struct probability_scale scale;
    conus_status status = probability_scale_of(&scale, file, entry->scale, notes);
    for (size_t i = 0; !status && i < labels->count; i++) {
        struct label label = labels->entries[i];
        status = load_progress_report(loading->progress, file->path, 1);
        label.number = before + (entry->source.chosen ? 1 : label.number - skipped);
        status = status ? status
                        : probability_add(loading->atlas, file, labels->entries[i].number - 1, &label, &scale,
                                          threshold, notes);
    }
    return status ? status
                  : notes_add(&loading->atlas->notes, "%s: %zu areas by probabilities of %s and more (values: %s)",
                              path_base(file->path), labels->count, text_number(words, threshold), scale.words);
}

static conus_status add_fsl_areas(struct loading *loading, const struct manifest_pathway *entry)
{
    struct fsl_maps maps = {0};
    conus_status status = open_fsl(&maps, loading, entry);
    loading->progress->total += status ? 0 : maps.atlas.labels.count - 1;
    status = status ? status
                    : add_labelled(loading, entry, &maps.image, &maps.atlas.labels, maps.has_background, &maps.notes);
    fsl_maps_finish(&maps);
    return status;
}

/* The labels of the volumes that the entry means: those it names, the one it chooses, or the only one. */
static conus_status label_volumes(struct label_table *out, const struct manifest_pathway *entry,
                                  const struct volume_file *file)
{
    const char *stem = path_base(file->path);
    size_t count = entry->names ? entry->name_count : 1;
    if (entry->names ? count != file->info.volume_count : !entry->source.chosen && file->info.volume_count > 1) {
        return fail(CONUS_ERROR_DATA, "%s: has %zu volumes: names (one for each), fsl or volume is needed",
                    entry->source.file, file->info.volume_count);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < count; i++) {
        struct label *label = label_table_add(out, (uint32_t)(entry->source.chosen ? entry->source.volume : i) + 1);
        const char *name = entry->names ? entry->names[i] : entry->name;
        const struct text text = name ? text_from(name) : (struct text){stem, volume_stem_length(stem)};
        status = label ? label_set_text(&label->name, text) : CONUS_ERROR_MEMORY;
    }
    return status;
}

static conus_status add_file_areas(struct loading *loading, const struct manifest_pathway *entry)
{
    struct volume_file file = {0};
    struct notes notes = {.sink = &loading->progress->sink};
    struct label_table labels = {0};
    char *path = file_beside(loading->path, entry->source.file);
    conus_status status = path ? load_progress_at(loading->progress, path) : CONUS_ERROR_MEMORY;
    status = status ? status : volume_file_open_series(&file, path, loading->options, &notes);
    if (loading->maps) {
        status = status ? status : named_maps_check(&file, loading->options->probability, &notes);
        status = status ? status : add_labelled(loading, entry, &file, &loading->maps->table, 0, &notes);
    } else {
        status = status ? status : label_volumes(&labels, entry, &file);
        status = status ? status : add_labelled(loading, entry, &file, &labels, 0, &notes);
    }
    label_table_finish(&labels);
    volume_file_finish(&file);
    notes_finish(&notes);
    memory_free(path);
    return status;
}

static conus_status add_probabilities(struct loading *loading)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < loading->manifest->map_count; i++) {
        const struct manifest_pathway *entry = &loading->manifest->maps[i];
        status = entry->fsl ? add_fsl_areas(loading, entry) : add_file_areas(loading, entry);
        status = loading->maps ? status : fail_at(status, loading, "probabilities", i);
    }
    return status;
}

static conus_status add_single(struct loading *loading, const struct manifest_pathway *pathway)
{
    const conus_pathway_options options = pathway_options(loading, pathway, pathway->name);
    char *path = source_path(loading, &pathway->source);
    conus_status status = path ? load_progress_report(loading->progress, path, 1) : CONUS_ERROR_MEMORY;
    status = status ? status : conus_atlas_add_pathway(loading->atlas, path, &options);
    memory_free(path);
    return status;
}

static void close_series(struct loading *loading)
{
    volume_file_finish(&loading->series);
    loading->series_name = NULL;
}

/* Adds a pathway that is in the same file as its neighbours in the manifest. */
static conus_status add_of_series(struct loading *loading, const struct manifest_pathway *pathway)
{
    struct notes notes = {.sink = &loading->progress->sink};
    const char *name = pathway->source.file;
    conus_status status = CONUS_OK;
    if (!loading->series_name || strcmp(loading->series_name, name) != 0) {
        close_series(loading);
        char *path = file_beside(loading->path, name);
        status = path ? load_progress_at(loading->progress, path) : CONUS_ERROR_MEMORY;
        status = status ? status : volume_file_open_series(&loading->series, path, loading->options, &notes);
        loading->series_name = status ? NULL : name;
        memory_free(path);
    }
    status =
        status ? status : add_volume(loading, pathway, &loading->series, pathway->source.volume, pathway->name, &notes);
    notes_finish(&notes);
    return status;
}

/* Whether both are volumes of a file that says by itself where it lies. */
static bool of_one_file(const struct manifest_pathway *a, const struct manifest_pathway *b)
{
    bool placed =
        a->source.orientation || b->source.orientation || a->source.resolution[0] > 0 || b->source.resolution[0] > 0;
    return a->source.chosen && b->source.chosen && !placed && strcmp(a->source.file, b->source.file) == 0;
}

/* Adds the pathways that move with the areas, or those that do not. */
static conus_status add_pathways(struct loading *loading, bool moves)
{
    conus_status status = CONUS_OK;
    size_t count = loading->manifest->pathway_count;
    for (size_t i = 0; !status && i < count; i++) {
        const struct manifest_pathway *pathway = &loading->manifest->pathways[i];
        if (pathway->moves != moves) {
            continue;
        }
        bool shared = (i && of_one_file(pathway - 1, pathway)) || (i + 1 < count && of_one_file(pathway, pathway + 1));
        status = pathway->fsl     ? add_fsl(loading, pathway)
                 : pathway->names ? add_named_volumes(loading, pathway)
                 : shared         ? add_of_series(loading, pathway)
                                  : add_single(loading, pathway);
        status = fail_at(status, loading, "pathways", i);
    }
    close_series(loading);
    return status;
}

static conus_status add_streamlines(struct loading *loading, bool moves)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < loading->manifest->streamlines_count; i++) {
        const struct manifest_streamlines *entry = &loading->manifest->streamlines[i];
        if (entry->moves == moves) {
            status = streamlines_add_entry(loading->atlas, entry, loading->path, loading->progress);
            status = fail_at(status, loading, "streamlines", i);
        }
    }
    return status;
}

/* Sets the file `path` as the entry says, without its transfer function. */
static conus_status context_entry_set(conus_atlas *atlas, const struct manifest_context *entry, const char *path,
                                      const conus_load_options *options)
{
    const conus_context_options context = {.block_threshold = entry->blocks,
                                           .max_memory = options->max_memory,
                                           .log = options->log,
                                           .log_user = options->log_user,
                                           .opacity = entry->opacity};
    const char *wrong;
    if (mesh_file_is(path)) {
        wrong = entry->transfer     ? "transfer: is for volumes, this is a surface"
                : entry->blocks > 0 ? "blocks: only voxels of a volume do, this is a surface"
                : entry->moves      ? "moves: a surface is where poses are"
                                    : NULL;
    } else {
        wrong = entry->opacity != 0    ? "opacity: is for surfaces, this is none; a volume has a transfer function"
                : atlas_context(atlas) ? "file: is no surface, and there is a volume already"
                                       : NULL;
    }
    return wrong ? fail(CONUS_ERROR_DATA, "%s", wrong) : conus_atlas_set_context(atlas, path, &context);
}

static conus_status context_entry_transfer(conus_atlas *atlas, const struct manifest_context *context, const char *path)
{
    const char *name = context->transfer;
    memory_free(atlas->transfer);
    atlas->transfer = context->transfer_is_file ? file_beside(path, name) : memory_text(name, strlen(name));
    if (!atlas->transfer || !context->transfer_is_file || file_exists(atlas->transfer)) {
        return atlas->transfer ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    return fail(CONUS_ERROR_IO, "transfer.file: %s: there is no such file", atlas->transfer);
}

static conus_status set_contexts(struct loading *loading, bool moves)
{
    const struct manifest *manifest = loading->manifest;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < manifest->context_count && !status; i++) {
        const struct manifest_context *context = &manifest->contexts[i];
        if (context->moves != moves) {
            continue;
        }
        char *path = source_path(loading, &context->source);
        status = path ? load_progress_report(loading->progress, path, 1) : CONUS_ERROR_MEMORY;
        status = status ? status : context_entry_set(loading->atlas, context, path, loading->options);
        memory_free(path);
        status = status || !context->transfer ? status : context_entry_transfer(loading->atlas, context, loading->path);
        status = fail_at(status, loading, "context", manifest->context_count > 1 ? i : FAIL_ALONE);
    }
    return status;
}

/* Adds the contexts: those that move with the areas, or those that do not. */
static conus_status add_others(struct loading *loading, bool moves)
{
    conus_status status = add_pathways(loading, moves);
    status = status ? status : add_streamlines(loading, moves);
    return status ? status : set_contexts(loading, moves);
}

static conus_status load_scene(conus_atlas **out, struct loading *loading)
{
    conus_status status = load_areas(loading);
    status = status ? status : add_probabilities(loading);
    status = status ? status : add_others(loading, true);
    status = status ? status : move_atlas(loading);
    status = status ? status : add_others(loading, false);
    return atlas_give(out, loading->atlas, status);
}

conus_status manifest_load(conus_atlas **out, const char *path, const struct bytes *file,
                           struct load_progress *progress)
{
    struct job job = {0}; /* Bridge: of the parser */
    struct manifest manifest;
    manifest_parse(&job, &manifest, text_from_bytes(file->data, file->size));
    if (!job_ok(&job)) {
        return fail_in(job_close(&job, NULL, NULL), path);
    }
    struct loading loading = {.manifest = &manifest,
                              .path = path,
                              .file = file,
                              .names = "the manifest",
                              .options = progress->options,
                              .progress = progress};
    conus_status status = load_scene(out, &loading);
    job_end(&job);
    return status;
}

conus_status manifest_load_made(conus_atlas **out, const struct manifest *manifest, const char *path, const char *names,
                                struct load_progress *progress)
{
    struct loading loading = {
        .manifest = manifest, .path = path, .names = names, .options = progress->options, .progress = progress};
    return load_scene(out, &loading);
}

/* Loads an entry of probabilities, whose path is in the folder of `path`, as an atlas of its own. */
static conus_status load_entry(conus_atlas **out, const char *path, struct manifest_pathway *entry,
                               struct named_maps *maps, struct load_progress *progress)
{
    const char *name = path_base(path);
    const struct manifest manifest = {.maps = entry, .map_count = 1};
    char *folder = name == path ? memory_text("./", 2) : memory_text(path, (size_t)(name - path));
    struct loading loading = {.manifest = &manifest,
                              .path = folder,
                              .names = maps ? maps->source : "FSL atlas XML",
                              .options = progress->options,
                              .progress = progress,
                              .maps = maps};
    conus_status status = folder ? load_scene(out, &loading) : CONUS_ERROR_MEMORY;
    memory_free(folder);
    return status;
}

conus_status probabilities_load(conus_atlas **out, const char *path, struct load_progress *progress)
{
    struct manifest_pathway entry = {.fsl = (char *)path_base(path)};
    return load_entry(out, path, &entry, NULL, progress);
}

/* One map has no labels: a table in or beside its file may tell that it is none. */
static conus_status warn_of_table(const conus_atlas *atlas, struct notes *notes)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    struct label_table *table = labels_new(&job);
    const struct label_volume volume = {.info = &atlas->volumes[0].info};
    const char *source = "";
    label_table_of_volume(&job, table, &source, &volume, NULL);
    if (job_ok(&job) && table->count) {
        (void)JOB_CALL(&job, notes_warn(notes,
                                        "%s: its values are stated to be probabilities, so %s, which names %zu labels, "
                                        "is not used",
                                        path_base(volume.info->path), source, table->count));
    }
    conus_status status = job_close(&job, NULL, NULL);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

conus_status named_maps_load(conus_atlas **out, const char *path, struct named_maps *maps,
                             struct load_progress *progress)
{
    struct manifest_pathway entry = {.source = {.file = (char *)path_base(path),
                                                .chosen = maps->chosen,
                                                .volume = maps->table.entries[0].number - 1}};
    conus_atlas *atlas = NULL;
    conus_status status = load_entry(&atlas, path, &entry, maps, progress);
    if (!status && maps->is_one && progress->options->probability > 0 && !atlas->objects[0].voxels) {
        status = fail(CONUS_ERROR_ARGUMENT,
                      "%s: --probability states that its values are probabilities, but none is %g or more (up to %g)",
                      path, progress->options->probability, atlas->volumes[0].info.maximum);
    }
    status = status || !maps->is_one ? status : warn_of_table(atlas, &maps->notes);
    status = status ? status : notes_move(&atlas->notes, &maps->notes);
    status = status ? status : file_sums_move(&atlas->files, &maps->read);
    return atlas_give(out, atlas, status);
}
