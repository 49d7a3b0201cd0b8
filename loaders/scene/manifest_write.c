/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_manifest_write(): writes a first manifest for the files in a folder. It guesses the role of a volume from its
 * values, and reports every guess. */
#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/cifti/cifti_file.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/labels/label_volumes.h"
#include "loaders/manifest/manifest.h"
#include "loaders/manifest/manifest_draft.h"
#include "loaders/manifest/manifest_scan.h"
#include "loaders/manifest/manifest_surfaces.h"
#include "loaders/maps/named_maps.h"
#include "loaders/scene/load_manifest.h"
#include "loaders/scene/load_parcellation.h"
#include "loaders/scene/load_streamlines.h"
#include "loaders/scene/plan_cifti.h"
#include "loaders/tracts/tract_file.h"
#include "loaders/transform/field_file.h"
#include "loaders/transform/transform_file.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Bridge: the draft's functions on a job, as functions that report a status. */
struct bridged {
    struct manifest_draft draft;
    struct job *job;
};

static struct job *job_of(const struct manifest_draft *draft)
{
    return ((const struct bridged *)draft)->job;
}

static conus_status bridge_status(const struct manifest_draft *draft)
{
    const struct job *job = job_of(draft);
    return job_ok(job) ? CONUS_OK : fail(job->status, "%s", job->message);
}

__attribute__((format(printf, 2, 3))) static conus_status bridge_log(const struct manifest_draft *draft,
                                                                     const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    manifest_draft_log(job_of(draft), draft, "%s", text);
    return bridge_status(draft);
}

static conus_status bridge_leave_out(const struct manifest_draft *draft, const char *name)
{
    manifest_draft_leave_out(job_of(draft), draft, name, job_format(job_of(draft), "%s", conus_message()));
    return bridge_status(draft);
}

static conus_status bridge_append(json_t *list, json_t *entry)
{
    return json_array_append_new(list, entry) ? fail(CONUS_ERROR_MEMORY, "no memory for the manifest") : CONUS_OK;
}

/* Reports why it does not load by the message. */
static conus_status say_why(bool *loads, const struct manifest_draft *draft, const char *why)
{
    *loads = !why;
    if (why) {
        (void)fail(CONUS_ERROR_DATA, "%s", why);
    }
    return bridge_status(draft);
}

static conus_status bridge_try(bool *loads, const struct manifest_draft *draft, const char *key, json_t *value,
                               bool listed)
{
    return say_why(loads, draft, manifest_draft_try(job_of(draft), draft, key, value, listed));
}

static conus_status bridge_append_loading(bool *loads, const struct manifest_draft *draft, json_t *list,
                                          const char *key, json_t *value)
{
    json_t *entry = manifest_draft_json(job_of(draft), value);
    const char *why = manifest_draft_try(job_of(draft), draft, key, entry, true);
    if (!why) {
        manifest_draft_append(job_of(draft), list, entry);
    }
    return say_why(loads, draft, why);
}

static conus_status bridge_surfaces(struct manifest_draft *draft, const char *name)
{
    manifest_surfaces_add(job_of(draft), draft, name);
    return bridge_status(draft);
}

static conus_status bridge_use(struct manifest_draft *draft, const char *name)
{
    *LIST_ADD(job_of(draft), &draft->used) = job_format(job_of(draft), "%s", name);
    return bridge_status(draft);
}

static conus_status bridge_guess(struct volume_guess *out, const char *path, uint64_t max_memory)
{
    struct job job = {0};
    volume_guess_make(&job, out, path, max_memory);
    return job_close(&job, NULL, NULL);
}

static conus_status bridge_halves(bool *out, const struct manifest_draft *draft, const char *left, const char *right)
{
    *out = volume_names_are_halves(job_of(draft), left, right);
    return bridge_status(draft);
}

static conus_status bridge_has_voxels(bool *out, const struct manifest_draft *draft)
{
    *out = brainglobe_has_voxels(job_of(draft), draft->folder);
    return bridge_status(draft);
}

static conus_status say_transform(struct manifest_draft *draft, const char *name, const char *what)
{
    return bridge_log(draft,
                      "%s: %s, left out: where it leads is not known; \"transform\": \"%s\" in the manifest "
                      "brings the areas to the other images",
                      name, what, name);
}

/* Logs that the file `name` is left out if it is a transform: neither its direction nor its images are known.
 * Errors: CONUS_ERROR_MEMORY. */
static conus_status draft_transform_say(struct manifest_draft *draft, const char *name)
{
    struct file_sums read = {0};
    struct transform_chain transform = {0};
    bool is_named_so = path_ends_in(name, ".tfm") || path_ends_in(name, ".mat") || path_ends_in(name, ".lta") ||
                       path_ends_in(name, ".xfm");
    if (!is_named_so) {
        return CONUS_OK;
    }
    char *path = file_beside(draft->folder, name);
    conus_status status =
        path ? transform_file_read(&transform, path, &(conus_transform_options){0}, &read) : CONUS_ERROR_MEMORY;
    bool is_transform = !status || status == CONUS_ERROR_ARGUMENT; /* FSL's, without its images */
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
    if (!status && is_transform) {
        status = say_transform(draft, name, "a transform");
    }
    transform_chain_finish(&transform);
    file_sums_finish(&read);
    memory_free(path);
    return status;
}

/* Logs the same for the volume `name` if its header says that it is a deformation field or a part of one; *is_field
 * then. Errors: CONUS_ERROR_MEMORY. */
static conus_status draft_field_say(bool *is_field, struct manifest_draft *draft, const char *name)
{
    bool usable = false;
    const char *words = NULL;
    char *path = file_beside(draft->folder, name);
    conus_status status = path ? field_file_words(&words, &usable, path) : CONUS_ERROR_MEMORY;
    memory_free(path);
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK; /* whoever reads the volume says what is wrong */
    *is_field = !status && words;
    if (!status && words) {
        status = usable ? say_transform(draft, name, words)
                        : bridge_log(draft, "%s: %s, left out: it moves no areas", name, words);
    }
    return status;
}

/* Marks the images of the atlas as used, so that they are not taken as volumes of their own. */
static conus_status draft_fsl_mark(struct manifest_draft *draft, const struct fsl_atlas *atlas)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas->image_count; i++) {
        const char *image = atlas->images[i].image;
        const char *summary = atlas->images[i].summary;
        status = image ? bridge_use(draft, image + strspn(image, "/")) : CONUS_OK;
        status = status || !summary ? status : bridge_use(draft, summary + strspn(summary, "/"));
    }
    return status;
}

/* Whether the volume `name` is an image of an FSL atlas that was taken. */
static bool draft_fsl_has(const struct manifest_draft *draft, const char *name)
{
    size_t length = volume_stem_length(name);
    for (size_t i = 0; i < draft->used.count; i++) {
        const char *used = draft->used.at[i];
        if (volume_stem_length(used) == length && strncmp(used, name, length) == 0) {
            return true;
        }
    }
    return false;
}

/* Chooses the file that the manifest names for `xml`, an atlas of type Label: the XML itself; its volume, where that
 * has other names by itself, so that the manifest and a query of the volume give the same names; or NULL, where another
 * XML has taken the volume. The log says why it is not the XML. *name is the caller's to memory_free(). */
static conus_status draft_fsl_choose(char **name, const struct manifest_draft *draft, const char *xml)
{
    struct parcellation parts = {0};
    const conus_load_options options = {.max_memory = draft->options->max_memory};
    const char *chosen = xml; /* what does not load says so when it is tried */
    char *path = file_beside(draft->folder, xml);
    conus_status status = path ? parcellation_read(&parts, path, &options, "an atlas XML") : CONUS_ERROR_MEMORY;
    if (!status) {
        const char *volume = parts.file.path + strlen(draft->folder);
        if (draft_fsl_has(draft, volume)) {
            chosen = NULL;
            status = bridge_log(draft, "%s: left out, since another XML has %s", xml, volume);
        } else if (parts.is_disputed) {
            chosen = volume;
            status = bridge_log(draft, "%s: left out for %s, which has other names by itself: %s", xml, volume,
                                parts.notes.lines[parts.notes.count - 1]);
        }
    }
    status = status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
    *name = status || !chosen ? NULL : memory_text(chosen, strlen(chosen));
    parcellation_finish(&parts);
    memory_free(path);
    return status || !chosen || *name ? status : CONUS_ERROR_MEMORY;
}

/* Whether an entry of the list has a name of these characters. */
static bool has_entry_named(const json_t *list, const char *name, size_t length)
{
    bool has = false;
    for (size_t i = 0; i < json_array_size(list) && !has; i++) {
        const char *other = json_string_value(json_object_get(json_array_get(list, i), "name"));
        has = other && strlen(other) == length && strncmp(other, name, length) == 0;
    }
    return has;
}

/* Appends the file `name` to "streamlines" if it is a tractogram that loads; logs it if it is a transform. */
static conus_status draft_streamlines_take(struct manifest_draft *draft, const char *name)
{
    bool loads = false;
    char *path = file_beside(draft->folder, name);
    if (!path) {
        return CONUS_ERROR_MEMORY;
    }
    bool is_tract = name[0] != '.' && tract_file_is(path);
    memory_free(path);
    if (!is_tract) {
        return draft_transform_say(draft, name);
    }
    size_t length = streamlines_stem_length(name);
    bool taken = has_entry_named(draft->streamlines, name, length) || has_entry_named(draft->pathways, name, length);
    conus_status status =
        bridge_append_loading(&loads, draft, draft->streamlines, "streamlines",
                              json_pack("{s:s,s:s#}", "file", name, "name", name, taken ? strlen(name) : length));
    return status ? status : loads ? bridge_log(draft, "%s: streamlines", name) : bridge_leave_out(draft, name);
}

enum { FIRST_OFFSET = 1000, LAST_OFFSET = 1000000000 };

/* The file of parcellation `index`, NULL past the last. */
static const char *parcellation_file(const struct manifest_draft *draft, size_t index)
{
    const json_t *entry = json_is_array(draft->parcellation) ? json_array_get(draft->parcellation, index)
                          : index == 0                       ? draft->parcellation
                                                             : NULL;
    return json_string_value(json_object_get(entry, "file"));
}

static bool is_parcellation(const struct manifest_draft *draft, const char *name)
{
    const char *file;
    for (size_t i = 0; (file = parcellation_file(draft, i)); i++) {
        if (strcmp(file, name) == 0) {
            return true;
        }
    }
    return false;
}

/* Tries both halves with the labels of the right one as they are, else behind the left one's. */
static conus_status try_halves(bool *load, uint32_t *offset, const struct manifest_draft *draft, json_t *halves)
{
    json_t *right = json_array_get(halves, 1);
    conus_status status = bridge_try(load, draft, "parcellations", halves, false);
    *offset = 0;
    for (uint32_t next = FIRST_OFFSET; !status && !*load && next <= LAST_OFFSET; next *= 10) {
        *offset = next;
        status = json_object_set_new(right, "label_offset", json_integer(next))
                     ? CONUS_ERROR_MEMORY
                     : bridge_try(load, draft, "parcellations", halves, false);
    }
    return status;
}

/* Takes the two files as one parcellation, if they load. */
static conus_status take_halves(struct manifest_draft *draft, const char *left, const char *right)
{
    bool load = false;
    uint32_t offset = 0;
    json_t *halves =
        json_pack("[{s:s,s:s},{s:s,s:s}]", "file", left, "hemisphere", "L", "file", right, "hemisphere", "R");
    conus_status status = halves ? try_halves(&load, &offset, draft, halves) : CONUS_ERROR_MEMORY;
    if (status || !load) {
        json_decref(halves);
    }
    if (status) {
        return status;
    }
    if (!load) {
        char why[400];
        snprintf(why, sizeof why, "%s", conus_message());
        return fail(CONUS_ERROR_DATA, "%s%s and %s are left and right of one, and do not load together: %s",
                    draft->folder, left, right, why);
    }
    status =
        offset ? bridge_log(draft, "%s: left and right of one with %s; its labels are %u further", right, left, offset)
               : bridge_log(draft, "%s: left and right of one with %s", right, left);
    json_decref(draft->parcellation);
    draft->parcellation = halves;
    draft->label_offset = offset < MANIFEST_LABEL_STEP ? MANIFEST_LABEL_STEP : 10 * offset;
    return status;
}

static conus_status set_second(struct manifest_draft *draft, const char *name)
{
    bool halves = false;
    bool is_right = false;
    const char *first = parcellation_file(draft, 0);
    conus_status status = bridge_halves(&is_right, draft, first, name);
    status = status || is_right ? status : bridge_halves(&halves, draft, name, first);
    if (status) {
        return status;
    }
    if ((!is_right && !halves) || json_is_array(draft->parcellation)) { /* the user knows which is meant or first */
        return fail(CONUS_ERROR_DATA,
                    "%s%s and %s are both parcellations, and their names are not left and right of one: give one of "
                    "them as ATLAS, or write the manifest by hand (\"parcellations\", docs/formats.md)",
                    draft->folder, first, name);
    }
    return take_halves(draft, is_right ? first : name, is_right ? name : first);
}

static conus_status set_parcellation(struct manifest_draft *draft, const char *name)
{
    bool loads = false;
    json_t *value = json_pack("{s:s}", "file", name);
    conus_status status = value ? bridge_try(&loads, draft, "parcellation", value, false) : CONUS_ERROR_MEMORY;
    if (!status && loads && !draft->parcellation) {
        draft->parcellation = value;
        draft->label_offset = MANIFEST_LABEL_STEP;
        return CONUS_OK;
    }
    json_decref(value);
    return status ? status : loads ? set_second(draft, name) : bridge_leave_out(draft, name);
}

static conus_status take_fsl_labels(struct manifest_draft *draft, const char *xml, const struct fsl_atlas *atlas)
{
    char *name = NULL;
    conus_status status = draft_fsl_choose(&name, draft, xml);
    status = status || !name ? status : set_parcellation(draft, name);
    if (!status && name && is_parcellation(draft, name)) {
        status = draft_fsl_mark(draft, atlas);
        status = status ? status
                        : bridge_log(draft, "%s: parcellation, an atlas XML of %zu labels", name, atlas->labels.count);
    }
    memory_free(name);
    return status;
}

static conus_status take_fsl(struct manifest_draft *draft, const char *name, const struct fsl_atlas *atlas)
{
    bool loads = false;
    if (atlas->is_label) {
        return take_fsl_labels(draft, name, atlas);
    }
    conus_status status =
        bridge_append_loading(&loads, draft, draft->maps, "probabilities", json_pack("{s:s}", "fsl", name));
    if (status || !loads) {
        return status ? status : bridge_leave_out(draft, name);
    }
    status = draft_fsl_mark(draft, atlas);
    return status ? status : bridge_log(draft, "%s: FSL atlas, %zu areas by probabilities", name, atlas->labels.count);
}

/* Takes `name` if it is an FSL atlas. */
static conus_status look_at_xml(struct manifest_draft *draft, const char *name)
{
    struct bytes bytes = {0};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    char *path = file_beside(draft->folder, name);
    conus_status status = path ? file_read(&bytes, path, FSL_ATLAS_LIMIT) : CONUS_ERROR_MEMORY;
    struct text text = status ? (struct text){0} : text_from_bytes(bytes.data, bytes.size);
    if (!status && text.size && text_equal(xml_root(text), "atlas")) {
        struct fsl_atlas *atlas = fsl_atlas_parse(&job, text);
        fsl_atlas_number(&job, atlas, &(struct label_use){0});
        status = job.status == CONUS_ERROR_MEMORY ? job.status
                 : !job_ok(&job)                  ? (fail(job.status, "%s", job.message), bridge_leave_out(draft, name))
                                                  : take_fsl(draft, name, atlas);
    }
    job_end(&job);
    bytes_finish(&bytes);
    memory_free(path);
    return status;
}

#define NAMED "named by the table beside it"

/* Names each volume as the table beside the file does, else by its number. */
static conus_status name_volume(struct buffer *out, bool *named, const struct manifest_draft *draft, const char *name,
                                size_t index, size_t count)
{
    struct job job = {0}; /* Bridge: to label tables on a job. */
    const char *from = NULL;
    char *path = labels_path(&job, file_beside(draft->folder, name));
    const conus_volume_info info = {.path = path, .volume = index, .volume_count = count};
    const char *given = label_volume_name(&job, &from, &info);
    conus_status status = job.status;
    *named = !status && from;
    buffer_text(out, *named ? given : "");
    if (!*named) {
        buffer_format(out, "%.*s %zu", (int)volume_stem_length(name), name, index);
    }
    job_end(&job);
    return status ? status : buffer_status(out);
}

/* Takes the volumes of `name` that load, each by itself. */
static conus_status take_volumes(struct manifest_draft *draft, const char *name, size_t count)
{
    conus_status status = CONUS_OK;
    size_t taken = 0;
    bool named = false;
    for (size_t i = 0; !status && i < count; i++) {
        struct buffer text = {0};
        bool loads = false;
        status = name_volume(&text, &named, draft, name, i, count);
        status = status ? status
                        : bridge_append_loading(
                              &loads, draft, draft->pathways, "pathways",
                              json_pack("{s:s,s:I,s:s}", "file", name, "volume", (json_int_t)i, "name", text.data));
        status = status || loads ? status : bridge_leave_out(draft, text.data);
        taken += loads;
        buffer_finish(&text);
    }
    return status ? status : bridge_log(draft, "%s: %zu pathways, %s", name, taken, named ? NAMED : "to be named");
}

/* Whether the table beside the file and its values make it an atlas of probabilities by itself. */
static conus_status is_probable(bool *out, const struct manifest_draft *draft, const char *name)
{
    const conus_load_options options = {.max_memory = draft->options->max_memory};
    struct named_maps maps = {0};
    struct volume_file file = {0};
    char *path = file_beside(draft->folder, name);
    struct probe probe = {0};
    conus_status status = path ? probe_open(&probe, path) : CONUS_ERROR_MEMORY;
    status = status ? status : named_maps_find(&maps, &probe, path, &options);
    probe_close(&probe);
    bool named = !status && maps.table.count;
    status = named ? volume_file_open_series(&file, path, &options, &maps.notes) : status;
    named = named && !status && maps.table.count == file.info.volume_count; /* none is the background's */
    status = named ? named_maps_check(&file, 0, &maps.notes) : status;
    *out = named && !status;
    volume_file_finish(&file);
    named_maps_finish(&maps);
    memory_free(path);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

static conus_status take_series(struct manifest_draft *draft, const char *name, size_t count)
{
    bool loads = false;
    bool probable = false;
    bool named = false;
    json_t *names = json_array();
    conus_status status = names ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        struct buffer text = {0};
        status = name_volume(&text, &named, draft, name, i, count);
        status = status ? status : bridge_append(names, json_string(text.data));
        buffer_finish(&text);
    }
    status = status || !named ? status : is_probable(&probable, draft, name);
    json_t *list = probable ? draft->maps : draft->pathways;
    status = status ? status
                    : bridge_append_loading(&loads, draft, list, probable ? "probabilities" : "pathways",
                                            json_pack("{s:s,s:O}", "file", name, "names", names));
    json_decref(names);
    if (status || !loads) {
        return status ? status : take_volumes(draft, name, count);
    }
    if (probable) {
        return bridge_log(draft, "%s: %zu areas by probabilities, " NAMED, name, count);
    }
    return bridge_log(draft, "%s: %zu pathways, %s", name, count, named ? NAMED : "to be named");
}

/* Takes a single volume as a pathway, or as an area by probabilities; `words` say why. */
static conus_status take_one_volume(struct manifest_draft *draft, bool probable, const char *name, const char *words)
{
    bool loads = false;
    conus_status status = bridge_append_loading(
        &loads, draft, probable ? draft->maps : draft->pathways, probable ? "probabilities" : "pathways",
        json_pack("{s:s,s:s#}", "file", name, "name", name, volume_stem_length(name)));
    return status  ? status
           : loads ? bridge_log(draft, "%s: %s, %s", name, probable ? "an area by probabilities" : "pathway", words)
                   : bridge_leave_out(draft, name);
}

static conus_status take_context(struct manifest_draft *draft, const char *name, const char *words)
{
    if (draft->context) {
        return bridge_log(draft, "%s: a second context, left out", name);
    }
    draft->context = json_pack("{s:s}", "file", name);
    return draft->context ? bridge_log(draft, "%s: context, %s", name, words) : CONUS_ERROR_MEMORY;
}

static conus_status take_volume(struct manifest_draft *draft, const char *name, const struct volume_guess *guess)
{
    if (guess->use == VOLUME_SERIES) {
        return take_series(draft, name, guess->count);
    }
    if (named_maps_is_probseg(name)) {
        return take_one_volume(draft, true, name, "as its name says");
    }
    if (guess->use == VOLUME_PATHWAY) {
        return take_one_volume(draft, false, name, guess->words);
    }
    if (guess->use == VOLUME_CONTEXT) {
        return take_context(draft, name, guess->words);
    }
    conus_status status = set_parcellation(draft, name);
    return status || !is_parcellation(draft, name) ? status
                                                   : bridge_log(draft, "%s: parcellation, %s", name, guess->words);
}

static conus_status look_at_volume(struct manifest_draft *draft, const char *name)
{
    struct volume_guess guess = {0};
    if (draft_fsl_has(draft, name)) {
        return CONUS_OK;
    }
    char *path = file_beside(draft->folder, name);
    conus_status status = path ? bridge_guess(&guess, path, draft->options->max_memory) : CONUS_ERROR_MEMORY;
    if (status && status != CONUS_ERROR_MEMORY) {
        status = bridge_log(draft, "left out: %s", conus_message());
    } else if (!status) {
        status = take_volume(draft, name, &guess);
    }
    memory_free(path);
    return status;
}

static bool is_volume_file(const char *name)
{
    bool image = path_ends_in(name, ".img") || path_ends_in(name, ".img.gz") || path_ends_in(name, ".BRIK") ||
                 path_ends_in(name, ".BRIK.gz"); /* its .hdr or .HEAD is taken */
    return name[0] != '.' && !image && name[volume_stem_length(name)];
}

/* Lets the labels of the next entry begin at a step above `largest`. */
static void raise_offset(struct manifest_draft *draft, uint64_t largest)
{
    uint64_t next = (largest / MANIFEST_LABEL_STEP + 1) * MANIFEST_LABEL_STEP;
    draft->label_offset = next < UINT32_MAX ? (uint32_t)next : UINT32_MAX;
}

/* Takes the surfaces that a .dlabel.nii labels by numbers up to `largest`; their labels begin above those of a
 * parcellation that is there. */
static conus_status take_labelled(struct manifest_draft *draft, const struct manifest *manifest, uint32_t largest)
{
    conus_status status = CONUS_OK;
    uint32_t base = draft->label_offset;
    raise_offset(draft, (uint64_t)base + largest);
    for (size_t i = 0; !status && i < manifest->area_count; i++) {
        bool loads = false;
        const struct manifest_area *area = &manifest->areas[i];
        json_int_t offset = (json_int_t)base + area->label_offset;
        raise_offset(draft, (uint64_t)offset + largest);
        status = bridge_append_loading(&loads, draft, draft->areas, "areas",
                                       json_pack("{s:s,s:s,s:I}", "file", area->file, "vertex_labels",
                                                 area->vertex_labels, "label_offset", offset));
        status = status  ? status
                 : loads ? bridge_log(draft, "%s: cut by %s", area->file, area->vertex_labels)
                         : bridge_leave_out(draft, area->file);
    }
    return status;
}

/* Takes voxels and surfaces from a .dlabel.nii. */
static conus_status take_cifti(bool *taken, struct manifest_draft *draft, const char *name)
{
    struct cifti_file file = {0};
    struct job job = {0}; /* Bridge: of the plan */
    struct manifest manifest = {0};
    struct notes notes = {0};
    char *path = file_beside(draft->folder, name);
    uint64_t max_memory = draft->options->max_memory;
    conus_status status = path ? cifti_file_open(&file, path, max_memory, &notes) : CONUS_ERROR_MEMORY;
    status = status ? status : plan_cifti(&job, &manifest, &file, max_memory, &notes);
    if (status) {
        status = status == CONUS_ERROR_MEMORY ? status : bridge_leave_out(draft, name);
    } else {
        const struct label_table *table = &file.choice.cifti.maps[file.choice.map].table;
        const char *voxels = manifest.parcellation_count ? manifest.parcellations[0].source.file : NULL;
        uint32_t offset = draft->label_offset;
        *taken = true;
        status = voxels ? set_parcellation(draft, voxels) : CONUS_OK;
        draft->label_offset = offset; /* the plan keeps surfaces off the file's own voxels */
        status = status || !voxels || !is_parcellation(draft, voxels)
                     ? status
                     : bridge_log(draft, "%s: parcellation, voxels of CIFTI labels", voxels);
        status = status ? status : take_labelled(draft, &manifest, table->entries[table->count - 1].number);
    }
    for (size_t i = 0; !status && i < notes.count; i++) {
        status = bridge_log(draft, "%s", notes.lines[i]);
    }
    notes_finish(&notes);
    job_end(&job);
    cifti_file_finish(&file);
    memory_free(path);
    return status;
}

/* Takes the .dlabel.nii among `names`, if there is one; of several, which one is meant is not known. */
static conus_status look_for_cifti(const char **found, struct manifest_draft *draft, const struct names *names)
{
    size_t count = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < names->count; i++) {
        struct probe probe = {0};
        char *path = is_volume_file(names->names[i]) ? file_beside(draft->folder, names->names[i]) : NULL;
        status = path ? probe_open(&probe, path) : CONUS_OK;
        bool cifti = probe.reader == READER_CIFTI;
        probe_close(&probe);
        status = status || !cifti ? status : bridge_use(draft, names->names[i]); /* it is no volume */
        *found = cifti ? names->names[i] : *found;
        count += cifti;
        memory_free(path);
    }
    if (!status && count > 1) {
        *found = NULL;
        status = bridge_log(draft, "%zu files of CIFTI labels, none is taken: give one of them as ATLAS", count);
    }
    return status;
}

/* Takes the voxels of a BrainGlobe folder, if they load; then its other stacks and its meshes are no further areas. */
static conus_status take_brainglobe(bool *taken, struct manifest_draft *draft)
{
    struct volume_guess guess = {0};
    bool voxels = false;
    conus_status status = bridge_has_voxels(&voxels, draft);
    if (status || !voxels) {
        return status;
    }
    status = set_parcellation(draft, BRAINGLOBE_ANNOTATION);
    *taken = is_parcellation(draft, BRAINGLOBE_ANNOTATION);
    if (status || !*taken) {
        return status;
    }
    status = bridge_log(draft, BRAINGLOBE_ANNOTATION ": parcellation of a BrainGlobe folder");
    char *path = file_beside(draft->folder, BRAINGLOBE_REFERENCE);
    status = status ? status : path ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && file_exists(path)) {
        status = bridge_guess(&guess, path, draft->options->max_memory);
        status = status == CONUS_ERROR_MEMORY ? status
                 : status                     ? bridge_leave_out(draft, BRAINGLOBE_REFERENCE)
                                              : take_context(draft, BRAINGLOBE_REFERENCE, "a BrainGlobe reference");
    }
    memory_free(path);
    return status;
}

static conus_status look_at_other(struct manifest_draft *draft, const char *name, bool brainglobe)
{
    if (!brainglobe || !(path_ends_in(name, ".tiff") || path_ends_in(name, ".tif"))) {
        bool is_field = false;
        conus_status status = draft_field_say(&is_field, draft, name);
        return status || is_field ? status : look_at_volume(draft, name);
    }
    bool known = strcmp(name, BRAINGLOBE_ANNOTATION) == 0 || strcmp(name, BRAINGLOBE_REFERENCE) == 0;
    return known ? CONUS_OK : bridge_log(draft, "%s: left out, another stack of the BrainGlobe folder", name);
}

static conus_status scan_folder(struct manifest_draft *draft)
{
    struct names names = {0};
    bool voxels = false;
    bool labelled = false;
    const char *cifti = NULL;
    conus_status status = names_list(&names, draft->folder, "");
    status = status ? status : take_brainglobe(&voxels, draft);
    status = status ? status : look_for_cifti(&cifti, draft, &names);
    for (size_t i = 0; !status && i < names.count; i++) {
        status = path_ends_in(names.names[i], ".xml") ? look_at_xml(draft, names.names[i]) : CONUS_OK;
    }
    for (size_t i = 0; !status && i < names.count; i++) {
        status = is_volume_file(names.names[i]) ? look_at_other(draft, names.names[i], voxels)
                                                : draft_streamlines_take(draft, names.names[i]);
    }
    status = status || !cifti ? status : take_cifti(&labelled, draft, cifti);
    status = status || voxels || labelled ? status : bridge_surfaces(draft, "");
    for (size_t i = 0; !status && i < names.count; i++) {
        char *path = names.names[i][0] == '.' ? NULL : file_beside(draft->folder, names.names[i]);
        bool known = voxels || json_object_get(json_array_get(draft->areas, 0), "brainglobe");
        bool brainglobe = path && strcmp(names.names[i], "meshes") == 0 && known;
        bool skip = brainglobe || manifest_draft_has(draft->streamlines, names.names[i]);
        status = path && !skip && file_is_folder(path) ? bridge_surfaces(draft, names.names[i]) : CONUS_OK;
        memory_free(path);
    }
    names_finish(&names);
    const char *file = voxels || labelled || !json_array_size(draft->areas) ? NULL : parcellation_file(draft, 0);
    return status || !file
               ? status
               : bridge_log(draft,
                            "%s and surfaces: areas that are in both are there twice: take one out of the manifest",
                            file);
}

/* Makes areas of probabilities the first pathways where there is a parcellation or a surface. Areas of probabilities
 * may overlap, so a manifest has no others beside them. */
static conus_status settle_maps(struct manifest_draft *draft)
{
    conus_status status = CONUS_OK;
    size_t taken = 0;
    bool alone = !draft->parcellation && !json_array_size(draft->areas);
    for (size_t i = 0; !alone && !status && i < json_array_size(draft->maps); i++) {
        bool loads = false;
        json_t *entry = json_array_get(draft->maps, i);
        const char *fsl = json_string_value(json_object_get(entry, "fsl"));
        const char *name = fsl ? fsl : json_string_value(json_object_get(entry, "file"));
        status = bridge_try(&loads, draft, "pathways", entry, true);
        if (!status && loads && json_array_insert(draft->pathways, taken++, entry)) {
            status = CONUS_ERROR_MEMORY;
        }
        status = status  ? status
                 : loads ? bridge_log(draft,
                                      "%s: pathways, because a manifest with a parcellation or surfaces "
                                      "has no areas by probabilities",
                                      name)
                         : bridge_leave_out(draft, name);
    }
    return status || alone || !json_array_clear(draft->maps) ? status : CONUS_ERROR_MEMORY;
}

/* Writes the manifest, once the parser has read it. */
static conus_status write_checked(const char *path, const struct text *text)
{
    struct job job = {0}; /* Bridge: of the parser */
    struct manifest manifest;
    manifest_parse(&job, &manifest, *text);
    conus_status status = job_close(&job, NULL, NULL);
    if (status) {
        return fail_in(status, path);
    }
    return file_write_new(path, text->data, text->size);
}

static conus_status load_text(const struct manifest_draft *draft, struct text text)
{
    conus_atlas *atlas = NULL;
    const struct bytes bytes = {(uint8_t *)text.data, text.size};
    const conus_load_options options = {.max_memory = draft->options->max_memory};
    struct load_progress progress = load_progress_of(draft->folder, &options);
    conus_status status = manifest_load(&atlas, draft->folder, &bytes, &progress);
    load_progress_finish(&progress);
    conus_atlas_destroy(atlas);
    return status;
}

conus_status conus_manifest_write(const char *path, const conus_manifest_options *options)
{
    struct job job = {0}; /* Bridge */
    struct text text = {0};
    if (!path || !path[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_manifest_write: a path is needed");
    }
    char *folder = path_folder(path);
    struct bridged bridged = {
        .draft = {.folder = folder, .options = options_of(conus_manifest_options, options), .load = load_text},
        .job = &job};
    struct manifest_draft *draft = &bridged.draft;
    manifest_draft_init(&job, draft);
    conus_status status = folder ? bridge_status(draft) : CONUS_ERROR_MEMORY;
    if (!status && !file_is_folder(folder)) {
        status = fail(CONUS_ERROR_IO, "%s: there is no such folder", folder);
    }
    status = status ? status : scan_folder(draft);
    status = status ? status : settle_maps(draft);
    size_t found = json_array_size(draft->areas) + json_array_size(draft->pathways) + json_array_size(draft->maps) +
                   json_array_size(draft->streamlines);
    if (!status && !draft->parcellation && !found) {
        status = fail(CONUS_ERROR_DATA, "%s: neither parcellation nor surfaces, pathways or streamlines in this folder",
                      folder);
    }
    if (!status) {
        text = manifest_draft_format(&job, draft);
        status = bridge_status(draft);
    }
    status = status ? status : write_checked(path, &text);
    json_decref(draft->parcellation);
    json_decref(draft->context);
    job_end(&job);
    memory_free(folder);
    return status;
}
