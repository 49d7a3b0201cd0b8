/* SPDX-License-Identifier: BSD-3-Clause */
/* The colours, and their contrast. */
#include "viewer/ui/ui.h"

#include "base/look.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHADE_OPACITY = 205 };

#define DARK(name, dark, light) [THEME_##name] = {LOOK_RGB(dark), 255},
#define LIGHT(name, dark, light) [THEME_##name] = {LOOK_RGB(light), 255},

const ui_colour theme_shaded[THEME_TEXTS] = {LOOK_TEXTS(DARK)};
static const ui_colour light_texts[THEME_TEXTS] = {LOOK_TEXTS(LIGHT)};

static const ui_colour surfaces[THEME_COUNT][THEME_SURFACES] = {
    {LOOK_SURFACES(DARK)[THEME_SHADE] = {LOOK_RGB(LOOK_BLACK), SHADE_OPACITY}},
    {LOOK_SURFACES(LIGHT)[THEME_SHADE] = {LOOK_RGB(LOOK_BLACK), SHADE_OPACITY}},
};

static const ui_colour marks[THEME_COUNT][THEME_MARKS] = {{LOOK_MARKS(DARK)}, {LOOK_MARKS(LIGHT)}};
const ui_colour *theme_texts = theme_shaded;
const ui_colour *theme_surfaces = surfaces[THEME_DARK];
const ui_colour *theme_marks = marks[THEME_DARK];
const float theme_pale = 0.8F;

void theme_use(enum theme theme)
{
    theme_texts = theme == THEME_LIGHT ? light_texts : theme_shaded;
    theme_surfaces = surfaces[theme];
    theme_marks = marks[theme];
}

enum theme theme_used(void)
{
    return theme_texts == light_texts ? THEME_LIGHT : THEME_DARK;
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
