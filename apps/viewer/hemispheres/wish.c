/* SPDX-License-Identifier: BSD-3-Clause */
/* Notes what is wanted; reload.c does it. */
#include "viewer/hemispheres/wish.h"

#include <stdlib.h>

const char *const hemispheres_meanings[HEMISPHERES_COUNT] = {"areas as in the file", "split left and right",
                                                             "left and right as one"};

bool hemispheres_wait(const struct hemispheres *hemispheres)
{
    return hemispheres->wanted != hemispheres->now;
}

void hemispheres_rest(struct hemispheres *hemispheres)
{
    hemispheres->owed -= hemispheres->state ? hemispheres->step : 0;
    free(hemispheres->state);
    hemispheres->state = NULL;
    hemispheres->wanted = hemispheres->now;
}

void hemispheres_want_state(struct hemispheres *hemispheres, struct viewer *viewer, conus_hemispheres how, char *state,
                            int step)
{
    hemispheres_rest(hemispheres);
    hemispheres->wanted = how;
    hemispheres->state = state;
    hemispheres->step = step;
    viewer->version++;
    viewer_say(viewer, hemispheres_wait(hemispheres) ? "the atlas is loaded again: %s" : "%s",
               hemispheres_meanings[how]);
}

void hemispheres_want(struct hemispheres *hemispheres, struct viewer *viewer, conus_hemispheres how)
{
    hemispheres_want_state(hemispheres, viewer, how, NULL, 0);
}
