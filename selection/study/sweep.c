/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the angle at which each object is admitted, and sorts the objects by it. */
#include "selection/study/sweep.h"

#include "atlas/bundles.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/selector.h"
#include "selection/study/admission.h"

#include <stdlib.h>

/* Of the cone that is searched, so that the next object beyond the widest is found. */
static const double WIDEST = MATH3_PI * (1 - 1e-9);

static conus_status check_selector(const conus_selector *selector)
{
    if (selector->options.radius > 0) {
        return fail(CONUS_ERROR_ARGUMENT, "radius: %g mm, but a cylinder has no angle to sweep",
                    selector->options.radius);
    }
    if (selector->options.aperture == CONUS_APERTURE_SQUARE) {
        return fail(CONUS_ERROR_ARGUMENT, "aperture: square, but a sweep over the angle is of round cones");
    }
    return CONUS_OK;
}

static bool is_closed(const conus_atlas *atlas, uint32_t number)
{
    return atlas->objects[number - 1].closed;
}

/* Of every object, as what it is reported. */
static void search(struct admission *admissions, const conus_selector *selector, const struct cone *cone)
{
    const conus_atlas *atlas = selector->atlas;
    const uint32_t *group = level_group(selector->level);
    struct cone widest = *cone;
    struct region region;
    widest.angle = WIDEST;
    region_from_cone(&region, &widest);
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (volume_can_be_hit(&atlas->volumes[i])) {
            admission_of_volume(admissions, &region, &atlas->volumes[i], group);
        }
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            admission_of_mesh(&admissions[group ? group[number] : number], &region, mesh, is_closed(atlas, number));
        }
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
        if (tractogram && !atlas->places[number - 1].is_hidden) {
            admission_of_bundle(&admissions[number], &region, tractogram, atlas_bundle_group(atlas, number));
        }
    }
}

static int compare(const void *a, const void *b)
{
    const conus_admission *x = a;
    const conus_admission *y = b;
    if (x->angle != y->angle) {
        return x->angle < y->angle ? -1 : 1;
    }
    if (x->distance != y->distance) {
        return x->distance < y->distance ? -1 : 1;
    }
    return (x->object > y->object) - (x->object < y->object);
}

static conus_admission describe(const struct admission *admission, const conus_atlas *atlas, const struct cone *cone,
                                uint32_t number)
{
    conus_admission row = {.kind = conus_atlas_object(atlas, number)->kind,
                           .object = number,
                           .angle = 2 * atan(admission->slope),
                           .is_surface = admission->is_surface,
                           .margin = NAN};
    double v[3];
    vec3_sub(v, admission->point, cone->pose.world_from_device + 12);
    row.distance = vec3_length(v);
    memcpy(row.point, admission->point, sizeof row.point);
    return row;
}

/* Sorts what was found; keeps what the widest cone admits, and the margin to the first that it does not. */
static void fill_rows(conus_sweep *sweep, const struct admission *admissions)
{
    for (uint32_t number = 1; number <= sweep->atlas->object_count; number++) {
        if (isfinite(admissions[number].slope)) {
            sweep->rows[sweep->count++] = describe(&admissions[number], sweep->atlas, &sweep->cone, number);
        }
    }
    qsort(sweep->rows, sweep->count, sizeof *sweep->rows, compare);
    for (size_t i = 0; i + 1 < sweep->count; i++) {
        sweep->rows[i].margin = sweep->rows[i + 1].angle - sweep->rows[i].angle;
    }
    while (sweep->count > 0 && sweep->rows[sweep->count - 1].angle > sweep->cone.angle) {
        sweep->count--;
    }
}

static conus_status build(conus_sweep *sweep, const conus_selector *selector)
{
    size_t count = selector->atlas->object_count;
    struct admission *admissions = memory_zeroed(count + 1, sizeof *admissions);
    sweep->rows = memory_raw(count, sizeof *sweep->rows);
    if (!admissions || !sweep->rows) {
        memory_free(admissions);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i <= count; i++) {
        admissions[i].slope = INFINITY;
    }
    search(admissions, selector, &sweep->cone);
    fill_rows(sweep, admissions);
    memory_free(admissions);
    return CONUS_OK;
}

conus_status conus_sweep_create(conus_sweep **out, const conus_selector *selector, const conus_pose *pose,
                                double widest)
{
    const conus_selector_options *options = &selector->options;
    struct cone cone = {
        .angle = widest, .resolution = options->resolution, .range = {options->range[0], options->range[1]}};
    conus_status status = check_selector(selector);
    status = status ? status : conus_pose_from_matrix(&cone.pose, pose->world_from_device);
    status = status ? status : cone_check(&cone);
    if (status) {
        return status;
    }
    conus_sweep *sweep = memory_zeroed(1, sizeof *sweep);
    if (!sweep) {
        return CONUS_ERROR_MEMORY;
    }
    sweep->atlas = selector->atlas;
    sweep->cone = cone;
    status = build(sweep, selector);
    if (status) {
        conus_sweep_destroy(sweep);
        return status;
    }
    *out = sweep;
    return CONUS_OK;
}

void conus_sweep_destroy(conus_sweep *sweep)
{
    if (sweep) {
        memory_free(sweep->rows);
        memory_free(sweep);
    }
}

size_t conus_sweep_count(const conus_sweep *sweep)
{
    return sweep ? sweep->count : 0;
}

const conus_admission *conus_sweep_admission(const conus_sweep *sweep, size_t index)
{
    return sweep && index < sweep->count ? &sweep->rows[index] : NULL;
}
