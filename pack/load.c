/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_load(), and what is added from files. */
#include "atlas/space.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/maps/maps.h"
#include "loaders/scene/scene.h"
#include "pack/pack.h"
#include "sources/names.h"

#include <stdio.h>
#include <string.h>

/* Warns where a brain is stated, and the files or the voxels of a published atlas say another. A grid alone does not:
 * the HCP keeps one person's own images on that of MNI 152. */
static conus_status check_stated(conus_atlas *atlas, const char *path, const conus_load_options *options)
{
    const struct note_sink sink = {options->log, options->log_user, path};
    const conus_brain_view stated = space_brain_stated(atlas->brain);
    atlas->brain = CONUS_BRAIN_UNKNOWN;
    conus_brain_view own = conus_atlas_brain(atlas);
    if (strcmp(own.source, "grid") == 0 && atlas->volumes[0].info.space_code < SPACE_TALAIRACH) {
        own = identity_brain(0);
    }
    if (!own.brain && !own.is_moved) {
        atlas_identify(atlas);
        own = identity_brain(atlas->identified);
    }
    atlas->brain = stated.brain;
    const conus_brain_gap gap = conus_brain_compare(stated, own);
    if (gap < CONUS_BRAIN_GAP_SOME_MM || (gap == CONUS_BRAIN_GAP_SOME_MM && own.brain == CONUS_BRAIN_TEMPLATE)) {
        return CONUS_OK;
    }
    atlas->notes.sink = &sink;
    const conus_status status = notes_warn(
        &atlas->notes, "',template=%s' says %s, but its %s %s: positions of one brain may be answered on another",
        space_brain_word(stated.brain), stated.words,
        strcmp(own.source, "voxels") == 0 ? "voxels are those of" : "files say", own.words);
    atlas->notes.sink = NULL;
    return status;
}

/* Copies `path` without the ",template=WORD" that says whose brain the atlas is, if it has one. */
static conus_status cut_template(char **plain, conus_brain *brain, const char *path)
{
    struct source_keys keys;
    if (!keys_read(&keys, path, KEYS_ATLAS)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %s", path, keys.why);
    }
    *brain = space_brain_parse(keys_value(&keys, KEY_TEMPLATE)->text);
    *plain = memory_raw(strlen(path) + 1, 1);
    if (*plain) {
        keys_keep(*plain, path, &keys, KEYS_SCENE);
    }
    return *plain ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status load_path(conus_atlas **out, const char *path, const conus_load_options *options)
{
    return pack_is(path) ? pack_load(out, path, options) : atlas_load_files(out, path, options);
}

/* Loads the installed atlas that `text` names; what stands behind the name chooses in its file. */
static conus_status load_named(conus_atlas **out, const char *text, const conus_load_options *options)
{
    const size_t length = keys_file_length(text, KEYS_ATLAS);
    char *name = memory_text(text, length);
    char *path = NULL;
    conus_catalogue *catalogue = NULL;
    const conus_installed *found = NULL;
    conus_status status = name ? conus_catalogue_create(&catalogue, NULL) : CONUS_ERROR_MEMORY;
    status = status ? status : conus_catalogue_find(&found, catalogue, name);
    memory_free(name);
    if (!status) {
        const size_t size = strlen(found->path) + strlen(text + length) + 1;
        path = memory_raw(size, 1);
        status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (path) {
            snprintf(path, size, "%s%s", found->path, text + length);
        }
    }
    if (!status) {
        conus_load_options its = *options;
        its.labels = its.labels ? its.labels : found->labels;
        status = load_path(out, path, &its);
    }
    memory_free(path);
    conus_catalogue_destroy(catalogue);
    return status;
}

conus_status conus_atlas_load(conus_atlas **out, const char *path, const conus_load_options *options)
{
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_load: a result and a path are needed");
    }
    char *plain = NULL;
    conus_brain brain = CONUS_BRAIN_UNKNOWN;
    conus_atlas *atlas = NULL;
    conus_status status = cut_template(&plain, &brain, path);
    options = options_of(conus_load_options, options);
    status = status ? status : (conus_atlas_is_path(plain) ? load_path : load_named)(&atlas, plain, options);
    memory_free(plain);
    if (!status) {
        const bool is_new = brain || !atlas->pack; /* a pack has what was found */
        atlas->brain = brain ? brain : atlas->brain;
        if (is_new && atlas->brain) {
            status = check_stated(atlas, path, options);
        } else if (is_new && !conus_atlas_brain(atlas).brain) {
            atlas_identify(atlas);
        }
    }
    if (status) {
        conus_atlas_destroy(atlas);
    } else {
        *out = atlas;
    }
    return status;
}

/* What options of any kind say of a load. */
#define ITS(options)                                                                                                   \
    (&(conus_load_options){.max_memory = (options)->max_memory, .log = (options)->log, .log_user = (options)->log_user})

conus_status conus_tractogram_load(conus_tractogram **out, const char *path, const conus_streamlines_options *options)
{
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_tractogram_load: a result and a path are needed");
    }
    options = options_of(conus_streamlines_options, options);
    struct job job = {.max_memory = options->max_memory}; /* conus_atlas_add_tractogram() has a log */
    conus_tractogram *tractogram = memory_zeroed(1, sizeof *tractogram);
    conus_atlas *alone = job_need(&job, tractogram) ? streamlines_load(&job, path, options->space) : NULL;
    if (alone) {
        tractogram->alone = job_give(&job, alone, sizeof *alone);
    }
    if (job_ok(&job)) {
        *out = tractogram;
    } else {
        conus_tractogram_destroy(tractogram);
    }
    return job_close(&job, NULL, NULL);
}

conus_status conus_atlas_add_streamlines(conus_atlas *atlas, const char *path, const conus_streamlines_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_streamlines: an atlas and a path are needed");
    }
    options = options_of(conus_streamlines_options, options);
    const struct scene_item item = {.kind = ITEM_STREAMLINES,
                                    .radius = options->radius,
                                    .label.name = (char *)options->name,
                                    .space = options->space};
    return scene_add_item(atlas, path, &item, ITS(options));
}

conus_status conus_atlas_add_pathway(conus_atlas *atlas, const char *path, const conus_pathway_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_pathway: an atlas and a path are needed");
    }
    options = options_of(conus_pathway_options, options);
    const struct scene_item item = pathway_item(options);
    return scene_add_item(atlas, path, &item, ITS(options));
}

conus_status conus_atlas_set_context(conus_atlas *atlas, const char *path, const conus_context_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_set_context: an atlas and a path are needed");
    }
    options = options_of(conus_context_options, options);
    const struct scene_item item = {
        .kind = ITEM_CONTEXT, .blocks = options->block_threshold, .opacity = options->opacity};
    return scene_add_item(atlas, path, &item, ITS(options));
}

conus_status conus_atlas_add_tractogram(conus_atlas *atlas, const conus_tractogram *tractogram,
                                        const conus_streamlines_options *options)
{
    if (!atlas || !tractogram) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_add_tractogram: an atlas and a tractogram are needed");
    }
    options = options_of(conus_streamlines_options, options);
    const char *path = tractogram->alone->tractograms[0].path;
    const struct note_sink sink = {options->log, options->log_user, path};
    struct job job = {.sink = &sink};
    const struct atlas_mark mark = atlas_mark(atlas);
    double radius = streamlines_radius(&job, options->radius, path);
    streamlines_take(&job, atlas, streamlines_borrow(&job, tractogram->alone), radius, options->name);
    return atlas_close(&job, atlas, mark);
}

void conus_tractogram_destroy(conus_tractogram *tractogram)
{
    if (tractogram) {
        conus_atlas_destroy(tractogram->alone);
        memory_free(tractogram);
    }
}
