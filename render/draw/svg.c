/* SPDX-License-Identifier: BSD-3-Clause */
/* SVG 1.1: the pixels as a PNG inside, the list over it, text as text in the font's name. */
#include "render/draw/draw.h"

#include "base/memory.h"

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

static void put_colour(struct buffer *out, const char *name, const struct draw_item *item)
{
    uint8_t rgb[3];
    srgb_bytes(rgb, item->rgba);
    buffer_format(out, " %s=\"#%02x%02x%02x\"", name, rgb[0], rgb[1], rgb[2]);
    if (item->rgba[3] < 1) {
        buffer_format(out, " %s-opacity=\"0.%02d\"", name, (int)fmin(99, rint(100 * (double)item->rgba[3])));
    }
}

static void put_stroke(struct buffer *out, const struct draw_item *item)
{
    buffer_text(out, " fill=\"none\"");
    put_colour(out, "stroke", item);
    put_attribute(out, "stroke-width", item->width);
    if (item->kind == DRAW_LINES) {
        buffer_text(out, " stroke-linecap=\"round\"");
    }
}

static void put_text(struct buffer *out, const struct draw_item *item)
{
    buffer_text(out, "<text");
    put_attribute(out, "x", item->points[0][0]);
    put_attribute(out, "y", item->points[0][1]);
    put_attribute(out, "font-size", item->width);
    put_attribute(out, "textLength", item->length);
    put_colour(out, "fill", item);
    buffer_text(out, ">");
    buffer_xml(out, item->text);
    buffer_text(out, "</text>\n");
}

/* A frame is a line in the middle of its width. */
static void put_box(struct buffer *out, const struct draw_item *item)
{
    double half = item->width / 2;
    buffer_text(out, "<rect");
    put_attribute(out, "x", item->points[0][0] + half);
    put_attribute(out, "y", item->points[0][1] + half);
    put_attribute(out, "width", fmax(item->points[1][0] - item->points[0][0] - item->width, 0));
    put_attribute(out, "height", fmax(item->points[1][1] - item->points[0][1] - item->width, 0));
    if (item->rounding > half) {
        put_attribute(out, "rx", item->rounding - half);
    }
    if (half > 0) {
        put_stroke(out, item);
    } else {
        put_colour(out, "fill", item);
    }
    buffer_text(out, "/>\n");
}

static void put_path(struct buffer *out, const struct draw_item *item)
{
    buffer_text(out, "<path");
    if (item->kind == DRAW_AREA) {
        put_colour(out, "fill", item);
    } else {
        put_stroke(out, item);
    }
    buffer_text(out, " d=\"");
    for (size_t k = 0; k < item->count; k++) {
        bool starts = item->kind == DRAW_LINES ? k % 2 == 0 : k == 0;
        put(out, starts ? "M" : "L", item->points[k][0]);
        put(out, " ", item->points[k][1]);
    }
    buffer_text(out, item->kind == DRAW_LINES ? "\"/>\n" : "Z\"/>\n");
}

static conus_status put_picture(struct buffer *out, const struct draw_list *list, const uint8_t *png, size_t size)
{
    char *digits = memory_raw(BASE64_ENCODE_RAW_LENGTH(size) + 1, 1);
    if (!digits) {
        return CONUS_ERROR_MEMORY;
    }
    base64_encode_raw(digits, size, png);
    buffer_format(out, "<image width=\"%u\" height=\"%u\" xlink:href=\"data:image/png;base64,", list->width,
                  list->height);
    buffer_append(out, digits, BASE64_ENCODE_RAW_LENGTH(size));
    buffer_text(out, "\"/>\n");
    memory_free(digits);
    return CONUS_OK;
}

conus_status draw_format_svg(struct buffer *out, const struct draw_list *list, const uint8_t *png, size_t png_size,
                             double dpi, const char *description)
{
    const double mm = dpi > 0 ? 25.4 / dpi : 0;
    buffer_text(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                     "xmlns:xlink=\"http://www.w3.org/1999/xlink\" version=\"1.1\"");
    buffer_text(out, " width=\"");
    buffer_number(out, mm > 0 ? list->width * mm : list->width);
    buffer_format(out, "%s\" height=\"", mm > 0 ? "mm" : "");
    buffer_number(out, mm > 0 ? list->height * mm : list->height);
    buffer_format(out, "%s\" viewBox=\"0 0 %u %u\">\n", mm > 0 ? "mm" : "", list->width, list->height);
    if (description && description[0]) {
        buffer_text(out, "<desc>");
        buffer_xml(out, description);
        buffer_text(out, "</desc>\n");
    }
    conus_status status = put_picture(out, list, png, png_size);
    buffer_text(out, "<g font-family=\"Liberation Sans, Arial, Helvetica, sans-serif\" xml:space=\"preserve\">\n");
    for (size_t i = 0; i < list->count && !status; i++) {
        const struct draw_item *item = &list->items[i];
        (item->kind == DRAW_TEXT ? put_text : item->kind == DRAW_BOX ? put_box : put_path)(out, item);
    }
    buffer_text(out, "</g>\n</svg>\n");
    return status ? status : list->failed ? CONUS_ERROR_MEMORY : buffer_status(out);
}
