/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds what is under the mouse: single rays and small balls, by a selector of their own. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "viewer/model/viewer.h"

#include <math.h>
#include <string.h>

static const double ray_angle = 0.1; /* degrees: the one pixel's ray is the axis, whatever it is */

static conus_status make_picker(struct view_atlas *view, conus_layers layers)
{
    const conus_selector_options options = {.resolution = 1, .layers = layers};
    conus_selector **picker = &view->pickers[layers];
    return *picker ? CONUS_OK : conus_selector_create(picker, view->atlas, &options);
}

/* A ray through the context, and how the picture shows it there. */
struct context_ray {
    const conus_atlas *atlas;
    size_t volume;
    conus_transfer_point points[EDITOR_POINTS];
    size_t count;
    double thinned; /* what the fade leaves of it */
};

/* Opacity of 1 mm at a grey value. */
static double opacity_of(const struct context_ray *context_ray, double value)
{
    const conus_transfer_point *last = &context_ray->points[context_ray->count - 1];
    size_t above = 0;
    while (above < context_ray->count && context_ray->points[above].value <= value) {
        above++;
    }
    const conus_transfer_point *low = &context_ray->points[above ? above - 1 : 0];
    const conus_transfer_point *high = above < context_ray->count ? &context_ray->points[above] : last;
    double part = high->value > low->value ? (value - low->value) / (high->value - low->value) : 0;
    return low->rgba[3] + part * (high->rgba[3] - low->rgba[3]);
}

/* The depth of the context's surface, where half of the light is gone, if it is below `limit`; INFINITY where a tenth
 * or more comes through. */
static double depth_of_surface(const struct viewer *viewer, const double origin[3], const double along[3], double most,
                               double limit)
{
    static const double dark = 0.1, half = 0.5;
    struct context_ray context_ray = {
        .atlas = viewer->drawn->atlas, .volume = view_atlas_context(viewer->drawn), .thinned = 1 - viewer_fade(viewer)};
    if (context_ray.volume < conus_atlas_volume_count(viewer->drawn->atlas) && viewer->painter) {
        context_ray.count = painter_transfer(viewer->painter, context_ray.points, EDITOR_POINTS);
    }
    double light = 1;
    double surface = INFINITY;
    double offset[3];
    vec3_sub(offset, viewer->centre, origin);
    const double before = vec3_dot(offset, along) - 2 * viewer->radius; /* there is nothing farther from the middle */
    bool goes_on = context_ray.count > 0;
    for (unsigned step = (unsigned)fmax(before, 0); goes_on && step < most && light > dark; step++) { /* mm */
        double t = step;
        double place[3];
        vec3_add_scaled(place, origin, t, along);
        double value = conus_atlas_value(context_ray.atlas, context_ray.volume, place);
        double opacity = isfinite(value) ? opacity_of(&context_ray, value) : 0;
        light *= opacity > 0 ? pow(1 - fmin(opacity, 1), context_ray.thinned) : 1;
        surface = light <= half ? fmin(surface, t) : surface;
        goes_on = surface < limit || t < limit;
    }
    return light > dark ? INFINITY : surface;
}

static bool is_hit(const struct view_atlas *view, uint32_t number)
{
    const conus_selection *selection = view_atlas_selection(view, FIRST_TOOL);
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object == number && result->pixels + result->pierced > 0) {
            return true;
        }
    }
    return false;
}

/* The distance to the first object that counts; INFINITY and 0 where there is none. */
static double find_first(uint32_t *object, struct view_atlas *view, const conus_pose *pose)
{
    conus_selection *selection = NULL;
    double depth = INFINITY;
    *object = 0;
    if (make_picker(view, CONUS_LAYERS_VISIBLE) ||
        conus_select(&selection, view->pickers[CONUS_LAYERS_VISIBLE], pose, ray_angle)) {
        return INFINITY;
    }
    const conus_evidence evidence = conus_selection_evidence(selection);
    if (evidence.object[0]) {
        *object = evidence.object[0];
        depth = evidence.distance[0];
    }
    conus_selection_destroy(selection);
    return depth;
}

/* The same among what is drawn: areas of voxels would hide pathways and bundles, so where these are shown, the picture
 * has the areas that are hit. */
static double find_first_drawn(uint32_t *object, struct view_atlas *view, const conus_pose *pose)
{
    conus_selection *selection = NULL;
    size_t count = 0;
    double depth = INFINITY;
    *object = 0;
    if (!view_atlas_shows_tracts(view)) {
        return find_first(object, view, pose);
    }
    if (make_picker(view, CONUS_LAYERS_ALL) ||
        conus_select(&selection, view->pickers[CONUS_LAYERS_ALL], pose, ray_angle)) {
        return INFINITY;
    }
    const conus_interval *intervals = conus_selection_intervals(&count, selection);
    for (size_t i = 0; i < count && !*object; i++) { /* those of a pixel are sorted by entry */
        uint32_t number = intervals[i].object;
        const conus_object *info = conus_atlas_object(view->atlas, number);
        if (info->kind != CONUS_KIND_AREA || info->triangles > 0 || is_hit(view, number)) {
            *object = number;
            depth = intervals[i].entry;
        }
    }
    conus_selection_destroy(selection);
    return depth;
}

uint32_t view_atlas_pick(double *depth, struct view_atlas *view, const double origin[3], const double direction[3])
{
    conus_pose pose;
    uint32_t object = 0;
    *depth = conus_pose_along(&pose, origin, direction, NULL) ? INFINITY : find_first_drawn(&object, view, &pose);
    return object;
}

double view_atlas_depth(struct view_atlas *view, const double origin[3], const double direction[3])
{
    conus_pose pose;
    uint32_t object;
    return conus_pose_along(&pose, origin, direction, NULL) ? INFINITY : find_first(&object, view, &pose);
}

uint32_t view_atlas_at(struct view_atlas *view, const double place[3])
{
    conus_cut_view cut = {.width = 1, .height = 1, .window = {0, 1}};
    memcpy(cut.centre, place, sizeof cut.centre);
    if ((!view->probe && conus_cutter_create(&view->probe, view->atlas)) || conus_cutter_draw(view->probe, &cut)) {
        return 0;
    }
    return conus_cutter_objects(view->probe)[0];
}

bool viewer_pick(uint32_t *object, double contact[3], struct viewer *viewer, const double origin[3],
                 const double direction[3], double limit)
{
    conus_pose pose;
    *object = 0;
    if (conus_pose_along(&pose, origin, direction, NULL)) {
        return false;
    }
    const double *m = pose.world_from_device;
    const double along[3] = {-m[8], -m[9], -m[10]};
    double offset[3];
    vec3_sub(offset, origin, viewer->centre);
    double depth = find_first_drawn(object, viewer->drawn, &pose);
    double surface =
        depth_of_surface(viewer, origin, along, fmin(depth, vec3_length(offset) + 2 * viewer->radius), limit);
    if (surface < depth) {
        *object = 0;
        depth = surface;
    }
    if (!(depth < limit)) {
        *object = 0;
        return false;
    }
    vec3_add_scaled(contact, origin, depth, along);
    return true;
}

double view_atlas_value(struct view_atlas *view, uint32_t object, const double place[3])
{
    const conus_object *info = conus_atlas_object(view->atlas, object);
    conus_selection *selection = NULL;
    double value = NAN;
    if (!info || info->kind != CONUS_KIND_PATHWAY || make_picker(view, CONUS_LAYERS_ALL)) {
        return NAN;
    }
    /* Half the diagonal of a voxel: a ball of it has the centre of a voxel in it, wherever it is. */
    const double *s = conus_atlas_volume(view->atlas, info->volume)->spacing;
    double radius = 0.51 * vec3_length(s);
    if (conus_select_ball(&selection, view->pickers[CONUS_LAYERS_ALL], place, radius)) {
        return NAN;
    }
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        value = result->object == object && result->voxels ? result->max_value : value;
    }
    conus_selection_destroy(selection);
    return value;
}
