/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The colours of everything that a person sees: the window, figures and the page. */
#ifndef CONUS_BASE_LOOK_H
#define CONUS_BASE_LOOK_H

/** sRGB, 0xRRGGBB. */
enum look_colour {
    LOOK_WHITE = 0xFFFFFF,
    LOOK_BLACK = 0x000000,

    /* What a question hits, by its place in the answer. tests/base/test_look.c says how far apart they are, from each
     * other and from all that follows up to the states, for any colour vision. On white, and on the dark background of
     * 3-D, their contrast is 3 or more. */
    LOOK_RANK_1 = 0xD2246C,
    LOOK_RANK_2 = 0x009CA8,
    LOOK_RANK_3 = 0x8A6C00,
    LOOK_RANK_4 = 0xA87EF6,
    LOOK_RANK_5 = 0x4272AE,
    LOOK_RANK_6 = 0x7E9C54,
    LOOK_NOT_HIT = 0xC9CDD3, /**< On dark. */
    LOOK_NOT_HIT_ON_WHITE = 0xD6D9DE,
    LOOK_CONE = 0xFFAA28,
    LOOK_SECOND = 0x00BEFF, /**< The second tool, and its cone. */
    LOOK_BROKEN = 0xFF6B57, /**< An old answer, or something that does not hold. */
    LOOK_HOLDS = 0x3FB68B,
};

/** The initialiser of three bytes: red, green and blue. */
#define LOOK_RGB(colour) (colour) / 65536, (colour) / 256 % 256, (colour) % 256

/** A row for each rank, the first hit's first. */
#define LOOK_RANKS(ROW)                                                                                                \
    ROW(LOOK_RANK_1) ROW(LOOK_RANK_2) ROW(LOOK_RANK_3) ROW(LOOK_RANK_4) ROW(LOOK_RANK_5) ROW(LOOK_RANK_6)

#endif
