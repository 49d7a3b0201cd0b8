/* SPDX-License-Identifier: BSD-3-Clause */
/* From BrainGlobe's manifest.json to a manifest of ours. BrainGlobe downloads an array when somebody asks for it, and a
 * store without chunks reads as an empty brain: whether they are there is looked at first. */
#include "loaders/scene/parts.h"

#include "loaders/brainglobe/brainglobe.h"
#include "loaders/volumes/volumes.h"

#include <string.h>
#include <strings.h>

static const char annotations[] = "annotations_compressed.ome.zarr";
static const char templates[] = "template.ome.zarr";
static const char axes[] = "asr"; /* of all arrays: what a manifest says of it, BrainGlobe's API does not heed */

static void check_array(struct job *job, const struct volume_input *v, const struct brainglobe_metadata *metadata)
{
    const uint64_t *shape = metadata->shape;
    const size_t *dim = v->header.info.dim;
    const struct volume_zarr *zarr = v->own;
    if (dim[0] != shape[2] || dim[1] != shape[1] || dim[2] != shape[0]) {
        job_bad(job, "shape: manifest.json says %llu x %llu x %llu, the array has %llu x %llu x %llu",
                (unsigned long long)shape[0], (unsigned long long)shape[1], (unsigned long long)shape[2],
                (unsigned long long)dim[2], (unsigned long long)dim[1], (unsigned long long)dim[0]);
    }
    if (zarr->orientation[0] && strcmp(zarr->orientation, axes) != 0) {
        job_bad(job, "orientation: the array's axes start at \"%s\", those of BrainGlobe at \"%s\"", zarr->orientation,
                axes);
    }
}

/* Whether the level of the atlas is in the store @p path, as the manifest says, and downloaded: chunks that begin with
 * "c/0/0/0" make a folder. */
static bool has_array(struct job *job, const char *path, const struct brainglobe_metadata *metadata)
{
    struct brainglobe_metadata place = *metadata;
    bool is_there = false;
    memcpy(place.orientation, axes, sizeof axes);
    if (!job_step(job) || !file_is_folder(path)) {
        return false;
    }
    const struct attempt attempt = job_try(job);
    const struct volume_input *v =
        volume_open(job, path, &(struct volume_wish){.place = &place, .is_header_only = true});
    if (v) {
        const struct volume_zarr *zarr = v->own;
        check_array(job, v, metadata);
        is_there = !zarr->array.prefixed || zarr->array.separator != '/' ||
                   file_is_folder(job_format(job, "%s/c", zarr->folder));
    }
    attempt_end(job, &attempt, ATTEMPT_SILENT); /* the files join the atlas where the array is read */
    return is_there && job_ok(job);
}

static struct scene_item *add_array(struct job *job, struct scene *out, enum item_kind kind, const char *file,
                                    const struct brainglobe_metadata *metadata)
{
    struct scene_item item = {.kind = kind, .file = (char *)file, .orientation = job_copy(job, text_from(axes))};
    memcpy(item.resolution, metadata->resolution, sizeof item.resolution);
    return scene_add(job, out, &item);
}

static void plan_annotation(struct job *job, struct scene *out, const struct brainglobe_atlas *atlas)
{
    const char *file = job_format(job, "%s/%s", atlas->annotation, annotations);
    const char *path = job_format(job, "%s%s", atlas->root, file);
    if (!has_array(job, path, &atlas->metadata)) {
        job_fail(job, CONUS_ERROR_IO,
                 "%s: the annotation of %g micrometres was not downloaded; python3 -c 'from brainglobe_atlasapi import "
                 "BrainGlobeAtlas as B; B(\"%s\").annotation' does so",
                 path, atlas->metadata.resolution[0], atlas->name);
    }
    add_array(job, out, ITEM_PARCELLATION, file, &atlas->metadata)->labels =
        job_format(job, "%s/terminology.csv", atlas->terminology);
}

/* Takes the template as the context. Nobody needs it for an answer, so one that is not there is a note. */
static void plan_template(struct job *job, struct scene *out, const struct brainglobe_atlas *atlas)
{
    const char *file = job_format(job, "%s/%s", atlas->template, templates);
    const char *path = job_format(job, "%s%s", atlas->root, file);
    const struct attempt attempt = job_try(job);
    const bool is_there = has_array(job, path, &atlas->metadata);
    const char *why = attempt_end(job, &attempt, ATTEMPT_TRY);
    if (why) {
        job_note(job, "the template is left out: %s", why);
    } else if (!is_there) {
        job_note(job, "%s: the template of %g micrometres was not downloaded, and is left out", path,
                 atlas->metadata.resolution[0]);
    }
    if (is_there) {
        add_array(job, out, ITEM_CONTEXT, file, &atlas->metadata);
    }
}

static void note_rest(struct job *job, const struct brainglobe_atlas *atlas, const char *folder)
{
    const char *orientation = atlas->metadata.orientation;
    if (orientation[0] && strcasecmp(orientation, axes) != 0) {
        job_note(job,
                 "%smanifest.json: orientation \"%s\" is not heeded: BrainGlobe's API takes all arrays as \"%s\", and "
                 "so does conus",
                 folder, orientation, axes);
    }
    const char *sides = job_format(job, "%s%s/hemispheres.ome.zarr", atlas->root, atlas->annotation);
    if (job_ok(job) && !atlas->is_symmetric && file_is_folder(sides)) {
        job_note(job, "%s (1 is left, 2 is right) is not used: areas are of both sides", sides);
    }
}

void plan_brainglobe(struct job *job, struct scene *out, const char **root, const char *folder)
{
    const struct brainglobe_atlas atlas = brainglobe_atlas_read(job, folder);
    if (job_ok(job)) {
        *root = atlas.root;
        plan_annotation(job, out, &atlas);
        if (atlas.template) {
            plan_template(job, out, &atlas);
        }
        note_rest(job, &atlas, folder);
    }
}
