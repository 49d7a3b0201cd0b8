/* SPDX-License-Identifier: BSD-3-Clause */
/* A cut as a figure: with letters, a scale and a legend. */
#include "selection/picture/picture.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "render/colour/pathways.h"
#include "render/image/image.h"
#include "render/image/image_srgb.h"

static const uint64_t MAX_MEMORY = UINT64_C(8) << 30;

enum { SIDE_LIMIT = 16384, DPI_LIMIT = 100000 };

static conus_status check_sheet(const conus_cut_view *view, const conus_view *sheet)
{
    if (view->width < 1 || view->height < 1 || view->width > SIDE_LIMIT || view->height > SIDE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "cut of %u x %u pixels; allowed is 1 to %d", view->width, view->height,
                    SIDE_LIMIT);
    }
    if (sheet->legend > CONUS_LEGEND_NONE || sheet->background > CONUS_BACKGROUND_TRANSPARENT) {
        return fail(CONUS_ERROR_ARGUMENT, "legend %d, background %d; allowed are at most %d, %d", (int)sheet->legend,
                    (int)sheet->background, CONUS_LEGEND_NONE, CONUS_BACKGROUND_TRANSPARENT);
    }
    if (!(sheet->dpi >= 0 && sheet->dpi <= DPI_LIMIT)) {
        return fail(CONUS_ERROR_ARGUMENT, "%g dpi; allowed is 0 to %d", sheet->dpi, DPI_LIMIT);
    }
    return CONUS_OK;
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
    return picture_prepare_sheet(picture, MAX_MEMORY, NULL, NULL);
}

/* What is not black counts as covered, for the place of a legend. */
static conus_status find_covered(struct picture *picture, const uint8_t *rgba)
{
    size_t width = picture->drawing[0];
    size_t height = picture->drawing[1];
    picture->rgba = memory_zeroed(width * height, 4 * sizeof *picture->rgba);
    for (size_t y = 0; picture->rgba && y < height; y++) {
        for (size_t x = 0; x < width; x++) {
            const uint8_t *from = rgba + 4 * (width * (height - 1 - y) + x);
            picture->rgba[4 * (width * y + x) + 3] = from[0] || from[1] || from[2] ? 1 : 0;
        }
    }
    return picture->rgba ? CONUS_OK : CONUS_ERROR_MEMORY;
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

/* The axes, where the letters go by. */
static void set_axes(struct picture *picture, const conus_cut_view *view)
{
    bool is_axial = vec3_length(view->right) == 0;
    memcpy(picture->camera.world_from_camera, is_axial ? (const double[]){1, 0, 0} : view->right, 3 * sizeof(double));
    memcpy(picture->camera.world_from_camera + 4, is_axial ? (const double[]){0, 1, 0} : view->up, 3 * sizeof(double));
    picture->frame = (struct camera_frame){.width = picture->drawing[0], .height = picture->drawing[1]};
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
        set_axes(picture, view);
        status = picture_annotate_cut(image, picture, view->mm_per_pixel);
    }
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

/* To what a legend leaves of the width: the drawing's shorter side shows as much as that of the whole. What is no scale
 * stays none, for conus_cutter_draw() to refuse. */
static void fit(conus_cut_view *view, const uint32_t drawing[2])
{
    double whole = fmin(view->width, view->height);
    double mm_per_pixel = view->mm_per_pixel != 0 ? view->mm_per_pixel : 1;
    view->mm_per_pixel = mm_per_pixel * whole / fmin(drawing[0], drawing[1]);
    view->width = drawing[0];
}

conus_status conus_cut_image(conus_image **out, const conus_atlas *atlas, const conus_cut_view *view,
                             const conus_view *sheet)
{
    conus_cut_view what = *options_of(conus_cut_view, view);
    conus_view on = *options_of(conus_view, sheet);
    struct picture picture = {.atlas = atlas};
    conus_cutter *cutter = NULL;
    conus_status status = check_sheet(&what, &on);
    status = status ? status : conus_cutter_create(&cutter, atlas);
    status = status ? status : set_up(&picture, &what, &on);
    if (!status) {
        fit(&what, picture.drawing);
    }
    status = status ? status : conus_cutter_draw(cutter, &what);
    if (!status && picture.legend) {
        status = find_covered(&picture, conus_cutter_rgba(cutter));
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
