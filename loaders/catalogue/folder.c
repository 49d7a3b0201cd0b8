/* SPDX-License-Identifier: BSD-3-Clause */
/* Walks a folder: its files first, then the folders in it. */
#include "loaders/catalogue/catalogue.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe_atlas.h"
#include "loaders/catalogue/volume_marks.h"

#include <ctype.h>
#include <fnmatch.h>
#include <string.h>

static const char manifest_ending[] = ".atlas.json";

static bool fits_patterns(const char *name, const char *const *patterns)
{
    for (; *patterns; patterns++) {
        if (fnmatch(*patterns, name, 0) == 0) {
            return true;
        }
    }
    return false;
}

/* The name without `length` bytes of ending, and without `cut` before that. */
static char *atlas_name(const char *name, size_t length, const char *cut)
{
    size_t ending = cut ? strlen(cut) : 0;
    if (ending && length > ending && strncmp(name + length - ending, cut, ending) == 0) {
        length -= ending;
    }
    return memory_text(name, length);
}

static conus_status add_named(conus_catalogue *catalogue, struct catalogue_found *found, char *name)
{
    found->name = name;
    conus_status status = name ? catalogue_add(catalogue, found) : CONUS_ERROR_MEMORY;
    memory_free(name);
    return status;
}

static conus_status take_file(conus_catalogue *catalogue, const char *name, struct catalogue_found *found,
                              const struct folder_rule *rule)
{
    if (volume_marks_is_volume(name)) {
        bool labels = false;
        if (rule->patterns && !fits_patterns(name, rule->patterns)) {
            return CONUS_OK;
        }
        conus_status status = volume_marks_find(&labels, found->spacing, found->path, rule->patterns != NULL);
        found->kind = "volume";
        return status || !labels ? status
                                 : add_named(catalogue, found, atlas_name(name, volume_stem_length(name), rule->cut));
    }
    if (path_ends_in(name, manifest_ending)) {
        found->kind = "scene";
        return add_named(catalogue, found, atlas_name(name, strlen(name) - strlen(manifest_ending), NULL));
    }
    return path_ends_in(name, ".xml") ? fsl_look(catalogue, found->path) : CONUS_OK;
}

static bool is_brainglobe(const char *folder)
{
    char *table = catalogue_join(folder, "structures.json");
    char *meshes = catalogue_join(folder, "meshes");
    bool is = table && meshes && file_exists(table) && file_is_folder(meshes);
    memory_free(table);
    memory_free(meshes);
    return is;
}

static conus_status add_brainglobe(conus_catalogue *catalogue, const char *name, struct catalogue_found *found)
{
    size_t length = strlen(name); /* of "allen_mouse_25um" of "allen_mouse_25um_v1.2", as BrainGlobe calls an atlas */
    size_t digits = length;
    while (digits && (isdigit((unsigned char)name[digits - 1]) || name[digits - 1] == '.')) {
        digits--;
    }
    if (digits < length && digits > 2 && name[digits - 1] == 'v' && name[digits - 2] == '_') {
        length = digits - 2;
    }
    char *alias = name[length] ? memory_text(name, length) : NULL;
    found->kind = "surfaces";
    found->name = name;
    found->alias = alias;
    conus_status status = name[length] && !alias ? CONUS_ERROR_MEMORY : catalogue_add(catalogue, found);
    memory_free(alias);
    return status;
}

/* The edges of its voxels, which the list shows; none where manifest.json is damaged, as loading it says. */
static conus_status find_spacing(double out[3], const char *folder)
{
    struct brainglobe_atlas atlas = {0};
    struct file_sums read = {0};
    char *root = NULL;
    char *path = catalogue_join(folder, "");
    conus_status status = path ? brainglobe_atlas_read(&atlas, &root, path, &read) : CONUS_ERROR_MEMORY;
    for (size_t axis = 0; !status && axis < 3; axis++) {
        out[axis] = atlas.metadata.resolution[2 - axis] / 1000; /* i is the last axis */
    }
    brainglobe_atlas_finish(&atlas);
    file_sums_finish(&read);
    memory_free(root);
    memory_free(path);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

/* Adds the versions of the atlas in `folder`, called `name`, the newest first. */
static conus_status add_versions(conus_catalogue *catalogue, const char *folder, const char *name)
{
    struct names versions = {0};
    conus_status status = brainglobe_versions(&versions, folder);
    for (size_t i = versions.count; !status && i-- > 0;) {
        struct stat info;
        struct buffer numbered = {0};
        bool is_newest = i + 1 == versions.count;
        char *path = catalogue_join(folder, versions.names[i]);
        buffer_format(&numbered, "%s_v%s", name, versions.names[i]);
        status = path ? buffer_status(&numbered) : CONUS_ERROR_MEMORY;
        if (!status && stat(path, &info) == 0) {
            for (char *c = numbered.data + strlen(name) + 2; *c; c++) {
                *c = *c == '_' ? '.' : *c; /* 1_10 is the version 1.10 */
            }
            struct catalogue_found found = {.name = is_newest ? name : numbered.data,
                                            .alias = is_newest ? numbered.data : NULL,
                                            .kind = "volume",
                                            .path = path,
                                            .id = catalogue_id_of(&info)};
            status = find_spacing(found.spacing, path);
            status = status ? status : catalogue_add(catalogue, &found);
        }
        memory_free(path);
        buffer_finish(&numbered);
    }
    names_finish(&versions);
    return status;
}

conus_status brainglobe_look(conus_catalogue *catalogue, const char *folder)
{
    struct names names = {0};
    conus_status status = catalogue_list(&names, catalogue, folder);
    for (size_t i = 0; !status && i < names.count; i++) {
        char *path = catalogue_join(folder, names.names[i]);
        status = path ? add_versions(catalogue, path, names.names[i]) : CONUS_ERROR_MEMORY;
        memory_free(path);
    }
    names_finish(&names);
    return status;
}

/** The passes over a folder, in this order: XMLs name volumes, and volumes in the folders below. */
enum turn { XMLS, OTHER_FILES, FOLDERS, TURNS };

static conus_status look_in_folder(conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule,
                                   size_t depth);

/* No deeper than rule->depth. NOLINTNEXTLINE(misc-no-recursion) */
static conus_status look_at_name(conus_catalogue *catalogue, const char *folder, const char *name,
                                 const struct folder_rule *rule, size_t depth, enum turn turn)
{
    struct stat info;
    char *path = catalogue_join(folder, name);
    bool there = path && stat(path, &info) == 0;
    conus_status status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
    struct catalogue_found found = {.path = path};
    if (there) {
        found.id = catalogue_id_of(&info);
    }
    if (there && turn != FOLDERS && S_ISREG(info.st_mode) && info.st_size) { /* TemplateFlow: empty until fetched */
        status = take_file(catalogue, name, &found, rule);
    } else if (there && turn == FOLDERS && S_ISDIR(info.st_mode) && depth < rule->depth) {
        status = is_brainglobe(path) ? add_brainglobe(catalogue, name, &found)
                                     : look_in_folder(catalogue, path, rule, depth + 1);
    }
    memory_free(path);
    return status;
}

/* NOLINTNEXTLINE(misc-no-recursion) */
static conus_status look_in_folder(conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule,
                                   size_t depth)
{
    struct names names = {0};
    conus_status status = catalogue_list(&names, catalogue, folder);
    for (enum turn turn = XMLS; turn < TURNS; turn++) {
        for (size_t i = 0; !status && i < names.count; i++) {
            const char *name = names.names[i];
            bool now = turn == FOLDERS || (turn == XMLS) == path_ends_in(name, ".xml");
            status = now ? look_at_name(catalogue, folder, name, rule, depth, turn) : CONUS_OK;
        }
    }
    names_finish(&names);
    return status;
}

conus_status folder_look(conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule)
{
    return look_in_folder(catalogue, folder, rule, 0);
}
