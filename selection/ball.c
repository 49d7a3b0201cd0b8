/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_select_ball(): what is at a point, and how near is the rest. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/selection.h"

#include <string.h>

static void add_count(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    (void)volume;
    (void)at;
    *(uint64_t *)user += count;
}

/* The share of a ball is that of its voxels, of the grid on which they lie. */
static void set_shares(conus_selection *selection)
{
    const conus_atlas *atlas = selection->atlas;
    const struct volume *counted = NULL;
    uint64_t voxels = 0;
    for (size_t i = 0; i < selection->statistics.count; i++) {
        conus_result *result = &selection->statistics.results[i];
        /* The volume on whose grid the result was counted; NULL for a mesh, and where areas lie on several grids for
         * what is on no one of them. */
        bool is_scalar = result->object && atlas_object_is_scalar(atlas, result->object);
        bool has_grids = result->object && atlas_parcellation_count(atlas) > 1;
        const struct volume *volume = is_scalar   ? atlas_object_volume(atlas, result->object)
                                      : has_grids ? atlas_only_volume(atlas, result->object)
                                                  : atlas_parcellation(atlas);
        if (volume && volume != counted) {
            voxels = 0;
            census_walk(&selection->region, volume, add_count, &voxels);
            counted = volume;
        }
        bool is_surface = result->object && !result->voxels && atlas_object_mesh(atlas, result->object);
        bool in_grid = volume && isfinite(result->volume) && !is_surface;
        result->share = in_grid && voxels ? (double)result->voxels / (double)voxels : NAN;
    }
}

static conus_status answer_ball(conus_selection *selection, conus_selector *selector)
{
    const struct score_view view = {.cone = &selection->cone};
    struct ranking share;
    conus_status status = tally_prepare(&selector->tally, selector->atlas->object_count);
    status = status ? status : census_prepare(&selector->census, selector->atlas, selector->labels);
    status = status ? status : near_prepare(&selector->near, selector->atlas);
    status = status ? status : selector_prepare_tracts(selector);
    const conus_weight *weight = selector->options.weight;
    if (!status && weight) {
        status = doses_prepare(&selector->doses, selector->atlas, selector->tract_index);
    }
    if (status) {
        return status;
    }
    census_take(&selector->census, selector->atlas, &selection->region);
    near_take(&selector->near, selector->atlas, &selection->region);
    struct gathering gathering = {.atlas = selector->atlas,
                                  .cone = &selection->cone,
                                  .evidence = &selection->evidence,
                                  .census = &selector->census,
                                  .near = &selector->near,
                                  .tracts = selector_take_tracts(selector, &selection->region),
                                  .tract_index = selector->tract_index,
                                  .solids = &selector->solids,
                                  .region = &selection->region,
                                  .weight = weight,
                                  .whole = selector->whole,
                                  .group = level_group(selector->level)};
    if (weight) {
        doses_take(&selector->doses, &gathering);
        gathering.doses = &selector->doses;
    }
    status = statistics_gather(&selection->statistics, &gathering, &selector->tally);
    status = status ? status : selection_regroup(selection, selector->level);
    status = status ? status : ranking_parse(&share, NULL);
    if (!status) {
        selection_set_kinds(selection);
        set_shares(selection);
        if (weight) {
            doses_share(selection->statistics.results, selection->statistics.count, &selector->doses, selector->atlas);
        }
        score_rank(&selection->statistics, &share, &view);
    }
    return status;
}

/* The distance of the nearest object in a ball; infinite where it has none. */
static double nearest_in(const struct near *near, const struct tract_census *tracts)
{
    double nearest = INFINITY;
    for (size_t i = 0; i < near->touched_count; i++) {
        nearest = fmin(nearest, near->objects[near->touched[i]].distance);
    }
    for (size_t i = 0; tracts && i < tracts->touched_count; i++) {
        nearest = fmin(nearest, sqrt(tracts->parts[tracts->touched[i]].square));
    }
    return nearest;
}

/* What is no farther from the nearest object than this counts as equally near. */
static double rounding_of(double distance)
{
    return 1e-9 * (1 + distance);
}

/* Whether the voxels of all volumes but the context have perpendicular edges, which the search for what is far relies
 * on. */
static bool has_right_angles(const conus_atlas *atlas)
{
    bool has = true;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        struct near_cells cells;
        near_cells_init(&cells, &atlas->volumes[i]);
        const bool is_right = cells.gram[0][1] == 0 && cells.gram[1][2] == 0 && cells.gram[2][0] == 0;
        has = has && (is_right || atlas->volumes[i].info.role == CONUS_ROLE_CONTEXT);
    }
    return has;
}

/* Finds the nearest objects but for bundles, with the index of clearances. */
static void find_far(conus_selector *selector, const double centre[3], double farthest)
{
    const conus_atlas *atlas = selector->atlas;
    struct clearance *found = &selector->clearance;
    struct clearance_question question = {.atlas = atlas, .index = selector->clearance_index, .limit = farthest};
    const struct needle point = {.origin = {centre[0], centre[1], centre[2]}, .direction = {0, 0, 1}};
    near_clear(&selector->near);
    clearance_take(found, &question, &point);
    double nearest = found->touched_count ? found->found[1].distance : INFINITY;
    question.groups = level_group(selector->level);
    question.limit = nearest + rounding_of(nearest);
    if (nearest < INFINITY) {
        clearance_take(found, &question, &point);
    }
    for (size_t i = 0; i < found->touched_count; i++) {
        uint32_t object = found->touched[i];
        const struct clearance_found *at = &found->found[object];
        const struct volume *volume = at->source < atlas->volume_count ? &atlas->volumes[at->source] : NULL;
        bool has_value = volume && volume_has_values(volume);
        near_note(&selector->near, object, at->distance, at->point,
                  has_value ? (double)volume_value(volume, at->part) : NAN);
    }
}

/* How far the centre is from the farthest corner of the box around all objects, which is measured once, and the box's
 * diagonal. */
static conus_status measure_box(double *far, double *diagonal, conus_selector *selector, const double centre[3])
{
    double farthest[3];
    double edges[3];
    const double *low = selector->box[0];
    const double *high = selector->box[1];
    conus_status status = selector_prepare_box(selector);
    if (!status) {
        for (int a = 0; a < 3; a++) {
            farthest[a] = fmax(fabs(centre[a] - low[a]), fabs(centre[a] - high[a]));
        }
        vec3_sub(edges, high, low);
        *diagonal = vec3_length(edges);
        *far = vec3_length(farthest) + rounding_of(*diagonal);
    }
    return status;
}

/* Finds what is in the smallest ball tried that has something. Most points lie in an object, or in one of the small
 * balls; for the others there is an index, which takes a while to make, but for bundles and voxels that are not
 * boxes. */
static conus_status find_nearest(struct region *ball, double *nearest, const struct tract_census **tracts,
                                 conus_selector *selector, const double centre[3])
{
    enum { FIRST = 256, LAST = 64 }; /* small balls: parts of the diagonal */
    double radius = CONUS_POINT_RADIUS;
    double far = INFINITY;
    double diagonal = 0;
    bool is_indexed = false;
    conus_status status = CONUS_OK;
    do {
        region_ball(ball, centre, radius);
        if (!is_indexed) {
            near_take(&selector->near, selector->atlas, ball);
        }
        *tracts = selector_take_tracts(selector, ball);
        *nearest = nearest_in(&selector->near, *tracts);
        if (*nearest > radius) {
            status = far == INFINITY ? measure_box(&far, &diagonal, selector, centre) : CONUS_OK;
            radius = fmax(2 * radius, diagonal / FIRST);
            bool is_large = !is_indexed && radius > diagonal / LAST && has_right_angles(selector->atlas);
            status = status || !is_large ? status : selector_prepare_clearance(selector);
            if (is_large && !status) {
                is_indexed = true;
                find_far(selector, centre, far);
            }
        }
    } while (!status && *nearest > ball->radius && ball->radius < far);
    return status;
}

/* Keeps what is as near as the nearest, but for rounding: all that is at the point, or lies equally far from it. */
static void keep_nearest(struct statistics *statistics, double nearest)
{
    const double limit = nearest + rounding_of(nearest);
    size_t kept = 0;
    for (size_t i = 0; i < statistics->count; i++) {
        conus_result *result = &statistics->results[i];
        result->streamlines = 0; /* of no region */
        result->length = NAN;
        if (result->distance <= limit) {
            statistics->results[kept++] = *result;
        }
    }
    statistics->count = kept;
}

/* What is at the point, or else what is nearest. */
static conus_status answer_point(conus_selection *selection, conus_selector *selector, const double centre[3])
{
    const struct score_view view = {.cone = &selection->cone};
    const struct tract_census *tracts = NULL;
    struct region ball;
    struct ranking share;
    double nearest = INFINITY;
    conus_status status = tally_prepare(&selector->tally, selector->atlas->object_count);
    status = status ? status : near_prepare(&selector->near, selector->atlas);
    status = status ? status : selector_prepare_tracts(selector);
    status = status ? status : find_nearest(&ball, &nearest, &tracts, selector, centre);
    if (status) {
        return status;
    }
    const struct gathering gathering = {.atlas = selector->atlas,
                                        .cone = &selection->cone,
                                        .evidence = &selection->evidence,
                                        .near = &selector->near,
                                        .tracts = tracts,
                                        .tract_index = selector->tract_index,
                                        .region = &ball,
                                        .whole = selector->whole,
                                        .group = level_group(selector->level)};
    status = statistics_gather(&selection->statistics, &gathering, &selector->tally);
    status = status ? status : selection_regroup(selection, selector->level);
    status = status ? status : ranking_parse(&share, NULL);
    if (!status) {
        keep_nearest(&selection->statistics, nearest);
        selection_set_kinds(selection);
        score_rank(&selection->statistics, &share, &view); /* no share: by distance, and then by number */
    }
    return status;
}

static conus_status select_within(conus_selection **out, conus_selector *selector, const double centre[3],
                                  double radius)
{
    conus_selection *selection = memory_zeroed(1, sizeof *selection);
    if (!selection) {
        return CONUS_ERROR_MEMORY;
    }
    selection->atlas = selector->atlas;
    memcpy(selection->engine, selector->engine->name, sizeof selection->engine);
    mat4_identity(selection->cone.pose.world_from_device);
    memcpy(selection->cone.pose.world_from_device + 12, centre, 3 * sizeof *centre);
    region_ball(&selection->region, centre, radius > 0 ? radius : CONUS_POINT_RADIUS);
    selection->is_point = radius == 0;
    conus_status status = radius > 0 ? answer_ball(selection, selector) : answer_point(selection, selector, centre);
    if (status) {
        conus_selection_destroy(selection);
        return status;
    }
    *out = selection;
    return CONUS_OK;
}

double conus_selection_ball(const conus_selection *selection)
{
    return selection->region.shape == REGION_BALL && !selection->is_point ? selection->region.radius : 0;
}

conus_status conus_select_ball(conus_selection **out, conus_selector *selector, const double centre[3], double radius)
{
    const conus_weight *weight = selector->options.weight;
    conus_status status = weight_check_region(&selector->options, true);
    if (status) {
        return status;
    }
    if (selector->range[1] > 0) {
        return fail(CONUS_ERROR_ARGUMENT, "a ball has no axis, along which a range of depths could be");
    }
    if (!vec3_is_finite(centre)) {
        return fail(CONUS_ERROR_ARGUMENT, "point: (%g, %g, %g), finite numbers are needed", centre[0], centre[1],
                    centre[2]);
    }
    radius = radius == 0 && weight && weight->facts.by == WEIGHT_BY_DISTANCE ? weight->facts.own : radius;
    if (radius == 0 && weight) {
        return fail(CONUS_ERROR_ARGUMENT, "weight: a point has no dose; a ball has, with a radius");
    }
    if (!(radius >= 0 && isfinite(radius))) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "radius: %g mm, allowed are 0 (what is at the point, or else the nearest) and more", radius);
    }
    return select_within(out, selector, centre, radius);
}
