/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the widgets' files share, and what tests learn of widgets. */
#ifndef CONUS_VIEWER_UI_PARTS_H
#define CONUS_VIEWER_UI_PARTS_H

#include "viewer/ui/ui.h"

#include <imgui.h>

/** Goes on in the font of headings or, for a text with letters that it lacks, in that of texts, enlarged by what is
 * returned. Until pop_heading(). */
extern "C" float push_heading(const char *text);
extern "C" void pop_heading(void);

/** Loads the font for @p scale, and sets sizes and the theme's colours. False where there is no font. */
bool ui_style(float scale);

/** What a test (tests/apps/ui_audit.cpp) records: a widget that is as wide as its text, one that people use, the tip
 * of the widget before, and a text within something so wide. */
enum audit_event { AUDIT_ITEM, AUDIT_WIDGET, AUDIT_TIP, AUDIT_WITHIN };
struct audit_listener {
    void (*report)(audit_event event, const char *text, float room);
};

/** Whether a test records: then all sections are open. */
inline bool audit_runs(void)
{
    return ImGui::GetIO().UserData;
}

inline void audit(audit_event event, const char *text, float room = 0)
{
    if (audit_runs()) {
        static_cast<const audit_listener *>(ImGui::GetIO().UserData)->report(event, text, room);
    }
}

#endif
