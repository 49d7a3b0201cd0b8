/* SPDX-License-Identifier: BSD-3-Clause */
/* Entries of a manifest for the surfaces in a folder, or for the files of BrainGlobe. */
#include "loaders/manifest/manifest.h"

#include "base/files/file.h"
#include "base/path.h"
#include "conus/own.h"
#include "sources/names.h"

#include <string.h>

static bool has_file(struct job *job, const char *folder, const char *name)
{
    return job_has_file(job, job_format(job, "%s%s", folder, name));
}

bool brainglobe_has_voxels(struct job *job, const char *folder)
{
    bool annotated = has_file(job, folder, BRAINGLOBE_ANNOTATION);
    return has_file(job, folder, "structures.json") && annotated;
}

const char *brainglobe_of_meshes(struct job *job, const char *path)
{
    const size_t length = path_plain_length(path, strlen(path));
    const size_t above = path_length_above(path, length);
    if (!above || !text_equal((struct text){path + above, length - above}, "meshes")) {
        return NULL;
    }
    const char *folder = job_format(job, "%.*s", (int)above, path);
    return has_file(job, folder, "structures.json") ? folder : NULL;
}

/* 'L' of lh.pial, 'R' of rh.pial, else 0. */
static char hemisphere_of(const char *name)
{
    return strncmp(name, "lh.", 3) == 0 ? 'L' : strncmp(name, "rh.", 3) == 0 ? 'R' : '\0';
}

/* The annotation of a hemisphere in `folder`: the only one, or aparc of several. NULL if there is none. */
static const char *find_annotation(struct job *job, const struct manifest_draft *draft, const char *folder, char side)
{
    struct names names = job_names(job, job_format(job, "%s%s", draft->folder, folder), ".annot");
    const char *found = NULL;
    size_t count = 0;
    for (size_t i = 0; i < names.count; i++) {
        if (hemisphere_of(names.names[i]) == side) {
            found = !count++ || strcmp(names.names[i] + 3, "aparc.annot") == 0 ? names.names[i] : found;
        }
    }
    bool chosen = count == 1 || (count && strcmp(found + 3, "aparc.annot") == 0);
    if (count > 1) {
        manifest_draft_log(job, draft, "%s%ch.*.annot: %zu annotations, %s is taken", folder, side == 'L' ? 'l' : 'r',
                           count, chosen ? found : "none");
    }
    return chosen ? job_format(job, "%s%s", folder, found) : NULL;
}

static void log_step(struct job *job, struct manifest_draft *draft, const char *what)
{
    const uint32_t offset = draft->label_offset;
    manifest_draft_log(job, draft, "%s, labels above %u", what, offset);
    draft->label_offset = offset < UINT32_MAX - MANIFEST_LABEL_STEP ? offset + MANIFEST_LABEL_STEP : UINT32_MAX;
}

/* Takes a surface as the areas of its hemisphere's annotation, beside it or, from surf/, in label/. */
static bool take_annotated(struct job *job, struct manifest_draft *draft, const char *folder, const char *name)
{
    char side = hemisphere_of(name);
    const char *labels = find_annotation(job, draft, folder, side);
    if (!labels && strcmp(folder, "surf/") == 0) {
        labels = find_annotation(job, draft, "label/", side);
    }
    if (!labels) {
        return false;
    }
    const char *file = job_format(job, "%s%s", folder, name);
    const struct scene_item area = {.kind = ITEM_AREA,
                                    .file = (char *)file,
                                    .vertex_labels = (char *)labels,
                                    .label.hemisphere = side,
                                    .label_offset = draft->label_offset};
    const bool taken = manifest_draft_take(job, draft, &area, labels);
    if (taken) {
        log_step(job, draft, job_format(job, "%s: cut by %s", file, labels));
    }
    return taken;
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
static void take_all_annotated(struct job *job, struct manifest_draft *draft, const char *folder, struct names *names)
{
    for (size_t i = 0; i < names->count;) {
        char **name = &names->names[i];
        if (is_only_of_side(names, *name) && take_annotated(job, draft, folder, *name)) {
            memmove(name, name + 1, (--names->count - i) * sizeof *name);
        } else {
            i++;
        }
    }
}

/* Takes the surfaces of one ending in a folder that no annotation cuts: as a pattern if their names give labels, else
 * one by one. */
static void take_surfaces(struct job *job, struct manifest_draft *draft, const char *folder, const char *ending,
                          struct names *names)
{
    size_t found = names->count;
    const char *pattern = job_format(job, "%s*%s", folder, ending);
    take_all_annotated(job, draft, folder, names);
    const struct scene_item areas = {.kind = ITEM_AREAS, .file = (char *)pattern, .label_offset = draft->label_offset};
    bool all =
        names->count == found && surface_names_give_labels(names) && manifest_draft_take(job, draft, &areas, NULL);
    size_t count = all ? found : 0;
    for (size_t i = 0; !all && i < names->count; i++) {
        const char *file = job_format(job, "%s%s", folder, names->names[i]);
        const uint64_t label = (uint64_t)draft->label_offset + i + 1;
        const struct scene_item area = {.kind = ITEM_AREA, .file = (char *)file, .label.number = (uint32_t)label};
        if (label > UINT32_MAX) {
            manifest_draft_leave_out(job, draft, file, "there is no label left for it");
        } else {
            count += manifest_draft_take(job, draft, &area, file);
        }
    }
    if (count) {
        log_step(job, draft, job_format(job, "%s: %zu surfaces", pattern, count));
    }
}

/* FreeSurfer's surfaces have no ending, and several of them are one hemisphere: the first kind that is there counts. */
static void look_for_hemispheres(struct job *job, struct manifest_draft *draft, const char *folder, const char *path)
{
    static const char *const kinds[] = {".pial", ".pial.T1", ".white", ".smoothwm", ".midthickness"};
    char *both[2];
    struct names names = {both, 0};
    for (size_t i = 0; !names.count && i < sizeof kinds / sizeof kinds[0]; i++) {
        for (size_t side = 0; side < 2; side++) {
            char *name = job_format(job, "%s%s", side ? "rh" : "lh", kinds[i]);
            if (has_file(job, path, name)) {
                both[names.count++] = name;
            }
        }
        if (names.count) {
            take_surfaces(job, draft, folder, kinds[i], &names);
            return;
        }
    }
}

static void drop_streamlines(struct names *names, const struct manifest_draft *draft)
{
    size_t count = 0;
    for (size_t i = 0; i < names->count; i++) {
        if (!manifest_draft_find(draft, ITEM_STREAMLINES, names->names[i])) {
            names->names[count++] = names->names[i];
        }
    }
    names->count = count;
}

/* `folder` is "" or a name with '/' at its end. */
static void look_for_surfaces(struct job *job, struct manifest_draft *draft, const char *folder)
{
    const char *path = job_format(job, "%s%s", draft->folder, folder);
    bool any = false;
    for (const char *ending = NULL; (ending = ending_next(ending, ROLE_SURFACE));) {
        if (any && strcmp(ending, ".gii") == 0) {
            continue; /* beside .surf.gii other GIFTI files are no surfaces */
        }
        struct names names = job_names(job, path, ending);
        if (!folder[0]) {
            drop_streamlines(&names, draft);
        }
        if (names.count) {
            any = true;
            take_surfaces(job, draft, folder, ending, &names);
        }
    }
    if (!any) {
        look_for_hemispheres(job, draft, folder, path);
    }
}

void manifest_surfaces_add(struct job *job, struct manifest_draft *draft, const char *name)
{
    const char *shown = name[0] ? name : ".";
    const char *folder = job_format(job, "%s%s", name, name[0] ? "/" : "");
    const char *meshes = job_format(job, "%s%smeshes", draft->folder, folder);
    if (job_has_file(job, job_format(job, "%s%sstructures.json", draft->folder, folder)) && file_is_folder(meshes)) {
        scene_add(job, &draft->scene, &(struct scene_item){.kind = ITEM_MESHES, .file = (char *)shown});
        manifest_draft_log(job, draft, "%s: BrainGlobe folder", shown);
    } else {
        look_for_surfaces(job, draft, folder);
    }
}

/* The folder has no surfaces. A manifest in it was probably meant, so the message names it. */
static void refuse_folder(struct job *job, const char *folder)
{
    struct names names = job_names(job, folder, ".atlas.json");
    int length = (int)strlen(folder) - 1; /* without the slash */
    if (names.count) {
        job_bad(job, "%.*s: no surfaces in this folder, but a manifest: %s%s is the atlas", length, folder, folder,
                names.names[0]);
    }
    job_bad(job,
            "%.*s: no surfaces in this folder (or structures.json and annotation.tiff or meshes/, as BrainGlobe has "
            "them); for volumes: conus manifest; a tractogram goes beside an atlas, each file as --streamlines FILE",
            length, folder);
}

void scene_of_folder(struct job *job, struct scene *out, const char *folder, bool meshes)
{
    static const conus_manifest_options silent;
    struct manifest_draft draft = {.folder = folder, .options = &silent};
    if (!meshes && brainglobe_has_voxels(job, folder)) {
        scene_add(job, &draft.scene, &(struct scene_item){.kind = ITEM_PARCELLATION, .file = BRAINGLOBE_ANNOTATION});
        if (has_file(job, folder, BRAINGLOBE_REFERENCE)) {
            scene_add(job, &draft.scene, &(struct scene_item){.kind = ITEM_CONTEXT, .file = BRAINGLOBE_REFERENCE});
        }
    } else {
        manifest_surfaces_add(job, &draft, "");
        if (!draft.scene.items.count) {
            refuse_folder(job, folder);
        }
    }
    *out = draft.scene;
}
