/* SPDX-License-Identifier: BSD-3-Clause */
/* The picture of cuts through the atlas with the cone in them. */
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/flat/cut.h"

#include <string.h>

enum { SIDE_LIMIT = 16384 };

struct conus_cutter {
    struct cut cut;
    double window[2]; /* conus_atlas_window(), once it was asked for */
    bool has_window;
};

static bool is_unit_frame(const double right[3], const double up[3])
{
    static const double slack = 1e-6;
    return fabs(vec3_dot(right, right) - 1) < slack && fabs(vec3_dot(up, up) - 1) < slack &&
           fabs(vec3_dot(right, up)) < slack;
}

conus_status cut_view_check_size(const conus_cut_view *view)
{
    if (view->width < 1 || view->height < 1 || view->width > SIDE_LIMIT || view->height > SIDE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "cut of %u x %u pixels; allowed is 1 to %d", view->width, view->height,
                    SIDE_LIMIT);
    }
    return CONUS_OK;
}

static conus_status check_view(const conus_cut_view *view)
{
    bool default_frame = vec3_length(view->right) == 0 && vec3_length(view->up) == 0;
    if (cut_view_check_size(view)) {
        return CONUS_ERROR_ARGUMENT;
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

static conus_status choose_window(double out[2], conus_cutter *cutter, const double given[2])
{
    const conus_atlas *atlas = cutter->cut.atlas;
    const struct volume *context = atlas_context(atlas);
    out[0] = given[0];
    out[1] = given[1] > given[0] ? given[1] : given[0] + 1;
    if (given[0] != 0 || given[1] != 0 || !context) {
        return CONUS_OK;
    }
    conus_status status = CONUS_OK;
    if (!cutter->has_window) {
        status = conus_atlas_window(cutter->window, atlas, (size_t)(context - atlas->volumes));
        cutter->has_window = !status;
    }
    memcpy(out, cutter->window, sizeof cutter->window);
    return status;
}

void cut_view_axes(double right[3], double up[3], const conus_cut_view *view)
{
    bool is_axial = vec3_length(view->right) == 0;
    memcpy(right, is_axial ? (const double[]){1, 0, 0} : view->right, 3 * sizeof *right);
    memcpy(up, is_axial ? (const double[]){0, 1, 0} : view->up, 3 * sizeof *up);
}

void cutter_cone(struct cut_cone *out, const conus_selection *selection)
{
    const struct cone *cone = &selection->cone;
    bool has_range = cone_has_range(cone);
    double depth = selection->has_layers ? -INFINITY : picture_cone_depth(selection);
    *out = (struct cut_cone){.world_from_cone = cone->pose.world_from_device,
                             .slope = cone_slope(cone),
                             .radius = cone->radius,
                             .near = has_range ? cone->range[0] : 0,
                             .far = has_range           ? cone->range[1]
                                    : depth > -INFINITY ? depth
                                                        : INFINITY};
}

conus_status cutter_list_tracts(bool **out, const conus_atlas *atlas, const conus_selection *selection,
                                bool own_colours, const bool *listed)
{
    *out = NULL;
    if (selection || own_colours || atlas->has_palette || !pathways_shown(atlas)) {
        return CONUS_OK;
    }
    *out = memory_zeroed(atlas->object_count + 1, sizeof **out);
    for (size_t n = 1; *out && n <= atlas->object_count; n++) {
        (*out)[n] = n > atlas->area_count || (listed && listed[n]);
    }
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status draw(conus_cutter *cutter, const conus_cut_view *view, const struct cutter_figure *figure)
{
    struct cut_cone cone;
    uint8_t *emphasis = NULL;
    const bool has_ranks = picture_has_ranks(view->selection, view->own_colours);
    const size_t objects = cutter->cut.atlas->object_count;
    bool *tracts = NULL;
    uint32_t *ranks = NULL;
    uint8_t(*rgb)[3] = NULL;
    uint8_t(*line_rgb)[3] = NULL;
    struct cut_view what = {.place = {.width = view->width,
                                      .height = view->height,
                                      .mm_per_pixel = view->mm_per_pixel > 0 ? view->mm_per_pixel : 1},
                            .fill = view->fill,
                            .no_outlines = view->no_outlines,
                            .line = figure->line,
                            .line_user = figure->line_user};
    memcpy(what.place.centre, view->centre, sizeof what.place.centre);
    cut_view_axes(what.place.right, what.place.up, view);
    conus_status status = choose_window(what.window, cutter, view->window);
    if (!status && view->selection) {
        cutter_cone(&cone, view->selection);
        what.cone = figure->has_cone ? &cone : NULL;
        emphasis = figure->emphasis ? NULL : picture_emphasis(view->selection, has_ranks ? 0 : view->chosen);
        status = emphasis || figure->emphasis ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!status && !figure->ranks) {
        status = cutter_list_tracts(&tracts, cutter->cut.atlas, view->selection, view->own_colours, NULL);
    }
    if (!status && tracts) {
        emphasis = memory_zeroed(objects + 1, sizeof *emphasis);
        status = emphasis ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    for (size_t n = 1; !status && tracts && n <= objects; n++) {
        emphasis[n] = tracts[n] ? EMPHASIS_FULL : EMPHASIS_PALE;
    }
    what.emphasis = emphasis ? emphasis : figure->emphasis;
    if (!status && (view->selection || figure->ranks || tracts) && !view->own_colours) {
        const bool *listed = tracts ? tracts : figure->listed;
        ranks = figure->ranks || tracts ? NULL : picture_ranks(view->selection);
        const uint32_t *by = ranks ? ranks : figure->ranks;
        const bool is_fine = by || tracts;
        rgb = is_fine ? picture_rank_colours(by, cutter->cut.atlas, LOOK_NOT_HIT, listed, view->selection) : NULL;
        line_rgb = is_fine ? picture_rank_colours(by, cutter->cut.atlas, LOOK_OUTLINE, listed, NULL) : NULL;
        what.rgb = (const uint8_t(*)[3])rgb;
        what.line_rgb = (const uint8_t(*)[3])line_rgb;
        status = rgb && line_rgb ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    status = status ? status : cut_draw(&cutter->cut, &what);
    memory_free(emphasis);
    memory_free(tracts);
    memory_free(ranks);
    memory_free(rgb);
    memory_free(line_rgb);
    return status;
}

conus_status conus_cutter_create(conus_cutter **out, const conus_atlas *atlas)
{
    conus_cutter *cutter = memory_zeroed(1, sizeof *cutter);
    conus_status status = cutter ? cut_init(&cutter->cut, atlas) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(cutter);
        return status;
    }
    *out = cutter;
    return CONUS_OK;
}

void conus_cutter_destroy(conus_cutter *cutter)
{
    if (cutter) {
        cut_finish(&cutter->cut);
        memory_free(cutter);
    }
}

conus_status conus_cutter_draw(conus_cutter *cutter, const conus_cut_view *view)
{
    view = options_of(conus_cut_view, view);
    conus_status status = check_view(view);
    return status ? status : draw(cutter, view, &(struct cutter_figure){.has_cone = !view->no_cone});
}

conus_status cutter_draw_figure(const struct cut **out, conus_cutter *cutter, const conus_cut_view *view,
                                const struct cutter_figure *figure)
{
    conus_status status = check_view(view);
    status = status ? status : draw(cutter, view, figure);
    *out = &cutter->cut;
    return status;
}

const uint8_t *conus_cutter_rgba(const conus_cutter *cutter)
{
    return cutter->cut.rgba;
}

const uint32_t *conus_cutter_objects(const conus_cutter *cutter)
{
    return cutter->cut.objects;
}

const uint32_t *conus_cutter_shown(const conus_cutter *cutter)
{
    return cutter->cut.shown;
}

conus_status conus_cut(uint8_t *rgba, uint32_t *objects, const conus_atlas *atlas, const conus_cut_view *view)
{
    conus_cutter *cutter = NULL;
    conus_status status = conus_cutter_create(&cutter, atlas);
    status = status ? status : conus_cutter_draw(cutter, view);
    if (!status) {
        size_t pixels = (size_t)view->width * view->height;
        memcpy(rgba, cutter->cut.rgba, 4 * pixels);
        if (objects) {
            memcpy(objects, cutter->cut.objects, pixels * sizeof *objects);
        }
    }
    conus_cutter_destroy(cutter);
    return status;
}
