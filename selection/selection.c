/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a selection: traces its cone, counts what the cone holds, and gathers the results. */
#include "selection/selection.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"

#include <string.h>

enum {
    PIXELS_AT_ONCE = 1 << 18,
    CONES_AT_ONCE = 1 << 15 /* OpenGL promises 65,535 workgroups along an axis */
};
static const double JUST_BEFORE = 1e-6; /* mm */

void selection_set_kinds(conus_selection *selection)
{
    struct statistics *statistics = &selection->statistics;

    for (size_t i = 0; i < statistics->count; i++) {
        const conus_object *object = conus_atlas_object(selection->atlas, statistics->results[i].object);
        statistics->results[i].kind = object ? object->kind : CONUS_KIND_UNASSIGNED;
    }
}

/* Keeps the voxel that was there where the point is in none of the object's. */
static bool find_voxel(uint64_t *out, const struct volume *volume, uint32_t object, const double point[3])
{
    size_t voxel = 0;
    bool found = volume_find_voxel(&voxel, volume, point) && volume_object(volume, voxel) == object;
    *out = found ? voxel : *out;
    return found;
}

/* An interval that the range cut begins in another voxel: in that of the cut or, where the cut only touches the end of
 * the interval, in the one just before it. */
static void move_entries(conus_selection *selection)
{
    const struct cone *cone = &selection->cone;
    for (size_t s = 0; s < selection->layers.count; s++) {
        conus_interval *interval = &selection->layers.intervals[s];
        const struct volume *volume =
            interval->object == VOLUME_BLOCKER ? NULL : atlas_object_volume(selection->atlas, interval->object);
        uint32_t i = interval->pixel % cone->resolution;
        uint32_t j = interval->pixel / cone->resolution;
        if (volume && interval->entry == cone->range[0] * cone_per_depth(cone, i, j)) {
            double ray[3];
            double point[3];
            cone_ray(ray, cone, i, j);
            cone_origin(point, cone, i, j);
            vec3_add_scaled(point, point, interval->entry, ray);
            if (!find_voxel(&interval->voxel, volume, interval->object, point)) {
                vec3_add_scaled(point, point, -JUST_BEFORE, ray);
                (void)find_voxel(&interval->voxel, volume, interval->object, point);
            }
        }
    }
}

/* Finds the first hits from the layers. Of intervals that begin at one place, as where a ray touches cells at an edge,
 * it is what is hit there without layers: that heeds the order of the cells. */
static conus_status find_first(conus_selection *selection, struct engine *engine)
{
    struct evidence *first = &selection->evidence;
    struct evidence hit;
    conus_status status = evidence_init(&hit, selection->cone.resolution);
    if (status) {
        return status;
    }
    (void)layers_first(first, &selection->layers);
    status = engine->functions->trace(engine, &hit, &selection->cone);
    for (size_t p = 0; p < (size_t)hit.resolution * hit.resolution && !status; p++) {
        if (hit.distance[p] == first->distance[p]) {
            first->object[p] = hit.object[p];
            first->voxel[p] = hit.voxel[p];
        }
    }
    evidence_finish(&hit);
    return status;
}

/* Lists all intervals. Then takes the first hits from them: always where there is a range, else only where nothing was
 * traced. */
static conus_status list_layers(conus_selection *selection, struct engine *engine, bool is_traced)
{
    struct layers *layers = &selection->layers;
    size_t pixels = (size_t)selection->cone.resolution * selection->cone.resolution;
    conus_status status = engine->functions->pierce(engine, layers, &selection->cone);
    status = status ? status : layers_sort(layers, pixels);
    if (!status && cone_has_range(&selection->cone)) {
        layers_clip(layers, &selection->cone);
        move_entries(selection);
        status = find_first(selection, engine);
    } else if (!status && !is_traced && !layers_first(&selection->evidence, layers)) {
        status = engine->functions->trace(engine, &selection->evidence, &selection->cone);
    }
    layers_drop_blockers(layers);
    return status;
}

/* Drops first hits out of the range. Returns whether some rays, which are set in `before`, hit something before it. */
static bool cut_first(struct evidence *first, bool *before, const struct cone *cone)
{
    bool any = false;
    for (uint32_t p = 0; p < first->resolution * first->resolution; p++) {
        double t = first->distance[p];
        bool may_be_out = t < INFINITY && (t > cone->range[1] || cone->range[0] > 0); /* a depth is no longer than t */
        if (may_be_out) {
            double per_depth = cone_per_depth(cone, p % cone->resolution, p / cone->resolution);
            before[p] = t < cone->range[0] * per_depth;
            any = any || before[p];
            if (before[p] || t > cone->range[1] * per_depth) {
                evidence_clear_pixel(first, p);
            }
        }
    }
    return any;
}

/* Cuts the first hits of volumes at the range. Of rays that hit something before it, the layers tell what is first. */
static conus_status find_in_range(conus_selection *selection, struct engine *engine)
{
    struct evidence *first = &selection->evidence;
    struct layers *layers = &selection->layers;
    struct cone cone = selection->cone;
    size_t pixels = (size_t)cone.resolution * cone.resolution;
    bool *before = memory_zeroed(pixels, sizeof *before);
    conus_status status = before ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (before && cut_first(first, before, &cone)) {
        cone.tracing.wanted = before;
        cone.tracing.rays = NULL;
        status = engine->functions->pierce(engine, layers, &cone);
        status = status ? status : layers_sort(layers, pixels);
        if (!status) {
            layers_clip(layers, &cone);
            move_entries(selection);
        }
        for (size_t i = 0; i < layers->count && !status; i++) {
            const conus_interval *interval = &layers->intervals[i];
            if (!first->object[interval->pixel]) { /* the first of its pixel */
                first->object[interval->pixel] = interval->object;
                first->distance[interval->pixel] = interval->entry;
                first->voxel[interval->pixel] = interval->voxel;
            }
        }
    }
    memory_free(before);
    return status;
}

size_t selections_at_once(const conus_selector *selector)
{
    size_t fitting = PIXELS_AT_ONCE / ((size_t)selector->options.resolution * selector->options.resolution);
    fitting = fitting < CONES_AT_ONCE ? fitting : CONES_AT_ONCE;
    return !selector->engine->functions->trace_many || fitting < 1 ? 1 : fitting;
}

/* Traces what is visible, for all selections at once, but for those with a range (NULL is skipped). */
static conus_status trace_together(conus_selection *const *selections, size_t count, struct engine *engine)
{
    struct evidence **evidence = memory_raw(count, sizeof(void *));
    const struct cone **cones = memory_raw(count, sizeof(void *));
    conus_status status = evidence && cones ? CONUS_OK : CONUS_ERROR_MEMORY;
    size_t given = 0;
    for (size_t i = 0; i < count && !status; i++) {
        if (selections[i] && !cone_has_range(&selections[i]->cone)) {
            evidence[given] = &selections[i]->evidence;
            cones[given++] = &selections[i]->cone;
        }
    }
    status = !status && given ? engine->functions->trace_many(engine, evidence, cones, given) : status;
    memory_free(evidence);
    memory_free(cones);
    return status;
}

/* How the first hits of a selection are found. */
enum first_hits {
    TRACED = 0,        /* alone: nothing is listed */
    TRACED_IN_RANGE,   /* from its near end on; only of rays that hit something before it, intervals are listed */
    LISTED,            /* from the list of all intervals */
    TRACED_AND_LISTED, /* each by itself */
};

static enum first_hits find_way(const conus_selection *selection, const conus_selector *selector, bool together)
{
    bool has_range = cone_has_range(&selection->cone);
    /* In a volume, a ray's first hit is the object of its first interval, unless several intervals begin there. In a
     * mesh it need not be: a ray may begin inside. */
    bool layers_show_first = selector->options.engine != CONUS_ENGINE_GL && !atlas_has_meshes(selector->atlas) &&
                             !atlas_has_bundles(selector->atlas);
    if (!selection->has_layers && !has_range) {
        return TRACED;
    }
    if (!selection->has_layers && layers_show_first) {
        return TRACED_IN_RANGE;
    }
    return has_range || (layers_show_first && !together) ? LISTED : TRACED_AND_LISTED;
}

static conus_status trace_by(enum first_hits way, conus_selection *selection, struct engine *engine, bool is_traced)
{
    conus_status status = CONUS_OK;
    if (way != LISTED && !is_traced) {
        selection->cone.tracing.begins_at_range = way == TRACED_IN_RANGE;
        status = engine->functions->trace(engine, &selection->evidence, &selection->cone);
        selection->cone.tracing.begins_at_range = false;
    }
    if (status || way == TRACED) {
        return status;
    }
    return way == TRACED_IN_RANGE ? find_in_range(selection, engine)
                                  : list_layers(selection, engine, way == TRACED_AND_LISTED);
}

conus_status selections_trace(conus_selection *const *selections, size_t count, conus_selector *selector)
{
    conus_status status = CONUS_OK;
    struct engine *engine = selector->engine;
    bool together = count > 1 && engine->functions->trace_many;
    /* The rays of a selector's pixels are those of the last cone that it was made ready for. */
    for (size_t i = 0; i < count; i++) {
        if (selections[i] && (selector->inside_only || cone_is_wide(&selections[i]->cone))) {
            selections[i]->cone.tracing.wanted = selections[i]->in_cone;
            selections[i]->cone.tracing.rays = count == 1 ? &selector->aperture.rays : NULL;
        }
        if (selections[i] && count == 1) {
            selections[i]->cone.tracing.per_depth = selector->aperture.per_depth;
        }
    }
    status = together ? trace_together(selections, count, engine) : status;
    for (size_t i = 0; i < count && !status; i++) {
        conus_selection *selection = selections[i];
        status = selection ? trace_by(find_way(selection, selector, together), selection, engine, together) : CONUS_OK;
        if (selection && !status) {
            evidence_drop_blocked(&selection->evidence);
        }
    }
    for (size_t i = 0; i < count; i++) {
        if (selections[i]) {
            selections[i]->cone.tracing = (struct cone_tracing){0};
        }
    }
    return status;
}

conus_status selection_regroup(conus_selection *selection, const struct level *level)
{
    size_t object_count = selection->atlas->object_count;
    size_t pixels = (size_t)selection->cone.resolution * selection->cone.resolution;
    if (level_is_identity(level)) {
        return CONUS_OK;
    }
    selection->group = memory_copy(level_group(level), object_count + 1, sizeof *selection->group);
    selection->own = memory_copy(selection->evidence.object, pixels, sizeof *selection->own);
    if (!selection->group || !selection->own) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t pixel = 0; pixel < pixels; pixel++) {
        selection->evidence.object[pixel] = selection->group[selection->own[pixel]];
    }
    return selection->has_layers ? layers_regroup(&selection->layers, selection->group, object_count) : CONUS_OK;
}

conus_status selection_begin(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle)
{
    const conus_selector_options *options = &selector->options;
    struct cone cone = {.degrees = angle,
                        .resolution = options->resolution,
                        .aperture = options->aperture,
                        .radius = options->radius,
                        .range = {selector->range[0], selector->range[1]}};
    conus_status status = pose_settle(&cone.pose, pose->world_from_device);
    status = status ? status : cone_check(&cone);
    status = status ? status : weight_check_region(options, false);
    if (status) {
        return status;
    }
    weight_turn(&cone.pose, options->weight);
    if (angle != selector->degrees) {
        selector->degrees = angle;
        selector->slope = tangent(radians_from_degrees(angle) / 2);
    }
    cone.angle = radians_from_degrees(angle);
    cone.slope = selector->slope;
    conus_selection *selection = memory_zeroed(1, sizeof *selection);
    if (!selection) {
        return CONUS_ERROR_MEMORY;
    }
    selection->atlas = selector->atlas;
    selection->sampling = options->sampling;
    selection->slice_fraction = options->slice_fraction;
    selection->has_layers = options->layers == CONUS_LAYERS_ALL;
    selection->cone = cone;
    region_from_cone(&selection->region, &cone);
    memcpy(selection->engine, selector->engine->name, sizeof selection->engine);
    size_t pixels = (size_t)cone.resolution * cone.resolution;
    status = evidence_init(&selection->evidence, cone.resolution);
    status = status ? status : aperture_prepare(&selector->aperture, &selection->cone);
    if (!status) {
        selection->in_cone = memory_copy(selector->aperture.in_cone, pixels, sizeof *selection->in_cone);
        status = selection->in_cone ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (status) {
        conus_selection_destroy(selection);
        return status;
    }
    *out = selection;
    return CONUS_OK;
}

conus_status selection_complete(conus_selection *selection, conus_selector *selector)
{
    conus_status status = aperture_prepare(&selector->aperture, &selection->cone); /* another's may have come between */
    status = status ? status : tally_prepare(&selector->tally, selector->atlas->object_count);
    const conus_weight *weight = selector->options.weight;
    const bool of_rays = weight && !weight->facts.by_depth;
    if (!status && of_rays) {
        status = soft_prepare(&selector->soft, weight, &selector->aperture, &selection->cone);
    }
    if (!status && selection->has_layers) {
        status = census_prepare(&selector->census, selector->atlas, selector->labels);
        if (!status) {
            census_take(&selector->census, selector->atlas, &selection->region);
            status = selector_prepare_tracts(selector);
        }
    }
    if (!status && weight && selection->has_layers) {
        status = doses_prepare(&selector->doses, selector->atlas, selector->tract_index);
    }
    if (!status) {
        struct gathering gathering = {
            .atlas = selector->atlas,
            .cone = &selection->cone,
            .aperture = &selector->aperture,
            .evidence = &selection->evidence,
            .soft = of_rays ? &selector->soft : NULL,
            .layers = selection->has_layers ? &selection->layers : NULL,
            .census = selection->has_layers ? &selector->census : NULL,
            .tracts = selection->has_layers ? selector_take_tracts(selector, &selection->region) : NULL,
            .tract_index = selector->tract_index,
            .solids = selection->has_layers ? &selector->solids : NULL,
            .region = &selection->region,
            .weight = weight,
            .whole = selector->whole,
            .group = level_group(selector->level)};
        if (weight && selection->has_layers) {
            doses_take(&selector->doses, &gathering);
            gathering.doses = &selector->doses;
        }
        status = statistics_gather(&selection->statistics, &gathering, &selector->tally);
    }
    status = status ? status : selection_regroup(selection, selector->level);
    if (!status) {
        selection_set_kinds(selection);
    }
    if (!status && weight && selection->has_layers) {
        doses_share(selection->statistics.results, selection->statistics.count, &selector->doses, selector->atlas);
    }
    if (!status && selector->has_posterior) {
        prior_apply(selection->statistics.results, selection->statistics.count, &selector->prior, &selection->cone);
    }
    return status;
}

conus_status selection_trace(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    conus_status status = selection_begin(&selection, selector, pose, angle);
    status = status ? status : selections_trace(&selection, 1, selector);
    status = status ? status : selection_complete(selection, selector);
    if (status) {
        conus_selection_destroy(selection);
        return status;
    }
    *out = selection;
    return CONUS_OK;
}

conus_status conus_select(conus_selection **out, conus_selector *selector, const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    if (selector->ranking.info.needs_history) {
        return fail(CONUS_ERROR_ARGUMENT, "score: %s needs a history, which only a track has",
                    selector->ranking.formula.text);
    }
    conus_status status = selection_trace(&selection, selector, pose, angle);
    if (!status) {
        selection_rank(selection, selector, NULL);
        *out = selection;
    }
    return status;
}

void conus_selection_destroy(conus_selection *selection)
{
    if (selection) {
        evidence_finish(&selection->evidence);
        layers_finish(&selection->layers);
        memory_free(selection->own);
        memory_free(selection->group);
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

/* What has its colour first. */
static int colour_class(const conus_selection *selection, const conus_result *result)
{
    enum { HIT, ASKED_FOR, BEHIND };
    return result->pixels ? HIT : result->object > selection->atlas->area_count ? ASKED_FOR : BEHIND;
}

size_t conus_selection_rank(const conus_selection *selection, uint32_t object)
{
    const size_t count = conus_selection_count(selection);
    const conus_result *results = conus_selection_result(selection, 0);
    const bool is_known = selection && object && object <= selection->atlas->object_count;
    const uint32_t shown = is_known && selection->group ? selection->group[object] : object;
    size_t place = 0;
    while (is_known && place < count && results[place].object != shown) {
        place++;
    }
    if (!is_known || place == count) {
        return 0;
    }
    const int own = colour_class(selection, &results[place]);
    size_t rank = 1;
    for (size_t i = 0; i < count; i++) {
        const int other = colour_class(selection, &results[i]);
        rank += results[i].object && (other < own || (other == own && i < place));
    }
    return rank;
}

double conus_selection_weight(const conus_selection *selection, uint32_t object)
{
    static const double least = 0.4, few = 0.02, most = 0.5; /* weight, and shares */
    static const double steps = 8;                           /* small changes of a share change no picture */
    const conus_result *result = conus_selection_result(selection, 0);
    const bool is_known = selection && object && object <= selection->atlas->object_count;
    const uint32_t shown = is_known && selection->group ? selection->group[object] : object;
    size_t left = is_known ? conus_selection_count(selection) : 0;
    while (left && result->object != shown) {
        left--;
        result++;
    }
    const double part = left && result->pixels ? fmin(fmax((result->share - few) / (most - few), 0), 1) : 1;
    return least + (1 - least) * rint(steps * part) / steps;
}

const conus_step *conus_selection_step(const conus_selection *selection)
{
    return selection && selection->is_step ? &selection->step : NULL;
}

conus_evidence conus_selection_evidence(const conus_selection *selection)
{
    if (!selection) {
        return (conus_evidence){0};
    }
    return (conus_evidence){selection->evidence.resolution, selection->evidence.object, selection->evidence.distance,
                            selection->evidence.voxel, selection->in_cone};
}

const conus_interval *conus_selection_intervals(size_t *count, const conus_selection *selection)
{
    bool has_layers = selection && selection->has_layers;
    *count = has_layers ? selection->layers.count : 0;
    return has_layers ? selection->layers.intervals : NULL;
}

void conus_selection_position(double out[3], const conus_selection *selection, size_t pixel)
{
    uint32_t n = selection ? selection->cone.resolution : 0;
    if (pixel >= (size_t)n * n) {
        out[0] = out[1] = out[2] = NAN;
        return;
    }
    evidence_position(out, &selection->evidence, &selection->cone, (uint32_t)(pixel % n), (uint32_t)(pixel / n));
}
