/* SPDX-License-Identifier: BSD-3-Clause */
/* From a manifest to the atlas that it describes. Every failure names the manifest and the key. */
#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/folder.h"
#include "loaders/fsl_atlas.h"
#include "loaders/label_parse.h"
#include "loaders/load_plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { XML_LIMIT = 4 << 20 };

/* What all steps need. */
struct loading {
    const struct manifest *manifest;
    const char *path;         /* of the manifest, ending in '/' if it was made for a folder */
    const struct bytes *file; /* its bytes */
    const conus_load_options *options;
    conus_atlas *atlas;
};

/* Puts manifest and key in front of the message. What a manifest asks for in vain is its fault, not the caller's. */
static conus_status fail_at(conus_status status, const struct loading *loading, const char *key)
{
    status = fail_in(status == CONUS_ERROR_ARGUMENT ? CONUS_ERROR_DATA : status, key);
    return fail_in(status, loading->path);
}

/* The path of `source` from where this process is, with ",volume=K" where one is chosen; NULL without memory. */
static char *source_path(const struct loading *loading, const struct manifest_volume *source)
{
    char *path = file_beside(loading->path, source->file);
    if (!path || !source->chosen) {
        return path;
    }
    struct buffer selected = {0};
    buffer_format(&selected, "%s,volume=%u", path, source->volume);
    memory_free(path);
    return selected.failed ? (buffer_finish(&selected), NULL) : selected.data;
}

/* ---- Areas --------------------------------------------------------------------------------------------------- */

static conus_status read_parcellation(struct parcellation *parts, const struct loading *loading)
{
    const struct manifest_parcellation *from = &loading->manifest->parcellation;
    conus_load_options options = *loading->options;
    char *labels = from->labels && !options.labels ? file_beside(loading->path, from->labels) : NULL;
    char *path = source_path(loading, &from->source);
    conus_status status = path && (labels || !from->labels || options.labels) ? CONUS_OK : CONUS_ERROR_MEMORY;
    options.labels = labels ? labels : options.labels;
    status = status ? status : parcellation_read(parts, path, &options);
    memory_free(path);
    memory_free(labels);
    if (status == CONUS_ERROR_ARGUMENT && !loading->options->labels) { /* as in fail_at() */
        status = CONUS_ERROR_DATA;
    }
    return status ? fail_in(status, "parcellation") : CONUS_OK;
}

/* An atlas of the parcellation, if there is one, with all voxels that are no surface's. */
static conus_status create_atlas(struct loading *loading, struct area_plan *plan)
{
    struct parcellation parts = {0};
    if (!loading->manifest->parcellation.source.file) {
        return loading->options->labels
                   ? fail(CONUS_ERROR_ARGUMENT, "labels %s: the manifest has no parcellation that they could name",
                          loading->options->labels)
                   : atlas_create_empty(&loading->atlas, "the manifest");
    }
    conus_status status = read_parcellation(&parts, loading);
    status = status ? status : area_plan_settle(plan, &parts, loading->manifest->prefer);
    status = status ? status : parcellation_atlas(&loading->atlas, &parts);
    parcellation_finish(&parts);
    return status;
}

static conus_status load_areas(struct loading *loading)
{
    struct area_plan plan = {0};
    struct notes notes = {0};
    conus_status status = area_plan_make(&plan, loading->manifest, loading->path, &notes);
    status = status ? status : create_atlas(loading, &plan);
    status = status ? status : notes_move(&loading->atlas->notes, &notes);
    if (!status && path_base(loading->path)[0]) {
        status = atlas_add_file(loading->atlas, loading->path, loading->file);
    }
    status = status ? status : area_plan_load(&plan, loading->atlas, loading->manifest, loading->options);
    area_plan_finish(&plan);
    notes_finish(&notes);
    return status ? fail_in(status, loading->path) : CONUS_OK;
}

/* ---- Pathways ----------------------------------------------------------------------------------------------- */

static conus_status add_pathway(struct loading *loading, const struct manifest_pathway *pathway, const char *path,
                                const char *name)
{
    double threshold = pathway->threshold > 0 ? pathway->threshold : loading->manifest->threshold;
    const conus_pathway_options options = {threshold, name, loading->options->max_memory};
    return conus_atlas_add_pathway(loading->atlas, path, &options);
}

/* Adds volume `volume` of the 4-D file `path`. */
static conus_status add_volume(struct loading *loading, const struct manifest_pathway *pathway, const char *path,
                               size_t volume, const char *name)
{
    struct buffer selected = {0};
    buffer_format(&selected, "%s,volume=%zu", path, volume);
    conus_status status = buffer_status(&selected);
    status = status ? status : add_pathway(loading, pathway, selected.data, name);
    buffer_finish(&selected);
    return status;
}

static conus_status open_first(struct volume_file *file, const struct loading *loading, const char *path)
{
    struct buffer selected = {0};
    struct notes notes = {0};
    buffer_format(&selected, "%s,volume=0", path);
    conus_status status = buffer_status(&selected);
    status = status ? status : volume_file_open(file, selected.data, loading->options->max_memory, &notes);
    buffer_finish(&selected);
    notes_finish(&notes);
    return status;
}

static conus_status add_named_volumes(struct loading *loading, const struct manifest_pathway *pathway)
{
    struct volume_file file = {0};
    char *path = file_beside(loading->path, pathway->source.file);
    conus_status status = path ? open_first(&file, loading, path) : CONUS_ERROR_MEMORY;
    size_t count = file.info.volume_count;
    volume_file_finish(&file);
    if (!status && count != pathway->name_count) {
        status = fail(CONUS_ERROR_DATA, "names: has %zu entries, %s has %zu volumes: they must be as many",
                      pathway->name_count, pathway->source.file, count);
    }
    for (size_t i = 0; !status && i < count; i++) {
        status = add_volume(loading, pathway, path, i, pathway->names[i]);
    }
    memory_free(path);
    return status;
}

/* ---- Pathways of an FSL atlas -------------------------------------------------------------------------------- */

/* An FSL atlas and the image of it that is taken. */
struct fsl_choice {
    struct fsl_atlas atlas;
    char *image;
    size_t volume_count;
    double voxel_mm3;
};

static void fsl_choice_finish(struct fsl_choice *choice)
{
    fsl_atlas_finish(&choice->atlas);
    memory_free(choice->image);
}

/* Takes the image `path` (taken over) if its voxels are smaller than those of the one that is there. */
static conus_status consider_image(struct fsl_choice *choice, const struct loading *loading, char *path)
{
    struct volume_file file = {0};
    conus_status status = open_first(&file, loading, path);
    const double *s = file.info.spacing;
    double voxel_mm3 = s[0] * s[1] * s[2];
    if (!status && (!choice->image || voxel_mm3 < choice->voxel_mm3)) {
        char *other = choice->image;
        choice->image = path;
        path = other;
        choice->voxel_mm3 = voxel_mm3;
        choice->volume_count = file.info.volume_count;
    }
    memory_free(path);
    volume_file_finish(&file);
    return status;
}

static conus_status choose_image(struct fsl_choice *choice, const struct loading *loading, const char *xml)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < choice->atlas.image_count; i++) {
        char *path = NULL;
        const char *image = choice->atlas.images[i].image;
        status = image ? fsl_image_find(&path, xml, image) : CONUS_OK;
        status = !status && path ? consider_image(choice, loading, path) : status;
    }
    if (!status && !choice->image) {
        return fail(CONUS_ERROR_DATA, "fsl: none of the %zu images of %s is there (<imagefile> is relative to the XML)",
                    choice->atlas.image_count, path_base(xml));
    }
    return status;
}

static conus_status read_fsl(struct fsl_choice *choice, const struct loading *loading, const char *xml)
{
    struct bytes bytes = {0};
    conus_status status = file_read(&bytes, xml, XML_LIMIT);
    if (!status) {
        status = fsl_atlas_parse(&choice->atlas, label_text_of(bytes.data, bytes.size), &loading->atlas->notes);
        status = status ? fail_in(status, xml) : CONUS_OK;
    }
    if (!status && choice->atlas.is_label) {
        status = fail(CONUS_ERROR_DATA,
                      "fsl: %s is of type Label, which has no volume per pathway: load it as parcellation", xml);
    }
    status = status ? status : label_table_sort(&choice->atlas.labels, &loading->atlas->notes);
    bytes_finish(&bytes);
    return status;
}

static conus_status choose_fsl(struct fsl_choice *choice, const struct loading *loading,
                               const struct manifest_pathway *pathway, const char *xml)
{
    conus_status status = read_fsl(choice, loading, xml);
    if (!status && pathway->source.file) {
        char *path = file_beside(loading->path, pathway->source.file);
        status = path ? consider_image(choice, loading, path) : CONUS_ERROR_MEMORY;
    } else if (!status) {
        status = choose_image(choice, loading, xml);
    }
    if (!status && choice->atlas.labels.count > choice->volume_count) {
        status = fail(CONUS_ERROR_DATA, "fsl: %s has %zu labels, %s has %zu volumes", path_base(xml),
                      choice->atlas.labels.count, path_base(choice->image), choice->volume_count);
    }
    return status;
}

static conus_status add_fsl(struct loading *loading, const struct manifest_pathway *pathway)
{
    struct fsl_choice choice = {0};
    char *xml = file_beside(loading->path, pathway->fsl);
    conus_status status = xml ? choose_fsl(&choice, loading, pathway, xml) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < choice.atlas.labels.count; i++) {
        const struct label *label = &choice.atlas.labels.entries[i];
        status = add_volume(loading, pathway, choice.image, label->number - 1, label->name);
    }
    status = status ? status
                    : notes_add(&loading->atlas->notes, "pathways of %s: %zu, from %s", path_base(xml),
                                choice.atlas.labels.count, path_base(choice.image));
    fsl_choice_finish(&choice);
    memory_free(xml);
    return status;
}

static conus_status add_one(struct loading *loading, const struct manifest_pathway *pathway)
{
    char *path = source_path(loading, &pathway->source);
    conus_status status = path ? add_pathway(loading, pathway, path, pathway->name) : CONUS_ERROR_MEMORY;
    memory_free(path);
    return status;
}

static conus_status add_pathways(struct loading *loading)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < loading->manifest->pathway_count; i++) {
        char key[48];
        const struct manifest_pathway *pathway = &loading->manifest->pathways[i];
        status = pathway->fsl     ? add_fsl(loading, pathway)
                 : pathway->names ? add_named_volumes(loading, pathway)
                                  : add_one(loading, pathway);
        snprintf(key, sizeof key, "pathways[%zu]", i);
        status = status ? fail_at(status, loading, key) : CONUS_OK;
    }
    return status;
}

/* ---- Context ------------------------------------------------------------------------------------------------- */

static conus_status set_transfer(struct loading *loading)
{
    const struct manifest_context *context = &loading->manifest->context;
    const char *name = context->transfer;
    char *transfer = context->transfer_is_file ? file_beside(loading->path, name) : memory_text(name, strlen(name));
    if (!transfer) {
        return CONUS_ERROR_MEMORY;
    }
    loading->atlas->transfer = transfer;
    return context->transfer_is_file && !file_exists(transfer)
               ? fail(CONUS_ERROR_IO, "transfer.file: %s: there is no such file", transfer)
               : CONUS_OK;
}

static conus_status set_context(struct loading *loading)
{
    const struct manifest_context *context = &loading->manifest->context;
    if (!context->source.file) {
        return CONUS_OK;
    }
    char *path = source_path(loading, &context->source);
    conus_status status = path ? conus_atlas_set_context(loading->atlas, path, loading->options) : CONUS_ERROR_MEMORY;
    status = status || !context->transfer ? status : set_transfer(loading);
    memory_free(path);
    return status ? fail_at(status, loading, "context") : CONUS_OK;
}

conus_status manifest_load(conus_atlas **out, const char *path, const struct bytes *file,
                           const conus_load_options *options)
{
    struct manifest manifest;
    conus_status status = manifest_parse(&manifest, label_text_of(file->data, file->size));
    if (status) {
        return fail_in(status, path);
    }
    struct loading loading = {&manifest, path, file, options, NULL};
    status = load_areas(&loading);
    status = status ? status : add_pathways(&loading);
    status = status ? status : set_context(&loading);
    manifest_finish(&manifest);
    if (status) {
        conus_atlas_destroy(loading.atlas);
        return status;
    }
    *out = loading.atlas;
    return CONUS_OK;
}
