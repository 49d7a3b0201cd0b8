/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines, fields, words and numbers of any bytes. */
#include "base/memory.h"
#include "base/text.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void read_word(struct text word)
{
    double number;
    int64_t integer;
    if (text_to_int(word, &integer) && !text_to_double(word, &number)) {
        abort(); /* an integer is a number, too */
    }
    char *clean = text_to_utf8(word);
    if (!clean || !text_is_utf8(text_from(clean))) {
        abort();
    }
    memory_free(clean);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct text rest = {(const char *)data, size};
    struct text line;
    while (text_line(&rest, &line)) {
        struct text fields = line;
        struct text field;
        for (bool more = true; text_field(&fields, '\t', &more, &field);) {
            struct text word;
            while (text_word(&field, &word)) {
                read_word(word);
            }
        }
    }
    return 0;
}
