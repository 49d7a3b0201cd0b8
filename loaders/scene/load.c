/* SPDX-License-Identifier: BSD-3-Clause */
/* A volume, an FSL atlas XML, a manifest, a surface, CIFTI labels or a folder becomes an atlas. */
#include "loaders/scene/load.h"

#include "atlas/areas/sides.h"
#include "atlas/atlas.h"
#include "atlas/surface/mesh_split.h"
#include "base/files/folder.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe_atlas.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/manifest/manifest_surfaces.h"
#include "loaders/maps/atlas_on_job.h"
#include "loaders/refuse.h"
#include "loaders/scene/load_parcellation.h"
#include "loaders/scene/load_progress.h"
#include "loaders/scene/parcellations.h"
#include "loaders/scene/plan_brainglobe.h"
#include "loaders/scene/plan_cifti.h"
#include "loaders/scene/scene_load.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"
#include "loaders/surfaces/mesh_file.h"
#include "loaders/transform/transform_chain.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_zarr.h"

#include <string.h>

/* A surface before it is an atlas: whole, or cut into parts. */
struct surface {
    struct mesh mesh;
    struct label about;
    struct vertex_labels labels;
    struct mesh_parts parts;
    char *name;         /* of areas that have none by themselves; NULL: their number */
    const char *source; /* of the names, in words */
};

static void end_surface(void *thing)
{
    struct surface *surface = thing;
    mesh_finish(&surface->mesh);
    label_finish(&surface->about);
    vertex_labels_finish(&surface->labels);
    mesh_parts_finish(&surface->parts);
}

/* What is stated of a surface's coordinates, ",space=WORD" behind its path; all zero: nothing. */
struct statement {
    enum mesh_space space;
    bool is_placed; /* by world: an image's own mm, as FSL counts them, in the world */
    double world[16];
};

/* Takes the statement off the path. */
static const char *take_statement(struct job *job, struct statement *out, const char *path)
{
    struct source_keys keys;
    conus_volume_info image;
    double flirt[16];
    double voxel[16];
    source_keys_read(job, &keys, path, KEYS_SCENE);
    const char *word = job_copy(job, keys_value(&keys, KEY_SPACE)->text);
    char *plain = job_raw(job, strlen(path) + 1, 1);
    if (!word[0] || !plain) {
        return path;
    }
    out->space = strcmp(word, "lps") == 0 ? MESH_SPACE_LPS : MESH_SPACE_RAS;
    out->is_placed = strcmp(word, "lps") != 0 && strcmp(word, "ras") != 0;
    if (out->is_placed) {
        volume_header_read(job, &image, word);
    }
    if (out->is_placed && job_ok(job)) {
        flirt_from_voxel(flirt, &image);
        if (mat4_invert_affine(voxel, flirt)) {
            mat4_multiply(out->world, image.world_from_voxel, voxel);
        } else {
            job_bad(job, "%s: the matrix is singular", word);
        }
    }
    keys_keep(plain, path, &keys, KEYS_VOLUME);
    return plain;
}

static void place_surface(struct surface *surface, const struct statement *stated)
{
    if (stated->is_placed && surface->mesh.vertex_count) {
        mesh_transform(&surface->mesh, stated->world);
    }
    for (size_t i = 0; stated->is_placed && i < surface->parts.count; i++) {
        mesh_transform(&surface->parts.parts[i].mesh, stated->world);
    }
}

/* Reads a file in which each object is an area. */
static void read_objects(struct job *job, struct surface *out, const char *path, const struct statement *stated)
{
    mesh_foreign_objects(job, &out->parts, &out->labels.table, path, stated->space);
    out->name = mesh_name(job, path);
    out->source = job_format(job, "the name in %s", path);
}

/* Reads a surface that the labels of its vertices cut into areas: those of options->labels, else of its own file. One
 * without labels stays whole. */
static void read_surface(struct job *job, struct surface *out, const char *path, const struct statement *stated,
                         const conus_load_options *options)
{
    const struct mesh_file_options file_options = {.space = stated->space};
    const struct mesh_file_options label_options = {.is_made_of = options->labels != NULL, .surface = path};
    const char *labels = options->labels ? options->labels : path;
    struct vertex_labels *vertices = &out->labels;
    surface_read(job, &out->mesh, &out->about, path, &file_options);
    surface_labels_read(job, vertices, labels, &label_options);
    if (!options->labels && !vertices->count) {
        label_table_finish(&vertices->table); /* of labels that no vertex has */
        out->name = out->about.name ? out->about.name : mesh_name(job, path);
        out->source = job_format(job, "the name in %s", labels);
        return;
    }
    out->source = job_format(job, "labels of vertices in %s", labels);
    mesh_file_match_sides(job, out->about.hemisphere, path, vertices->hemisphere, labels);
    vertex_labels_extend(job, vertices, out->mesh.vertex_count);
    if (vertices->count != out->mesh.vertex_count) {
        job_bad(job, "%s: labels of %zu vertices, the surface %s has %zu", labels, vertices->count, path,
                out->mesh.vertex_count);
    }
    (void)JOB_CALL(job, mesh_split(&out->parts, &out->mesh, vertices->labels, &job->notes));
    mesh_finish(&out->mesh);
}

static void add_area(struct load *load, const struct surface *surface, uint32_t number, struct mesh *mesh)
{
    char digits[LABEL_DIGITS];
    const struct label *known = label_table_find(&surface->labels.table, number);
    struct label label = known ? *known : (struct label){.number = number};
    label.name = label.name ? label.name : surface->name;
    label.abbreviation = NULL;
    label.hemisphere = surface->about.hemisphere ? surface->about.hemisphere : surface->labels.hemisphere;
    const conus_object area = label_object(&label, load->atlas->object_count, digits);
    (void)JOB_CALL(&load->job, atlas_add_mesh(load->atlas, &area, mesh));
}

/* Notes labels of vertices without a name, and names without a triangle, which are no areas, since an area has a
 * shape. */
static void note_missing(struct job *job, const struct surface *surface)
{
    enum { SHOWN = 4 };
    const struct label_table *table = &surface->labels.table;
    const char *names = "";
    size_t count = 0;
    for (size_t i = 0; surface->labels.count && i < surface->parts.count; i++) {
        const struct label *label = label_table_find(table, surface->parts.parts[i].label);
        if (!(label && label->name) && count++ < SHOWN) {
            names = job_format(job, "%s%s%u", names, count > 1 ? ", " : "", surface->parts.parts[i].label);
        }
    }
    if (count) {
        job_warn(job, "labels of vertices that their table does not name: %zu (%s%s)", count, names,
                 count > SHOWN ? ", ..." : "");
    }
    names = "";
    count = 0;
    for (size_t i = 0; i < table->count; i++) {
        const char *name = table->entries[i].name;
        if (name && !mesh_parts_find(&surface->parts, table->entries[i].number) && count++ < SHOWN) {
            names = job_format(job, "%s%s%s", names, count > 1 ? ", " : "", name);
        }
    }
    if (count) {
        job_note(job, "names without a triangle: %zu (%s%s)", count, names, count > SHOWN ? ", ..." : "");
    }
}

/* Loads the surface `path`: each part is an area, or the whole. */
static void load_surface(struct load *load, const char *path, const struct statement *stated)
{
    struct job *job = &load->job;
    const conus_load_options *options = load->options;
    struct surface *surface = job_new(job, struct surface);
    struct file_state state;
    if (!JOB_CALL(job, file_state_find(&state, path))) {
        return;
    }
    job_own(job, end_surface, surface);
    const struct format *format = source_format(job, path, ROLE_SURFACE);
    if (options->labels && !mesh_format_keeps_vertices(format)) {
        job_refuse(job, "%s: labels of vertices need a surface that numbers its vertices, as all formats but STL do",
                   path);
    } else if (!options->labels && mesh_format_is_foreign(format)) {
        read_objects(job, surface, path, stated);
    } else {
        read_surface(job, surface, path, stated, options);
    }
    place_surface(surface, stated);
    load_create(load, NULL, 0, NULL, surface->source);
    if (job_ok(job) && surface->mesh.vertex_count) {
        add_area(load, surface, 1, &surface->mesh);
    }
    for (size_t i = 0; i < surface->parts.count && job_ok(job); i++) {
        add_area(load, surface, surface->parts.parts[i].label, &surface->parts.parts[i].mesh);
    }
    note_missing(job, surface);
    (void)JOB_CALL(job, atlas_note_file(load->atlas, path, &state));
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
    "a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC, OME-Zarr), a surface, a folder of surfaces, a "
    "manifest (with the key \"conus_atlas\") or an FSL atlas XML";

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

/* Loads the atlas whose manifest.json is in `folder`. */
static void load_brainglobe(struct load *load, const char *folder)
{
    struct scene scene = {0};
    const char *root = "";
    plan_brainglobe(&load->job, &scene, &root, folder);
    scene_load(load, &scene, root, "terminology.csv");
}

static void load_folder(struct load *load, const char *path)
{
    struct job *job = &load->job;
    const char *whole = brainglobe_of_meshes(job, path); /* the folder whose meshes these are */
    const char *folder = whole ? whole : job_format(job, "%s%s", path, path_base(path)[0] ? "/" : "");
    struct scene scene;
    scene_of_folder(job, &scene, folder, whole != NULL);
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

static void load_file(struct load *load, const struct source *source, const char *path, const struct statement *stated)
{
    const enum format_id scene = source_scene(source);
    const bool is_surface = source->is_open && format_find(&source->head, ROLE_SURFACE);
    if (stated->space && (scene == FORMAT_MANIFEST || (source->is_open && !is_surface))) {
        job_fail(&load->job, CONUS_ERROR_ARGUMENT, "%s: space= is for surfaces, and this is none", path);
    } else if (scene == FORMAT_MANIFEST) {
        load_json(load, &source->file);
    } else if (scene == FORMAT_CIFTI) {
        load_cifti(load, path);
    } else if (scene == FORMAT_ATLAS_XML && is_probabilistic(&load->job, &source->file)) {
        probabilities_load(load, path);
    } else if (scene == FORMAT_ATLAS_XML || !is_surface) {
        load_volumes(load, source, path);
    } else {
        report_only_file(load, path);
        load_surface(load, path, stated);
    }
}

static void load_path(struct load *load, const char *path)
{
    struct job *job = &load->job;
    struct source source = {0};
    struct statement stated = {0};
    path = take_statement(job, &stated, path);
    const struct format *zarr = NULL;
    bool is_folder = file_is_folder(path);
    if (is_folder) {
        (void)JOB_CALL(job, source_find(&zarr, path, ROLE_VOLUME));
        is_folder = !zarr;
    }
    const bool may_be_brainglobe = is_folder || strcmp(path_base(path), "manifest.json") == 0;
    const char *brainglobe = may_be_brainglobe ? find_brainglobe(job, path) : NULL;
    if (brainglobe) {
        load_brainglobe(load, brainglobe);
    } else if (is_folder) {
        load_folder(load, path);
    } else if (JOB_CALL(job, source_open_atlas(&source, path))) {
        load_file(load, &source, path, &stated);
    }
    source_close(&source);
}

/* Warns of surfaces whose coordinates cannot be mm of a brain. */
static conus_status note_unit(conus_atlas *atlas)
{
    static const double most = 1000; /* of a brain in mm, */
    static const double least = 0.3; /* and of a brain in metres */
    static const double world[16] = {1, [5] = 1, [10] = 1, [15] = 1};
    double low[3];
    double high[3];
    double farthest = 0;
    if (!atlas->mesh_count || !atlas_area_bounds(low, high, atlas, world)) {
        return CONUS_OK;
    }
    for (int a = 0; a < 3; a++) {
        farthest = fmax(farthest, fmax(-low[a], high[a]));
    }
    return farthest > most    ? notes_warn(&atlas->notes,
                                           "areas reach %g mm from the origin: are the coordinates of their "
                                              "surfaces micrometres? They were taken as millimetres",
                                           farthest)
           : farthest < least ? notes_warn(&atlas->notes,
                                           "areas reach %g mm from the origin: are the coordinates of "
                                           "their surfaces metres? They were taken as millimetres",
                                           farthest)
                              : CONUS_OK;
}

/* Checks the whole atlas while the log still gets its notes. */
static conus_status check_whole(struct load *load, const char *path)
{
    conus_atlas *atlas = load->atlas;
    const double probability = load->options->probability;
    load->sink.path = path;
    if (probability > 0 && !atlas_has_probabilities(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "--probability %g: %s has no areas of probabilities", probability, path);
    }
    conus_status status = conflicting_sides_note(atlas);
    status = status ? status : note_unit(atlas);
    atlas->notes.sink = NULL;
    atlas->path = memory_text(path, strlen(path));
    return status || atlas->path ? status : CONUS_ERROR_MEMORY;
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
    (void)JOB_CALL(&load.job, check_whole(&load, path));
    return load_end(out, &load);
}
