/* SPDX-License-Identifier: BSD-3-Clause */
/* Image files: detects the format of a file that is read, and picks the format of one that is written. */
#include "render/image/image_codecs.h"

#include <string.h>
#include <strings.h>

conus_status conus_image_load(conus_image **out, const char *path)
{
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_image_load: %s is NULL", out ? "path" : "out");
    }
    static const uint8_t exr[] = {0x76, 0x2f, 0x31, 0x01};
    static const uint8_t png[] = {0x89, 'P', 'N', 'G'};
    struct bytes bytes;
    conus_status status = file_read(&bytes, path, IMAGE_MAX_BYTES);
    if (status) {
        return status;
    }
    if (bytes.size >= sizeof exr && memcmp(bytes.data, exr, sizeof exr) == 0) {
        status = image_parse_exr(out, bytes.data, bytes.size);
    } else if (bytes.size >= sizeof png && memcmp(bytes.data, png, sizeof png) == 0) {
        status = image_parse_png(out, bytes.data, bytes.size);
    } else {
        status = fail(CONUS_ERROR_DATA, "%zu bytes that are neither OpenEXR nor PNG", bytes.size);
    }
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

/* Whether the ending, without its dot, is that of a format that is written. */
static bool is_known(const char *ending)
{
    return strcasecmp(ending, "exr") == 0 || strcasecmp(ending, "png") == 0;
}

static conus_status format_image(struct bytes *out, const conus_image *image, const char *ending)
{
    return strcasecmp(ending, "exr") == 0 ? image_format_exr(out, image) : image_format_png(out, image);
}

conus_status conus_image_write(const conus_image *image, const char *path)
{
    if (!image || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_image_write: %s is NULL", image ? "path" : "image");
    }
    const char *dot = strrchr(path, '.');
    if (!dot || !is_known(dot + 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the ending says the format of a picture: .exr or .png", path);
    }
    struct bytes bytes;
    conus_status status = format_image(&bytes, image, dot + 1);
    if (status) {
        return fail_in(status, path);
    }
    status = file_write(path, bytes.data, bytes.size);
    bytes_finish(&bytes);
    return status;
}

conus_status conus_image_encode(const uint8_t **data, size_t *size, conus_image *image, const char *format)
{
    if (!data || !size || !image || !format || !is_known(format)) {
        return fail(CONUS_ERROR_ARGUMENT, "format: %s, allowed is exr or png", format ? format : "NULL");
    }
    struct bytes bytes;
    conus_status status = format_image(&bytes, image, format);
    if (status) {
        return status;
    }
    bytes_finish(&image->encoded);
    image->encoded = bytes;
    *data = bytes.data;
    *size = bytes.size;
    return CONUS_OK;
}
