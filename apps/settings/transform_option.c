/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the option --atlas-transform apart, and moves an atlas as it says. */
#include "settings/transform_option.h"

#include "options/messages.h"

#include <stdlib.h>
#include <string.h>

/* What "FILE[,from=IMAGE,to=IMAGE][,inverse][,relative|absolute][,grid=IMAGE]" says; the text is cut at its commas. */
struct transform_option {
    char *path;
    conus_transform_options options;
};

/* Takes a key, the text after a comma. False where it is none; then it is a part of the file's name. */
static bool take_key(struct transform_option *out, const char *key)
{
    if (strcmp(key, "inverse") == 0 && !out->options.inverse) {
        return out->options.inverse = true;
    }
    if ((strcmp(key, "relative") == 0 || strcmp(key, "absolute") == 0) && !out->options.vectors) {
        out->options.vectors = key[0] == 'r' ? CONUS_VECTORS_RELATIVE : CONUS_VECTORS_ABSOLUTE;
        return true;
    }
    if (strncmp(key, "grid=", 5) == 0 && !out->options.grid) {
        out->options.grid = key + 5;
        return true;
    }
    if (strncmp(key, "from=", 5) == 0 && !out->options.from) {
        out->options.from = key + 5;
        return true;
    }
    if (strncmp(key, "to=", 3) == 0 && !out->options.to) {
        out->options.to = key + 3;
        return true;
    }
    return false;
}

/* Cuts keys off the end as long as there are some, since a file's name may have commas as well. */
static void parse(struct transform_option *out, char *text)
{
    *out = (struct transform_option){.path = text};
    for (char *comma; (comma = strrchr(text, ',')) && take_key(out, comma + 1);) {
        *comma = '\0';
    }
}

static bool is_empty(const char *text)
{
    return text && !*text;
}

static int apply(conus_atlas *atlas, const char *given, uint64_t max_memory)
{
    struct transform_option option;
    char *text = strdup(given);
    if (!text) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    parse(&option, text);
    option.options.max_memory = max_memory;
    bool empty = is_empty(option.path) || is_empty(option.options.from) || is_empty(option.options.to) ||
                 is_empty(option.options.grid);
    int code = empty ? print_usage_error("--atlas-transform: \"%s\" names no file, or no image", given) : EXIT_DONE;
    if (!code) {
        conus_status status = conus_atlas_transform(atlas, option.path, &option.options);
        code = status ? print_status(status) : EXIT_DONE;
    }
    free(text);
    return code;
}

int transform_options_apply(conus_atlas *atlas, const struct option_list *texts, uint64_t max_memory)
{
    int code = EXIT_DONE;
    for (size_t i = texts->count; i > 0 && !code; i--) { /* the atlas goes back through the last one first */
        code = apply(atlas, texts->items[i - 1], max_memory);
    }
    return code;
}
