/* SPDX-License-Identifier: BSD-3-Clause */
/* What cairo draws of a list: how much of each pixel an item covers, or a page of PDF. */
#include "render/draw/draw.h"

#include "base/library.h"
#include "base/memory.h"
#include "conus/version.h"

#include <cairo-pdf.h>
#include <cairo.h>
#include <math.h>
#include <string.h>

/* clang-format off */
#define CAIRO_FUNCTIONS(F)                                                                                             \
    F(cairo_, arc) F(cairo_, close_path) F(cairo_, create) F(cairo_, destroy) F(cairo_, fill)                          \
    F(cairo_, fill_extents) F(cairo_, image_surface_create_for_data) F(cairo_, line_to) F(cairo_, move_to)             \
    F(cairo_, new_path) F(cairo_, paint) F(cairo_, pdf_surface_create_for_stream) F(cairo_, pdf_surface_set_metadata)  \
    F(cairo_, rectangle) F(cairo_, scale) F(cairo_, set_font_size) F(cairo_, set_line_cap)    \
    F(cairo_, set_line_width) F(cairo_, set_source_rgba) F(cairo_, set_source_surface) F(cairo_, set_tolerance)        \
    F(cairo_, show_text) F(cairo_, status) F(cairo_, status_to_string) F(cairo_, stroke) F(cairo_, stroke_extents)                          \
    F(cairo_, surface_destroy) F(cairo_, surface_finish) F(cairo_, surface_flush) F(cairo_, surface_mark_dirty)        \
    F(cairo_, surface_status) F(cairo_, text_path)
/* clang-format on */

LIBRARY_TABLE(cairo, CAIRO_FUNCTIONS);

/* A pixel where no dpi is known, as CSS has it. */
static const double CSS_DPI = 96;

/* Of a curve, pixels: round ends are curves, too. */
static const double TOLERANCE = 0.02;

static const double RIGHT_ANGLE = 1.5707963267948966;

static conus_status load_cairo(void)
{
    return library_load(&cairo, CAIRO_FUNCTIONS(LIBRARY_NAME), CONUS_CAIRO_FILE, "libcairo2");
}

static conus_status status_of(cairo_status_t status)
{
    return status == CAIRO_STATUS_SUCCESS ? CONUS_OK
           : status == CAIRO_STATUS_NO_MEMORY
               ? fail(CONUS_ERROR_MEMORY, "no memory to draw text and lines")
               : fail(CONUS_ERROR_UNSUPPORTED, "text and lines: %s", cairo.status_to_string(status));
}

/* The text as text, or in pixels as outlines, which begin anywhere between two of them; sizes as font_width() has them.
 */
static void trace_text(cairo_t *to, const struct draw_item *item, bool in_pixels)
{
    const double *at = item->points[0];
    cairo.set_font_size(to, in_pixels ? rint(item->width * 64) / 64 : item->width);
    cairo.move_to(to, at[0], in_pixels ? rint(at[1]) : at[1]);
    (in_pixels ? cairo.text_path : cairo.show_text)(to, item->text);
}

/* A frame is a line in the middle of its width. */
static void trace_box(cairo_t *to, const struct draw_item *item)
{
    const double half = item->width / 2;
    const double left = item->points[0][0] + half;
    const double top = item->points[0][1] + half;
    const double right = fmax(item->points[1][0] - half, left);
    const double bottom = fmax(item->points[1][1] - half, top);
    const double radius = fmin(fmax(item->rounding - half, 0), fmin(right - left, bottom - top) / 2);
    if (radius > 0) {
        cairo.arc(to, right - radius, top + radius, radius, -RIGHT_ANGLE, 0);
        cairo.arc(to, right - radius, bottom - radius, radius, 0, RIGHT_ANGLE);
        cairo.arc(to, left + radius, bottom - radius, radius, RIGHT_ANGLE, 2 * RIGHT_ANGLE);
        cairo.arc(to, left + radius, top + radius, radius, 2 * RIGHT_ANGLE, 3 * RIGHT_ANGLE);
        cairo.close_path(to);
    } else {
        cairo.rectangle(to, left, top, right - left, bottom - top);
    }
}

static void trace_points(cairo_t *to, const struct draw_item *item)
{
    for (size_t k = 0; k < item->count; k++) {
        bool starts = item->kind == DRAW_LINES ? k % 2 == 0 : k == 0;
        (starts ? cairo.move_to : cairo.line_to)(to, item->points[k][0], item->points[k][1]);
    }
    if (item->kind != DRAW_LINES) {
        cairo.close_path(to);
    }
}

static void trace_item(cairo_t *to, const struct draw_item *item, bool in_pixels)
{
    cairo.new_path(to);
    cairo.set_line_width(to, item->width);
    cairo.set_line_cap(to, item->kind == DRAW_LINES ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    if (item->kind == DRAW_TEXT) {
        trace_text(to, item, in_pixels);
    } else if (item->kind == DRAW_BOX) {
        trace_box(to, item);
    } else {
        trace_points(to, item);
    }
}

static bool is_line(const struct draw_item *item)
{
    return item->kind == DRAW_LINES || item->kind == DRAW_LOOP || (item->kind == DRAW_BOX && item->width > 0);
}

/* Which part of each of a picture's pixels an item covers, 0 to 255; all 0 between two items. */
struct coverage {
    uint8_t *bytes;
    int stride;
    cairo_surface_t *surface;
    cairo_t *to;
};

/* The first and one past the last pixel that what is drawn between `low` and `high` may touch. */
static void limit(size_t range[2], double low, double high, uint32_t size)
{
    range[0] = (size_t)fmin(fmax(floor(low - 1), 0), size);
    range[1] = (size_t)fmin(fmax(ceil(high + 1), 0), size);
}

static void paint_item(float *const plane[4], const struct draw_list *list, struct coverage *coverage,
                       const struct draw_item *item)
{
    double box[4];
    size_t columns[2], rows[2];
    const float *rgba = item->rgba;
    trace_item(coverage->to, item, true);
    (is_line(item) ? cairo.stroke_extents : cairo.fill_extents)(coverage->to, &box[0], &box[1], &box[2], &box[3]);
    (is_line(item) ? cairo.stroke : cairo.fill)(coverage->to);
    cairo.surface_flush(coverage->surface);
    limit(columns, box[0], box[2], list->width);
    limit(rows, box[1], box[3], list->height);
    for (size_t row = rows[0]; row < rows[1] && columns[0] < columns[1]; row++) {
        uint8_t *covered = coverage->bytes + row * (size_t)coverage->stride;
        for (size_t column = columns[0]; column < columns[1]; column++) {
            if (covered[column]) {
                const size_t pixel = row * list->width + column;
                const float opacity = rgba[3] * (float)covered[column] / 255;
                for (int c = 0; c < 3; c++) {
                    plane[c][pixel] = rgba[c] * opacity + (1 - opacity) * plane[c][pixel];
                }
                plane[3][pixel] = opacity + (1 - opacity) * plane[3][pixel];
            }
        }
        memset(covered + columns[0], 0, columns[1] - columns[0]);
    }
    cairo.surface_mark_dirty(coverage->surface);
}

/* Readies a context for the list: its font, where there is text, and how round curves are. */
static conus_status prepare(cairo_t *to, const struct draw_list *list, bool in_pixels)
{
    struct font *font = NULL;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < list->count && !font && !status; i++) {
        status = list->items[i].kind == DRAW_TEXT ? font_create(&font) : CONUS_OK;
    }
    if (font) {
        font_select(font, to, in_pixels);
    }
    font_destroy(font);
    cairo.set_tolerance(to, TOLERANCE);
    return status;
}

conus_status draw_paint(float *const plane[4], const struct draw_list *list)
{
    struct coverage coverage = {.stride = (int)((list->width + 3) / 4 * 4)};
    conus_status status = list->failed ? CONUS_ERROR_MEMORY : CONUS_OK;
    if (status || !list->count) {
        return status;
    }
    status = load_cairo();
    coverage.bytes = status ? NULL : memory_zeroed(list->height, (size_t)coverage.stride);
    if (!coverage.bytes) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    coverage.surface = cairo.image_surface_create_for_data(coverage.bytes, CAIRO_FORMAT_A8, (int)list->width,
                                                           (int)list->height, coverage.stride);
    coverage.to = cairo.create(coverage.surface);
    status = prepare(coverage.to, list, true);
    for (size_t i = 0; i < list->count && !status; i++) {
        paint_item(plane, list, &coverage, &list->items[i]);
        status = status_of(cairo.status(coverage.to));
    }
    cairo.destroy(coverage.to);
    cairo.surface_destroy(coverage.surface);
    memory_free(coverage.bytes);
    return status;
}

/* cairo's pixels: 32 bits of A, R, G, B, premultiplied. */
static uint32_t *copy_pixels(bool *is_opaque, const uint8_t *rgba, size_t count)
{
    uint32_t *pixels = memory_raw(count, sizeof *pixels);
    *is_opaque = true;
    for (size_t i = 0; i < count && pixels; i++) {
        uint32_t opacity = rgba[4 * i + 3];
        pixels[i] = opacity << 24;
        *is_opaque = *is_opaque && opacity == 255;
        for (size_t c = 0; c < 3; c++) {
            pixels[i] |= (rgba[4 * i + c] * opacity + 127) / 255 << (16 - 8 * c);
        }
    }
    return pixels;
}

static cairo_status_t write_bytes(void *user, const unsigned char *bytes, unsigned size)
{
    struct buffer *buffer = user;
    buffer_append(buffer, bytes, size);
    return buffer->failed ? CAIRO_STATUS_NO_MEMORY : CAIRO_STATUS_SUCCESS;
}

static void draw_page(cairo_t *to, cairo_surface_t *picture, const struct draw_list *list)
{
    cairo.set_source_surface(to, picture, 0, 0);
    cairo.paint(to);
    for (size_t i = 0; i < list->count; i++) {
        const struct draw_item *item = &list->items[i];
        uint8_t rgb[3];
        srgb_bytes(rgb, item->rgba);
        cairo.set_source_rgba(to, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0, (double)item->rgba[3]);
        trace_item(to, item, false);
        (is_line(item) ? cairo.stroke : cairo.fill)(to);
    }
}

conus_status draw_format_pdf(struct buffer *out, const struct draw_list *list, const uint8_t *rgba, double dpi)
{
    bool is_opaque;
    const double scale = 72 / (dpi > 0 ? dpi : CSS_DPI); /* points of a 72nd inch */
    conus_status status = list->failed ? CONUS_ERROR_MEMORY : load_cairo();
    uint32_t *pixels = status ? NULL : copy_pixels(&is_opaque, rgba, (size_t)list->width * list->height);
    if (!pixels) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    cairo_surface_t *picture = cairo.image_surface_create_for_data(
        (unsigned char *)pixels, is_opaque ? CAIRO_FORMAT_RGB24 : CAIRO_FORMAT_ARGB32, (int)list->width,
        (int)list->height, (int)(4 * list->width));
    cairo_surface_t *page =
        cairo.pdf_surface_create_for_stream(write_bytes, out, list->width * scale, list->height * scale);
    cairo_t *to = cairo.create(page);
    status = prepare(to, list, false);
    if (!status) {
        cairo.pdf_surface_set_metadata(page, CAIRO_PDF_METADATA_CREATOR, "conus " CONUS_VERSION);
        cairo.pdf_surface_set_metadata(page, CAIRO_PDF_METADATA_CREATE_DATE, ""); /* which would change each file */
        cairo.scale(to, scale, scale);
        draw_page(to, picture, list);
        status = status_of(cairo.status(to));
    }
    cairo.destroy(to);
    cairo.surface_finish(page);
    status = status ? status : status_of(cairo.surface_status(page));
    cairo.surface_destroy(page);
    cairo.surface_destroy(picture);
    memory_free(pixels);
    return status;
}
