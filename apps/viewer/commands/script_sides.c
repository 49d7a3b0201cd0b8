/* SPDX-License-Identifier: BSD-3-Clause */
/* Hemispheres and sides by words. */
#include "viewer/commands/script_sides.h"

#include "settings/settings.h"
#include "viewer/model/hemispheres.h"

#include <string.h>

bool script_hemispheres(struct window *window, char *const *arguments, size_t count)
{
    for (size_t how = 0; count && settings_hemispheres[how]; how++) {
        if (strcmp(settings_hemispheres[how], arguments[0]) == 0) {
            window_want_hemispheres(window, (conus_hemispheres)how, 0);
            return true;
        }
    }
    return false;
}

bool script_side(struct window *window, char *const *arguments, size_t count)
{
    enum side side = SIDE_BOTH;
    while (count && side < SIDE_COUNT && strcmp(side_names[side], arguments[0]) != 0) {
        side++;
    }
    bool fine = count && side < SIDE_COUNT && side_is_known(window->viewer);
    if (fine) {
        side_show(window->viewer, side);
    }
    return fine;
}
