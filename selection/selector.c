/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes, shares and ends selectors. */
#include "selection/selection.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"
#include "conus/own.h"

#include <string.h>

/* F of Eq. 7. */
static conus_status check_slice_fraction(const conus_selector_options *options)
{
    double fraction = options->slice_fraction;
    char text[TEXT_NUMBER_SIZE];
    if (!(fraction >= 0 && fraction <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "slice_fraction: %s, allowed is more than 0 to 1 (0 = a fifth)",
                    text_number(text, fraction));
    }
    return fraction == 0 || options->sampling == CONUS_SAMPLING_SLICES
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "slice_fraction: %s with exact sampling, which has no slices",
                      text_number(text, fraction));
}

static conus_status check_options(const conus_selector_options *options)
{
    struct cone cone = {.degrees = options->radius == 0 ? 1 : 0,
                        .resolution = options->resolution,
                        .radius = options->radius,
                        .range = {options->range[0], options->range[1]}};
    conus_status status = cone_check(&cone);
    if (!status && options->sampling == CONUS_SAMPLING_SLICES && (options->layers || cone_has_range(&cone))) {
        status = fail(CONUS_ERROR_ARGUMENT, "%s: needs exact sampling, slices see only what is first",
                      options->layers ? "layers" : "range");
    }
    if (!status && options->slices && options->sampling != CONUS_SAMPLING_SLICES) {
        status = fail(CONUS_ERROR_ARGUMENT, "slices: %u with exact sampling, which has none", options->slices);
    }
    return status ? status : check_slice_fraction(options);
}

static conus_status check_weight(const conus_selector *selector)
{
    const conus_selector_options *options = &selector->options;
    const char *score = selector->ranking.formula.text;
    if (!options->weight) {
        return options->prior                        ? fail(CONUS_ERROR_ARGUMENT, "prior: needs a weight")
               : selector->ranking.info.needs_weight ? fail(CONUS_ERROR_ARGUMENT, "score: %s needs a weight", score)
                                                     : CONUS_OK;
    }
    const struct weight_facts *facts = &options->weight->facts;
    const bool is_of_rays = !facts->by_depth && facts->by != WEIGHT_BY_DISTANCE;
    if (facts->by == WEIGHT_BY_ANGLE && options->radius > 0) {
        return fail(CONUS_ERROR_ARGUMENT, "weight: an angle needs a cone, and a radius makes a cylinder");
    }
    if (!is_of_rays && (options->prior || selector->ranking.needs_rays)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %s needs a weight of rays, and this one depends on %s",
                    options->prior ? "prior" : "score", options->prior ? "the posterior" : score,
                    facts->by_depth ? "the depth" : "the distance from a point");
    }
    return facts->by == WEIGHT_BY_OFFSET && !facts->by_depth && options->radius == 0
               ? fail(CONUS_ERROR_ARGUMENT, "weight: an offset needs a cylinder, which has a radius")
               : CONUS_OK;
}

/* Whether the middle of `inner`, by its bounds, lies within those of `outer`. */
static bool holds_middle(const struct mesh *outer, const struct mesh *inner)
{
    for (int axis = 0; axis < 3; axis++) {
        double middle = (inner->shape.low[axis] + inner->shape.high[axis]) / 2;
        if (middle < outer->shape.low[axis] || middle > outer->shape.high[axis]) {
            return false;
        }
    }
    return true;
}

bool selector_lies_in_mesh(const conus_selector *selector, uint32_t number, bool of_any)
{
    const conus_atlas *atlas = selector->atlas;
    const uint32_t *group = level_group(selector->level);
    const struct mesh *inner = atlas_object_mesh(atlas, number);
    uint32_t at = inner ? atlas->objects[number - 1].parent : 0;
    for (; at; at = atlas->objects[at - 1].parent) {
        const struct mesh *outer = atlas_object_mesh(atlas, at);
        if ((of_any || group[at] == group[number]) && outer && holds_middle(outer, inner)) {
            return true;
        }
    }
    return false;
}

static conus_status measure_objects(conus_selector *selector)
{
    const conus_atlas *atlas = selector->atlas;
    selector->whole = memory_zeroed(atlas->object_count + 1, sizeof *selector->whole);
    if (!selector->whole) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const conus_object *object = &atlas->objects[number - 1];
        bool unknown = object->triangles && object->volume_mm3 == 0; /* so is the volume of an area above it */
        if (!atlas->places[number - 1].is_hidden && !selector_lies_in_mesh(selector, number, false)) {
            selector->whole[level_group(selector->level)[number]] += unknown ? NAN : object->volume_mm3;
        }
    }
    return CONUS_OK;
}

/* The surfaces that measure_objects() has counted, but for those of objects whose whole is not known. */
static conus_status list_solids(conus_selector *selector)
{
    const conus_atlas *atlas = selector->atlas;
    conus_status status = CONUS_OK;
    for (uint32_t number = 1; number <= atlas->object_count && !status; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh && !atlas->places[number - 1].is_hidden && !selector_lies_in_mesh(selector, number, false) &&
            selector->whole[level_group(selector->level)[number]] > 0) {
            status = solids_add(&selector->solids, number, mesh);
        }
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
    selector->volume_count = atlas->volume_count;
    selector->options = *options_of(conus_selector_options, options);
    selector->options.resolution =
        selector->options.resolution ? selector->options.resolution : CONUS_RESOLUTION_DEFAULT;
    if (selector->options.weight && selector->options.weight->facts.by_depth) {
        selector->options.layers = CONUS_LAYERS_ALL;
    }
    conus_status status = frame_of_options(&selector->frame, selector->options.frame, CONUS_SPACE_RAS);
    selector->options.frame = NULL; /* the caller's may end */
    status = status ? status : selector_prepare_ranking(selector);
    status = status ? status : check_weight(selector);
    status = status ? status : conus_selector_set_range(selector, NULL);
    const char *level = selector->options.level;
    selector->options.level = NULL;
    selector->level_spec = level && !status ? memory_text(level, strlen(level)) : NULL;
    status = status                           ? status
             : level && !selector->level_spec ? CONUS_ERROR_MEMORY
                                              : level_create(&selector->level, atlas, level);
    selector->has_posterior = selector->options.prior || selector->ranking.needs_posterior;
    if (!status && selector->has_posterior) {
        status = prior_read(&selector->prior, selector->options.prior, atlas, level_group(selector->level));
    }
    selector->options.prior = NULL; /* the caller's may end */
    status = status ? status : measure_objects(selector);
    status = status ? status : list_solids(selector);
    status = status ? status : census_labels_create(&selector->labels, atlas);
    if (!status) {
        if (selector->options.sampling == CONUS_SAMPLING_SLICES && selector->options.slice_fraction == 0) {
            selector->options.slice_fraction = SLICES_FRACTION;
        }
        const struct engine_options engine = {.sampling = selector->options.sampling,
                                              .slices = selector->options.slices,
                                              .slice_fraction = selector->options.slice_fraction,
                                              .log = selector->options.log,
                                              .log_user = selector->options.log_user};
        status = selector->options.engine == CONUS_ENGINE_GL ? engine_gl_create(&selector->engine, atlas, &engine)
                                                             : engine_rays_create(&selector->engine, atlas, &engine);
    }
    if (!status && selector->options.layers == CONUS_LAYERS_ALL) {
        status = selector_prepare_tracts(selector);
    }
    if (status) {
        conus_selector_destroy(selector);
        return status;
    }
    *out = selector;
    return CONUS_OK;
}

conus_status conus_selector_set_range(conus_selector *selector, const double range[2])
{
    conus_selector_options options = selector->options;
    for (int i = 0; range && i < 2; i++) {
        options.range[i] = isnan(range[i]) ? options.range[i] : range[i];
    }
    conus_status status = check_options(&options);
    if (!status) {
        memcpy(selector->range, options.range, sizeof selector->range);
    }
    return status;
}

conus_status selector_share(conus_selector **out, const conus_selector *selector)
{
    conus_selector *shared = memory_zeroed(1, sizeof *shared);
    if (!shared) {
        return CONUS_ERROR_MEMORY;
    }
    *shared = (conus_selector){.atlas = selector->atlas, /* and all scratch is its own */
                               .options = selector->options,
                               .frame = selector->frame,
                               .range = {selector->options.range[0], selector->options.range[1]},
                               .ranking = selector->ranking,
                               .level = selector->level,
                               .level_spec = selector->level_spec,
                               .engine = selector->engine,
                               .axis = selector->axis,
                               .labels = selector->labels,
                               .tract_index = selector->tract_index,
                               .whole = selector->whole,
                               .solids = selector->solids,
                               .clearance_index = selector->clearance_index,
                               .prior = selector->prior,
                               .has_posterior = selector->has_posterior,
                               .inside_only = selector->inside_only,
                               .has_box = selector->has_box,
                               .is_shared = true};
    memcpy(shared->box, selector->box, sizeof shared->box);
    if (selector_prepare_border(shared)) {
        memory_free(shared);
        return CONUS_ERROR_MEMORY;
    }
    *out = shared;
    return CONUS_OK;
}

conus_status selector_prepare_axis(conus_selector *selector)
{
    const conus_selector_options *options = &selector->options;
    bool is_exact = options->engine != CONUS_ENGINE_GL && options->sampling == CONUS_SAMPLING_EXACT;
    if (selector->axis) {
        return CONUS_OK;
    }
    if (is_exact) {
        selector->axis = selector->engine;
        return CONUS_OK;
    }
    conus_status status = engine_rays_create(&selector->axis, selector->atlas,
                                             &(struct engine_options){.sampling = CONUS_SAMPLING_EXACT});
    selector->owns_axis = !status;
    return status;
}

conus_status selector_prepare_tracts(conus_selector *selector)
{
    conus_status status = CONUS_OK;
    if (!selector->tract_index && atlas_has_bundles(selector->atlas)) {
        status = tract_index_create(&selector->tract_index, selector->atlas);
        selector->owns_tract_index = !status;
    }
    return status || !selector->tract_index
               ? status
               : tract_census_prepare(&selector->tracts, selector->tract_index, selector->atlas);
}

conus_status selector_prepare_clearance(conus_selector *selector)
{
    conus_status status = clearance_prepare(&selector->clearance, selector->atlas);
    status = status ? status : selector_prepare_tracts(selector);
    if (!status && !selector->clearance_index) {
        status = clearance_index_create(&selector->clearance_index, selector->atlas);
        selector->owns_clearance_index = !status;
    }
    return status;
}

const struct tract_census *selector_take_tracts(conus_selector *selector, const struct region *region)
{
    if (!selector->tract_index) {
        return NULL;
    }
    tract_census_take(&selector->tracts, selector->tract_index, selector->atlas, region);
    return &selector->tracts;
}

conus_status conus_selector_share(conus_selector **out, const conus_selector *selector)
{
    return selector_share(out, selector);
}

void conus_selector_destroy(conus_selector *selector)
{
    if (selector) {
        if (!selector->is_shared) {
            engine_destroy(selector->engine);
            level_destroy(selector->level);
            memory_free(selector->level_spec);
            memory_free(selector->whole);
            solids_finish(&selector->solids);
            prior_finish(&selector->prior);
            census_labels_destroy(selector->labels, selector->volume_count);
        }
        if (selector->owns_axis) {
            engine_destroy(selector->axis);
        }
        memory_free(selector->on_border);
        aperture_finish(&selector->aperture);
        soft_finish(&selector->soft);
        doses_finish(&selector->doses);
        tally_finish(&selector->tally);
        census_finish(&selector->census);
        near_finish(&selector->near);
        clearance_finish(&selector->clearance);
        if (selector->owns_clearance_index) {
            clearance_index_destroy(selector->clearance_index);
        }
        conus_table_destroy(selector->areas);
        tract_census_finish(&selector->tracts);
        if (selector->owns_tract_index) {
            tract_index_destroy(selector->tract_index);
        }
        memory_free(selector);
    }
}

const char *conus_selector_engine(const conus_selector *selector)
{
    return selector ? selector->engine->name : "";
}

uint32_t conus_selector_resolution(const conus_selector *selector)
{
    return selector ? selector->options.resolution : 0;
}
