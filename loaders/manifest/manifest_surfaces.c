/* SPDX-License-Identifier: BSD-3-Clause */
/* Entries of a manifest for the surfaces in a folder. */
#include "loaders/manifest/manifest_surfaces.h"

#include "base/files/file.h"
#include "base/memory.h"
#include "loaders/manifest/manifest_brainglobe.h"
#include "loaders/manifest/manifest_scan.h"

#include <stdio.h>
#include <string.h>

static conus_status take_one_surface(bool *taken, struct manifest_draft *draft, const char *folder, const char *name,
                                     uint32_t label)
{
    struct buffer file = {0};
    buffer_format(&file, "%s%s", folder, name);
    conus_status status = buffer_status(&file);
    status = status
                 ? status
                 : manifest_draft_append_loading(taken, draft, draft->areas, "areas",
                                                 json_pack("{s:s,s:I}", "file", file.data, "label", (json_int_t)label));
    status = status || *taken ? status : manifest_draft_leave_out(draft, file.data);
    buffer_finish(&file);
    return status;
}

/* 'L' of lh.pial, 'R' of rh.pial, else 0. */
static char hemisphere_of(const char *name)
{
    return strncmp(name, "lh.", 3) == 0 ? 'L' : strncmp(name, "rh.", 3) == 0 ? 'R' : '\0';
}

/* The annotation of a hemisphere in `folder`: the only one, or aparc of several. NULL in *out if there is none. */
static conus_status find_annotation(char **out, const struct manifest_draft *draft, const char *folder, char side)
{
    struct names names = {0};
    const char *found = NULL;
    size_t count = 0;
    char *path = file_beside(draft->folder, folder);
    conus_status status = path ? names_list(&names, path, ".annot") : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < names.count; i++) {
        if (hemisphere_of(names.names[i]) == side) {
            found = !count++ || strcmp(names.names[i] + 3, "aparc.annot") == 0 ? names.names[i] : found;
        }
    }
    bool chosen = count == 1 || (count && strcmp(found + 3, "aparc.annot") == 0);
    struct buffer file = {0};
    if (!status && chosen) {
        buffer_format(&file, "%s%s", folder, found);
        status = buffer_status(&file);
    }
    if (!status && count > 1) {
        status = manifest_draft_log(draft, "%s%ch.*.annot: %zu annotations, %s is taken", folder,
                                    side == 'L' ? 'l' : 'r', count, chosen ? found : "none");
    }
    *out = status ? NULL : file.data;
    if (status) {
        buffer_finish(&file);
    }
    names_finish(&names);
    memory_free(path);
    return status;
}

/* Takes a surface as the areas of its hemisphere's annotation, beside it or, from surf/, in label/. */
static conus_status take_annotated(bool *taken, struct manifest_draft *draft, const char *folder, const char *name)
{
    char *labels = NULL;
    struct buffer file = {0};
    char side = hemisphere_of(name);
    *taken = false;
    conus_status status = side ? find_annotation(&labels, draft, folder, side) : CONUS_OK;
    if (!status && side && !labels && strcmp(folder, "surf/") == 0) {
        status = find_annotation(&labels, draft, "label/", side);
    }
    if (status || !labels) {
        return status;
    }
    buffer_format(&file, "%s%s", folder, name);
    status = buffer_status(&file);
    status = status ? status
                    : manifest_draft_append_loading(taken, draft, draft->areas, "areas",
                                                    json_pack("{s:s,s:s,s:s#,s:I}", "file", file.data, "vertex_labels",
                                                              labels, "hemisphere", &side, 1, "label_offset",
                                                              (json_int_t)draft->label_offset));
    if (!status && *taken) {
        draft->label_offset += MANIFEST_LABEL_STEP;
        status = manifest_draft_log(draft, "%s: cut by %s, labels above %u", file.data, labels,
                                    draft->label_offset - MANIFEST_LABEL_STEP);
    } else if (!status) {
        status = manifest_draft_leave_out(draft, labels);
    }
    buffer_finish(&file);
    memory_free(labels);
    return status;
}

/* Whether `name` is the only surface of its hemisphere: an annotation belongs to one surface. */
static bool is_only_of_side(const struct names *names, const char *name)
{
    size_t count = 0;
    for (size_t i = 0; i < names->count; i++) {
        count += hemisphere_of(names->names[i]) == hemisphere_of(name);
    }
    return hemisphere_of(name) && count == 1;
}

/* Takes the surfaces that have an annotation, and out of `names`. */
static conus_status take_all_annotated(struct manifest_draft *draft, const char *folder, struct names *names)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < names->count;) {
        bool taken = false;
        char *name = names->names[i];
        status = is_only_of_side(names, name) ? take_annotated(&taken, draft, folder, name) : CONUS_OK;
        if (taken) {
            memory_free(name);
            memmove(&names->names[i], &names->names[i + 1], (--names->count - i) * sizeof *names->names);
        } else {
            i++;
        }
    }
    return status;
}

static conus_status take_pattern(bool *taken, struct manifest_draft *draft, const char *folder, const char *ending)
{
    struct buffer pattern = {0};
    buffer_format(&pattern, "%s*%s", folder, ending);
    conus_status status = buffer_status(&pattern);
    status = status ? status
                    : manifest_draft_append_loading(taken, draft, draft->areas, "areas",
                                                    json_pack("{s:s,s:I}", "files", pattern.data, "label_offset",
                                                              (json_int_t)draft->label_offset));
    buffer_finish(&pattern);
    return status;
}

/* Takes the surfaces of one ending in a folder that no annotation cuts: as a pattern if their names give labels, else
 * one by one. */
static conus_status take_surfaces(struct manifest_draft *draft, const char *folder, const char *ending,
                                  struct names *names)
{
    bool all = false;
    size_t found = names->count;
    conus_status status = take_all_annotated(draft, folder, names);
    size_t count = names->count;
    if (!status && count == found && surface_names_give_labels(names)) {
        status = take_pattern(&all, draft, folder, ending);
    }
    if (!all) {
        count = 0;
        for (size_t i = 0; !status && i < names->count; i++) {
            bool taken = false;
            status = take_one_surface(&taken, draft, folder, names->names[i], draft->label_offset + (uint32_t)i + 1);
            count += taken;
        }
    }
    if (status || !count) {
        return status;
    }
    draft->label_offset += MANIFEST_LABEL_STEP;
    return manifest_draft_log(draft, "%s*%s: %zu surfaces, labels above %u", folder, ending, count,
                              draft->label_offset - MANIFEST_LABEL_STEP);
}

/* FreeSurfer's surfaces have no ending, and several of them are one hemisphere: the first kind that is there counts. */
static conus_status look_for_hemispheres(struct manifest_draft *draft, const char *folder, const char *path)
{
    static const char *const kinds[] = {".pial", ".pial.T1", ".white", ".smoothwm", ".midthickness"};
    conus_status status = CONUS_OK;
    bool taken = false;
    for (size_t i = 0; !status && !taken && i < sizeof kinds / sizeof kinds[0]; i++) {
        struct names names = {0};
        for (size_t side = 0; !status && side < 2; side++) {
            char name[32];
            snprintf(name, sizeof name, "%s%s", side ? "rh" : "lh", kinds[i]);
            char *file = file_beside(path, name);
            status = !file ? CONUS_ERROR_MEMORY : file_exists(file) ? names_add(&names, name) : CONUS_OK;
            memory_free(file);
        }
        taken = names.count > 0;
        status = status || !taken ? status : take_surfaces(draft, folder, kinds[i], &names);
        names_finish(&names);
    }
    return status;
}

/* Takes the files of VTK out that are tractograms. */
static void drop_streamlines(struct names *names, const json_t *streamlines)
{
    size_t count = 0;
    for (size_t i = 0; i < names->count; i++) {
        if (manifest_draft_has(streamlines, names->names[i])) {
            memory_free(names->names[i]);
        } else {
            names->names[count++] = names->names[i];
        }
    }
    names->count = count;
}

/* `folder` is "" or a name with '/' at its end. */
static conus_status look_for_surfaces(struct manifest_draft *draft, const char *folder)
{
    static const char *const endings[] = {".surf.gii", ".gii", ".obj", ".ply", ".stl", ".off", ".mz3", ".vtk", ".vtp"};
    char *path = file_beside(draft->folder, folder);
    conus_status status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
    bool surf = false;
    bool any = false;
    for (size_t i = 0; !status && i < sizeof endings / sizeof endings[0]; i++) {
        struct names names = {0};
        bool skip = i == 1 && surf; /* other GIFTI files there are no surfaces */
        status = skip ? CONUS_OK : names_list(&names, path, endings[i]);
        if (!folder[0]) {
            drop_streamlines(&names, draft->streamlines);
        }
        if (!status && names.count) {
            surf = surf || i == 0;
            any = true;
            status = take_surfaces(draft, folder, endings[i], &names);
        }
        names_finish(&names);
    }
    status = status || any ? status : look_for_hemispheres(draft, folder, path);
    memory_free(path);
    return status;
}

conus_status manifest_surfaces_add(struct manifest_draft *draft, const char *name)
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
        status = manifest_draft_append(draft->areas, json_pack("{s:s}", "brainglobe", name[0] ? name : "."));
        status = status ? status : manifest_draft_log(draft, "%s: BrainGlobe folder", name[0] ? name : ".");
    } else if (!status) {
        status = look_for_surfaces(draft, folder.data ? folder.data : "");
    }
    buffer_finish(&meshes);
    buffer_finish(&table);
    buffer_finish(&folder);
    return status;
}

/* The folder has no surfaces. A manifest in it was probably meant, so the message names it. */
static conus_status refuse_folder(const char *folder)
{
    struct names names = {0};
    int length = (int)strlen(folder) - 1; /* without the slash */
    conus_status status = names_list(&names, folder, ".atlas.json");
    if (!status && names.count) {
        status = fail(CONUS_ERROR_DATA, "%.*s: no surfaces in this folder, but a manifest: %s%s is the atlas", length,
                      folder, folder, names.names[0]);
    } else if (!status) {
        status = fail(CONUS_ERROR_DATA,
                      "%.*s: no surfaces in this folder (or structures.json and annotation.tiff or meshes/, as "
                      "BrainGlobe has them); for volumes: conus manifest",
                      length, folder);
    }
    names_finish(&names);
    return status;
}

conus_status manifest_of_folder(struct buffer *out, const char *folder, bool meshes)
{
    static const conus_manifest_options silent;
    bool voxels = false;
    struct manifest_draft draft = {
        .folder = folder, .options = &silent, .areas = json_array(), .pathways = json_array()};
    conus_status status = draft.areas && draft.pathways ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || meshes ? status : brainglobe_has_voxels(&voxels, folder);
    status = status ? status : voxels ? manifest_brainglobe_set(&draft) : manifest_surfaces_add(&draft, "");
    if (!status && !voxels && !json_array_size(draft.areas)) {
        status = refuse_folder(folder);
    }
    status = status ? status : manifest_draft_format(out, &draft);
    manifest_draft_finish(&draft);
    return status;
}
