/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps the newest eye and screen of a tracked head. */
#include "viewer/pictures/head.h"

#include <string.h>

static bool is_moved(const struct head *head, const double eye[3], const conus_pose *screen)
{
    bool moved = false;
    for (int a = 0; a < 3; a++) {
        moved = moved || head->eye[a] != eye[a];
    }
    for (int i = 0; i < 16; i++) {
        moved = moved || head->screen.world_from_device[i] != screen->world_from_device[i];
    }
    return moved;
}

void head_move(struct head *head, const double eye[3], const conus_pose *screen)
{
    conus_pose camera;
    double frustum[4];
    bool inside = conus_window_camera(&camera, frustum, screen, head->size, eye);
    bool moved = !head->known || is_moved(head, eye, screen);
    head->number += inside != head->inside || (!inside && moved);
    head->inside = inside;
    if (!inside) {
        memcpy(head->eye, eye, sizeof head->eye);
        head->screen = *screen;
        head->known = true;
    }
}

void head_set_state(struct head *head, enum station_state state)
{
    head->number += head->state != state;
    head->state = state;
}

bool head_toggle(struct head *head)
{
    bool is_there = head->named || head->known;
    head->on = !head->on && is_there;
    head->number++;
    return is_there;
}

bool head_sight(struct sight *out, const struct head *head, const double part[4])
{
    conus_pose pane = head->screen;
    const double *m = head->screen.world_from_device;
    double size[2];
    for (int axis = 0; axis < 2; axis++) {
        double low = part[2 * axis];
        double high = part[2 * axis + 1];
        size[axis] = (high - low) * head->size[axis];
        for (int a = 0; a < 3; a++) {
            pane.world_from_device[12 + a] += ((low + high) / 2 - 0.5) * head->size[axis] * m[4 * axis + a];
        }
    }
    return head->on && head->known && !conus_window_camera(&out->camera, out->frustum, &pane, size, head->eye);
}

const char *head_text(const struct head *head, bool *is_well)
{
    static const char *const troubles[] = {"no tracker", "no head yet", "head lost", "head silent"};
    static const char *const kept[] = {"no tracker: last view kept", "no head yet: last view kept",
                                       "head lost: last view kept", "head silent: last view kept"};
    *is_well = head->state == STATION_SEEN && !head->inside;
    if (!head->on) {
        return NULL;
    }
    if (head->state != STATION_SEEN) {
        return (head->known ? kept : troubles)[head->state];
    }
    return head->inside ? "eye not before the screen: last view kept" : "as the head sees it";
}
