/* SPDX-License-Identifier: BSD-3-Clause */
/* The renderer of the public interface: its device, its updates, and pictures with smooth edges. */
#include "render/colour/renderer.h"

#include "base/memory.h"
#include "base/options.h"
#include "render/colour/colour.h"

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
static bool find_edge_tiles(uint32_t *tiles, const float *rgba, const struct colour_view *view)
{
    const size_t width = view->width;
    const size_t across = tiles_along(width);
    bool found = false;
    for (size_t y = 0; y < view->height; y++) {
        for (size_t x = 0; x < width; x++) {
            const float *pixel = rgba + 4 * (y * width + x);
            bool right = x + 1 < width && differ(pixel, pixel + 4);
            bool above = y + 1 < view->height && differ(pixel, pixel + 4 * width);
            if (right || above) {
                tiles[y / TILE * across + x / TILE] = 1;
                found = true;
            }
        }
    }
    return found;
}

/* Half of the pixel at x, y is its own ray's, half those of its four corners, which it shares with its neighbours. Of
 * a tile that was not drawn the pixel's own ray stands for them. */
static void mix_corners(float *rgba, const float *corners, const uint32_t *tiles, const struct colour_view *view,
                        size_t x, size_t y)
{
    float sum[4];
    for (size_t c = 0; c < 4; c++) {
        sum[c] = 4 * rgba[c];
    }
    for (size_t n = 0; n < 4; n++) {
        const size_t right = x + (n % 2 && x + 1 < view->width);
        const size_t up = y + (n / 2 && y + 1 < view->height);
        const bool drawn = tiles[up / TILE * tiles_along(view->width) + right / TILE];
        for (size_t c = 0; c < 4; c++) {
            sum[c] += drawn ? corners[4 * (up * view->width + right) + c] : rgba[c];
        }
    }
    for (size_t c = 0; c < 4; c++) {
        rgba[c] = sum[c] / 8;
    }
}

/* Smooths `rgba`, the picture of `view` (bottom row first), by rays through four places of each pixel, a rotated
 * square, in the tiles with edges. Through translucent surfaces a ray costs more, and most tiles have edges: one,
 * through the lower left corner of each pixel. */
static conus_status smooth_edges(float *rgba, const struct colour_pass *pass, const struct colour_view *view)
{
    static const double square[RAYS][2] = {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}};
    static const double corner[1][2] = {{-0.5, -0.5}};
    const size_t across = tiles_along(view->width);
    float *smooth = memory_raw((size_t)view->width * view->height, 4 * sizeof *smooth);
    uint32_t *tiles = memory_zeroed(across * tiles_along(view->height), sizeof *tiles);
    conus_status status = smooth && tiles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && find_edge_tiles(tiles, rgba, view)) {
        const struct colour_rays rays = {
            .shifts = view->opacity ? corner : square, .count = view->opacity ? 1 : RAYS, .tiles = tiles};
        status = pass->device->functions->draw(smooth, pass->device, pass, view, &rays);
        for (size_t y = 0; y < view->height && !status; y++) {
            for (size_t x = 0; x < view->width; x++) {
                size_t pixel = 4 * (y * view->width + x);
                if (!tiles[y / TILE * across + x / TILE]) {
                    continue;
                }
                if (view->opacity) {
                    mix_corners(rgba + pixel, smooth, tiles, view, x, y);
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

/* Makes the colour pass, which takes `device`, and is entered, in any case. */
static conus_status create_pass(conus_renderer *renderer, struct colour_device *device,
                                const conus_renderer_options *options, struct colour_fields *fields)
{
    struct haze_choice hazy = {0};
    struct tube_colouring streamlines = {0};
    struct colour_pass *pass = &renderer->colour;
    pass->device = device;
    conus_status status = colour_pass_enter(pass);
    if (status) {
        return status;
    }
    status = haze_choose(&hazy, renderer->atlas, options);
    status = status ? status
                    : colour_pass_init(pass, device, renderer->atlas, &renderer->transfer, &hazy, fields,
                                       renderer->max_memory);
    haze_choice_finish(&hazy);
    status = status ? status : tube_colouring_choose(&streamlines, renderer->atlas, options->streamline_colour);
    status = status ? status : colour_pass_paint_streamlines(pass, renderer->atlas, &streamlines, NULL);
    tube_colouring_finish(&streamlines);
    colour_pass_leave(pass);
    return status;
}

/* OpenGL where it is there, unless the other is asked for. */
static conus_status create_device(struct colour_device **out, const conus_renderer_options *options)
{
    conus_status status = CONUS_ERROR_GL;
    if (options->engine > CONUS_ENGINE_GL) {
        return fail(CONUS_ERROR_ARGUMENT, "engine %d; allowed is 0 to %d", (int)options->engine, CONUS_ENGINE_GL);
    }
    if (options->engine != CONUS_ENGINE_RAYS) {
        status = colour_gl_create(out, options->log, options->log_user);
    }
    bool is_absent = status == CONUS_ERROR_GL || status == CONUS_ERROR_UNSUPPORTED;
    if (options->engine == CONUS_ENGINE_GL || !is_absent) {
        return status;
    }
    if (options->engine == CONUS_ENGINE_AUTO && options->log) {
        const conus_note note = {.severity = CONUS_SEVERITY_NOTE, .line = conus_message()};
        options->log(options->log_user, &note);
    }
    return colour_rays_create(out);
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
    struct colour_device *device = NULL;
    const char *own = renderer->atlas->transfer ? renderer->atlas->transfer : "brain";
    conus_status status = transfer_load(&renderer->transfer, options->transfer ? options->transfer : own);
    status = status ? status : make_absolute(&renderer->transfer, atlas_context(renderer->atlas));
    if (!status) {
        colour_fields_start(&fields, atlas, &renderer->transfer);
    }
    status = status ? status : create_device(&device, options);
    status = status ? status : create_pass(renderer, device, options, &fields);
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
    if (renderer) {
        colour_pass_finish(&renderer->colour);
        transfer_finish(&renderer->transfer);
        memory_free(renderer);
    }
}

conus_status conus_renderer_update(conus_renderer *renderer)
{
    conus_status status = colour_pass_enter(&renderer->colour);
    if (!status) {
        status = colour_pass_update(&renderer->colour, renderer->atlas, renderer->max_memory);
        colour_pass_leave(&renderer->colour);
    }
    return status;
}

conus_status renderer_include(conus_renderer *renderer, const uint8_t *areas)
{
    conus_status status = colour_pass_enter(&renderer->colour);
    if (!status) {
        status = colour_pass_include(&renderer->colour, renderer->atlas, areas, renderer->max_memory);
        colour_pass_leave(&renderer->colour);
    }
    return status;
}

conus_status renderer_paint_streamlines(conus_renderer *renderer, const bool *const *is_pale)
{
    conus_status status = colour_pass_enter(&renderer->colour);
    if (!status) {
        status = colour_pass_paint_streamlines(&renderer->colour, renderer->atlas, NULL, is_pale);
        colour_pass_leave(&renderer->colour);
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
    conus_status status = transfer_copy(&transfer, points, count);
    status = status ? status : colour_pass_enter(&renderer->colour);
    if (!status) {
        status = colour_pass_set_transfer(&renderer->colour, renderer->atlas, &transfer, renderer->max_memory);
        colour_pass_leave(&renderer->colour);
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
    return renderer ? renderer->colour.device->functions->name(renderer->colour.device) : "";
}

conus_status renderer_draw(float *rgba, conus_renderer *renderer, const struct colour_view *view, bool smooth)
{
    static const double centre[1][2] = {{0}};
    const struct colour_rays rays = {.shifts = centre, .count = 1};
    const struct colour_pass *pass = &renderer->colour;
    conus_status status = colour_pass_enter(pass);
    if (!status) {
        status = pass->device->functions->draw(rgba, pass->device, pass, view, &rays);
        status = status || !smooth ? status : smooth_edges(rgba, pass, view);
        colour_pass_leave(pass);
    }
    return status;
}
