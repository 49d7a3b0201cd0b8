/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The widgets of the window: the one border to Dear ImGui, which is C++. */
#ifndef CONUS_VIEWER_UI_UI_H
#define CONUS_VIEWER_UI_UI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The colours of the window, a dark and a light theme: of texts, and of surfaces that texts stand on. Each text can
 * be read on each surface: their contrast is at least 4.5, also where a text is pale. */

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

/* The widgets of the window: the one border to Dear ImGui, which is C++. Everything here is for the thread that owns
 * the window, between ui_begin() and ui_end() where nothing else is said. Positions and sizes are pixels of the
 * window from its top left corner; colours are sRGB bytes with opacity. */

struct ui_box {
    float x, y, width, height;
};

/** Makes the widgets ready for @p window, a GLFWwindow whose GL context is current; @p scale is that of a HiDPI screen.
 * False where there is no font or no GL. */
bool ui_create(void *window, float scale);
void ui_destroy(void);
/** Another scale from the next frame on; not between ui_begin() and ui_end(). */
bool ui_set_scale(float scale);

enum ui_event_kind {
    UI_MOVE = 0, /**< To x, y.                                                */
    UI_WHEEL,    /**< By so much to the right and up.                         */
    UI_BUTTON,   /**< `code` was pressed or let go.                           */
    UI_KEY,      /**< Likewise, or goes on being held.                        */
    UI_LETTER,   /**< `code` of Unicode was typed.                            */
    UI_ENTRY,    /**< The mouse came into the window (`action`) or left it.   */
    UI_FOCUS     /**< The window got the keyboard (`action`) or lost it.      */
};

/** What mouse or keyboard did, with GLFW's numbers. */
struct ui_event {
    enum ui_event_kind kind;
    float x, y;
    int code, scancode, action, mods;
    double time; /**< By GLFW's clock, s. */
};

/** Before ui_begin(): the frame has this event of @p window, behind those that it has already. */
void ui_take(void *window, const struct ui_event *event);
/** Begins a frame of time @p now, s. */
void ui_begin(double now);
/** Draws everything into the window's framebuffer. */
void ui_end(void);

/** Whether the widgets take the whole keyboard: a text is being typed, or a list of choices is open. */
bool ui_wants_keys(void);
bool ui_lists(void); /**< A list of choices is open. */
/** Height of a line of text. */
float ui_line(void);
float ui_text_width(const char *text);
float ui_button_width(const char *label); /**< Width of a small button, and of the gap behind it. */

/* Panels: a panel's widgets come between ui_panel() and ui_panel_end(). */

/** Panels have no background, which costs time: what the framebuffer was cleared to. But those in front have. */
enum ui_panel_flag {
    UI_PLAIN = 1,    /**< No title, no padding: for pictures. */
    UI_IN_FRONT = 2, /**< Before all others.                  */
    UI_UNTITLED = 4, /**< No title,           */
    UI_NARROW = 8,   /**< half the padding beside its widgets: a rail. */
};
/** The state of a tree's node: as it was left, open at first, open now whatever it was. */
enum ui_opening { UI_AS_IT_WAS = 0, UI_OPEN_FIRST, UI_OPEN_NOW };

void ui_panel(const char *title, struct ui_box box, unsigned flags);
void ui_panel_end(void);
/** A part that scrolls by itself, @p height high (0 = the rest). */
void ui_scroll(const char *id, float height);
void ui_scroll_end(void);
/** Likewise, but so wide; the next one may stand beside it, after ui_same_line(). */
void ui_column(const char *id, float width, float height);
/** The list scrolls to where the next widget comes. */
void ui_scroll_here(void);
void ui_dim(float opacity); /**< Makes the widgets up to ui_dim_end() pale. */
void ui_dim_end(void);
void ui_disable(bool is); /**< Makes panels up to ui_disable_end() pale, and deaf to the mouse, or not. */
void ui_disable_end(void);
void ui_tint(enum theme_text colour); /**< Colours the texts up to ui_tint_end(). */
void ui_tint_end(void);
void ui_gap(float height); /**< Nothing, so high. */
/** What comes up to ui_group_end() is one widget to what follows in the same line. */
void ui_group(void);
void ui_group_end(void);
void ui_same_line(void);
void ui_same_line_at(float x); /**< The next widget x from the panel's, or column's, left edge. */
void ui_separator(void);
float ui_room_below(void);  /**< From where the next widget comes to the panel's, or the scrolled part's, lower edge. */
float ui_room(void);        /**< From where the next widget comes to the panel's right edge. */
void ui_width(float width); /**< Sets the width of the next widget. */
/** Widgets up to ui_id_end() may have the names of others. */
void ui_id(uint32_t id);
void ui_id_end(void);

void ui_text(const char *format, ...) __attribute__((format(printf, 1, 2)));
void ui_text_coloured(enum theme_text colour, const char *format, ...) __attribute__((format(printf, 2, 3)));
void ui_text_wrapped(enum theme_text colour, const char *text);
/** In large letters; in smaller ones, and then with "..." in its middle, where it is too wide. */
void ui_heading(const char *text);
/** A text over the widget before, where the mouse is on it. */
void ui_tip(const char *text);
/** In a line that has the keyboard: 1 = the arrow down was pressed, -1 = that up. */
int ui_arrow(void);
bool ui_edited(void);  /**< Whether the widget before was let go after a change. */
bool ui_hovered(void); /**< Whether the mouse is on the widget before. */

/* Tips (NULL = none) work as in ui_tip(). */
bool ui_button(const char *label, const char *tip);
bool ui_main_button(const char *label, const char *tip); /**< The one of a panel that matters most. */
/** A button that has a drawing instead of a name: polylines with a space between them, their points two letters, a to
 * q, each, which are places in a square, from its left and from its top. @p marked: what it does is on. */
bool ui_icon(const char *id, const char *strokes, float width, float height, bool marked, const char *tip);
bool ui_small_button(const char *label, const char *tip);
bool ui_check(const char *label, bool *value, const char *tip);
bool ui_choose(const char *label, size_t *index, const char *const *choices, size_t count, const char *tip);
bool ui_slider(const char *label, double *value, double low, double high, const char *format, bool logarithmic,
               const char *tip);
bool ui_count(const char *label, uint32_t *value, uint32_t low, uint32_t high, const char *tip);
bool ui_numbers(const char *label, double value[3], const char *format, const char *tip);
/** The next widget takes the keyboard if @p is_asked, which is false then. */
void ui_take_keys(bool *is_asked);
/** A line that is typed, whose old text is selected when it takes the keyboard; true when Enter was pressed in it. */
bool ui_type(const char *label, char *text, size_t size, const char *hint, const char *tip);
/** Likewise of a path; where *is_set is true it takes over what @p text is, selected from byte @p selected on. A whole
 * path that is pasted behind @p folder (ends in '/'; "" = none) takes its place. */
bool ui_type_path(const char *label, char *text, size_t size, const char *hint, const char *folder, size_t selected,
                  bool *is_set);
bool ui_escaped(void);               /**< Escape was pressed. */
void ui_chip(ui_colour colour);      /**< A small square. */
bool ui_can_write(const char *text); /**< Whether the font has all its letters; others are shown as "?". */
bool ui_row(const char *label, bool selected, float height); /**< A line that can be clicked; height 0 = a text's. */
bool ui_section(const char *label, bool open);               /**< A heading that folds what is below. */
/** One of several buttons, that which is @p shown with a line below it, over what is drawn where ui_shows_tab(). */
bool ui_tab(const char *label, bool shown, const char *tip);
bool ui_shows_tab(bool shown);
/** A node of a tree; true while it is open, to be ended by ui_tree_end(). */
bool ui_tree(const char *label, enum ui_opening opening);
void ui_tree_end(void);

void ui_cell(void); /**< The next cell of a list. */

/** A picture of that size where the next widget would be; texture 0: nothing is in its place. */
void ui_picture(uint32_t texture, float width, float height);
/** A picture, @p texture of GL, opaque. */
void ui_draw_image(uint32_t texture, struct ui_box box);
/** Likewise, but its opacity counts. */
void ui_draw_overlay(uint32_t texture, struct ui_box box);
void ui_clip(struct ui_box box); /**< Keeps drawings up to ui_clip_end() in the box. */
void ui_clip_end(void);
void ui_draw_line(const float from[2], const float to[2], ui_colour colour, float width);
void ui_draw_circle(const float centre[2], float radius, ui_colour colour, float width); /**< Width 0: filled. */
/** Fills the inside of a convex shape. */
void ui_draw_fill(float (*corners)[2], size_t count, ui_colour colour);
void ui_draw_box(struct ui_box box, ui_colour colour, float width);
/** Copies @p text to @p out [size], or its beginning with "..." where it is wider than @p width. */
void ui_shorten(char *out, size_t size, const char *text, float width);
/** Likewise with "..." in its middle: a name's end may say the side. */
void ui_shorten_name(char *out, size_t size, const char *name, float width);
/** Text with its top left corner there, in front of a dark shade. */
void ui_draw_text(const float at[2], ui_colour colour, const char *text);
/** Likewise, in large letters. */
void ui_draw_heading(const float at[2], ui_colour colour, const char *text);
/** Likewise, in letters so high, without a shade; and how wide that is. */
void ui_draw_large(const float at[2], ui_colour colour, const char *text, float height);
float ui_large_width(const char *text, float height);
/** Until ui_pop_letters() all texts, widths and lines are of large letters so high, but where those lack one of @p
 * text.
 */
void ui_push_letters(const char *text, float height);
void ui_pop_letters(void);
/** Text there on a panel, without a shade. */
void ui_draw_label(const float at[2], ui_colour colour, const char *text);

struct ui_mouse {
    float x, y, moved_x, moved_y, wheel;
    bool down[3], pressed[3], released[3]; /**< Left, right, middle. */
    bool doubled, doubled_middle;          /**< Left; middle. */
    float strayed; /**< How far it was at most, pixels, from where the left button was pressed last. */
    bool shift, control;
};

struct ui_mouse ui_mouse_now(void);
/** A surface that takes the mouse: true while the mouse is on it or was pressed on it. */
bool ui_surface(const char *id, struct ui_box box);
/** Such a surface as wide as the panel, where the next widget would be; the widget before is it. */
struct ui_box ui_area(const char *id, float height);
/** In this frame the mouse's pointer says that it can drag to the sides or, @p down, up and down. */
void ui_resize_pointer(bool down);
bool ui_surface_held(void); /**< The one before: a button is down that was pressed on it. */

/** From this frame on the arrow keys, Tab, Space and Enter go to the widgets of the panel with this title; NULL = to
 * none. Between ui_begin() and ui_end(). False: there is no such panel yet. */
bool ui_navigate(const char *title);
/** Before ui_begin(): those keys go to an open list of choices in any case, and to the panel only where they did. */
void ui_navigate_lists(bool also_panels);
bool ui_navigates(void);
/** Whether Escape is for the widgets: a choice or a list that was entered, a number that is typed. */
bool ui_navigates_deep(void);

/* Widgets of long lists with columns. */

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
