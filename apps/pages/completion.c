/* SPDX-License-Identifier: BSD-3-Clause */
/* What the completions of all shells need to know of an option. */
#include "pages/completion.h"

#include <string.h>

enum completion_value completion_value(const struct option *option)
{
    if (option->type == OPTION_CHOICE) {
        return COMPLETION_CHOICES;
    }
    if (!option->value) {
        return COMPLETION_NONE;
    }
    return strstr(option->value, "FILE")    ? COMPLETION_FILE
           : strstr(option->value, "DIR")   ? COMPLETION_FOLDER
           : strstr(option->value, "ATLAS") ? COMPLETION_ATLAS
                                            : COMPLETION_ANY;
}

bool completion_takes_atlas(const struct command *command)
{
    return command->operands[0] && strcmp(command->operands[0], "ATLAS") == 0;
}

const struct option *completion_option(const struct command *command, size_t index)
{
    for (const struct option_group *group = command->groups; group && group->title; group++) {
        for (const struct option *option = group->options; option->name; option++) {
            if (index-- == 0) {
                return option;
            }
        }
    }
    return NULL;
}

void completion_quote(FILE *out, const char *text, const char *special)
{
    fputc('\'', out);
    for (; *text; text++) {
        if (strchr(special, *text)) {
            fputc('\\', out);
        }
        fputs(*text == '\'' ? "'\\''" : (char[]){*text, '\0'}, out);
    }
    fputc('\'', out);
}
