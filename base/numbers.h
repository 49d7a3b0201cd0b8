/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Numbers of a position as people paste them: "(-42, -20, 50)", "x = -42, y = -20, z = 50", "42L 20P 50S",
 * "-42,5; -20; 50 mm" with any kind of minus. Pure: no memory, no message, no locale. */
#ifndef CONUS_BASE_NUMBERS_H
#define CONUS_BASE_NUMBERS_H

#include "base/text.h"

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
