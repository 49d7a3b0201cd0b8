/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_transform(): moves an atlas by an affine, a field, or a chain of both. */
#include "atlas/atlas.h"
#include "atlas/fit/area_points.h"
#include "atlas/placement.h"
#include "atlas/space.h"
#include "atlas/warp/warp.h"
#include "base/files/file_sums.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/transform/chain_file.h"
#include "loaders/transform/field_file.h"
#include "loaders/transform/transform_file.h"
#include "loaders/transform/transform_name.h"
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

/* Adds the images that the options name to the files that were read, except volumes of the atlas, whose sums it already
 * has. */
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

/* Warns where less than half of the atlas, not moved yet, lies in the grid of the matrix's image on the atlas's side:
 * that of `to`, or with `inverse` that of `from`. Both are given. Errors of reading its header. */
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

/* Moves the atlas by all fields, or not at all. */
static conus_status warp_along(conus_atlas *atlas, struct deformation *fields, size_t count,
                               const struct warp_plan *plan)
{
    conus_volume_info own;
    struct warp_plan whole = *plan;
    if (!plan->grid) {
        conus_status status = warp_grid(&own, atlas, fields, count);
        if (status) {
            return fail_in(status, plan->words);
        }
        whole.grid = &own;
    }
    return atlas_warp(atlas, fields, count, &whole);
}

/* Moves the atlas by all of a chain, or not at all. */
static conus_status move_along(conus_atlas *atlas, struct transform_chain *chain, const struct warp_plan *plan)
{
    return chain->count ? warp_along(atlas, chain->fields, chain->count, plan)
           : plan->grid ? atlas_move_onto(atlas, chain->matrix, plan)
                        : atlas_move(atlas, chain->matrix, plan->words);
}

static conus_status move_by_field(conus_atlas *atlas, const char *path, const conus_transform_options *options,
                                  const struct warp_plan *plan, struct file_sums *read)
{
    struct deformation field = {0};
    conus_status status = field_file_read(&field, path, options, read, &atlas->notes);
    status = status ? status : transform_images_sum(read, atlas, options);
    status = status ? status : file_sums_move(&atlas->files, read);
    status = status ? status : warp_along(atlas, &field, 1, plan);
    deformation_finish(&field);
    return status;
}

static bool is_of_mni(const conus_atlas *atlas)
{
    bool is = false;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const conus_volume_info *info = &atlas->volumes[i].info;
        is = is || info->space_code == SPACE_MNI || (info->path && strstr(info->path, "MNI"));
    }
    return is;
}

/* Between which spaces a file moves points, by its name. */
static bool find_way(struct text *from, struct text *to, const char *path, bool inverse)
{
    return inverse ? transform_name_points(to, from, path) : transform_name_points(from, to, path);
}

/* The trap of BIDS names: a file that moves images from the patient to the MNI moves points the other way. */
static conus_status note_direction(conus_atlas *atlas, const char *path, bool inverse)
{
    struct text from;
    struct text to;
    struct text next;
    struct text last;
    const char *behind = atlas->last_transform;
    if (!find_way(&from, &to, path, inverse)) {
        return CONUS_OK;
    }
    if (behind && find_way(&next, &last, behind, atlas->last_is_inverse) && text_compare(to, next) != 0) {
        return notes_warn(&atlas->notes,
                          "%s: by its name it moves points to %.*s, but %s, which is behind it, takes them from %.*s",
                          path, TEXT_SHOW(to, 40), behind, TEXT_SHOW(next, 40));
    }
    if (is_of_mni(atlas) && transform_name_is_mni(from) && !transform_name_is_mni(to)) {
        return notes_warn(&atlas->notes,
                          "%s: by its name it moves points of %.*s to %.*s, but the atlas is in the MNI's space: for "
                          "poses in %.*s the file of the other direction is needed",
                          path, TEXT_SHOW(from, 40), TEXT_SHOW(to, 40), TEXT_SHOW(to, 40));
    }
    return notes_add(
        &atlas->notes,
        "%s: by its name it moves points of %.*s to %.*s: it is for poses in the first and an atlas in the "
        "second",
        path, TEXT_SHOW(from, 40), TEXT_SHOW(to, 40));
}

/* Two files of one registration by ANTs, by their names: an image is moved by the affine and then by the warp, so
 * points go through 1Warp and then the affine, or the whole way back. */
static conus_status note_pair(conus_atlas *atlas, const char *path, bool inverse)
{
    const char *behind = atlas->last_transform;
    struct text of[2];
    enum ants_kind first = transform_name_ants(&of[0], path);
    enum ants_kind then = behind ? transform_name_ants(&of[1], behind) : ANTS_NONE;
    if (!first || !then || text_compare(of[0], of[1]) != 0) {
        return CONUS_OK;
    }
    if (first == ANTS_COMPOSITE || then == ANTS_COMPOSITE) {
        return notes_warn(&atlas->notes,
                          "%s and then %s: by its name a composite of ANTs has the other file's step, too", path,
                          behind);
    }
    bool back = first == ANTS_AFFINE && inverse && then == ANTS_INVERSE_WARP;
    bool forth = first == ANTS_WARP && then == ANTS_AFFINE && !atlas->last_is_inverse;
    if (back || forth || (first == ANTS_AFFINE && then == ANTS_AFFINE)) {
        return CONUS_OK;
    }
    return notes_warn(
        &atlas->notes,
        "points go through %s%s and then %s%s, which by their names do not fit together: of ANTs they go "
        "through 0GenericAffine.mat,inverse and then 1InverseWarp.nii.gz, or through 1Warp.nii.gz and then "
        "0GenericAffine.mat",
        path, inverse ? ",inverse" : "", behind, atlas->last_is_inverse ? ",inverse" : "");
}

/* Moves it by an affine, a B-spline or, from HDF5, a chain. */
static conus_status move_by_chain(conus_atlas *atlas, const char *path, bool is_hdf5,
                                  const conus_transform_options *options, const struct warp_plan *plan,
                                  struct file_sums *read)
{
    struct transform_chain chain = {0};
    if (is_hdf5 && (options->from || options->to || options->vectors || options->space)) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "%s: from, to, relative and absolute are for files of FSL, ITK and SPM that are not HDF5, and so is "
            "space",
            path);
    }
    if (options->vectors || options->space) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "%s: relative and absolute are for deformation fields, as space is, and this is none", path);
    }
    conus_status status = is_hdf5 ? chain_file_read(&chain, path, options->max_memory, read, &atlas->notes)
                                  : transform_file_read(&chain, path, options, read);
    if (!status && options->inverse && chain.count) {
        status = fail(
            CONUS_ERROR_UNSUPPORTED,
            is_hdf5
                ? "%s: a chain with a deformation field is not inverted; the file of the other direction is needed: "
                  "InverseComposite.h5 for Composite.h5 (ANTs), from-B_to-A for from-A_to-B (fMRIPrep)"
                : "%s: a B-spline is not inverted; that of the other direction is needed",
            path);
    } else if (!status && options->inverse) {
        (void)mat4_invert_affine(chain.matrix, chain.matrix); /* which the reader has tried */
    }
    status = status || !options->from ? status : transform_images_note(atlas, options);
    status = status ? status : transform_images_sum(read, atlas, options);
    status = status ? status : file_sums_move(&atlas->files, read);
    status = status ? status : move_along(atlas, &chain, plan);
    transform_chain_finish(&chain);
    return status;
}

conus_status conus_atlas_transform(conus_atlas *atlas, const char *path, const conus_transform_options *options)
{
    struct file_sums read = {0};
    conus_volume_info grid;
    bool is_field = false;
    bool is_chain = false;
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
    status = status || is_field ? status : chain_file_is(&is_chain, path);
    if (!status && options->transform && (is_field || is_chain)) {
        status = fail(CONUS_ERROR_ARGUMENT, "%s: transform is for lists in ITK's text, and this is none", path);
    }
    char *name = memory_text(path, strlen(path));
    status = status || name ? status : CONUS_ERROR_MEMORY;
    status = status ? status : note_direction(atlas, path, options->inverse);
    status = status ? status : note_pair(atlas, path, options->inverse);
    status = status     ? status
             : is_field ? move_by_field(atlas, path, options, &plan, &read)
                        : move_by_chain(atlas, path, is_chain, options, &plan, &read);
    if (status) {
        file_sums_cut(&atlas->files, file_count);
        notes_cut(&atlas->notes, note_count);
        memory_free(name);
    } else {
        memory_free(atlas->last_transform);
        atlas->last_transform = name;
        atlas->last_is_inverse = options->inverse;
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
