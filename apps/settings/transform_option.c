/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes the option --atlas-transform apart, and moves an atlas as it says. */
#include "settings/transform_option.h"

#include "common/messages.h"

#include <stdlib.h>
#include <string.h>

/* What "FILE[,from=IMAGE,to=IMAGE][,inverse]" says; the text is cut at its commas. */
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

static int apply(conus_atlas *atlas, const char *given)
{
    struct transform_option option;
    char *text = strdup(given);
    if (!text) {
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    parse(&option, text);
    bool empty =
        !option.path[0] || (option.options.from && !*option.options.from) || (option.options.to && !*option.options.to);
    int code = empty ? print_usage_error("--atlas-transform: \"%s\" names no file, or no image", given) : EXIT_DONE;
    if (!code) {
        conus_status status = conus_atlas_transform(atlas, option.path, &option.options);
        code = status ? print_status(status) : EXIT_DONE;
    }
    free(text);
    return code;
}

int transform_options_apply(conus_atlas *atlas, const struct option_list *texts)
{
    int code = EXIT_DONE;
    for (size_t i = texts->count; i > 0 && !code; i--) { /* the atlas goes back through the last one first */
        code = apply(atlas, texts->items[i - 1]);
    }
    return code;
}
