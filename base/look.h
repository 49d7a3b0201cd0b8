/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The colours and sizes of everything that a person sees: the window, figures and the page. Who draws takes them from
 * here by what they mean; apps/web/pack.mjs reads the rows below for the page. Colours of data are not here: transfer
 * functions, ramps of numbers, palettes of others. */
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
    LOOK_RANK_3 = 0xA87EF6,
    LOOK_RANK_4 = 0x7E9C54,
    LOOK_RANK_5 = 0x4272AE,
    LOOK_RANK_6 = 0x8A6C00,
    LOOK_RANK_MORE = 0x6B727C, /**< From the seventh on, with a number. */
    LOOK_NOT_HIT = 0xC9CDD3,   /**< On dark. */
    LOOK_NOT_HIT_ON_WHITE = 0xD6D9DE,
    LOOK_CONE = 0xFFB000,
    LOOK_SECOND = 0x00BEFF, /**< The second tool, and its cone. */
    LOOK_BROKEN = 0xFF6B57, /**< An old answer, or something that does not hold. */
    LOOK_HOLDS = 0x3FB68B,

    /* Pictures. */
    LOOK_CONE_OLD = 0xB4B4B4,     /**< The cone where the tool is not seen. */
    LOOK_APEX = 0x3C3C42,         /**< The ball where the cone begins. */
    LOOK_AROUND = 0xACA59B,       /**< Lines of surfaces around the areas in cuts: on black, grey and white. */
    LOOK_GLASS = 0xDBD4C7,        /**< Surfaces around the areas in 3-D: bone. */
    LOOK_GLASS_EDGE = 0x555559,   /**< Their outline: it shows on white and on black. */
    LOOK_MARKER_EDGE = 0x191919,  /**< Of balls. */
    LOOK_OUTLINE = 0x69737D,      /**< Outlines in cuts of what is not hit: seen on that, and around it. */
    LOOK_CUT_GROUND = 0x909090,   /**< Under areas in cuts where there is no image, or it is black. */
    LOOK_NO_OBJECT = 0x82848A,    /**< The chip and curve of what is no object. */
    LOOK_SEEN_NOTHING = 0x34353A, /**< Pixels of the device that see no object, and what is around them. */
    LOOK_SEEN_AROUND = 0x18191C,

    /* The window: its main button is as amber as the cone, and nothing else is. */
    LOOK_MAIN = LOOK_CONE,
    LOOK_MAIN_HOVERED = 0xFFC24D,
    LOOK_MAIN_HELD = 0xE09A00,
    LOOK_MAIN_TEXT = 0x1E1600,
    LOOK_PANE_DARK = 0x14171B, /**< Behind the brain in the dark theme; on the page behind cuts, too. */

    /* The window, over pictures, which have no theme. */
    LOOK_CHOSEN = 0xFFFFFF, /**< The outline of what is chosen. */
    LOOK_OVER = 0xEBEBF0,   /**< Words and lines over pictures, farther ones, and under them. */
    LOOK_OVER_FAR = 0xAFAFB5,
    LOOK_UNDER = 0x141418,
    LOOK_UNDER_SECOND = 0x0A141E,
    LOOK_CROSS = 0xF2F28A,  /**< The crosshair. */
    LOOK_BORDER = 0x78AAE6, /**< A border of panes that is held. */
    LOOK_PLOT = 0x18191E,   /**< Under a transfer function; its bars. */
    LOOK_PLOT_BARS = 0x787E8C,
};

/** @name The themes
 * An item: its name, dark, light. LOOK_DARK_NAME and LOOK_LIGHT_NAME are the colours.
 * @{ */
/** Texts of the window. */
#define LOOK_TEXTS(ITEM)                                                                                               \
    ITEM(PLAIN, 0xF2F4F6, 0x1B1F24)                                                                                    \
    ITEM(HINT, 0xBEC3CD, 0x424854)                                                                                     \
    ITEM(ACCENT, 0x9CC7FF, 0x0A3880)                                                                                   \
    ITEM(ORANGE, 0xFFAF55, 0x963000)                                                                                   \
    ITEM(RED, 0xFFA596, 0xA01014)                                                                                      \
    ITEM(GREEN, 0x6EE682, 0x005C20)
/** What no text stands on: the focus and ticks, the edge of what is pressed or typed in, sliders' knobs, lines between
 * groups of widgets. */
#define LOOK_MARKS(ITEM)                                                                                               \
    ITEM(MARK, 0x78B4FF, 0x185CBE)                                                                                     \
    ITEM(EDGE, 0x868F9C, 0x707882)                                                                                     \
    ITEM(KNOB, 0xAEB9C5, 0x5A6572)                                                                                     \
    ITEM(KNOB_HELD, 0xF2F4F6, 0x3A434E)                                                                                \
    ITEM(LINE, 0x3A4049, 0xD9DCE1)

/** What texts stand on. */
#define LOOK_SURFACES(ITEM)                                                                                            \
    ITEM(PANEL, 0x1E2126, 0xF4F5F7)                                                                                    \
    ITEM(POPUP, 0x16181C, 0xFFFFFF)                                                                                    \
    ITEM(FIELD, 0x272B31, 0xE9ECF0)                                                                                    \
    ITEM(FIELD_HOVERED, 0x30353D, 0xE1E5EB)                                                                            \
    ITEM(FIELD_HELD, 0x3A424D, 0xD8DEE6)                                                                               \
    ITEM(BUTTON, 0x2F353D, 0xE1E5EA)                                                                                   \
    ITEM(BUTTON_HOVERED, 0x373E48, 0xDADFE6)                                                                           \
    ITEM(BUTTON_HELD, 0x3A424D, 0xCFD6DF)                                                                              \
    ITEM(ROW, 0x333B46, 0xDDE4EE)                                                                                      \
    ITEM(ROW_HOVERED, 0x2A2F37, 0xE9ECF0)                                                                              \
    ITEM(ROW_HELD, 0x3A424D, 0xD3DBE6)                                                                                 \
    ITEM(MARKED, 0x34465F, 0xBFD3F2)

/** The page, as page.css names them. */
#define LOOK_PAGE(ITEM)                                                                                                \
    ITEM(PAGE_GROUND, 0x16181C, 0xFFFFFF)                                                                              \
    ITEM(PAGE_TEXT, 0xECECEC, 0x1A1A1A)                                                                                \
    ITEM(PAGE_SOFT, 0xB5B5B5, 0x555555)                                                                                \
    ITEM(PAGE_LINE, 0x8A8A8A, 0x767676)                                                                                \
    ITEM(PAGE_MARK, 0x8AB4F8, 0x0B57D0)                                                                                \
    ITEM(PAGE_WRONG, 0xFFB4AB, 0xB3261E)                                                                               \
    ITEM(PAGE_CHOSEN, 0x2B3D5C, 0xD9E6FB)
/** @} */

#define LOOK_BOTH_THEMES(name, dark, light) LOOK_DARK_##name = (dark), LOOK_LIGHT_##name = (light),
enum look_theme_colour {
    LOOK_TEXTS(LOOK_BOTH_THEMES) LOOK_MARKS(LOOK_BOTH_THEMES) LOOK_SURFACES(LOOK_BOTH_THEMES)
        LOOK_PAGE(LOOK_BOTH_THEMES)
};

/** @name Linear light
 * Words and lines that are drawn into pictures: red, green and blue, 0 to 1.
 * @{ */
#define LOOK_PICTURE_INK 0.83F, 0.83F, 0.86F /**< Over cuts. */
#define LOOK_PICTURE_INK_ON_DARK 0.9F        /**< A grey. */
#define LOOK_PICTURE_INK_ON_LIGHT 0.02F
#define LOOK_PICTURE_TOP 0.90F /**< The light background, a grey: its top, and how much darker it is below. */
#define LOOK_PICTURE_DARKER 0.22F
#define LOOK_LEGEND_TEXT 0.95F, 0.95F, 0.95F /**< Beside what a device saw. */
#define LOOK_MEASURED 0.83F, 0.9F, 0.83F     /**< A measured line and its words, and what is under them. */
#define LOOK_MEASURED_UNDER 0.02F, 0.02F, 0.025F
#define LOOK_PROBE_CASING 0.01F, 0.01F, 0.015F
#define LOOK_PROBE_OUTSIDE 0.35F, 0.35F, 0.37F
/** @} */

/** The initialiser of three bytes: red, green and blue. */
#define LOOK_RGB(colour) (colour) / 65536, (colour) / 256 % 256, (colour) % 256

/** A row for each rank, the first hit's first. */
#define LOOK_RANKS(ROW)                                                                                                \
    ROW(LOOK_RANK_1) ROW(LOOK_RANK_2) ROW(LOOK_RANK_3) ROW(LOOK_RANK_4) ROW(LOOK_RANK_5) ROW(LOOK_RANK_6)

#ifndef __cplusplus /* ui.cpp draws no answer */
/** sRGB of what has a rank, 0 = none, in an answer: its colour by `weight` (conus_selection_weight()), the rest
 * `not_hit`. */
static inline void look_ranked(unsigned char rgb[3], unsigned long rank, double weight, unsigned not_hit)
{
#define LOOK_ROW(colour) colour,
    static const unsigned ranks[] = {LOOK_RANKS(LOOK_ROW)};
#undef LOOK_ROW
    const unsigned colour = !rank ? not_hit : rank <= sizeof ranks / sizeof *ranks ? ranks[rank - 1] : LOOK_RANK_MORE;
    for (int shift = 16; shift >= 0; shift -= 8) {
        *rgb++ = (unsigned char)(weight * (colour >> shift & 255) + (1 - weight) * (not_hit >> shift & 255) + 0.5);
    }
}
#endif

/* Sizes of letters and of the space around them, for the window, figures and the page. */

enum look_size {
    /* The window, pixels at a scale of 1. */
    LOOK_TEXT = 17,
    LOOK_HEADING = 30,
    LOOK_ROUNDING = 4, /**< Of corners. */
    LOOK_PADDING_X = 12,
    LOOK_PADDING_Y = 6,
    LOOK_GAP_X = 6,
    LOOK_GAP_Y = 4,
    LOOK_BAR = 10,   /**< A bar that scrolls. */
    LOOK_CELL = 4,   /**< Between a table's columns, */
    LOOK_CELL_Y = 4, /**< and between a row and its line. */

    /* Figures. */
    LOOK_FIGURE_PART = 54,  /**< Where no dpi is known letters are as high as this part of the shorter side, */
    LOOK_FIGURE_LEAST = 11, /**< and have at least so many pixels. */

    /* The page, pixels of CSS. */
    LOOK_PAGE_TITLE = 22,
    LOOK_PAGE_TYPE = 15,
    LOOK_PAGE_TABLE = 14,
    LOOK_PAGE_SMALL = 13,
};

/** Letters of figures, points of a 72nd inch. */
#define LOOK_FIGURE_POINTS 7.0

#endif
