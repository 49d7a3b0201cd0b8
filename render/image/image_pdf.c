/* SPDX-License-Identifier: BSD-3-Clause */
/* PDF through cairo, which embeds the letters that are used: the pixels, and the shapes over them. */
#include "render/image/image_codecs.h"

#include "base/buffer.h"
#include "base/library.h"
#include "base/memory.h"
#include "conus/version.h"
#include "render/image/image_srgb.h"
#include "render/image/shapes.h"

#ifndef CONUS_CAIRO_FILE

conus_status image_format_pdf(struct bytes *out, const conus_image *image)
{
    (void)out, (void)image;
    return fail(CONUS_ERROR_UNSUPPORTED, "this build of conus leaves out PDF, for which it needs cairo");
}

#else

#include <cairo-pdf.h>
#include <cairo.h>
#include <math.h>

/* clang-format off */
#define CAIRO_FUNCTIONS(F)                                                                                             \
    F(cairo_, arc) F(cairo_, close_path) F(cairo_, create) F(cairo_, destroy) F(cairo_, fill)                          \
    F(cairo_, font_options_create) F(cairo_, font_options_destroy) F(cairo_, font_options_set_hint_metrics)            \
    F(cairo_, font_options_set_hint_style) F(cairo_, image_surface_create_for_data) F(cairo_, line_to)                 \
    F(cairo_, move_to) F(cairo_, new_path) F(cairo_, paint) F(cairo_, pdf_surface_create_for_stream)                   \
    F(cairo_, pdf_surface_set_metadata) F(cairo_, rectangle) F(cairo_, scale) F(cairo_, select_font_face)              \
    F(cairo_, set_font_options) F(cairo_, set_font_size) F(cairo_, set_line_cap) F(cairo_, set_line_join)              \
    F(cairo_, set_line_width) F(cairo_, set_source_rgba) F(cairo_, set_source_surface) F(cairo_, show_text)            \
    F(cairo_, status) F(cairo_, status_to_string) F(cairo_, stroke) F(cairo_, surface_destroy)                         \
    F(cairo_, surface_finish) F(cairo_, surface_status)
/* clang-format on */

static struct {
    CAIRO_FUNCTIONS(LIBRARY_MEMBER)
} cairo;

/* A pixel where no dpi is known, as CSS has it. */
static const double CSS_DPI = 96;

static const double RIGHT_ANGLE = 1.5707963267948966;

static cairo_status_t write_bytes(void *user, const unsigned char *bytes, unsigned size)
{
    struct buffer *buffer = user;
    buffer_append(buffer, bytes, size);
    return buffer->failed ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

static void draw_loop(cairo_t *to, const struct image_shape *shape)
{
    for (size_t k = 0; k < shape->point_count; k++) {
        bool starts = shape->kind == SHAPE_PAIRS ? k % 2 == 0 : k == 0;
        (starts ? cairo.move_to : cairo.line_to)(to, shape->points[k][0], shape->points[k][1]);
    }
    if (shape->kind == SHAPE_LOOP) {
        cairo.close_path(to);
    }
    cairo.stroke(to);
}

static void draw_box(cairo_t *to, const struct image_shape *shape)
{
    const double half = shape->width / 2;
    const double left = shape->from[0] + half;
    const double top = shape->from[1] + half;
    const double right = fmax(shape->to[0] - half, left);
    const double bottom = fmax(shape->to[1] - half, top);
    const double radius = fmin(fmax(shape->rounding - half, 0), fmin(right - left, bottom - top) / 2);
    if (radius > 0) {
        cairo.arc(to, right - radius, top + radius, radius, -RIGHT_ANGLE, 0);
        cairo.arc(to, right - radius, bottom - radius, radius, 0, RIGHT_ANGLE);
        cairo.arc(to, left + radius, bottom - radius, radius, RIGHT_ANGLE, 2 * RIGHT_ANGLE);
        cairo.arc(to, left + radius, top + radius, radius, 2 * RIGHT_ANGLE, 3 * RIGHT_ANGLE);
        cairo.close_path(to);
    } else {
        cairo.rectangle(to, left, top, right - left, bottom - top);
    }
    (half > 0 ? cairo.stroke : cairo.fill)(to);
}

static void draw_shape(cairo_t *to, const struct image_shape *shape)
{
    uint8_t rgb[3];
    srgb_bytes(rgb, shape->rgba);
    cairo.new_path(to);
    cairo.set_source_rgba(to, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0, (double)shape->rgba[3]);
    cairo.set_line_width(to, shape->width);
    if (shape->kind == SHAPE_TEXT) {
        cairo.set_font_size(to, shape->width);
        cairo.move_to(to, shape->from[0], shape->from[1]);
        cairo.show_text(to, shape->text);
    } else if (shape->kind == SHAPE_BOX) {
        draw_box(to, shape);
    } else if (shape->kind == SHAPE_LINE) {
        cairo.move_to(to, shape->from[0], shape->from[1]);
        cairo.line_to(to, shape->to[0], shape->to[1]);
        cairo.stroke(to);
    } else {
        draw_loop(to, shape);
    }
}

/* cairo's pixels: 32 bits of A, R, G, B, premultiplied. */
static conus_status copy_pixels(uint32_t **out, bool *is_opaque, const conus_image *image)
{
    uint8_t *rgba = NULL;
    size_t count = (size_t)image->width * image->height;
    uint32_t *pixels = memory_raw(count, sizeof *pixels);
    conus_status status = pixels ? image_srgb_bytes(&rgba, image) : CONUS_ERROR_MEMORY;
    *is_opaque = true;
    for (size_t i = 0; i < count && !status; i++) {
        uint32_t opacity = rgba[4 * i + 3];
        pixels[i] = opacity << 24;
        *is_opaque = *is_opaque && opacity == 255;
        for (size_t c = 0; c < 3; c++) {
            pixels[i] |= (rgba[4 * i + c] * opacity + 127) / 255 << (16 - 8 * c);
        }
    }
    memory_free(rgba);
    if (status) {
        memory_free(pixels);
        return status;
    }
    *out = pixels;
    return CONUS_OK;
}

static void draw_page(cairo_t *to, cairo_surface_t *picture, const struct shapes *shapes)
{
    cairo_font_options_t *options = cairo.font_options_create();
    cairo.font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE); /* widths as those that were measured */
    cairo.font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo.set_source_surface(to, picture, 0, 0);
    cairo.paint(to);
    cairo.set_font_options(to, options);
    cairo.select_font_face(to, shapes->family, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo.set_line_cap(to, CAIRO_LINE_CAP_ROUND);
    cairo.set_line_join(to, CAIRO_LINE_JOIN_ROUND);
    for (size_t i = 0; i < shapes->count; i++) {
        draw_shape(to, &shapes->items[i]);
    }
    cairo.font_options_destroy(options);
}

static conus_status status_of(cairo_status_t status)
{
    return status == CAIRO_STATUS_SUCCESS ? CONUS_OK
           : status == CAIRO_STATUS_NO_MEMORY
               ? fail(CONUS_ERROR_MEMORY, "no memory for a PDF")
               : fail(CONUS_ERROR_UNSUPPORTED, "PDF: %s", cairo.status_to_string(status));
}

/* The page's size in points of a 72nd inch. A date would make each file another. */
static conus_status write_page(struct buffer *out, const conus_image *image, cairo_surface_t *picture)
{
    const double scale = 72 / (image->dpi > 0 ? image->dpi : CSS_DPI);
    cairo_surface_t *page =
        cairo.pdf_surface_create_for_stream(write_bytes, out, image->width * scale, image->height * scale);
    cairo_t *to = cairo.create(page);
    cairo.pdf_surface_set_metadata(page, CAIRO_PDF_METADATA_CREATOR, "conus " CONUS_VERSION);
    cairo.pdf_surface_set_metadata(page, CAIRO_PDF_METADATA_CREATE_DATE, "");
    cairo.scale(to, scale, scale);
    draw_page(to, picture, image->shapes);
    cairo_status_t status = cairo.status(to);
    cairo.destroy(to);
    cairo.surface_finish(page);
    status = status ? status : cairo.surface_status(page);
    cairo.surface_destroy(page);
    return status_of(status);
}

conus_status image_format_pdf(struct bytes *out, const conus_image *image)
{
    uint32_t *pixels = NULL;
    bool is_opaque;
    struct buffer bytes = {0};
    conus_status status = library_load(&cairo, CAIRO_FUNCTIONS(LIBRARY_NAME), CONUS_CAIRO_FILE, "libcairo2");
    status = status ? status : copy_pixels(&pixels, &is_opaque, image);
    if (status) {
        return status;
    }
    cairo_surface_t *picture = cairo.image_surface_create_for_data(
        (unsigned char *)pixels, is_opaque ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32, (int)image->width,
        (int)image->height, (int)(4 * image->width));
    status = status_of(cairo.surface_status(picture));
    status = status ? status : write_page(&bytes, image, picture);
    cairo.surface_destroy(picture);
    memory_free(pixels);
    status = status ? status : image->shapes->failed ? CONUS_ERROR_MEMORY : buffer_status(&bytes);
    if (status) {
        buffer_finish(&bytes);
        return status;
    }
    *out = (struct bytes){(uint8_t *)bytes.data, bytes.size};
    return CONUS_OK;
}

#endif
