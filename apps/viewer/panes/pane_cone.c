/* SPDX-License-Identifier: BSD-3-Clause */
/* The cones of both tools over the four panes. */
#include "viewer/panes/panes.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/order.h"
#include "viewer/model/viewer.h"
#include "viewer/tools/tools.h"

#include <math.h>
#include <string.h>

/* Opacities of the inside: up to the first hit, and behind that, and where the cone is seen along its axis, so that the
 * colours of hits stay what they are. */
static const double fill = 0.25, fill_over_hits = 0.08;

static const float needle = 3, tick = 5, apex_radius = 4; /* pixels at scale 1 */

static const double tick_mm = 10;
static const double arm[2] = {0.03, 0.12}; /* of the crosshair, in radii of the atlas: it is free within */
static const double touching = 1.5;        /* mm: what lies no farther behind a surface lies on it */

enum { PARTS = 4, ARC = 8 /* points of a ring that are looked at once */, STEPS = 3, HULL = 4 * SHELL_POINTS };

/* Whether the tool is the needle of a plan: its axis from where it begins to its tip. */
static bool is_needle(const struct viewer *viewer, enum tool_number number)
{
    return number == FIRST_TOOL && plans_is_on(viewer) && viewer->cone.options.range[1] > 0;
}

static void find_shell(struct shell *out, const struct viewer *viewer, enum tool_number number, double near, double far)
{
    conus_selector_options options;
    double angle = viewer_query(&options, viewer, number, 0);
    shell_find(out, &viewer->tools[number].pose, options.radius, angle, near, far);
}

/* Finds how far the cone reaches, where that, or how it is seen, is not known any more. */
static void find_extent(struct window *window, enum tool_number number)
{
    struct viewer *viewer = window->viewer;
    struct cone_sight *sight = &window->pictures.cones[number];
    unsigned answer = viewer->tools[number].answer_number;
    bool is_anew = window_sees_anew(&sight->view, window);
    if (!is_anew && sight->answer_number == answer && sight->plan_number == viewer->plan.number) {
        return;
    }
    sight->answer_number = answer;
    sight->plan_number = viewer->plan.number;
    sight->is_seen = false;
    extent_find(&sight->extent, viewer, number);
    if (window->frame.turns_cone == number) { /* about the place where it was taken */
        memcpy(sight->extent.entry, window->frame.turned_about.entry, sizeof sight->extent.entry);
        sight->extent.reach = window->frame.turned_about.reach;
    }
}

/* Whether the picture of the 3-D pane shows something before a place, but for the object `own`. */
static bool is_hidden_by_others(const struct window *window, const double at[3], uint32_t own)
{
    const double *eye = window->pictures.shown.camera.world_from_device + 12;
    double offset[3];
    double place[3];
    uint32_t object;
    vec3_sub(offset, at, eye);
    double limit = vec3_length(offset) - touching;
    return viewer_pick(&object, place, window->viewer, eye, offset, limit) && (!own || object != own);
}

static bool is_hidden(const struct window *window, const double at[3])
{
    return is_hidden_by_others(window, at, 0);
}

static void add_line(struct cone_sight *sight, const double from[3], const double to[3], bool dashed)
{
    if (sight->line_count < CONE_LINES) {
        struct cone_line *line = &sight->lines[sight->line_count++];
        memcpy(line->ends[0], from, sizeof line->ends[0]);
        memcpy(line->ends[1], to, sizeof line->ends[1]);
        line->dashed = dashed;
    }
}

static void part_of(double out[3], const double from[3], const double to[3], double part)
{
    double whole[3];
    vec3_sub(whole, to, from);
    vec3_add_scaled(out, from, part, whole);
}

/* How far along a line something begins or ceases to hide it, after `part`, at the beginning of which it is hidden or
 * not; 1 = nowhere. */
static double next_change(const struct window *window, const double from[3], const double to[3], double part,
                          bool hidden)
{
    double place[3];
    double same = part;
    double other = part;
    for (bool changes = false; !changes && same < 1;) {
        other = fmin(same + 1.0 / PARTS, 1);
        part_of(place, from, to, other);
        changes = is_hidden(window, place) != hidden;
        same = changes ? same : other;
    }
    for (int step = 0; step < STEPS && same < other; step++) {
        double middle = (same + other) / 2;
        part_of(place, from, to, middle);
        *(is_hidden(window, place) == hidden ? &same : &other) = middle;
    }
    return other;
}

static void add_seen(struct cone_sight *sight, const struct window *window, const double from[3], const double to[3])
{
    double ends[2][3];
    double part = 0;
    bool hidden = is_hidden(window, from);
    while (part < 1) {
        double next = next_change(window, from, to, part, hidden);
        part_of(ends[0], from, to, part);
        part_of(ends[1], from, to, next);
        add_line(sight, ends[0], ends[1], hidden);
        hidden = !hidden;
        part = next;
    }
}

/* Adds a ring, in dashes where it is hidden. One that is dashed all around has no lines beside the brain, where nothing
 * is that it could lie in. */
static void add_ring(struct cone_sight *sight, const struct window *window, double (*points)[3], bool dashed)
{
    bool hidden = false;
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        hidden = i % ARC ? hidden : is_hidden(window, points[i + ARC / 2]);
        if (hidden || !dashed) {
            add_line(sight, points[i], points[(i + 1) % SHELL_POINTS], hidden);
        }
    }
}

static void on_axis(double out[3], const struct window *window, enum tool_number number, double depth)
{
    const double *m = window->viewer->tools[number].pose.world_from_device;
    vec3_add_scaled(out, m + 12, -depth, m + 8);
}

/* Adds the wall between two depths: both rings, but none that is a point, and the sides. */
static void add_wall(struct window *window, enum tool_number number, double near, double far, bool dashed)
{
    struct cone_sight *sight = &window->pictures.cones[number];
    const double *eye = window->pictures.shown.camera.world_from_device + 12;
    struct shell shell;
    find_shell(&shell, window->viewer, number, near, far);
    add_ring(sight, window, shell.far, dashed);
    if (!dashed && (near > 0 || window->viewer->cone.options.radius > 0)) {
        add_ring(sight, window, shell.near, dashed);
    }
    for (size_t i = 0; i < SHELL_POINTS; i++) {
        if (!shell_turns(&shell, i, eye)) {
            continue;
        }
        if (dashed) {
            add_line(sight, shell.near[i], shell.far[i], true);
        } else {
            add_seen(sight, window, shell.near[i], shell.far[i]);
        }
    }
}

/* Finds which of the named hits the camera does not see, or sees another area before. */
static void find_hidden_hits(struct window *window, enum tool_number number)
{
    const conus_selection *selection = view_atlas_selection(window->viewer->drawn, number);
    for (size_t i = 0; i < HITS_NAMED && i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        window->pictures.cones[number].hides_hit[i] =
            result->object && result->pixels && is_hidden_by_others(window, result->contact, result->object);
    }
}

/* Finds the lines of the cone as the eye sees it: its wall up to the deepest hit, behind that dashed, or the needle of
 * a plan; and the axis up to its ball. */
static void find_lines(struct window *window, enum tool_number number)
{
    struct viewer *viewer = window->viewer;
    struct cone_sight *sight = &window->pictures.cones[number];
    const struct extent *extent = &sight->extent;
    double ends[2][3];
    if (sight->is_seen) {
        return;
    }
    sight->is_seen = true;
    sight->line_count = 0;
    sight->clear = extent->near;
    on_axis(ends[0], window, number, extent->near);
    if (is_needle(viewer, number)) {
        on_axis(ends[1], window, number, extent->end);
        add_seen(sight, window, ends[0], ends[1]);
    } else if (extent->solid > extent->near) {
        on_axis(ends[1], window, number, extent->solid);
        add_wall(window, number, extent->near, extent->solid, false);
        if (!is_hidden(window, ends[0])) {
            sight->clear += next_change(window, ends[0], ends[1], 0, false) * (extent->solid - extent->near);
        }
    }
    if (extent->end > extent->solid && !is_needle(viewer, number)) {
        add_wall(window, number, extent->solid, extent->end, true);
    }
    find_hidden_hits(window, number);
    pane_ball_place(window, number);
    add_seen(sight, window, sight->ball, extent->entry);
    sight->hides_ball = is_hidden(window, sight->ball);
}

/* Draws a mark across the needle at `at`, on its way from `from`. */
static void draw_tick(const float from[2], const float at[2], struct pen pen)
{
    float size = hypotf(at[0] - from[0], at[1] - from[1]);
    if (size > 0) {
        float half = tick * pen.scale / size;
        const float across[2] = {half * (from[1] - at[1]), half * (at[0] - from[0])};
        stroke_line((float[]){at[0] - across[0], at[1] - across[1]}, (float[]){at[0] + across[0], at[1] + across[1]},
                    pen);
    }
}

/* Finds where mark `index` of the needle is, from 0 where it begins; false behind its tip. */
static bool find_tick(double out[3], const struct window *window, enum tool_number number, int index)
{
    const struct extent *extent = &window->pictures.cones[number].extent;
    double depth = extent->near + tick_mm * index;
    on_axis(out, window, number, depth);
    return depth <= extent->end;
}

static int by_place(const void *a, const void *b)
{
    const float *p = a;
    const float *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0]) : (p[1] > q[1]) - (p[1] < q[1]);
}

/* Replaces points, at most HULL, by the corners of their hull, in their order around it. */
static size_t find_hull(float (*points)[2], size_t count)
{
    float hull[2 * HULL + 1][2];
    size_t corners = 0;
    order_sort(points, count, sizeof *points, by_place);
    for (int side = 0; side < 2; side++) { /* the lower one from left to right, the upper one back */
        size_t first = corners;
        for (size_t i = 0; i < count; i++) {
            const float *p = points[side ? count - 1 - i : i];
            while (corners >= first + 2) {
                const float *a = hull[corners - 2];
                const float *b = hull[corners - 1];
                if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) {
                    break;
                }
                corners--;
            }
            memcpy(hull[corners++], p, sizeof hull[0]);
        }
        corners -= corners > 0; /* where the other side begins */
    }
    memcpy(points, hull, corners * sizeof *points);
    return corners;
}

/* Fills what is seen between two depths. */
static void draw_part(const struct window *window, enum tool_number number, double near, double far, ui_colour colour)
{
    float points[HULL][2];
    struct shell shell;
    bool seen = far > near;
    if (seen) {
        find_shell(&shell, window->viewer, number, near, far);
    }
    for (size_t i = 0; i < SHELL_POINTS && seen; i++) {
        seen =
            window_point(points[2 * i], window, shell.near[i]) && window_point(points[2 * i + 1], window, shell.far[i]);
    }
    if (seen) {
        ui_draw_fill(points, find_hull(points, (size_t)2 * SHELL_POINTS), colour);
    }
}

static ui_colour filled(ui_colour colour, double opacity)
{
    colour.a = (uint8_t)(255 * opacity + 0.5);
    return colour;
}

/* Fills the part that nothing hides. */
static void draw_inside(const struct window *window, enum tool_number number, ui_colour colour)
{
    const struct cone_sight *sight = &window->pictures.cones[number];
    const double *m = window->viewer->tools[number].pose.world_from_device;
    const double *eye = window->pictures.shown.camera.world_from_device;
    double along = vec3_dot(m + 8, eye + 8); /* 1: seen along the axis */
    double first = fmin(fmax(sight->extent.first, sight->extent.near), sight->clear);
    double before = fill_over_hits + (1 - along * along) * (fill - fill_over_hits);
    draw_part(window, number, sight->extent.near, first, filled(colour, before));
    draw_part(window, number, first, sight->clear, filled(colour, fill_over_hits));
}

/* Draws lines, those that are hidden in dashes. */
static void draw_sight(const struct window *window, const struct cone_sight *sight, struct pen pen)
{
    float phase = 0;
    float ends[2][2];
    for (size_t i = 0; i < sight->line_count; i++) {
        const struct cone_line *line = &sight->lines[i];
        if (!window_point(ends[0], window, line->ends[0]) || !window_point(ends[1], window, line->ends[1])) {
            continue;
        }
        if (line->dashed) {
            stroke_dashes(&phase, ends[0], ends[1], pen);
        } else {
            stroke_line(ends[0], ends[1], pen);
        }
    }
}

/* Draws the lines of a cone; ticks on a needle, over which no name shall lie: it would seem to name the tip. */
static void draw_lines(struct window *window, enum tool_number number, struct pen pen)
{
    float ends[2][2];
    float width = is_needle(window->viewer, number) ? needle : pen.width;
    draw_sight(window, &window->pictures.cones[number], (struct pen){pen.colour, width, pen.scale});
    double place[3];
    for (int i = 0; is_needle(window->viewer, number) && find_tick(place, window, number, i); i++) {
        bool seen = window_point(ends[i % 2], window, place);
        const float *from = ends[(i + 1) % 2];
        const float *at = ends[i % 2];
        if (seen && i) {
            draw_tick(from, at, pen);
            labels_reserve(&window->frame.labels, (struct ui_box){fminf(from[0], at[0]), fminf(from[1], at[1]),
                                                                  fabsf(at[0] - from[0]), fabsf(at[1] - from[1])});
        }
    }
}

void pane_cones(struct window *window)
{
    tool_update_second(window->viewer); /* a panel may have changed the atlas in this frame */
    for (enum tool_number number = FIRST_TOOL; number < TOOL_COUNT; number++) {
        struct pen pen = pane_tool_pen(window, number);
        float apex[2];
        if (!pane_tool_shows(window, number)) {
            continue;
        }
        find_extent(window, number);
        find_lines(window, number);
        draw_inside(window, number, pen.colour);
        draw_lines(window, number, pen);
        if (window_point(apex, window, window->viewer->tools[number].pose.world_from_device + 12)) {
            ui_draw_circle(apex, apex_radius * pen.scale, (ui_colour){LOOK_RGB(LOOK_APEX), 255}, 0);
            stroke_circle(apex, apex_radius, pen);
        }
        pane_ball_draw(window, number);
    }
}

/* Finds the crosshair's arms along the axes, from beside its place on. */
static void find_cross(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    struct cone_sight *sight = &window->pictures.cross;
    const double *at = viewer->crosshair;
    double *was = window->pictures.crossed;
    bool is_anew = window_sees_anew(&sight->view, window);
    if (!is_anew && was[0] == at[0] && was[1] == at[1] && was[2] == at[2]) {
        return;
    }
    sight->line_count = 0;
    memcpy(was, at, sizeof window->pictures.crossed);
    for (int half = 0; half < 6; half++) {
        double ends[2][3];
        for (int e = 0; e < 2; e++) {
            memcpy(ends[e], at, sizeof ends[e]);
            ends[e][half % 3] += (half < 3 ? arm[e] : -arm[e]) * viewer->radius;
        }
        add_seen(sight, window, ends[0], ends[1]);
    }
}

void pane_cross(struct window *window)
{
    find_cross(window);
    draw_sight(window, &window->pictures.cross,
               (struct pen){(ui_colour){LOOK_RGB(LOOK_CROSS), 255}, 1, window->screen.scale});
}

/* Finds where a plane cuts the cone between two depths: the corners of its section, as pixels. */
static size_t find_section(float (*out)[2], const struct viewer *viewer, enum tool_number number,
                           const double depths[2], const struct pane_plane *plane)
{
    struct shell shell;
    struct shell_piece pieces[2 * SHELL_POINTS];
    double normal[3];
    pane_normal(normal, plane);
    find_shell(&shell, viewer, number, depths[0], depths[1]);
    size_t count = shell_cut(pieces, &shell, plane->view.centre, normal);
    for (size_t i = 0; i < count; i++) {
        pane_point(out[2 * i], plane, pieces[i].ends[0]);
        pane_point(out[2 * i + 1], plane, pieces[i].ends[1]);
    }
    return find_hull(out, 2 * count);
}

/* Draws the edges of a section, but not one where the cone only leaves what is shown: it does not end there. */
static void draw_edges(const struct window *window, enum tool_number number, const struct pane_plane *plane,
                       const double depths[2], bool dashed, struct pen pen)
{
    const struct viewer *viewer = window->viewer;
    const double *m = viewer->tools[number].pose.world_from_device;
    const conus_cut_view *view = &plane->view;
    const bool is_open = viewer->cone.options.range[1] <= 0 && depths[1] >= window->pictures.cones[number].extent.end;
    float corners[HULL][2];
    bool is_far[HULL];
    float phase = 0;
    size_t count = find_section(corners, viewer, number, depths, plane);
    for (size_t i = 0; i < count; i++) {
        double right = (double)(corners[i][0] - plane->box.x - plane->box.width / 2) * view->mm_per_pixel;
        double up = (double)(plane->box.y + plane->box.height / 2 - corners[i][1]) * view->mm_per_pixel;
        double offset[3];
        vec3_sub(offset, view->centre, m + 12);
        vec3_add_scaled(offset, offset, right, view->right);
        vec3_add_scaled(offset, offset, up, view->up);
        is_far[i] = is_open && -vec3_dot(offset, m + 8) > depths[1] - touching;
    }
    for (size_t i = 0; i < count; i++) {
        size_t next = (i + 1) % count;
        if (is_far[i] && is_far[next]) {
            continue;
        }
        if (dashed) {
            stroke_dashes(&phase, corners[i], corners[next], pen);
        } else {
            stroke_line(corners[i], corners[next], pen);
        }
    }
}

static void draw_section(struct window *window, enum tool_number number, const struct pane_plane *plane, struct pen pen)
{
    const struct extent *extent = &window->pictures.cones[number].extent;
    const double first = fmin(fmax(extent->first, extent->near), extent->solid);
    const double depths[4] = {extent->near, first, extent->solid, extent->end};
    float corners[HULL][2];
    for (int part = 0; part < 2; part++) {
        size_t count = find_section(corners, window->viewer, number, depths + part, plane);
        ui_draw_fill(corners, count, filled(pen.colour, part ? fill_over_hits : fill));
    }
    draw_edges(window, number, plane, depths + 2, true, pen);
    draw_edges(window, number, plane, (double[]){extent->near, extent->solid}, false, pen);
}

/* Draws the needle as it is seen from before the cut, with its marks where it is in it. */
static void draw_needle(const struct window *window, enum tool_number number, const struct pane_plane *plane,
                        struct pen pen)
{
    const struct extent *extent = &window->pictures.cones[number].extent;
    const double radius = window->viewer->cone.options.radius;
    double places[2][3];
    float from[2];
    float at[2];
    on_axis(places[0], window, number, extent->near);
    on_axis(places[1], window, number, extent->end);
    pane_point(from, plane, places[0]);
    pane_line_cut(window, plane, places[0], places[1], radius, (struct pen){pen.colour, needle, pen.scale});
    for (int i = 1; find_tick(places[1], window, number, i); i++) {
        pane_point(at, plane, places[1]);
        if (pane_is_in_cut(window, plane, places[1], radius)) {
            draw_tick(from, at, pen);
        }
    }
}

void pane_cones_cut(struct window *window, const struct pane_plane *plane)
{
    tool_update_second(window->viewer); /* a panel may have changed the atlas in this frame */
    for (enum tool_number number = FIRST_TOOL; number < TOOL_COUNT; number++) {
        struct pen pen = pane_tool_pen(window, number);
        if (!pane_tool_shows(window, number)) {
            continue;
        }
        find_extent(window, number);
        if (is_needle(window->viewer, number)) {
            draw_needle(window, number, plane, pen);
        } else {
            draw_section(window, number, plane, pen);
        }
    }
}
