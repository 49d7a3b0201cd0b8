/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Scripts that drive the window, one command a line, for tests and figures (docs/viewer.md lists them). */
#ifndef CONUS_VIEWER_COMMANDS_SCRIPT_H
#define CONUS_VIEWER_COMMANDS_SCRIPT_H

#include "viewer/window/window.h"

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

#endif
