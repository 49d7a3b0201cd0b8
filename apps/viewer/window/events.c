/* SPDX-License-Identifier: BSD-3-Clause */
/* Notes what GLFW tells, and gives it to widgets, panes and keys frame by frame. */
#include "viewer/window/window.h"

#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void want_frames(GLFWwindow *handle)
{
    struct window *window = glfwGetWindowUserPointer(handle);
    if (window) {
        window->frame.frames_wanted = FRAMES_PER_EVENT;
    }
}

static void want_frames_by_numbers(GLFWwindow *handle, int x, int y)
{
    (void)x, (void)y;
    want_frames(handle);
}

static void want_frames_by_number(GLFWwindow *handle, int number)
{
    (void)number;
    want_frames(handle);
}

/* With Control: what is written on the key, so that Z is where the keyboard has it; of letters that are not Latin, what
 * the key has on a keyboard that is. A plus is one with Shift and without. */
static void name_with_control(char name[KEY_LIMIT], int key, int scancode, int mods)
{
    const char *written = glfwGetKeyName(key, scancode);
    char letter = (char)(key >= GLFW_KEY_A && key <= GLFW_KEY_Z ? 'a' + key - GLFW_KEY_A : '\0');
    letter = written && written[0] > ' ' && written[0] < 127 && !written[1] ? written[0] : letter;
    bool is_plus = letter == '=' || letter == '+';
    bool with_shift = (mods & GLFW_MOD_SHIFT) && !is_plus;
    snprintf(name, letter ? KEY_LIMIT : 1, "ctrl+%s%c", with_shift ? "shift+" : "", is_plus ? '+' : letter);
}

static const char *name_of_key(int key)
{
    static const struct {
        int key;
        const char *name;
    } names[] = {{GLFW_KEY_ENTER, "enter"}, {GLFW_KEY_KP_ENTER, "enter"}, {GLFW_KEY_SPACE, "space"},
                 {GLFW_KEY_TAB, "tab"},     {GLFW_KEY_F1, "f1"},          {GLFW_KEY_F11, "f11"},
                 {GLFW_KEY_F2, "f2"},       {GLFW_KEY_F3, "f3"},          {GLFW_KEY_F4, "f4"},
                 {GLFW_KEY_F5, "f5"},       {GLFW_KEY_F7, "f7"},          {GLFW_KEY_F8, "f8"},
                 {GLFW_KEY_F9, "f9"},       {GLFW_KEY_UP, "up"},          {GLFW_KEY_DOWN, "down"},
                 {GLFW_KEY_LEFT, "left"},   {GLFW_KEY_RIGHT, "right"},    {GLFW_KEY_ESCAPE, "escape"},
                 {GLFW_KEY_F6, "f6"},       {GLFW_KEY_PAGE_UP, "pageup"}, {GLFW_KEY_PAGE_DOWN, "pagedown"}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (names[i].key == key) {
            return names[i].name;
        }
    }
    return "";
}

static bool moves(int key)
{
    return key >= GLFW_KEY_RIGHT && key <= GLFW_KEY_PAGE_DOWN; /* arrows, Page Up and Down */
}

/* Keys that move between widgets and press them. */
static bool is_for_widgets(int key)
{
    bool presses = key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER || key == GLFW_KEY_SPACE || key == GLFW_KEY_TAB;
    return (ui_navigates() && (presses || moves(key))) || (key == GLFW_KEY_ESCAPE && ui_navigates_deep());
}

/* A form over the panes is closed at once, also while its line has the keyboard, unless a list is open in it. */
static bool is_for_form(const struct window *window, int key)
{
    const struct forms *forms = &window->forms;
    return key == GLFW_KEY_ESCAPE && !ui_lists() && !window->start.on && !window_asks(window) &&
           (window->dialog.on || forms->show_help || forms->figure.open || forms->added.open);
}

/* Returns whether it did something. */
static bool press_named(struct window *window, const struct ui_event *event)
{
    int key = event->code;
    int mods = event->mods;
    char name[KEY_LIMIT] = "";
    const char *with = !moves(key) ? "" : mods & GLFW_MOD_SHIFT ? "shift+" : mods & GLFW_MOD_CONTROL ? "ctrl+" : "";
    snprintf(name, sizeof name, "%s%s", with, name_of_key(key));
    if (!name[0] && (mods & GLFW_MOD_CONTROL) && !(mods & (GLFW_MOD_ALT | GLFW_MOD_SUPER))) {
        name_with_control(name, key, event->scancode, mods);
    }
    bool is_enter = key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER;
    if (is_enter && (event->action == GLFW_RELEASE || ui_lists())) { /* Space takes the marked choice of a list */
        struct ui_event space = *event;
        space.code = GLFW_KEY_SPACE;
        ui_take(window->handle, &space);
    }
    /* Held down these do nothing more: Escape leaves a page, and shall not clear the cone behind it, too. */
    bool acts_once = is_enter || key == GLFW_KEY_ESCAPE || key == GLFW_KEY_SPACE;
    bool counts = event->action == GLFW_PRESS || (event->action == GLFW_REPEAT && !acts_once);
    bool is_ours = is_for_form(window, key) || (!ui_wants_keys() && !is_for_widgets(key));
    return name[0] && counts && is_ours && window_press(window, name);
}

/* Likewise. */
static bool press_letter(struct window *window, const struct ui_event *event)
{
    const char key[2] = {(char)event->code, '\0'};
    return event->code > ' ' && event->code < 127 && !ui_wants_keys() && window_press(window, key);
}

static void note_scale(GLFWwindow *handle, float x, float y)
{
    struct window *window = glfwGetWindowUserPointer(handle);
    (void)y;
    if (window && x > 0) {
        window_rescale(window, x);
    }
    want_frames(handle);
}

static void take_drop(GLFWwindow *handle, int count, const char **paths)
{
    struct window *window = glfwGetWindowUserPointer(handle);
    want_frames(handle);
    if (window) {
        window_request_files(window, (size_t)count, paths);
    }
}

/* Notes an event; without memory it is lost. */
static void note(GLFWwindow *handle, struct ui_event event)
{
    struct window *window = glfwGetWindowUserPointer(handle);
    struct events *events = window ? &window->events : NULL;
    want_frames(handle);
    if (events && events->count == events->room) {
        size_t room = 2 * events->room + 16;
        struct ui_event *list = realloc(events->list, room * sizeof *list);
        events->list = list ? list : events->list;
        events->room = list ? room : events->room;
    }
    if (events && events->count < events->room) {
        event.time = glfwGetTime();
        events->list[events->count++] = event;
    }
}

static void note_move(GLFWwindow *handle, double x, double y)
{
    note(handle, (struct ui_event){.kind = UI_MOVE, .x = (float)x, .y = (float)y});
}

static void note_wheel(GLFWwindow *handle, double x, double y)
{
    note(handle, (struct ui_event){.kind = UI_WHEEL, .x = (float)x, .y = (float)y});
}

static void note_button(GLFWwindow *handle, int button, int action, int mods)
{
    note(handle, (struct ui_event){.kind = UI_BUTTON, .code = button, .action = action, .mods = mods});
}

static void note_key(GLFWwindow *handle, int key, int scancode, int action, int mods)
{
    note(handle, (struct ui_event){.kind = UI_KEY, .code = key, .scancode = scancode, .action = action, .mods = mods});
}

static void note_letter(GLFWwindow *handle, unsigned letter)
{
    note(handle, (struct ui_event){.kind = UI_LETTER, .code = (int)letter});
}

static void note_entry(GLFWwindow *handle, int enters)
{
    note(handle, (struct ui_event){.kind = UI_ENTRY, .action = enters});
}

static void note_focus(GLFWwindow *handle, int has_it)
{
    note(handle, (struct ui_event){.kind = UI_FOCUS, .action = has_it});
}

/* Keys that type, alone or together, do not move or press anything: several of them may be pressed and let go in one
 * frame. So may keys that are held down, which nothing but the window's own commands gets again. */
static bool is_typed(const struct ui_event *event)
{
    bool types = event->code > GLFW_KEY_SPACE && event->code <= GLFW_KEY_WORLD_2 && !(event->mods & GLFW_MOD_CONTROL);
    bool is_modifier = event->code >= GLFW_KEY_LEFT_SHIFT && event->code <= GLFW_KEY_RIGHT_SUPER;
    return event->kind == UI_LETTER ||
           (event->kind == UI_KEY && (types || is_modifier || event->action == GLFW_REPEAT));
}

static bool is_move(const struct ui_event *event)
{
    return event->kind == UI_MOVE || event->kind == UI_ENTRY || event->kind == UI_FOCUS;
}

/* Whether a frame that took `before` last can take the next event, too. */
static bool goes_with(const struct ui_event *before, const struct ui_event *next)
{
    return (is_move(before) && is_move(next)) || (is_typed(before) && is_typed(next)) ||
           (before->kind == UI_WHEEL && next->kind == UI_WHEEL);
}

/* A line will have the keyboard, which asks for it in the next frame. */
static bool will_type(const struct window *window)
{
    return window->frame.searches || window->forms.searches_help || window->forms.figure.takes_keys ||
           window->forms.added.takes_keys || window->dialog.takes_keys || window->start.takes_keys;
}

bool events_take(struct window *window)
{
    struct events *events = &window->events;
    size_t taken = 0;
    events->time = glfwGetTime();
    if (events->rest) {
        events->rest--;
    }
    while (taken < events->count && (!taken || goes_with(&events->list[taken - 1], &events->list[taken])) &&
           !events->rest && !window_has_request(window)) {
        const struct ui_event event = events->list[taken++];
        window->frame.frames_wanted = FRAMES_PER_EVENT;
        events->time = event.time;
        if (event.kind == UI_BUTTON && event.action == GLFW_PRESS) {
            window_forget_message(window);
        }
        bool acts = event.kind == UI_KEY ? press_named(window, &event)
                                         : event.kind == UI_LETTER && press_letter(window, &event);
        events->rest = acts && will_type(window) ? FRAMES_PER_EVENT : 0;
        ui_take(window->handle, &event);
    }
    events->count -= taken;
    memmove(events->list, events->list + taken, events->count * sizeof *events->list);
    return events->count;
}

void events_hear(struct window *window)
{
    GLFWwindow *handle = window->handle;
    double at[2];
    glfwSetKeyCallback(handle, note_key);
    glfwSetCharCallback(handle, note_letter);
    glfwSetCursorPosCallback(handle, note_move);
    glfwSetScrollCallback(handle, note_wheel);
    glfwSetMouseButtonCallback(handle, note_button);
    glfwSetCursorEnterCallback(handle, note_entry);
    glfwSetWindowFocusCallback(handle, note_focus);
    glfwSetWindowIconifyCallback(handle, want_frames_by_number);
    glfwSetFramebufferSizeCallback(handle, want_frames_by_numbers);
    glfwSetWindowPosCallback(handle, want_frames_by_numbers); /* a tracked head sees another part */
    glfwSetWindowRefreshCallback(handle, want_frames);
    glfwSetWindowContentScaleCallback(handle, note_scale);
    glfwSetDropCallback(handle, take_drop);
    glfwGetCursorPos(handle, &at[0], &at[1]);
    if (glfwGetWindowAttrib(handle, GLFW_HOVERED)) { /* it came in before */
        note_move(handle, at[0], at[1]);
    }
}
