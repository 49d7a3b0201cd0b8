/* SPDX-License-Identifier: BSD-3-Clause */
/* Image files: detects the format of a file that is read, and picks the format of one that is written. */
#include "render/image/image.h"

#include "base/memory.h"
#include "conus/own.h"
#include "render/draw/draw.h"

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

static conus_status finish_text(struct bytes *out, struct buffer *text, conus_status status)
{
    if (status) {
        buffer_finish(text);
        return status;
    }
    *out = (struct bytes){(uint8_t *)text->data, text->size};
    return CONUS_OK;
}

static conus_status format_svg(struct bytes *out, const conus_image *image)
{
    struct buffer text = {0};
    struct bytes png = {0};
    conus_status status = image_format_png(&png, image);
    status = status ? status
                    : draw_format_svg(&text, image->list, png.data, png.size, image->dpi, conus_image_legend(image));
    bytes_finish(&png);
    return finish_text(out, &text, status);
}

static conus_status format_pdf(struct bytes *out, const conus_image *image)
{
    struct buffer text = {0};
    uint8_t *rgba = NULL;
    conus_status status = image_srgb_bytes(&rgba, image);
    status = status ? status : draw_format_pdf(&text, image->list, rgba, image->dpi);
    memory_free(rgba);
    return finish_text(out, &text, status);
}

/* The formats that are written. */
static const struct {
    const char *ending; /* without its dot */
    bool listed;        /* lines and texts stay a list; other formats have them in the pixels */
    conus_status (*format)(struct bytes *out, const conus_image *image);
} formats[] = {{"exr", false, image_format_exr},
               {"png", false, image_format_png},
               {"svg", true, format_svg},
               {"pdf", true, format_pdf}};

enum { FORMATS = sizeof formats / sizeof *formats };

/* FORMATS where it is none. */
static size_t find_format(const char *ending)
{
    size_t i = 0;
    while (i < FORMATS && strcasecmp(ending, formats[i].ending) != 0) {
        i++;
    }
    return i;
}

static conus_status format_image(struct bytes *out, const conus_image *image, size_t format)
{
    if (formats[format].listed != (image->list != NULL)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: a picture whose lines and text are %s (conus_view.shapes)",
                    formats[format].ending,
                    image->list ? "kept as shapes is written as svg or pdf"
                                : "pixels is "
                                  "written as png or exr");
    }
    return formats[format].format(out, image);
}

conus_status conus_image_write(const conus_image *image, const char *path)
{
    if (!image || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_image_write: %s is NULL", image ? "path" : "image");
    }
    const char *dot = strrchr(path, '.');
    const size_t format = dot ? find_format(dot + 1) : FORMATS;
    if (format == FORMATS) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the ending says the format of a picture: .exr, .png, .svg or .pdf",
                    path);
    }
    struct bytes bytes;
    conus_status status = format_image(&bytes, image, format);
    if (status) {
        return fail_in(status, path);
    }
    status = file_write(path, bytes.data, bytes.size);
    bytes_finish(&bytes);
    return status;
}

conus_status conus_image_encode(const uint8_t **data, size_t *size, conus_image *image, const char *format)
{
    const size_t number = format ? find_format(format) : FORMATS;
    if (!data || !size || !image || number == FORMATS) {
        return fail(CONUS_ERROR_ARGUMENT, "format: %s, allowed is exr, png, svg or pdf", format ? format : "NULL");
    }
    struct bytes bytes;
    conus_status status = format_image(&bytes, image, number);
    if (status) {
        return status;
    }
    bytes_finish(&image->encoded);
    image->encoded = bytes;
    *data = bytes.data;
    *size = bytes.size;
    return CONUS_OK;
}
