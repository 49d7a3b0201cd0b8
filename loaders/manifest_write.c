/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_manifest_write(): a first manifest from what lies in a folder. What a volume is, is guessed from its values,
 * and every guess is said. */
#include "base/buffer.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/xml.h"
#include "loaders/folder.h"
#include "loaders/fsl_atlas.h"
#include "loaders/label_files.h"
#include "loaders/label_parse.h"
#include "loaders/load.h"
#include "loaders/manifest.h"
#include "loaders/manifest_scan.h"

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

static conus_status take_fsl(struct draft *draft, const char *name, const struct fsl_atlas *atlas)
{
    conus_status status = mark_used(draft, atlas);
    if (status) {
        return status;
    }
    if (!atlas->is_label) {
        status = append(draft->pathways, json_pack("{s:s}", "fsl", name));
        return status ? status : say(draft, "%s: FSL atlas, %zu pathways", name, atlas->labels.count);
    }
    if (draft->parcellation) {
        return say(draft, "%s: a second parcellation, left out", name);
    }
    draft->parcellation = json_pack("{s:s}", "file", name);
    return say(draft, "%s: parcellation, an FSL atlas of %zu labels", name, atlas->labels.count);
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
        status = status ? fail_in(status, path) : take_fsl(draft, name, &atlas);
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

static conus_status take_series(struct draft *draft, const char *name, size_t count)
{
    json_t *names = json_array();
    int length = (int)volume_stem_length(name);
    conus_status status = names ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        struct buffer text = {0};
        buffer_format(&text, "%.*s %zu", length, name, i);
        status = buffer_status(&text);
        status = status ? status : append(names, json_string(text.data));
        buffer_finish(&text);
    }
    status = status ? status : append(draft->pathways, json_pack("{s:s,s:O}", "file", name, "names", names));
    json_decref(names);
    return status ? status : say(draft, "%s: %zu pathways, to be named", name, count);
}

static conus_status take_volume(struct draft *draft, const char *name, const struct volume_guess *guess)
{
    json_t **place = guess->use == VOLUME_LABELS ? &draft->parcellation : &draft->context;
    if (guess->use == VOLUME_SERIES) {
        return take_series(draft, name, guess->count);
    }
    if (guess->use == VOLUME_PATHWAY) {
        conus_status status =
            append(draft->pathways, json_pack("{s:s,s:s#}", "file", name, "name", name, volume_stem_length(name)));
        return status ? status : say(draft, "%s: pathway, %s", name, guess->words);
    }
    if (*place) {
        return say(draft, "%s: a second %s, left out", name, guess->use == VOLUME_LABELS ? "parcellation" : "context");
    }
    *place = json_pack("{s:s}", "file", name);
    return *place
               ? say(draft, "%s: %s, %s", name, guess->use == VOLUME_LABELS ? "parcellation" : "context", guess->words)
               : CONUS_ERROR_MEMORY;
}

static conus_status look_at_volume(struct draft *draft, const char *name)
{
    struct volume_guess guess = {0};
    if (is_used(draft, name)) {
        return CONUS_OK;
    }
    char *path = path_in(draft, name);
    conus_status status = path ? volume_guess_make(&guess, path, draft->options->max_memory) : CONUS_ERROR_MEMORY;
    if (status == CONUS_ERROR_DATA || status == CONUS_ERROR_UNSUPPORTED) {
        status = say(draft, "left out: %s", conus_message());
    } else if (!status) {
        status = take_volume(draft, name, &guess);
    }
    memory_free(path);
    return status;
}

/* ---- Surfaces ---------------------------------------------------------------------------------------------------- */

static conus_status take_single(struct draft *draft, const char *folder, const char *name, uint32_t label)
{
    struct buffer file = {0};
    buffer_format(&file, "%s%s", folder, name);
    conus_status status = buffer_status(&file);
    status =
        status ? status : append(draft->areas, json_pack("{s:s,s:I}", "file", file.data, "label", (json_int_t)label));
    buffer_finish(&file);
    return status;
}

/* Takes the surfaces of one ending in a folder as a pattern if their names give labels, else one by one. */
static conus_status take_surfaces(struct draft *draft, const char *folder, const char *ending,
                                  const struct names *names)
{
    conus_status status = CONUS_OK;
    uint32_t offset = draft->label_offset;
    if (surface_names_give_labels(names)) {
        struct buffer pattern = {0};
        buffer_format(&pattern, "%s*%s", folder, ending);
        status = buffer_status(&pattern);
        status = status ? status
                        : append(draft->areas,
                                 json_pack("{s:s,s:I}", "files", pattern.data, "label_offset", (json_int_t)offset));
        buffer_finish(&pattern);
    } else {
        for (size_t i = 0; !status && i < names->count; i++) {
            status = take_single(draft, folder, names->names[i], offset + (uint32_t)i + 1);
        }
    }
    draft->label_offset += OFFSET_STEP;
    return status ? status : say(draft, "%s*%s: %zu surfaces, labels above %u", folder, ending, names->count, offset);
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

static int put_text(const char *text, size_t size, void *user)
{
    buffer_append(user, text, size);
    return ((struct buffer *)user)->failed ? -1 : 0;
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
    struct draft draft = {.folder = folder, .options = &silent, .areas = json_array(), .pathways = json_array()};
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
    static const conus_manifest_options defaults;
    struct buffer text = {0};
    if (!path || !path[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_manifest_write: a path is needed");
    }
    char *folder = path_folder(path);
    struct draft draft = {.folder = folder, .options = options ? options : &defaults};
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
