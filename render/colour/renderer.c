/* SPDX-License-Identifier: BSD-3-Clause */
/* The renderer of the public interface: its device, its updates, and its pictures. */
#include "render/colour/colour.h"

#include "base/memory.h"
#include "base/options.h"

#include <math.h>
#include <string.h>

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
    /* A rotated square. Through translucent surfaces a ray costs more, and most squares have edges: there one. */
    static const double square[][2] = {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}};
    static const double corner[][2] = {{-0.5, -0.5}};
    static const struct colour_edges opaque = {.shifts = square, .count = sizeof square / sizeof *square};
    static const struct colour_edges translucent = {.shifts = corner, .count = 1, .is_corner = true};
    const struct colour_pass *pass = &renderer->colour;
    conus_status status = colour_pass_enter(pass);
    if (!status) {
        const struct colour_edges *edges = view->opacity ? &translucent : &opaque;
        status = pass->device->functions->draw(rgba, pass->device, pass, view, smooth ? edges : NULL);
        colour_pass_leave(pass);
    }
    return status;
}
