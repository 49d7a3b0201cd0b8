/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares sidecars value by value. */
#include "cli/verify/settings_differ.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 256, DEPTH = 16, DIGITS = 9 };

static bool is_passed_over(const char *key)
{
    static const char *const keys[] = {"path", "bytes", "notes", "engine"};
    bool is = false;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        is = is || strcmp(key, keys[i]) == 0;
    }
    return is;
}

static char *text_of(const json_t *value)
{
    return value ? json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(DIGITS)) : strdup("missing");
}

/* The values that are no objects or lists, or of which one is. */
static char *compare_values(const char *name, const json_t *a, const json_t *b)
{
    char *one = text_of(a);
    char *other = text_of(b);
    char *said = NULL;
    if (one && other && strcmp(one, other) != 0 &&
        asprintf(&said, "%s is %.60s there, and %.60s when it is answered again", name, one, other) < 0) {
        said = NULL;
    }
    free(one);
    free(other);
    return said;
}

static char *compare(const char *name, json_t *a, json_t *b, int depth)
{
    char own[NAME_SIZE];
    char *said = NULL;
    const char *key;
    json_t *value;
    if (depth == DEPTH || json_typeof(a) != json_typeof(b)) {
        return compare_values(name, a, b);
    }
    json_object_foreach(a, key, value)
    {
        json_t *other = json_object_get(b, key);
        snprintf(own, sizeof own, "%s.%s", name, key);
        said = said || is_passed_over(key) ? said
               : other                     ? compare(own, value, other, depth + 1)
                                           : compare_values(own, value, NULL);
    }
    json_object_foreach(b, key, value)
    {
        snprintf(own, sizeof own, "%s.%s", name, key);
        said = said || is_passed_over(key) || json_object_get(a, key) ? said : compare_values(own, NULL, value);
    }
    size_t count = json_is_array(a) ? json_array_size(a) : 0;
    for (size_t i = 0; i < count || (json_is_array(b) && i < json_array_size(b)); i++) {
        json_t *one = json_array_get(a, i);
        json_t *other = json_array_get(b, i);
        snprintf(own, sizeof own, "%s[%zu]", name, i);
        said = said ? said : one && other ? compare(own, one, other, depth + 1) : compare_values(own, one, other);
    }
    return said || json_is_object(a) || json_is_array(a) ? said : compare_values(name, a, b);
}

char *settings_difference(const json_t *recorded, const json_t *again)
{
    static const char *const parts[] = {"Space", "Settings", "Queries", "Atlas", "Atlases"};
    char *said = NULL;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && !said; i++) {
        json_t *one = json_object_get(recorded, parts[i]);
        json_t *other = json_object_get(again, parts[i]);
        said = !one && !other ? NULL
               : one && other ? compare(parts[i], one, other, 0)
                              : compare_values(parts[i], one, other);
    }
    return said;
}
