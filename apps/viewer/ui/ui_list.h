/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Widgets of long lists with columns, beside those of ui.h, whose rules hold. */
#ifndef CONUS_VIEWER_UI_UI_LIST_H
#define CONUS_VIEWER_UI_UI_LIST_H

#include "viewer/ui/ui.h"

#ifdef __cplusplus
extern "C" {
#endif

float ui_list_line(void); /**< Height of a row of a list. */
/** A list of @p count columns, the first of which is at least so wide, and takes what the others leave. Where they
 * leave less, the list scrolls to the side below it. False: nothing of it is to be drawn, and it is not to be ended. */
bool ui_list(const char *id, const float *widths, size_t count, float height);
/** Narrows the first column, of names, and counts fewer columns, but @p least, where the list would scroll to the side.
 */
size_t ui_list_fit(float *widths, size_t count, size_t least);
void ui_list_end(void);
/** The row of headings; then, for each column, a heading, at its @p right or left; true when it was pressed. */
void ui_list_top(void);
bool ui_list_heading(const char *text, bool right);
/** Such a list with headings that are not pressed. */
bool ui_table(const char *id, const char *const *headings, const float *widths, size_t count, float height);
/** The next row, and its first cell. False where it lies so far out of sight that nothing need be drawn in it. */
bool ui_list_row(void);
void ui_text_right(const char *text); /**< It ends at the cell's right edge. */
/** A line under the cell's text, as long as the part of the cell's width. */
void ui_underline(double part, ui_colour colour);
/** A line of a list that can be pressed, as ui_name_cut() shows it; what is cut is whole in its tip, with @p tip. */
bool ui_row_cut(const char *label, bool selected, const char *tip);

/** A text that ends in "..." where it is wider than @p width; then its tip has it whole. */
void ui_text_cut(const char *text, float width);
/** A name with "..." in its middle where it is wider than that: its end may say the side. Likewise. */
void ui_name_cut(const char *name, float width);
/** The following texts stand in so many columns, filled from ui_next_column() to the next; 1 ends them. */
void ui_columns(size_t count);
void ui_next_column(void);

/** A button that opens what comes up to ui_popup_end(), if it is true, over the window. */
bool ui_popup(const char *label);
void ui_popup_end(void);
void ui_popup_close(void); /**< It is over with this frame. */
/** The next widget, a button with this label, stands in the same line where it fits, else below. */
void ui_flow(const char *label);

#ifdef __cplusplus
}
#endif

#endif
