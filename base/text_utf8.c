/* SPDX-License-Identifier: BSD-3-Clause */
/* Text of results, which programs that share text.c do not make. */
#include "base/memory.h"
#include "base/text.h"

#include <string.h>

char *text_to_utf8(struct text text)
{
    char *out = text.size < SIZE_MAX / 3 ? memory_raw(3 * text.size + 1, 1) : NULL;
    size_t size = 0;
    while (out && text.size) {
        const unsigned char *at = (const unsigned char *)text.data;
        size_t length = 0;
        while (length < text.size && !(at[length] & 0x80)) {
            length++;
        }
        length = length ? length : text_character(text);
        bool control = length == 2 && at[0] == 0xc2 && at[1] < 0xa0;
        if (length && !control) {
            memcpy(&out[size], text.data, length);
            size += length;
        } else {
            size += text_from_windows(&out[size], at[control]);
        }
        length = length ? length : 1;
        text = (struct text){text.data + length, text.size - length};
    }
    if (out) {
        out[size] = '\0';
        text_make_plain(out, "");
    }
    return out;
}
