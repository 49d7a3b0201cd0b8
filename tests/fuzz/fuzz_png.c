/* SPDX-License-Identifier: BSD-3-Clause */
/* PNG: a picture that is read can be written again. */
#include "render/image/image.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    conus_image *image = NULL;
    struct bytes bytes;
    if (image_parse_png(&image, data, size)) {
        return 0;
    }
    if (image_format_png(&bytes, image)) {
        abort();
    }
    bytes_finish(&bytes);
    conus_image_destroy(image);
    return 0;
}
