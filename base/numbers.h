/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Numbers of a position as people paste them: "(-42, -20, 50)", "x = -42, y = -20, z = 50", "42L 20P 50S",
 * "-42,5; -20; 50 mm" with any kind of minus. Pure: no memory, no message, no locale. */
#ifndef CONUS_BASE_NUMBERS_H
#define CONUS_BASE_NUMBERS_H

#include "base/text.h"

/** What a comma between two digits is. */
enum numbers_comma {
    NUMBERS_COMMA_UNKNOWN = 0,
    NUMBERS_COMMA_DECIMAL, /**< -42,5 is -42.5. */
    NUMBERS_COMMA_GROUPS   /**< 5,739 is 5739. */
};

enum numbers_found {
    NUMBERS_NONE,  /**< The text has fewer numbers: it may be a name. */
    NUMBERS_FOUND, /**< They are read. */
    NUMBERS_WRONG  /**< It has that many or more, and cannot be read, or in several ways; see why. */
};

struct numbers {
    double value[3];                  /**< The numbers; letters have become signs of RAS. */
    size_t count;                     /**< How many numbers the text has, also where they are refused. */
    enum numbers_comma comma;         /**< What a comma is, as far as these numbers show it by themselves. */
    bool is_doubtful;                 /**< WRONG: a comma stands before exactly three digits, and nothing shows what it
                                         is. Where other texts show it, read this one again with that. */
    bool has_letters;                 /**< L R A P S I stood with them: they are RAS. */
    bool says_ras, says_mni, says_mm; /**< These words stood with them. */
    struct text at;                   /**< WRONG: a part of the text, not empty, and */
    const char *why;                  /**< what is wrong with it, static: "\"foo\" is no number, sign or known word". */
};

/** Reads the @p wanted numbers, 1 or 3, that are all of @p text. Beside them may stand brackets, x y z in this order
 * (all in front, or each before its number), = and : behind a word, and the words mm, MNI, MNI152, RAS, at, peak. They
 * are separated by white space (of Unicode, too), commas or semicolons. U+2212, U+2013, U+2011 and U+00AD are a minus
 * where a number begins. A comma between digits is a decimal comma, or groups thousands, where something else separates
 * the numbers; before exactly three digits it is refused unless @p comma or another number shows what it is. A letter
 * L R A P S I behind its number, or with @p letters_first before each, is its sign. All else is refused. */
enum numbers_found numbers_read(struct numbers *out, struct text text, size_t wanted, enum numbers_comma comma,
                                bool letters_first);

#endif
