/* SPDX-License-Identifier: BSD-3-Clause */
/* What a picture's camera sees, by rays from it. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "selection/picture/picture.h"
#include "selection/selection.h"

enum { RAYS_ACROSS = 512, PIERCING_ACROSS = 256 /* which take longer */ };

/* The part of a pixel's light from which on something is seen through haze, or as haze: white under a twentieth of a
 * mid grey differs by about one CIEDE2000, which an eye can just tell. */
static const double LEAST_SEEN = 0.05;

/* The rays of a picture through haze. */
struct sight {
    struct picture *picture;
    const struct cone *cone;
    double *part;       /* [object_count + 1] of the ray's light, all 0 between rays */
    double *extinction; /* per mm at a point of each interval of a ray */
};

static bool is_haze(const struct sight *sight, const conus_interval *interval)
{
    return haze_is(sight->picture->hazy, interval->object);
}

/* Of a pathway's haze at a point, per mm (Eq. 8). */
static double extinction_at(const struct sight *sight, uint32_t number, const double world[3])
{
    const struct volume *volume = atlas_object_volume(sight->picture->atlas, number);
    size_t voxel = 0;
    double rgba[4];
    if (!volume_find_voxel(&voxel, volume, world) || volume_object(volume, voxel) != number) {
        return 0;
    }
    transfer_at(rgba, &sight->picture->hazy->transfers[number], (double)volume_value(volume, voxel));
    return transfer_extinction(rgba[3]);
}

/* Shares the light that comes through a step of so many mm; the rest of it. */
static double pass_step(const struct sight *sight, const conus_interval *intervals, size_t count, double distance,
                        double step, double light)
{
    const uint32_t n = sight->cone->resolution;
    double world[3];
    double sum = 0;
    cone_point(world, sight->cone, intervals->pixel % n, intervals->pixel / n, distance);
    for (size_t i = 0; i < count; i++) {
        const conus_interval *at = &intervals[i];
        bool is_there = is_haze(sight, at) && at->entry <= distance && distance < at->exit;
        sight->extinction[i] = is_there ? extinction_at(sight, at->object, world) : 0;
        sum += sight->extinction[i];
    }
    const double taken = light * (1 - exp2(-sum * step));
    for (size_t i = 0; i < count && sum > 0; i++) {
        sight->part[intervals[i].object] += taken * sight->extinction[i] / sum;
    }
    return light * exp2(-sum * step);
}

/* Adds what one ray meets, whose intervals these are, sorted by entry. */
static void see_ray(const struct sight *sight, const conus_interval *intervals, size_t count)
{
    struct picture *picture = sight->picture;
    size_t before = 0; /* what is opaque */
    double from = INFINITY;
    double to = 0;
    double step = INFINITY;
    double light = 1;
    for (; before < count; before++) {
        const conus_interval *at = &intervals[before];
        if (is_haze(sight, at)) {
            from = fmin(from, at->entry);
            to = fmax(to, at->exit);
            step = fmin(step, vec3_length(atlas_object_volume(picture->atlas, at->object)->info.world_from_voxel));
        } else if (picture_draws(picture, at->object)) {
            break;
        }
    }
    to = before < count ? fmin(to, intervals[before].entry) : to;
    while (from < to && light >= LEAST_SEEN) {
        const double length = fmin(step, to - from);
        light = pass_step(sight, intervals, before, from + length / 2, length, light);
        from += step;
    }
    if (before < count) {
        sight->part[intervals[before].object] += light;
    }
    for (size_t i = 0; i < count; i++) {
        const uint32_t number = intervals[i].object;
        picture->seen[number] += sight->part[number] >= LEAST_SEEN ? sight->part[number] : 0;
        sight->part[number] = 0;
    }
}

/* Whether a ray of a square around the picture is in it. */
static bool is_inside(const struct camera *camera, uint32_t across, uint32_t pixel)
{
    const double slope = fmax(camera->slope[0], camera->slope[1]);
    return fabs(cone_coordinate(pixel % across, across)) * slope <= camera->slope[0] &&
           fabs(cone_coordinate(pixel / across, across)) * slope <= camera->slope[1];
}

/* All that rays meet, since areas are left out beside pathways, and haze lets light through. */
static conus_status see_layers(struct sight *sight, const conus_selection *seen)
{
    size_t count = 0;
    const conus_interval *intervals = conus_selection_intervals(&count, seen);
    sight->extinction = memory_raw(count, sizeof *sight->extinction);
    if (!sight->extinction) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && intervals[end].pixel == intervals[first].pixel;) {
            end++;
        }
        if (is_inside(&sight->picture->camera, sight->cone->resolution, intervals[first].pixel)) {
            see_ray(sight, intervals + first, end - first);
        }
    }
    memory_free(sight->extinction);
    return CONUS_OK;
}

/* What the rays of a selection from the camera say. */
static conus_status see_selection(struct picture *picture, const conus_selection *seen)
{
    const size_t objects = picture->atlas->object_count + 1;
    const conus_evidence first = conus_selection_evidence(seen);
    struct sight sight = {.picture = picture, .cone = &seen->cone, .part = memory_zeroed(objects, sizeof *sight.part)};
    conus_status status = !sight.part ? CONUS_ERROR_MEMORY : seen->has_layers ? see_layers(&sight, seen) : CONUS_OK;
    double rays = 0;
    for (uint32_t p = 0; p < first.resolution * first.resolution; p++) {
        const bool is_in = is_inside(&picture->camera, first.resolution, p);
        rays += is_in;
        picture->seen[first.object[p]] += is_in && !seen->has_layers;
    }
    for (size_t n = 0; n < objects; n++) {
        picture->seen[n] /= rays;
    }
    memory_free(sight.part);
    return status;
}

conus_status picture_see(struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    const double slope = fmax(picture->camera.slope[0], picture->camera.slope[1]);
    conus_selector_options rays = CONUS_SELECTOR_OPTIONS_INIT;
    rays.aperture = CONUS_APERTURE_SQUARE;
    rays.layers = pathways_shown(atlas) ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE;
    rays.resolution = rays.layers == CONUS_LAYERS_ALL ? PIERCING_ACROSS : RAYS_ACROSS;
    conus_selector *selector = NULL;
    conus_selection *seen = NULL;
    conus_pose eye;
    picture->seen = memory_zeroed(atlas->object_count + 1, sizeof *picture->seen);
    conus_status status = picture->seen ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : conus_pose_from_matrix(&eye, picture->camera.world_from_camera);
    status = status ? status : conus_selector_create(&selector, atlas, &rays);
    status = status ? status : conus_select(&seen, selector, &eye, degrees_from_radians(2 * atan(slope)));
    status = status ? status : see_selection(picture, seen);
    if (rays.layers == CONUS_LAYERS_VISIBLE) {
        picture->sight = seen;
    } else {
        conus_selection_destroy(seen);
    }
    conus_selector_destroy(selector);
    return status;
}

/* Whether an area that is not hidden lies at a place. */
static bool is_in_area(const conus_atlas *atlas, const double world[3])
{
    bool found = false;
    for (size_t v = 0; v < atlas->volume_count && !found; v++) {
        size_t voxel = 0;
        const struct volume *volume = &atlas->volumes[v];
        const bool is_there = volume->info.role == CONUS_ROLE_PARCELLATION && volume_find_voxel(&voxel, volume, world);
        const uint32_t number = is_there ? volume_object(volume, voxel) : 0;
        found = number && number != VOLUME_BLOCKER && !conus_atlas_is_hidden(atlas, number);
    }
    return found;
}

/* Along a column of the context from one of its ends: whether there is something bright, and whether an area begins
 * within so many voxels of it. */
static bool look_along(bool *is_covered, const conus_atlas *atlas, size_t at[3], int axis, bool is_back, double bright,
                       size_t steps)
{
    const struct volume *context = atlas_context(atlas);
    const size_t *dim = context->info.dim;
    size_t left = SIZE_MAX; /* steps, from the first bright voxel on */
    *is_covered = false;
    for (size_t k = 0; k < dim[axis] && left > 0 && !*is_covered; k++) {
        at[axis] = is_back ? dim[axis] - 1 - k : k;
        const size_t voxel = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
        left = left < SIZE_MAX ? left - 1 : (double)volume_value(context, voxel) > bright ? steps : left;
        if (left < SIZE_MAX) {
            double world[3];
            mat4_point(world, context->info.world_from_voxel,
                       (const double[]){(double)at[0], (double)at[1], (double)at[2]});
            *is_covered = is_in_area(atlas, world);
        }
    }
    return left < SIZE_MAX;
}

conus_status conus_context_is_covered(bool *out, const conus_atlas *atlas)
{
    enum { COLUMNS = 90 };            /* along each side */
    static const double bright = 0.2; /* of the way from black to white */
    static const double reach = 8;    /* mm */
    static const double most = 0.92;  /* of the columns, from all six sides */
    const struct volume *context = atlas_context(atlas);
    double window[2];
    size_t count = 0;
    size_t covered = 0;
    *out = false;
    conus_status status =
        context ? conus_atlas_window(window, atlas, (size_t)(context - atlas->volumes)) : CONUS_ERROR_ARGUMENT;
    for (int n = 0; n < 6 && !status; n++) {
        const int axis = n / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        const size_t *dim = context->info.dim;
        const size_t strides[2] = {dim[u] / COLUMNS + 1, dim[v] / COLUMNS + 1};
        size_t at[3];
        for (at[u] = 0; at[u] < dim[u]; at[u] += strides[0]) {
            for (at[v] = 0; at[v] < dim[v]; at[v] += strides[1]) {
                bool is_covered = false;
                count += look_along(&is_covered, atlas, at, axis, n % 2, window[0] + bright * (window[1] - window[0]),
                                    (size_t)ceil(reach / context->info.spacing[axis]) + 1);
                covered += is_covered;
            }
        }
    }
    *out = count && (double)covered >= most * (double)count;
    return context ? status : CONUS_OK;
}
