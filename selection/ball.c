/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_select_ball(): what is at a point, and how near is the rest. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/rank.h"
#include "selection/selection.h"
#include "selection/selector.h"

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
    if (status) {
        return status;
    }
    census_take(&selector->census, selector->atlas, &selection->region);
    near_take(&selector->near, selector->atlas, &selection->region);
    const struct gathering gathering = {.atlas = selector->atlas,
                                        .cone = &selection->cone,
                                        .evidence = &selection->evidence,
                                        .census = &selector->census,
                                        .near = &selector->near,
                                        .tracts = selector_take_tracts(selector, &selection->region),
                                        .tract_index = selector->tract_index,
                                        .solids = &selector->solids,
                                        .region = &selection->region,
                                        .whole = selector->whole,
                                        .group = level_group(selector->level)};
    status = statistics_gather(&selection->statistics, &gathering, &selector->tally);
    status = status ? status : selection_regroup(selection, selector->level);
    status = status ? status : ranking_parse(&share, NULL);
    if (!status) {
        selection_set_kinds(selection);
        set_shares(selection);
        score_rank(&selection->statistics, &share, &view);
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
    region_ball(&selection->region, centre, radius);
    conus_status status = answer_ball(selection, selector);
    if (status) {
        conus_selection_destroy(selection);
        return status;
    }
    *out = selection;
    return CONUS_OK;
}

double conus_selection_ball(const conus_selection *selection)
{
    return selection->region.shape == REGION_BALL ? selection->region.radius : 0;
}

/* 1, 2 or 5 times a power of ten: the largest up to `length`; 1 of a length of 0. */
static double round_number(double length)
{
    double unit = length > 0 ? pow(10, floor(log10(length))) : 1;
    return length >= 5 * unit ? 5 * unit : length >= 2 * unit ? 2 * unit : unit;
}

/* Whether something is near the centre, but not at it. */
static bool has_neighbour(const conus_selection *selection)
{
    for (size_t i = 0; i < selection->statistics.count; i++) {
        const conus_result *result = &selection->statistics.results[i];
        if (result->object && result->distance > 0) {
            return true;
        }
    }
    return false;
}

/* The search begins with a twentieth of the diagonal of the box around all objects, as a round number, and matters as
 * far as the box's farthest corner. */
static conus_status select_nearest(conus_selection **out, conus_selector *selector, const double centre[3])
{
    double low[3];
    double high[3];
    double diagonal[3];
    double far[3];
    conus_status status = conus_atlas_bounds(low, high, selector->atlas);
    if (status) {
        return status;
    }
    vec3_sub(diagonal, high, low);
    for (int a = 0; a < 3; a++) {
        far[a] = fmax(fabs(centre[a] - low[a]), fabs(centre[a] - high[a]));
    }
    double radius = round_number(vec3_length(diagonal) / 20);
    double last = vec3_length(far);
    conus_selection *selection = NULL;
    bool is_enough = false;
    while (!status && !is_enough) {
        conus_selection_destroy(selection);
        selection = NULL;
        status = select_within(&selection, selector, centre, radius);
        is_enough = status || radius >= last || has_neighbour(selection);
        radius *= 2;
    }
    if (!status) {
        *out = selection;
    }
    return status;
}

conus_status conus_select_ball(conus_selection **out, conus_selector *selector, const double centre[3], double radius)
{
    if (selector->range[1] > 0) {
        return fail(CONUS_ERROR_ARGUMENT, "a ball has no axis, along which a range of depths could be");
    }
    if (!vec3_is_finite(centre)) {
        return fail(CONUS_ERROR_ARGUMENT, "point: (%g, %g, %g), finite numbers are needed", centre[0], centre[1],
                    centre[2]);
    }
    if (!(radius >= 0 && isfinite(radius))) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm, allowed are 0 (as far as the nearest) and more", radius);
    }
    return radius > 0 ? select_within(out, selector, centre, radius) : select_nearest(out, selector, centre);
}
