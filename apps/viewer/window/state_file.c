/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds, reads and writes the files of the window's state. */
#include "viewer/window/start.h"

#include "base/path.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* False where there is no home, or it is too long. */
static bool find_path(char path[SYSTEM_PATH], const char *name)
{
    const char *state = getenv("XDG_STATE_HOME");
    const char *home = getenv("HOME");
    int size = 0;
    if (path_is_whole(state)) { /* the specification: relative ones are ignored */
        size = snprintf(path, SYSTEM_PATH, "%s/conus/%s", state, name);
    } else if (path_is_whole(home)) {
        size = snprintf(path, SYSTEM_PATH, "%s/.local/state/conus/%s", home, name);
    }
    return size > 0 && size < SYSTEM_PATH;
}

/* Whether it is there now, who opens a file in it will see. */
static bool make_folder(void *user, const char *path)
{
    (void)user;
    system_make_folder(path, true);
    return true;
}

bool state_file_path(char path[SYSTEM_PATH], const char *name)
{
    bool fine = find_path(path, name);
    if (fine) {
        path_each_folder(path, 1, make_folder, NULL);
    }
    return fine;
}

char *state_file_read(size_t *size, const char *name, size_t limit)
{
    char path[SYSTEM_PATH];
    char *text = NULL;
    messages_hold(true);
    bool fine = find_path(path, name) && !input_file_read(&text, size, path, INPUT_FILE, limit);
    messages_hold(false);
    return fine ? text : NULL;
}

void state_file_write(const char *name, const char *text, size_t size)
{
    char path[SYSTEM_PATH];
    if (state_file_path(path, name)) {
        conus_status status = conus_write_file(path, text, size);
        (void)status;
    }
}

bool typed_path(char path[SYSTEM_PATH], const char *text)
{
    const char *home = getenv("HOME");
    bool at_home = home && text[0] == '~' && (!text[1] || path_is_whole(text + 1));
    int size = snprintf(path, SYSTEM_PATH, "%s%s", at_home ? home : "", text + at_home);
    return size > 0 && size < SYSTEM_PATH;
}
