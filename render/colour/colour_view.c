/* SPDX-License-Identifier: BSD-3-Clause */
/* Packs a view into the uniform block of the colour pass: planes of Eq. 7, camera, light, cone and markers. */
#include "render/colour/colour.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "render/image/image.h"

struct slices colour_pass_slices(const struct colour_pass *pass, const struct camera *camera, uint32_t count)
{
    struct slices joint = {0};
    uint32_t finest = 1;
    const struct colour_volume *volumes[] = {pass->has_areas ? &pass->areas : NULL,
                                             pass->may_have_context ? &pass->context : NULL,
                                             pass->has_haze ? &pass->haze : NULL};
    for (int i = 0; i < 3; i++) {
        if (volumes[i]) {
            uint32_t own = slices_default(volumes[i]->dim);
            finest = own > finest ? own : finest;
            const double *m = camera->world_from_camera;
            const double forward[3] = {-m[8], -m[9], -m[10]};
            struct slices alone = slices_over(volumes[i]->dim, volumes[i]->world_from_voxel, m + 12, forward, 1);
            if (alone.count) {
                double end = fmax(joint.count ? joint.start + joint.spacing : 0, alone.start + alone.spacing);
                joint.start = joint.count ? fmin(joint.start, alone.start) : alone.start;
                joint.spacing = end - joint.start;
                joint.count = 1;
            }
        }
    }
    if (joint.count) {
        joint.count = count ? count : finest;
        joint.spacing /= joint.count;
    }
    return joint;
}

static void set4(float out[4], const double xyz[3], double w)
{
    for (int i = 0; i < 3; i++) {
        out[i] = (float)xyz[i];
    }
    out[3] = (float)w;
}

static void set_volume(float from_camera[16], float bricks[4], const struct colour_volume *volume,
                       const struct camera *camera)
{
    double m[16];
    mat4_multiply(m, volume->texture_from_world, camera->world_from_camera);
    for (int i = 0; i < 16; i++) {
        from_camera[i] = (float)m[i];
    }
    for (int a = 0; a < 3; a++) {
        bricks[a] = (float)((double)volume->size[a] / BRICKS_EDGE);
    }
    bricks[3] = 1;
}

void colour_view_pack(struct colour_view_block *block, const struct colour_pass *pass, const struct colour_view *view)
{
    static const uint8_t amber[3] = {LOOK_RGB(LOOK_CONE)};
    const struct camera *camera = view->camera;
    double camera_from_world[16], light[3];
    mat4_invert_affine(camera_from_world, camera->world_from_camera);
    struct slices slices = colour_pass_slices(pass, camera, view->slices);
    mat4_direction(light, camera->world_from_camera, (double[]){-0.42, 0.52, 0.74});
    vec3_normalise(light, light);
    for (int i = 0; i < 12; i++) {
        block->world_from_camera[i] = (float)camera->world_from_camera[i];
    }
    set4(block->lens, (double[]){camera->slope[0], camera->slope[1], view->width}, view->height);
    set4(block->middle, (double[]){camera->middle[0], camera->middle[1], 0}, 0);
    set4(block->planes, (double[]){slices.start, slices.count ? slices.spacing : 1, slices.count}, !view->no_skipping);
    set4(block->light, light, 1 - view->fade);
    set4(block->line, (double[]){0.5 * view->line_width, 0.5 * view->line_width, view->shift[0]}, view->shift[1]);
    if (pass->has_areas) {
        set_volume(block->areas_from_camera, block->areas_bricks, &pass->areas, camera);
    }
    if (pass->may_have_context && view->fade < 1) {
        set_volume(block->context_from_camera, block->context_bricks, &pass->context, camera);
    }
    if (pass->has_haze) {
        set_volume(block->haze_from_camera, block->haze_shape, &pass->haze, camera);
    }
    if (view->world_from_cone) {
        const double *m = view->world_from_cone;
        const double forward[3] = {-m[8], -m[9], -m[10]};
        double apex[3], axis[3];
        mat4_point(apex, camera_from_world, m + 12);
        mat4_direction(axis, camera_from_world, forward);
        set4(block->apex, apex, view->cone_slope);
        set4(block->axis, axis, view->cone_length);
        const double reach = view->cone_reach > 0 ? view->cone_reach : 1e9;
        set4(block->cone_shape, (double[]){view->cone_radius, view->cone_start, reach}, 1);
        draw_colour(block->cone_colour, amber, 0.09F);
    }
    size_t count = view->marker_count < COLOUR_MARKER_LIMIT ? view->marker_count : COLOUR_MARKER_LIMIT;
    for (size_t i = 0; i < count; i++) {
        const struct colour_marker *marker = &view->markers[i];
        double centre[3];
        mat4_point(centre, camera_from_world, marker->centre);
        set4(block->markers[i], centre, marker->radius);
        draw_colour(block->marker_colours[i], marker->rgb, 0);
    }
    if (view->pale_rgb) {
        draw_colour(block->pale, view->pale_rgb, 1);
    }
    block->counts[0] = (int32_t)count;
}
