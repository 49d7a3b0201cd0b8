/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the option --streamlines apart: FILE and keys behind commas. */
#include "settings/streamlines_option.h"

#include "options/messages.h"
#include "options/options.h"

#include <stdlib.h>
#include <string.h>

static bool read_radius(struct streamlines_option *out, const char *value)
{
    if (!number_parse(value, &out->radius) || out->radius <= 0) {
        print_error_line("--streamlines: radius=%s is not a number above 0", value);
        return false;
    }
    return true;
}

static bool is_key(const char *text)
{
    return strchr(text, '=') || strcmp(text, "moves") == 0;
}

/* Reads "key=value" or "moves", the text after a comma. */
static bool read_key(struct streamlines_option *out, char *key)
{
    if (strncmp(key, "radius=", 7) == 0 && out->radius == 0) {
        return read_radius(out, key + 7);
    }
    if (strncmp(key, "name=", 5) == 0 && !out->name) {
        out->name = key + 5;
        return *out->name || (print_error_line("--streamlines: name= is empty"), false);
    }
    if (strcmp(key, "moves") == 0 && !out->moves) {
        return out->moves = true;
    }
    print_error_line("--streamlines: \"%s\" is none of radius=R, name=S and moves, each at most once", key);
    return false;
}

/* Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
bool streamlines_option_parse(struct streamlines_option *out, const char *text)
{
    static const char *const keys[] = {",radius=", ",name=", NULL};
    *out = (struct streamlines_option){.path = strdup(text)};
    if (!out->path) {
        print_error_line("--streamlines: not enough memory");
        return false;
    }
    for (char *comma; (comma = strrchr(out->path, ',')) && is_key(comma + 1);) {
        *comma = '\0';
        if (!read_key(out, comma + 1)) {
            return false;
        }
    }
    if (!*out->path) {
        print_error_line("--streamlines: \"%s\" names no file", text);
    }
    return *out->path && !key_left_in_file("--streamlines", out->path, keys);
}

void streamlines_option_finish(struct streamlines_option *option)
{
    free(option->path);
}
