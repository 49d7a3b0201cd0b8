/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens the window on its screen, lays it out, notes what is to be opened next, decides when a frame is due. */
#include "viewer/window/window.h"

#include "base/look.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Finds the screen that a place is on, else the first one, and its area, or the free part of it. NULL: there is none.
 */
static GLFWmonitor *find_screen(int area[4], const int middle[2], bool free)
{
    int count;
    GLFWmonitor **monitors = glfwGetMonitors(&count);
    for (int i = count - 1; i >= 0; i--) {
        const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
        if (free) {
            glfwGetMonitorWorkarea(monitors[i], &area[0], &area[1], &area[2], &area[3]);
        } else if (mode) {
            glfwGetMonitorPos(monitors[i], &area[0], &area[1]);
            area[2] = mode->width;
            area[3] = mode->height;
        } else {
            continue;
        }
        int across = middle[0] - area[0];
        int down = middle[1] - area[1];
        if (i == 0 || (across >= 0 && across < area[2] && down >= 0 && down < area[3])) {
            return monitors[i];
        }
    }
    return NULL;
}

/* The screen that the window's middle is on, with its x, y, width and height. */
static GLFWmonitor *window_screen(const struct window *window, int screen[4])
{
    int place[4];
    glfwGetWindowPos(window->handle, &place[0], &place[1]);
    glfwGetWindowSize(window->handle, &place[2], &place[3]);
    return find_screen(screen, (int[]){place[0] + place[2] / 2, place[1] + place[3] / 2}, false);
}

/* Fits a place to what is free on the screen that its middle is on, else on the first one. */
static void screen_fit(struct place *place)
{
    int area[4] = {0};
    const int middle[2] = {place->known ? place->x + place->width / 2 : INT_MIN / 2, place->y + place->height / 2};
    if (find_screen(area, middle, true) && area[2] > 0 && area[3] > 0) {
        place_fit(place, area);
    }
}

/* How large texts shall be on the screen that the window is on; `content` as the desktop says. */
static float window_screen_scale(const struct window *window, float content)
{
    int screen[4];
    int millimetres[2];
    GLFWmonitor *monitor = window_screen(window, screen);
    if (!monitor) {
        return content;
    }
    glfwGetMonitorPhysicalSize(monitor, &millimetres[0], &millimetres[1]);
    return place_scale(content, screen[2], millimetres[0]);
}

void window_fill_screen(struct window *window, bool fill)
{
    int screen[4];
    GLFWmonitor *monitor = fill ? window_screen(window, screen) : NULL;
    if (fill == window->screen.alone) {
        return;
    }
    if (fill) {
        window_place(window, &window->screen.before);
    }
    window->screen.alone = fill;
    if (monitor) { /* it stays when others are clicked on: who points may stand far from who clicks */
        glfwSetWindowAttrib(window->handle, GLFW_AUTO_ICONIFY, GLFW_FALSE);
        glfwSetWindowMonitor(window->handle, monitor, 0, 0, screen[2], screen[3], GLFW_DONT_CARE);
    } else if (!fill) {
        const struct place *place = &window->screen.before;
        glfwSetWindowMonitor(window->handle, NULL, place->x, place->y, place->width, place->height, 0);
    }
    window->viewer->version++;
}

/* Left, right, lower and upper edge of a box of the window, in parts of the screen. */
static void find_part_of_screen(double part[4], const struct window *window, const struct ui_box *box)
{
    int place[4];
    int screen[4];
    glfwGetWindowPos(window->handle, &place[0], &place[1]);
    glfwGetWindowSize(window->handle, &place[2], &place[3]);
    if (!window_screen(window, screen)) {
        memcpy(part, (double[]){0, 1, 0, 1}, 4 * sizeof *part);
        return;
    }
    double unit = (double)place[2] / window->screen.width; /* the screen's, per pixel */
    double left = place[0] - screen[0] + unit * (double)box->x;
    double top = place[1] - screen[1] + unit * (double)box->y;
    part[0] = left / screen[2];
    part[1] = (left + unit * (double)box->width) / screen[2];
    part[2] = 1 - (top + unit * (double)box->height) / screen[3];
    part[3] = 1 - top / screen[3];
}

void window_eye(const struct window *window, struct eye *out)
{
    const struct viewer *viewer = window->viewer;
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    double part[4];
    if (viewer->head.on && window->screen.width > 0) {
        find_part_of_screen(part, window, box);
        if (head_eye(out, &viewer->head, part)) {
            return;
        }
    }
    eye_of_orbit(out, &viewer->orbit, (double[]){(double)box->width, (double)box->height});
}

bool window_sees_anew(struct seen_view *view, const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const struct seen_view now = {.of = viewer->drawn,
                                  .atlas_number = viewer->atlas_number,
                                  .scene_number = viewer->scene_number,
                                  .eye = window->pictures.shown,
                                  .fade = viewer_fade(viewer)};
    bool is_same = view->of == now.of && view->atlas_number == now.atlas_number &&
                   view->scene_number == now.scene_number && view->fade == now.fade &&
                   eye_is_same(&view->eye, &now.eye);
    *view = now;
    return !is_same;
}

enum { STATUS_HEIGHT = 24 };

void window_forget_message(struct window *window)
{
    if (window->viewer) {
        window->viewer->message[0] = '\0';
    }
}

bool window_press(struct window *window, const char *key)
{
    window_forget_message(window);
    return window->press && window->press(window, key);
}

static const float least_zoom = PLACE_LEAST_ZOOM / 100.0F, most_zoom = PLACE_MOST_ZOOM / 100.0F;

/* The scale at which texts can be read and some fit; where the brain is alone also from the back of a room. */
static float find_wanted_scale(const struct screen *screen)
{
    enum { LINES = 56 /* that fill the height */ };
    float far = screen_is_bare(screen) ? (float)screen->height / (LINES * LOOK_TEXT) : 0;
    return fminf(fmaxf(fmaxf(screen->screen_scale * (float)screen->zoom, far), least_zoom), most_zoom);
}

/* Sets the size of texts from the next frame on. */
static void use_zoom(struct window *window, double zoom)
{
    window->screen.zoom = fmin(fmax(zoom, (double)least_zoom), (double)most_zoom);
    window->screen.next_scale = find_wanted_scale(&window->screen);
    window->frame.frames_wanted = FRAMES_PER_EVENT;
}

void window_zoom(struct window *window, int steps)
{
    use_zoom(window, steps ? window->screen.zoom * pow(1.1, steps) : 1);
}

void window_rescale(struct window *window, float content)
{
    if (!window->screen.scale_given) {
        window->screen.screen_scale = window_screen_scale(window, content);
        use_zoom(window, window->screen.zoom);
    }
}

static void print_glfw_error(int code, const char *text)
{
    (void)code;
    print_error_line("window: %s", text);
}

/* The library's contexts are EGL's, and put back what was current on a thread: they cannot where that is one of GLX. */
static GLFWwindow *make_window(const struct window_options *options, int api)
{
    const struct place *place = &options->place;
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR,
                   place->known ? GLFW_FALSE : GLFW_TRUE); /* a size that was left is of pixels */
    return glfwCreateWindow(place->width, place->height, "conus", NULL, NULL);
}

/* Maps the window. GLFW waits for that: for 0.1 s where no event is queued, else without an end, also for a window that
 * a window manager overlooks which is just starting. So the queue is emptied first, and it is mapped again. */
static void show(GLFWwindow *handle)
{
    enum { TRIES = 50 };
    for (int i = 0; i < TRIES && !glfwGetWindowAttrib(handle, GLFW_VISIBLE); i++) {
        glfwPollEvents();
        glfwShowWindow(handle);
    }
}

/* Places the window, as large as it was asked for or as the screen asks for, but no larger than the screen. */
static void put_on_screen(struct window *window, const struct window_options *options)
{
    struct place place = options->place;
    if (!place.known) {
        glfwGetWindowSize(window->handle, &place.width, &place.height);
        glfwGetWindowPos(window->handle, &place.x, &place.y);
    }
    struct place fitted = place;
    if (options->fits_screen) {
        screen_fit(&fitted);
    }
    if (fitted.width != place.width || fitted.height != place.height) {
        glfwSetWindowSize(window->handle, fitted.width, fitted.height);
    }
    if (place.known || fitted.x != place.x || fitted.y != place.y) {
        glfwSetWindowPos(window->handle, fitted.x, fitted.y);
    }
}

static void find_scale(struct window *window, const struct window_options *options)
{
    float content = 1;
    float across;
    glfwGetWindowContentScale(window->handle, &content, &across);
    window->screen.scale_given = options->scale > 0;
    window->screen.screen_scale =
        window->screen.scale_given ? (float)options->scale : window_screen_scale(window, content);
    use_zoom(window, options->place.zoom > 0 && !window->screen.scale_given ? options->place.zoom : 1);
    window->screen.scale = window->screen.next_scale;
    window->screen.next_scale = 0;
}

void window_place(const struct window *window, struct place *out)
{
    *out = window->screen.alone ? window->screen.before : (struct place){.known = true};
    if (!window->screen.alone) {
        glfwGetWindowSize(window->handle, &out->width, &out->height);
        glfwGetWindowPos(window->handle, &out->x, &out->y);
    }
    out->zoom = window->screen.zoom;
    out->layout = window->screen.layout;
}

/* GLFW and Xlib wait without an end for answers of a display: a user shall not wait for a window that never comes. */
static const unsigned patience_s = 30;

static void give_up(int number)
{
    static const char text[] =
        "conus: window: the display or its window manager has not answered for 30 s; start again\n";
    (void)number;
    (void)!write(STDERR_FILENO, text, sizeof text - 1);
    _exit(EXIT_NO_GL);
}

bool window_find_display(void)
{
    system_alarm(patience_s, give_up);
    glfwSetErrorCallback(print_glfw_error);
    bool found = glfwInit();
    system_alarm(0, give_up);
    return found;
}

bool window_open(struct window *out, const struct window_options *options)
{
    struct window window = {.screen = {.enlarged = -1, .layout = options->place.layout},
                            .sheet = {.pixels = {1400, 1050}, .mm = {85, 64}}, /* as conus render has it */
                            .start.on = true};
    devices_init(&window.inputs.devices);
    system_alarm(patience_s, give_up);
    window.handle = make_window(options, GLFW_EGL_CONTEXT_API);
    if (!window.handle) {
        window.handle = make_window(options, GLFW_NATIVE_CONTEXT_API);
    }
    if (window.handle && !options->hidden) {
        show(window.handle);
    }
    system_alarm(0, give_up);
    if (!window.handle) {
        glfwTerminate();
        return false;
    }
    glfwMakeContextCurrent(window.handle);
    glfwSwapInterval(1);
    theme_use(options->theme);
    window_clear(&window); /* or it is black until its fonts are ready */
    glfwSwapBuffers(window.handle);
    put_on_screen(&window, options);
    find_scale(&window, options);
    if (!ui_create(window.handle, window.screen.scale)) {
        print_error_line("window: no font for its texts");
        window_close(&window);
        return false;
    }
    *out = window;
    glfwSetWindowUserPointer(out->handle, out);
    return true;
}

static void pictures_drop(struct pictures *pictures)
{
    texture_drop(&pictures->painted);
    texture_drop(&pictures->device_view);
    texture_drop(&pictures->preview);
    for (enum outline which = 0; which < OUTLINE_COUNT; which++) {
        texture_drop(&pictures->shadows[which].texture);
        cells_finish(&pictures->shadows[which].cells);
    }
    for (int p = 0; p < PANE_COUNT; p++) {
        texture_drop(&pictures->points[p].texture);
    }
    for (int p = 0; p < PLANE_COUNT; p++) {
        texture_drop(&pictures->cuts[p].texture);
        conus_cutter_destroy(pictures->cuts[p].cutter);
    }
}

void window_history_finish(struct history *history)
{
    changes_finish(&history->changes);
    free(history->session_path);
    json_decref(history->kept);
}

void window_close(struct window *window)
{
    pictures_drop(&window->pictures);
    window_history_finish(&window->history);
    spacemouse_finish(&window->inputs.devices.spacemouse);
    open_request_finish(&window->files.requested);
    open_request_finish(&window->files.asked);
    free(window->files.session_waits);
    free(window->files.doubted);
    json_decref(window->files.opened);
    json_decref(window->files.lost);
    start_finish(&window->start);
    dialog_finish(&window->dialog);
    free(window->files.saves_as);
    free(window->files.saved_last);
    free(window->events.list);
    ui_destroy();
    glfwDestroyWindow(window->handle);
    glfwTerminate();
}

void window_show(struct window *window, struct viewer *viewer)
{
    pictures_drop(&window->pictures);
    window_history_finish(&window->history);
    window->viewer = viewer;
    window->pictures = (struct pictures){0};
    window->frame = (struct frame_state){.frames_wanted = 1, .turns_cone = TOOL_COUNT};
    window->history = (struct history){0};
    window->forms = (struct forms){0};
    window->inputs.replay = (struct replay){.poses = window->inputs.replay.poses};
    window->files.stops = false;
    window->screen.enlarged = -1;
    window->start.on = !viewer;
    start_stop(&window->start);
    window->dialog.on = false;
    window_lay_out(window);
}

void window_go_to_start(struct window *window)
{
    struct start *start = &window->start;
    size_t pins = window->viewer ? window->viewer->pin_count : 0;
    start_look(start);
    window->dialog.on = false;
    start->why[0] = start->typed[0] = '\0';
    if (pins) {
        snprintf(start->why, sizeof start->why,
                 "Another atlas in place of this one ends the list of what was kept (%zu). Escape goes back, where O "
                 "saves it.",
                 pins);
    }
    start->on = true;
}

void window_say(struct window *window, const char *text)
{
    char plain[START_WHY];
    snprintf(plain, sizeof plain, "%s", text);
    make_plain_line(plain);
    if (window->start.on) {
        memcpy(window->start.why, plain, sizeof plain);
        window->frame.frames_wanted = FRAMES_PER_EVENT;
    } else {
        viewer_say(window->viewer, "%s", plain);
    }
}

void window_lay_out(struct window *window)
{
    struct screen *screen = &window->screen;
    glfwGetFramebufferSize(window->handle, &screen->width, &screen->height);
    const float wanted = find_wanted_scale(screen);
    screen->next_scale = fabsf(wanted - screen->scale) > 0.005F ? wanted : screen->next_scale;
    screen_divide(screen);
}

void screen_divide(struct screen *screen)
{
    float width = (float)screen->width;
    float status = STATUS_HEIGHT * screen->scale;
    float height = fmaxf((float)screen->height - status, 0);
    struct division d = layout_divide(&screen->layout, width, height, screen->scale);
    screen->left = (struct ui_box){0, 0, d.left, height};
    screen->right = (struct ui_box){width - d.right, 0, d.right, height};
    screen->status = (struct ui_box){0, height, width, status};
    memcpy(screen->folded, d.folded, sizeof screen->folded);
    screen->panes[PANE_3D] = (struct ui_box){d.left, 0, d.column - 1, d.rows};
    float below = floorf((d.rows - d.row) / 2); /* the second and the third cut are as high as each other */
    const float tops[PLANE_COUNT + 1] = {0, d.row, d.row + below, d.rows + 1};
    for (int p = 0; p < PLANE_COUNT; p++) {
        screen->panes[p] =
            (struct ui_box){d.left + d.column, tops[p], d.columns - d.column - 1, tops[p + 1] - tops[p] - 1};
    }
    if (screen->enlarged >= 0) {
        screen->panes[screen->enlarged] = (struct ui_box){d.left, 0, d.columns, d.rows};
    }
    if (screen_is_bare(screen)) {
        screen->panes[PANE_3D] = (struct ui_box){0, 0, width, (float)screen->height};
    }
}

bool screen_is_bare(const struct screen *screen)
{
    return screen->alone || screen->bare;
}

bool screen_shows_pane(const struct screen *screen, int pane)
{
    const struct ui_box *box = &screen->panes[pane];
    bool chosen = screen_is_bare(screen) ? pane == PANE_3D : screen->enlarged < 0 || screen->enlarged == pane;
    return chosen && box->width >= 2 && box->height >= 2;
}

void window_maximise(struct window *window)
{
    struct ui_mouse mouse = ui_mouse_now();
    int under = PANE_3D;
    for (int p = 0; p < PANE_COUNT; p++) {
        const struct ui_box *box = &window->screen.panes[p];
        bool is_on =
            mouse.x >= box->x && mouse.x < box->x + box->width && mouse.y >= box->y && mouse.y < box->y + box->height;
        under = is_on ? p : under;
    }
    window->screen.enlarged = window->screen.enlarged < 0 ? under : -1;
    window_lay_out(window);
}

static bool is_behind(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const struct frame_state *frame = &window->frame;
    return frame->frames_wanted || window->events.count ||
           (viewer &&
            (frame->shown_version != viewer->version || frame->shown_said != viewer->said ||
             frame->shown_head != viewer->head.number || frame->shown_second != viewer->tools[SECOND_TOOL].version));
}

void pictures_note_late(struct pictures *pictures, double now)
{
    const struct painting *drawn = &pictures->drawn, *asked = &pictures->asked;
    const bool is_late = pictures->painted.name &&
                         (drawn->answer_number != asked->answer_number || drawn->plan_number != asked->plan_number ||
                          drawn->scene_number != asked->scene_number);
    pictures->late_at = !is_late ? 0 : pictures->late_at > 0 ? pictures->late_at : now + PICTURE_LATE_MS;
    pictures->says_late = is_late && now >= pictures->late_at;
}

bool window_needs_frame(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const struct pictures *pictures = &window->pictures;
    bool update = viewer && viewer->painter && painter_has_update(viewer->painter);
    update = (window->start.painted && painter_has_update(window->start.painted->painter)) || update;
    const double now = clock_ms();
    bool rests = pictures->moving && now >= pictures->moving_until;
    bool becomes_late =
        pictures->late_at > 0 && !pictures->says_late && now >= pictures->late_at; /* and is to say so */
    return update || rests || becomes_late || is_behind(window);
}

double window_idle_s(const struct window *window)
{
    if (is_behind(window)) {
        return 0;
    }
    const struct pictures *pictures = &window->pictures;
    const double until = fmin(pictures->moving ? pictures->moving_until : INFINITY,
                              pictures->late_at > 0 && !pictures->says_late ? pictures->late_at : INFINITY);
    return fmax(until - clock_ms(), 1) / 1e3;
}

void window_panel(const struct window *window, const char *title, float width, float height)
{
    const struct screen *screen = &window->screen;
    float wide = fminf(width * screen->scale, (float)screen->width);
    float high = fminf(height * screen->scale, (float)screen->height);
    ui_panel(title, (struct ui_box){((float)screen->width - wide) / 2, ((float)screen->height - high) / 2, wide, high},
             UI_IN_FRONT);
}

void window_clear(const struct window *window)
{
    glViewport(0, 0, window->screen.width, window->screen.height);
    const ui_colour panel = theme_surfaces[THEME_PANEL];
    glClearColor((float)panel.r / 255, (float)panel.g / 255, (float)panel.b / 255, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

void window_note_shown(struct window *window, enum shown_place place)
{
    const struct viewer *viewer = window->viewer;
    window->frame.shows[place] = (struct shown_numbers){.is_there = true,
                                                        .answer = viewer->tools[FIRST_TOOL].answer_number,
                                                        .plan = viewer->plan.number,
                                                        .scene = viewer->scene_number,
                                                        .second = viewer->tools[SECOND_TOOL].version};
}

bool window_rests(const struct window *window)
{
    const struct pictures *pictures = &window->pictures;
    const bool paints = window->viewer && !window->start.on && !window->dialog.on && !pictures->painted_fine &&
                        screen_shows_pane(&window->screen, PANE_3D);
    return !is_behind(window) && !pictures->moving && !paints;
}

bool window_is_settled(const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const struct pictures *pictures = &window->pictures;
    if (window->start.on || window->dialog.on) {
        return !window->start.painted;
    }
    bool settled = pictures->painted_fine || !screen_shows_pane(&window->screen, PANE_3D);
    settled = settled && !(studies_is_on(viewer) && studies_is_old(viewer)) && !plans_is_behind(viewer);
    for (int p = 0; p < PLANE_COUNT; p++) {
        settled = settled &&
                  (pictures->cuts[p].version == viewer_cut_version(viewer) || !screen_shows_pane(&window->screen, p));
    }
    return settled;
}

conus_status window_write(const struct window *window, const char *path)
{
    size_t row = 4 * (size_t)window->screen.width;
    uint8_t *bottom_up = malloc(row * (size_t)window->screen.height);
    uint8_t *rgba = malloc(row * (size_t)window->screen.height);
    conus_image *image = NULL;
    conus_status status = bottom_up && rgba ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        glReadPixels(0, 0, window->screen.width, window->screen.height, GL_RGBA, GL_UNSIGNED_BYTE, bottom_up);
        for (int y = 0; y < window->screen.height; y++) {
            memcpy(rgba + row * (size_t)y, bottom_up + row * (size_t)(window->screen.height - 1 - y), row);
        }
        for (size_t p = 0; p < row * (size_t)window->screen.height; p += 4) {
            rgba[p + 3] = 255;
        }
        status = conus_image_from_bytes(&image, rgba, (uint32_t)window->screen.width, (uint32_t)window->screen.height);
    }
    status = status ? status : conus_image_write(image, path);
    conus_image_destroy(image);
    free(bottom_up);
    free(rgba);
    return status;
}

bool window_has_request(const struct window *window)
{
    return window->files.requested.count || window->files.requested.words;
}

void open_request_finish(struct open_request *request)
{
    for (size_t i = 0; i < request->count; i++) {
        free(request->paths[i]);
    }
    free(request->paths);
    json_decref(request->words);
    *request = (struct open_request){.count = 0};
}

void window_request_files(struct window *window, size_t count, const char *const *paths)
{
    struct open_request *request = &window->files.requested;
    open_request_finish(request);
    request->paths = calloc(count + 1, sizeof *request->paths);
    while (request->paths && request->count < count &&
           (request->paths[request->count] = strdup(paths[request->count]))) {
        request->count++;
    }
    if (request->count < count) {
        open_request_finish(request);
        window_say(window, "not enough memory");
    }
}

void window_request_file(struct window *window, const char *path)
{
    window_request_files(window, 1, &path);
}

void window_request_typed(struct window *window)
{
    char path[SYSTEM_PATH];
    if (start_typed(path, &window->start)) {
        window_request_file(window, path);
    }
}

void window_request_sample(struct window *window)
{
    char path[SYSTEM_PATH];
    if (start_sample(path)) {
        window_request_file(window, path);
    } else {
        window_say(window, conus_message());
    }
}

void window_ask(struct window *window, struct open_request *request)
{
    open_request_finish(&window->files.asked);
    window->files.asked = *request;
    *request = (struct open_request){.count = 0};
    window->frame.frames_wanted = FRAMES_PER_EVENT;
}

void window_answer(struct window *window, enum opening how)
{
    struct open_request asked = window->files.asked;
    window->files.asked = (struct open_request){.count = 0};
    if (how == OPEN_ASKS) {
        open_request_finish(&asked);
    } else {
        open_request_finish(&window->files.requested);
        window->files.requested = asked;
        window->files.requested.how = how;
    }
}

void window_answer_closing(struct window *window, bool closes)
{
    window->forms.closing_loses = NULL;
    window->forms.closes = closes;
    glfwSetWindowShouldClose(window->handle, closes);
}

bool window_asks(const struct window *window)
{
    return window->forms.closing_loses || window->files.asked.count;
}

const struct json_t *window_words(struct window *window)
{
    const json_t *words = json_object_get(window->files.opened, "options");
    if (!words) {
        window_say(window, "one of the options with which conus was started is not UTF-8: the atlas stays as it is");
    }
    return words;
}

/* Opens the atlas again with these, which are taken over. */
static void request_words(struct window *window, json_t *words)
{
    if (words) {
        open_request_finish(&window->files.requested);
        window->files.requested.words = words;
    } else {
        window_say(window, "not enough memory, or a name that is not UTF-8");
    }
}

void window_change(struct window *window, size_t index, enum addition kind, const char *value)
{
    const json_t *words = window_words(window);
    json_t *rest = index == SIZE_MAX ? json_copy((json_t *)words) : words ? additions_without(words, index) : NULL;
    if (words) {
        request_words(window, !value ? json_incref(rest) : rest ? additions_with(rest, kind, value) : NULL);
    }
    json_decref(rest);
}

void window_request_hemispheres(struct window *window, conus_hemispheres how)
{
    const json_t *words = window_words(window);
    if (words && how != window->files.hemispheres) {
        request_words(window, hemispheres_put_in_words(words, how));
    } else if (words) {
        viewer_say(window->viewer, "%s", hemispheres_meanings[how]);
    }
}

void window_request_asked(struct window *window, conus_constraint_kind kind, const char *name, bool asks)
{
    const json_t *words = window_words(window);
    if (words) {
        request_words(window, plans_ask(window->viewer, words, kind, name, asks));
    }
}

void window_request_options(struct window *window, const json_t *options, int step)
{
    const json_t *words = window_words(window);
    json_t *asked = words ? plans_put_asked(words, options) : NULL;
    if (words) {
        request_words(window, asked ? hemispheres_put_in_words(asked, hemispheres_of_words(options)) : NULL);
        window->files.requested.step = step;
    }
    json_decref(asked);
}

bool window_connect(struct window *window)
{
    struct inputs *inputs = &window->inputs;
    bool fine = inputs_connect(inputs, window->wake);
    window->frame.sent_answer = 0; /* the new peer has none yet */
    if (fine) {
        viewer_say(window->viewer, "tracker: %s", inputs->address);
    } else {
        viewer_say(window->viewer, "%s", error_line());
    }
    return fine;
}

/* Finds a path in the folder of the file that was saved last, or else in one that can be written. */
static void find_saving_path(char path[SYSTEM_PATH], const struct window *window, const char *name)
{
    char here[SYSTEM_PATH];
    const char *last = window->files.saved_last;
    const char *home = getenv("HOME");
    bool fits = system_here(here) && system_allows(here, SYSTEM_WRITE);
    int size = last ? snprintf(path, SYSTEM_PATH, "%.*s%s", (int)(path_name(last) - last), last, name)
                    : snprintf(path, SYSTEM_PATH, "%s/%s",
                               fits   ? here
                               : home ? home
                                      : "",
                               name);
    path[size < SYSTEM_PATH ? size : 0] = '\0';
}

/* That of the last session, or else a name after the atlas. */
static void find_session_path(char path[SYSTEM_PATH], const struct window *window)
{
    char name[SYSTEM_PATH];
    const char *atlas = path_name(window->viewer->atlases->path);
    if (window->history.session_path) {
        snprintf(path, SYSTEM_PATH, "%s", window->history.session_path);
    } else {
        snprintf(name, sizeof name, "%.*s-session.json", (int)strcspn(atlas, "."), atlas);
        find_saving_path(path, window, name);
    }
}

void window_show_saving(struct window *window, enum saved_file what, const char *name, const char *ending)
{
    char path[SYSTEM_PATH];
    find_saving_path(path, window, name);
    start_look(&window->start);
    window->files.saves = what;
    window->dialog.ending = ending;
    dialog_show(&window->dialog, DIALOG_SAVE, path, &window->start);
}

void window_show_dialog(struct window *window, enum dialog_purpose purpose)
{
    char path[SYSTEM_PATH];
    start_look(&window->start);
    window->files.saves = SAVE_SESSION;
    window->dialog.ending = NULL;
    if (purpose == DIALOG_OPEN) {
        dialog_show(&window->dialog, purpose, NULL, &window->start);
    } else if (window->viewer) {
        find_session_path(path, window);
        dialog_show(&window->dialog, purpose, path, &window->start);
    }
}

/* Opens what was chosen in the dialog, which says so where that cannot be. */
static void open_chosen(struct window *window, const char *path)
{
    window->dialog.on = false;
    window_request_file(window, path);
    window->files.requested.by_dialog = true;
}

void window_use_folder(struct window *window)
{
    char path[SYSTEM_PATH];
    dialog_here(path, &window->dialog);
    open_chosen(window, path);
}

void window_use_dialog(struct window *window)
{
    char path[SYSTEM_PATH];
    struct dialog *dialog = &window->dialog;
    if (!dialog_enter(path, dialog)) {
        return;
    }
    if (dialog->purpose == DIALOG_OPEN) {
        open_chosen(window, path);
    } else {
        dialog->on = false;
        free(window->files.saves_as);
        window->files.saves_as = strdup(path);
    }
}

void window_copy(struct window *window, enum copied what)
{
    struct viewer *viewer = window->viewer;
    if (what == COPY_STUDY) {
        const char *text = studies_text(viewer);
        if (text) {
            glfwSetClipboardString(window->handle, text);
            viewer_say(viewer, "copied the study");
        }
        return;
    }
    char *text = what == COPY_PINS ? viewer_pins_text(viewer) : viewer_results_text(viewer);
    size_t rows = what == COPY_PINS ? viewer->pin_count : 0;
    for (size_t i = 0; i < viewer->atlas_count && what == COPY_RESULTS; i++) {
        rows += conus_selection_count(view_atlas_selection(&viewer->atlases[i], FIRST_TOOL));
    }
    if (text) {
        glfwSetClipboardString(window->handle, text);
        viewer_say(viewer, "copied %zu rows", rows);
    } else {
        viewer_say(viewer, "not copied: not enough memory");
    }
    free(text);
}

/* What the title names: what the needle of a plan does, the best hit, or else the chosen object; "" = nothing. */
static void find_named(char out[HEADLINE_TEXT], const char **how, const struct window *window)
{
    struct viewer *viewer = window->viewer;
    const conus_selection *selection = viewer_selection(viewer);
    const conus_result *best = conus_selection_count(selection) ? conus_selection_result(selection, 0) : NULL;
    bool is_hit = best && best->object && best->pixels;
    bool is_old = inputs_is_old(&window->inputs, viewer, FIRST_TOOL);
    struct headline headline;
    char title[VIEW_ATLAS_TITLE];
    headline_find(&headline, viewer);
    bool is_answer = is_hit || headline.is_of_plan;
    uint32_t chosen = viewer->drawn->shown.chosen;
    *how = !is_answer ? "chosen" : is_old ? "old answer" : viewer->tools[FIRST_TOOL].held ? "held" : "hit";
    snprintf(out, HEADLINE_TEXT, "%s",
             is_answer ? headline.what
             : chosen  ? view_atlas_title(title, viewer->drawn, chosen)
                       : "");
}

void title_write(char out[TITLE_SIZE], const struct window *window)
{
    const struct viewer *viewer = window->viewer;
    const char *how;
    char named[HEADLINE_TEXT];
    int used = snprintf(out, TITLE_SIZE, "conus");
    if (!viewer || window->start.on || window->dialog.on) {
        return;
    }
    used += snprintf(out + used, (size_t)(TITLE_SIZE - used), " - %.80s", path_name(viewer->atlases->path));
    if (window->history.session_path) {
        used += snprintf(out + used, (size_t)(TITLE_SIZE - used), " [%.80s]", path_name(window->history.session_path));
    }
    find_named(named, &how, window);
    if (named[0]) {
        snprintf(out + used, (size_t)(TITLE_SIZE - used), " - %.80s (%s)", named, how);
    }
    make_plain_line(out);
}

void title_update(struct window *window)
{
    char title[TITLE_SIZE];
    title_write(title, window);
    if (strcmp(title, window->frame.title) != 0) {
        memcpy(window->frame.title, title, sizeof title);
        glfwSetWindowTitle(window->handle, title);
    }
}

bool window_point(float out[2], const struct window *window, const double world[3])
{
    const struct ui_box *box = &window->screen.panes[PANE_3D];
    double at[2];
    bool visible = eye_project(at, &window->pictures.shown, (double[]){(double)box->width, (double)box->height}, world);
    out[0] = box->x + (float)at[0];
    out[1] = box->y + (float)at[1];
    return visible;
}
