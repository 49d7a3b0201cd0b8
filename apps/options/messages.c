/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints error lines, maps statuses to exit codes, and suggests names for misspelt words. */
#include "options/messages.h"

#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/options.h"

#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 2048, WORD_SIZE = 64 };

/* The thread's newest. */
static _Thread_local char said[LINE_SIZE];
static _Thread_local unsigned holds;
static _Thread_local bool is_unfinished;

/* The thread's notes and warnings, which its answers say, too: [whether they warn]. */
static _Thread_local struct lines {
    char **items;
    size_t count;
} kept[2];

void make_plain_line(char *text)
{
    for (char *c = text; (c = strpbrk(c, "\n\t"));) {
        *c = ' ';
    }
    conus_plain_text(text);
}

void message_drop_quotes(char *line)
{
    char *first = strpbrk(line, "\"<");
    char *last = first;
    bool is_open = false;
    for (char *mark = first; mark; mark = strpbrk(mark + 1, "\"<>")) {
        is_open = *mark == '<' || (*mark == '"' && !is_open);
        last = mark;
    }
    if (first) {
        last = is_open ? last + strlen(last) : last;
        memmove(first + 1, last, strlen(last) + 1);
    }
}

/* The word by which a line begins that is no error; "" where it is one. */
static const char *severity_word(const char *line)
{
    static const char *const words[] = {"note:", "warning:"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strncmp(line, words[i], strlen(words[i])) == 0) {
            return words[i];
        }
    }
    return "";
}

/* On a terminal with colours notes and warnings differ from errors by their words. */
static void print_error_list(const char *format, va_list args)
{
    vsnprintf(said, sizeof said, format, args);
    make_plain_line(said);
    if (!holds) {
        const char *word = severity_word(said);
        const char *form = !terminal_has_colour(STDERR_FILENO) ? "conus: %s%s\n"
                           : *word == 'w'                      ? "conus: \033[1;31m%s\033[0m%s\n"
                           : *word                             ? "conus: \033[33m%s\033[0m%s\n"
                                                               : "\033[1mconus:\033[0m %s%s\n";
        fputs(is_unfinished ? "\r\033[K" : "", stderr);
        is_unfinished = false;
        fprintf(stderr, form, word, said + strlen(word));
    }
}

/* Without memory it is printed all the same. False where it is known. */
static bool keep(struct lines *lines, const char *line)
{
    for (size_t i = 0; i < lines->count; i++) {
        if (strcmp(lines->items[i], line) == 0) {
            return false;
        }
    }
    char **more = realloc(lines->items, (lines->count + 1) * sizeof *more);
    char *copy = more ? strdup(line) : NULL;
    lines->items = more ? more : lines->items;
    if (copy) {
        lines->items[lines->count++] = copy;
    }
    return true;
}

void say_note(conus_severity severity, bool quiet, const char *format, ...)
{
    char line[LINE_SIZE];
    bool warns = severity >= CONUS_SEVERITY_WARNING;
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    make_plain_line(line);
    if ((warns || !quiet) && (keep(&kept[warns], line) || !warns)) {
        print_error_line("%s: %s", warns ? "warning" : "note", line);
    }
}

const char *warning_line(size_t index)
{
    return index < kept[true].count ? kept[true].items[index] : NULL;
}

const char *note_line(size_t index)
{
    return index < kept[false].count ? kept[false].items[index] : NULL;
}

static void forget(struct lines *lines, size_t first)
{
    while (lines->count > first) {
        free(lines->items[--lines->count]);
    }
    if (!lines->count) {
        free(lines->items);
        *lines = (struct lines){0};
    }
}

void warnings_forget(size_t first)
{
    forget(&kept[true], first);
    if (!first) {
        forget(&kept[false], 0);
    }
}

void messages_unfinished(bool is)
{
    is_unfinished = is;
}

void messages_hold(bool held)
{
    holds = held ? holds + 1 : holds - 1;
}

const char *error_line(void)
{
    return said;
}

void print_error_line(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print_error_list(format, args);
    va_end(args);
}

int print_no_memory(void)
{
    return print_data_error("not enough memory");
}

int print_usage_error(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print_error_list(format, args);
    va_end(args);
    return EXIT_USAGE;
}

int print_system_error(const char *path, const char *action)
{
    return print_data_error("%s: cannot %s: %s", path, action, text_error(errno));
}

int exit_code_of(conus_status status)
{
    switch (status) {
    case CONUS_OK:
        return EXIT_DONE;
    case CONUS_ERROR_ARGUMENT:
        return EXIT_USAGE;
    case CONUS_ERROR_GL:
        return EXIT_NO_GL;
    default:
        return EXIT_DATA;
    }
}

int print_status(conus_status status)
{
    if (status) {
        print_error_line("%s", conus_message());
    }
    return exit_code_of(status);
}

void log_line(void *user, const conus_note *note)
{
    (void)user;
    print_error_line("log: %s", note->line);
}

void log_note(void *user, const conus_note *note)
{
    (void)user;
    say_note(note->severity, false, "%s", note->line);
}

void log_note_quiet(void *user, const conus_note *note)
{
    (void)user;
    say_note(note->severity, true, "%s", note->line);
}

/* Insertions, deletions and replacements that turn a into b (Levenshtein 1966), by rows. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[WORD_SIZE + 1];
    size_t width = strlen(b);
    if (width > WORD_SIZE || strlen(a) > WORD_SIZE) {
        return WORD_SIZE;
    }
    for (size_t j = 0; j <= width; j++) {
        row[j] = j;
    }
    for (size_t i = 0; a[i]; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < width; j++) {
            size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            size_t least = diagonal < row[j] ? diagonal + 1 : row[j] + 1; /* deleted or inserted */
            row[j + 1] = replaced < least ? replaced : least;
        }
    }
    return row[width];
}

const char *closest_name(const char *word, const char *(*name_at)(const void *list, size_t index), const void *list)
{
    const char *best = NULL;
    size_t least = SIZE_MAX;
    size_t length = strlen(word);
    const char *name;
    for (size_t i = 0; (name = name_at(list, i)); i++) {
        size_t distance = edit_distance(word, name);
        /* An abbreviated name is near, however long it is. */
        bool is_near = distance <= (length + 1) / 3 || (length >= 2 && strncmp(word, name, length) == 0);
        if (distance < least && is_near) {
            least = distance;
            best = name;
        }
    }
    return best;
}
