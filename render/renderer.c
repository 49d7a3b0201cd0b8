/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/renderer.h"

#include "base/memory.h"
#include "render/smooth.h"
#include "render/target.h"

#define DEFAULT_MEMORY (UINT64_C(8) << 30)

/* With the renderer's context current. */
static conus_status fill(conus_renderer *renderer, const conus_renderer_options *options)
{
    struct transfer transfer = {0};
    const char *own = renderer->atlas->transfer ? renderer->atlas->transfer : "brain";
    conus_status status = transfer_load(&transfer, options->transfer ? options->transfer : own);
    if (!status) {
        uint64_t memory = options->max_memory ? options->max_memory : DEFAULT_MEMORY;
        status = colour_pass_init(&renderer->colour, renderer->atlas, &transfer, memory);
    }
    transfer_finish(&transfer);
    return status;
}

conus_status conus_renderer_create(conus_renderer **out, const conus_atlas *atlas,
                                   const conus_renderer_options *options)
{
    static const conus_renderer_options defaults = {0};
    options = options ? options : &defaults;
    conus_renderer *renderer = memory_zeroed(1, sizeof *renderer);
    if (!renderer) {
        return CONUS_ERROR_MEMORY;
    }
    renderer->atlas = atlas;
    renderer->log = options->log;
    renderer->log_user = options->log_user;
    conus_status status = gl_context_create(&renderer->context, options->log, options->log_user);
    struct gl_current previous;
    if (!status) {
        status = gl_context_use(renderer->context, &previous);
    }
    if (!status) {
        status = fill(renderer, options);
        gl_current_restore(&previous);
    }
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
    memory_free(renderer);
}

const char *conus_renderer_device(const conus_renderer *renderer)
{
    return renderer ? gl_context_renderer(renderer->context) : "";
}

static conus_status draw(float *rgba, const struct colour_pass *pass, const struct colour_view *view, bool smooth)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    struct target target = {0};
    conus_status status = target_init(&target, view->width, view->height, &colour, 1);
    if (!status) {
        status = colour_pass_begin(pass, view);
    }
    if (!status) {
        target_bind(&target);
        target_clear(&target);
        status = colour_pass_draw(pass, view);
    }
    if (!status) {
        status = target_read(&target, "colour", rgba);
    }
    if (!status && smooth) {
        status = smooth_edges(rgba, &target, pass, view);
    }
    target_finish(&target);
    return status;
}

conus_status renderer_draw(float *rgba, conus_renderer *renderer, const struct colour_view *view, bool smooth)
{
    struct gl_current previous;
    conus_status status = gl_context_use(renderer->context, &previous);
    if (!status) {
        status = draw(rgba, &renderer->colour, view, smooth);
        gl_current_restore(&previous);
    }
    return status;
}
