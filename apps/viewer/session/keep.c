/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a free name by the time, and writes a session or picture there. */
#include "viewer/session/keep.h"

#include "viewer/session/session.h"

#include <limits.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum { NAME_SIZE = 64, SAME_SECOND = 100 };

static void make_name(char name[NAME_SIZE], const char *ending)
{
    char date[32];
    struct tm now;
    time_t clock = time(NULL);
    strftime(date, sizeof date, "%Y%m%d-%H%M%S", localtime_r(&clock, &now));
    snprintf(name, NAME_SIZE, "conus-%s%s", date, ending);
    for (int i = 2; i < SAME_SECOND && access(name, F_OK) == 0; i++) {
        snprintf(name, NAME_SIZE, "conus-%s-%d%s", date, i, ending);
    }
}

void keep(struct window *window, enum keep what)
{
    char name[NAME_SIZE];
    char why[SESSION_REASON] = "";
    make_name(name, what == KEEP_PICTURE ? ".png" : ".json");
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s", what == KEEP_SAME_SESSION && window->session_path ? window->session_path : name);
    bool kept = what == KEEP_PICTURE ? !window_write(window, path) : session_save(window, path, why);
    if (kept) {
        viewer_say(window->viewer, "saved: %s", path);
    } else {
        viewer_say(window->viewer, "%s", why[0] ? why : conus_message());
    }
}
