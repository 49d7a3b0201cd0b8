/* SPDX-License-Identifier: BSD-3-Clause */
/* States are sessions without what is not taken back. */
#include "viewer/session/undo.h"

#include "viewer/model/hemisphere_words.h"
#include "viewer/session/session.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

static bool moves_by_itself(const struct cone_state *cone)
{
    bool is_driven = cone->pointer >= POINT_BY_SPACEMOUSE || cone->pointer == POINT_BY_MOUSE;
    return cone->pointer == POINT_BY_REPLAY || cone->pointer == POINT_BY_TRACKER || (is_driven && !cone->frozen);
}

static bool second_moves_by_itself(const struct second *second)
{
    return second->pointer != POINT_BY_WAND && !second->held;
}

static void leave_out(json_t *root, const char *const *keys, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        json_object_del(root, keys[i]);
    }
}

/* NULL without memory, or where a name is not UTF-8. */
static char *text_of(const struct window *window)
{
    static const char *const views[] = {"orbit", "crosshair", "magnification",     "enlarged",
                                        "eye",   "by_head",   "world_from_screen", "screen_mm"};
    static const char *const poses[] = {"world_from_device", "has_pose"};
    const struct cone_state *cone = &window->viewer->cone;
    char *session = session_text(window);
    json_t *root = session ? json_loads(session, 0, NULL) : NULL;
    leave_out(root, views, sizeof views / sizeof views[0]);
    leave_out(root, poses, moves_by_itself(cone) ? sizeof poses / sizeof poses[0] : 0);
    if (second_moves_by_itself(&window->second)) {
        leave_out(json_object_get(root, "second"), poses, sizeof poses / sizeof poses[0]);
    }
    if (cone->pointer == POINT_BY_REPLAY) { /* rows have angles */
        json_object_del(root, "angle_deg");
    }
    char *text = root ? json_dumps(root, JSON_COMPACT) : NULL;
    json_decref(root);
    free(session);
    return text;
}

static void note_versions(struct window *window)
{
    window->history.noted_version = window->viewer->version;
    window->history.noted_said = window->viewer->said;
    window->history.noted_second = window->second.version;
    window->history.noted_layout = window->screen.layout;
}

void undo_renew(struct window *window)
{
    char *text = text_of(window);
    if (text) {
        note_versions(window);
        changes_renew(&window->history.changes, text);
    }
}

void undo_note(struct window *window)
{
    const struct viewer *viewer = window->viewer;
    bool is_new = window->history.noted_version != viewer->version || window->history.noted_said != viewer->said ||
                  window->history.noted_second != window->second.version || !window->history.changes.count ||
                  !layout_is_same(&window->history.noted_layout, &window->screen.layout);
    if (is_new) {
        char *text = text_of(window);
        note_versions(window);
        if (text) {
            changes_add(&window->history.changes, text);
        }
    }
}

/* What the state does not say stays as it is. */
static bool use(struct window *window, const char *state, char why[SESSION_REASON])
{
    char *session = session_text(window);
    json_t *root = session ? json_loads(session, 0, NULL) : NULL;
    json_t *before = json_loads(state, 0, NULL);
    json_object_update_recursive(root, before);
    char *text = root && before ? json_dumps(root, JSON_COMPACT) : NULL;
    bool fine = text ? session_parse(window, text, strlen(text), why) : session_refuse(why, "not enough memory");
    free(text);
    json_decref(before);
    json_decref(root);
    free(session);
    return fine;
}

/* Whether the state is of areas that the atlases have only once they are loaded again, and as what. */
static bool needs_others(conus_hemispheres *how, const struct window *window, const char *state)
{
    json_t *root = json_loads(state, 0, NULL);
    const json_t *opened = json_object_get(root, "opened");
    *how = hemispheres_of_words(json_object_get(opened, "options"));
    json_decref(root);
    return opened && *how != window->files.hemispheres;
}

static void use_aloud(struct window *window, const char *state, int by)
{
    char why[SESSION_REASON];
    bool fine = use(window, state, why);
    viewer_say(window->viewer, "%s", !fine ? why : by < 0 ? "undone" : "done again");
    if (fine) { /* other files may be added now than then, or options be in another order, which is no change */
        undo_renew(window);
    }
}

void undo_go_on(struct window *window, int by)
{
    const char *state = changes_step(&window->history.changes, by);
    if (state) {
        use_aloud(window, state, by);
    }
}

void undo_step(struct window *window, int by)
{
    conus_hemispheres how;
    window->history.noted_version = window->viewer->version - 1; /* what has just changed counts, too */
    undo_note(window);
    const char *state = changes_step(&window->history.changes, by);
    if (!state) {
        viewer_say(window->viewer, by < 0 ? "nothing to undo" : "nothing to do again");
    } else if (needs_others(&how, window, state)) {
        changes_step(&window->history.changes, -by);
        window_want_hemispheres(window, how, by);
    } else {
        use_aloud(window, state, by);
    }
}
