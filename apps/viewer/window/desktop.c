/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the XDG Desktop Portal, which GNOME, KDE and others answer: its color-scheme is 0 = no preference, which is how
 * GNOME is light, 1 = dark, 2 = light. */
#include "viewer/window/desktop.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
