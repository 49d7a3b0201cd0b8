/* SPDX-License-Identifier: BSD-3-Clause */
/* Walks a folder: its files first, then the folders in it. */
#include "loaders/catalogue/catalogue.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/brainglobe/brainglobe.h"
#include "sources/names.h"

#include <ctype.h>
#include <string.h>

static const char manifest_ending[] = ".atlas.json";

/* Adds the file `found` by the first `length` bytes of its name, without `cut` at their end. */
static void add_named(struct job *job, conus_catalogue *catalogue, struct catalogue_item *found, size_t length,
                      const char *cut)
{
    const char *name = path_base(found->atlas.path);
    size_t ending = cut ? strlen(cut) : 0;
    if (ending && length > ending && strncmp(name + length - ending, cut, ending) == 0) {
        length -= ending;
    }
    found->atlas.name = job_format(job, "%.*s", (int)length, name);
    catalogue_add(job, catalogue, found);
}

static void take_file(struct job *job, conus_catalogue *catalogue, struct catalogue_item *found,
                      const struct folder_rule *rule)
{
    const char *path = found->atlas.path;
    const char *name = path_base(path);
    if (volume_marks_is_volume(name)) {
        found->atlas.kind = "volume";
        found->is_image = !((!rule->patterns || volume_marks_fit(name, rule->patterns, 0)) &&
                            volume_marks_find(job, found->atlas.spacing, path, rule->patterns != NULL));
        add_named(job, catalogue, found, volume_stem_length(name), found->is_image ? NULL : rule->cut);
    } else if (path_ends_in(name, manifest_ending)) {
        found->atlas.kind = "scene";
        add_named(job, catalogue, found, strlen(name) - strlen(manifest_ending), NULL);
    } else if (path_ends_in(name, CONUS_PACK_ENDING)) {
        found->atlas.kind = "pack";
        add_named(job, catalogue, found, strlen(name) - strlen(CONUS_PACK_ENDING), NULL);
    } else if (path_ends_in(name, ".xml")) {
        fsl_look(job, catalogue, path);
    }
}

static bool is_brainglobe(struct job *job, const char *folder)
{
    return job_has_file(job, catalogue_join(job, folder, "structures.json")) &&
           file_is_folder(catalogue_join(job, folder, "meshes"));
}

static void add_brainglobe(struct job *job, conus_catalogue *catalogue, struct catalogue_item *found)
{
    const char *name = path_base(found->atlas.path);
    size_t digits = strlen(name); /* "allen_mouse_25um" of "allen_mouse_25um_v1.2", as BrainGlobe calls an atlas */
    while (digits && (isdigit((unsigned char)name[digits - 1]) || name[digits - 1] == '.')) {
        digits--;
    }
    if (name[digits] && digits > 2 && name[digits - 1] == 'v' && name[digits - 2] == '_') {
        found->alias = job_format(job, "%.*s", (int)digits - 2, name);
    }
    found->atlas.kind = "surfaces";
    found->atlas.name = name;
    catalogue_add(job, catalogue, found);
}

/* The edges of its voxels, which the list shows; none where manifest.json is damaged, as loading it says. */
static void find_spacing(struct job *job, double out[3], const char *folder)
{
    const struct attempt attempt = job_try(job);
    const struct brainglobe_atlas atlas = brainglobe_atlas_read(job, catalogue_join(job, folder, ""));
    for (size_t axis = 0; job_ok(job) && axis < 3; axis++) {
        out[axis] = atlas.metadata.resolution[2 - axis] / 1000; /* i is the last axis */
    }
    (void)attempt_end(job, &attempt, ATTEMPT_TRY);
}

/* Adds the versions of the atlas in `folder`, called `name`, the newest first. */
static void add_versions(struct job *job, conus_catalogue *catalogue, const char *folder, const char *name)
{
    const struct names versions = brainglobe_versions(job, folder);
    for (size_t i = versions.count; i-- > 0;) {
        bool is_newest = i + 1 == versions.count;
        struct catalogue_item found = {
            .atlas = {.kind = "volume", .path = catalogue_join(job, folder, versions.names[i])}};
        for (char *c = versions.names[i]; *c; c++) {
            *c = *c == '_' ? '.' : *c; /* 1_10 is the version 1.10 */
        }
        const char *numbered = job_format(job, "%s_v%s", name, versions.names[i]);
        found.atlas.name = is_newest ? name : numbered;
        found.alias = is_newest ? numbered : NULL;
        find_spacing(job, found.atlas.spacing, found.atlas.path);
        catalogue_add(job, catalogue, &found);
    }
}

void brainglobe_look(struct job *job, conus_catalogue *catalogue, const char *folder)
{
    struct names names = catalogue_list(job, catalogue, folder);
    for (size_t i = 0; i < names.count; i++) {
        add_versions(job, catalogue, catalogue_join(job, folder, names.names[i]), names.names[i]);
    }
}

/** The passes over a folder, in this order: XMLs name volumes, and volumes in the folders below. */
enum turn { XMLS, OTHER_FILES, FOLDERS, TURNS };

/* No deeper than rule->depth. NOLINTNEXTLINE(misc-no-recursion) */
static void look_at_path(struct job *job, conus_catalogue *catalogue, const char *path, const struct folder_rule *rule,
                         enum turn turn)
{
    struct catalogue_item found = {.atlas.path = path};
    enum catalogue_kind kind = catalogue_at(path);
    if (kind == CATALOGUE_FILE && turn != FOLDERS) {
        take_file(job, catalogue, &found, rule);
    } else if (kind == CATALOGUE_FOLDER && turn == FOLDERS && rule->depth) {
        struct folder_rule below = *rule;
        below.depth--;
        if (is_brainglobe(job, path)) {
            add_brainglobe(job, catalogue, &found);
        } else {
            folder_look(job, catalogue, path, &below);
        }
    }
}

/* NOLINTNEXTLINE(misc-no-recursion) */
void folder_look(struct job *job, conus_catalogue *catalogue, const char *folder, const struct folder_rule *rule)
{
    struct names names = catalogue_list(job, catalogue, folder);
    for (enum turn turn = XMLS; turn < TURNS; turn++) {
        for (size_t i = 0; i < names.count; i++) {
            if (turn == FOLDERS || (turn == XMLS) == path_ends_in(names.names[i], ".xml")) {
                look_at_path(job, catalogue, catalogue_join(job, folder, names.names[i]), rule, turn);
            }
        }
    }
}
