/* SPDX-License-Identifier: BSD-3-Clause */
/* A cut as a figure: with letters, a scale and a legend. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "selection/picture/picture.h"

#include <string.h>

/* On paper outlines are of one grey, but not those of what stands out, nor of surfaces that are not closed: these have
 * nothing else to show their colour. */
static conus_status grey_outlines(struct picture *picture)
{
    const conus_atlas *atlas = picture->atlas;
    uint8_t(*own)[3] = picture->line_rgb;
    picture->line_rgb = picture_rank_colours(NULL, atlas, LOOK_OUTLINE, NULL, NULL);
    for (uint32_t n = 1; picture->line_rgb && n <= atlas->object_count; n++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, n);
        const bool stands_out = picture->options.listed && picture->options.listed[n] && !picture->options.selection;
        if (stands_out || (mesh && !mesh->shape.closed)) {
            memcpy(picture->line_rgb[n], own ? own[n] : atlas->objects[n - 1].rgb, sizeof *own);
        }
    }
    memory_free(own);
    return picture->line_rgb ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status picture_cut_init(struct picture *picture, const conus_cut_view *view, const conus_view *sheet)
{
    size_t count = picture->atlas->object_count + 1;
    picture->options = (conus_view){.width = view->width,
                                    .height = view->height,
                                    .selection = view->selection,
                                    .legend = sheet->legend,
                                    .legend_rows = sheet->legend_rows,
                                    .no_legend = sheet->no_legend,
                                    .background = sheet->background,
                                    .dpi = sheet->dpi,
                                    .frame = sheet->frame,
                                    .shapes = sheet->shapes,
                                    .print = sheet->print,
                                    .measured = sheet->measured,
                                    .listed = sheet->listed,
                                    .points = sheet->points,
                                    .point_count = sheet->point_count,
                                    .title = sheet->title,
                                    .is_beam = sheet->is_beam,
                                    .own_colours = view->own_colours || sheet->own_colours};
    memcpy(picture->options.background_rgb, sheet->background_rgb, sizeof sheet->background_rgb);
    picture->areas = memory_raw(count, sizeof *picture->areas);
    const bool is_marked = sheet->point_count || (sheet->listed && !picture->options.own_colours);
    bool has_ranks = picture_has_ranks(view->selection, picture->options.own_colours);
    picture->emphasis = view->selection ? picture_emphasis(view->selection, has_ranks ? 0 : view->chosen)
                        : is_marked     ? memory_zeroed(count, sizeof *picture->emphasis)
                                        : NULL;
    if (!picture->areas || ((view->selection || is_marked) && !picture->emphasis)) {
        return CONUS_ERROR_MEMORY;
    }
    memset(picture->areas, PATHWAYS_AREA_OVER, count * sizeof *picture->areas);
    picture_keep_listed(picture);
    conus_status status = sheet->point_count ? picture_points_init(picture) : CONUS_OK;
    status = status ? status : picture_rank(picture, picture_is_dark(&picture->options));
    status = status || sheet->dpi <= 0 ? status : grey_outlines(picture);
    return status ? status : picture_prepare_sheet(picture, memory_limit(0), NULL, NULL);
}

static void lay_out(conus_image *image, const struct picture *picture, const uint8_t *rgba)
{
    const struct image_rgba to = image_rgba(image);
    picture_lay_background(image, &picture->options);
    for (uint32_t row = 0; row < picture->drawing[1]; row++) {
        for (uint32_t column = 0; column < picture->drawing[0]; column++, rgba += 4) {
            float over[4];
            draw_colour(over, rgba, 1);
            image_lay(&to, (size_t)image->width * row + column, over);
        }
    }
}

/* The places as they are seen from before the cut; the camera's first columns are its axes. */
static void draw_measured(struct draw_list *list, const struct picture *picture, const conus_cut_view *view)
{
    const double *axes = picture->camera.world_from_camera;
    double ends[2][2];
    double away[2];
    double normal[3];
    vec3_cross(normal, axes, axes + 4);
    for (int n = 0; n < 2; n++) {
        double offset[3];
        vec3_sub(offset, picture->options.measured + 3 * n, view->centre);
        ends[n][0] = view->width / 2.0 + vec3_dot(axes, offset) / view->mm_per_pixel;
        ends[n][1] = view->height / 2.0 - vec3_dot(axes + 4, offset) / view->mm_per_pixel;
        away[n] = vec3_dot(normal, offset);
    }
    picture_draw_measured(list, picture, ends, away);
}

static conus_status make_image(conus_image **out, struct picture *picture, const conus_cut_view *view,
                               const uint8_t *rgba)
{
    conus_image *image = NULL;
    conus_status status = image_create_listed(&image, picture->options.width, picture->sheet_height);
    if (!status) {
        image->dpi = picture->options.dpi;
        lay_out(image, picture, rgba);
        status = picture_add_volumes(image, picture->atlas, true);
        status = status ? status : picture_add_key(image, picture);
    }
    double *axes = picture->camera.world_from_camera;
    cut_view_axes(axes, axes + 4, view); /* the letters at the edges depend on them */
    bool *shown = memory_zeroed(picture->options.point_count, sizeof *shown);
    status = status || shown ? status : CONUS_ERROR_MEMORY;
    if (!status && picture->options.point_count) {
        status = picture_points_cut_whole(image->list, picture, view, shown);
        picture_points_count(image->list, picture, shown);
    }
    memory_free(shown);
    if (!status && picture->font) {
        picture->frame = (struct camera_frame){.width = picture->drawing[0], .height = picture->drawing[1]};
        picture_annotate_cut(image->list, picture, view->mm_per_pixel);
        if (picture->options.measured) {
            draw_measured(image->list, picture, view);
        }
    }
    status = status || picture->options.shapes ? status : image_paint(image);
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
    bool *listed = NULL;
    conus_status status = cut_view_check_size(&what);
    on.side = CONUS_SIDE_OF_CONE; /* which is of space */
    status = status ? status : picture_check_sheet(&on);
    status = status ? status : picture_points_check(&on);
    if (status) {
        return status;
    }
    status = conus_cutter_create(&cutter, atlas);
    if (!status && !on.point_count) {
        status = cutter_list_tracts(&listed, atlas, what.selection, what.own_colours || on.own_colours, on.listed);
        on.listed = listed ? listed : on.listed;
    }
    status = status ? status : picture_cut_init(&picture, &what, &on);
    if (!status) {
        /* Shrinks the view to the width beside the legend: the shorter side still shows as many mm. An invalid scale
         * stays invalid; conus_cutter_draw() refuses it. */
        double whole = fmin(what.width, what.height);
        double mm_per_pixel = what.mm_per_pixel != 0 ? what.mm_per_pixel : 1;
        what.mm_per_pixel = mm_per_pixel * whole / fmin(picture.drawing[0], picture.drawing[1]);
        what.width = picture.drawing[0];
        what.own_colours = picture.options.own_colours;
    }
    const struct cut *cut = NULL;
    const struct cutter_figure figure = {.ranks = picture.ranks,
                                         .emphasis = picture.emphasis,
                                         .listed = picture.options.listed,
                                         .has_cone = !what.no_cone};
    status = status ? status : cutter_draw_figure(&cut, cutter, &what, &figure);
    if (!status && picture.font) {
        /* Pixels that are not black count as covered, for the place of a legend and for patches under text. */
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
    picture_finish(&picture);
    memory_free(listed);
    return status;
}
