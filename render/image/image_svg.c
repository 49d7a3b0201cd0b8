/* SPDX-License-Identifier: BSD-3-Clause */
/* SVG 1.1: the pixels as a PNG inside, the shapes over it, text as text in the font's name. */
#include "render/image/image_codecs.h"

#include "base/memory.h"
#include "render/image/image_srgb.h"
#include "render/image/shapes.h"

#include <math.h>
#include <nettle/base64.h>

/* Two decimals of a pixel. */
static void put(struct buffer *out, const char *before, double value)
{
    buffer_text(out, before);
    buffer_number(out, rint(100 * value) / 100);
}

static void put_attribute(struct buffer *out, const char *name, double value)
{
    buffer_format(out, " %s", name);
    put(out, "=\"", value);
    buffer_text(out, "\"");
}

static void put_colour(struct buffer *out, const char *name, const struct image_shape *shape)
{
    uint8_t rgb[3];
    srgb_bytes(rgb, shape->rgba);
    buffer_format(out, " %s=\"#%02x%02x%02x\"", name, rgb[0], rgb[1], rgb[2]);
    if (shape->rgba[3] < 1) {
        buffer_format(out, " %s-opacity=\"0.%02d\"", name, (int)fmin(99, rint(100 * (double)shape->rgba[3])));
    }
}

static void put_stroke(struct buffer *out, const struct image_shape *shape)
{
    buffer_text(out, " fill=\"none\"");
    put_colour(out, "stroke", shape);
    put_attribute(out, "stroke-width", shape->width);
    buffer_text(out, " stroke-linecap=\"round\" stroke-linejoin=\"round\"");
}

static void put_text(struct buffer *out, const struct image_shape *shape)
{
    buffer_text(out, "<text");
    put_attribute(out, "x", shape->from[0]);
    put_attribute(out, "y", shape->from[1]);
    put_attribute(out, "font-size", shape->width);
    put_attribute(out, "textLength", shape->length);
    put_colour(out, "fill", shape);
    buffer_text(out, ">");
    buffer_xml(out, shape->text);
    buffer_text(out, "</text>\n");
}

/* A frame is a line in the middle of its width. */
static void put_box(struct buffer *out, const struct image_shape *shape)
{
    double half = shape->width / 2;
    buffer_text(out, "<rect");
    put_attribute(out, "x", shape->from[0] + half);
    put_attribute(out, "y", shape->from[1] + half);
    put_attribute(out, "width", fmax(shape->to[0] - shape->from[0] - shape->width, 0));
    put_attribute(out, "height", fmax(shape->to[1] - shape->from[1] - shape->width, 0));
    if (shape->rounding > half) {
        put_attribute(out, "rx", shape->rounding - half);
    }
    if (half > 0) {
        put_stroke(out, shape);
    } else {
        put_colour(out, "fill", shape);
    }
    buffer_text(out, "/>\n");
}

static void put_line(struct buffer *out, const struct image_shape *shape)
{
    buffer_text(out, "<path");
    put_stroke(out, shape);
    buffer_text(out, " d=\"");
    if (shape->kind == SHAPE_LINE) {
        put(out, "M", shape->from[0]);
        put(out, " ", shape->from[1]);
        put(out, "L", shape->to[0]);
        put(out, " ", shape->to[1]);
    }
    for (size_t k = 0; k < shape->point_count; k++) {
        bool starts = shape->kind == SHAPE_PAIRS ? k % 2 == 0 : k == 0;
        put(out, starts ? "M" : "L", shape->points[k][0]);
        put(out, " ", shape->points[k][1]);
    }
    buffer_text(out, shape->kind == SHAPE_LOOP ? "Z\"/>\n" : "\"/>\n");
}

static conus_status put_picture(struct buffer *out, const conus_image *image)
{
    struct bytes png = {0};
    conus_status status = image_format_png(&png, image);
    char *digits = status ? NULL : memory_raw(BASE64_ENCODE_RAW_LENGTH(png.size) + 1, 1);
    if (digits) {
        base64_encode_raw(digits, png.size, png.data);
        buffer_format(out, "<image width=\"%u\" height=\"%u\" xlink:href=\"data:image/png;base64,", image->width,
                      image->height);
        buffer_append(out, digits, BASE64_ENCODE_RAW_LENGTH(png.size));
        buffer_text(out, "\"/>\n");
    }
    bool has_digits = digits;
    memory_free(digits);
    bytes_finish(&png);
    return status || has_digits ? status : CONUS_ERROR_MEMORY;
}

conus_status image_format_svg(struct bytes *out, const conus_image *image)
{
    const struct shapes *shapes = image->shapes;
    struct buffer text = {0};
    const double mm = image->dpi > 0 ? 25.4 / image->dpi : 0;
    buffer_text(&text, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                       "xmlns:xlink=\"http://www.w3.org/1999/xlink\" version=\"1.1\"");
    buffer_text(&text, " width=\"");
    buffer_number(&text, mm > 0 ? image->width * mm : image->width);
    buffer_format(&text, "%s\" height=\"", mm > 0 ? "mm" : "");
    buffer_number(&text, mm > 0 ? image->height * mm : image->height);
    buffer_format(&text, "%s\" viewBox=\"0 0 %u %u\">\n", mm > 0 ? "mm" : "", image->width, image->height);
    conus_status status = put_picture(&text, image);
    buffer_text(&text, "<g font-family=\"");
    buffer_xml(&text, shapes->family);
    buffer_text(&text, ", sans-serif\" xml:space=\"preserve\">\n");
    for (size_t i = 0; i < shapes->count && !status; i++) {
        const struct image_shape *shape = &shapes->items[i];
        if (shape->kind == SHAPE_TEXT) {
            put_text(&text, shape);
        } else if (shape->kind == SHAPE_BOX) {
            put_box(&text, shape);
        } else {
            put_line(&text, shape);
        }
    }
    buffer_text(&text, "</g>\n</svg>\n");
    status = status ? status : shapes->failed ? CONUS_ERROR_MEMORY : buffer_status(&text);
    if (status) {
        buffer_finish(&text);
        return status;
    }
    *out = (struct bytes){(uint8_t *)text.data, text.size};
    return CONUS_OK;
}
