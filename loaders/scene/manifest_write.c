/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_manifest_write(): writes a first manifest for the files in a folder. It guesses the role of a volume from its
 * values, and reports every guess. A file is looked at in an attempt: what is wrong with it leaves it out. */
#include "base/files/file.h"
#include "base/formats/xml.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/cifti/cifti.h"
#include "loaders/labels/labels.h"
#include "loaders/manifest/manifest.h"
#include "loaders/maps/maps.h"
#include "loaders/scene/parts.h"
#include "loaders/scene/scene.h"
#include "loaders/tracts/tracts.h"
#include "loaders/transform/transform.h"
#include "sources/names.h"

#include <limits.h>
#include <string.h>

static void say_transform(struct job *job, const struct manifest_draft *draft, const char *name, const char *what)
{
    manifest_draft_log(job, draft,
                       "%s: %s, left out: where it leads is not known; \"transform\": \"%s\" in the manifest brings "
                       "the areas to the other images",
                       name, what, name);
}

/* Logs that the file `name` is left out if it is a transform: neither its direction nor its images are known. */
static void look_for_transform(struct job *job, const struct manifest_draft *draft, const char *name)
{
    struct transform_chain transform = {0};
    if (!path_ending_length(name, ".tfm/.mat/.lta/.xfm")) {
        return;
    }
    const struct job_mark mark = job_mark(job);
    const struct attempt attempt = job_try(job);
    struct source *source = source_open(job, job_beside(job, draft->folder, name));
    const bool is_matlab = source && format_id_of(&source->stored, ROLE_TRANSFORM) == FORMAT_HDF5;
    if (!is_matlab) {
        transform_read(job, &transform, source, &(conus_transform_options){0});
    }
    const bool is = job_ok(job) ? !is_matlab : job->status == CONUS_ERROR_ARGUMENT; /* FSL's, without its images */
    transform_chain_finish(&transform);
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    job_release(job, mark);
    if (is) {
        say_transform(job, draft, name, "a transform");
    }
}

/* Logs the same for the volume `name` if its header says that it is a deformation field or a part of one: whether it
 * is. */
static bool is_field(struct job *job, const struct manifest_draft *draft, const char *name)
{
    bool usable = false;
    const struct job_mark mark = job_mark(job);
    const struct attempt attempt = job_try(job); /* reading the volume says what is wrong */
    const struct source *source = source_open(job, job_beside(job, draft->folder, name));
    const char *words = source ? field_words(&usable, source) : NULL;
    const bool is = job_ok(job) && words;
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    job_release(job, mark);
    if (is && usable) {
        say_transform(job, draft, name, words);
    } else if (is) {
        manifest_draft_log(job, draft, "%s: %s, left out: it moves no areas", name, words);
    }
    return is;
}

static void use_file(struct job *job, struct manifest_draft *draft, const char *name)
{
    *LIST_ADD(job, &draft->used) = job_format(job, "%s", name);
}

/* Marks the images of the atlas as used, so that they are not taken as volumes of their own. */
static void use_images(struct job *job, struct manifest_draft *draft, const struct fsl_atlas *atlas)
{
    for (size_t i = 0; i < atlas->image_count; i++) {
        const char *paths[] = {atlas->images[i].image, atlas->images[i].summary};
        for (size_t k = 0; k < 2; k++) {
            if (paths[k]) {
                use_file(job, draft, paths[k] + strspn(paths[k], "/"));
            }
        }
    }
}

/* Whether the volume `name` is an image of an FSL atlas that was taken. */
static bool is_used(const struct manifest_draft *draft, const char *name)
{
    size_t length = volume_stem_length(name);
    bool is = false;
    for (size_t i = 0; !is && i < draft->used.count; i++) {
        const char *used = draft->used.at[i];
        is = volume_stem_length(used) == length && strncmp(used, name, length) == 0;
    }
    return is;
}

/* Chooses the file that the manifest names for `xml`, an atlas of type Label: the XML itself; its volume, where that
 * has other names by itself, so that the manifest and a query of the volume give the same names; or NULL, where another
 * XML has taken the volume. The log says why it is not the XML. */
static const char *choose_file(struct job *job, const struct manifest_draft *draft, const char *xml)
{
    const conus_load_options options = {.max_memory = job->max_memory};
    char *chosen = (char *)xml;
    const struct job_mark mark = job_mark(job);
    const struct attempt attempt = job_try(job); /* what does not load says so when it is tried */
    struct parcellation *parts = job_new(job, struct parcellation);
    parcellation_read(job, parts, job_beside(job, draft->folder, xml), &options, "an atlas XML");
    const char *volume = job_ok(job) ? parts->file.path + strlen(draft->folder) : NULL;
    const char *note =
        volume && parts->is_disputed ? job_copy(job, text_from(job->notes.lines[job->notes.count - 1])) : NULL;
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    if (volume && is_used(draft, volume)) {
        chosen = NULL;
        manifest_draft_log(job, draft, "%s: left out, since another XML has %s", xml, volume);
    } else if (note) {
        chosen = job_give(job, job_copy(job, text_from(volume)), strlen(volume) + 1);
        manifest_draft_log(job, draft, "%s: left out for %s, which has other names by itself: %s", xml, volume, note);
    }
    job_release(job, mark);
    return chosen == xml ? chosen : job_adopt(job, chosen);
}

static bool has_item_named(const struct manifest_draft *draft, unsigned kinds, const char *name, size_t length)
{
    bool has = false;
    for (const struct scene_item *item = NULL; !has && (item = scene_next(&draft->scene, kinds, item));) {
        has = text_equal((struct text){name, length}, item->label.name ? item->label.name : "");
    }
    return has;
}

/* Appends the file `name` to "streamlines" if it is a tractogram that loads; logs it if it is a transform. */
static void look_at_no_volume(struct job *job, struct manifest_draft *draft, const char *name)
{
    if (name[0] == '.' || !tract_file_is(job_beside(job, draft->folder, name))) {
        look_for_transform(job, draft, name);
        return;
    }
    size_t length = stem_length(name, strlen(name), ROLE_TRACTS);
    bool taken = has_item_named(draft, ITEM_STREAMLINES | ITEM_PATHWAY, name, length);
    const struct scene_item item = {.kind = ITEM_STREAMLINES,
                                    .file = (char *)name,
                                    .label.name = job_format(job, "%.*s", taken ? INT_MAX : (int)length, name)};
    if (manifest_draft_take(job, draft, &item, name)) {
        manifest_draft_log(job, draft, "%s: streamlines", name);
    }
}

enum { FIRST_OFFSET = 1000, LAST_OFFSET = 1000000000 };

static struct scene_item *first_parcellation(const struct manifest_draft *draft)
{
    return scene_next(&draft->scene, ITEM_PARCELLATION, NULL);
}

/* Tries both halves with the labels of the right one as they are, else behind the left one's. NULL if they load. */
static const char *try_halves(struct job *job, const struct manifest_draft *draft, struct scene_item halves[2])
{
    const char *why = manifest_draft_try(job, draft, halves, 2);
    for (uint32_t next = FIRST_OFFSET; job_ok(job) && why && next <= LAST_OFFSET; next *= 10) {
        halves[1].label_offset = next;
        why = manifest_draft_try(job, draft, halves, 2);
    }
    return why;
}

static void take_halves(struct job *job, struct manifest_draft *draft, const char *left, const char *right)
{
    struct scene_item halves[] = {{.kind = ITEM_PARCELLATION, .file = (char *)left, .label.hemisphere = 'L'},
                                  {.kind = ITEM_PARCELLATION, .file = (char *)right, .label.hemisphere = 'R'}};
    const char *why = try_halves(job, draft, halves);
    const uint32_t offset = halves[1].label_offset;
    if (why) {
        job_bad(job, "%s%s and %s are left and right of one, and do not load together: %.399s", draft->folder, left,
                right, why);
    } else if (offset) {
        manifest_draft_log(job, draft, "%s: left and right of one with %s; its labels are %u further", right, left,
                           offset);
    } else {
        manifest_draft_log(job, draft, "%s: left and right of one with %s", right, left);
    }
    *first_parcellation(draft) = halves[0];
    scene_add(job, &draft->scene, &halves[1]);
    draft->label_offset = offset < MANIFEST_LABEL_STEP ? MANIFEST_LABEL_STEP : 10 * offset;
}

static void set_second(struct job *job, struct manifest_draft *draft, const char *name)
{
    const char *first = first_parcellation(draft)->file;
    bool is_right = volume_names_are_halves(job, first, name);
    if ((!is_right && !volume_names_are_halves(job, name, first)) ||
        scene_count(&draft->scene, ITEM_PARCELLATION) > 1) {
        job_bad(job, /* the user knows which is meant or first */
                "%s%s and %s are both parcellations, and their names are not left and right of one: give one of them "
                "as ATLAS, or write the manifest by hand (\"parcellations\", docs/formats.md)",
                draft->folder, first, name);
    } else {
        take_halves(job, draft, is_right ? first : name, is_right ? name : first);
    }
}

/* Whether `name` loads as the parcellation of the draft, or as the other half of it. */
static bool set_parcellation(struct job *job, struct manifest_draft *draft, const char *name)
{
    const struct scene_item item = {.kind = ITEM_PARCELLATION, .file = (char *)name};
    const char *why = manifest_draft_try(job, draft, &item, 1);
    if (why) {
        manifest_draft_leave_out(job, draft, name, why);
    } else if (first_parcellation(draft)) {
        set_second(job, draft, name);
    } else {
        scene_add(job, &draft->scene, &item);
        draft->label_offset = MANIFEST_LABEL_STEP;
    }
    return !why;
}

static void take_fsl(struct job *job, struct manifest_draft *draft, const char *xml, const struct fsl_atlas *atlas)
{
    const char *name = atlas->is_label ? choose_file(job, draft, xml) : NULL;
    if (name && set_parcellation(job, draft, name)) {
        use_images(job, draft, atlas);
        manifest_draft_log(job, draft, "%s: parcellation, an atlas XML of %zu labels", name, atlas->labels.count);
    }
    const struct scene_item maps = {.kind = ITEM_PROBABILITIES, .fsl = (char *)xml};
    if (!atlas->is_label && manifest_draft_take(job, draft, &maps, xml)) {
        use_images(job, draft, atlas);
        manifest_draft_log(job, draft, "%s: FSL atlas, %zu areas by probabilities", xml, atlas->labels.count);
    }
}

static void look_at_xml(struct job *job, struct manifest_draft *draft, const char *name)
{
    struct bytes bytes = {0};
    (void)JOB_CALL(job, file_read(&bytes, job_beside(job, draft->folder, name), FSL_ATLAS_LIMIT));
    struct text text = text_from_bytes(bytes.data, bytes.size);
    if (text.size && text_equal(xml_root(text), "atlas")) {
        const struct attempt attempt = job_try(job);
        struct fsl_atlas *atlas = fsl_atlas_parse(job, text);
        fsl_atlas_number(job, atlas, &(struct label_use){0});
        const bool is = job_ok(job);
        const char *why = attempt_end(job, &attempt, ATTEMPT_DROP);
        if (is) {
            take_fsl(job, draft, name, atlas);
        } else {
            manifest_draft_leave_out(job, draft, name, why);
        }
    }
    bytes_finish(&bytes);
}

#define NAMED "named by the table beside it"

/* Names each volume as the table beside the file does, else by its number. */
static char *name_volume(struct job *job, bool *named, const struct manifest_draft *draft, const char *name,
                         size_t index, size_t count)
{
    const char *from;
    const conus_volume_info info = {
        .path = job_beside(job, draft->folder, name), .volume = index, .volume_count = count};
    char *title = (char *)label_volume_name(job, &from, &info);
    *named = title != NULL;
    return title ? title : job_format(job, "%.*s %zu", (int)volume_stem_length(name), name, index);
}

static void take_volumes(struct job *job, struct manifest_draft *draft, const char *name, size_t count)
{
    size_t taken = 0;
    bool named = false;
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        const struct scene_item item = {.kind = ITEM_PATHWAY,
                                        .file = (char *)name,
                                        .volume = i + 1,
                                        .label.name = name_volume(job, &named, draft, name, i, count)};
        taken += manifest_draft_take(job, draft, &item, item.label.name);
    }
    manifest_draft_log(job, draft, "%s: %zu pathways, %s", name, taken, named ? NAMED : "to be named");
}

/* Whether the table beside the file and its values make it an atlas of probabilities by itself. */
static bool is_probable(struct job *job, const struct manifest_draft *draft, const char *name)
{
    const conus_load_options options = {.max_memory = job->max_memory};
    struct source source = {0};
    const struct job_mark mark = job_mark(job);
    const struct attempt attempt = job_try(job);
    const char *path = job_beside(job, draft->folder, name);
    (void)JOB_CALL(job, source_open_atlas(&source, path));
    const struct named_maps maps = named_maps_find(job, &source, path, &options);
    source_close(&source);
    struct volume_file *file = volume_file_new(job);
    if (maps.table->count && file) {
        volume_load_series(job, file, path, options.max_memory);
    }
    bool named =
        maps.table->count && file && maps.table->count == file->info.volume_count; /* none is the background's */
    if (named) {
        named_maps_check(job, file, 0);
    }
    named = job_ok(job) && named;
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    job_release(job, mark);
    return named;
}

static void take_series(struct job *job, struct manifest_draft *draft, const char *name, size_t count)
{
    bool named = false;
    struct scene_item item = {.file = (char *)name};
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        *LIST_ADD(job, &item.names) = name_volume(job, &named, draft, name, i, count);
    }
    bool probable = named && is_probable(job, draft, name);
    item.kind = probable ? ITEM_PROBABILITIES : ITEM_PATHWAY;
    if (!manifest_draft_take(job, draft, &item, NULL)) {
        take_volumes(job, draft, name, count);
    } else if (probable) {
        manifest_draft_log(job, draft, "%s: %zu areas by probabilities, " NAMED, name, count);
    } else {
        manifest_draft_log(job, draft, "%s: %zu pathways, %s", name, count, named ? NAMED : "to be named");
    }
}

/* Takes a single volume as a pathway, or as an area by probabilities; `words` say why. */
static void take_one_volume(struct job *job, struct manifest_draft *draft, bool probable, const char *name,
                            const char *words)
{
    const struct scene_item item = {.kind = probable ? ITEM_PROBABILITIES : ITEM_PATHWAY,
                                    .file = (char *)name,
                                    .label.name = job_format(job, "%.*s", (int)volume_stem_length(name), name)};
    if (manifest_draft_take(job, draft, &item, name)) {
        manifest_draft_log(job, draft, "%s: %s, %s", name, probable ? "an area by probabilities" : "pathway", words);
    }
}

static void take_context(struct job *job, struct manifest_draft *draft, const char *name, const char *words)
{
    if (scene_count(&draft->scene, ITEM_CONTEXT)) {
        manifest_draft_log(job, draft, "%s: a second context, left out", name);
        return;
    }
    if (!text_is_utf8(text_from(name))) {
        manifest_draft_leave_out(job, draft, name, "its name is no UTF-8");
        return;
    }
    scene_add(job, &draft->scene, &(struct scene_item){.kind = ITEM_CONTEXT, .file = (char *)name});
    manifest_draft_log(job, draft, "%s: context, %s", name, words);
}

static void take_volume(struct job *job, struct manifest_draft *draft, const char *name,
                        const struct volume_guess *guess)
{
    if (guess->use == VOLUME_SERIES) {
        take_series(job, draft, name, guess->count);
    } else if (named_maps_is_probseg(name)) {
        take_one_volume(job, draft, true, name, "as its name says");
    } else if (guess->use == VOLUME_PATHWAY) {
        take_one_volume(job, draft, false, name, guess->words);
    } else if (guess->use == VOLUME_CONTEXT) {
        take_context(job, draft, name, guess->words);
    } else if (set_parcellation(job, draft, name)) {
        manifest_draft_log(job, draft, "%s: parcellation, %s", name, guess->words);
    }
}

/* Guesses the role of the volume `name`: NULL, else why that cannot be. */
static const char *guess_role(struct job *job, struct volume_guess *out, const struct manifest_draft *draft,
                              const char *name)
{
    struct attempt attempt = job_try(job);
    volume_guess_make(job, out, job_beside(job, draft->folder, name));
    return attempt_end(job, &attempt, ATTEMPT_TRY);
}

static void look_at_volume(struct job *job, struct manifest_draft *draft, const char *name)
{
    struct volume_guess guess = {0};
    if (is_used(draft, name)) {
        return;
    }
    const char *why = guess_role(job, &guess, draft, name);
    if (why) {
        manifest_draft_log(job, draft, "left out: %s", why);
    } else {
        take_volume(job, draft, name, &guess);
    }
}

static bool is_volume_file(const char *name)
{
    bool image = path_ending_length(name, ".img/.img.gz/.BRIK/.BRIK.gz"); /* its .hdr or .HEAD is taken */
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
static void take_labelled(struct job *job, struct manifest_draft *draft, const struct scene *scene, uint32_t largest)
{
    uint32_t base = draft->label_offset;
    raise_offset(draft, (uint64_t)base + largest);
    for (const struct scene_item *of = NULL; (of = scene_next(scene, ITEM_AREA, of));) {
        const uint64_t offset = (uint64_t)base + of->label_offset;
        const struct scene_item area = {.kind = ITEM_AREA,
                                        .file = of->file,
                                        .vertex_labels = of->vertex_labels,
                                        .label_offset = offset < UINT32_MAX ? (uint32_t)offset : UINT32_MAX};
        raise_offset(draft, offset + largest);
        if (manifest_draft_take(job, draft, &area, area.file)) {
            manifest_draft_log(job, draft, "%s: cut by %s", area.file, area.vertex_labels);
        }
    }
}

/* Takes voxels and surfaces from a .dlabel.nii: whether it could be read. */
static bool take_cifti(struct job *job, struct manifest_draft *draft, const char *name)
{
    struct scene scene = {0};
    const struct notes before = label_notes_swap(job, (struct notes){0});
    const struct attempt attempt = job_try(job);
    const struct cifti_file *file = cifti_file_open(job, job_beside(job, draft->folder, name));
    plan_cifti(job, &scene, file);
    const bool is = job_ok(job) && file;
    struct notes notes = label_notes_swap(job, (struct notes){0}); /* also of one that is refused */
    const char *why = attempt_end(job, &attempt, ATTEMPT_DROP);
    (void)label_notes_swap(job, before);
    if (is) {
        const struct label_table *table = &file->choice->table;
        const struct scene_item *voxels = scene_next(&scene, ITEM_PARCELLATION, NULL);
        uint32_t offset = draft->label_offset;
        if (voxels && set_parcellation(job, draft, voxels->file)) {
            manifest_draft_log(job, draft, "%s: parcellation, voxels of CIFTI labels", voxels->file);
        }
        draft->label_offset = offset; /* the plan keeps surfaces off the file's own voxels */
        take_labelled(job, draft, &scene, table->entries[table->count - 1].number);
    } else {
        manifest_draft_leave_out(job, draft, name, why);
    }
    for (size_t i = 0; i < notes.count; i++) {
        manifest_draft_log(job, draft, "%s", notes.lines[i]);
    }
    notes_finish(&notes);
    return is;
}

static bool is_cifti(struct job *job, const char *path)
{
    struct source source = {0};
    bool is = JOB_CALL(job, source_open_atlas(&source, path)) && source_scene(&source) == FORMAT_CIFTI;
    source_close(&source);
    return is;
}

/* The .dlabel.nii among `names`, NULL if there is none; of several, which one is meant is not known. */
static const char *look_for_cifti(struct job *job, struct manifest_draft *draft, const struct names *names)
{
    const char *found = NULL;
    size_t count = 0;
    for (size_t i = 0; i < names->count; i++) {
        const char *name = names->names[i];
        if (is_volume_file(name) && is_cifti(job, job_beside(job, draft->folder, name))) {
            use_file(job, draft, name); /* it is no volume */
            found = name;
            count++;
        }
    }
    if (count > 1) {
        manifest_draft_log(job, draft, "%zu files of CIFTI labels, none is taken: give one of them as ATLAS", count);
    }
    return count == 1 ? found : NULL;
}

/* Takes the voxels of a BrainGlobe folder, if they load: then its other stacks and its meshes are no further areas. */
static bool take_brainglobe(struct job *job, struct manifest_draft *draft)
{
    struct volume_guess guess = {0};
    if (!brainglobe_has_voxels(job, draft->folder) || !set_parcellation(job, draft, BRAINGLOBE_ANNOTATION)) {
        return false;
    }
    manifest_draft_log(job, draft, BRAINGLOBE_ANNOTATION ": parcellation of a BrainGlobe folder");
    if (job_has_file(job, job_beside(job, draft->folder, BRAINGLOBE_REFERENCE))) {
        const char *why = guess_role(job, &guess, draft, BRAINGLOBE_REFERENCE);
        if (why) {
            manifest_draft_leave_out(job, draft, BRAINGLOBE_REFERENCE, why);
        } else {
            take_context(job, draft, BRAINGLOBE_REFERENCE, "a BrainGlobe reference");
        }
    }
    return true;
}

/* Takes the volume `name`, in a folder that is perhaps a BrainGlobe folder. */
static void look_at_other(struct job *job, struct manifest_draft *draft, const char *name, bool brainglobe)
{
    if (!brainglobe || !path_ending_length(name, ".tiff/.tif")) {
        if (!is_field(job, draft, name)) {
            look_at_volume(job, draft, name);
        }
    } else if (strcmp(name, BRAINGLOBE_ANNOTATION) != 0 && strcmp(name, BRAINGLOBE_REFERENCE) != 0) {
        manifest_draft_log(job, draft, "%s: left out, another stack of the BrainGlobe folder", name);
    }
}

/* Adds the surfaces in the folders of the draft's, but for the meshes of a BrainGlobe folder. */
static void look_into_folders(struct job *job, struct manifest_draft *draft, const struct names *names, bool voxels)
{
    for (size_t i = 0; job_ok(job) && i < names->count; i++) {
        const char *name = names->names[i];
        const struct scene_item *areas = scene_next(&draft->scene, ITEM_SURFACES, NULL);
        bool known = voxels || (areas && areas->kind == ITEM_MESHES);
        bool skip = name[0] == '.' || (strcmp(name, "meshes") == 0 && known) ||
                    manifest_draft_find(draft, ITEM_STREAMLINES, name);
        if (!skip && file_is_folder(job_beside(job, draft->folder, name))) {
            manifest_surfaces_add(job, draft, name);
        }
    }
}

static void scan_folder(struct job *job, struct manifest_draft *draft)
{
    const struct names names = job_names(job, draft->folder, "");
    bool voxels = take_brainglobe(job, draft);
    const char *cifti = look_for_cifti(job, draft, &names);
    for (size_t i = 0; i < names.count; i++) {
        if (path_ends_in(names.names[i], ".xml")) {
            look_at_xml(job, draft, names.names[i]);
        }
    }
    for (size_t i = 0; job_ok(job) && i < names.count; i++) {
        if (is_volume_file(names.names[i])) {
            look_at_other(job, draft, names.names[i], voxels);
        } else {
            look_at_no_volume(job, draft, names.names[i]);
        }
    }
    bool labelled = cifti && take_cifti(job, draft, cifti);
    if (!voxels && !labelled) {
        manifest_surfaces_add(job, draft, "");
    }
    look_into_folders(job, draft, &names, voxels);
    const struct scene_item *first = first_parcellation(draft);
    if (first && !voxels && !labelled && scene_count(&draft->scene, ITEM_SURFACES)) {
        manifest_draft_log(job, draft,
                           "%s and surfaces: areas that are in both are there twice: take one out of the manifest",
                           first->file);
    }
}

/* Makes areas of probabilities the first pathways where there is a parcellation or a surface. Areas of probabilities
 * may overlap, so a manifest has no others beside them. */
static void settle_maps(struct job *job, struct manifest_draft *draft)
{
    const struct scene all = draft->scene;
    if (!scene_count(&all, ITEM_LABELLED)) {
        return;
    }
    draft->scene = (struct scene){0};
    for (const struct scene_item *of = NULL; job_ok(job) && (of = scene_next(&all, ITEM_PROBABILITIES, of));) {
        struct scene_item item = *of;
        const char *name = item.fsl ? item.fsl : item.file;
        item.kind = ITEM_PATHWAY;
        if (manifest_draft_take(job, draft, &item, name)) {
            manifest_draft_log(job, draft,
                               "%s: pathways, because a manifest with a parcellation or surfaces has no areas by "
                               "probabilities",
                               name);
        }
    }
    for (const struct scene_item *of = NULL; (of = scene_next(&all, ~(unsigned)ITEM_PROBABILITIES, of));) {
        scene_add(job, &draft->scene, of);
    }
}

static conus_status load_text(const struct manifest_draft *draft, struct text text)
{
    struct load load;
    const struct bytes bytes = {(uint8_t *)text.data, text.size};
    const conus_load_options options = {.max_memory = draft->options->max_memory};
    load_begin(&load, draft->folder, &options);
    manifest_load(&load, draft->folder, &bytes);
    return load_end(NULL, &load);
}

/* Writes the manifest of `folder` as `path`, once the parser has read it. */
static void write_manifest(struct job *job, const char *path, const char *folder, const conus_manifest_options *options)
{
    struct manifest_draft draft = {.folder = folder, .options = options, .load = load_text};
    struct scene again;
    if (!file_is_folder(folder)) {
        job_fail(job, CONUS_ERROR_IO, "%s: there is no such folder", folder);
    }
    scan_folder(job, &draft);
    settle_maps(job, &draft);
    if (!scene_count(&draft.scene, ~(unsigned)ITEM_CONTEXT)) {
        job_bad(job, "%s: neither parcellation nor surfaces, pathways or streamlines in this folder", folder);
    }
    const struct text text = scene_write(job, &draft.scene);
    size_t place = job_in(job, path, JOB_ALONE);
    scene_read(job, &again, text);
    job_out(job, place);
    (void)JOB_CALL(job, file_write_new(path, text.data, text.size));
}

conus_status conus_manifest_write(const char *path, const conus_manifest_options *options)
{
    if (!path || !path[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_manifest_write: a path is needed");
    }
    options = options_of(conus_manifest_options, options);
    struct job job = {.max_memory = options->max_memory};
    char *folder = path_folder(path);
    if (job_need(&job, folder)) {
        write_manifest(&job, path, folder, options);
    }
    memory_free(folder);
    return job_close(&job, NULL, NULL);
}
