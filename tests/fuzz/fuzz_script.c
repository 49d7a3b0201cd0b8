/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines of the window's scripts: words are parts of their line, one after the other. */
#include "viewer/commands/commands.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(bool fine)
{
    if (!fine) {
        abort();
    }
}

static void check_words(char *const words[SCRIPT_WORDS], size_t count, const char *line, size_t size)
{
    const char *from = line;
    for (size_t i = 0; i < count; i++) {
        double value;
        check(words[i] >= from && words[i] <= line + size);
        from = words[i] + strlen(words[i]);
        check(from <= line + size);
        check(words[i][0] != '#' || (words[i] > line && words[i][-1] == '"'));
        check(!script_number(&value, words[i]) || isfinite(value));
    }
}

/* Copies a line as getline() gives it, into memory of exactly its length. */
static void read_line(const uint8_t *data, size_t size)
{
    char *words[SCRIPT_WORDS];
    size_t count = 0;
    char *line = malloc(size + 1);
    if (!line) {
        return;
    }
    memcpy(line, data, size);
    line[size] = '\0';
    bool fine = script_split(words, &count, line);
    check(count <= SCRIPT_WORDS && (fine || count == SCRIPT_WORDS));
    check_words(words, count, line, size);
    free(line);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    while (size) {
        const uint8_t *end = memchr(data, '\n', size);
        size_t length = end ? (size_t)(end - data) + 1 : size;
        read_line(data, length);
        data += length;
        size -= length;
    }
    return 0;
}
