/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_write_meshes(): one file per area. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/extraction/mesh_extract.h"
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
static const char *file_name(struct job *job, const struct writing *work, const conus_object *area)
{
    size_t length = strlen(area->name);
    if (length > NAME_LIMIT) {
        for (length = NAME_LIMIT; length && ((unsigned char)area->name[length] & 0xc0) == 0x80;) {
            length--;
        }
    }
    char *name =
        job_format(job, "%u_%.*s.%s", area->label, (int)length, area->name, mesh_format_ending(work->options->format));
    for (char *c = name; *c; c++) {
        *c = (unsigned char)*c > ' ' && *c != 0x7f && !strchr("/\\:*?\"<>|", *c) ? *c : '_';
    }
    return job_format(job, "%s/%s", work->folder, name);
}

static void write_mesh(struct job *job, void *user, uint32_t number, const struct mesh *mesh)
{
    struct writing *work = user;
    const conus_mesh_options *options = work->options;
    const conus_object *area = conus_atlas_object(work->atlas, number);
    struct mesh_title title = {.label = area->label, .name = area->name, .space = work->space};
    memcpy(title.rgb, area->rgb, sizeof title.rgb);
    const struct job_mark mark = job_mark(job);
    const char *path = file_name(job, work, area);
    const size_t place = job_in(job, path, JOB_ALONE);
    work->bytes.size = 0;
    (void)JOB_CALL(job, mesh_format(&work->bytes, mesh, &title, options->format));
    job_out(job, place);
    (void)JOB_CALL(job, file_write_soon(path, work->bytes.data, work->bytes.size));
    job_release(job, mark);
    work->done++;
    if (job_ok(job) && options->progress && !options->progress(options->progress_user, work->done, work->total)) {
        job_fail(job, CONUS_ERROR_CANCELLED, "cancelled after %zu of %zu surfaces", work->done, work->total);
    }
}

/* Counts the areas that get a file; a note counts the others. */
static void count_files(struct job *job, struct writing *work)
{
    size_t empty = 0;
    for (size_t i = 0; i < work->atlas->area_count; i++) {
        const conus_object *area = &work->atlas->objects[i];
        bool hidden = work->atlas->places[i].is_hidden;
        work->total += !hidden && (area->voxels > 0 || area->triangles > 0);
        empty += !hidden && !area->voxels && !area->triangles;
    }
    if (empty) {
        job_note(job, "%zu areas without voxels get no mesh", empty);
    }
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
    options = options_of(conus_mesh_options, options);
    const struct note_sink sink = {options->log, options->log_user, NULL};
    const struct mesh_extract_options extract = {.iterations = options->no_smoothing ? 0
                                                               : options->smooth     ? options->smooth
                                                                                     : MESH_DEFAULT_SMOOTH,
                                                 .pass_band = options->pass_band > 0 ? options->pass_band
                                                                                     : MESH_DEFAULT_PASS_BAND,
                                                 .reduction = options->decimate,
                                                 .max_memory = memory_limit(options->max_memory)};
    conus_status status = check_arguments(atlas, folder, options);
    if (status) {
        return status;
    }
    struct job job = {.sink = &sink};
    struct writing work = {.atlas = atlas, .folder = folder, .options = options, .space = space_of(atlas)};
    if (JOB_CALL(&job, file_make_folder(folder))) {
        count_files(&job, &work);
    }
    for (uint32_t i = 0; job_ok(&job) && i < atlas->area_count; i++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, i + 1);
        if (mesh) {
            write_mesh(&job, &work, i + 1, mesh);
        }
    }
    mesh_extract(&job, atlas, &extract, write_mesh, &work);
    buffer_finish(&work.bytes);
    return job_close(&job, NULL, NULL);
}
