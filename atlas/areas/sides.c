/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the word for the side in the name of an area. */
#include "atlas/areas/sides.h"

#include <string.h>

static const struct {
    const char *left, *right;
    bool outer; /* only at a name's ends; a small letter within it is as often something else */
} pairs[] = {
    {"L", "R", false},   {"left", "right", false}, {"Left", "Right", false}, {"LEFT", "RIGHT", false},
    {"lh", "rh", false}, {"LH", "RH", false},      {"l", "r", true},
};

static bool is_word_character(char c)
{
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (unsigned char)c >= 0x80;
}

/* The run of word characters that starts at `from` or later. */
static struct text next_word(struct text name, size_t from)
{
    while (from < name.size && !is_word_character(name.data[from])) {
        from++;
    }
    size_t end = from;
    while (end < name.size && is_word_character(name.data[end])) {
        end++;
    }
    return (struct text){name.data + from, end - from};
}

bool side_word_find(struct side_word *out, struct text name, size_t from)
{
    struct text word;
    for (; (word = next_word(name, from)).size; from = out->start + out->size) {
        *out = (struct side_word){.start = (size_t)(word.data - name.data), .size = word.size};
        for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
            bool left = text_equal(word, pairs[i].left);
            if ((left || text_equal(word, pairs[i].right)) &&
                (!pairs[i].outer || !out->start || out->start + out->size == name.size)) {
                out->side = left ? 'L' : 'R';
                out->opposite = left ? pairs[i].right : pairs[i].left;
                return true;
            }
        }
    }
    return false;
}

bool side_word_is_long(const struct side_word *word)
{
    return word->size > 1;
}

void side_word_swap(struct buffer *out, struct text name, const struct side_word *word)
{
    size_t end = word->start + word->size;
    buffer_append(out, name.data, word->start);
    buffer_text(out, word->opposite);
    buffer_append(out, name.data + end, name.size - end);
}

static bool is_joining(char c)
{
    return c && strchr(" _-.,:;/", c);
}

static bool is_bracketed(struct text name, size_t start, size_t end)
{
    static const char brackets[] = "()[]";
    const char *open = start && end < name.size ? strchr(brackets, name.data[start - 1]) : NULL;
    return open && *open && open[1] == name.data[end];
}

void side_word_drop(struct buffer *out, struct text name, const struct side_word *word)
{
    size_t start = word->start;
    size_t end = start + word->size;
    if (is_bracketed(name, start, end)) {
        start--;
        end++;
    }
    size_t next = end;
    while (next < name.size && is_joining(name.data[next])) {
        next++;
    }
    while (next == end && start && is_joining(name.data[start - 1])) { /* nothing joins it to what follows */
        start--;
    }
    buffer_append(out, name.data, start);
    buffer_append(out, name.data + next, name.size - next);
}
