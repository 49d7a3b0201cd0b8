/* SPDX-License-Identifier: BSD-3-Clause */
/** @file For tests: which texts of the newest frame could not be read whole. */
#ifndef CONUS_TESTS_APPS_UI_AUDIT_H
#define CONUS_TESTS_APPS_UI_AUDIT_H

#include "viewer/ui/ui.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Widgets without a screen: nothing is drawn, and frames are so large. False where there is no font. They end with
 * ui_destroy(). From now on texts are looked at. */
bool ui_audit_create(float scale, float width, float height);
/** Begins and ends a frame of them. */
void ui_audit_begin(void);
void ui_audit_end(void);
/** A text that lay partly beside its panel, cell, or field, at its left or right; NULL = no more. Names of areas that
 * ui_row_cut() cuts are none. Until the next frame. */
const char *ui_audit_cut(size_t index);
/** A button, line, slider or choice without a tip; likewise. */
const char *ui_audit_untold(size_t index);
/** How many texts were looked at. */
size_t ui_audit_count(void);
/** Which of them, from 0, this one was first; SIZE_MAX = it was none. */
size_t ui_audit_place(const char *text);
/** Where its upper left corner was; false: it was none. */
bool ui_audit_at(float at[2], const char *text);
/** A colour of the style, and its name in Dear ImGui; false = no more. */
bool ui_audit_colour(ui_colour *out, const char **name, size_t index);

/** As viewer/ui/parts.h has them, for C++. */
float push_heading(const char *text);
void pop_heading(void);

#ifdef __cplusplus
}
#endif

#endif
