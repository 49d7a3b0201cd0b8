/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the session's file, the atlases that were opened lately and the catalogue. */
#include "viewer/opening/reopen.h"

#include "options/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Among what was opened lately and what is installed; by its name, too, if it was given so. */
static bool find(char out[PATH_MAX], const struct session_file *file, const char *session)
{
    struct start start = {.on = true};
    const conus_installed *named = NULL;
    start_look(&start);
    size_t installed = conus_catalogue_count(start.catalogue);
    const char **others = calloc(start.recent.count + installed + 1, sizeof *others);
    size_t count = 0;
    for (size_t i = 0; others && i < start.recent.count; i++) {
        others[count++] = start.recent.paths[i];
    }
    for (size_t i = 0; others && i < installed; i++) {
        others[count++] = conus_catalogue_atlas(start.catalogue, i)->path;
    }
    bool found = session_file_find(out, file, session, others, count);
    if (!found && start.catalogue && !strchr(file->atlas, '/') &&
        !conus_catalogue_find(&named, start.catalogue, file->atlas)) {
        found = snprintf(out, PATH_MAX, "%s", file->atlas) < PATH_MAX;
    }
    free(others);
    start_finish(&start);
    return found;
}

/* In plain words, and what to do. */
static void say_missing(char why[REOPEN_WHY], const struct session_file *file, const char *session)
{
    const char *slash = strrchr(session, '/');
    const char *joint = file->folder[0] && file->atlas[0] != '/' ? "/" : "";
    snprintf(why, REOPEN_WHY,
             "%.100s: its atlas is not found: %.150s%s%.150s. It was looked for there, beside the session, among what "
             "was opened before and what is installed. Open or drop it, and the session goes on.",
             slash ? slash + 1 : session, joint[0] ? file->folder : "", joint, file->atlas);
}

bool reopening_prepare(struct reopening *out, const char *session, const char *atlas, const struct view_settings *given,
                       bool count, bool *missing, char why[REOPEN_WHY])
{
    *out = (struct reopening){.path = ""};
    *missing = false;
    if (!session_file_read(&out->file, session)) {
        snprintf(why, REOPEN_WHY, "%s: no session of conus view, or it cannot be read", session);
        print_error_line("%s", why);
        return false;
    }
    out->words = additions_find(out->missing, out->file.options,
                                json_object_get(json_object_get(out->file.root, "opened"), "added"), session);
    if (!out->words) {
        snprintf(why, REOPEN_WHY, "%.200s: not enough memory", session);
        return false;
    }
    if (worded_parse(&out->worded, out->words, given, count)) {
        snprintf(why, REOPEN_WHY, "%.200s: opened: options: %.200s", session, error_line());
        return false;
    }
    out->worded.settings.session = session;
    bool found = atlas ? snprintf(out->path, PATH_MAX, "%s", atlas) < PATH_MAX : find(out->path, &out->file, session);
    *missing = !found;
    if (!found) {
        say_missing(why, &out->file, session);
        print_error_line("%s", why);
    }
    return found;
}

bool reopening_is_open(const struct reopening *reopening, const struct window *window)
{
    const json_t *opened = json_object_get(reopening->file.root, "opened");
    return window->viewer && window->files.opened && json_equal(opened, window->files.opened) &&
           strcmp(reopening->file.atlas, window->viewer->atlases->path) == 0;
}

void reopening_finish(struct reopening *reopening)
{
    if (reopening->worded.words) {
        worded_finish(&reopening->worded);
    }
    json_decref(reopening->words);
    session_file_finish(&reopening->file);
}
