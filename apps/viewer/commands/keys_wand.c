/* SPDX-License-Identifier: BSD-3-Clause */
/* The wand, moved by keys. */
#include "viewer/commands/keys_wand.h"

#include "viewer/tools/inputs.h"

#include <strings.h>

struct wand_key {
    const char *key;
    int axis; /* from 3 on: a turn about axis - 3 */
    double by;
};

static const struct wand_key wand_keys[] = {
    /* by 1 mm, or 2 degrees */
    {"w", 2, -1}, {"s", 2, 1},      {"a", 0, -1},        {"d", 0, 1},        {"e", 1, 1},
    {"q", 1, -1}, {"up", 3, 0.035}, {"down", 3, -0.035}, {"left", 4, 0.035}, {"right", 4, -0.035},
};
enum { WAND_KEYS = sizeof wand_keys / sizeof wand_keys[0] };

bool keys_wand_press(struct window *window, const char *key)
{
    enum tool_number tool = tool_moved_by(window->viewer, POINT_BY_WAND);
    for (size_t i = 0; tool < TOOL_COUNT && i < WAND_KEYS; i++) {
        const struct wand_key *wand = &wand_keys[i];
        if (strcasecmp(wand->key, key) == 0) {
            double by[6] = {0}; /* moves along its axes, turns about them */
            by[wand->axis] = wand->by;
            tool_steer(window->viewer, tool, by, by + 3);
            return true;
        }
    }
    return false;
}

const char *keys_wand_name(size_t index)
{
    return index < WAND_KEYS ? wand_keys[index].key : NULL;
}
