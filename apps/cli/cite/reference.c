/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads references out of manifests, BrainGlobe's metadata and BIDS's descriptions. */
#include "cli/cite/citation.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "sources/names.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DESCRIPTION_LIMIT = 1 << 20, FOLDERS_UP = 4 };

static void add_text(struct references *out, const json_t *value)
{
    const char *text = json_string_value(value);
    size_t length = text ? json_string_length(value) : 0;
    size_t kept = length < REFERENCE_SIZE ? length : REFERENCE_SIZE;
    while (kept < length && kept && ((unsigned char)text[kept] & 0xc0) == 0x80) { /* no part of a character */
        kept--;
    }
    char *line = length && out->count < REFERENCES ? text_copy(text, kept) : NULL;
    if (line) {
        make_plain_line(line);
        out->items[out->count++] = line;
    }
}

/* The JSON in a small file; NULL if there is none. */
static json_t *load(const char *path)
{
    struct system_stat info;
    char *text = NULL;
    size_t size = 0;
    bool is = path && system_stat(&info, path) && info.kind == SYSTEM_FILE && info.size <= DESCRIPTION_LIMIT;
    messages_hold(true);
    int code = is ? input_file_read(&text, &size, path, INPUT_FILE, DESCRIPTION_LIMIT) : EXIT_DATA;
    messages_hold(false);
    json_t *root = code ? NULL : json_loadb(text, size, 0, NULL);
    free(text);
    return root;
}

/* Adds what the file `path`, which it frees, says under the keys, if it has the key `needed`. */
static void read_keys(struct references *out, char *path, const char *needed, const char *const *keys)
{
    json_t *root = load(path);
    bool fits = root && (!needed || json_object_get(root, needed));
    size_t before = out->count;
    for (; fits && *keys; keys++) {
        const json_t *value = json_object_get(root, *keys); /* a text, or a list of them */
        size_t index;
        const json_t *text;
        add_text(out, value);
        json_array_foreach(value, index, text)
        {
            add_text(out, text);
        }
    }
    json_decref(root);
    if (out->count > before && !out->source) {
        out->source = path;
        path = NULL;
    }
    free(path);
}

static char *path_in(const char *folder, size_t length, const char *name)
{
    char *path = NULL;
    return asprintf(&path, "%.*s%s%s", (int)length, folder, path_joint(folder, length), name) < 0 ? NULL : path;
}

/* Length of the folder that `length` bytes of the path are in; 0 for none. */
static size_t folder_of(const char *path, size_t length)
{
    return path_length_above(path, path_plain_length(path, length));
}

static void read_brainglobe(struct references *out, const char *path, size_t folder)
{
    static const char *const keys[] = {"citation", "atlas_link", NULL};
    read_keys(out, path_in(path, folder, "metadata.json"), "orientation", keys);
    if (!out->count) {
        read_keys(out, path_in(path, folder, "manifest.json"), "annotation_set", keys);
    }
}

static void read_bids(struct references *out, const char *path, const char *name)
{
    static const char *const keys[] = {"HowToAcknowledge", "ReferencesAndLinks", "References", "DatasetDOI", NULL};
    static const char *const files[] = {"template_description.json", "dataset_description.json"};
    size_t folder = folder_of(path, strlen(path));
    const char *entity = strstr(name, "atlas-"); /* "atlas-Schaefer2018" of "atlas-Schaefer2018_dseg.nii.gz" */
    if (!strstr(name, "tpl-") && !entity) {
        return; /* a description of somebody's study, in which the file lies */
    }
    for (int i = 0; i <= FOLDERS_UP && !out->count; i++) {
        char *file = NULL;
        if (entity && asprintf(&file, "%.*s_description.json", (int)strcspn(entity, "_."), entity) >= 0) {
            read_keys(out, path_in(path, folder, file), NULL, keys);
            free(file);
        }
        for (size_t k = 0; k < sizeof files / sizeof files[0] && !out->count; k++) {
            read_keys(out, path_in(path, folder, files[k]), NULL, keys);
        }
        if (!folder || folder == 1) {
            break;
        }
        folder = folder_of(path, folder);
    }
}

void references_find(struct references *out, const char *path)
{
    static const char *const keys[] = {"references", NULL};
    struct system_stat info;
    size_t length = strlen(path);
    bool is_folder = system_stat(&info, path) && info.kind == SYSTEM_FOLDER;
    *out = (struct references){0};
    read_keys(out, strdup(path), "conus_atlas", keys);
    if (is_folder && !out->count) {
        read_brainglobe(out, path, length);
    }
    bool is_beside = path_ends_in(path, ".tif") || path_ends_in(path, ".tiff") || path_ends_in(path, "manifest.json");
    if ((is_folder || is_beside) && !out->count) {
        read_brainglobe(out, path, folder_of(path, length)); /* beside the stack; of FOLDER/meshes, in FOLDER */
    }
    if (!out->count) {
        read_bids(out, path, path_base(path));
    }
}

void references_identify(struct references *out, const conus_atlas *atlas)
{
    const conus_atlas_identity_view identity = conus_atlas_identity(atlas);
    if (identity.facts && out->count < REFERENCES) {
        char *line = NULL;
        bool is_made =
            asprintf(&line, "%s, %s: %s", identity.facts->name,
                     identity.is_verified ? "known by its voxels" : "by its labels and names, not by its voxels",
                     identity.facts->reference) >= 0;
        out->items[out->count] = is_made ? line : NULL;
        out->count += is_made;
    }
}

void references_finish(struct references *references)
{
    for (size_t i = 0; i < references->count; i++) {
        free(references->items[i]);
    }
    free(references->source);
    *references = (struct references){0};
}

char *cited_stem(const char *path)
{
    char *name = strdup(path_name(path));
    if (name) {
        name[stem_length(name, strlen(name), ROLES_ATLAS)] = '\0';
    }
    return name;
}

int cited_atlas_find(struct cited_atlas *out, const char *given, const char *installed, const char *path,
                     const conus_atlas *atlas)
{
    const conus_volume_info *info = installed ? conus_atlas_volume(atlas, 0) : NULL;
    const char *file = info ? info->path : path;
    out->name = installed ? strdup(installed) : cited_stem(path);
    references_find(&out->references, path);
    if (!out->references.count && file != path) {
        references_find(&out->references, file);
    }
    if (!out->references.count) {
        references_identify(&out->references, atlas);
    }
    for (size_t i = 0; i < conus_atlas_volume_count(atlas) && !out->sha256; i++) {
        const conus_volume_info *volume = conus_atlas_volume(atlas, i);
        out->sha256 = strcmp(volume->path, file) == 0 ? volume->sha256 : NULL;
    }
    out->file = path_name(info ? info->path : given);
    out->is_here = true;
    return out->name ? EXIT_DONE : print_no_memory();
}
