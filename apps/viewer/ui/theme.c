/* SPDX-License-Identifier: BSD-3-Clause */
/* The colours, and their contrast. */
#include "viewer/ui/theme.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const ui_colour theme_shaded[THEME_TEXTS] = {
    [THEME_PLAIN] = {255, 255, 255, 255}, [THEME_HINT] = {190, 195, 205, 255}, [THEME_AMBER] = {255, 200, 90, 255},
    [THEME_ORANGE] = {255, 175, 85, 255}, [THEME_RED] = {255, 165, 150, 255},  [THEME_GREEN] = {110, 230, 130, 255},
};

static const ui_colour light_texts[THEME_TEXTS] = {
    [THEME_PLAIN] = {18, 20, 24, 255},  [THEME_HINT] = {66, 72, 84, 255}, [THEME_AMBER] = {86, 46, 0, 255},
    [THEME_ORANGE] = {150, 48, 0, 255}, [THEME_RED] = {160, 16, 20, 255}, [THEME_GREEN] = {0, 92, 32, 255},
};

static const ui_colour surfaces[THEME_COUNT][THEME_SURFACES] = {
    {
        [THEME_PANEL] = {33, 34, 38, 255},
        [THEME_POPUP] = {20, 20, 24, 255},
        [THEME_TITLE] = {43, 46, 54, 255},
        [THEME_FIELD] = {36, 52, 80, 255},
        [THEME_FIELD_HOVERED] = {40, 64, 104, 255},
        [THEME_FIELD_HELD] = {40, 68, 112, 255},
        [THEME_BUTTON] = {40, 70, 112, 255},
        [THEME_BUTTON_HOVERED] = {44, 78, 126, 255},
        [THEME_BUTTON_HELD] = {34, 62, 104, 255},
        [THEME_ROW] = {38, 62, 96, 255},
        [THEME_ROW_HOVERED] = {42, 74, 120, 255},
        [THEME_ROW_HELD] = {34, 62, 104, 255},
        [THEME_ODD_ROW] = {46, 47, 51, 255},
        [THEME_HEADINGS] = {48, 48, 51, 255},
        [THEME_KNOB] = {56, 92, 146, 255},
        [THEME_KNOB_HELD] = {60, 98, 154, 255},
        [THEME_MARKED] = {44, 80, 130, 255},
        [THEME_SHADE] = {0, 0, 0, 205},
    },
    {
        [THEME_PANEL] = {243, 244, 246, 255},
        [THEME_POPUP] = {255, 255, 255, 255},
        [THEME_TITLE] = {226, 230, 237, 255},
        [THEME_FIELD] = {222, 229, 240, 255},
        [THEME_FIELD_HOVERED] = {210, 221, 239, 255},
        [THEME_FIELD_HELD] = {202, 215, 237, 255},
        [THEME_BUTTON] = {204, 219, 242, 255},
        [THEME_BUTTON_HOVERED] = {190, 209, 240, 255},
        [THEME_BUTTON_HELD] = {212, 225, 245, 255},
        [THEME_ROW] = {211, 224, 243, 255},
        [THEME_ROW_HOVERED] = {203, 218, 241, 255},
        [THEME_ROW_HELD] = {214, 226, 245, 255},
        [THEME_ODD_ROW] = {234, 236, 240, 255},
        [THEME_HEADINGS] = {228, 231, 236, 255},
        [THEME_KNOB] = {150, 182, 228, 255},
        [THEME_KNOB_HELD] = {138, 173, 224, 255},
        [THEME_MARKED] = {170, 201, 245, 255},
        [THEME_SHADE] = {0, 0, 0, 205},
    },
};

static const ui_colour marks[THEME_COUNT] = {{120, 180, 255, 255}, {24, 92, 190, 255}};
const ui_colour *theme_texts = theme_shaded;
const ui_colour *theme_surfaces = surfaces[THEME_DARK];
const float theme_pale = 0.7F;

void theme_use(enum theme theme)
{
    theme_texts = theme == THEME_LIGHT ? light_texts : theme_shaded;
    theme_surfaces = surfaces[theme];
}

enum theme theme_used(void)
{
    return theme_texts == light_texts ? THEME_LIGHT : THEME_DARK;
}

ui_colour theme_mark(void)
{
    return marks[theme_used()];
}

/* The XDG Desktop Portal, which GNOME, KDE and others answer: its color-scheme is 0 = no preference, which is how GNOME
 * is light, 1 = dark, 2 = light. */
static const char question[] =
    "gdbus call --session --timeout 1 --dest org.freedesktop.portal.Desktop "
    "--object-path /org/freedesktop/portal/desktop --method org.freedesktop.portal.Settings.Read "
    "org.freedesktop.appearance color-scheme 2>/dev/null";

enum theme desktop_theme(void)
{
    enum { ANSWER = 64 };
    char text[ANSWER] = "";
    /* without a session's bus gdbus would start one */
    FILE *answer = getenv("DBUS_SESSION_BUS_ADDRESS") ? popen(question, "re") : NULL;
    if (!answer) {
        return THEME_DARK;
    }
    bool is_said = fgets(text, sizeof text, answer) && strncmp(text, "(<<uint32 ", 10) == 0;
    pclose(answer);
    return is_said && text[10] != '1' ? THEME_LIGHT : THEME_DARK;
}
