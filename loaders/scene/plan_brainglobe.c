/* SPDX-License-Identifier: BSD-3-Clause */
/* From BrainGlobe's manifest.json to a manifest of ours. BrainGlobe downloads an array when somebody asks for it, and a
 * store without chunks reads as an empty brain: whether they are there is looked at first. */
#include "loaders/scene/plan_brainglobe.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe_atlas.h"
#include "loaders/volumes/volume_zarr.h"

#include <string.h>
#include <strings.h>

static const char annotations[] = "annotations_compressed.ome.zarr";
static const char axes[] = "asr"; /* of all arrays: what a manifest says of it, BrainGlobe's API does not heed */

static char *join(const char *root, const char *place, const char *name)
{
    struct buffer path = {0};
    buffer_format(&path, "%s%s/%s", root, place, name);
    return buffer_status(&path) ? (buffer_finish(&path), NULL) : path.data;
}

/* Whether chunks were downloaded: those of "c/0/0/0" make a folder. */
static conus_status has_chunks(bool *out, const struct volume_zarr *zarr)
{
    struct buffer path = {0};
    buffer_format(&path, "%s/c", zarr->folder);
    conus_status status = buffer_status(&path);
    *out = !status && (!zarr->array.prefixed || zarr->array.separator != '/' || file_is_folder(path.data));
    buffer_finish(&path);
    return status;
}

static conus_status check_array(const struct volume_zarr *zarr, const struct volume_header *header,
                                const struct brainglobe_metadata *metadata)
{
    const uint64_t *shape = metadata->shape;
    const size_t *dim = header->info.dim;
    if (dim[0] != shape[2] || dim[1] != shape[1] || dim[2] != shape[0]) {
        return fail(CONUS_ERROR_DATA, "shape: manifest.json says %llu x %llu x %llu, the array has %llu x %llu x %llu",
                    (unsigned long long)shape[0], (unsigned long long)shape[1], (unsigned long long)shape[2],
                    (unsigned long long)dim[2], (unsigned long long)dim[1], (unsigned long long)dim[0]);
    }
    if (zarr->orientation[0] && strcmp(zarr->orientation, axes) != 0) {
        return fail(CONUS_ERROR_DATA, "orientation: the array's axes start at \"%s\", those of BrainGlobe at \"%s\"",
                    zarr->orientation, axes);
    }
    return CONUS_OK;
}

/* Looks whether the level of the atlas is in the store @p path, as the manifest says, and downloaded. */
static conus_status find_array(bool *there, const char *path, const struct brainglobe_metadata *metadata)
{
    struct volume_selector selector = {.place = *metadata};
    struct volume_zarr zarr = {0};
    struct volume_header header = {0};
    struct file_sums read = {0}; /* joins the atlas where the array is read */
    *there = false;
    memcpy(selector.place.orientation, axes, sizeof axes);
    if (!file_is_folder(path)) {
        return CONUS_OK;
    }
    conus_status status = volume_zarr_open(&zarr, &header, path, &selector, &read);
    status = status ? status : check_array(&zarr, &header, metadata);
    status = status ? status : has_chunks(there, &zarr);
    volume_zarr_finish(&zarr);
    file_sums_finish(&read);
    return status;
}

/* Bridge: the state of the job as a status. */
static conus_status state_of(const struct job *job)
{
    return job_ok(job) ? CONUS_OK : fail(job->status, "%s", job->message);
}

static conus_status set_source(struct job *job, struct manifest_volume *out, const char *place, const char *name,
                               const struct brainglobe_metadata *metadata)
{
    out->file = job_format(job, "%s/%s", place, name);
    out->orientation = job_format(job, "%s", axes);
    memcpy(out->resolution, metadata->resolution, sizeof out->resolution);
    return state_of(job);
}

static conus_status plan_annotation(struct job *job, struct manifest *out, const struct brainglobe_atlas *atlas,
                                    const char *root)
{
    bool there = false;
    char *path = join(root, atlas->annotation, annotations);
    conus_status status = path ? find_array(&there, path, &atlas->metadata) : CONUS_ERROR_MEMORY;
    if (!status && !there) {
        status = fail(CONUS_ERROR_IO,
                      "%s: the annotation of %g micrometres was not downloaded; python3 -c 'from brainglobe_atlasapi "
                      "import BrainGlobeAtlas as B; B(\"%s\").annotation' does so",
                      path, atlas->metadata.resolution[0], atlas->name);
    }
    memory_free(path);
    if (status) {
        return status;
    }
    out->single = true;
    out->parcellations = job_new(job, struct manifest_parcellation);
    if (!out->parcellations) {
        return state_of(job);
    }
    out->parcellation_count = 1;
    out->parcellations->labels = job_format(job, "%s/terminology.csv", atlas->terminology);
    return set_source(job, &out->parcellations->source, atlas->annotation, annotations, &atlas->metadata);
}

/* Takes the template as the context. Nobody needs it for an answer, so one that is not there is a note. */
static conus_status plan_template(struct job *job, struct manifest *out, const struct brainglobe_atlas *atlas,
                                  const char *root, struct notes *notes)
{
    bool there = false;
    char *path = join(root, atlas->template, "template.ome.zarr");
    conus_status status = path ? find_array(&there, path, &atlas->metadata) : CONUS_ERROR_MEMORY;
    if (status && status != CONUS_ERROR_MEMORY) {
        status = notes_warn(notes, "the template is left out: %s", conus_message());
    } else if (!status && !there) {
        status = notes_add(notes, "%s: the template of %g micrometres was not downloaded, and is left out", path,
                           atlas->metadata.resolution[0]);
    }
    memory_free(path);
    if (status || !there) {
        return status;
    }
    out->contexts = job_new(job, struct manifest_context);
    if (!out->contexts) {
        return state_of(job);
    }
    out->context_count = 1;
    return set_source(job, &out->contexts->source, atlas->template, "template.ome.zarr", &atlas->metadata);
}

/* Notes what of the atlas is not heeded. */
static conus_status note_rest(const struct brainglobe_atlas *atlas, const char *root, const char *folder,
                              struct notes *notes)
{
    const char *orientation = atlas->metadata.orientation;
    conus_status status = CONUS_OK;
    if (orientation[0] && strcasecmp(orientation, axes) != 0) {
        status = notes_warn(notes,
                            "%smanifest.json: orientation \"%s\" is not heeded: BrainGlobe's API takes all arrays as "
                            "\"%s\", and so does conus",
                            folder, orientation, axes);
    }
    char *sides = join(root, atlas->annotation, "hemispheres.ome.zarr");
    status = sides ? status : CONUS_ERROR_MEMORY;
    if (!status && !atlas->is_symmetric && file_is_folder(sides)) {
        status = notes_add(notes, "%s (1 is left, 2 is right) is not used: areas are of both sides", sides);
    }
    memory_free(sides);
    return status;
}

conus_status plan_brainglobe(struct job *job, struct manifest *out, char **root, const char *folder,
                             struct file_sums *read, struct notes *notes)
{
    struct brainglobe_atlas atlas = {0};
    struct manifest manifest = {0};
    char *above = NULL;
    conus_status status = brainglobe_atlas_read(&atlas, &above, folder, read);
    status = status ? status : plan_annotation(job, &manifest, &atlas, above);
    status = status || !atlas.template ? status : plan_template(job, &manifest, &atlas, above, notes);
    status = status ? status : note_rest(&atlas, above, folder, notes);
    brainglobe_atlas_finish(&atlas);
    if (status) {
        memory_free(above);
        return status;
    }
    *out = manifest;
    *root = above;
    return CONUS_OK;
}
