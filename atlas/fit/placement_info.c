/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_placement(): where an atlas was, where it is, and how much of it is in the head of its context. */
#include "atlas/fit/fit.h"
#include "base/geometry/math3.h"
#include "conus/own.h"

#include <stddef.h>

static conus_status fill_fit(conus_placement *out, const struct volume *context, const struct area_points *points)
{
    double here[16];
    struct head head;
    conus_status status = head_make(&head, context);
    if (status) {
        return status;
    }
    mat4_identity(here);
    const struct fit fit = fit_of(&head, points, here);
    out->has_context = true;
    out->head_threshold = head.threshold;
    out->in_grid = fit.in_grid;
    out->in_head = fit.in_head;
    head_finish(&head);
    return CONUS_OK;
}

static conus_status fill(conus_placement *out, const conus_atlas *atlas, const struct area_points *points)
{
    double here[16];
    double own_centre[3];
    mat4_identity(here);
    if (!points->count || !atlas_area_bounds(out->low, out->high, atlas, here)) {
        return fail(CONUS_ERROR_DATA, "the atlas has no areas that could be placed");
    }
    if (out->is_warped) {
        for (size_t i = 0; i < 16; i++) {
            out->atlas_from_world[i] = NAN;
        }
        for (size_t i = 0; i < 3; i++) {
            out->own_low[i] = out->own_high[i] = NAN;
        }
        out->growth = NAN;
        out->mirrors = false;
    } else {
        (void)atlas_area_bounds(out->own_low, out->own_high, atlas, out->atlas_from_world); /* there are areas */
    }
    area_points_centre(out->centre, points);
    conus_atlas_own_point(own_centre, atlas, out->centre);
    vec3_sub(own_centre, out->centre, own_centre);
    out->distance_mm = vec3_length(own_centre);
    const struct volume *context = atlas_context(atlas);
    if (context) {
        return fill_fit(out, context, points);
    }
    struct volume inside = {0}; /* of closed surfaces, where the context has no volume */
    conus_status status = surface_head_make(&inside, atlas);
    status = status || !inside.values ? status : fill_fit(out, &inside, points);
    volume_finish(&inside);
    return status;
}

conus_status conus_atlas_placement(conus_placement *out, const conus_atlas *atlas)
{
    if (!out || !atlas) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_placement: a result and an atlas are needed");
    }
    struct area_points points = {0};
    conus_placement placement = {.is_moved = atlas->is_moved, .is_warped = conus_atlas_is_warped(atlas)};
    mat4_identity(placement.atlas_from_world);
    if (atlas->is_moved) {
        memcpy(placement.atlas_from_world, atlas->own_from_world, sizeof placement.atlas_from_world);
    }
    const double determinant = mat4_determinant3(placement.atlas_from_world);
    placement.growth = 1 / fabs(determinant);
    placement.mirrors = determinant < 0;
    conus_status status = area_points_make(&points, atlas);
    status = status ? status : fill(&placement, atlas, &points);
    area_points_finish(&points);
    if (!status) {
        size_t size = out->struct_size && out->struct_size < sizeof placement ? out->struct_size : sizeof placement;
        placement.struct_size = out->struct_size;
        memcpy(out, &placement, size);
    }
    return status;
}
