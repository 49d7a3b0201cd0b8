/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Messages on stderr, one line each, and the exit codes that go with them (docs/commands.md). */
#ifndef CONUS_OPTIONS_MESSAGES_H
#define CONUS_OPTIONS_MESSAGES_H

#include "conus/status.h"

#include <stdbool.h>
#include <stddef.h>

enum exit_code {
    EXIT_DONE = 0,
    EXIT_DIFFERENT = 1, /**< Some queries failed, or the two things compared differ. */
    EXIT_USAGE = 2,
    EXIT_DATA = 3,  /**< Bad input, a refusing system, too little memory. */
    EXIT_NO_GL = 4, /**< No usable OpenGL for what was asked. */
};

/** Writes "conus: " and the line to stderr; control characters become spaces. */
void print_error_line(const char *format, ...) __attribute__((format(printf, 1, 2)));

/** Prints "note: " and the line, unless @p quiet; a warning as "warning: ", and once. A thread's notes and warnings are
 * kept, so that its answers can say them. */
void say_note(conus_severity severity, bool quiet, const char *format, ...) __attribute__((format(printf, 3, 4)));
#define say_warning(...) say_note(CONUS_SEVERITY_WARNING, false, __VA_ARGS__)

/** Warning, or note that was printed, @p index of this thread, from 0; NULL past the last. */
const char *warning_line(size_t index);
const char *note_line(size_t index);
/** Forgets the thread's warnings from @p first on, with 0 the notes, too: what follows is about other files. */
void warnings_forget(size_t first);

/** Whether the terminal's last line is unfinished, as that of a progress is: a message takes its place. */
void messages_unfinished(bool is);

/** While lines are held, this thread prints none; error_line() has the last one. Each hold has an end, and may lie
 * within another. */
void messages_hold(bool held);

/** The line that this thread wrote last, without "conus: "; "" before the first. It lasts until the thread writes
 * another. */
const char *error_line(void);

/** Makes a text harmless for whatever shows it, in place: one line, without control characters. */
void make_plain_line(char *text);

/** Leaves out, in place, what stands from the first to the last quotation mark, or mark of XML: words of files, which
 * may be of somebody else and hold such marks. */
void message_drop_quotes(char *line);

/** print_error_line(), and EXIT_USAGE. */
int print_usage_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/** The same, and EXIT_DATA. */
#define print_data_error(...) (print_error_line(__VA_ARGS__), EXIT_DATA)

/** The same, and false. */
#define refuse(...) (print_error_line(__VA_ARGS__), false)

/** Prints that there is not enough memory. Gives EXIT_DATA. */
int print_no_memory(void);

/** print_error_line() with the library's message about @p status, unless that is CONUS_OK, and the exit code that goes
 * with it. */
int print_status(conus_status status);

/** print_error_line() of a line about @p status, which is an error, and the exit code that goes with it. */
#define print_status_line(status, ...) (print_error_line(__VA_ARGS__), exit_code_of(status))

/** Prints that @p action ("read") failed on the file @p path, with the reason in errno. Gives EXIT_DATA. */
int print_system_error(const char *path, const char *action);

/** The exit code that goes with @p status. */
int exit_code_of(conus_status status);

/** A conus_log that writes what a driver says to stderr. */
void log_line(void *user, const conus_note *note);

/** A conus_log that says notes and warnings, and one that says only what looks wrong, as --quiet does. */
void log_note(void *user, const conus_note *note);
void log_note_quiet(void *user, const conus_note *note);

/** The name, among those that @p name_at lists up to its NULL, that @p word was most likely meant to be; NULL if none
 * is close. */
const char *closest_name(const char *word, const char *(*name_at)(const void *list, size_t index), const void *list);

#endif
