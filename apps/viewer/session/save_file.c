/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a free name by the time, and writes a session or picture there. */
#include "viewer/session/session.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/provenance.h"
#include "viewer/model/columns.h"
#include "viewer/model/viewer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { NAME_SIZE = 64, SAME_SECOND = 100 };

/* Whether neither the file nor its sidecar exists. */
static bool is_free(const char *name)
{
    char *sidecar = provenance_path(name);
    bool is = sidecar && !system_allows(name, 0) && !system_allows(sidecar, 0);
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
    enum saved_file what = window->files.saves;
    char *path = window->files.saves_as;
    const char *study = what == SAVE_STUDY ? studies_text(window->viewer) : NULL;
    window->files.saves_as = NULL;
    bool fine = what == SAVE_PICTURE   ? !window_write(window, path)
                : what == SAVE_RESULTS ? export_results(window->viewer, path, why)
                : what == SAVE_STUDY   ? study && !conus_write_file(path, study, strlen(study))
                                       : session_save(window, path, why);
    const char *said = fine ? path : why[0] ? why : conus_message();
    if (!fine && what != SAVE_SAME_SESSION) { /* the page where it was typed */
        dialog_complain(&window->dialog, said);
    } else {
        viewer_say(window->viewer, "%s%s", fine ? "saved: " : "", said);
    }
    if (!fine) {
        free(path);
        return;
    }
    if (what <= SAVE_SAME_SESSION && window->files.remembers) {
        recent_add(path);
    }
    free(window->files.saved_last);
    window->files.saved_last = path;
}

void save_file(struct window *window, enum saved_file what)
{
    const struct viewer *viewer = window->viewer;
    const char *ending = what == SAVE_PICTURE   ? ".png"
                         : what == SAVE_STUDY   ? ".tsv"
                         : what == SAVE_RESULTS ? result_endings[viewer->list.format]
                                                : ".json";
    char name[NAME_SIZE];
    char end[16];
    if (what == SAVE_SAME_SESSION && window->history.session_path) {
        free(window->files.saves_as);
        window->files.saves = what;
        window->files.saves_as = strdup(window->history.session_path);
        save_file_as(window);
    } else if (what == SAVE_SAME_SESSION) {
        window_show_dialog(window, DIALOG_SAVE);
    } else if (what != SAVE_STUDY || studies_text(window->viewer)) {
        snprintf(end, sizeof end, "%s%s", what == SAVE_RESULTS ? "-hits" : "", ending);
        make_name(name, end);
        window_show_saving(window, what, name, ending);
    }
}
