/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The keys of the window and what they do. */
#ifndef CONUS_VIEWER_COMMANDS_KEYS_H
#define CONUS_VIEWER_COMMANDS_KEYS_H

#include "viewer/session/property.h"

struct key {
    const char *key;                    /**< As window->press gets it. */
    const char *help;                   /**< What it does, for the help; NULL: another row says it. */
    void (*act)(struct window *window); /**< Without any of these it sets the next value of a property. */
    void (*view)(struct viewer *viewer);
    void (*tool)(struct viewer *viewer, enum tool_number number); /**< The tool is by[0]. */
    void (*step)(struct window *window, int by);                  /**< By by[0]. */
    void (*move)(struct window *window, const int by[3]);
    int by[3];
    enum property_id sets; /**< Row of the state's table (0 = none), also where it acts: its tip names the key. */
    const char *shown;     /**< How the list calls it, with those of the next rows; NULL = as it is. */
    bool is_anywhere;      /**< It needs no atlas. */
    bool is_of_wand;       /**< It is one only where a tool is moved as a wand. */
    bool ends_column;      /**< The last key in its column of the list. */
    const char *group;     /**< A heading before it; NULL = it goes on with the group before. */
};

/** The rows of the table of keys; NULL = no more. */
const struct key *keys_row(size_t index);
/** How the list calls a key: "Ctrl+O". */
const char *keys_shown(char out[KEY_LIMIT], const struct key *key);
enum { KEYS_TIP = 512 };
/** Says what a property is and which keys change it. */
const char *keys_tip(char out[KEYS_TIP], enum property_id id);

/** Does what a key does, for window->press; false if it means nothing. */
bool keys_press(struct window *window, const char *key);

/** Draws the list of keys over the window. */
void keys_draw_help(struct window *window);

#endif
