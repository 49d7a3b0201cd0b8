/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/selection.h"

#include "base/math3.h"
#include "base/memory.h"

#include <string.h>

enum { DEFAULT_RESOLUTION = 16 };

static conus_status check_options(const conus_selector_options *options)
{
    struct cone cone = {.angle = 1, .resolution = options->resolution};
    conus_status status = cone_check(&cone);
    if (!status && options->slices && options->sampling != CONUS_SLICES) {
        status = fail(CONUS_ERROR_ARGUMENT, "slices: %u with exact sampling, which has none", options->slices);
    }
    return status;
}

conus_status conus_selector_create(conus_selector **out, const conus_atlas *atlas,
                                   const conus_selector_options *options)
{
    conus_selector *selector = memory_zeroed(1, sizeof *selector);
    if (!selector) {
        return CONUS_ERROR_MEMORY;
    }
    selector->atlas = atlas;
    selector->options = options ? *options : (conus_selector_options){0};
    selector->options.resolution = selector->options.resolution ? selector->options.resolution : DEFAULT_RESOLUTION;
    conus_status status = score_find(&selector->score, selector->options.score);
    selector->options.score = NULL;
    status = status ? status : check_options(&selector->options);
    if (!status) {
        const struct engine_options engine = {selector->options.sampling, selector->options.slices,
                                              selector->options.log, selector->options.log_user};
        status = selector->options.engine == CONUS_ENGINE_GL ? engine_gl_create(&selector->engine, atlas, &engine)
                                                             : engine_rays_create(&selector->engine, atlas, &engine);
    }
    if (status) {
        conus_selector_destroy(selector);
        return status;
    }
    *out = selector;
    return CONUS_OK;
}

void conus_selector_destroy(conus_selector *selector)
{
    if (selector) {
        engine_destroy(selector->engine);
        memory_free(selector);
    }
}

const char *conus_selector_engine(const conus_selector *selector)
{
    return selector ? selector->engine->name : "";
}

static conus_status mark_cone(conus_selection *selection)
{
    uint32_t n = selection->cone.resolution;
    selection->in_cone = memory_raw((size_t)n * n, sizeof *selection->in_cone);
    if (!selection->in_cone) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t j = 0; j < n; j++) {
        for (uint32_t i = 0; i < n; i++) {
            selection->in_cone[(size_t)j * n + i] = cone_has_pixel(&selection->cone, i, j);
        }
    }
    return CONUS_OK;
}

static void set_kinds(struct statistics *statistics, const conus_atlas *atlas)
{
    for (size_t i = 0; i < statistics->count; i++) {
        const conus_object *object = conus_atlas_object(atlas, statistics->results[i].object);
        statistics->results[i].kind = object ? object->kind : CONUS_UNASSIGNED;
    }
}

static conus_status answer(conus_selection *selection, conus_selector *selector)
{
    conus_status status = evidence_init(&selection->evidence, selection->cone.resolution);
    status = status ? status : mark_cone(selection);
    status =
        status ? status : selector->engine->functions->look(selector->engine, &selection->evidence, &selection->cone);
    if (!status) {
        evidence_drop_blocked(&selection->evidence);
        status = statistics_gather(&selection->statistics, &selection->evidence, &selection->cone,
                                   selector->atlas->object_count);
    }
    if (!status) {
        set_kinds(&selection->statistics, selector->atlas);
        score_rank(&selection->statistics, selector->score, &selection->cone);
    }
    return status;
}

conus_status conus_select(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle)
{
    struct cone cone = {
        .angle = angle, .resolution = selector->options.resolution, .aperture = selector->options.aperture};
    conus_status status = conus_pose_from_matrix(&cone.pose, pose->world_from_device);
    status = status ? status : cone_check(&cone);
    if (status) {
        return status;
    }
    conus_selection *selection = memory_zeroed(1, sizeof *selection);
    if (!selection) {
        return CONUS_ERROR_MEMORY;
    }
    selection->atlas = selector->atlas;
    selection->sampling = selector->options.sampling;
    selection->cone = cone;
    memcpy(selection->engine, selector->engine->name, sizeof selection->engine);
    status = answer(selection, selector);
    if (status) {
        conus_selection_destroy(selection);
        return status;
    }
    *out = selection;
    return CONUS_OK;
}

void conus_selection_destroy(conus_selection *selection)
{
    if (selection) {
        evidence_finish(&selection->evidence);
        statistics_finish(&selection->statistics);
        memory_free(selection->in_cone);
        memory_free(selection);
    }
}

size_t conus_selection_count(const conus_selection *selection)
{
    return selection ? selection->statistics.count : 0;
}

const conus_result *conus_selection_result(const conus_selection *selection, size_t index)
{
    return selection && index < selection->statistics.count ? &selection->statistics.results[index] : NULL;
}

conus_evidence conus_selection_evidence(const conus_selection *selection)
{
    if (!selection) {
        return (conus_evidence){0};
    }
    return (conus_evidence){selection->evidence.resolution, selection->evidence.object, selection->evidence.distance,
                            selection->evidence.voxel, selection->in_cone};
}

void conus_selection_position(const conus_selection *selection, size_t pixel, double out[3])
{
    uint32_t n = selection ? selection->cone.resolution : 0;
    if (pixel >= (size_t)n * n) {
        out[0] = out[1] = out[2] = NAN;
        return;
    }
    evidence_position(out, &selection->evidence, &selection->cone, (uint32_t)(pixel % n), (uint32_t)(pixel / n));
}
