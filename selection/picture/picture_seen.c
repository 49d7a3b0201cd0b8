/* SPDX-License-Identifier: BSD-3-Clause */
/* What a picture's camera sees, by rays from it. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/colour/pathways.h"
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
    status = status ? status : conus_select(&seen, selector, &eye, 2 * atan(slope));
    status = status ? status : see_selection(picture, seen);
    conus_selection_destroy(seen);
    conus_selector_destroy(selector);
    return status;
}
