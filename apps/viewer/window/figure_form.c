/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a name, waits until the window has said what it does, and writes what a pane shows as conus render would. */
#include "viewer/window/window.h"

#include "base/look.h"
#include "base/path.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "viewer/model/viewer.h"

#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void figure_of_window(struct figure_settings *out, const struct window *window)
{
    const struct sheet *sheet = &window->sheet;
    const struct view_atlas *drawn = window->viewer->drawn;
    *out =
        (struct figure_settings){.side = CONUS_SIDE_OF_CONE + 1,
                                 .dpi = sheet->dpi,
                                 .legend = (size_t)sheet->legend,
                                 .no_legend = sheet->no_text,
                                 .background = window->viewer->display.backdrop == BACKDROP_THEME
                                                   ? NULL /* as figures have it: white on paper */
                                                   : backdrop_of_figures(window->viewer->display.backdrop),
                                 .streamline_colour = appearance_streamline_colour(&drawn->appearance, drawn->atlas)};
    if (sheet->in_mm) {
        out->width_mm = sheet->mm[0];
        out->height_mm = sheet->mm[1];
    } else {
        memcpy(out->size, sheet->pixels, sizeof out->size);
    }
}

/* The two places that are measured; NULL = fewer are. */
static const double *measured(const struct viewer *viewer)
{
    return viewer->measure.count == 2 ? viewer->measure.points : NULL;
}

/* The renderer is the caller's to destroy, also where this fails. */
static conus_status make_renderer(conus_renderer **out, const struct viewer *viewer,
                                  const struct figure_settings *settings)
{
    const struct appearance *appearance = &viewer->drawn->appearance;
    const struct transfer_editor *editor = &viewer->transfer_editor;
    conus_pathway_transfer *pathways = calloc(appearance->object_count + 1, sizeof *pathways);
    if (!pathways) {
        return CONUS_ERROR_MEMORY;
    }
    const conus_renderer_options options = {.transfer = viewer->preset ? viewer->preset : viewer->transfer,
                                            .pathways = pathways,
                                            .pathway_count = appearance_pathways(pathways, appearance),
                                            .streamline_colour = settings->streamline_colour};
    conus_status status = conus_renderer_create(out, viewer->drawn->atlas, &options);
    free(pathways);
    return status || !editor->edited ? status : conus_renderer_set_transfer(*out, editor->points, editor->count);
}

/* A field of view fits the drawing, which a legend makes narrower; an eye beside the middle needs a frustum. */
static bool set_camera(conus_view *view, struct eye *eye, const char *streamline_colour)
{
    double *f = eye->frustum;
    view->camera = &eye->camera;
    if (f[0] == -f[1] && f[2] == -f[3]) {
        view->field_of_view = 2 * atan(f[3]) * (180 / M_PI);
        return true;
    }
    eye_fit(eye, (double[]){view->width, view->height});
    memcpy(view->frustum, f, sizeof view->frustum);
    bool has_key = streamline_colour && strcmp(streamline_colour, "bundle") != 0;
    return view->legend != CONUS_LEGEND_RIGHT || view->no_legend || (!view->selection && !has_key);
}

/* What the pane has over its picture. */
struct marks {
    conus_drawn_point items[TOOL_COUNT * (CONE_LINES + 3 + HITS_NAMED)];
    size_t count;
};

static conus_drawn_point *add_mark(struct marks *marks, const double from[3], const double to[3], uint32_t rgb)
{
    conus_drawn_point *mark = &marks->items[marks->count++];
    for (int a = 0; a < 3; a++) {
        mark->at[a] = from[a];
        mark->end[a] = to[a];
        mark->rgb[a] = (uint8_t)(rgb >> (16 - 8 * a));
    }
    return mark;
}

/* Adds a tool's cone, its beginning, its ball and the names of its best hits, as the pane has them for this eye. */
static void add_tool(struct marks *marks, const struct window *window, enum tool_number number, const struct eye *eye)
{
    static const uint32_t colours[TOOL_COUNT] = {LOOK_CONE, LOOK_SECOND};
    const struct viewer *viewer = window->viewer;
    const struct tool *tool = &viewer->tools[number];
    const struct cone_sight *sight = &window->pictures.cones[number];
    const conus_selection *selection = view_atlas_selection(viewer->drawn, number);
    bool is_shown = tool_has_cone(viewer, number) && sight->is_seen && sight->answer_number == tool->answer_number &&
                    eye_is_same(&sight->view.eye, eye);
    uint32_t rgb = inputs_is_old(&window->inputs, viewer, number) ? LOOK_CONE_OLD : colours[number];
    if (!is_shown) {
        return;
    }
    for (size_t i = 0; i < sight->line_count; i++) {
        const struct cone_line *line = &sight->lines[i];
        add_mark(marks, line->ends[0], line->ends[1], rgb)->dashed = line->dashed;
    }
    const double *apex = tool->pose.world_from_device + 12;
    add_mark(marks, apex, apex, rgb)->radius = 5;
    add_mark(marks, apex, apex, LOOK_APEX)->radius = 3.5;
    if (sight->has_ball) {
        add_mark(marks, sight->ball, sight->ball, rgb)->radius = 8;
    }
    for (size_t i = 0; i < HITS_NAMED && i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            add_mark(marks, result->contact, result->contact, rgb)->object = result->object;
        }
    }
}

static conus_status draw_3d(conus_image **out, const char **refusal, const struct window *window,
                            const struct figure_settings *settings, bool shapes)
{
    const struct viewer *viewer = window->viewer;
    conus_renderer *renderer = NULL;
    struct eye eye;
    struct marks *marks = calloc(1, sizeof *marks);
    if (!marks) {
        return CONUS_ERROR_MEMORY;
    }
    conus_view view = {.selection = answer_selection(viewer_pictured(viewer)),
                       .no_cone = !tool_has_cone(viewer, FIRST_TOOL),
                       .chosen = viewer_full(viewer),
                       .fade = viewer->display.fade,
                       .no_covered_context = true,
                       .shapes = shapes,
                       .measured = measured(viewer),
                       .points = viewer->points.points,
                       .point_count = viewer->points.count};
    window_eye(window, &eye);
    for (enum tool_number number = FIRST_TOOL; number < TOOL_COUNT; number++) {
        add_tool(marks, window, number, &eye);
    }
    view.marks = marks->items;
    view.mark_count = marks->count;
    figure_view(&view, settings);
    view.legend = view.no_cone ? CONUS_LEGEND_NONE : view.legend; /* of no question */
    view.opacity = viewer->drawn->appearance.opacity;
    view.pale = view.opacity[0];
    view.own_colours = viewer->display.own_colours;
    if (!set_camera(&view, &eye, settings->streamline_colour)) {
        *refusal = "a tracked head's view has no room for a legend beside it: choose auto, below or none";
        free(marks);
        return CONUS_OK;
    }
    conus_status status = make_renderer(&renderer, viewer, settings);
    status = status ? status : conus_render(out, renderer, &view);
    conus_renderer_destroy(renderer);
    free(marks);
    return status;
}

static conus_status draw_cut(conus_image **out, const struct window *window, enum plane plane,
                             const struct figure_settings *settings, bool shapes)
{
    conus_view sheet = {.shapes = shapes,
                        .measured = measured(window->viewer),
                        .points = window->viewer->points.points,
                        .point_count = window->viewer->points.count};
    conus_cut_view view;
    figure_view(&sheet, settings);
    const struct viewer *viewer = window->viewer;
    cut_view(&view, viewer, plane, (double[]){sheet.width, sheet.height});
    if (sheet.measured || viewer->magnification != 1) { /* which sheets do not show */
        return conus_cut_image(out, viewer->drawn->atlas, &view, &sheet);
    }
    conus_cut_plane whole;
    memcpy(whole.at, view.centre, sizeof whole.at);
    memcpy(whole.right, view.right, sizeof whole.right);
    memcpy(whole.up, view.up, sizeof whole.up);
    sheet.selection = view.selection;
    sheet.legend = view.no_cone ? CONUS_LEGEND_NONE : sheet.legend;
    sheet.own_colours = view.own_colours;
    sheet.frame = &viewer->frame;
    return conus_render_cuts(out, viewer->drawn->atlas, &whole, 1, &view, NULL, &sheet);
}

/* As figure_write(), but gives the image; none where there is a refusal. */
static conus_status draw_figure(conus_image **out, const char **refusal, const struct window *window, size_t pane,
                                const struct figure_settings *settings, bool shapes)
{
    return pane == PANE_3D ? draw_3d(out, refusal, window, settings, shapes)
                           : draw_cut(out, window, (enum plane)pane, settings, shapes);
}

static const char *reason_of(conus_status status)
{
    return conus_message()[0] || status != CONUS_ERROR_MEMORY ? conus_message() : "not enough memory";
}

bool figure_write(const struct window *window, size_t pane, const struct figure_settings *settings, const char *path,
                  char why[FIGURE_REASON])
{
    conus_image *image = NULL;
    const char *refusal = NULL;
    const bool shapes = path_ends_in(path, ".svg") || path_ends_in(path, ".pdf");
    conus_status status = draw_figure(&image, &refusal, window, pane, settings, shapes);
    status = status || refusal ? status : conus_image_write(image, path);
    conus_image_destroy(image);
    if (status) {
        refusal = reason_of(status);
    }
    snprintf(why, FIGURE_REASON, "%s", refusal ? refusal : "");
    return !refusal;
}

const char *const figure_panes[PANE_COUNT] = {"axial", "coronal", "sagittal", "3d"};

/* The frame in which the figure is asked for, and one more that shows a word about it. */
enum { PREVIEW_WIDTH = 496, PREVIEW_HEIGHT = 240 /* at scale 1 */, FRAMES_BEFORE = 4, FREE_NAMES = 10000 };

void figure_form_open(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    form->open = form->takes_keys = true;
    form->pane = window->screen.enlarged >= 0 ? (size_t)window->screen.enlarged : PANE_3D;
    form->update[0] = form->replaced[0] = '\0';
    form->failed = false;
    for (int i = 1; i < FREE_NAMES; i++) {
        snprintf(form->name, sizeof form->name, "figure-%d.png", i);
        if (!system_allows(form->name, 0)) {
            return;
        }
    }
}

static void say(struct window *window, const char *what, const char *name)
{
    struct figure_form *form = &window->forms.figure;
    snprintf(form->update, sizeof form->update, "%s%s", what, name);
    form->failed = false;
    viewer_say(window->viewer, "%s", form->update);
}

/* Says an error, after which another name may be typed. */
static void complain(struct window *window, const char *what, const char *name)
{
    say(window, what, name);
    window->forms.figure.failed = window->forms.figure.takes_keys = true;
}

static bool has_folder(const char *name)
{
    char folder[FIGURE_NAME];
    struct system_stat info;
    snprintf(folder, sizeof folder, "%.*s", (int)path_folder_length(name), name);
    return !folder[0] || (system_stat(&info, folder) && info.kind == SYSTEM_FOLDER);
}

void figure_form_save(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    size_t used = strlen(form->name);
    if (!used || form->frames) {
        return;
    }
    if (path_ending_length(form->name, ".jpg/.jpeg/.tif/.tiff/.gif/.bmp/.webp/.eps/.ps")) {
        complain(window, "figures are .png, .svg, .pdf or .exr, not as in ", form->name);
        return;
    }
    if (!has_folder(form->name)) {
        complain(window, "there is no such folder: ", form->name);
        return;
    }
    if (!path_ending_length(form->name, ".png/.exr/.svg/.pdf")) {
        snprintf(form->name + used, sizeof form->name - used, ".png");
    }
    if (system_allows(form->name, 0) && strcmp(form->replaced, form->name) != 0) {
        snprintf(form->replaced, sizeof form->replaced, "%s", form->name);
        say(window, "it is there already; save again to replace ", form->name);
        return;
    }
    form->frames = FRAMES_BEFORE;
    form->previews = false;
    window->frame.frames_wanted = FRAMES_BEFORE + 2;
    say(window, "saving ", form->name);
}

void figure_form_preview(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    form->frames = FRAMES_BEFORE;
    form->previews = true;
    window->frame.frames_wanted = FRAMES_BEFORE + 2;
    say(window, "drawing\u2026", "");
}

/* The same sheet with fewer pixels, at most as many as given, and letters that are as much smaller. */
static void shrink(struct figure_settings *settings, const double most[2])
{
    conus_view view = {0};
    figure_view(&view, settings);
    const double part = fmin(fmin(most[0] / view.width, most[1] / view.height), 1);
    const double em = fmax(LOOK_FIGURE_LEAST, fmin(view.width, view.height) / (double)LOOK_FIGURE_PART);
    settings->dpi = part * (view.dpi > 0 ? view.dpi : em * 72 / LOOK_FIGURE_POINTS);
    settings->width_mm = settings->height_mm = 0;
    settings->size[0] = (uint32_t)fmax(part * view.width, 1);
    settings->size[1] = (uint32_t)fmax(part * view.height, 1);
}

static void draw_preview(struct window *window, struct figure_settings *settings)
{
    struct figure_form *form = &window->forms.figure;
    conus_image *image = NULL;
    const char *refusal = NULL;
    const float scale = window->screen.scale;
    shrink(settings, (const double[]){PREVIEW_WIDTH * scale, PREVIEW_HEIGHT * scale});
    conus_status status = draw_figure(&image, &refusal, window, form->pane, settings, false);
    uint8_t *rgba = image ? painted_bytes(image) : NULL;
    if (rgba) {
        texture_set(&window->pictures.preview, rgba, conus_image_width(image), conus_image_height(image), false);
        form->previewed_version = window->viewer->version;
        form->previewed_pane = form->pane;
        say(window, "", "");
    } else {
        complain(window, "", status ? reason_of(status) : refusal ? refusal : "not enough memory");
    }
    free(rgba);
    conus_image_destroy(image);
}

const struct texture *figure_form_previewed(const struct window *window)
{
    const struct figure_form *form = &window->forms.figure;
    const struct texture *preview = &window->pictures.preview;
    const bool is_same = form->previewed_version == window->viewer->version && form->previewed_pane == form->pane;
    return preview->name && is_same ? preview : NULL;
}

void figure_form_step(struct window *window)
{
    struct figure_form *form = &window->forms.figure;
    struct figure_settings settings;
    char why[FIGURE_REASON];
    char whole[SYSTEM_PATH];
    form->frames -= form->frames > 0;
    if (form->frames != 1 || !window->viewer) {
        return;
    }
    form->frames = 0;
    figure_of_window(&settings, window);
    if (form->previews) {
        form->previews = false;
        draw_preview(window, &settings);
        return;
    }
    if (!figure_write(window, form->pane, &settings, form->name, why)) {
        complain(window, "", why);
        return;
    }
    bool found = system_real_path(whole, form->name) && strlen(whole) < sizeof form->saved;
    snprintf(form->saved, sizeof form->saved, "%.*s", FIGURE_NAME - 1, found ? whole : form->name);
    form->replaced[0] = '\0';
    say(window, "saved: ", form->saved);
}

void figure_form_copy(struct window *window)
{
    const char *saved = window->forms.figure.saved;
    if (saved[0]) {
        glfwSetClipboardString(window->handle, saved);
        viewer_say(window->viewer, "copied the path: %s", saved);
    } else {
        viewer_say(window->viewer, "no figure was saved yet: Ctrl+P");
    }
}
