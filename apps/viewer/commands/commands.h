/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What drives the window from a keyboard or a file: keys and scripts. */
#ifndef CONUS_VIEWER_COMMANDS_COMMANDS_H
#define CONUS_VIEWER_COMMANDS_COMMANDS_H

#include "viewer/session/property.h"
#include "viewer/window/window.h"

#include <stdbool.h>
#include <stddef.h>

/* The keys of the window and what they do. */

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

/* Scripts that drive the window, one command a line, for tests and figures (docs/viewer.md lists them). */

struct script;

/** Reads a script; returns the exit code and prints an error unless it is 0. */
int script_load(struct script **out, const char *path);
void script_destroy(struct script *script); /**< NULL is fine. */

/** Whether it waits for something that takes no frames: a file, a time, pictures being drawn. */
bool script_waits(struct script *script, const struct window *window);
/** Does the next command, unless the script waits. To be called after a frame was drawn and before it is shown. True
 * when none is left or one failed; then *code is set, and a failure has been printed. */
bool script_step(struct script *script, struct window *window, int *code);

/** Does one command that waits for nothing; @p words, [count], are its name and arguments. False: it is not done. */
bool script_do(struct window *window, char *const *words, size_t count);
/** The name of a command, and what it takes; NULL = no more. */
const char *script_command_name(const char **arguments, size_t index);

/* The words of a line of a script. */

enum { SCRIPT_WORDS = 9 /**< A command and its arguments. */ };

/** Cuts @p line into words, its pieces, by spaces; "in quotes" is one, # begins a comment. False: too many. */
bool script_split(char *words[SCRIPT_WORDS], size_t *count, char *line);
/** A finite number, and nothing else. */
bool script_number(double *out, const char *word);

/* What the newest frame shows, as numbers of answers, for scripts. */

/** Writes the viewer's numbers (`is`), and those of each place that the frame has: `list`, `labels`, `status`,
 * `picture`; `colours` is the sum of the answer, and `cuts` are those of the answers that they were drawn for. False:
 * it cannot be written. */
bool state_write(const struct window *window, const char *path);

#endif
