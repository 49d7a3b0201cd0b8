/* SPDX-License-Identifier: BSD-3-Clause */
/* A flat pane: the cut, the crosshair, the cone in it, and the mouse on it. */
#include "base/geometry/math3.h"
#include "base/look.h"
#include "conus/own.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/tools/tools.h"
#include "viewer/window/window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const ui_colour light = {LOOK_RGB(LOOK_OVER), 255};
static const ui_colour white = {LOOK_RGB(LOOK_CHOSEN), 255};
static const float margin = 7;         /* pixels, of letters */
static const double step_pixels = 300; /* that the mouse moves for a step of 1 of appearance_move_grey() */

/* Lets the mouse on a cut change the context's grey values; true while it does. */
static bool drag_grey(struct window *window, const struct ui_mouse *mouse)
{
    struct viewer *viewer = window->viewer;
    bool by_mouse = mouse->down[2] || (mouse->down[0] && mouse->control);
    bool has_grey = viewer->drawn->found_grey[1] > viewer->drawn->found_grey[0];
    if (!has_grey || !ui_surface_held() || !by_mouse) {
        return false;
    }
    if (mouse->doubled_middle || (mouse->doubled && mouse->control)) {
        viewer_set_grey(viewer, 0, 0);
    } else if (mouse->moved_x != 0 || mouse->moved_y != 0) {
        viewer_move_grey(viewer, (double)mouse->moved_x / step_pixels, -(double)mouse->moved_y / step_pixels);
    }
    return true;
}

/* Writes into a cut's lower left corner, beside the brain and the lower letter: what is chosen, if the cut shows it
 * and the 3-D pane, which names it, is not there, and above it the grey values, unless they are those that were found.
 */
static void draw_corner(const struct window *window, const struct ui_box *box, bool shows_chosen)
{
    static const char *const ends[2] = {"black", "white"};
    const struct view_atlas *view = window->viewer->drawn;
    const double *grey = view_atlas_grey(view);
    float at[2] = {box->x + 8, box->y + box->height - 1.4F * ui_line()};
    char title[VIEW_ATLAS_TITLE];
    char text[PANE_NAME];
    if (shows_chosen && conus_atlas_object(view->atlas, view->shown.chosen)) {
        const char *name = view_atlas_title(title, view, view->shown.chosen);
        bool is_beside = ui_text_width(name) <= box->width / 2 - ui_line() - 8; /* else above the letter */
        at[1] -= is_beside ? 0 : 1.2F * ui_line();
        ui_shorten_name(text, sizeof text, name, box->width - 16);
        ui_draw_text(at, white, text);
        at[1] -= 1.2F * ui_line();
    }
    for (int end = 1; end >= 0 && grey != view->found_grey; end--) {
        snprintf(text, sizeof text, "%s %.6g", ends[end], grey[end]);
        ui_draw_text(at, light, text);
        at[1] -= 1.2F * ui_line();
    }
}

static const ui_colour cross = {LOOK_RGB(LOOK_CROSS), 255};

/* A pane in this frame. */
struct cut {
    struct cut_pane *pane;
    struct pane_plane plane;
    char title[96];
    const char *sides; /* "" where there is no room for them: letters say so, too */
    float upper;       /* where the upper letter is, from the pane's upper edge */
    struct labels labels;
};

static void draw_picture(struct window *window, const struct cut *cut)
{
    struct viewer *viewer = window->viewer;
    struct cut_pane *pane = cut->pane;
    const conus_cut_view *view = &cut->plane.view;
    conus_status status = CONUS_OK;
    bool is_old = inputs_is_old(&window->inputs, viewer, FIRST_TOOL);
    const unsigned version = viewer_cut_version(viewer); /* the cone is drawn over the picture */
    bool same = pane->version == version && pane->is_old == is_old && pane->texture.width == view->width &&
                pane->texture.height == view->height;
    for (int a = 0; a < 3; a++) {
        same = same && pane->centre[a] == view->centre[a];
    }
    if (same) {
        return;
    }
    pane->is_old = is_old;
    pane->version = version; /* what cannot be drawn is said once */
    pane->answer_sum = tool_answer_sum(viewer);
    memcpy(pane->centre, view->centre, sizeof pane->centre);
    if (!pane->cutter || pane->atlas_number != viewer->atlas_number) { /* it holds as long as the atlas */
        conus_cutter_destroy(pane->cutter);
        pane->cutter = NULL;
        pane->atlas_number = viewer->atlas_number;
        status = conus_cutter_create(&pane->cutter, viewer->drawn->atlas);
    }
    if (status || conus_cutter_draw(pane->cutter, view)) {
        viewer_say(viewer, "%s", conus_message());
        return;
    }
    const uint32_t *objects = conus_cutter_shown(pane->cutter);
    size_t pixels = (size_t)view->width * view->height;
    uint8_t *rgba = malloc(4 * pixels);
    if (!rgba) {
        return;
    }
    memcpy(rgba, conus_cutter_rgba(pane->cutter), 4 * pixels);
    if (is_old) {
        answer_pale(rgba, pixels);
    }
    for (enum outline which = 0; which < OUTLINE_COUNT; which++) {
        bool *wanted = outline_wanted(viewer, which);
        pane->top = (struct outline_top){0};
        if (wanted) {
            outline_cut(rgba, &pane->top, objects, view->width, view->height, wanted, &outline_looks[which]);
        }
        free(wanted);
    }
    texture_set(&pane->texture, rgba, view->width, view->height, false);
    free(rgba);
}

static void world_at(double out[3], const struct cut *cut, float x, float y)
{
    const struct ui_box *box = &cut->plane.box;
    double beside = ((double)(x - box->x) - (double)box->width / 2) * cut->plane.view.mm_per_pixel;
    double above = ((double)box->height / 2 - (double)(y - box->y)) * cut->plane.view.mm_per_pixel;
    vec3_add_scaled(out, cut->plane.view.centre, beside, cut->plane.view.right);
    vec3_add_scaled(out, out, above, cut->plane.view.up);
}

static uint32_t object_at(const struct cut *cut, float x, float y)
{
    const struct cut_pane *pane = cut->pane;
    float column = x - cut->plane.box.x;
    float row = y - cut->plane.box.y;
    bool inside = column >= 0 && row >= 0 && column < (float)pane->texture.width && row < (float)pane->texture.height;
    const uint32_t *objects = inside && pane->cutter ? conus_cutter_objects(pane->cutter) : NULL;
    return objects ? objects[(size_t)row * pane->texture.width + (size_t)column] : 0;
}

static char letter_towards(const double direction[3])
{
    static const char letters[2][3] = {{'R', 'A', 'S'}, {'L', 'P', 'I'}};
    for (int a = 0; a < 3; a++) {
        if (fabs(direction[a]) > 0.5) {
            return letters[direction[a] < 0][a];
        }
    }
    return ' ';
}

static void draw_letters(struct cut *cut)
{
    const struct ui_box *box = &cut->plane.box;
    double left[3];
    double down[3];
    vec3_scale(left, cut->plane.view.right, -1);
    vec3_scale(down, cut->plane.view.up, -1);
    struct {
        const double *towards;
        float x, y; /* parts of the space between the margins */
    } places[] = {{left, 0, 0.5F}, {cut->plane.view.right, 1, 0.5F}, {cut->plane.view.up, 0.5F, 0}, {down, 0.5F, 1}};
    for (int i = 0; i < 4; i++) {
        bool is_upper = places[i].towards == cut->plane.view.up;
        const char text[2] = {letter_towards(places[i].towards), '\0'};
        const float space[2] = {box->width - ui_text_width(text) - 2 * margin, box->height - ui_line() - 2 * margin};
        float top = is_upper ? cut->upper : margin;
        const float at[2] = {box->x + margin + places[i].x * space[0], box->y + top + places[i].y * space[1]};
        ui_draw_text(at, light, text);
        labels_reserve(&cut->labels, (struct ui_box){at[0], at[1], ui_text_width(text), ui_line()});
    }
}

static void draw_measured(const struct window *window, struct cut *cut)
{
    float ends[2][2] = {{0}};
    for (uint32_t i = 0; i < window->viewer->measure.count; i++) {
        pane_point(ends[i], &cut->plane, window->viewer->measure.points + (size_t)3 * i);
    }
    pane_measured(window, &cut->labels, &cut->plane.box, &cut->plane, ends);
}

/* Draws its arms beside the place, which they leave free. */
static void draw_crosshair(const struct window *window, const struct cut *cut)
{
    static const float inner = 6, outer = 20;
    const struct pen pen = {cross, 1, window->screen.scale};
    float at[2];
    pane_point(at, &cut->plane, window->viewer->crosshair);
    for (int arm = 0; arm < 4; arm++) { /* on whole pixels: between them they would be pale */
        float ends[2][2] = {{roundf(at[0]), roundf(at[1])}, {roundf(at[0]), roundf(at[1])}};
        float side = arm % 2 ? pen.scale : -pen.scale;
        ends[0][arm / 2] += side * inner;
        ends[1][arm / 2] += side * outer;
        stroke_line(ends[0], ends[1], pen);
    }
}

/* Writes the coordinate that a plane's points share: "z = 1.0 mm", "DV = 332 um". */
static void put_depth(char *out, size_t size, const struct viewer *viewer, enum plane plane)
{
    static const char *const axes[][PLANE_COUNT] = {{"z", "y", "x"}, {"DV", "AP", "ML"}};
    double at[3];
    size_t axis = 0;
    conus_space space = viewer->frame.space;
    const char *name = axes[space >= CONUS_SPACE_CCF][plane];
    conus_frame_from_world(at, &viewer->frame, viewer->crosshair);
    while (strcmp(conus_space_axis(space, axis), name) != 0) {
        axis++;
    }
    size_t used = (size_t)snprintf(out, size, "%s = ", name);
    used += viewer_put_coordinate(out + used, size - used, viewer, at[axis]);
    snprintf(out + used, size - used, " %s", conus_space_unit(space));
}

/* Finds the longest title that fits, and whether there is room for the sides. */
static void make_title(struct cut *cut, const struct viewer *viewer, enum plane plane)
{
    const struct ui_box *box = &cut->plane.box;
    float room = box->width - 12;
    char depth[64];
    char whole[96];
    put_depth(depth, sizeof depth, viewer, plane);
    snprintf(whole, sizeof whole, "%s  %s", figure_panes[plane], depth);
    if (ui_text_width(depth) > room) { /* the unit goes next */
        *strrchr(depth, ' ') = '\0';
    }
    ui_shorten(cut->title, sizeof cut->title, ui_text_width(whole) > room ? depth : whole, room);
    cut->sides = plane != AXIAL ? "" : viewer->display.radiological ? "radiological" : "neurological";
    cut->sides = ui_text_width(cut->sides) > box->width / 2 - 2 * ui_line() ? "" : cut->sides;
    float wide = ui_text_width(cut->title);
    labels_reserve(&cut->labels, (struct ui_box){box->x + 8, box->y + 6, wide, ui_line()});
    cut->upper = 8 + wide > 0.5F * box->width - margin ? 1.6F * ui_line() : margin;
}

/* The sides are on the other side of the lower letter than grey values. */
static void draw_title(const struct cut *cut)
{
    const struct ui_box *box = &cut->plane.box;
    ui_draw_text((float[]){box->x + 8, box->y + 6}, light, cut->title);
    if (*cut->sides) {
        const float left = box->x + box->width - 8 - ui_text_width(cut->sides);
        ui_draw_text((float[]){left, box->y + box->height - 1.4F * ui_line()}, light, cut->sides);
    }
}

/* Moves the wand there, or with Shift turns it to there; at first it looks at the brain's middle. */
static void use_wand(struct viewer *viewer, enum tool_number tool, bool shift, const double at[3])
{
    double direction[3];
    if (!viewer->tools[tool].has_pose && !shift) {
        vec3_sub(direction, viewer->centre, at);
        if (vec3_length(direction) > 1) {
            tool_aim_along(viewer, tool, at, direction);
        } else {
            tool_place(viewer, tool);
        }
        return;
    }
    if (!viewer->tools[tool].has_pose) {
        tool_place(viewer, tool);
    }
    const conus_pose pose = viewer->tools[tool].pose;
    const double *origin = pose.world_from_device + 12;
    if (shift) {
        vec3_sub(direction, at, origin);
    } else {
        vec3_scale(direction, pose.world_from_device + 8, -1);
    }
    tool_aim_along(viewer, tool, shift ? origin : at, direction);
}

static void use_mouse(struct window *window, const struct cut *cut, enum plane plane)
{
    struct viewer *viewer = window->viewer;
    struct ui_mouse mouse = ui_mouse_now();
    enum tool_number wand = tool_moved_by(viewer, POINT_BY_WAND);
    double at[3];
    world_at(at, cut, mouse.x, mouse.y);
    window->frame.hover.object = object_at(cut, mouse.x, mouse.y);
    memcpy(window->frame.hover.at, at, sizeof at);
    window->frame.hover.has_place = true;
    window->frame.hover.value = view_atlas_value(viewer->drawn, window->frame.hover.object, at);
    if (mouse.wheel != 0 && mouse.control) {
        viewer->magnification = fmin(fmax(viewer->magnification * pow(1.1, (double)mouse.wheel), 0.2), 50);
        viewer->version++;
    } else if (mouse.wheel != 0) {
        double next[3] = {viewer->crosshair[0], viewer->crosshair[1], viewer->crosshair[2]};
        double clicks = round((double)mouse.wheel); /* there may be several in a frame */
        next[2 - (int)plane] += clicks != 0 ? clicks : mouse.wheel > 0 ? 1 : -1;
        viewer_cross(viewer, next);
    }
    if (drag_grey(window, &mouse)) {
        return;
    }
    if (ui_surface_held() && mouse.doubled) {
        window_maximise(window);
    } else if (viewer->measure.on && ui_surface_held() && mouse.down[0]) {
        if (mouse.pressed[0]) {
            viewer_measure(viewer, at);
        }
    } else if (ui_surface_held() && mouse.pressed[0] &&
               pane_points_choose(window, (float[]){mouse.x, mouse.y}, &cut->plane)) {
        return;
    } else if (ui_surface_held() && mouse.down[0]) {
        viewer_cross(viewer, at);
        viewer->drawn->shown.chosen =
            window->frame.hover.object ? window->frame.hover.object : viewer->drawn->shown.chosen;
    } else if (ui_surface_held() && mouse.down[1] && wand < TOOL_COUNT) {
        use_wand(viewer, wand, mouse.shift, at);
    }
}

void pane_cut(struct window *window, enum plane plane)
{
    struct cut_pane *pane = &window->pictures.cuts[plane];
    struct cut cut = {.pane = pane, .plane.box = window->screen.panes[plane]};
    const struct ui_box *box = &cut.plane.box;
    cut_view(&cut.plane.view, window->viewer, plane, (double[]){(double)box->width, (double)box->height});
    make_title(&cut, window->viewer, plane);
    cut.plane.view.no_cone = true; /* pane_cone.c has it */
    draw_picture(window, &cut);
    ui_panel(figure_panes[plane], *box, UI_PLAIN);
    if (pane->texture.name) {
        ui_draw_image(pane->texture.name, *box);
    }
    bool touched = ui_surface("surface", *box);
    if (touched) {
        use_mouse(window, &cut, plane);
    }
    ui_clip(*box);
    pane_points(window, plane, box, &cut.plane);
    pane_cones_cut(window, &cut.plane);
    draw_crosshair(window, &cut);
    draw_title(&cut);
    draw_letters(&cut);
    draw_measured(window, &cut);
    draw_corner(window, box, pane->top.is_there && !screen_shows_pane(&window->screen, PANE_3D));
    ui_clip_end();
    if (touched && window->frame.hover.object) {
        hover_tip(window);
    }
    ui_panel_end();
}
