/* SPDX-License-Identifier: BSD-3-Clause */
/* UTF-8: checks it, and replaces what would steer a terminal. Below memory.c and status.c, whose messages pass here. */
#include "base/text.h"

#include "conus/own.h"

#include <string.h>

size_t text_character(struct text text) /* Unicode 15, table 3-7 */
{
    const unsigned char *s = (const unsigned char *)text.data;
    if (s[0] < 0x80) {
        return 1;
    }
    size_t length = s[0] >= 0xc2 && s[0] <= 0xdf ? 2 : (s[0] & 0xf0) == 0xe0 ? 3 : s[0] >= 0xf0 && s[0] <= 0xf4 ? 4 : 0;
    if (!length || length > text.size) {
        return 0;
    }
    for (size_t i = 1; i < length; i++) {
        if ((s[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
    bool outside = (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf4 && s[1] > 0x8f);
    return overlong || outside ? 0 : length;
}

bool text_is_utf8(struct text text)
{
    while (text.size) {
        size_t length = text_character(text);
        if (!length) {
            return false;
        }
        text = (struct text){text.data + length, text.size - length};
    }
    return true;
}

size_t text_from_windows(char out[4], unsigned char byte)
{
    static const uint16_t letters[32] = {0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021,
                                         0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017d, 0,
                                         0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                         0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};
    unsigned code = byte >= 0xa0 ? byte : letters[byte & 31] ? letters[byte & 31] : 0xfffd;
    size_t length = code < 0x800 ? 2 : 3;
    out[0] = (char)(length == 2 ? 0xc0 | code >> 6 : 0xe0 | code >> 12);
    out[1] = (char)(0x80 | (code >> (length == 2 ? 0 : 6) & 0x3f));
    out[2] = (char)(length == 2 ? '\0' : 0x80 | (code & 0x3f));
    out[3] = '\0';
    return length;
}

/* The character that a valid sequence of `length` bytes means. */
static uint32_t utf8_code(const char *bytes, size_t length)
{
    static const unsigned char first[] = {0, 0x7f, 0x1f, 0x0f, 0x07}; /* bits of the first byte, by length */
    uint32_t code = (unsigned char)bytes[0] & first[length];
    for (size_t i = 1; i < length; i++) {
        code = code << 6 | ((unsigned char)bytes[i] & 0x3f);
    }
    return code;
}

/* Whether a character moves a terminal's cursor, begins a command to it, ends the line or turns the text around:
 * controls (C0, DEL, C1), line and paragraph separators, bidirectional embeddings, overrides and isolates. */
static bool steers_terminal(uint32_t code)
{
    return code < 0x20 || (code >= 0x7f && code <= 0x9f) || (code >= 0x2028 && code <= 0x202e) ||
           (code >= 0x2066 && code <= 0x2069);
}

void text_make_plain(char *text, const char *kept)
{
    char *end = text;
    struct text rest = {text, strlen(text)};
    while (rest.size) {
        size_t length = text_character(rest);
        size_t used = length ? length : 1;
        if (!length) {
            *end++ = '?';
        } else if (steers_terminal(utf8_code(rest.data, length)) && !strchr(kept, *rest.data)) {
            *end++ = ' ';
        } else {
            memmove(end, rest.data, length);
            end += length;
        }
        rest = (struct text){rest.data + used, rest.size - used};
    }
    *end = '\0';
}

void conus_plain_text(char *text)
{
    text_make_plain(text, "\n\t");
}
