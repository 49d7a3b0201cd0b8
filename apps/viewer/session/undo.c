/* SPDX-License-Identifier: BSD-3-Clause */
/* States are sessions without what is not taken back. */
#include "viewer/session/session.h"

#include "viewer/model/viewer.h"

#include <jansson.h>

/* Whether a file moves the first tool: not where a row of Points is chosen, which is taken back as a whole. */
static bool is_replayed(const struct viewer *viewer)
{
    return viewer->tools[FIRST_TOOL].pointer == POINT_BY_REPLAY && !viewer->chosen_point;
}

static bool moves_by_itself(const struct viewer *viewer)
{
    const struct tool *tool = &viewer->tools[FIRST_TOOL];
    bool is_driven = tool->pointer >= POINT_BY_SPACEMOUSE || tool->pointer == POINT_BY_MOUSE;
    return is_replayed(viewer) || tool->pointer == POINT_BY_TRACKER || (is_driven && !tool->held);
}

static bool is_left_out(const struct property *property, const struct window *window)
{
    const struct tool *second = &window->viewer->tools[SECOND_TOOL];
    switch (property->undo) {
    case UNDO_LEAVES:
        return true;
    case UNDO_LEAVES_MOVING:
        return property->object ? second->pointer != POINT_BY_WAND && !second->held : moves_by_itself(window->viewer);
    case UNDO_LEAVES_REPLAY:
        return is_replayed(window->viewer);
    default:
        return false;
    }
}

/* Which areas are chosen stays. Numbers mean what they meant, since the files are the same. */
static void leave_chosen(json_t *root)
{
    const json_t *further = json_object_get(root, "further_atlases");
    for (size_t i = 0; i <= json_array_size(further); i++) {
        json_t *of = i ? json_array_get(further, i - 1) : root;
        json_object_del(of, "chosen");
        json_object_del(of, "named");
    }
}

/* NULL without memory, or where a name is not UTF-8. */
static char *state_text(const struct window *window)
{
    json_t *root = session_json(window);
    for (size_t i = 0; i < PROPERTY_COUNT; i++) {
        const struct property *property = &properties[i];
        if (is_left_out(property, window)) {
            json_object_del(property->object ? json_object_get(root, property->object) : root, property->name);
        }
    }
    leave_chosen(root);
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(root);
    return text;
}

static void note_versions(struct window *window)
{
    window->history.noted_version = window->viewer->version;
    window->history.noted_said = window->viewer->said;
    window->history.noted_second = window->viewer->tools[SECOND_TOOL].version;
    window->history.noted_layout = window->screen.layout;
}

void undo_renew(struct window *window)
{
    char *text = state_text(window);
    if (text) {
        note_versions(window);
        changes_renew(&window->history.changes, text);
    }
}

void undo_note(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    bool is_new = window->history.noted_version != viewer->version || window->history.noted_said != viewer->said ||
                  window->history.noted_second != viewer->tools[SECOND_TOOL].version ||
                  !window->history.changes.count ||
                  !layout_is_same(&window->history.noted_layout, &window->screen.layout);
    if (is_new) {
        char *text = state_text(window);
        note_versions(window);
        if (text) {
            changes_add(&window->history.changes, text);
        }
    }
}

/* Restores a state; values that it leaves out stay as they are. */
static void restore(struct window *window, const char *state, int by)
{
    char why[PROPERTY_REASON];
    json_t *root = session_json(window);
    json_t *before = json_loads(state, 0, NULL);
    leave_chosen(root); /* whose numbers are those of now */
    bool fine = root && before && !json_object_update_recursive(root, before)
                    ? session_read(window, root, "session", why)
                    : session_refuse(why, "not enough memory");
    json_decref(before);
    json_decref(root);
    viewer_say(window->viewer, "%s", !fine ? why : by < 0 ? "undone" : "done again");
    if (fine) { /* other files may be added now than then, or options be in another order, which is no change */
        undo_renew(window);
    }
}

void undo_go_on(struct window *window, int by)
{
    const char *state = changes_step(&window->history.changes, by);
    if (state) {
        restore(window, state, by);
    }
}

void undo_step(struct window *window, int by)
{
    window->history.noted_version = window->viewer->version - 1; /* what has just changed counts, too */
    undo_note(window);
    const char *state = changes_step(&window->history.changes, by);
    json_t *root = state ? json_loads(state, 0, NULL) : NULL;
    const json_t *options = json_object_get(json_object_get(root, "opened"), "options");
    const json_t *now = json_object_get(window->files.opened, "options");
    bool needs_others = options && (hemispheres_of_words(options) != window->files.hemispheres ||
                                    !plans_asked_is_same(options, now)); /* atlases, or a plan, are made anew */
    if (!state) {
        viewer_say(window->viewer, by < 0 ? "nothing to undo" : "nothing to do again");
    } else if (needs_others) {
        changes_step(&window->history.changes, -by);
        window_request_options(window, options, by);
    } else {
        restore(window, state, by);
    }
    json_decref(root);
}
