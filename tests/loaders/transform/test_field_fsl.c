/* SPDX-License-Identifier: BSD-3-Clause */
/* FSL's deformation fields and the images that they need. tests/cli/warp.bats moves atlases by them. */
#include "atlas/deformation/deformation.h"
#include "builders/nifti_builder.h"
#include "loaders/transform/transform.h"
#include "test.h"

#include <string.h>

enum { NX = 20, NY = 10, NZ = 11 };

/* Voxels of 1 mm and value 0: one volume of a mask, or three of a field. */
static const char *write_image(const char *name, const double srow[12], size_t volumes)
{
    struct nifti_builder builder;
    const int64_t dim[3] = {NX, NY, NZ};
    nifti_begin(&builder, 1, false, volumes == 3 ? 16 : 2, dim);
    for (size_t i = 0; i < 12; i++) {
        nifti_set(&builder, "srow", i, srow[i]);
    }
    for (size_t i = 0; i < 3; i++) {
        nifti_set(&builder, "pixdim", i + 1, 1);
    }
    nifti_set(&builder, "dim", 0, volumes == 3 ? 4 : 3);
    nifti_set(&builder, "dim", 4, (double)volumes);
    for (size_t i = 0; i < volumes * NX * NY * NZ; i++) {
        nifti_voxel(&builder, 0);
    }
    const char *path = write_bytes(name, &builder.bytes);
    buffer_finish(&builder.bytes);
    return path;
}

/* The field's x runs to the left, so that FSL's mm are its voxels, and its corner (20, 10, 11) is at (-20, 10, 11) mm.
 * The image's x and y are exchanged. With the shift (-30, -10) its corner lies there, too, and the corners (0, 0, 0)
 * lie at (0, 0, 0) and (-30, -10, 0): sqrt(1000) mm apart, more than any others. With the shift (0, 0) they share the
 * first corner, and that at (20, 10) is as far off. */
static void fsl_images_are_compared_at_all_corners(void **state)
{
    (void)state;
    const char *path = write_image("field.nii", (const double[]){-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 3);
    const double shifts[2][2] = {{-30, -10}, {0, 0}};
    for (size_t i = 0; i < 2; i++) {
        const double srow[12] = {0, 1, 0, shifts[i][0], 1, 0, 0, shifts[i][1], 0, 0, 1, 0};
        const char *image = write_image("image.nii", srow, 1);
        const conus_transform_options options = {.from = image, .to = image};
        struct transform_chain chain;
        struct job job = {0};
        transform_read(&job, &chain, source_open(&job, path), &options);
        assert_fails(job_close(&job, NULL, NULL), CONUS_ERROR_ARGUMENT);
        if (!strstr(conus_message(), "lies up to 31.6 mm from where the field does")) {
            fail_msg("%s", conus_message());
        }
        transform_chain_finish(&chain);
    }
}

TEST_GROUP(field_fsl)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fsl_images_are_compared_at_all_corners),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
