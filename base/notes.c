/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of lines of advice. */
#include "base/notes.h"

#include "base/memory.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void notes_finish(struct notes *notes)
{
    for (size_t i = 0; i < notes->count; i++) {
        memory_free(notes->lines[i]);
    }
    memory_free(notes->lines);
    *notes = (struct notes){0};
}

static conus_status reserve_line(struct notes *notes, size_t more)
{
    char **lines = memory_resize(notes->lines, notes->count + more, sizeof *lines);
    if (!lines) {
        return CONUS_ERROR_MEMORY;
    }
    notes->lines = lines;
    return CONUS_OK;
}

conus_status notes_add(struct notes *notes, const char *format, ...)
{
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    text_make_plain(text, "");
    char *line = memory_text(text, strlen(text));
    if (!line || reserve_line(notes, 1)) {
        memory_free(line);
        return CONUS_ERROR_MEMORY;
    }
    notes->lines[notes->count++] = line;
    return CONUS_OK;
}

void notes_cut(struct notes *notes, size_t count)
{
    while (notes->count > count) {
        memory_free(notes->lines[--notes->count]);
    }
}

conus_status notes_move(struct notes *notes, struct notes *from)
{
    if (reserve_line(notes, from->count + 1)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < from->count; i++) {
        notes->lines[notes->count++] = from->lines[i];
    }
    memory_free(from->lines);
    *from = (struct notes){0};
    return CONUS_OK;
}
