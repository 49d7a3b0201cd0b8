/* SPDX-License-Identifier: BSD-3-Clause */
/* Cuts side by side on one sheet, at one scale, perhaps with the view in space before them. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "render/colour/colour.h"
#include "render/flat/cut.h"
#include "render/image/image.h"
#include "selection/picture/picture.h"

#include <stdio.h>
#include <string.h>

enum { DEFAULT_WIDTH = 1400, PANEL_LIMIT = 400, TITLE_SIZE = 48 };

/* Around the box of the atlas, as a part of it. */
static const double MARGIN = 0.02;

/* Samples of a context that are looked at, and how bright one is that belongs in the picture: a part of the way from
 * black to white. */
static const double SAMPLES = 2e6;
static const double BRIGHT = 0.15;

/* A cone's start lies in the cuts if it is not farther from the box than so much of its extent. */
static const double NEAR = 0.25;

/* Lengths in em: beside a panel and above it for letters, from it to the middle of those beside it, which are nearer to
 * it than to the next panel's; below it for its title, the strip of the scale bar, and the least height of a panel that
 * has letters above and below. */
static const double BESIDE = 2.4;
static const double ABOVE = 1.6;
static const double LETTER = 0.55;
static const double GAP = 0.4;
static const double TITLE = 1.7;
static const double STRIP = 3;
static const double TALL = 8;

/* How much wider than others the outlines are of what stands out. */
static const double FIRM = 2.5;

/* A panel shows so many mm; its picture is in the pixels `at` to `at` + `size` of the sheet. */
struct panel {
    const conus_cut_plane *plane; /* NULL = the view in space */
    double centre[3], mm[2];
    long at[2], size[2];
};

/* Title of a panel: "z = -12 mm", "z -12", "-12" or nothing. */
enum title { TITLE_WHOLE = 0, TITLE_SHORT, TITLE_NUMBER, TITLE_NONE };

struct sheet {
    struct picture picture;
    conus_view view;
    const conus_cut_view *look;
    conus_renderer *renderer;
    conus_cutter *cutter;
    conus_image *image;
    struct panel *panels;
    size_t count, columns;
    bool trims; /* no height was asked for */
    enum title title;
    bool *shown;  /* [point_count] of points: in a cut */
    bool *listed; /* [objects + 1] what stands out; NULL = as the view says */
    struct haze_choice hazy;
    double pixels_per_mm;
    double beside, above, below, strip; /* pixels around each panel, and below all */
    uint8_t *rgba;                      /* of the panel that is drawn: scratch */
    uint32_t *stack;
};

/* Extent of the box along a unit vector. */
static double extent(const double low[3], const double high[3], const double axis[3])
{
    double sum = 0;
    for (int a = 0; a < 3; a++) {
        sum += fabs(axis[a]) * (high[a] - low[a]);
    }
    return sum * (1 + 2 * MARGIN);
}

/* Makes the box hold what is bright in the context, and the surfaces around the areas. */
static conus_status include_context(struct box3 *box, const conus_atlas *atlas)
{
    const struct volume *volume = atlas_context(atlas);
    double window[2];
    conus_status status = volume ? conus_atlas_window(window, atlas, (size_t)(volume - atlas->volumes)) : CONUS_OK;
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        const struct mesh_shape *shape = &atlas->context_surfaces[i].mesh.shape;
        box3_join(box, shape->low, shape->high);
    }
    if (status || !volume) {
        return status;
    }
    const size_t *dim = volume->info.dim;
    const size_t step = (size_t)ceil(cbrt(fmax((double)volume->voxel_count / SAMPLES, 1)));
    const double bright = window[0] + BRIGHT * (window[1] - window[0]);
    for (size_t k = 0; k < dim[2]; k += step) {
        for (size_t j = 0; j < dim[1]; j += step) {
            for (size_t i = 0; i < dim[0]; i += step) {
                if ((double)volume_value(volume, i + dim[0] * (j + dim[1] * k)) > bright) {
                    double at[3];
                    mat4_point(at, volume->info.world_from_voxel, (double[]){(double)i, (double)j, (double)k});
                    box3_add(box, at);
                }
            }
        }
    }
    return CONUS_OK;
}

/* Makes the box hold the start of a cone that is near it, so that its outline is closed there. */
static void include_cone(struct box3 *box, const conus_selection *selection)
{
    const double *apex = selection ? selection->cone.pose.world_from_device + 12 : NULL;
    bool is_near = apex;
    for (int a = 0; a < 3 && is_near; a++) {
        double reach = NEAR * (box->high[a] - box->low[a]);
        is_near = apex[a] >= box->low[a] - reach && apex[a] <= box->high[a] + reach;
    }
    if (is_near) {
        box3_add(box, apex);
    }
}

/* Centres a cut on the box; its depth stays. */
static void measure_panels(struct sheet *sheet, const double low[3], const double high[3])
{
    double largest = 1;
    for (size_t i = 0; i < sheet->count; i++) {
        struct panel *panel = &sheet->panels[i];
        const conus_cut_plane *plane = panel->plane;
        for (int a = 0; a < 3; a++) {
            panel->centre[a] = (low[a] + high[a]) / 2;
            largest = fmax(largest, (high[a] - low[a]) * (1 + 2 * MARGIN));
        }
        if (plane) {
            double normal[3], offset[3];
            vec3_cross(normal, plane->right, plane->up);
            vec3_sub(offset, plane->at, panel->centre);
            vec3_add_scaled(panel->centre, panel->centre, vec3_dot(offset, normal), normal);
            panel->mm[0] = fmax(extent(low, high, plane->right), 1e-6);
            panel->mm[1] = fmax(extent(low, high, plane->up), 1e-6);
        }
    }
    if (!sheet->panels[0].plane) {
        sheet->panels[0].mm[0] = sheet->panels[0].mm[1] = largest;
    }
}

/* Width and height in mm of rows of so many columns. */
static void measure_rows(double mm[2], const struct sheet *sheet, size_t columns)
{
    mm[0] = mm[1] = 0;
    for (size_t first = 0; first < sheet->count; first += columns) {
        double width = 0;
        double height = 0;
        for (size_t i = first; i < sheet->count && i < first + columns; i++) {
            width += sheet->panels[i].mm[0];
            height = fmax(height, sheet->panels[i].mm[1]);
        }
        mm[0] = fmax(mm[0], width);
        mm[1] += height;
    }
}

/* The number of columns at which the scale is largest; a last row that is not full counts against it. A sheet that is
 * as high as it needs to be has no single column. */
static void choose_scale(struct sheet *sheet)
{
    const uint32_t *drawing = sheet->picture.drawing;
    double best = 0;
    sheet->pixels_per_mm = 0;
    for (size_t columns = sheet->count; columns >= (sheet->trims && sheet->count > 1 ? 2 : 1); columns--) {
        double mm[2];
        size_t rows = (sheet->count + columns - 1) / columns;
        measure_rows(mm, sheet, columns);
        double width = drawing[0] - 2 * sheet->beside * (double)columns;
        double height = drawing[1] - sheet->strip - (sheet->above + sheet->below) * (double)rows;
        double scale = fmin(width / mm[0], height / mm[1]);
        double score = scale * (double)sheet->count / (double)(rows * columns);
        if (score > best) {
            best = score;
            sheet->pixels_per_mm = scale;
            sheet->columns = columns;
        }
    }
}

static void set_bands(struct sheet *sheet, bool has_letters)
{
    const double em = sheet->picture.font ? sheet->picture.em : 0;
    const double gap = GAP * sheet->picture.em;
    sheet->beside = fmax(BESIDE * em, gap);
    sheet->above = has_letters ? fmax(ABOVE * em, gap) : gap;
    sheet->below = sheet->above + TITLE * em;
    sheet->strip = STRIP * em;
}

/* In the middle of the drawing, and each row in the middle of its height. */
static void place_panels(struct sheet *sheet)
{
    double mm[2];
    size_t rows = (sheet->count + sheet->columns - 1) / sheet->columns;
    measure_rows(mm, sheet, sheet->columns);
    double taken = mm[1] * sheet->pixels_per_mm + (sheet->above + sheet->below) * (double)rows + sheet->strip;
    if (sheet->trims) {
        picture_lower(&sheet->picture, (uint32_t)ceil(taken));
    }
    double top = (sheet->picture.drawing[1] - taken) / 2;
    for (size_t first = 0; first < sheet->count; first += sheet->columns) {
        size_t end = first + sheet->columns < sheet->count ? first + sheet->columns : sheet->count;
        double width = 0;
        double height = 0;
        for (size_t i = first; i < end; i++) {
            width += sheet->panels[i].mm[0] * sheet->pixels_per_mm + 2 * sheet->beside;
            height = fmax(height, sheet->panels[i].mm[1] * sheet->pixels_per_mm);
        }
        double left = (sheet->picture.drawing[0] - width) / 2;
        for (size_t i = first; i < end; i++) {
            struct panel *panel = &sheet->panels[i];
            const double size[2] = {panel->mm[0] * sheet->pixels_per_mm, panel->mm[1] * sheet->pixels_per_mm};
            panel->size[0] = lrint(fmax(floor(size[0]), 1));
            panel->size[1] = lrint(fmax(floor(size[1]), 1));
            panel->at[0] = lrint(left + sheet->beside);
            panel->at[1] = lrint(top + sheet->above + (height - size[1]) / 2);
            left += size[0] + 2 * sheet->beside;
        }
        top += height + sheet->above + sheet->below;
    }
}

/* The coordinate of the sheet's space that does not change in the plane; "" of an oblique one. A
 * computed one has one digit where a pixel is 0.1 mm or more. */
static void put_title(char out[TITLE_SIZE], const struct sheet *sheet, const struct panel *panel, enum title title)
{
    static const conus_frame world = {.space = CONUS_SPACE_RAS,
                                      .world_from_space = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    const conus_frame *frame = sheet->view.frame ? sheet->view.frame : &world;
    double at[3], beyond[3], normal[3];
    vec3_cross(normal, panel->plane->right, panel->plane->up);
    vec3_add_scaled(beyond, panel->centre, 1, normal);
    conus_frame_from_world(at, frame, panel->centre);
    conus_frame_from_world(beyond, frame, beyond);
    vec3_sub(beyond, beyond, at);
    out[0] = '\0';
    for (size_t a = 0; a < 3 && title != TITLE_NONE; a++) {
        if (fabs(beyond[a]) > (1 - 1e-9) * vec3_length(beyond)) {
            bool is_fine = frame->space == CONUS_SPACE_CCF;
            const char *axis = conus_space_axis(frame->space, a);
            char digits[PICTURE_NUMBER];
            char number[PICTURE_NUMBER + 3];
            picture_put_place(digits, at[a], !is_fine && sheet->pixels_per_mm <= 10 ? 1 : 3);
            snprintf(number, sizeof number, "%s%s", *digits == '-' ? "\u2212" : "", digits + (*digits == '-'));
            if (title == TITLE_WHOLE) {
                snprintf(out, TITLE_SIZE, "%s = %s %s", axis, number, is_fine ? "\u00b5m" : "mm");
            } else if (title == TITLE_SHORT) {
                snprintf(out, TITLE_SIZE, "%s %s", axis, number);
            } else {
                snprintf(out, TITLE_SIZE, "%s", number);
            }
        }
    }
}

/* The longest form in which each title fits below its panel. */
static enum title choose_title(const struct sheet *sheet)
{
    const struct picture *picture = &sheet->picture;
    enum title title = TITLE_WHOLE;
    for (size_t i = 0; i < sheet->count && title < TITLE_NONE; i++) {
        char text[TITLE_SIZE];
        const struct panel *panel = &sheet->panels[i];
        if (panel->plane && picture->font) {
            put_title(text, sheet, panel, title);
            double room = (double)panel->size[0] + 2 * sheet->beside - GAP * picture->em;
            bool fits = font_width(picture->font, picture->em, text) <= room;
            title += !fits;
            i -= !fits; /* the same one again */
        }
    }
    return title;
}

/* Panels that are low have no letters above and below. */
static conus_status lay_out(struct sheet *sheet)
{
    struct box3 box;
    conus_status status = conus_atlas_bounds(box.low, box.high, sheet->picture.atlas);
    status = status ? status : include_context(&box, sheet->picture.atlas);
    if (status) {
        return status;
    }
    include_cone(&box, sheet->view.selection);
    measure_panels(sheet, box.low, box.high);
    set_bands(sheet, true);
    choose_scale(sheet);
    if (sheet->panels[sheet->count - 1].mm[1] * sheet->pixels_per_mm < TALL * sheet->picture.em) {
        set_bands(sheet, false);
        choose_scale(sheet);
    }
    if (sheet->pixels_per_mm <= 0) {
        return fail(CONUS_ERROR_ARGUMENT, "%u x %u pixels are too few for %zu cuts", sheet->view.width,
                    sheet->view.height, sheet->count);
    }
    place_panels(sheet);
    sheet->title = choose_title(sheet);
    return CONUS_OK;
}

/* Lays `over`, linear and premultiplied, over a pixel of the sheet, whose planes are `to`. */
static void lay_pixel(const struct sheet *sheet, const struct image_rgba *to, long x, long y, const float over[4])
{
    if (x >= 0 && y >= 0 && x < (long)sheet->image->width && y < (long)sheet->image->height) {
        image_lay(to, (size_t)y * sheet->image->width + (size_t)x, over);
    }
}

/* Colours pathways by their values where somebody asked for that. */
static void colour_values(const struct sheet *sheet, const struct cut *cut)
{
    const struct cut_place *at = &cut->of;
    for (size_t i = 0; sheet->picture.hazy && i < (size_t)at->width * at->height; i++) {
        const uint32_t number = cut->shown[i];
        if (number && haze_is(sheet->picture.hazy, number)) {
            double place[3], rgba[4];
            const double across = (double)(i % at->width) + 0.5 - 0.5 * at->width;
            const double down = floor((double)i / at->width) + 0.5 - 0.5 * at->height;
            vec3_add_scaled(place, at->centre, across * at->mm_per_pixel, at->right);
            vec3_add_scaled(place, place, -down * at->mm_per_pixel, at->up);
            haze_colour_at(rgba, sheet->picture.atlas, sheet->picture.hazy, number, place);
            for (int c = 0; c < 3; c++) {
                sheet->rgba[4 * i + (size_t)c] = (uint8_t)lrint(255 * rgba[c]);
            }
        }
    }
}

static bool is_black(const struct sheet *sheet, size_t pixel)
{
    const uint8_t *rgb = sheet->rgba + 4 * pixel;
    return !rgb[0] && !rgb[1] && !rgb[2];
}

/* Over a context areas count where they have a colour: beyond the end of an image without a skull they have none. */
static bool is_empty(const struct sheet *sheet, const struct cut *cut, size_t pixel)
{
    const bool is_nothing = atlas_context(sheet->picture.atlas) ? is_black(sheet, pixel) : !cut->shown[pixel];
    return is_nothing && !(cut->contours && cut->contours[pixel]) && !cut->grey[pixel];
}

/* Makes transparent what is empty: with a context from the panel's edges on, so that a dark ventricle stays; without
 * one all, also within areas that are not filled. */
static void clear_outside(struct sheet *sheet, const struct cut *cut, size_t width, size_t height)
{
    const bool has_context = atlas_context(sheet->picture.atlas);
    size_t top = 0;
    for (size_t i = 0; i < width * height && !has_context; i++) {
        bool is_unfilled = sheet->look->fill == 0 && is_black(sheet, i);
        sheet->rgba[4 * i + 3] = is_empty(sheet, cut, i) || is_unfilled ? 0 : 255;
    }
    for (size_t i = 0; i < width * height && has_context; i++) {
        size_t column = i % width;
        size_t row = i / width;
        bool is_edge = column == 0 || row == 0 || column + 1 == width || row + 1 == height;
        if (is_edge && is_empty(sheet, cut, i) && sheet->rgba[4 * i + 3]) {
            sheet->rgba[4 * i + 3] = 0;
            sheet->stack[top++] = (uint32_t)i;
        }
    }
    while (top) {
        size_t at = sheet->stack[--top];
        size_t column = at % width;
        const size_t next[4] = {column > 0 ? at - 1 : at, column + 1 < width ? at + 1 : at,
                                at >= width ? at - width : at, at + width < width * height ? at + width : at};
        for (int n = 0; n < 4; n++) {
            if (sheet->rgba[4 * next[n] + 3] && is_empty(sheet, cut, next[n])) {
                sheet->rgba[4 * next[n] + 3] = 0;
                sheet->stack[top++] = (uint32_t)next[n];
            }
        }
    }
}

/* Makes transparent what is dark within so many mm of what is, as the rim of a head without its skull mostly is: on
 * paper it would be a black fringe. */
static void clear_fringe(struct sheet *sheet, const struct cut *cut, size_t width, size_t height)
{
    enum { DARK = 64, MARKED = 1 };
    static const double rim = 2.5;
    const long steps = atlas_context(sheet->picture.atlas) ? lrint(ceil(rim * sheet->pixels_per_mm)) : 0;
    const uint8_t *emphasis =
        sheet->picture.ranks ? sheet->picture.emphasis : NULL; /* then pale areas are not filled */
    uint8_t *rgba = sheet->rgba;
    for (long step = 0; step < steps; step++) {
        for (size_t i = 0; i < width * height; i++) {
            const size_t column = i % width;
            const bool is_filled = cut->shown[i] && !(emphasis && emphasis[cut->shown[i]] == EMPHASIS_PALE);
            const bool is_dark =
                rgba[4 * i + 3] && !is_filled && cut->grey[i] < DARK && !(cut->contours && cut->contours[i]);
            const bool is_next = is_dark && ((column && !rgba[4 * i - 1]) || (column + 1 < width && !rgba[4 * i + 7]) ||
                                             (i >= width && !rgba[4 * (i - width) + 3]) ||
                                             (i + width < width * height && !rgba[4 * (i + width) + 3]));
            rgba[4 * i + 3] = is_next ? MARKED : rgba[4 * i + 3];
        }
        for (size_t i = 0; i < width * height; i++) {
            rgba[4 * i + 3] = rgba[4 * i + 3] == MARKED ? 0 : rgba[4 * i + 3];
        }
    }
}

static void lay_cut(const struct sheet *sheet, const struct panel *panel)
{
    const struct image_rgba to = image_rgba(sheet->image);
    for (long y = 0; y < panel->size[1]; y++) {
        for (long x = 0; x < panel->size[0]; x++) {
            const uint8_t *from = sheet->rgba + 4 * ((size_t)panel->size[0] * (size_t)y + (size_t)x);
            if (from[3]) {
                float over[4];
                draw_colour(over, from, 1);
                lay_pixel(sheet, &to, panel->at[0] + x, panel->at[1] + y, over);
            }
        }
    }
}

/* Light edges of the outlines on paper over an image, where a grey line would be lost on its greys: below all of
 * these. On a screen, where a line is a pixel wide, they would hide the image. */
static conus_status trace_edges(const struct sheet *sheet, const struct cut *cut, const struct cut_lines *lines,
                                const bool *skips)
{
    struct cut_lines edges = *lines;
    uint8_t(*white)[3] = picture_rank_colours(NULL, sheet->picture.atlas, LOOK_WHITE, NULL, NULL);
    edges.rgb = (const uint8_t(*)[3])white;
    edges.width *= 2;
    conus_status status =
        white ? cut_trace_areas(&edges, cut->shown, cut->of.width, cut->of.height, skips) : CONUS_ERROR_MEMORY;
    memory_free(white);
    return status;
}

/* Appends the outlines of areas that are no surfaces, then of surfaces, and of the cone over them. */
static conus_status trace(const struct sheet *sheet, const struct cut *cut, struct cut_lines *lines)
{
    const conus_atlas *atlas = sheet->picture.atlas;
    bool *skips = memory_zeroed(atlas->object_count + 1, sizeof *skips);
    if (!skips) {
        cut_lines_finish(lines);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < cut->surface_count; i++) {
        skips[cut->surfaces[i]] = true;
    }
    const bool has_outlines = !sheet->look->no_outlines;
    const bool has_edges = has_outlines && atlas_context(atlas) && sheet->picture.options.dpi > 0;
    conus_status status = has_edges ? trace_edges(sheet, cut, lines, skips) : CONUS_OK;
    if (!status && has_outlines) {
        status = cut_trace_areas(lines, cut->shown, cut->of.width, cut->of.height, skips);
    }
    if (!status && has_outlines && sheet->listed) { /* firm lines around what stands out */
        const double width = lines->width;
        for (size_t n = 1; n <= atlas->object_count; n++) {
            skips[n] = skips[n] || !sheet->listed[n];
        }
        lines->width = FIRM * width;
        status = cut_trace_areas(lines, cut->shown, cut->of.width, cut->of.height, skips);
        lines->width = width;
    }
    memory_free(skips);
    cut_lines_finish(lines);
    if (!status && sheet->view.selection) {
        struct cut_cone cone;
        cutter_cone(&cone, sheet->view.selection);
        cut_trace_cone(lines, &cut->of, &cone);
    }
    return status;
}

/* How many pixels each one is from the outside of what it shows, along rows and columns. */
static void measure_depths(uint32_t *depths, const uint32_t *shown, size_t width, size_t height)
{
    for (size_t row = 0; row < height; row++) {
        for (size_t column = 0; column < width; column++) {
            const size_t i = row * width + column;
            uint32_t left = column && shown[i - 1] == shown[i] ? depths[i - 1] : 0;
            uint32_t up = row && shown[i - width] == shown[i] ? depths[i - width] : 0;
            depths[i] = 1 + (left < up ? left : up);
        }
    }
    for (size_t row = height; row-- > 0;) {
        for (size_t column = width; column-- > 0;) {
            const size_t i = row * width + column;
            uint32_t right = column + 1 < width && shown[i + 1] == shown[i] ? depths[i + 1] : 0;
            uint32_t down = row + 1 < height && shown[i + width] == shown[i] ? depths[i + width] : 0;
            uint32_t least = 1 + (right < down ? right : down);
            depths[i] = least < depths[i] ? least : depths[i];
        }
    }
}

/* The numbers of the legend where there is no view in space to have them: in the middle of each object, as far as one
 * can be from what is beside it. */
static conus_status number_objects(const struct sheet *sheet, const struct cut *cut, const struct panel *panel)
{
    const struct picture *picture = &sheet->picture;
    const size_t count = picture->atlas->object_count;
    const size_t pixels = (size_t)cut->of.width * cut->of.height;
    if (!picture->font || !picture->legend || !picture->ranks || !sheet->panels[0].plane) {
        return CONUS_OK;
    }
    uint32_t *depths = memory_raw(pixels, sizeof *depths);
    size_t *middles = memory_zeroed(count + 1, sizeof *middles);
    conus_status status = depths && middles ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        measure_depths(depths, cut->shown, cut->of.width, cut->of.height);
    }
    for (size_t i = 0; i < pixels && !status; i++) {
        size_t *middle = &middles[cut->shown[i]];
        bool is_first = cut->shown[*middle] != cut->shown[i];
        *middle = is_first || depths[i] > depths[*middle] ? i : *middle;
    }
    for (uint32_t number = 1; number <= count && !status; number++) {
        const size_t at = middles[number];
        const size_t row = at / cut->of.width;
        if (cut->shown[at] == number && picture->ranks[number] && picture_tag(picture, number)) {
            const double place[2] = {(double)panel->at[0] + (double)(at % cut->of.width) + 0.5,
                                     (double)panel->at[1] + (double)row + 0.5};
            picture_draw_tag(sheet->image->list, picture, number, place);
        }
    }
    memory_free(depths);
    memory_free(middles);
    return status;
}

static conus_status draw_cut(struct sheet *sheet, const struct panel *panel)
{
    const struct cut *cut = NULL;
    conus_cut_view view = *sheet->look;
    view.width = (uint32_t)panel->size[0];
    view.height = (uint32_t)panel->size[1];
    view.mm_per_pixel = 1 / sheet->pixels_per_mm;
    view.selection = sheet->view.selection;
    view.own_colours = !sheet->picture.ranks;
    memcpy(view.centre, panel->centre, sizeof view.centre);
    memcpy(view.right, panel->plane->right, sizeof view.right);
    memcpy(view.up, panel->plane->up, sizeof view.up);
    struct cut_lines lines = {.out = sheet->image->list,
                              .list = sheet->picture.atlas->objects,
                              .rgb = (const uint8_t(*)[3])sheet->picture.line_rgb,
                              .width = sheet->picture.line,
                              .at = {(double)panel->at[0], (double)panel->at[1]},
                              .limit = {(double)panel->size[0], (double)panel->size[1]}};
    view.no_outlines = true;
    const struct cutter_figure figure = {.line = cut_lines_add,
                                         .line_user = &lines,
                                         .ranks = sheet->picture.ranks,
                                         .emphasis = sheet->picture.emphasis,
                                         .listed = sheet->view.listed};
    conus_status status = cutter_draw_figure(&cut, sheet->cutter, &view, &figure);
    size_t pixels = (size_t)view.width * view.height;
    sheet->rgba = status ? NULL : memory_copy(cut->rgba, pixels, 4);
    sheet->stack = sheet->rgba ? memory_raw(pixels, sizeof *sheet->stack) : NULL;
    status = status || sheet->stack ? status : CONUS_ERROR_MEMORY;
    if (!status) {
        colour_values(sheet, cut);
        clear_outside(sheet, cut, view.width, view.height);
        clear_fringe(sheet, cut, view.width, view.height);
        if (view.selection) {
            struct cut_cone cone;
            cutter_cone(&cone, view.selection);
            cone.no_line = true;
            cone.areas = cut->shown;
            cut_draw_cone(sheet->rgba, &cut->of, &cone);
        }
        lay_cut(sheet, panel);
        status = trace(sheet, cut, &lines);
        status = status ? status : number_objects(sheet, cut, panel);
    }
    memory_free(lines.points); /* of a cut that failed */
    memory_free(sheet->rgba);
    memory_free(sheet->stack);
    return status;
}

static bool has_panel_letters(const struct sheet *sheet)
{
    return sheet->picture.font && sheet->view.print && sheet->count > 1;
}

/* It has the bands of a cut's letters, too, but for that of its own. Its letters are as large as the sheet's. A
 * background that changes from row to row is the sheet's own. */
static conus_status draw_space(struct sheet *sheet, const struct panel *panel)
{
    conus_image *image = NULL;
    conus_view view = sheet->view;
    const long left = lrint(fmax((double)panel->at[0] - sheet->beside, 0));
    const long top = lrint(fmax((double)panel->at[1] - (has_panel_letters(sheet) ? 0 : sheet->above), 0));
    view.width = (uint32_t)(panel->size[0] + 2 * (panel->at[0] - left));
    view.height = (uint32_t)lrint((double)(panel->at[1] - top + panel->size[1]) + sheet->below);
    view.legend = CONUS_LEGEND_NONE;
    view.legend_rows = !sheet->picture.legend    ? 0 /* the numbers of the one that is beside */
                       : sheet->view.legend_rows ? sheet->view.legend_rows
                                                 : UINT32_MAX;
    view.shapes = true;
    view.dpi = sheet->picture.em * 72 / LOOK_FIGURE_POINTS;
    view.background = view.background == CONUS_BACKGROUND_LIGHT ? CONUS_BACKGROUND_TRANSPARENT : view.background;
    conus_status status = conus_render(&image, sheet->renderer, &view);
    if (status) {
        return status;
    }
    const struct image_rgba from = image_rgba(image);
    const struct image_rgba to = image_rgba(sheet->image);
    for (uint32_t y = 0; y < view.height; y++) {
        for (uint32_t x = 0; x < view.width; x++) {
            size_t at = (size_t)y * image->width + x;
            const float over[4] = {from.plane[0][at], from.plane[1][at], from.plane[2][at], from.plane[3][at]};
            lay_pixel(sheet, &to, left + (long)x, top + (long)y, over);
        }
    }
    draw_take(sheet->image->list, image->list, (double[]){(double)left, (double)top});
    conus_image_destroy(image);
    return CONUS_OK;
}

static void write_centred(const struct sheet *sheet, double x, double baseline, double size, const char *text)
{
    const struct picture *picture = &sheet->picture;
    const double at[2] = {x - font_width(picture->font, size, text) / 2, baseline};
    draw_text(sheet->image->list, picture->font, at, size, picture->ink, text);
}

/* Whether the panel before it is seen from the same side: one of them has letters. */
static bool continues(const struct sheet *sheet, const struct panel *panel)
{
    const conus_cut_plane *before = panel > sheet->panels ? panel[-1].plane : NULL;
    const double alike = 1 - 1e-9;
    return before && vec3_dot(before->right, panel->plane->right) > alike &&
           vec3_dot(before->up, panel->plane->up) > alike;
}

/* Letters in the bands around the cut, where they lie on nothing, and the title below. */
static void annotate(const struct sheet *sheet, const struct panel *panel)
{
    const double em = sheet->picture.em;
    const double size = PICTURE_LETTER * em;
    const double middle[2] = {(double)panel->at[0] + (double)panel->size[0] / 2,
                              (double)panel->at[1] + (double)panel->size[1] / 2};
    const double bottom = (double)(panel->at[1] + panel->size[1]);
    const int letters = continues(sheet, panel) ? 0 : sheet->above > GAP * em ? 4 : 2;
    const double places[4][2] = {{(double)panel->at[0] - LETTER * em, middle[1] + 0.36 * size},
                                 {(double)(panel->at[0] + panel->size[0]) + LETTER * em, middle[1] + 0.36 * size},
                                 {middle[0], bottom + 0.5 * sheet->above + 0.36 * size},
                                 {middle[0], (double)panel->at[1] - 0.5 * sheet->above + 0.36 * size}};
    const char *words[4];
    char title[TITLE_SIZE];
    for (int n = 0; n < 4; n++) {
        double axis[3];
        vec3_scale(axis, n < 2 ? panel->plane->right : panel->plane->up, n % 2 ? 1 : -1);
        words[n] = picture_letter_of(axis);
    }
    for (int n = 0; n < letters && words[0] && words[2]; n++) {
        write_centred(sheet, places[n][0], places[n][1], size, words[n]);
    }
    put_title(title, sheet, panel, sheet->title);
    write_centred(sheet, middle[0], bottom + sheet->above + (TITLE - 0.5) * em, em, title);
}

/* The letter of panel `index`, a, b, c, ... z, aa, ab, ...: left above it. */
static void write_letter(const struct sheet *sheet, size_t index)
{
    const struct panel *panel = &sheet->panels[index];
    const double size = PICTURE_LETTER * sheet->picture.em;
    const double at[2] = {fmax((double)panel->at[0] - sheet->beside, 0) + GAP * sheet->picture.em,
                          fmax((double)panel->at[1] - sheet->above, 0) + size};
    char text[3] = {(char)('a' + index % 26)};
    if (index >= 26) {
        text[1] = text[0];
        text[0] = (char)('a' + index / 26 - 1);
    }
    draw_text(sheet->image->list, sheet->picture.font, at, size, sheet->picture.ink, text);
}

static conus_status draw_points(const struct sheet *sheet, const struct panel *panel)
{
    const double at[2] = {(double)panel->at[0], (double)panel->at[1]};
    const double size[2] = {(double)panel->size[0], (double)panel->size[1]};
    return picture_points_cut(sheet->image->list, &sheet->picture,
                              &(struct picture_plane){.centre = panel->centre,
                                                      .right = panel->plane->right,
                                                      .up = panel->plane->up,
                                                      .pixels_per_mm = sheet->pixels_per_mm,
                                                      .middle = {at[0] + size[0] / 2, at[1] + size[1] / 2},
                                                      .box = {at[0], at[1], at[0] + size[0], at[1] + size[1]}},
                              sheet->shown);
}

static conus_status draw_panel(struct sheet *sheet, size_t index)
{
    const struct panel *panel = &sheet->panels[index];
    conus_status status = panel->plane ? draw_cut(sheet, panel) : draw_space(sheet, panel);
    if (!status && panel->plane && sheet->view.point_count) {
        status = draw_points(sheet, panel);
    }
    if (!status && sheet->picture.font && panel->plane) {
        annotate(sheet, panel);
    }
    if (!status && has_panel_letters(sheet)) {
        write_letter(sheet, index);
    }
    return status;
}

static conus_status draw_sheet(struct sheet *sheet)
{
    struct picture *picture = &sheet->picture;
    conus_status status = lay_out(sheet);
    status = status ? status : image_create_listed(&sheet->image, picture->options.width, picture->sheet_height);
    if (status) {
        return status;
    }
    sheet->image->dpi = picture->options.dpi;
    picture_lay_background(sheet->image, &picture->options);
    for (size_t i = 0; i < sheet->count && !status; i++) {
        status = draw_panel(sheet, i);
    }
    bool has_cuts = sheet->panels[sheet->count - 1].plane;
    if (!status && picture->font && has_cuts) {
        picture_draw_bar(sheet->image->list, picture, sheet->pixels_per_mm);
    }
    if (!status && picture->options.point_count && !sheet->renderer) { /* the view in space shows all */
        picture_points_count(sheet->image->list, picture, sheet->shown);
    }
    if (!status && picture->legend) {
        picture_legend_draw(sheet->image->list, picture);
    }
    status = status || picture->options.shapes ? status : image_paint(sheet->image);
    status = status ? status : picture_add_volumes(sheet->image, picture->atlas, true);
    return status ? status : picture_add_key(sheet->image, picture);
}

/* Finds for the legend what part of the cuts each object has, in cuts of so many pixels. Beside a view in space all
 * counts as seen; outlines of one grey have no colour to explain. */
static conus_status see_cuts(struct sheet *sheet)
{
    enum { PIXELS = 240 };
    const conus_atlas *atlas = sheet->picture.atlas;
    const bool has_space = sheet->renderer;
    const bool is_grey = sheet->look->fill == 0 && sheet->view.dpi > 0;
    double low[3], high[3];
    size_t pixels = 0;
    conus_status status = conus_atlas_bounds(low, high, atlas);
    if (status) {
        return status;
    }
    double *seen = sheet->picture.seen = memory_zeroed(atlas->object_count + 1, sizeof *seen);
    status = seen ? CONUS_OK : CONUS_ERROR_MEMORY;
    const struct panel *panels = is_grey ? NULL : sheet->panels;
    for (size_t i = has_space; panels && i < sheet->count && !status; i++) {
        const conus_cut_plane *plane = panels[i].plane;
        conus_cut_view view = {.width = PIXELS, .height = PIXELS, .own_colours = true};
        double offset[3], normal[3];
        for (int a = 0; a < 3; a++) {
            view.centre[a] = (low[a] + high[a]) / 2;
            view.mm_per_pixel = fmax(view.mm_per_pixel, (high[a] - low[a]) / PIXELS);
        }
        vec3_cross(normal, plane->right, plane->up);
        vec3_sub(offset, plane->at, view.centre);
        vec3_add_scaled(view.centre, view.centre, vec3_dot(offset, normal), normal);
        memcpy(view.right, plane->right, sizeof view.right);
        memcpy(view.up, plane->up, sizeof view.up);
        status = conus_cutter_draw(sheet->cutter, &view);
        for (size_t p = 0; p < (size_t)PIXELS * PIXELS && !status; p++, pixels++) {
            seen[conus_cutter_shown(sheet->cutter)[p]]++;
        }
    }
    for (size_t n = 1; n <= atlas->object_count && !status; n++) {
        seen[n] = fmax(seen[n] / fmax((double)pixels, 1), has_space ? PICTURE_LEAST_PART : 0);
    }
    return status;
}

static conus_status check_planes(const conus_cut_plane *planes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!vec3_is_finite(planes[i].at) || vec3_length(planes[i].right) == 0) {
            return fail(CONUS_ERROR_ARGUMENT, "cut %zu: a place of numbers and unit vectors are needed", i + 1);
        }
    }
    return CONUS_OK;
}

conus_status conus_render_cuts(conus_image **out, const conus_atlas *atlas, const conus_cut_plane *planes, size_t count,
                               const conus_cut_view *look, conus_renderer *renderer, const conus_view *sheet)
{
    struct sheet of = {.look = options_of(conus_cut_view, look), .renderer = renderer, .picture = {.atlas = atlas}};
    of.view = *options_of(conus_view, sheet);
    of.view.width = of.view.width ? of.view.width : DEFAULT_WIDTH;
    of.trims = of.picture.is_low = !of.view.height;
    const double highest = of.view.print ? 1.4 : 0.75; /* on paper the width is scarce */
    of.view.height = of.trims ? (uint32_t)fmax(ceil(highest * of.view.width), 1) : of.view.height;
    of.count = count + (renderer ? 1 : 0);
    const conus_cut_view whole = {
        .width = of.view.width, .height = of.view.height, .selection = of.view.selection, .chosen = of.look->chosen};
    if (count > PANEL_LIMIT || !of.count) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu cuts; allowed is 1 to %d", count, PANEL_LIMIT);
    }
    conus_status status = cut_view_check_size(&whole);
    status = status ? status : picture_check_sheet(&of.view);
    status = status ? status : picture_points_check(&of.view);
    status = status ? status : check_planes(planes, count);
    if (status) {
        return status;
    }
    of.panels = memory_zeroed(of.count, sizeof *of.panels);
    of.shown = memory_zeroed(of.view.point_count, sizeof *of.shown);
    status = of.panels && of.shown ? conus_cutter_create(&of.cutter, atlas) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && of.panels; i++) {
        of.panels[of.count - count + i].plane = &planes[i];
    }
    if (renderer) {
        of.picture.streamlines = &renderer->colour.streamlines;
        of.picture.hazy = &renderer->colour.hazy;
    }
    if (!status && of.look->pathway_count) {
        const conus_renderer_options haze = {.pathways = of.look->pathways, .pathway_count = of.look->pathway_count};
        status = haze_choose(&of.hazy, atlas, &haze);
        of.picture.hazy = &of.hazy;
    }
    if (!status && !of.view.point_count) {
        status = cutter_list_tracts(&of.listed, atlas, of.view.selection, of.view.own_colours, of.view.listed);
        of.view.listed = of.listed ? of.listed : of.view.listed;
    }
    status = status || of.view.selection || of.view.point_count ? status : see_cuts(&of);
    status = status ? status : picture_cut_init(&of.picture, &whole, &of.view);
    status = status ? status : draw_sheet(&of);
    if (status) {
        conus_image_destroy(of.image);
    } else {
        *out = of.image;
    }
    picture_finish(&of.picture);
    conus_cutter_destroy(of.cutter);
    memory_free(of.panels);
    memory_free(of.shown);
    memory_free(of.listed);
    haze_choice_finish(&of.hazy);
    return status;
}
