/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_transform(): moves an atlas by an affine or a field. */
#include "atlas/atlas.h"
#include "atlas/fit/area_points.h"
#include "atlas/placement.h"
#include "atlas/warp/warp.h"
#include "base/files/file_sums.h"
#include "base/geometry/math3.h"
#include "base/options.h"
#include "loaders/transform/field_file.h"
#include "loaders/transform/transform_file.h"
#include "loaders/volumes/volume_file.h"

#include <string.h>

static bool has_volume(const conus_atlas *atlas, const char *path)
{
    bool is = false;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const char *own = atlas->volumes[i].info.path;
        is = is || (own && strcmp(own, path) == 0);
    }
    return is;
}

/* Adds the images that the options name to the files that were read, but for those that are a volume of atlas,
 * which has their sums. */
static conus_status transform_images_sum(struct file_sums *out, const conus_atlas *atlas,
                                         const conus_transform_options *options)
{
    const char *paths[] = {options->from, options->to, options->grid};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < sizeof paths / sizeof paths[0] && !status; i++) {
        struct bytes content = {0};
        if (paths[i] && !has_volume(atlas, paths[i])) {
            status = file_read(&content, paths[i], UINT64_MAX);
            status = status ? status : file_sums_add(out, paths[i], &content);
        }
        bytes_finish(&content);
    }
    return status;
}

/* Warns where less than half of atlas, which has not been moved yet, is in the grid of the image that the matrix
 * has in its space: that of `to`, or with `inverse` that of `from`. Both are given. Errors of reading its header. */
static conus_status transform_images_note(conus_atlas *atlas, const conus_transform_options *options)
{
    const char *path = options->inverse ? options->from : options->to;
    conus_volume_info info = {0};
    struct volume image = {0};
    struct area_points points = {0};
    size_t inside = 0;
    conus_status status = volume_file_header(&info, path);
    info.path = path;
    status = status ? status : volume_init(&image, &info);
    status = status ? status : area_points_make(&points, atlas);
    for (size_t i = 0; i < points.count; i++) {
        size_t voxel;
        inside += volume_find_voxel(&voxel, &image, points.at + 3 * i);
    }
    if (!status && 2 * inside < points.count) {
        status = notes_warn(&atlas->notes, "%.0f %% of the atlas is in the grid of %s: is %s= the image of its space?",
                            100 * (double)inside / (double)points.count, path, options->inverse ? "from" : "to");
    }
    area_points_finish(&points);
    volume_finish(&image);
    return status;
}

static conus_status move_by_affine(conus_atlas *atlas, const char *path, const conus_transform_options *options,
                                   const struct warp_plan *plan, struct file_sums *read)
{
    double atlas_from_world[16];
    if (options->vectors) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: vectors of a field are relative or absolute, and this is none", path);
    }
    conus_status status = transform_file_read(atlas_from_world, path, options->from, options->to, read);
    if (!status && options->inverse) {
        (void)mat4_invert_affine(atlas_from_world, atlas_from_world); /* which the reader has tried */
    }
    status = status || !options->from ? status : transform_images_note(atlas, options);
    status = status ? status : transform_images_sum(read, atlas, options);
    status = status ? status : file_sums_move(&atlas->files, read);
    if (status) {
        return status;
    }
    return plan->grid ? atlas_move_onto(atlas, atlas_from_world, plan) : atlas_move(atlas, atlas_from_world, path);
}

static conus_status move_by_field(conus_atlas *atlas, const char *path, const conus_transform_options *options,
                                  const struct warp_plan *plan, struct file_sums *read)
{
    struct deformation field = {0};
    conus_volume_info nodes;
    conus_status status = field_file_read(&field, &nodes, path, options, read, &atlas->notes);
    struct warp_plan own = *plan;
    own.grid = plan->grid ? plan->grid : &nodes;
    status = status ? status : transform_images_sum(read, atlas, options);
    status = status ? status : file_sums_move(&atlas->files, read);
    status = status ? status : atlas_warp(atlas, &field, &own);
    deformation_finish(&field);
    return status;
}

conus_status conus_atlas_transform(conus_atlas *atlas, const char *path, const conus_transform_options *options)
{
    struct file_sums read = {0};
    conus_volume_info grid;
    bool is_field = false;
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_transform: an atlas and a path are needed");
    }
    options = options_of(conus_transform_options, options);
    const struct warp_plan plan = {
        .words = path, .grid = options->grid ? &grid : NULL, .max_memory = options->max_memory};
    size_t file_count = atlas->files.count;
    size_t note_count = atlas->notes.count;
    conus_status status = options->grid ? volume_file_header(&grid, options->grid) : CONUS_OK;
    status = status ? status : field_file_is(&is_field, path);
    status = status ? status : (is_field ? move_by_field : move_by_affine)(atlas, path, options, &plan, &read);
    if (status) {
        file_sums_cut(&atlas->files, file_count);
        notes_cut(&atlas->notes, note_count);
    }
    file_sums_finish(&read);
    return status;
}

conus_status conus_atlas_move(conus_atlas *atlas, const double atlas_from_world[16])
{
    if (!atlas || !atlas_from_world) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_move: an atlas and a matrix are needed");
    }
    return atlas_move(atlas, atlas_from_world, "the program's matrix");
}
