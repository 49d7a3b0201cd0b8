/* SPDX-License-Identifier: BSD-3-Clause */
/* Undoes the quoting of arguments_text(). */
#include "cli/verify/command_line.h"

#include <stdlib.h>
#include <string.h>

/* What stands bare in a word; all else is in quotes. */
static bool is_bare(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (c && strchr("-_=+.,/:@%", c));
}

/* Copies one word from *from to *to. False where its quoting is not ours. */
static bool take_word(char **to, const char **from)
{
    const char *at = *from;
    bool bare = *at != '\'';
    for (; bare && is_bare(*at); at++) {
        *(*to)++ = *at;
    }
    while (!bare && *at == '\'') {
        size_t length = strcspn(at + 1, "'");
        *to = mempcpy(*to, at + 1, length);
        at += 1 + length;
        if (*at != '\'') {
            return false;
        }
        at++;
        if (strncmp(at, "\\''", 3) == 0) { /* 'it'\''s' */
            *(*to)++ = '\'';
            at += 2;
        } else {
            break;
        }
    }
    bool is_word = at > *from && (!*at || *at == ' ');
    *(*to)++ = '\0';
    *from = at;
    return is_word;
}

static const char *cut(struct command_line *out, const char *text)
{
    char *to = out->text;
    for (const char *from = text; *from;) {
        if (out->count == COMMAND_WORDS) {
            return "has more than 4096 words";
        }
        out->words[out->count++] = to;
        if (!take_word(&to, &from)) {
            return "is not quoted as conus does it";
        }
        if (*from && !*++from) {
            return "ends with a space";
        }
    }
    return out->count ? NULL : "is empty";
}

const char *command_line_parse(struct command_line *out, const char *text)
{
    size_t size = strlen(text) + 1;
    *out = (struct command_line){.text = malloc(2 * size), .words = calloc(COMMAND_WORDS + 1, sizeof(char *))};
    const char *why = out->text && out->words ? cut(out, text) : "does not fit into memory";
    if (why) {
        command_line_finish(out);
    }
    return why;
}

void command_line_finish(struct command_line *line)
{
    free(line->text);
    free((void *)line->words);
    *line = (struct command_line){0};
}
