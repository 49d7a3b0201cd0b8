/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Text from untrusted files and for them: bounded, and independent of the process's locale. */
#ifndef CONUS_BASE_TEXT_H
#define CONUS_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* Numbers as text, shortest and independent of the process's locale. */

enum { TEXT_NUMBER_SIZE = 32 };

/** @p value with up to 9 digits and no needless zeros, whole numbers below 2^53 with all of theirs; else "nan", "inf"
 * or "-inf". Never the locale's decimal comma, never "-0". Returns @p out. */
char *text_number(char out[TEXT_NUMBER_SIZE], double value);

/** The same in memory that lives as long as the block in which this stands. */
#define NUMBER_TEXT(value) text_number((char[TEXT_NUMBER_SIZE]){0}, value)

/** The same, and gives the text's length. */
size_t text_number_length(char out[TEXT_NUMBER_SIZE], double value);

/** @p value in decimal; gives the text's length. */
size_t text_whole(char out[TEXT_NUMBER_SIZE], uint64_t value);

enum { TEXT_SHARE_SIZE = 16 };

/** A part in per cent with one digit behind the point or none: "12.3"; "<0.1" or "<1" of what would be 0 but is not. */
const char *text_share(char out[TEXT_SHARE_SIZE], double share, int digits);

enum { TEXT_TIME_DIGITS = 15 };

/** As text_number() with up to TEXT_TIME_DIGITS digits: a hundred-thousandth of a calendar's seconds. */
char *text_time(char out[TEXT_NUMBER_SIZE], double value);

/* Reading and writing text from untrusted files: bounded, and independent of the process's locale. */

/** A text inside bytes that someone else owns; not NUL-terminated. */
struct text {
    const char *data;
    size_t size;
};

/** Arguments for "%.*s": the first @p most bytes of the text @p t. */
#define TEXT_SHOW(t, most) (int)((t).size < (most) ? (t).size : (most)), (t).size ? (t).data : ""

/** A text over a C string. */
static inline struct text text_from(const char *string)
{
    return (struct text){string, strlen(string)};
}

/** @p data as text: without a byte order mark of UTF-8, and without NULs and white space at its end. */
struct text text_from_bytes(const uint8_t *data, size_t size);

/** Takes the next line off @p rest (ended by LF, CR, CRLF or the end) into @p line, without its ending.
 * False when nothing is left. */
bool text_line(struct text *rest, struct text *line);

/** Takes the next field off @p rest, up to the single byte @p separator or the end. False when nothing is left;
 * "a,,b" has an empty field in the middle, and "a," an empty one at the end. Start with *more = true. */
bool text_field(struct text *rest, char separator, bool *more, struct text *field);

/** How text_quoted_field() found a field to be written. */
enum text_quotes {
    TEXT_PLAIN,
    TEXT_QUOTED,
    TEXT_FOLLOWED, /**< There is more behind the closing mark, which is left out. */
    TEXT_UNCLOSED
};

/** text_field() of fields that may stand in quotation marks and then hold separators, and doubled marks. @p field is
 * without the white space around it and the outer marks; doubled ones stay. */
bool text_quoted_field(struct text *rest, char separator, bool *more, struct text *field, enum text_quotes *quotes);

/** Takes the next run without white space off @p rest. False when only white space is left. */
bool text_word(struct text *rest, struct text *word);

/** Bytes of the white space that @p text begins with, one character: that of ASCII, U+00A0, U+2000 to U+200A, U+202F;
 * 0 for none. */
size_t text_blank(struct text text);

/** Bytes of the minus that @p text begins with: ASCII's, U+2212, U+2013, U+2011, U+00AD; 0 for none. */
size_t text_minus(struct text text);

/** How many digits there are from @p from on. */
size_t text_digits(struct text text, size_t from);

/** @p text without white space at both ends. */
struct text text_trim(struct text text);

bool text_equal(struct text text, const char *string);
bool text_equal_ignoring_case(struct text text, const char *string);
bool text_starts(struct text text, const char *prefix);

/** Bytes of the sign, of whichever kind, with which @p text begins, 0 if it has none; *sign is '+', '-' or 0. */
static inline size_t text_sign(char *sign, struct text text)
{
    static const char *const signs[] = {"+", "-", "\xe2\x88\x92", "\xe2\x80\x93", "\xe2\x80\x91", "\xc2\xad"};
    *sign = 0;
    for (size_t i = 0; i < sizeof signs / sizeof signs[0]; i++) {
        size_t size = strlen(signs[i]);
        if (text.size >= size && memcmp(text.data, signs[i], size) == 0) {
            *sign = i ? '-' : '+';
            return size;
        }
    }
    return 0;
}

/** Whether @p text is one of @p words, which have '/' between them; @p exact: upper and lower case differ. */
bool text_is_one_of(struct text text, const char *words, bool exact);

/* What GNU's C library has for text, and others have not. */

/** Where @p part begins first in @p text; NULL = nowhere. */
const char *text_find(struct text text, const char *part);

/** Where @p c stands last in @p text; NULL = nowhere. */
const char *text_last(struct text text, char c);

/** Takes the next word off *rest, up to one of @p separators, in whose place a NUL is written. *rest is NULL behind the
 * last word, which may be empty; then NULL is returned. */
char *text_next(char **rest, const char *separators);

/** A copy of the first @p most bytes of @p text, or fewer where it ends earlier. free() it; NULL without memory. */
char *text_copy(const char *text, size_t most);

enum text_matching {
    TEXT_ANY_CASE = 1, /**< Upper and lower case (of ASCII) are the same. */
    TEXT_NO_DOT = 2    /**< Only a '.' of the pattern stands for one that the name begins with. */
};

/** Whether all of @p name matches @p pattern: '*' is any bytes, '?' one byte, "[a-z_]" one of them, "[!a-z]" one that
 * is none of them, "[[:digit:]]" one of a class of ASCII; a backslash takes the meaning of the next byte. @p how is a
 * sum of enum text_matching. */
bool text_matches(const char *name, const char *pattern, unsigned how);

/** True when @p part stands somewhere in @p text. */
bool text_mentions(struct text text, const char *part);

/** Compares by bytes; a text that the other begins with is the smaller one. */
int text_compare(struct text a, struct text b);

/** True when @p part stands somewhere in @p text; upper and lower case (of ASCII) are the same. */
bool text_contains(struct text text, struct text part);

/** Words for mm, of text_is_one_of(). */
#define TEXT_MM "mm/millimeter/millimeters/millimetre/millimetres"

/** Takes the next run of letters and digits (and bytes above ASCII) off @p rest; false where there is none. */
bool text_token(struct text *rest, struct text *token);

/** Finds the next of @p words ('/' between them, whatever their case) in @p rest that has a value, and goes on at the
 * value: a token behind "=", ":", blanks, quotes and brackets, SPACE="LPS", "coordinates (LPS)"; @p sign: only where
 * "=" or ":" is among these. */
bool text_statement(struct text *rest, const char *words, bool sign, struct text *value);

/** True when every byte of @p text is one of @p these: of an empty one, too. */
bool text_has_only(struct text text, const char *these);

/** What glibc says of an error of the system (errno), so that messages are the same on all. */
const char *text_error(int error);

/** How many bytes must be inserted, deleted or replaced to turn @p a into @p b, ignoring case; for guessing what was
 * meant. SIZE_MAX if either is longer than 255 bytes. */
size_t text_distance(struct text a, struct text b);

/* Numbers are at most 63 characters long; longer text is none. */

/** The whole of @p text as a decimal number ('.' is the decimal point; "nan" and "inf" are read). False if it is none.
 */
bool text_to_double(struct text text, double *out);

/** The same, rounded once from the decimal number to the nearest float. */
bool text_to_float(struct text text, float *out);

/** The whole of @p text as a decimal integer without sign, at most @p limit. False if it is none. */
bool text_to_uint(struct text text, uint64_t limit, uint64_t *out);

/** The whole of @p text as a decimal integer, a leading sign allowed. False if it is none or does not fit. */
bool text_to_int(struct text text, int64_t *out);

/** True when @p text is not empty and has no control character but tab, line and page breaks: not a binary file. */
bool text_is_readable(struct text text);

/** True when @p text is valid UTF-8 (no surrogates, nothing above U+10FFFF, no overlong forms). */
bool text_is_utf8(struct text text);

/** Makes @p text harmless for a terminal, in place: a space for each character that would steer it (controls, line and
 * paragraph separators, marks that turn the direction of text) but those of @p kept, '?' for each byte that is no
 * UTF-8.
 */
void text_make_plain(char *text, const char *kept);

/** Length of the character of UTF-8 that @p text, not empty, begins with; 0 if it begins with none. */
size_t text_character(struct text text);

/** Writes the letter that Windows-1252 has for @p byte, 0x80 and above, as UTF-8 into @p out; its length. U+FFFD for
 * the five bytes that it has none for. */
size_t text_from_windows(char out[4], unsigned char byte);

/** Writes the UTF-16 @p wide, its high bytes first if @p is_big, as UTF-8 into @p out of so many bytes, up to 3 for 2
 * of the text, and says how many there are: whole characters. Half a pair of surrogates is U+FFFD. */
size_t text_from_utf16(char *out, size_t size, struct text wide, bool is_big);

/** A copy of @p text for results: as UTF-8 (a byte that is none of it is taken as Windows-1252, as is a control of
 * U+0080 to U+009F, which such bytes become on a wrong way), plain as text_make_plain() makes it. End it with
 * memory_free(); NULL without memory. */
char *text_to_utf8(struct text text);

/* Numbers of a position as people paste them: "(-42, -20, 50)", "x = -42, y = -20, z = 50", "42L 20P 50S",
 * "-42,5; -20; 50 mm" with any kind of minus. Pure: no memory, no message, no locale. */

enum numbers_found {
    NUMBERS_NONE,  /**< The text has fewer numbers: it may be a name. */
    NUMBERS_FOUND, /**< They are read. */
    NUMBERS_WRONG  /**< It has three or more, and cannot be read, or in several ways; see why. */
};

struct numbers {
    double value[3];                  /**< The numbers; letters have become signs of RAS. */
    size_t count;                     /**< How many numbers the text has, also where they are refused. */
    bool has_letters;                 /**< L R A P S I stood with them: they are RAS. */
    bool says_ras, says_mni, says_mm; /**< These words stood with them. */
    struct text at;                   /**< WRONG: a part of the text, not empty, and */
    const char *why;                  /**< what is wrong with it, static: "\"foo\" is no number, sign or known word". */
};

/** Reads the three numbers that are all of @p text. Beside them may stand brackets, x y z in this order
 * (all in front, or each before its number), = and : behind a word, and the words mm, MNI, MNI152, RAS, at, peak. They
 * are separated by white space (of Unicode, too), commas or semicolons. U+2212, U+2013, U+2011 and U+00AD are a minus
 * where a number begins. A comma between digits is a decimal comma, or groups thousands, where something else separates
 * the numbers; before exactly three digits it is refused unless another number shows what it is. A letter
 * L R A P S I behind each number, or before each, is its sign. All else is refused. */
enum numbers_found numbers_read(struct numbers *out, struct text text);

#endif
