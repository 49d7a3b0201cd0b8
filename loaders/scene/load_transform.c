/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_transform(): an atlas goes to where a transform says. */
#include "atlas/placement.h"
#include "base/math3.h"
#include "base/options.h"
#include "loaders/transform/transform_file.h"

#include <string.h>

conus_status conus_atlas_transform(conus_atlas *atlas, const char *path, const conus_transform_options *options)
{
    struct file_sums read = {0};
    double atlas_from_world[16];
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_transform: an atlas and a path are needed");
    }
    options = options_of(conus_transform_options, options);
    size_t file_count = atlas->files.count;
    conus_status status = transform_file_read(atlas_from_world, path, options->from, options->to, &read);
    if (!status && options->inverse) {
        (void)mat4_invert_affine(atlas_from_world, atlas_from_world); /* which the reader has tried */
    }
    status = status ? status : file_sums_move(&atlas->files, &read);
    status = status ? status : atlas_move(atlas, atlas_from_world, path);
    if (status) {
        file_sums_cut(&atlas->files, file_count);
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
