/* SPDX-License-Identifier: BSD-3-Clause */
/* The renderer of the public interface: its context, its updates, and pictures off-screen. */
#include "render/colour/renderer.h"

#include "base/memory.h"
#include "base/options.h"
#include "render/colour/colour.h"
#include "render/gl/context.h"
#include "render/gl/target.h"

#include <math.h>
#include <string.h>

enum { TILE = COLOUR_TILE, RAYS = 4 };

#define THRESHOLD 0.05F /* of white, linear radiance times opacity */

static bool differ(const float *a, const float *b)
{
    float most = 0;
    for (int c = 0; c < 4; c++) {
        most = fmaxf(most, fabsf(a[c] - b[c]));
    }
    return most > THRESHOLD;
}

static size_t tiles_along(size_t pixels)
{
    return (pixels + TILE - 1) / TILE;
}

/* Marks the tiles with a pixel that differs from its right or upper neighbour, which may lie in the next tile. Returns
 * whether there are any. */
static bool find_edge_tiles(uint32_t *tiles, const float *rgba, const struct target *target)
{
    const size_t width = target->width;
    const size_t across = tiles_along(width);
    bool found = false;
    for (size_t y = 0; y < target->height; y++) {
        for (size_t x = 0; x < width; x++) {
            const float *pixel = rgba + 4 * (y * width + x);
            bool right = x + 1 < width && differ(pixel, pixel + 4);
            bool above = y + 1 < target->height && differ(pixel, pixel + 4 * width);
            if (right || above) {
                tiles[y / TILE * across + x / TILE] = 1;
                found = true;
            }
        }
    }
    return found;
}

/* Adds the pictures of the tiles in `buffer`, a quarter each, by rays through four places of each pixel, a rotated
 * square. Through translucent surfaces a ray costs more, and most tiles have edges: one, through the lower left corner
 * of each pixel. */
static conus_status draw_tiles(GLuint buffer, const struct target *target, const struct colour_pass *pass,
                               const struct colour_view *view)
{
    static const double square[RAYS][2] = {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}};
    static const double corner[1][2] = {{-0.5, -0.5}};
    const double(*places)[2] = view->opacity ? corner : square;
    const size_t count = view->opacity ? 1 : RAYS;
    glBlendColor(0, 0, 0, 1.0F / (float)count);
    glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE);
    conus_status status = CONUS_OK;
    for (size_t n = 0; n < count && !status; n++) {
        struct colour_view shifted = *view;
        memcpy(shifted.shift, places[n], sizeof shifted.shift);
        shifted.tiles = buffer;
        status = gl_tell(&view->listener, n, count);
        status = status ? status : colour_pass_begin(pass, &shifted);
        if (!status) {
            target_bind(target);
            glEnable(GL_BLEND);
            status = colour_pass_draw(pass, &shifted);
        }
    }
    glDisable(GL_BLEND);
    return status;
}

/* Half of the pixel at x, y is its own ray's, half those of its four corners, which it shares with its neighbours. Of
 * a tile that was not drawn the pixel's own ray stands for them. */
static void mix_corners(float *rgba, const float *corners, const uint32_t *tiles, const struct target *target, size_t x,
                        size_t y)
{
    float sum[4];
    for (size_t c = 0; c < 4; c++) {
        sum[c] = 4 * rgba[c];
    }
    for (size_t n = 0; n < 4; n++) {
        const size_t right = x + (n % 2 && x + 1 < target->width);
        const size_t up = y + (n / 2 && y + 1 < target->height);
        const bool drawn = tiles[up / TILE * tiles_along(target->width) + right / TILE];
        for (size_t c = 0; c < 4; c++) {
            sum[c] += drawn ? corners[4 * (up * target->width + right) + c] : rgba[c];
        }
    }
    for (size_t c = 0; c < 4; c++) {
        rgba[c] = sum[c] / 8;
    }
}

/* Smooths `rgba`, the picture of `view` in `target` (bottom row first), whose contents are lost. */
static conus_status smooth_edges(float *rgba, const struct target *target, const struct colour_pass *pass,
                                 const struct colour_view *view)
{
    const size_t across = tiles_along(target->width);
    const size_t count = across * tiles_along(target->height);
    float *smooth = memory_raw((size_t)target->width * target->height, 4 * sizeof *smooth);
    uint32_t *tiles = memory_zeroed(count, sizeof *tiles);
    conus_status status = smooth && tiles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && find_edge_tiles(tiles, rgba, target)) {
        GLuint buffer = 0;
        glCreateBuffers(1, &buffer);
        glNamedBufferData(buffer, (GLsizeiptr)(count * sizeof *tiles), tiles, GL_STREAM_DRAW);
        target_bind(target);
        target_clear(target);
        status = draw_tiles(buffer, target, pass, view);
        status = status ? status : target_read(target, "colour", smooth);
        glDeleteBuffers(1, &buffer);
        for (size_t y = 0; y < target->height && !status; y++) {
            for (size_t x = 0; x < target->width; x++) {
                size_t pixel = 4 * (y * target->width + x);
                if (!tiles[y / TILE * across + x / TILE]) {
                    continue;
                }
                if (view->opacity) {
                    mix_corners(rgba + pixel, smooth, tiles, target, x, y);
                } else {
                    memcpy(rgba + pixel, smooth + pixel, 4 * sizeof *rgba);
                }
            }
        }
    }
    memory_free(smooth);
    memory_free(tiles);
    return status;
}

/* Turns values that are fractions of the context's window into grey values. */
static conus_status make_absolute(struct transfer *transfer, const struct volume *context)
{
    double low;
    double high;
    if (!transfer->relative || !context) {
        return CONUS_OK;
    }
    conus_status status = transfer_window(&low, &high, context);
    for (size_t i = 0; !status && i < transfer->count; i++) {
        transfer->points[i].value = low + transfer->points[i].value * (high - low);
    }
    transfer->relative = status ? transfer->relative : false;
    return status;
}

/* The renderer's context must be current. */
static conus_status create_passes(conus_renderer *renderer, const conus_renderer_options *options,
                                  struct colour_fields *fields)
{
    struct haze_choice hazy = {0};
    conus_status status = haze_choose(&hazy, renderer->atlas, options);
    status = status ? status
                    : colour_pass_init(&renderer->colour, renderer->atlas, &renderer->transfer, &hazy, fields,
                                       renderer->max_memory);
    haze_choice_finish(&hazy);
    struct tube_colouring streamlines = {0};
    status = status ? status : tube_colouring_choose(&streamlines, renderer->atlas, options->streamline_colour);
    status = status ? status : colour_pass_paint_streamlines(&renderer->colour, renderer->atlas, &streamlines, NULL);
    tube_colouring_finish(&streamlines);
    return status;
}

conus_status conus_renderer_create(conus_renderer **out, const conus_atlas *atlas,
                                   const conus_renderer_options *options)
{
    options = options_of(conus_renderer_options, options);
    conus_renderer *renderer = memory_zeroed(1, sizeof *renderer);
    if (!renderer) {
        return CONUS_ERROR_MEMORY;
    }
    renderer->atlas = atlas;
    renderer->max_memory = memory_limit(options->max_memory);
    renderer->log = options->log;
    renderer->log_user = options->log_user;
    struct colour_fields fields = {0};
    struct gl_current previous;
    const char *own = renderer->atlas->transfer ? renderer->atlas->transfer : "brain";
    conus_status status = transfer_load(&renderer->transfer, options->transfer ? options->transfer : own);
    status = status ? status : make_absolute(&renderer->transfer, atlas_context(renderer->atlas));
    status = status ? status : colour_fields_start(&fields, atlas, &renderer->transfer);
    status = status ? status : gl_context_create(&renderer->context, options->log, options->log_user);
    if (!status) {
        status = gl_context_use(renderer->context, &previous);
    }
    if (!status) {
        status = create_passes(renderer, options, &fields);
        gl_current_restore(&previous);
    }
    colour_fields_end(&fields);
    if (status) {
        conus_renderer_destroy(renderer);
        return status;
    }
    *out = renderer;
    return CONUS_OK;
}

void conus_renderer_destroy(conus_renderer *renderer)
{
    if (!renderer) {
        return;
    }
    struct gl_current previous;
    if (renderer->colour.program && !gl_context_use(renderer->context, &previous)) {
        colour_pass_finish(&renderer->colour);
        gl_current_restore(&previous);
    }
    gl_context_destroy(renderer->context);
    transfer_finish(&renderer->transfer);
    memory_free(renderer);
}

conus_status conus_renderer_update(conus_renderer *renderer)
{
    struct gl_current previous;
    conus_status status = gl_context_use(renderer->context, &previous);
    if (!status) {
        status = colour_pass_update(&renderer->colour, renderer->atlas, renderer->max_memory);
        gl_current_restore(&previous);
    }
    return status;
}

conus_status renderer_include(conus_renderer *renderer, const uint8_t *areas)
{
    struct gl_current previous;
    conus_status status = gl_context_use(renderer->context, &previous);
    if (!status) {
        status = colour_pass_include(&renderer->colour, renderer->atlas, areas, renderer->max_memory);
        gl_current_restore(&previous);
    }
    return status;
}

conus_status renderer_paint_streamlines(conus_renderer *renderer, const bool *const *is_pale)
{
    struct gl_current previous;
    conus_status status = gl_context_use(renderer->context, &previous);
    if (!status) {
        status = colour_pass_paint_streamlines(&renderer->colour, renderer->atlas, NULL, is_pale);
        gl_current_restore(&previous);
    }
    return status;
}

const conus_transfer_point *conus_renderer_transfer(size_t *count, const conus_renderer *renderer)
{
    bool used = renderer && atlas_context(renderer->atlas);
    *count = used ? renderer->transfer.count : 0;
    return used ? renderer->transfer.points : NULL;
}

conus_status conus_renderer_set_transfer(conus_renderer *renderer, const conus_transfer_point *points, size_t count)
{
    struct transfer transfer = {0};
    struct gl_current previous;
    conus_status status = transfer_copy(&transfer, points, count);
    status = status ? status : gl_context_use(renderer->context, &previous);
    if (!status) {
        status = colour_pass_set_transfer(&renderer->colour, renderer->atlas, &transfer, renderer->max_memory);
        gl_current_restore(&previous);
    }
    if (!status) {
        struct transfer old = renderer->transfer;
        renderer->transfer = transfer;
        transfer = old;
    }
    transfer_finish(&transfer);
    return status;
}

const char *conus_renderer_device(const conus_renderer *renderer)
{
    return renderer ? gl_context_renderer(renderer->context) : "";
}

conus_status renderer_draw(float *rgba, conus_renderer *renderer, const struct colour_view *view, bool smooth)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    struct colour_pass *pass = &renderer->colour;
    struct target target = {0};
    struct gl_current previous;
    conus_status status = gl_context_use(renderer->context, &previous);
    if (status) {
        return status;
    }
    status = colour_pass_need(pass, view);
    status = status ? status : target_init(&target, view->width, view->height, &colour, 1);
    status = status ? status : colour_pass_begin(pass, view);
    if (!status) {
        target_bind(&target);
        target_clear(&target);
        status = colour_pass_draw(pass, view);
    }
    status = status ? status : target_read(&target, "colour", rgba);
    if (!status && smooth) {
        status = smooth_edges(rgba, &target, pass, view);
    }
    target_finish(&target);
    gl_current_restore(&previous);
    return status;
}
