/* SPDX-License-Identifier: BSD-3-Clause */
/* Is the image of an FSL matrix one of the atlas's space? And which images were read? */
#include "loaders/scene/transform_images.h"

#include "atlas/fit/area_points.h"
#include "loaders/volumes/volume_file.h"

#include <string.h>

static conus_status note_share(conus_atlas *atlas, const struct volume *image, const char *word)
{
    struct area_points points = {0};
    size_t inside = 0;
    conus_status status = area_points_make(&points, atlas);
    for (size_t i = 0; i < points.count; i++) {
        size_t voxel;
        inside += volume_find_voxel(&voxel, image, points.at + 3 * i);
    }
    if (!status && 2 * inside < points.count) {
        status = notes_warn(&atlas->notes, "%.0f %% of the atlas is in the grid of %s: is %s= the image of its space?",
                            100 * (double)inside / (double)points.count, image->info.path, word);
    }
    area_points_finish(&points);
    return status;
}

static bool is_volume(const conus_atlas *atlas, const char *path)
{
    bool is = false;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const char *own = atlas->volumes[i].info.path;
        is = is || (own && strcmp(own, path) == 0);
    }
    return is;
}

conus_status transform_images_sum(struct file_sums *out, const conus_atlas *atlas,
                                  const conus_transform_options *options)
{
    const char *paths[] = {options->from, options->to, options->grid};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < sizeof paths / sizeof paths[0] && !status; i++) {
        struct bytes content = {0};
        if (paths[i] && !is_volume(atlas, paths[i])) {
            status = file_read(&content, paths[i], UINT64_MAX);
            status = status ? status : file_sums_add(out, paths[i], &content);
        }
        bytes_finish(&content);
    }
    return status;
}

conus_status transform_images_note(conus_atlas *atlas, const conus_transform_options *options)
{
    const char *path = options->inverse ? options->from : options->to;
    conus_volume_info info = {0};
    struct volume image = {0};
    conus_status status = volume_file_header(&info, path);
    info.path = path;
    status = status ? status : volume_init(&image, &info);
    status = status ? status : note_share(atlas, &image, options->inverse ? "from" : "to");
    volume_finish(&image);
    return status;
}
