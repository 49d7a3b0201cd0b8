/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/picture.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/cut.h"

enum { SIDE_LIMIT = 16384 };

static bool is_unit_frame(const double right[3], const double up[3])
{
    static const double slack = 1e-6;
    return fabs(vec3_dot(right, right) - 1) < slack && fabs(vec3_dot(up, up) - 1) < slack &&
           fabs(vec3_dot(right, up)) < slack;
}

static conus_status check(const conus_cut_view *view)
{
    bool default_frame = vec3_length(view->right) == 0 && vec3_length(view->up) == 0;
    if (view->width < 1 || view->height < 1 || view->width > SIDE_LIMIT || view->height > SIDE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "cut of %u x %u pixels; allowed is 1 to %d", view->width, view->height,
                    SIDE_LIMIT);
    }
    if (!default_frame && !is_unit_frame(view->right, view->up)) {
        return fail(CONUS_ERROR_ARGUMENT, "cut: right and up are no perpendicular unit vectors");
    }
    if (!vec3_is_finite(view->centre) || !(view->mm_per_pixel >= 0 && isfinite(view->mm_per_pixel))) {
        return fail(CONUS_ERROR_ARGUMENT, "cut: a centre of numbers and mm per pixel from 0 on are needed");
    }
    if (!(view->fill >= 0 && view->fill <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "cut: fill of %g; allowed is 0 to 1", view->fill);
    }
    return CONUS_OK;
}

static conus_status choose_window(double out[2], const conus_atlas *atlas, const double given[2])
{
    const struct volume *context = atlas_context(atlas);
    out[0] = given[0];
    out[1] = given[1] > given[0] ? given[1] : given[0] + 1;
    bool is_given = given[0] != 0 || given[1] != 0;
    return is_given || !context ? CONUS_OK : conus_atlas_window(out, atlas, (size_t)(context - atlas->volumes));
}

static void place_cone(struct cut_cone *out, const struct cone *cone)
{
    bool has_range = cone_has_range(cone);
    *out = (struct cut_cone){.world_from_cone = cone->pose.world_from_device,
                             .slope = tan(cone->angle / 2),
                             .radius = cone->radius,
                             .near = has_range ? cone->range[0] : 0,
                             .far = has_range ? cone->range[1] : INFINITY};
}

conus_status conus_cut(uint8_t *rgba, uint32_t *objects, const conus_atlas *atlas, const conus_cut_view *view)
{
    struct cut_view cut = {.width = view->width,
                           .height = view->height,
                           .mm_per_pixel = view->mm_per_pixel > 0 ? view->mm_per_pixel : 1,
                           .hidden = view->hidden,
                           .fill = view->fill,
                           .no_outlines = view->no_outlines};
    struct cut_cone cone;
    uint8_t *emphasis = NULL;
    conus_status status = check(view);
    status = status ? status : choose_window(cut.window, atlas, view->window);
    bool is_axial = vec3_length(view->right) == 0;
    memcpy(cut.centre, view->centre, sizeof cut.centre);
    memcpy(cut.right, is_axial ? (const double[]){1, 0, 0} : view->right, sizeof cut.right);
    memcpy(cut.up, is_axial ? (const double[]){0, 1, 0} : view->up, sizeof cut.up);
    if (!status && view->selection) {
        place_cone(&cone, &view->selection->cone);
        cut.cone = &cone;
        cut.emphasis = emphasis = picture_emphasis(view->selection);
        status = emphasis ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    status = status ? status : cut_draw(rgba, objects, atlas, &cut);
    memory_free(emphasis);
    return status;
}
