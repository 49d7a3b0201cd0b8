/* SPDX-License-Identifier: BSD-3-Clause */
/** @file How the atlases have left and right areas, and how they shall. Between both they are loaded again
 * (viewer/reload.h). */
#ifndef CONUS_VIEWER_HEMISPHERES_WISH_H
#define CONUS_VIEWER_HEMISPHERES_WISH_H

#include "viewer/model/viewer.h"

enum { HEMISPHERES_COUNT = CONUS_HEMISPHERES_MERGED + 1 };
/** What each means, for people. */
extern const char *const hemispheres_meanings[HEMISPHERES_COUNT];

struct hemispheres {
    conus_hemispheres now, wanted;
    uint64_t max_memory; /**< With which the atlases were loaded, */
    bool no_cache;       /**< likewise. */
    char *state;         /**< That undo shall bring back with them (session/undo.h); NULL = none. */
    int step;            /**< By which undo got there. */
    int owed;            /**< The step that undo has to take because nothing came of that. */
};

/** Whether they are to be loaded again, or that goes on. */
bool hemispheres_wait(const struct hemispheres *hemispheres);
/** Wants them so; what was wanted before is not any more. @p viewer says so. */
void hemispheres_want(struct hemispheres *hemispheres, struct viewer *viewer, conus_hemispheres how);
/** Likewise with a state to go back to, which is taken over. */
void hemispheres_want_state(struct hemispheres *hemispheres, struct viewer *viewer, conus_hemispheres how, char *state,
                            int step);
/** Nothing is wanted but what is now; a state that is left comes to nothing. */
void hemispheres_rest(struct hemispheres *hemispheres);

#endif
