/* SPDX-License-Identifier: BSD-3-Clause */
/* The picture of cuts through the atlas with the cone in them, and a cut as a figure: with letters, a scale and a
 * legend. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "render/colour/pathways.h"
#include "render/flat/cut.h"
#include "render/image/image.h"
#include "render/image/image_srgb.h"
#include "selection/picture/picture.h"

enum { SIDE_LIMIT = 16384, DPI_LIMIT = 100000 };

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

static conus_status check_size(const conus_cut_view *view)
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
    if (check_size(view)) {
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

/* The axes of the picture; those of an axial cut unless the caller chose some. */
static void copy_axes(double right[3], double up[3], const conus_cut_view *view)
{
    bool is_axial = vec3_length(view->right) == 0;
    memcpy(right, is_axial ? (const double[]){1, 0, 0} : view->right, 3 * sizeof *right);
    memcpy(up, is_axial ? (const double[]){0, 1, 0} : view->up, 3 * sizeof *up);
}

static conus_status draw(conus_cutter *cutter, const conus_cut_view *view)
{
    struct cut_cone cone;
    uint8_t *emphasis = NULL;
    struct cut_view what = {.place = {.width = view->width,
                                      .height = view->height,
                                      .mm_per_pixel = view->mm_per_pixel > 0 ? view->mm_per_pixel : 1},
                            .fill = view->fill,
                            .no_outlines = view->no_outlines};
    memcpy(what.place.centre, view->centre, sizeof what.place.centre);
    copy_axes(what.place.right, what.place.up, view);
    conus_status status = choose_window(what.window, cutter, view->window);
    if (!status && view->selection) {
        const struct cone *of = &view->selection->cone;
        bool has_range = cone_has_range(of);
        cone = (struct cut_cone){.world_from_cone = of->pose.world_from_device,
                                 .slope = tan(of->angle / 2),
                                 .radius = of->radius,
                                 .near = has_range ? of->range[0] : 0,
                                 .far = has_range ? of->range[1] : INFINITY};
        what.cone = &cone;
        what.emphasis = emphasis = picture_emphasis(view->selection, view->chosen);
        status = emphasis ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    status = status ? status : cut_draw(&cutter->cut, &what);
    memory_free(emphasis);
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
    return status ? status : draw(cutter, view);
}

const uint8_t *conus_cutter_rgba(const conus_cutter *cutter)
{
    return cutter->cut.rgba;
}

const uint32_t *conus_cutter_objects(const conus_cutter *cutter)
{
    return cutter->cut.objects;
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

/* A cut shows all areas, also beside pathways, and no haze. */
static conus_status set_up(struct picture *picture, const conus_cut_view *view, const conus_view *sheet)
{
    size_t count = picture->atlas->object_count + 1;
    picture->options = (conus_view){.width = view->width,
                                    .height = view->height,
                                    .selection = view->selection,
                                    .legend = sheet->legend,
                                    .no_legend = sheet->no_legend,
                                    .background = sheet->background,
                                    .dpi = sheet->dpi};
    memcpy(picture->options.background_rgb, sheet->background_rgb, sizeof sheet->background_rgb);
    picture->areas = memory_raw(count, sizeof *picture->areas);
    picture->emphasis = view->selection ? picture_emphasis(view->selection, view->chosen) : NULL;
    if (!picture->areas || (view->selection && !picture->emphasis)) {
        return CONUS_ERROR_MEMORY;
    }
    memset(picture->areas, PATHWAYS_AREA_OVER, count * sizeof *picture->areas);
    return picture_prepare_sheet(picture, memory_limit(0), NULL, NULL);
}

static void lay_out(conus_image *image, const struct picture *picture, const uint8_t *rgba)
{
    struct image_rgba to = image_rgba(image);
    for (uint32_t row = 0; row < image->height; row++) {
        float under[4];
        picture_background(under, &picture->options, (float)row / (float)image->height);
        for (uint32_t column = 0; column < image->width; column++) {
            bool drawn = row < picture->drawing[1] && column < picture->drawing[0];
            const uint8_t *from = drawn ? rgba + 4 * ((size_t)picture->drawing[0] * row + column) : NULL;
            for (int c = 0; c < 4; c++) {
                float level = !drawn ? under[c] : c < 3 ? (float)linear_from_srgb(from[c] / 255.0) : 1;
                to.plane[c][(size_t)image->width * row + column] = level;
            }
        }
    }
}

static conus_status make_image(conus_image **out, struct picture *picture, const conus_cut_view *view,
                               const uint8_t *rgba)
{
    conus_image *image = NULL;
    conus_status status = image_create_rgba(&image, picture->options.width, picture->sheet_height);
    if (!status) {
        image->dpi = picture->options.dpi;
        lay_out(image, picture, rgba);
        status = picture_add_volumes(image, picture->atlas, true);
    }
    if (!status && picture->font) {
        double *axes = picture->camera.world_from_camera;
        copy_axes(axes, axes + 4, view); /* the letters at the edges depend on them */
        picture->frame = (struct camera_frame){.width = picture->drawing[0], .height = picture->drawing[1]};
        status = picture_annotate_cut(image, picture, view->mm_per_pixel);
    }
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

conus_status conus_cut_image(conus_image **out, const conus_atlas *atlas, const conus_cut_view *view,
                             const conus_view *sheet)
{
    conus_cut_view what = *options_of(conus_cut_view, view);
    conus_view on = *options_of(conus_view, sheet);
    struct picture picture = {.atlas = atlas};
    conus_cutter *cutter = NULL;
    conus_status status = check_size(&what);
    if (status) {
        return status;
    }
    if (on.legend > CONUS_LEGEND_NONE || on.background > CONUS_BACKGROUND_TRANSPARENT) {
        return fail(CONUS_ERROR_ARGUMENT, "legend %d, background %d; allowed are at most %d, %d", (int)on.legend,
                    (int)on.background, CONUS_LEGEND_NONE, CONUS_BACKGROUND_TRANSPARENT);
    }
    if (!(on.dpi >= 0 && on.dpi <= DPI_LIMIT)) {
        return fail(CONUS_ERROR_ARGUMENT, "%g dpi; allowed is 0 to %d", on.dpi, DPI_LIMIT);
    }
    status = conus_cutter_create(&cutter, atlas);
    status = status ? status : set_up(&picture, &what, &on);
    if (!status) {
        /* Shrinks the view to the width beside the legend: the shorter side still shows as many mm. An invalid scale
         * stays invalid; conus_cutter_draw() refuses it. */
        double whole = fmin(what.width, what.height);
        double mm_per_pixel = what.mm_per_pixel != 0 ? what.mm_per_pixel : 1;
        what.mm_per_pixel = mm_per_pixel * whole / fmin(picture.drawing[0], picture.drawing[1]);
        what.width = picture.drawing[0];
    }
    status = status ? status : conus_cutter_draw(cutter, &what);
    if (!status && picture.legend) {
        /* Pixels that are not black count as covered, for the place of a legend. */
        const uint8_t *rgba = conus_cutter_rgba(cutter);
        size_t width = picture.drawing[0];
        size_t height = picture.drawing[1];
        picture.rgba = memory_zeroed(width * height, 4 * sizeof *picture.rgba);
        for (size_t y = 0; picture.rgba && y < height; y++) {
            for (size_t x = 0; x < width; x++) {
                const uint8_t *from = rgba + 4 * (width * (height - 1 - y) + x);
                picture.rgba[4 * (width * y + x) + 3] = from[0] || from[1] || from[2] ? 1 : 0;
            }
        }
        status = picture.rgba ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    status = status ? status : make_image(out, &picture, &what, conus_cutter_rgba(cutter));
    conus_cutter_destroy(cutter);
    picture_legend_finish(&picture);
    font_destroy(picture.font);
    memory_free(picture.emphasis);
    memory_free(picture.areas);
    memory_free(picture.rgba);
    return status;
}
