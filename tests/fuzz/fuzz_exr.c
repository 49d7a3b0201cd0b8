/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenEXR: an image that is read can be written again, and is then the same. */
#include "conus/own.h"
#include "render/image/image.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void write_again(const conus_image *image)
{
    struct bytes bytes;
    conus_image *back = NULL;
    conus_image_difference difference;
    if (image_format_exr(&bytes, image)) {
        abort();
    }
    if (image_parse_exr(&back, bytes.data, bytes.size) || conus_image_compare(&difference, image, back, 0) ||
        difference.differing || back->attribute_count != image->attribute_count) {
        abort();
    }
    conus_image_destroy(back);
    bytes_finish(&bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    conus_image *image = NULL;
    if (image_parse_exr(&image, data, size)) {
        return 0;
    }
    write_again(image);
    conus_image_destroy(image);
    return 0;
}
