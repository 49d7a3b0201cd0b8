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

/* Length of the characters of one byte in front, eight by eight. */
static size_t count_plain(struct text text)
{
    uint64_t eight = 0;
    size_t count = 0;
    while (count + sizeof eight <= text.size && !(eight & UINT64_C(0x8080808080808080))) {
        memcpy(&eight, text.data + count, sizeof eight);
        count += sizeof eight;
    }
    count -= eight & UINT64_C(0x8080808080808080) ? sizeof eight : 0;
    while (count < text.size && !(text.data[count] & 0x80)) {
        count++;
    }
    return count;
}

bool text_is_utf8(struct text text)
{
    while (text.size) {
        const size_t plain = count_plain(text);
        const size_t length = plain ? plain : text_character(text);
        if (!length) {
            return false;
        }
        text = (struct text){text.data + length, text.size - length};
    }
    return true;
}

static size_t put_character(char out[4], uint32_t code)
{
    static const unsigned char firsts[] = {0, 0, 0xc0, 0xe0, 0xf0};
    const size_t length = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    for (size_t i = length; i-- > 1; code >>= 6) {
        out[i] = (char)(0x80 | (code & 0x3f));
    }
    out[0] = (char)(firsts[length] | code);
    return length;
}

size_t text_from_utf16(char *out, size_t size, struct text wide, bool is_big)
{
    const unsigned char *bytes = (const unsigned char *)wide.data;
    size_t written = 0;
    for (size_t i = 0; i + 1 < wide.size && written + 4 <= size; i += 2) {
        const uint32_t unit = (uint32_t)bytes[i + !is_big] << 8 | bytes[i + is_big];
        const uint32_t low = i + 3 < wide.size ? (uint32_t)bytes[i + 2 + !is_big] << 8 | bytes[i + 2 + is_big] : 0;
        bool is_pair = unit >> 10 == 0x36 && low >> 10 == 0x37;
        written += put_character(out + written, is_pair            ? 0x10000 + ((unit & 0x3ff) << 10) + (low & 0x3ff)
                                                : unit >> 11 == 27 ? 0xfffd
                                                                   : unit);
        i += is_pair ? 2 : 0;
    }
    return written;
}

size_t text_from_windows(char out[4], unsigned char byte)
{
    static const uint16_t letters[32] = {0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021,
                                         0x02c6, 0x2030, 0x0160, 0x2039, 0x0152, 0,      0x017d, 0,
                                         0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022, 0x2013, 0x2014,
                                         0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};
    unsigned code = byte >= 0xa0 ? byte : letters[byte & 31] ? letters[byte & 31] : 0xfffd;
    memset(out, 0, 4);
    return put_character(out, code);
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
    while (*end >= ' ' && *end <= '~') { /* all, mostly */
        end++;
    }
    struct text rest = {end, strlen(end)};
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
