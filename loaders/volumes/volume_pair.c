/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of the two files of a pair. */
#include "loaders/volumes/volume_pair.h"

#include "base/files/file.h"
#include "base/memory.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

bool volume_pair_has(const char *path, const char *ext, size_t *at)
{
    size_t length = strlen(path);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) {
        length -= 3;
    }
    size_t ending = strlen(ext);
    *at = length - ending;
    return length > ending && path[*at - 1] == '.' && strncasecmp(path + *at, ext, ending) == 0;
}

char *volume_pair_other(const char *path, size_t at, const char *ext)
{
    bool packed = path[at + 3] != '\0';
    char *other = memory_raw(at + 7, 1);
    if (!other) {
        return NULL;
    }
    for (int attempt = 0; attempt < 2; attempt++) {
        snprintf(other, at + 7, "%.*s%s%s", (int)at, path, ext, packed == (attempt == 0) ? ".gz" : "");
        for (size_t i = at; i < at + 3; i++) {
            other[i] = path[at] < 'a' ? (char)(other[i] - 'a' + 'A') : other[i];
        }
        if (file_exists(other)) {
            break;
        }
    }
    return other;
}
