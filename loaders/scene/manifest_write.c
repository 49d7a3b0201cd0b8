/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_manifest_write(): a first manifest from what lies in a folder. What a volume is, is guessed from its values,
 * and every guess is said. */
#include "base/buffer.h"
#include "base/file.h"
#include "base/folder.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/xml.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/labels/label_files.h"
#include "loaders/labels/label_parse.h"
#include "loaders/scene/load.h"
#include "loaders/scene/manifest.h"
#include "loaders/scene/manifest_scan.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { XML_LIMIT = 4 << 20, OFFSET_STEP = 10000 };

/* A manifest in the making. */
struct draft {
    const char *folder; /* with '/' at its end */
    const conus_manifest_options *options;
    struct names used; /* images that an FSL atlas names, from the folder and without ending */
    json_t *parcellation, *context, *areas, *pathways;
    uint32_t label_offset; /* of the next group of surfaces */
    bool silent;           /* for a folder as ATLAS: what does not load is an error then, not left out */
};

static void draft_finish(struct draft *draft)
{
    names_finish(&draft->used);
    json_decref(draft->parcellation);
    json_decref(draft->context);
    json_decref(draft->areas);
    json_decref(draft->pathways);
}

__attribute__((format(printf, 2, 3))) static conus_status say(const struct draft *draft, const char *format, ...)
{
    struct buffer line = {0};
    va_list arguments;
    char text[512];
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    buffer_text(&line, text);
    conus_status status = buffer_status(&line);
    if (!status && draft->options->log) {
        draft->options->log(draft->options->log_user, line.data);
    }
    buffer_finish(&line);
    return status;
}

static conus_status append(json_t *list, json_t *entry)
{
    return json_array_append_new(list, entry) ? fail(CONUS_ERROR_MEMORY, "no memory for the manifest") : CONUS_OK;
}

static int put_text(const char *text, size_t size, void *user)
{
    buffer_append(user, text, size);
    return ((struct buffer *)user)->failed ? -1 : 0;
}

/* Loads a manifest of nothing but `value` (taken over) at `key`. */
static conus_status load_piece(const struct draft *draft, const char *key, json_t *value)
{
    struct buffer text = {0};
    conus_atlas *atlas = NULL;
    json_t *root = json_pack("{s:i,s:o}", "conus_atlas", MANIFEST_VERSION, key, value);
    const conus_load_options options = {.max_memory = draft->options->max_memory};
    bool done = root && json_dump_callback(root, put_text, &text, 0) == 0;
    const struct bytes bytes = {(uint8_t *)text.data, text.size};
    conus_status status = done ? manifest_load(&atlas, draft->folder, &bytes, &options) : CONUS_ERROR_MEMORY;
    conus_atlas_destroy(atlas);
    buffer_finish(&text);
    json_decref(root);
    return status;
}

/* What is written must load: whether `value` does, at `key` of a manifest of its own (in a list there). */
static conus_status try_piece(bool *loads, const struct draft *draft, const char *key, json_t *value, bool listed)
{
    *loads = true;
    if (draft->silent) {
        return CONUS_OK;
    }
    conus_status status = load_piece(draft, key, listed ? json_pack("[O]", value) : json_incref(value));
    *loads = status == CONUS_OK;
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

/* Says that `name` is left out, since it does not load. */
static conus_status leave_out(const struct draft *draft, const char *name)
{
    char why[400];
    snprintf(why, sizeof why, "%s", conus_message());
    return say(draft, "%s: left out, since it does not load: %s", name, why);
}

/* Appends `value` (taken over) to the manifest's `list`, called `key`, if it loads. */
static conus_status append_loading(bool *loads, const struct draft *draft, json_t *list, const char *key, json_t *value)
{
    conus_status status = value ? try_piece(loads, draft, key, value, true) : CONUS_ERROR_MEMORY;
    if (status || !*loads) {
        json_decref(value);
        return status;
    }
    return append(list, value);
}

static char *path_in(const struct draft *draft, const char *name)
{
    return file_beside(draft->folder, name);
}

/* ---- FSL atlases ------------------------------------------------------------------------------------------------- */

static conus_status mark_used(struct draft *draft, const struct fsl_atlas *atlas)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas->image_count; i++) {
        const char *image = atlas->images[i].image;
        const char *summary = atlas->images[i].summary;
        status = image ? names_add(&draft->used, image + strspn(image, "/")) : CONUS_OK;
        status = status || !summary ? status : names_add(&draft->used, summary + strspn(summary, "/"));
    }
    return status;
}

/* A scene has one parcellation: which, only the user knows. */
static conus_status set_parcellation(struct draft *draft, const char *name)
{
    bool loads = false;
    const char *first = json_string_value(json_object_get(draft->parcellation, "file"));
    json_t *value = json_pack("{s:s}", "file", name);
    conus_status status = value ? try_piece(&loads, draft, "parcellation", value, false) : CONUS_ERROR_MEMORY;
    if (!status && loads && first) {
        status = fail(CONUS_ERROR_DATA,
                      "%s%s and %s are both parcellations, a manifest has one: give one of them as ATLAS, or write the "
                      "manifest by hand (docs/formats.md)",
                      draft->folder, first, name);
    }
    if (!status && loads) {
        draft->parcellation = value;
        return CONUS_OK;
    }
    json_decref(value);
    return status ? status : leave_out(draft, name);
}

static bool is_parcellation(const struct draft *draft, const char *name)
{
    const char *file = json_string_value(json_object_get(draft->parcellation, "file"));
    return file && strcmp(file, name) == 0;
}

static conus_status take_fsl(struct draft *draft, const char *name, const struct fsl_atlas *atlas)
{
    bool loads = false;
    conus_status status =
        atlas->is_label ? set_parcellation(draft, name)
                        : append_loading(&loads, draft, draft->pathways, "pathways", json_pack("{s:s}", "fsl", name));
    loads = atlas->is_label ? is_parcellation(draft, name) : loads;
    if (status || !loads) {
        return status || atlas->is_label ? status : leave_out(draft, name);
    }
    status = mark_used(draft, atlas);
    return status
               ? status
               : say(draft,
                     atlas->is_label ? "%s: parcellation, an FSL atlas of %zu labels" : "%s: FSL atlas, %zu pathways",
                     name, atlas->labels.count);
}

/* Takes `name` if it is an FSL atlas. */
static conus_status look_at_xml(struct draft *draft, const char *name)
{
    struct bytes bytes = {0};
    struct fsl_atlas atlas = {0};
    struct notes notes = {0};
    char *path = path_in(draft, name);
    conus_status status = path ? file_read(&bytes, path, XML_LIMIT) : CONUS_ERROR_MEMORY;
    struct text text = status ? (struct text){0} : label_text_of(bytes.data, bytes.size);
    if (!status && text.size && text_equal(xml_root(text), "atlas")) {
        status = fsl_atlas_parse(&atlas, text);
        status = status ? status : fsl_atlas_number(&atlas, &(struct label_use){0}, &notes);
        status = status == CONUS_ERROR_MEMORY ? status
                 : status                     ? leave_out(draft, name)
                                              : take_fsl(draft, name, &atlas);
    }
    fsl_atlas_finish(&atlas);
    notes_finish(&notes);
    bytes_finish(&bytes);
    memory_free(path);
    return status;
}

/* ---- Volumes ----------------------------------------------------------------------------------------------------- */

static bool is_used(const struct draft *draft, const char *name)
{
    size_t length = volume_stem_length(name);
    for (size_t i = 0; i < draft->used.count; i++) {
        const char *used = draft->used.names[i];
        if (volume_stem_length(used) == length && strncmp(used, name, length) == 0) {
            return true;
        }
    }
    return false;
}

static conus_status name_volume(struct buffer *out, const char *name, size_t index)
{
    buffer_format(out, "%.*s %zu", (int)volume_stem_length(name), name, index);
    return buffer_status(out);
}

/* The volumes of `name` that load, each by itself. */
static conus_status take_volumes(struct draft *draft, const char *name, size_t count)
{
    conus_status status = CONUS_OK;
    size_t taken = 0;
    for (size_t i = 0; !status && i < count; i++) {
        struct buffer text = {0};
        bool loads = false;
        status = name_volume(&text, name, i);
        status =
            status
                ? status
                : append_loading(&loads, draft, draft->pathways, "pathways",
                                 json_pack("{s:s,s:I,s:s}", "file", name, "volume", (json_int_t)i, "name", text.data));
        status = status || loads ? status : leave_out(draft, text.data);
        taken += loads;
        buffer_finish(&text);
    }
    return status ? status : say(draft, "%s: %zu pathways, to be named", name, taken);
}

static conus_status take_series(struct draft *draft, const char *name, size_t count)
{
    bool loads = false;
    json_t *names = json_array();
    conus_status status = names ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        struct buffer text = {0};
        status = name_volume(&text, name, i);
        status = status ? status : append(names, json_string(text.data));
        buffer_finish(&text);
    }
    status = status ? status
                    : append_loading(&loads, draft, draft->pathways, "pathways",
                                     json_pack("{s:s,s:O}", "file", name, "names", names));
    json_decref(names);
    if (status || !loads) {
        return status ? status : take_volumes(draft, name, count);
    }
    return say(draft, "%s: %zu pathways, to be named", name, count);
}

static conus_status take_pathway(struct draft *draft, const char *name, const char *words)
{
    bool loads = false;
    conus_status status = append_loading(&loads, draft, draft->pathways, "pathways",
                                         json_pack("{s:s,s:s#}", "file", name, "name", name, volume_stem_length(name)));
    return status ? status : loads ? say(draft, "%s: pathway, %s", name, words) : leave_out(draft, name);
}

static conus_status take_context(struct draft *draft, const char *name, const char *words)
{
    if (draft->context) {
        return say(draft, "%s: a second context, left out", name);
    }
    draft->context = json_pack("{s:s}", "file", name);
    return draft->context ? say(draft, "%s: context, %s", name, words) : CONUS_ERROR_MEMORY;
}

static conus_status take_volume(struct draft *draft, const char *name, const struct volume_guess *guess)
{
    if (guess->use == VOLUME_SERIES) {
        return take_series(draft, name, guess->count);
    }
    if (guess->use == VOLUME_PATHWAY) {
        return take_pathway(draft, name, guess->words);
    }
    if (guess->use == VOLUME_CONTEXT) {
        return take_context(draft, name, guess->words);
    }
    conus_status status = set_parcellation(draft, name);
    return status || !is_parcellation(draft, name) ? status : say(draft, "%s: parcellation, %s", name, guess->words);
}

static conus_status look_at_volume(struct draft *draft, const char *name)
{
    struct volume_guess guess = {0};
    if (is_used(draft, name)) {
        return CONUS_OK;
    }
    char *path = path_in(draft, name);
    conus_status status = path ? volume_guess_make(&guess, path, draft->options->max_memory) : CONUS_ERROR_MEMORY;
    if (status && status != CONUS_ERROR_MEMORY) {
        status = say(draft, "left out: %s", conus_message());
    } else if (!status) {
        status = take_volume(draft, name, &guess);
    }
    memory_free(path);
    return status;
}

/* ---- Surfaces ---------------------------------------------------------------------------------------------------- */

static conus_status take_single(bool *taken, struct draft *draft, const char *folder, const char *name, uint32_t label)
{
    struct buffer file = {0};
    buffer_format(&file, "%s%s", folder, name);
    conus_status status = buffer_status(&file);
    status = status ? status
                    : append_loading(taken, draft, draft->areas, "areas",
                                     json_pack("{s:s,s:I}", "file", file.data, "label", (json_int_t)label));
    status = status || *taken ? status : leave_out(draft, file.data);
    buffer_finish(&file);
    return status;
}

static conus_status take_pattern(bool *taken, struct draft *draft, const char *folder, const char *ending)
{
    struct buffer pattern = {0};
    buffer_format(&pattern, "%s*%s", folder, ending);
    conus_status status = buffer_status(&pattern);
    status = status ? status
                    : append_loading(taken, draft, draft->areas, "areas",
                                     json_pack("{s:s,s:I}", "files", pattern.data, "label_offset",
                                               (json_int_t)draft->label_offset));
    buffer_finish(&pattern);
    return status;
}

/* Takes the surfaces of one ending in a folder as a pattern if their names give labels, else one by one. */
static conus_status take_surfaces(struct draft *draft, const char *folder, const char *ending,
                                  const struct names *names)
{
    bool all = false;
    size_t count = names->count;
    conus_status status = surface_names_give_labels(names) ? take_pattern(&all, draft, folder, ending) : CONUS_OK;
    if (!all) {
        count = 0;
        for (size_t i = 0; !status && i < names->count; i++) {
            bool taken = false;
            status = take_single(&taken, draft, folder, names->names[i], draft->label_offset + (uint32_t)i + 1);
            count += taken;
        }
    }
    if (status || !count) {
        return status;
    }
    draft->label_offset += OFFSET_STEP;
    return say(draft, "%s*%s: %zu surfaces, labels above %u", folder, ending, count, draft->label_offset - OFFSET_STEP);
}

/* `folder` is "" or a name with '/' at its end. */
static conus_status look_for_surfaces(struct draft *draft, const char *folder)
{
    static const char *const endings[] = {".surf.gii", ".gii", ".obj", ".ply", ".stl", ".vtk", ".vtp"};
    char *path = path_in(draft, folder);
    conus_status status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
    bool surf = false;
    for (size_t i = 0; !status && i < sizeof endings / sizeof endings[0]; i++) {
        struct names names = {0};
        bool skip = i == 1 && surf; /* what else is GIFTI there, is no surface */
        status = skip ? CONUS_OK : names_list(&names, path, endings[i]);
        if (!status && names.count) {
            surf = surf || i == 0;
            status = take_surfaces(draft, folder, endings[i], &names);
        }
        names_finish(&names);
    }
    memory_free(path);
    return status;
}

/* A BrainGlobe folder, or one with surfaces in it. */
static conus_status look_at_folder(struct draft *draft, const char *name)
{
    struct buffer folder = {0};
    struct buffer table = {0};
    struct buffer meshes = {0};
    buffer_format(&folder, "%s%s", name, name[0] ? "/" : "");
    buffer_format(&table, "%s%s%sstructures.json", draft->folder, name, name[0] ? "/" : "");
    buffer_format(&meshes, "%s%s%smeshes", draft->folder, name, name[0] ? "/" : "");
    conus_status status = buffer_status(&folder);
    status = status ? status : buffer_status(&table);
    status = status ? status : buffer_status(&meshes);
    if (!status && file_exists(table.data) && file_is_folder(meshes.data)) {
        status = append(draft->areas, json_pack("{s:s}", "brainglobe", name[0] ? name : "."));
        status = status ? status : say(draft, "%s: BrainGlobe folder", name[0] ? name : ".");
    } else if (!status) {
        status = look_for_surfaces(draft, folder.data ? folder.data : "");
    }
    buffer_finish(&meshes);
    buffer_finish(&table);
    buffer_finish(&folder);
    return status;
}

/* ---- The whole folder -------------------------------------------------------------------------------------------- */

static bool ends_in(const char *name, const char *ending)
{
    size_t length = strlen(name);
    size_t tail = strlen(ending);
    return length > tail && strcasecmp(name + length - tail, ending) == 0;
}

static bool is_volume(const char *name)
{
    bool image = ends_in(name, ".img") || ends_in(name, ".img.gz"); /* its .hdr is taken */
    return name[0] != '.' && !image && name[volume_stem_length(name)];
}

static conus_status scan(struct draft *draft)
{
    struct names names = {0};
    conus_status status = names_list(&names, draft->folder, "");
    for (size_t i = 0; !status && i < names.count; i++) {
        status = ends_in(names.names[i], ".xml") ? look_at_xml(draft, names.names[i]) : CONUS_OK;
    }
    for (size_t i = 0; !status && i < names.count; i++) {
        status = is_volume(names.names[i]) ? look_at_volume(draft, names.names[i]) : CONUS_OK;
    }
    draft->label_offset = draft->parcellation ? OFFSET_STEP : 0;
    status = status ? status : look_at_folder(draft, "");
    for (size_t i = 0; !status && i < names.count; i++) {
        char *path = names.names[i][0] == '.' ? NULL : path_in(draft, names.names[i]);
        bool globe = path && strcmp(names.names[i], "meshes") == 0 && json_array_size(draft->areas) &&
                     json_object_get(json_array_get(draft->areas, 0), "brainglobe");
        status = path && !globe && file_is_folder(path) ? look_at_folder(draft, names.names[i]) : CONUS_OK;
        memory_free(path);
    }
    names_finish(&names);
    return status;
}

/* Sets `key` unless there is nothing to set. */
static bool set(json_t *root, const char *key, json_t *value)
{
    bool empty = !value || (json_is_array(value) && !json_array_size(value));
    return empty || json_object_set(root, key, value) == 0;
}

static conus_status format(struct buffer *out, const struct draft *draft)
{
    json_t *root = json_pack("{s:i}", "conus_atlas", MANIFEST_VERSION);
    bool done = root && set(root, "parcellation", draft->parcellation) && set(root, "areas", draft->areas) &&
                set(root, "pathways", draft->pathways) && set(root, "context", draft->context) &&
                json_dump_callback(root, put_text, out, JSON_INDENT(2)) == 0;
    json_decref(root);
    buffer_text(out, "\n");
    return done ? buffer_status(out) : fail(CONUS_ERROR_MEMORY, "no memory for the manifest");
}

conus_status manifest_of_surfaces(struct buffer *out, const char *folder)
{
    static const conus_manifest_options silent;
    struct draft draft = {
        .folder = folder, .options = &silent, .silent = true, .areas = json_array(), .pathways = json_array()};
    conus_status status = draft.areas && draft.pathways ? look_at_folder(&draft, "") : CONUS_ERROR_MEMORY;
    if (!status && !json_array_size(draft.areas)) {
        status = fail(CONUS_ERROR_DATA,
                      "%.*s: no surfaces in this folder (or structures.json and meshes/, as BrainGlobe has them); for "
                      "volumes: conus manifest",
                      (int)strlen(folder) - 1, folder);
    }
    status = status ? status : format(out, &draft);
    draft_finish(&draft);
    return status;
}

/* What is written must be what the parser reads. */
static conus_status write_checked(const char *path, const struct buffer *text)
{
    struct manifest manifest;
    conus_status status = manifest_parse(&manifest, (struct text){text->data, text->size});
    if (status) {
        return fail_in(status, path);
    }
    manifest_finish(&manifest);
    return file_write_new(path, text->data, text->size);
}

conus_status conus_manifest_write(const char *path, const conus_manifest_options *options)
{
    struct buffer text = {0};
    if (!path || !path[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_manifest_write: a path is needed");
    }
    char *folder = path_folder(path);
    struct draft draft = {.folder = folder, .options = options_of(conus_manifest_options, options)};
    draft.areas = json_array();
    draft.pathways = json_array();
    conus_status status = folder && draft.areas && draft.pathways ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && !file_is_folder(folder)) {
        status = fail(CONUS_ERROR_IO, "%s: there is no such folder", folder);
    }
    status = status ? status : scan(&draft);
    if (!status && !draft.parcellation && !json_array_size(draft.areas) && !json_array_size(draft.pathways)) {
        status = fail(CONUS_ERROR_DATA, "%s: neither parcellation nor surfaces nor pathways in this folder", folder);
    }
    status = status ? status : format(&text, &draft);
    status = status ? status : write_checked(path, &text);
    buffer_finish(&text);
    draft_finish(&draft);
    memory_free(folder);
    return status;
}
