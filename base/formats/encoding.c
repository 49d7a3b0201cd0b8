/* SPDX-License-Identifier: BSD-3-Clause */
/* Text of Windows programs: UTF-8, or Windows-1252. */
#include "base/formats/encoding.h"

#include "base/memory.h"

#include <string.h>

/* What is in a text. */
struct census {
    size_t letters;     /* of UTF-8, beyond ASCII */
    size_t stray;       /* bytes of no such letter */
    size_t line;        /* of the first */
    size_t unknown;     /* line of the first that Windows-1252 has not, 0 if none */
    unsigned char byte; /* which */
    size_t size;        /* of the text in UTF-8 */
};

/* Copies into `out`, NULL: only counts; `all`: each byte beyond ASCII is Windows-1252. */
static struct census recode(char *out, struct text text, bool all)
{
    struct census census = {0};
    size_t line = 1;
    while (text.size) {
        char letter[4] = {text.data[0]};
        unsigned char byte = (unsigned char)text.data[0];
        size_t length = byte < 0x80 ? 1 : all ? 0 : text_character(text);
        size_t written = length ? length : text_from_windows(letter, byte);
        const char *from = length ? text.data : letter;
        line += byte == '\n';
        census.letters += length > 1;
        census.line = length || census.stray++ ? census.line : line;
        if (!length && written == 3 && !census.unknown && memcmp(letter, "\xef\xbf\xbd", 3) == 0) {
            census.unknown = line;
            census.byte = byte;
        }
        if (out) {
            memcpy(&out[census.size], from, written);
        }
        census.size += written;
        length = length ? length : 1;
        text = (struct text){text.data + length, text.size - length};
    }
    return census;
}

/* The encoding that XML declares, within its marks; empty if it declares none. */
static struct text declared_encoding(struct text text)
{
    const char *end = text_starts(text, "<?xml") ? text_find(text, "?>") : NULL;
    const char *at = end ? text_find((struct text){text.data, (size_t)(end - text.data)}, "encoding") : NULL;
    while (at && at < end && *at != '"' && *at != '\'') {
        at++;
    }
    const char *close = at && at < end ? memchr(at + 1, *at, (size_t)(end - at - 1)) : NULL;
    return close ? (struct text){at + 1, (size_t)(close - at - 1)} : (struct text){0};
}

/* Of XML that declares Windows-1252: only where `text` has letters, all of them in UTF-8, too. */
static conus_status say(const struct census *census, struct text text, bool is_declared, struct notes *notes)
{
    bool has_letters = census->size > text.size; /* each grows */
    return !notes || (is_declared && !(has_letters && text_is_utf8(text))) ? CONUS_OK
           : is_declared
               ? notes_add(notes, "the text is read as Windows-1252, as its XML declares, but its letters are those "
                                  "of UTF-8, too: they may be wrong")
           : census->letters
               ? notes_add(notes,
                           "line %zu: a byte that is not UTF-8 in a text that has letters in UTF-8, too: such bytes "
                           "(%zu) are read as Windows-1252, and letters may be wrong",
                           census->line, census->stray)
               : notes_add(notes, "the text is not UTF-8: it is read as Windows-1252");
}

conus_status encoding_decode(char **owned, struct text *text, struct notes *notes)
{
    static const char windows[] = "windows-1252/cp1252/ISO-8859-1/ISO_8859-1/ISO8859-1/latin1/latin-1";
    struct text declared = declared_encoding(text_trim(*text)); /* it must be the very first thing */
    bool is_declared = declared.size && text_is_one_of(declared, windows, false);
    struct text whole = is_declared ? text_trim(*text) : *text;
    bool is_utf16 = text_starts(*text, "\xff\xfe") || text_starts(*text, "\xfe\xff");
    *owned = NULL;
    if (is_utf16 || (!is_declared && (declared.size || text_is_utf8(*text)))) {
        return CONUS_OK;
    }
    struct census census = recode(NULL, whole, is_declared);
    if (census.unknown) {
        return fail(CONUS_ERROR_DATA,
                    "line %zu: byte 0x%02X is of neither UTF-8 nor Windows-1252: save the text as UTF-8",
                    census.unknown, census.byte);
    }
    char *copy = memory_raw(census.size + 1, 1);
    conus_status status = copy ? say(&census, whole, is_declared, notes) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(copy);
        return status;
    }
    recode(copy, whole, is_declared);
    copy[census.size] = '\0';
    if (is_declared) { /* "UTF-8   "; the mark that ends it moves to the front of the spaces */
        char *at = copy + (declared.data - whole.data);
        char mark = at[declared.size];
        memset(at, ' ', declared.size + 1);
        memcpy(at, "UTF-8", 5);
        at[5] = mark;
    }
    *text = (struct text){copy, census.size};
    *owned = copy;
    return CONUS_OK;
}
