/* SPDX-License-Identifier: BSD-3-Clause */
/* A volume, an FSL atlas XML, a manifest, a surface, CIFTI labels or a folder becomes an atlas. */
#include "loaders/scene/scene.h"

#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe.h"
#include "loaders/labels/labels.h"
#include "loaders/manifest/manifest.h"
#include "loaders/maps/maps.h"
#include "loaders/refuse.h"
#include "loaders/scene/parts.h"
#include "loaders/volumes/volumes.h"

#include <string.h>

/* Takes what is stated of surfaces' coordinates, ",space=WORD", off the path. */
static const char *take_space(struct job *job, struct scene *out, const char *path)
{
    struct source_keys keys;
    source_keys_read(job, &keys, path, KEYS_SCENE);
    char *word = job_copy(job, keys_value(&keys, KEY_SPACE)->text);
    char *plain = job_raw(job, strlen(path) + 1, 1);
    if (!word[0] || !plain) {
        return path;
    }
    out->space = strcmp(word, "lps") == 0 ? MESH_SPACE_LPS : MESH_SPACE_RAS;
    out->image = out->space == MESH_SPACE_LPS || strcmp(word, "ras") == 0 ? NULL : word;
    keys_keep(plain, path, &keys, KEYS_VOLUME);
    return plain;
}

/* Loads the surface `path`: each part is an area, or the whole. */
static void load_surface(struct load *load, const char *path, struct scene *scene)
{
    struct scene_item item = {
        .kind = ITEM_AREA, .file = (char *)path, .vertex_labels = (char *)load->options->labels, .parts = true};
    load_at(load, path);
    *LIST_ADD(&load->job, &scene->items) = item;
    scene_load(load, scene, "", NULL);
}

/* Loads the .dlabel.nii path, which may choose a map, with the surfaces beside it. */
static void load_cifti(struct load *load, const char *path)
{
    struct job *job = &load->job;
    struct scene scene = {0};
    const char *labels = load->options->labels;
    if (labels) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "--labels %s: %s names its labels itself", labels, path);
    }
    const struct cifti_file *file = cifti_file_open(job, path);
    plan_cifti(job, &scene, file);
    scene_load(load, &scene, file ? file->path : "", "the label table in it");
}

enum { JSON_LIMIT = 64 << 20 };

static const char atlas_needed[] =
    "a labelled volume (" VOLUME_NAMES ", OME-Zarr), a surface, a folder of surfaces, a manifest (with the key "
    "\"conus_atlas\") or an FSL atlas XML";

static void report_only_file(struct load *load, const char *path)
{
    load->job.total = 1;
    load_report(load, path, 1);
}

/* Loads one volume of labels, or several of probabilities. */
static void load_volumes(struct load *load, const struct source *source, const char *path)
{
    struct job *job = &load->job;
    const struct named_maps maps = named_maps_find(job, source, path, load->options);
    struct parcellation *part = job_new(job, struct parcellation);
    if (part && maps.table->count) {
        named_maps_load(load, path, &maps);
    } else if (part) {
        report_only_file(load, path);
        parcellation_read_opened(job, part, source, path, load->options, atlas_needed);
        parcellations_atlas(load, part, 1, part->table, part->source);
    }
}

static void load_json(struct load *load, const struct open_file *file)
{
    struct job *job = &load->job;
    struct bytes bytes = {0};
    if (!JOB_CALL(job, file_read_open(&bytes, file, SIZE_MAX, JSON_LIMIT, ""))) {
        return;
    }
    if (manifest_is(text_from_bytes(bytes.data, bytes.size))) {
        manifest_load(load, file->path, &bytes);
    } else {
        const size_t mark = job_in(job, file->path, JOB_ALONE);
        file_refuse(job, file->path, &bytes, atlas_needed);
        job_out(job, mark);
    }
    bytes_finish(&bytes);
}

/* Notes that the stack of sides in a BrainGlobe folder is not used. */
static void note_hemispheres(struct job *job, const char *folder)
{
    const char *path = job_beside(job, folder, "hemispheres.tiff");
    if (brainglobe_has_voxels(job, folder) && job_has_file(job, path)) {
        job_note(job, "%s (1 is left, 2 is right) is not used: areas are of both sides", path);
    }
}

/* Finds the folder of BrainGlobe's third release that `path` means: the folder itself, the newest version in it, or the
 * folder of the manifest.json. NULL where there is none. It ends in '/'. */
static const char *find_brainglobe(struct job *job, const char *path)
{
    const int above = (int)(path_base(path) - path);
    const bool is_file = strcmp(path + above, "manifest.json") == 0;
    const char *folder = !is_file ? job_format(job, "%s%s", path, path[above] ? "/" : "")
                         : above  ? job_format(job, "%.*s", above, path)
                                  : "./";
    if (brainglobe_atlas_is(job, folder)) {
        return folder;
    }
    const struct names versions = is_file ? (struct names){0} : brainglobe_versions(job, folder);
    return versions.count ? job_format(job, "%s%s/", folder, versions.names[versions.count - 1]) : NULL;
}

static void load_brainglobe(struct load *load, const char *folder)
{
    struct scene scene = {0};
    const char *root = "";
    plan_brainglobe(&load->job, &scene, &root, folder);
    scene_load(load, &scene, root, "terminology.csv");
}

/* Refuses what is stated of surfaces where there are none, or they say it by themselves. */
static void refuse_space(struct job *job, const struct scene *stated, const char *path, bool has_surfaces)
{
    if (stated->space && !has_surfaces) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: space= is for surfaces, and this is none", path);
    }
}

static void load_folder(struct load *load, const char *path, const struct scene *stated)
{
    struct job *job = &load->job;
    const char *whole = brainglobe_of_meshes(job, path); /* the folder whose meshes these are */
    const char *folder = whole ? whole : job_format(job, "%s%s", path, path_base(path)[0] ? "/" : "");
    struct scene scene;
    scene_of_folder(job, &scene, folder, whole != NULL);
    scene.space = stated->space;
    scene.image = stated->image;
    refuse_space(job, &scene, path, scene_count(&scene, ITEM_AREA | ITEM_AREAS));
    scene_load(load, &scene, folder, "the manifest");
    if (!whole) {
        note_hemispheres(job, folder);
    }
}

/* Whether the file is an FSL atlas of probabilities: the type Label is a parcellation. */
static bool is_probabilistic(struct job *job, const struct open_file *file)
{
    struct bytes bytes = {0};
    if (file->before.size > FSL_ATLAS_LIMIT) { /* its reader says why it cannot be read, here and below */
        return false;
    }
    const struct attempt attempt = job_try(job);
    (void)JOB_CALL(job, file_read_open(&bytes, file, SIZE_MAX, FSL_ATLAS_LIMIT, ""));
    const struct fsl_atlas *atlas = fsl_atlas_parse(job, text_from_bytes(bytes.data, bytes.size));
    const bool is = job_ok(job) && !atlas->is_label;
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    bytes_finish(&bytes);
    return is;
}

static void load_file(struct load *load, const struct source *source, const char *path, struct scene *stated)
{
    const enum format_id scene = source_scene(source);
    const bool is_surface = source->is_open && format_find(&source->head, ROLE_SURFACE);
    refuse_space(&load->job, stated, path, scene != FORMAT_MANIFEST && (is_surface || !source->is_open));
    if (scene == FORMAT_MANIFEST) {
        load_json(load, &source->file);
    } else if (scene == FORMAT_CIFTI) {
        load_cifti(load, path);
    } else if (scene == FORMAT_ATLAS_XML && is_probabilistic(&load->job, &source->file)) {
        probabilities_load(load, path);
    } else if (scene == FORMAT_ATLAS_XML || !is_surface) {
        load_volumes(load, source, path);
    } else {
        load_surface(load, path, stated);
    }
}

static void load_path(struct load *load, const char *path)
{
    struct job *job = &load->job;
    struct source source = {0};
    struct scene stated = {0};
    path = take_space(job, &stated, path);
    const struct format *zarr = NULL;
    bool is_folder = file_is_folder(path);
    if (is_folder) {
        (void)JOB_CALL(job, source_find(&zarr, path, ROLE_VOLUME));
        is_folder = !zarr;
    }
    const bool may_be_brainglobe = is_folder || strcmp(path_base(path), "manifest.json") == 0;
    const char *brainglobe = may_be_brainglobe ? find_brainglobe(job, path) : NULL;
    if (brainglobe) {
        refuse_space(job, &stated, path, false);
        load_brainglobe(load, brainglobe);
    } else if (is_folder) {
        load_folder(load, path, &stated);
    } else if (JOB_CALL(job, source_open_atlas(&source, path))) {
        load_file(load, &source, path, &stated);
    }
    source_close(&source);
}

static void note_unit(struct job *job, conus_atlas *atlas)
{
    static const double most = 1000; /* of a brain in mm, */
    static const double least = 0.3; /* and of a brain in metres */
    static const double world[16] = {1, [5] = 1, [10] = 1, [15] = 1};
    double low[3];
    double high[3];
    double farthest = 0;
    if (!atlas->mesh_count || !atlas_area_bounds(low, high, atlas, world)) {
        return;
    }
    for (int a = 0; a < 3; a++) {
        farthest = fmax(farthest, fmax(-low[a], high[a]));
    }
    if (farthest > most || farthest < least) {
        (void)JOB_CALL(job, notes_warn(&atlas->notes,
                                       "areas reach %g mm from the origin: are the coordinates of their surfaces %s? "
                                       "They were taken as millimetres",
                                       farthest, farthest > most ? "micrometres" : "metres"));
    }
}

/* Checks the whole atlas while the log still gets its notes. */
static void check_whole(struct load *load, const char *path)
{
    struct job *job = &load->job;
    conus_atlas *atlas = load->atlas;
    const double probability = load->options->probability;
    load->sink.path = path;
    if (probability > 0 && !atlas_has_probabilities(atlas)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "--probability %g: %s has no areas of probabilities", probability, path);
    }
    (void)JOB_CALL(job, conflicting_sides_note(atlas));
    note_unit(job, atlas);
    atlas->notes.sink = NULL;
    atlas->path = memory_text(path, strlen(path));
    job_need(job, atlas->path);
}

conus_status atlas_load_files(conus_atlas **out, const char *path, const conus_load_options *options)
{
    struct load load;
    load_begin(&load, path, options);
    if (options->probability >= 0 && options->probability <= 1) {
        load_path(&load, path);
    } else {
        job_fail(&load.job, CONUS_ERROR_ARGUMENT, "--probability: is %g, allowed is above 0 to 1 (0 = default)",
                 options->probability);
    }
    atlas_take(&load.job, load.atlas);
    if (job_step(&load.job)) {
        check_whole(&load, path);
    }
    return load_end(out, &load);
}
