/* SPDX-License-Identifier: BSD-3-Clause */
/* Splits a line of a script into words; numbers. */
#include "viewer/commands/commands.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool script_number(double *out, const char *word)
{
    char *end;
    *out = strtod(word, &end);
    return *word && !*end && isfinite(*out);
}

bool script_split(char *words[SCRIPT_WORDS], size_t *count, char *line)
{
    *count = 0;
    for (char *at = line; *at;) {
        at += strspn(at, " \t\r\n");
        if (!*at || *at == '#') {
            break;
        }
        bool quoted = *at == '"';
        at += quoted;
        if (*count == SCRIPT_WORDS) {
            return false;
        }
        words[(*count)++] = at;
        at += strcspn(at, quoted ? "\"" : " \t\r\n");
        if (*at) {
            *at++ = '\0';
        }
    }
    return true;
}
