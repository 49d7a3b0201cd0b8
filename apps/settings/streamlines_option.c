/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the option --streamlines apart: FILE and keys behind commas. */
#include "settings/streamlines_option.h"

#include "common/messages.h"
#include "options/option_values.h"

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

/* Reads "key=value", the text after a comma. */
static bool read_key(struct streamlines_option *out, char *key)
{
    char *value = strchr(key, '=') + 1;
    if (strncmp(key, "radius=", 7) == 0 && out->radius == 0) {
        return read_radius(out, value);
    }
    if (strncmp(key, "name=", 5) == 0 && !out->name) {
        out->name = value;
        return *value || (print_error_line("--streamlines: name= is empty"), false);
    }
    print_error_line("--streamlines: \"%s\" is none of radius=R and name=S, each at most once", key);
    return false;
}

/* Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
bool streamlines_option_parse(struct streamlines_option *out, const char *text)
{
    *out = (struct streamlines_option){.path = strdup(text)};
    if (!out->path) {
        print_error_line("--streamlines: not enough memory");
        return false;
    }
    for (char *comma; (comma = strrchr(out->path, ',')) && strchr(comma, '=');) {
        *comma = '\0';
        if (!read_key(out, comma + 1)) {
            return false;
        }
    }
    if (!*out->path) {
        print_error_line("--streamlines: \"%s\" names no file", text);
    }
    return *out->path;
}

void streamlines_option_finish(struct streamlines_option *option)
{
    free(option->path);
}
