/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The colours of the window, a dark and a light theme: of texts, and of surfaces that texts stand on. Each text
 * can be read on each surface: their contrast is at least 4.5, also where a text is pale. */
#ifndef CONUS_VIEWER_UI_THEME_H
#define CONUS_VIEWER_UI_THEME_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** sRGB bytes and opacity. */
typedef struct ui_colour {
    uint8_t r, g, b, a;
} ui_colour;

enum theme_text {
    THEME_PLAIN = 0,
    THEME_HINT,   /**< Where nothing is typed yet, what is less important. */
    THEME_ACCENT, /**< Chosen things; keys; what was just done. */
    THEME_ORANGE, /**< Trouble. */
    THEME_RED,    /**< A tracker that is lost; the words say so, too. */
    THEME_GREEN,  /**< One that is there. */
    THEME_TEXTS
};

enum theme_surface {
    THEME_PANEL = 0,
    THEME_POPUP,
    THEME_FIELD, /**< Lines to type in, sliders, choices; under the mouse; while they are held. */
    THEME_FIELD_HOVERED,
    THEME_FIELD_HELD,
    THEME_BUTTON,
    THEME_BUTTON_HOVERED,
    THEME_BUTTON_HELD,
    THEME_ROW, /**< A row that is chosen. */
    THEME_ROW_HOVERED,
    THEME_ROW_HELD,
    THEME_MARKED, /**< Text that is marked. */
    THEME_SHADE,  /**< Under texts over pictures, with the opacity that it has over white. */
    THEME_SURFACES
};

/** What no text stands on (base/look.h). */
enum theme_mark { THEME_MARK = 0, THEME_EDGE, THEME_KNOB, THEME_KNOB_HELD, THEME_LINE, THEME_MARKS };

enum theme { THEME_DARK = 0, THEME_LIGHT, THEME_COUNT };

/** Colours of the theme in use, by those enums: one for the program, as Dear ImGui's style is. */
extern const ui_colour *theme_texts, *theme_surfaces, *theme_marks;
/** Texts on THEME_SHADE, over pictures, which have no theme. */
extern const ui_colour theme_shaded[THEME_TEXTS];
/** The theme in use; dark until theme_use(), whose colours widgets take over with the next ui_create() or
 * ui_set_scale(). */
enum theme theme_used(void);
void theme_use(enum theme theme);
/** Opacity of pale texts: less would be too faint. */
extern const float theme_pale;

/** The theme that the user chose for the desktop; the dark one where no desktop answers within a second. */
enum theme desktop_theme(void);

#ifdef __cplusplus
}
#endif

#endif
