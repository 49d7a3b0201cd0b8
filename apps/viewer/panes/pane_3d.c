/* SPDX-License-Identifier: BSD-3-Clause */
/* The 3-D pane: shows the painter's picture, and lets the mouse turn it or aim. */
#include "base/look.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"
#include "viewer/panes/panes.h"
#include "viewer/tools/tools.h"
#include "viewer/window/start.h"
#include "viewer/window/window.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const ui_colour compass_near = {LOOK_RGB(LOOK_OVER), 255};
static const ui_colour compass_far = {LOOK_RGB(LOOK_OVER_FAR), 255};
static const ui_colour compass_edge = {LOOK_RGB(LOOK_UNDER), 190};

static const ui_colour light = {LOOK_RGB(LOOK_OVER), 255};
static const ui_colour dark = {LOOK_RGB(LOOK_UNDER), 255};
/* The view rests when the mouse, or else a tracker or a replay, has stood still for so long. */
static const double view_rest_ms = 120, others_rest_ms = 300;

static const float click = 4; /* pixels: a mouse that moves as far from where it was pressed turns the view */

static const char device_caption[] = "what the device sees";

enum { INSET = 7 /* pixels on the screen per pixel of the device's view */ };

/* Half an axis of the cross of directions. */
struct direction {
    const char *letter;
    float x, y; /* in the picture, of a unit vector */
    bool is_away;
};

static struct direction find_direction(const struct window *window, size_t axis, int sign)
{
    static const char letters[3][2][2] = {{"L", "R"}, {"P", "A"}, {"I", "S"}};
    const double *m = window->pictures.shown.camera.world_from_device;
    return (struct direction){letters[axis][sign > 0], (float)(sign * m[axis]), (float)(-sign * m[4 + axis]),
                              sign * m[8 + axis] < 0};
}

/* Draws it paler where it points away from the viewer. */
static void draw_direction(const float centre[2], const struct direction *direction)
{
    bool is_away = direction->is_away;
    float length = 1.5F * ui_line();
    const float end[2] = {centre[0] + length * direction->x, centre[1] + length * direction->y};
    ui_draw_line(centre, end, compass_edge, is_away ? 2.5F : 3.5F);
    ui_draw_line(centre, end, is_away ? compass_far : compass_near, is_away ? 1.0F : 2.0F);
}

/* Writes its letter where there is room beside those before. */
static void draw_letter(struct labels *labels, const float centre[2], const struct direction *direction)
{
    static const float shade = 3; /* around texts, pixels */
    float wide = ui_text_width(direction->letter) + 2 * shade;
    const struct ui_box box = {centre[0] + 2.2F * ui_line() * direction->x - wide / 2,
                               centre[1] + 2.2F * ui_line() * direction->y - ui_line() / 2, wide, ui_line()};
    bool is_across = direction->x * direction->x + direction->y * direction->y > 0.1F; /* else it is at the middle */
    if (is_across && labels_leave_free(labels, &box)) {
        labels_reserve(labels, box);
        ui_draw_text((float[]){box.x + shade, box.y}, direction->is_away ? compass_far : compass_near,
                     direction->letter);
    }
}

static float compass_reach(void)
{
    return 2.9F * ui_line();
}

static bool has_compass(const struct ui_box *box)
{
    return box->width > 3 * compass_reach() && box->height > 4 * compass_reach();
}

static void draw_compass(const struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    float reach = compass_reach();
    float below = 1.6F * ui_line(); /* where words may stand */
    const float centre[2] = {box->x + box->width - reach, box->y + box->height - reach - below};
    struct labels labels = {.count = 0};
    for (int half = 0; half < 24 && has_compass(box); half++) { /* what points away first; of letters the near ones */
        struct direction direction = find_direction(window, (size_t)half % 3, half / 3 % 2 ? 1 : -1);
        bool is_letter = half >= 12;
        if (direction.is_away != (half / 6 % 2 == is_letter)) {
            continue;
        }
        if (is_letter) {
            draw_letter(&labels, centre, &direction);
        } else {
            draw_direction(centre, &direction);
        }
    }
}

static void ask_painter(struct window *window, bool moving)
{
    struct viewer *viewer = window->viewer;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    struct painting what = {.eye = window->pictures.eye,
                            .width = (uint32_t)fmaxf(box->width, 1),
                            .height = (uint32_t)fmaxf(box->height, 1),
                            .fade = viewer->display.fade,
                            .leaves_context = viewer_leaves_context(viewer),
                            .backdrop = viewer->display.backdrop,
                            .is_dark = theme_used() == THEME_DARK,
                            .own_colours = viewer->display.own_colours,
                            .chosen = viewer_full(viewer),
                            .answer = viewer_pictured(viewer),
                            .plan_number = viewer->plan.number,
                            .is_old = inputs_is_old(&window->inputs, viewer, FIRST_TOOL),
                            .answer_number = viewer->tools[FIRST_TOOL].answer_number,
                            .scene_number = viewer->scene_number,
                            .moving = moving};
    bool same = painting_shows_same(&what, &window->pictures.asked);
    bool rests = window->pictures.asked.moving && !moving;
    if (viewer->painter && (!same || rests)) {
        painter_ask(viewer->painter, &what);
        window->pictures.asked = what;
        window->pictures.painted_fine = window->pictures.painted_fine && same;
    }
}

/* Keeps the first fine picture of the first atlas for the start page. */
static void keep_picture(struct window *window, const struct painted *picture)
{
    const struct view_atlas *first = window->viewer->atlases;
    uint32_t areas = 0;
    if (!window->files.remembers || window->pictures.is_kept || window->viewer->drawn != first) {
        return;
    }
    for (size_t number = 1; number <= first->object_count; number++) {
        areas += conus_atlas_object(first->atlas, number)->kind == CONUS_KIND_AREA;
    }
    thumbnail_keep(first->path, areas, picture);
    window->pictures.is_kept = true;
}

static void take_picture(struct window *window)
{
    struct painted picture;
    if (window->pictures.painted_of != window->viewer->drawn) { /* a picture of another atlas is not shown */
        texture_drop(&window->pictures.painted);
        window->pictures.painted_of = window->viewer->drawn;
        window->pictures.painted_fine = false;
    }
    if (window->viewer->painter && painter_take(window->viewer->painter, &picture)) {
        bool coarse = picture.width != picture.what.width || picture.height != picture.what.height;
        if (!window->pictures.painted.name) { /* one frame is enough before it, for where both share processors */
            window->frame.frames_wanted = FRAMES_PER_EVENT;
        }
        struct times *times = &window->times;
        times_add(times, TIMED_PICTURE, picture.milliseconds);
        times->first_picture = times->first_picture > 0 ? times->first_picture : clock_ms() - times->started;
        texture_set(&window->pictures.painted, picture.rgba, picture.width, picture.height, coarse);
        window->pictures.late_at = 0;
        window->pictures.drawn = picture.what;
        window->pictures.around = (ui_colour){picture.rgba[0], picture.rgba[1], picture.rgba[2], 255};
        window->pictures.painted_ms = picture.milliseconds;
        window->pictures.painted_fine = picture.fine && painting_shows_same(&picture.what, &window->pictures.asked);
        if (picture.fine && !viewer_selection(window->viewer)) {
            keep_picture(window, &picture);
        }
        free(picture.rgba);
    }
}

/* Finds the eye by which the pane is seen, and where the picture lies in it: one of another size than the pane has now
 * keeps its shape, as large as it fits, in the middle. */
static void find_shown(struct ui_box *place, struct pictures *pictures, const struct ui_box *box)
{
    const struct painting *drawn = &pictures->drawn;
    bool same = drawn->width == (uint32_t)box->width && drawn->height == (uint32_t)box->height;
    *place = *box;
    pictures->shown = pictures->painted.name ? drawn->eye : pictures->eye;
    if (pictures->painted.name && !same) {
        float scale = fminf(box->width / (float)drawn->width, box->height / (float)drawn->height);
        place->width = scale * (float)drawn->width;
        place->height = scale * (float)drawn->height;
        place->x += (box->width - place->width) / 2;
        place->y += (box->height - place->height) / 2;
        for (int axis = 0; axis < 2; axis++) { /* what is seen beside it */
            double *edges = pictures->shown.frustum + 2 * axis;
            double part = (double)(axis ? box->height / place->height : box->width / place->width);
            double more = (part - 1) * (edges[1] - edges[0]) / 2;
            edges[0] -= more;
            edges[1] += more;
        }
    }
}

/* The names of a tool's best hits beside their contacts, which they do not cover. What the second one hits has no
 * colour in the picture: its ring and name have that of its cone. */
static void draw_names(struct window *window, enum tool_number number)
{
    const struct viewer *viewer = window->viewer;
    const conus_selection *selection = view_atlas_selection(viewer->drawn, number);
    const bool is_second = number == SECOND_TOOL;
    bool is_old = inputs_is_old(&window->inputs, viewer, number);
    struct pen pen = {is_old      ? compass_far
                      : is_second ? pane_tool_pen(window, number).colour
                                  : light,
                      1.5F, window->screen.scale};
    float places[HITS_NAMED][2];
    const conus_result *results[HITS_NAMED] = {NULL};
    for (size_t i = 0; i < HITS_NAMED && i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels && window_point(places[i], window, result->contact)) {
            const float half = 4 * pen.scale;
            struct pen ring = pen;
            results[i] = result;
            ring.colour.a = window->pictures.cones[number].hides_hit[i] ? (uint8_t)(255 * theme_pale) : 255;
            stroke_circle(places[i], 4, ring);
            labels_reserve(&window->frame.labels,
                           (struct ui_box){places[i][0] - half, places[i][1] - half, 2 * half, 2 * half});
        }
    }
    for (size_t i = 0; i < HITS_NAMED; i++) {
        char title[VIEW_ATLAS_TITLE];
        if (results[i]) {
            struct pane_name name = {.name = view_atlas_title(title, viewer->drawn, results[i]->object),
                                     .object = results[i]->object,
                                     .colour = pen.colour,
                                     .is_hidden = window->pictures.cones[number].hides_hit[i],
                                     .scale = pen.scale};
            uint8_t rgba[4];
            viewer_colour(rgba, viewer, results[i]->object);
            if (is_old) {
                answer_pale(rgba, 1);
            }
            name.chip = (ui_colour){rgba[0], rgba[1], rgba[2], is_second ? 0 : 255};
            pane_name(&window->frame.labels, &window->screen.panes[PANE_3D], places[i], &name);
        }
    }
}

static struct ui_box find_inset(const struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    float edge = fminf(INSET * 16 * window->screen.scale, 0.3F * fminf(box->width, box->height));
    return (struct ui_box){box->x + box->width - edge - 10, box->y + 10, edge, edge};
}

enum { SEEN_CELL = 12 /* pixels: what is seen is asked once in a square of these */ };

/* The object that the picture shows at a pixel of the pane; 0 = none. */
static uint32_t find_seen(struct window *window, float x, float y)
{
    struct seen_places *seen = &window->pictures.seen;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    const struct eye *eye = &window->pictures.shown;
    if (window_sees_anew(&seen->view, window)) {
        memset(seen->places, 0, sizeof seen->places);
    }
    const int cell[2] = {(int)(x - box->x) / SEEN_CELL, (int)(y - box->y) / SEEN_CELL};
    struct seen_place *place = &seen->places[((unsigned)cell[1] * 97 + (unsigned)cell[0]) % SEEN_PLACES];
    if (!place->is_known || place->cell[0] != cell[0] || place->cell[1] != cell[1]) {
        double direction[3];
        double at[3];
        const double size[2] = {(double)box->width, (double)box->height};
        const double middle[2] = {(cell[0] + 0.5) * SEEN_CELL, (cell[1] + 0.5) * SEEN_CELL};
        eye_ray(direction, eye, size, middle);
        *place = (struct seen_place){.is_known = true, .cell = {cell[0], cell[1]}};
        if (!viewer_pick(&place->object, at, window->viewer, eye->camera.world_from_device + 12, direction, INFINITY)) {
            place->object = 0;
        }
    }
    return place->object;
}

/* A name on another area that is hit, and so has a colour, or is chosen would seem to be that area's. */
static bool allows_name(void *user, const struct ui_box *box, uint32_t object)
{
    struct window *window = user;
    const int columns = (int)ceilf(box->width / SEEN_CELL) + 1;
    bool does = true;
    for (int i = 0; object && does && i < 2 * columns; i++) {
        int column = i / 2;
        float x = box->x + fminf((float)(column * SEEN_CELL), box->width);
        float y = box->y + (i % 2 ? 0.9F : 0.1F) * box->height;
        uint32_t other = find_seen(window, x, y);
        does = !other || other == object ||
               !(viewer_rank(window->viewer, other) || other == window->viewer->drawn->shown.chosen);
    }
    return does;
}

/* Sizes of the card, parts of the pane's height: texts can be read from the back of a room. */
static const float card_name = 52.0F / 900, card_more = 26.0F / 900, card_hit = 24.0F / 900, card_gap = 10.0F / 900;

/* Keeps names off what else lies over the picture. */
static void reserve_places(struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    struct ui_box inset = find_inset(window);
    float line = ui_line();
    float across = 5 * line; /* of the directions */
    float up = 7.2F * line;
    float buttons[2];
    window->frame.labels = (struct labels){.allows = allows_name, .user = window};
    panel_views_size(buttons, window);
    labels_reserve(&window->frame.labels, (struct ui_box){box->x, box->y, buttons[0], buttons[1]});
    if (window->viewer->display.device_view) {
        inset.width = fmaxf(inset.width, ui_text_width(device_caption));
        inset.x = box->x + box->width - inset.width - 10;
        inset.height += 1.5F * line;
        labels_reserve(&window->frame.labels, inset);
    }
    labels_reserve(&window->frame.labels,
                   (struct ui_box){box->x + box->width - across, box->y + box->height - up, across, up});
    labels_reserve(&window->frame.labels,
                   (struct ui_box){box->x, box->y + box->height - 3 * line, box->width, 3 * line}); /* notices */
    if (screen_is_bare(&window->screen)) {
        window->frame.labels.high = card_hit * box->height;
        const float high = (card_name + card_more + card_hit + 5 * card_gap) * box->height + 4 * line;
        labels_reserve(&window->frame.labels,
                       (struct ui_box){box->x, box->y + box->height - high, 0.65F * box->width, high});
    }
}

/* Draws the device's view, enlarged: the pixels of its buffer in the areas' colours. */
static void draw_device_view(struct window *window)
{
    const conus_selection *selection = viewer_selection(window->viewer);
    conus_evidence evidence = conus_selection_evidence(selection);
    uint32_t n = evidence.resolution;
    if (!window->viewer->display.device_view || n < 1 || n > 64) {
        return;
    }
    uint8_t rgba[64 * 64 * 4];
    for (uint32_t pixel = 0; pixel < n * n; pixel++) {
        uint8_t *to = rgba + 4 * ((n - 1 - pixel / n) * n + pixel % n);
        viewer_colour(to, window->viewer, evidence.object[pixel]);
        if (!evidence.object[pixel]) {
            memset(to, 52, 3);
        }
        for (int c = 0; c < 3 && !evidence.in_cone[pixel]; c++) {
            to[c] = (uint8_t)(to[c] / 4);
        }
        to[3] = 255;
    }
    if (inputs_is_old(&window->inputs, window->viewer, FIRST_TOOL)) {
        answer_pale(rgba, (size_t)n * n);
    }
    texture_set(&window->pictures.device_view, rgba, n, n, false);
    struct ui_box inset = find_inset(window);
    ui_surface("inset", inset);
    ui_draw_image(window->pictures.device_view.name, inset);
    ui_draw_box(inset, light, 1);
    ui_draw_text((float[]){inset.x + inset.width - ui_text_width(device_caption), inset.y + inset.height + 4}, light,
                 device_caption);
}

static void draw_measured(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    float ends[2][2] = {{0}};
    bool seen = viewer->measure.count > 0;
    for (uint32_t i = 0; i < viewer->measure.count; i++) {
        seen = window_point(ends[i], window, viewer->measure.points + (size_t)3 * i) && seen;
    }
    if (seen) {
        pane_measured(window, &window->frame.labels, &window->screen.panes[PANE_3D], NULL, ends);
    }
}

static void draw_waiting(const struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    char error[PAINTER_TEXT];
    static const char drawing[] = "drawing\u2026";
    const float at[2] = {box->x + 20, box->y + box->height / 2};
    const float middle[2] = {box->x + (box->width - ui_text_width(drawing)) / 2,
                             window->pictures.painted.name ? box->y + 4 * ui_line() : at[1]};
    if (!window->viewer->painter) {
        ui_draw_text(at, theme_shaded[THEME_ORANGE], "not enough memory to draw");
    } else if (painter_text(error, window->viewer->painter, PAINTER_ERROR)) {
        ui_draw_text(at, theme_shaded[THEME_ORANGE], error);
    } else if (!window->pictures.painted.name || window->pictures.says_late) {
        ui_draw_text(middle, light, drawing);
    }
}

/* Writes the next best hits in one line, as far as there is room for them, or only measures it. Returns its width. */
static float draw_next_hits(const struct viewer *viewer, const float start[2], float room, float high, bool draws)
{
    const conus_selection *selection = viewer_selection(viewer);
    float used = 0;
    for (size_t i = 1; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        char title[VIEW_ATLAS_TITLE];
        char text[VIEW_ATLAS_TITLE + SHARE_TEXT];
        char share[SHARE_TEXT];
        if (!result->object || !result->pixels) {
            continue;
        }
        headline_share(share, result->share);
        snprintf(text, sizeof text, "%s %s", view_atlas_title(title, viewer->drawn, result->object), share);
        const float wide = ui_large_width(text, high) + 1.8F * high;
        if (used + wide > room) {
            break;
        }
        if (draws) {
            ui_draw_box((struct ui_box){start[0] + used, start[1] + 0.2F * high, 0.6F * high, 0.6F * high},
                        panel_colour(viewer, result->object), 0);
            ui_draw_large((float[]){start[0] + used + high, start[1]}, light, text, high);
        }
        used += wide;
    }
    return used;
}

/* Where there are no panels the answer stands on the picture, above the line @p below. */
static void draw_card(struct window *window, float below)
{
    struct viewer *viewer = window->viewer;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    const conus_selection *selection = viewer_selection(viewer);
    struct headline headline;
    char shown[HEADLINE_TEXT];
    const bool is_old = inputs_is_old(&window->inputs, viewer, FIRST_TOOL);
    headline_find(&headline, viewer);
    if (is_old) {
        snprintf(shown, sizeof shown, "OLD ANSWER \u00b7 %.480s", headline.more);
        memcpy(headline.more, shown, sizeof shown);
    }
    const float gap = card_gap * box->height;
    const float more = card_more * box->height;
    const float hit = card_hit * box->height;
    const float most = 0.6F * box->width;
    float name = card_name * box->height;
    name = fmaxf(fminf(name, name * most / ui_large_width(headline.what, name)), more);
    const float whole = name + more + hit + 4 * gap;
    float at[2] = {box->x + 5 * gap, below - whole};
    float wide = fmaxf(ui_large_width(headline.what, name), ui_large_width(headline.more, more));
    wide = fminf(fmaxf(wide, draw_next_hits(viewer, at, most, hit, false)), most);
    const uint32_t best = conus_selection_count(selection) ? conus_selection_result(selection, 0)->object : 0;
    const ui_colour bar = is_old                ? theme_shaded[THEME_ORANGE]
                          : headline.is_of_plan ? theme_shaded[panel_verdict_colour(plans_verdict(viewer))]
                                                : panel_colour(viewer, best);
    const struct ui_box card = {at[0] - 2 * gap, at[1] - gap, wide + 4 * gap, whole};
    ui_draw_box(card, theme_surfaces[THEME_SHADE], 0);
    ui_draw_box((struct ui_box){card.x, card.y, 0.6F * gap, card.height}, bar, 0);
    ui_shorten_name(shown, sizeof shown, headline.what,
                    most * ui_text_width(headline.what) / ui_large_width(headline.what, name));
    ui_draw_large(at, theme_shaded[THEME_PLAIN], shown, name);
    at[1] += name + gap;
    ui_draw_large(at, theme_shaded[is_old ? THEME_ORANGE : THEME_HINT], headline.more, more);
    at[1] += more + gap;
    if (!is_old) {
        draw_next_hits(viewer, at, most, hit, true);
    }
}

/* Writes notices at the lower edge: of the head, and above it of both cones; and above all the answer, where no panel
 * has it. */
static void draw_notices(struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    const struct viewer *viewer = window->viewer;
    struct notice notice;
    char second[128];
    char shown[PLAN_LINE];
    bool is_well;
    float room = box->width - 16 - (has_compass(box) ? 2 * compass_reach() : 0); /* of lines beside the directions */
    float at[2] = {box->x + 8, box->y + box->height - 1.4F * ui_line()};
    const char *text = head_text(&viewer->head, &is_well);
    if (text) {
        ui_draw_text(at, is_well ? light : theme_shaded[THEME_ORANGE], text);
        at[1] -= 1.4F * ui_line();
    }
    if (viewer->measure.on) {
        ui_draw_text(at, theme_shaded[THEME_GREEN], "measuring; Ctrl+M ends it");
        at[1] -= 1.4F * ui_line();
    }
    inputs_notice(&notice, &window->inputs, window->viewer, FIRST_TOOL);
    if (notice.text) {
        ui_draw_text(at, notice.is_trouble ? theme_shaded[THEME_ORANGE] : light, notice.text);
        at[1] -= 1.4F * ui_line();
    }
    if (notice.is_old) {
        at[1] -= ui_line();
        ui_draw_heading(at, theme_shaded[THEME_ORANGE], "OLD ANSWER");
        at[1] -= 1.4F * ui_line();
    }
    const bool panel_says_it = !window->screen.folded[1] && !screen_is_bare(&window->screen);
    struct panel_warning warning;
    for (size_t i = 0; !panel_says_it && panel_warning(&warning, &i, viewer);) {
        ui_shorten(shown, sizeof shown, warning.text, room);
        ui_draw_text(at, theme_shaded[warning.colour], shown);
        at[1] -= 1.4F * ui_line();
    }
    if (plans_is_on(viewer) && !notice.is_old && !panel_says_it) {
        char line[PLAN_LINE];
        plans_line(line, window->viewer, true);
        if (ui_text_width(line) > room) { /* the verdict first */
            plans_line(line, window->viewer, false);
        }
        ui_shorten(shown, sizeof shown, line, room);
        ui_draw_text(at, theme_shaded[panel_verdict_colour(plans_verdict(window->viewer))], shown);
        at[1] -= 1.4F * ui_line();
    }
    inputs_notice(&notice, &window->inputs, window->viewer, SECOND_TOOL);
    if (viewer->tools[SECOND_TOOL].on && notice.text) {
        snprintf(second, sizeof second, "tool 2: %s%s", notice.is_old ? "OLD ANSWER: " : "", notice.text);
        ui_shorten(shown, sizeof shown, second, room);
        ui_draw_text(at, notice.is_trouble ? theme_shaded[THEME_ORANGE] : light, shown);
        at[1] -= 1.4F * ui_line();
    }
    if (screen_is_bare(&window->screen) && viewer->tools[FIRST_TOOL].has_pose) {
        draw_card(window, at[1] + ui_line());
    }
}

/* Finds what is on the ray from the eye through the mouse. */
static void find_hovered(struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    const struct ui_mouse mouse = ui_mouse_now();
    const double size[2] = {(double)box->width, (double)box->height};
    const double at[2] = {(double)(mouse.x - box->x), (double)(mouse.y - box->y)};
    struct hover *hover = &window->frame.hover;
    memcpy(hover->eye, window->pictures.shown.camera.world_from_device + 12, sizeof hover->eye);
    eye_ray(hover->direction, &window->pictures.shown, size, at);
    hover->by_ray = true;
    hover->has_place = viewer_pick(&hover->object, hover->at, window->viewer, hover->eye, hover->direction, INFINITY);
    if (hover->object) {
        hover->value = view_atlas_value(window->viewer->drawn, hover->object, hover->at);
    }
}

static void point_at(struct window *window, const struct hover *hover)
{
    inputs_point(&window->inputs, window->viewer, hover->eye, hover->direction);
}

/* The left button is pressed: this place counts, in the picture that is seen now, whatever comes before it is let go.
 */
static void press(struct window *window, const struct ui_mouse *mouse)
{
    window->frame.pressed = window->frame.hover;
    window->frame.pressed_of = window->viewer->drawn;
    window->frame.turned[0] = mouse->x;
    window->frame.turned[1] = mouse->y;
    window->frame.points_again = false;
    point_at(window, &window->frame.pressed); /* the picture may be another one than when the mouse came there */
}

/* A click that did not turn the view sets the crosshair to the place that was pressed, and holds the mouse's cone there
 * or lets it go. */
static void use_click(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const struct hover *pressed = &window->frame.pressed;
    enum tool_number tool = tool_moved_by(viewer, POINT_BY_MOUSE);
    if (!viewer->measure.on && pane_points_choose(window, window->frame.turned, NULL)) {
        return;
    }
    if (tool < TOOL_COUNT && viewer->tools[tool].has_pose && !viewer->measure.on) {
        tool_hold(viewer, tool);
        point_at(window, pressed); /* of one that was let go */
    }
    if (pressed->has_place && viewer->measure.on) {
        viewer_measure(viewer, pressed->at);
    } else if (pressed->has_place) {
        viewer_cross(viewer, pressed->at);
        viewer->drawn->shown.chosen = pressed->object ? pressed->object : viewer->drawn->shown.chosen;
    }
}

/* Returns whether the view moves. Where the head moves it, the mouse does not. */
static bool use_mouse(struct window *window)
{
    struct viewer *viewer = window->viewer;
    const struct ui_mouse mouse = ui_mouse_now();
    struct frame_state *frame = &window->frame;
    double height = (double)window->screen.panes[PANE_3D].height;
    bool held = ui_surface_held();
    bool moved = mouse.moved_x != 0 || mouse.moved_y != 0;
    bool is_behind = !eye_is_same(&window->pictures.shown, &window->pictures.eye);
    bool turns = held && mouse.down[0] && frame->pressed_of && mouse.strayed >= click && moved;
    bool pans = held && !mouse.down[0] && moved && (mouse.down[1] || mouse.down[2]);
    if (pane_cone_turn(window)) {
        return moved;
    }
    if (mouse.pressed[0] && held) {
        press(window, &mouse);
    }
    if (viewer->head.on && viewer->head.known && (turns || pans || mouse.wheel != 0)) {
        viewer_say(viewer, "the head moves the view; T gives it to the mouse");
        return false;
    }
    if (turns) {
        orbit_turn(&viewer->orbit, (double)(mouse.x - frame->turned[0]), (double)(mouse.y - frame->turned[1]), height);
        frame->turned[0] = mouse.x;
        frame->turned[1] = mouse.y;
    } else if (pans) {
        orbit_pan(&viewer->orbit, (double)mouse.moved_x, (double)mouse.moved_y, height);
    } else if (!held && pane_cone_at(window, (float[]){mouse.x, mouse.y}) == TOOL_COUNT &&
               (moved || (frame->points_again && !is_behind))) {
        point_at(window, &frame->hover);
        frame->points_again = is_behind;
    }
    if (mouse.wheel != 0) {
        orbit_zoom(&viewer->orbit, (double)mouse.wheel);
    }
    if (mouse.doubled) {
        inputs_confirm(&window->inputs, viewer, FIRST_TOOL);
    }
    return moved || mouse.wheel != 0;
}

/* The button may be let go anywhere. */
static void use_release(struct window *window)
{
    const struct ui_mouse mouse = ui_mouse_now();
    if (mouse.released[0]) {
        if (window->frame.pressed_of == window->viewer->drawn && mouse.strayed < click) {
            use_click(window);
        }
        window->frame.pressed_of = NULL;
    }
}

/* Names what is under the mouse; where the cone follows the mouse, it has its name there already. */
static void show_hover_tip(const struct window *window)
{
    const struct ui_mouse mouse = ui_mouse_now();
    if (pane_cone_at(window, (float[]){mouse.x, mouse.y}) < TOOL_COUNT) {
        ui_tip("drag it: the cone turns about the place where it enters");
        return;
    }
    enum tool_number follows = tool_moved_by(window->viewer, POINT_BY_MOUSE);
    if (window->frame.hover.object && !labels_has(&window->frame.labels, window->frame.hover.object) &&
        (follows == TOOL_COUNT || window->viewer->tools[follows].held)) {
        hover_tip(window);
    }
}

/* Notes until when pictures shall be quick: the mouse moves the view or the cone, or a tracker or a replay does. */
static void note_moves(struct window *window, bool by_mouse)
{
    const struct viewer *viewer = window->viewer;
    double now = clock_ms();
    bool is_by_device =
        viewer->tools[FIRST_TOOL].pointer >= POINT_BY_REPLAY; /* or a tracker, a SpaceMouse, a gamepad */
    if (by_mouse) {
        window->pictures.moving_until = now + view_rest_ms;
    }
    if ((is_by_device && window->pictures.noted_answer != viewer->tools[FIRST_TOOL].answer_number) ||
        (viewer->head.on && window->pictures.noted_head != viewer->head.number)) {
        window->pictures.moving_until = now + others_rest_ms;
    }
    window->pictures.noted_answer = viewer->tools[FIRST_TOOL].answer_number;
    window->pictures.noted_head = viewer->head.number;
    window->pictures.moving = now < window->pictures.moving_until;
}

void pane_3d(struct window *window)
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    struct ui_box place;
    orbit_fit(&window->viewer->orbit, (double[]){(double)box->width, (double)box->height});
    window_eye(window, &window->pictures.eye);
    take_picture(window);
    find_shown(&place, &window->pictures, box);
    ui_panel("3d", *box, UI_PLAIN);
    if (window->pictures.painted.name) {
        ui_draw_box(*box, window->pictures.around, 0);
        ui_draw_image(window->pictures.painted.name, place);
    } else {
        ui_draw_box(*box, dark, 0);
    }
    bool by_mouse = false;
    if (ui_mouse_now().pressed[0]) { /* wherever that is */
        window->frame.pressed_of = NULL;
    }
    if (ui_surface("surface", *box)) {
        find_hovered(window);
        by_mouse = use_mouse(window);
        show_hover_tip(window);
    }
    use_release(window);
    note_moves(window, by_mouse);
    ask_painter(window, window->pictures.moving);
    pictures_note_late(&window->pictures, clock_ms());
    reserve_places(window);
    ui_clip(*box);
    pane_chosen(window);
    draw_compass(window);
    pane_points(window, PANE_3D, box, NULL);
    pane_cones(window);
    pane_cross(window);
    draw_names(window, FIRST_TOOL); /* the answer has the best places */
    window_note_shown(window, SHOWN_LABELS);
    pane_chosen_names(window);
    draw_measured(window);
    draw_names(window, SECOND_TOOL);
    draw_waiting(window);
    draw_notices(window);
    draw_device_view(window);
    ui_clip_end();
    ui_panel_end();
}
