/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a free name by the time, and writes a session or picture there. */
#include "viewer/session/save_file.h"

#include "conus/file.h"
#include "options/provenance.h"
#include "viewer/model/columns.h"
#include "viewer/model/studies.h"
#include "viewer/session/session.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { NAME_SIZE = 64, SAME_SECOND = 100 };

/* Whether neither the file nor its sidecar exists. */
static bool is_free(const char *name)
{
    char *sidecar = provenance_path(name);
    bool is = sidecar && access(name, F_OK) != 0 && access(sidecar, F_OK) != 0;
    free(sidecar);
    return is;
}

static void make_name(char name[NAME_SIZE], const char *ending)
{
    char date[32];
    struct tm now;
    time_t clock = time(NULL);
    strftime(date, sizeof date, "%Y%m%d-%H%M%S", localtime_r(&clock, &now));
    snprintf(name, NAME_SIZE, "conus-%s%s", date, ending);
    for (int i = 2; i < SAME_SECOND && !is_free(name); i++) {
        snprintf(name, NAME_SIZE, "conus-%s-%d%s", date, i, ending);
    }
}

void save_file_as(struct window *window)
{
    char why[PROPERTY_REASON] = "";
    char *path = window->files.saves_as;
    window->files.saves_as = NULL;
    if (session_save(window, path, why)) {
        viewer_say(window->viewer, "saved: %s", path);
        if (window->files.remembers) {
            recent_add(path);
        }
    } else {
        viewer_say(window->viewer, "%s", why);
    }
    free(path);
}

void save_file(struct window *window, enum saved_file what)
{
    char name[NAME_SIZE];
    char ending[16];
    if (what == SAVE_STUDY) {
        const char *text = studies_text(window->viewer);
        make_name(name, ".tsv");
        if (text && !conus_write_file(name, text, strlen(text))) {
            viewer_say(window->viewer, "saved: %s", name);
        } else if (text) {
            viewer_say(window->viewer, "%s", conus_message());
        }
        return;
    }
    char why[PROPERTY_REASON] = "";
    snprintf(ending, sizeof ending, "%s%s", what == SAVE_RESULTS ? "-hits" : "",
             what == SAVE_PICTURE   ? ".png"
             : what == SAVE_RESULTS ? result_ending(window->viewer->list.format)
                                    : ".json");
    make_name(name, ending);
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s",
             what == SAVE_SAME_SESSION && window->history.session_path ? window->history.session_path : name);
    bool fine = what == SAVE_PICTURE   ? !window_write(window, path)
                : what == SAVE_RESULTS ? export_results(window->viewer, path, why)
                                       : session_save(window, path, why);
    if (fine) {
        viewer_say(window->viewer, "saved: %s", path);
    } else {
        viewer_say(window->viewer, "%s", why[0] ? why : conus_message());
    }
}
