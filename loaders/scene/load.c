/* SPDX-License-Identifier: BSD-3-Clause */
/* A volume, an FSL atlas XML, a manifest, a surface, CIFTI labels or a folder becomes an atlas. */
#include "loaders/scene/load.h"

#include "atlas/areas/sides.h"
#include "atlas/atlas.h"
#include "atlas/surface/mesh_split.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe_atlas.h"
#include "loaders/file_kind.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/manifest/manifest.h"
#include "loaders/manifest/manifest_surfaces.h"
#include "loaders/scene/load_manifest.h"
#include "loaders/scene/load_parcellation.h"
#include "loaders/scene/load_progress.h"
#include "loaders/scene/plan_brainglobe.h"
#include "loaders/scene/plan_cifti.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"
#include "loaders/surfaces/mesh_file.h"
#include "loaders/volumes/volume_zarr.h"

#include <stdio.h>
#include <string.h>

struct surface {
    struct mesh mesh;
    struct label about;
    struct vertex_labels labels;
    struct mesh_parts parts;
    struct notes notes;
    struct buffer source;
    struct file_sums read; /* labels that lie in a file of their own */
};

static void surface_finish(struct surface *surface)
{
    mesh_finish(&surface->mesh);
    label_finish(&surface->about);
    vertex_labels_finish(&surface->labels);
    mesh_parts_finish(&surface->parts);
    notes_finish(&surface->notes);
    buffer_finish(&surface->source);
    file_sums_finish(&surface->read);
}

/* Makes the whole surface one area, number 1. */
static conus_status take_whole(struct surface *surface)
{
    label_table_finish(&surface->labels.table); /* of labels that no vertex has */
    struct label *label = label_table_add(&surface->labels.table, 1);
    surface->parts.parts = memory_zeroed(1, sizeof *surface->parts.parts);
    if (!label || !surface->parts.parts) {
        return CONUS_ERROR_MEMORY;
    }
    label->name = surface->about.name ? surface->about.name : mesh_file_name(surface->mesh.path);
    surface->about.name = NULL;
    surface->parts.parts[0] = (struct mesh_part){1, surface->mesh};
    surface->parts.count = 1;
    surface->mesh = (struct mesh){0};
    return label->name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Reads a file in which each object is an area. */
static conus_status read_objects(struct surface *out, const char *path, const conus_load_options *options)
{
    const struct mesh_foreign_options foreign = {.max_memory = options->max_memory};
    conus_status status = mesh_foreign_objects(&out->parts, &out->labels.table, path, &foreign, &out->notes);
    for (size_t i = 0; !status && i < out->labels.table.count; i++) {
        struct label *label = &out->labels.table.entries[i];
        label->name = label->name ? label->name : mesh_file_name(path);
        status = label->name ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    buffer_format(&out->source, "the name in %s", path);
    return status ? status : buffer_status(&out->source);
}

static conus_status read_surface(struct surface *out, const char *path, const conus_load_options *options)
{
    const struct mesh_file_options file_options = {.max_memory = options->max_memory};
    struct mesh_file_options label_options = {.max_memory = options->max_memory};
    label_options.read = options->labels ? &out->read : NULL;
    label_options.surface = path;
    const char *labels = options->labels ? options->labels : path;
    if (options->labels && !mesh_file_keeps_vertices(path)) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "%s: labels of vertices need a surface that numbers its vertices, as all formats but STL do", path);
    }
    if (!options->labels && mesh_file_is_foreign(path)) {
        return read_objects(out, path, options);
    }
    conus_status status = mesh_file_read(&out->mesh, &out->about, path, &file_options, &out->notes);
    status = status ? status : vertex_labels_read(&out->labels, labels, &label_options, &out->notes);
    if (status) {
        return status;
    }
    bool whole = !options->labels && !out->labels.count;
    buffer_format(&out->source, whole ? "the name in %s" : "labels of vertices in %s", labels);
    status = buffer_status(&out->source);
    if (status || whole) {
        return status ? status : take_whole(out);
    }
    status = vertex_labels_extend(&out->labels, out->mesh.vertex_count);
    if (!status && out->labels.count != out->mesh.vertex_count) {
        return fail(CONUS_ERROR_DATA, "%s: labels of %zu vertices, the surface %s has %zu", labels, out->labels.count,
                    out->mesh.path, out->mesh.vertex_count);
    }
    return status ? status : mesh_split(&out->parts, &out->mesh, out->labels.labels, &out->notes);
}

static conus_status add_part(conus_atlas *atlas, const struct surface *surface, struct mesh_part *part)
{
    char digits[LABEL_DIGITS];
    const struct label *known = label_table_find(&surface->labels.table, part->label);
    char hemisphere = surface->about.hemisphere ? surface->about.hemisphere : surface->labels.hemisphere;
    struct label label = known ? *known : (struct label){.number = part->label};
    label.abbreviation = NULL;
    label.hemisphere = hemisphere;
    const conus_object area = label_object(&label, atlas->object_count, digits);
    return atlas_add_mesh(atlas, &area, &part->mesh);
}

/* Notes the names without a triangle. They are no areas, since an area has a shape. */
static conus_status note_missing(conus_atlas *atlas, const struct surface *surface)
{
    enum { SHOWN = 4 };
    struct buffer names = {0};
    size_t count = 0;
    for (size_t i = 0; i < surface->labels.table.count; i++) {
        const struct label *label = &surface->labels.table.entries[i];
        if (label->name && !mesh_parts_find(&surface->parts, label->number) && count++ < SHOWN) {
            buffer_format(&names, "%s%s", count > 1 ? ", " : "", label->name);
        }
    }
    conus_status status = buffer_status(&names);
    if (!status && count) {
        status = notes_add(&atlas->notes, "names without a triangle: %zu (%s%s)", count, names.data,
                           count > SHOWN ? ", ..." : "");
    }
    buffer_finish(&names);
    return status;
}

/* Loads the surface path: its areas are those of the labels of its vertices (options->labels, else in its own
 * file), or there is one, the whole. The atlas's notes keep the sink. */
static conus_status surface_load(conus_atlas **out, const char *path, const struct load_progress *progress)
{
    struct surface surface = {.notes.sink = &progress->sink};
    struct file_state state;
    conus_atlas *atlas = NULL;
    conus_status status = file_state_find(&state, path);
    status = status ? status : read_surface(&surface, path, progress->options);
    status = status ? status : atlas_create_empty(&atlas, surface.source.data);
    if (!status) {
        atlas->notes.sink = surface.notes.sink;
    }
    for (size_t i = 0; !status && i < surface.parts.count; i++) {
        status = add_part(atlas, &surface, &surface.parts.parts[i]);
    }
    status = status ? status : notes_move(&atlas->notes, &surface.notes);
    status = status ? status : note_missing(atlas, &surface);
    status = status ? status : atlas_note_file(atlas, path, &state);
    status = status ? status : file_sums_move(&atlas->files, &surface.read);
    surface_finish(&surface);
    return atlas_give(out, atlas, status);
}

/* Loads the .dlabel.nii path, which may choose a map, with the surfaces beside it. The atlas's notes keep the sink. */
static conus_status cifti_load(conus_atlas **out, const char *path, struct load_progress *progress)
{
    struct cifti_file file = {0};
    struct job job = {0}; /* Bridge: owns the manifest */
    struct manifest manifest = {0};
    struct notes notes = {.sink = &progress->sink};
    conus_atlas *atlas = NULL;
    uint64_t max_memory = progress->options->max_memory;
    if (progress->options->labels) {
        return fail(CONUS_ERROR_ARGUMENT, "--labels %s: %s names its labels itself", progress->options->labels, path);
    }
    conus_status status = cifti_file_open(&file, path, max_memory, &notes);
    status = status ? status : plan_cifti(&job, &manifest, &file, max_memory, &notes);
    char *file_path = file.path;
    file.path = NULL;
    cifti_file_finish(&file); /* before the surfaces need memory */
    status = status ? status : manifest_load_made(&atlas, &manifest, file_path, "the label table in it", progress);
    status = status ? status : notes_move(&atlas->notes, &notes);
    notes_finish(&notes);
    job_end(&job);
    memory_free(file_path);
    return atlas_give(out, atlas, status);
}

enum { JSON_LIMIT = 64 << 20 };

static const char atlas_needed[] =
    "a labelled volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC, OME-Zarr), a surface, a folder of surfaces, a "
    "manifest (with the key \"conus_atlas\") or an FSL atlas XML";

static conus_status load_labelled_volume(conus_atlas **out, const struct probe *probe, const char *path,
                                         const struct load_progress *progress)
{
    struct parcellation parts = {.notes.sink = &progress->sink};
    conus_atlas *atlas = NULL;
    conus_status status = parcellation_read_opened(&parts, probe, path, progress->options, atlas_needed);
    status = status ? status : parcellation_atlas(&atlas, &parts);
    status = status ? status : file_sums_move(&atlas->files, &parts.read);
    parcellation_finish(&parts);
    return atlas_give(out, atlas, status);
}

static conus_status report_only_file(struct load_progress *progress, const char *path)
{
    progress->total = 1;
    return load_progress_report(progress, path, 1);
}

/* Loads one volume of labels, or several of probabilities. */
static conus_status load_volumes(conus_atlas **out, const struct probe *probe, const char *path,
                                 struct load_progress *progress)
{
    struct named_maps maps = {0};
    conus_status status = named_maps_find(&maps, probe, path, progress->options);
    if (!status && maps.table.count) {
        status = named_maps_load(out, path, &maps, progress);
    } else if (!status) {
        status = report_only_file(progress, path);
        status = status ? status : load_labelled_volume(out, probe, path, progress);
    }
    named_maps_finish(&maps);
    return status;
}

static conus_status load_json(conus_atlas **out, const struct open_file *file, struct load_progress *progress)
{
    const char *path = file->path;
    struct bytes bytes = {0};
    conus_status status = file_read_open(&bytes, file, SIZE_MAX, JSON_LIMIT, "");
    if (!status && !manifest_is(text_from_bytes(bytes.data, bytes.size))) {
        status = fail_in(file_kind_fail(path, &bytes, atlas_needed), path);
    }
    status = status ? status : manifest_load(out, path, &bytes, progress);
    bytes_finish(&bytes);
    return status;
}

/* Notes that the stack of sides in a BrainGlobe folder is not used. */
static conus_status note_hemispheres(conus_atlas *atlas, const char *folder)
{
    char *path = file_beside(folder, "hemispheres.tiff");
    struct job job = {0}; /* Bridge */
    bool voxels = brainglobe_has_voxels(&job, folder);
    conus_status status = job_close(&job, NULL, NULL);
    status = status || path ? status : CONUS_ERROR_MEMORY;
    if (!status && voxels && file_exists(path)) {
        status = notes_add(&atlas->notes, "%s (1 is left, 2 is right) is not used: areas are of both sides", path);
    }
    memory_free(path);
    return status;
}

/* Finds the folder of BrainGlobe's third release that `path` means: the folder itself, the newest version in it, or the
 * folder of the manifest.json. NULL where there is none. It ends in '/'; the caller's to memory_free(). */
static conus_status find_brainglobe(char **out, const char *path)
{
    static const char manifest[] = "manifest.json";
    size_t length = strlen(path);
    struct buffer folder = {0};
    struct names versions = {0};
    bool is = false;
    if (strcmp(path_base(path), manifest) == 0) {
        length -= strlen(manifest);
        buffer_append(&folder, path, length);
        buffer_text(&folder, length ? "" : "./");
    } else {
        buffer_format(&folder, "%s%s", path, path[length - 1] == '/' ? "" : "/");
    }
    conus_status status = buffer_status(&folder);
    status = status ? status : brainglobe_atlas_is(&is, folder.data);
    if (!status && !is && length == strlen(path)) {
        status = brainglobe_versions(&versions, folder.data);
        if (!status && versions.count) {
            buffer_format(&folder, "%s/", versions.names[versions.count - 1]);
            status = buffer_status(&folder);
            is = true;
        }
    }
    names_finish(&versions);
    *out = !status && is ? folder.data : NULL;
    if (!*out) {
        buffer_finish(&folder);
    }
    return status;
}

/* Loads the atlas whose manifest.json is in `folder`. */
static conus_status load_brainglobe(conus_atlas **out, const char *folder, struct load_progress *progress)
{
    struct job job = {0}; /* Bridge: owns the manifest */
    struct manifest manifest = {0};
    struct file_sums read = {0};
    struct notes notes = {.sink = &progress->sink};
    conus_atlas *atlas = NULL;
    char *root = NULL;
    conus_status status = plan_brainglobe(&job, &manifest, &root, folder, &read, &notes);
    status = status ? status : manifest_load_made(&atlas, &manifest, root, "terminology.csv", progress);
    status = status ? status : notes_move(&atlas->notes, &notes);
    status = status ? status : file_sums_move(&atlas->files, &read);
    notes_finish(&notes);
    file_sums_finish(&read);
    job_end(&job);
    memory_free(root);
    return atlas_give(out, atlas, status);
}

static conus_status load_folder(conus_atlas **out, const char *path, struct load_progress *progress)
{
    struct job job = {0}; /* Bridge */
    conus_atlas *atlas = NULL;
    size_t length = strlen(path);
    const char *whole = brainglobe_of_meshes(&job, path); /* the folder whose meshes these are */
    const char *folder = whole ? whole : job_format(&job, "%s%s", path, path[length - 1] == '/' ? "" : "/");
    struct text text = manifest_of_folder(&job, folder, whole != NULL);
    const struct bytes bytes = {(uint8_t *)text.data, text.size};
    conus_status status =
        job_ok(&job) ? manifest_load(&atlas, folder, &bytes, progress) : fail(job.status, "%s", job.message);
    status = status || whole ? status : note_hemispheres(atlas, folder);
    job_end(&job);
    return atlas_give(out, atlas, status);
}

/* Whether the file is an FSL atlas of probabilities: the type Label is a parcellation. */
static conus_status is_probabilistic(bool *out, const struct open_file *file)
{
    struct bytes bytes = {0};
    struct job job = {0}; /* Bridge: to label tables on a job. */
    *out = false;
    if (file_read_open(&bytes, file, SIZE_MAX, FSL_ATLAS_LIMIT, "")) {
        return CONUS_OK; /* its reader says why it cannot be read */
    }
    const struct fsl_atlas *atlas = fsl_atlas_parse(&job, text_from_bytes(bytes.data, bytes.size));
    *out = job_ok(&job) && !atlas->is_label;
    conus_status status = job_close(&job, NULL, NULL);
    bytes_finish(&bytes);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

static conus_status load_opened(conus_atlas **out, const struct probe *probe, const char *path,
                                struct load_progress *progress)
{
    conus_status status = CONUS_OK;
    bool probabilistic = false;
    switch (probe->reader) {
    case READER_MANIFEST:
        return load_json(out, &probe->file, progress);
    case READER_CIFTI:
        return cifti_load(out, path, progress);
    case READER_ATLAS_XML:
        status = is_probabilistic(&probabilistic, &probe->file);
        return status          ? status
               : probabilistic ? probabilities_load(out, path, progress)
                               : load_volumes(out, probe, path, progress);
    case READER_VOLUME:
        if (!probe->is_open || !mesh_foreign_is(path)) {
            return load_volumes(out, probe, path, progress);
        }
        break;
    case READER_SURFACE:
        break;
    }
    status = report_only_file(progress, path);
    return status ? status : surface_load(out, path, progress);
}

/* Checks the whole atlas while the log still gets its notes. */
static conus_status check_whole(conus_atlas *atlas, const char *path, struct load_progress *progress)
{
    const double probability = progress->options->probability;
    progress->sink.path = path;
    if (probability > 0 && !atlas_has_probabilities(atlas)) {
        return fail(CONUS_ERROR_ARGUMENT, "--probability %g: %s has no areas of probabilities", probability, path);
    }
    conus_status status = swapped_sides_note(atlas);
    atlas->notes.sink = NULL;
    atlas->path = memory_text(path, strlen(path));
    return status || atlas->path ? status : CONUS_ERROR_MEMORY;
}

conus_status atlas_load_files(conus_atlas **out, const char *path, const conus_load_options *options)
{
    conus_atlas *atlas = NULL;
    if (!(options->probability >= 0 && options->probability <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "--probability: is %g, allowed is above 0 to 1 (0 = default)",
                    options->probability);
    }
    struct load_progress progress = load_progress_of(path, options);
    struct probe probe = {0};
    char *brainglobe = NULL;
    bool is_folder = file_is_folder(path) && !volume_zarr_is(path);
    conus_status status = CONUS_OK;
    if (is_folder || strcmp(path_base(path), "manifest.json") == 0) {
        status = find_brainglobe(&brainglobe, path);
    }
    if (status || brainglobe) {
        status = status ? status : load_brainglobe(&atlas, brainglobe, &progress);
    } else if (is_folder) {
        status = load_folder(&atlas, path, &progress);
    } else {
        status = probe_open(&probe, path);
        status = status ? status : load_opened(&atlas, &probe, path, &progress);
        probe_close(&probe);
    }
    memory_free(brainglobe);
    status = status ? status : check_whole(atlas, path, &progress);
    load_progress_finish(&progress);
    return atlas_give(out, atlas, status);
}
