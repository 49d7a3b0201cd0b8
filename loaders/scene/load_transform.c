/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_transform(): moves an atlas by an affine, a field, or a chain of both. */
#include "loaders/scene/parts.h"

#include "atlas/atlas.h"
#include "atlas/fit/fit.h"
#include "atlas/space.h"
#include "atlas/warp/warp.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/maps/maps.h"
#include "loaders/transform/transform.h"
#include "loaders/volumes/volumes.h"

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
static void sum_images(struct job *job, const conus_atlas *atlas, const conus_transform_options *options)
{
    const char *paths[] = {options->from, options->to, options->grid};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        struct bytes content = {0};
        if (paths[i] && !has_volume(atlas, paths[i]) && JOB_CALL(job, file_read(&content, paths[i], UINT64_MAX))) {
            job_made_of(job, paths[i], &content);
        }
        bytes_finish(&content);
    }
}

/* Warns where less than half of the atlas, not moved yet, lies in the grid of the matrix's image on the atlas's side:
 * that of `to`, or with `inverse` that of `from`. Both are given. Errors of reading its header. */
static void warn_of_image(struct job *job, const conus_atlas *atlas, const conus_transform_options *options)
{
    const char *path = options->inverse ? options->from : options->to;
    conus_volume_info info = {0};
    struct volume image = {0};
    struct area_points points = {0};
    size_t inside = 0;
    volume_header_read(job, &info, path);
    info.path = path;
    (void)JOB_CALL(job, volume_init(&image, &info));
    (void)JOB_CALL(job, area_points_make(&points, atlas));
    for (size_t i = 0; i < points.count; i++) {
        size_t voxel;
        inside += volume_find_voxel(&voxel, &image, points.at + 3 * i);
    }
    if (2 * inside < points.count) {
        job_warn(job, "%.0f %% of the atlas is in the grid of %s: is %s= the image of its space?",
                 100 * (double)inside / (double)points.count, path, options->inverse ? "from" : "to");
    }
    area_points_finish(&points);
    volume_finish(&image);
}

/* Moves the atlas by all fields, or not at all. */
static void warp_along(struct job *job, conus_atlas *atlas, struct deformation *fields, size_t count,
                       const struct warp_plan *plan)
{
    conus_volume_info own;
    struct warp_plan whole = *plan;
    if (!plan->grid) {
        size_t place = job_in(job, plan->words, JOB_ALONE);
        (void)JOB_CALL(job, warp_grid(&own, atlas, fields, count));
        job_out(job, place);
        whole.grid = &own;
    }
    (void)JOB_CALL(job, atlas_warp(atlas, fields, count, &whole));
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
static void note_direction(struct job *job, const conus_atlas *atlas, const char *path, bool inverse)
{
    struct text from;
    struct text to;
    struct text next;
    struct text last;
    const char *behind = atlas->last_transform;
    if (!find_way(&from, &to, path, inverse)) {
        return;
    }
    if (behind && find_way(&next, &last, behind, atlas->last_is_inverse) && text_compare(to, next) != 0) {
        job_warn(job, "%s: by its name it moves points to %.*s, but %s, which is behind it, takes them from %.*s", path,
                 TEXT_SHOW(to, 40), behind, TEXT_SHOW(next, 40));
    } else if (is_of_mni(atlas) && transform_name_is_mni(from) && !transform_name_is_mni(to)) {
        job_warn(job,
                 "%s: by its name it moves points of %.*s to %.*s, but the atlas is in the MNI's space: for poses in "
                 "%.*s the file of the other direction is needed",
                 path, TEXT_SHOW(from, 40), TEXT_SHOW(to, 40), TEXT_SHOW(to, 40));
    } else {
        job_note(job,
                 "%s: by its name it moves points of %.*s to %.*s: it is for poses in the first and an atlas in the "
                 "second",
                 path, TEXT_SHOW(from, 40), TEXT_SHOW(to, 40));
    }
}

/* Two files of one registration by ANTs, by their names: an image is moved by the affine and then by the warp, so
 * points go through 1Warp and then the affine, or the whole way back. */
static void warn_of_pair(struct job *job, const conus_atlas *atlas, const char *path, bool inverse)
{
    const char *behind = atlas->last_transform;
    struct text of[2];
    enum ants_kind first = transform_name_ants(&of[0], path);
    enum ants_kind then = behind ? transform_name_ants(&of[1], behind) : ANTS_NONE;
    if (!first || !then || text_compare(of[0], of[1]) != 0) {
        return;
    }
    bool back = first == ANTS_AFFINE && inverse && then == ANTS_INVERSE_WARP;
    bool forth = first == ANTS_WARP && then == ANTS_AFFINE && !atlas->last_is_inverse;
    if (first == ANTS_COMPOSITE || then == ANTS_COMPOSITE) {
        job_warn(job, "%s and then %s: by its name a composite of ANTs has the other file's step, too", path, behind);
    } else if (!back && !forth && (first != ANTS_AFFINE || then != ANTS_AFFINE)) {
        job_warn(job,
                 "points go through %s%s and then %s%s, which by their names do not fit together: of ANTs they go "
                 "through 0GenericAffine.mat,inverse and then 1InverseWarp.nii.gz, or through 1Warp.nii.gz and then "
                 "0GenericAffine.mat",
                 path, inverse ? ",inverse" : "", behind, atlas->last_is_inverse ? ",inverse" : "");
    }
}

static void finish_chain(void *chain)
{
    transform_chain_finish(chain);
}

void transform_load(struct job *job, conus_atlas *atlas, const char *path, const conus_transform_options *options)
{
    conus_volume_info grid;
    struct transform_chain *chain = job_new(job, struct transform_chain);
    if (!chain) {
        return; /* there may be no atlas */
    }
    job_own(job, finish_chain, chain);
    const struct warp_plan plan = {
        .words = path, .grid = options->grid ? &grid : NULL, .max_memory = options->max_memory};
    if (options->grid) {
        volume_header_read(job, &grid, options->grid);
    }
    const size_t place = job_in(job, path, JOB_ALONE);
    struct source *source = source_open(job, path);
    job_out(job, place);
    note_direction(job, atlas, path, options->inverse);
    warn_of_pair(job, atlas, path, options->inverse);
    transform_read(job, chain, source, options);
    if (options->from && !chain->count) {
        warn_of_image(job, atlas, options);
    }
    sum_images(job, atlas, options);
    atlas_take(job, atlas);
    char *name = job_give(job, job_copy(job, text_from(path)), strlen(path) + 1);
    if (chain->count) {
        warp_along(job, atlas, chain->fields, chain->count, &plan);
    } else if (plan.grid) {
        (void)JOB_CALL(job, atlas_move_onto(atlas, chain->matrix, &plan));
    } else {
        (void)JOB_CALL(job, atlas_move(atlas, chain->matrix, path));
    }
    if (job_ok(job)) {
        char *before = atlas->last_transform;
        atlas->last_transform = name;
        atlas->last_is_inverse = options->inverse;
        name = before;
    }
    memory_free(name);
}

conus_status conus_atlas_transform(conus_atlas *atlas, const char *path, const conus_transform_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_transform: an atlas and a path are needed");
    }
    if (atlas->lacks_context) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the atlas was loaded without its context, which moves with it", path);
    }
    options = options_of(conus_transform_options, options);
    struct job job = {.max_memory = options->max_memory};
    const struct atlas_mark mark = atlas_mark(atlas);
    transform_load(&job, atlas, path, options);
    return atlas_close(&job, atlas, mark);
}

conus_status conus_atlas_move(conus_atlas *atlas, const double atlas_from_world[16])
{
    if (!atlas || !atlas_from_world) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_move: an atlas and a matrix are needed");
    }
    return atlas_move(atlas, atlas_from_world, "the program's matrix");
}
