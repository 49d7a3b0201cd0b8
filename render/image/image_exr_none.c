/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for images in files of OpenEXR, in a build without that library: each function says so. */
#include "render/image/image.h"

static conus_status refuse(void)
{
    return fail(CONUS_ERROR_UNSUPPORTED, "this build of conus leaves out OpenEXR");
}

conus_status image_format_exr(struct bytes *out, const conus_image *image)
{
    (void)out, (void)image;
    return refuse();
}

conus_status image_parse_exr(conus_image **out, const uint8_t *data, size_t size)
{
    (void)out, (void)data, (void)size;
    return refuse();
}
