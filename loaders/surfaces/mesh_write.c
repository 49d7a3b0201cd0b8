/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_write_meshes(): one file per area. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/child/mesh_extract.h"
#include "loaders/surfaces/surfaces.h"

#include <string.h>

enum { SMOOTH_LIMIT = 1000, NAME_LIMIT = 200 };

static const char unknown_space[] = "NIFTI_XFORM_UNKNOWN";

struct writing {
    const conus_atlas *atlas;
    const char *folder;
    const conus_mesh_options *options;
    const char *space;
    struct buffer bytes; /* of a file, again and again */
    size_t done, total;
};

/* GIFTI's word for the space into which the voxels' transform leads, by NIfTI's code for it. */
static const char *space_of_volume(const conus_volume_info *info)
{
    static const char *const words[] = {"NIFTI_XFORM_SCANNER_ANAT", "NIFTI_XFORM_ALIGNED_ANAT", "NIFTI_XFORM_TALAIRACH",
                                        "NIFTI_XFORM_MNI_152"};
    static const char mark[] = "code ";
    const char *code = strstr(info->transform, mark);
    size_t index = code ? (size_t)(unsigned char)code[sizeof mark - 1] - '1' : SIZE_MAX;
    return index < sizeof words / sizeof words[0] ? words[index] : unknown_space;
}

/* The common space of all volumes of labels, if they have one. */
static const char *space_of(const conus_atlas *atlas)
{
    size_t count = atlas_parcellation_count(atlas);
    const char *space = count ? space_of_volume(&atlas->volumes[0].info) : unknown_space;
    for (size_t i = 1; i < count; i++) {
        space = strcmp(space, space_of_volume(&atlas->volumes[i].info)) == 0 ? space : unknown_space;
    }
    return space;
}

/* "folder/37_Hippocampus_L.gii"; what a file's name should not hold becomes "_". */
static conus_status file_name(struct buffer *out, const struct writing *work, const conus_object *area)
{
    buffer_format(out, "%s/%u_", work->folder, area->label);
    size_t length = strlen(area->name);
    if (length > NAME_LIMIT) {
        for (length = NAME_LIMIT; length && ((unsigned char)area->name[length] & 0xc0) == 0x80;) {
            length--;
        }
    }
    for (size_t i = 0; i < length; i++) {
        char c = area->name[i];
        bool keep = (unsigned char)c > ' ' && c != 0x7f && !strchr("/\\:*?\"<>|", c);
        buffer_append(out, keep ? &c : "_", 1);
    }
    buffer_format(out, ".%s", mesh_format_ending(work->options->format));
    return buffer_status(out);
}

static conus_status write_mesh(void *user, uint32_t number, const struct mesh *mesh)
{
    struct writing *work = user;
    const conus_object *area = conus_atlas_object(work->atlas, number);
    struct mesh_title title = {.label = area->label, .name = area->name, .space = work->space};
    struct buffer path = {0};
    memcpy(title.rgb, area->rgb, sizeof title.rgb);
    conus_status status = file_name(&path, work, area);
    if (!status) {
        work->bytes.size = 0;
        status = mesh_format(&work->bytes, mesh, &title, work->options->format);
        status = status ? fail_in(status, path.data) : file_write_soon(path.data, work->bytes.data, work->bytes.size);
    }
    buffer_finish(&path);
    work->done++;
    const conus_mesh_options *options = work->options;
    bool go_on = status || !options->progress || options->progress(options->progress_user, work->done, work->total);
    return go_on ? status : fail(CONUS_ERROR_CANCELLED, "cancelled after %zu of %zu surfaces", work->done, work->total);
}

static conus_status write_surfaces(struct writing *work, struct notes *notes)
{
    const conus_mesh_options *options = work->options;
    const struct mesh_extract_options extract = {.iterations = options->no_smoothing ? 0
                                                               : options->smooth     ? options->smooth
                                                                                     : MESH_DEFAULT_SMOOTH,
                                                 .pass_band = options->pass_band > 0 ? options->pass_band
                                                                                     : MESH_DEFAULT_PASS_BAND,
                                                 .reduction = options->decimate,
                                                 .max_memory = memory_limit(options->max_memory)};
    return mesh_extract(work->atlas, &extract, write_mesh, work, notes);
}

/* Counts the areas that get a file; a note counts the others. */
static conus_status count_files(struct writing *work, struct notes *notes)
{
    size_t empty = 0;
    for (size_t i = 0; i < work->atlas->area_count; i++) {
        const conus_object *area = &work->atlas->objects[i];
        bool hidden = work->atlas->places[i].is_hidden;
        work->total += !hidden && (area->voxels > 0 || area->triangles > 0);
        empty += !hidden && !area->voxels && !area->triangles;
    }
    return empty ? notes_add(notes, "%zu areas without voxels get no mesh", empty) : CONUS_OK;
}

static conus_status check_arguments(const conus_atlas *atlas, const char *folder, const conus_mesh_options *options)
{
    if (!atlas || !folder) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_write_meshes: an atlas and a folder are needed");
    }
    if (!mesh_format_ending(options->format)) {
        return fail(CONUS_ERROR_ARGUMENT, "format: %d, allowed are 0 to %d", (int)options->format, CONUS_MESH_STL);
    }
    if (options->smooth > SMOOTH_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "smooth: %u iterations, allowed are 1 to %d", options->smooth, SMOOTH_LIMIT);
    }
    if (!(options->pass_band >= 0 && options->pass_band <= 2)) {
        return fail(CONUS_ERROR_ARGUMENT, "pass_band: %g, allowed is 0 (default) to 2", options->pass_band);
    }
    if (!(options->decimate >= 0 && options->decimate < 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "decimate: %g, allowed is 0 or more and less than 1", options->decimate);
    }
    return CONUS_OK;
}

conus_status conus_atlas_write_meshes(const conus_atlas *atlas, const char *folder, const conus_mesh_options *options)
{
    struct writing work = {.atlas = atlas, .folder = folder, .options = options_of(conus_mesh_options, options)};
    const struct note_sink sink = {work.options->log, work.options->log_user, NULL};
    struct notes notes = {.sink = &sink};
    conus_status status = check_arguments(atlas, folder, work.options);
    if (status) {
        return status;
    }
    work.space = space_of(atlas);
    status = file_make_folder(folder);
    status = status ? status : count_files(&work, &notes);
    for (uint32_t i = 0; !status && i < atlas->area_count; i++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, i + 1);
        status = mesh ? write_mesh(&work, i + 1, mesh) : CONUS_OK;
    }
    status = status ? status : write_surfaces(&work, &notes);
    notes_finish(&notes);
    buffer_finish(&work.bytes);
    return status;
}
