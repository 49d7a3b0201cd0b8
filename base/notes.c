/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of lines of advice. */
#include "base/status.h"

#include "base/memory.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void free_lines(struct notes *notes)
{
    memory_free(notes->lines);
    memory_free(notes->marks);
    *notes = (struct notes){.sink = notes->sink};
}

void notes_finish(struct notes *notes)
{
    notes_cut(notes, 0);
    free_lines(notes);
}

static conus_status reserve_lines(struct notes *notes, size_t more)
{
    char **lines = memory_resize(notes->lines, notes->count + more, sizeof *lines);
    notes->lines = lines ? lines : notes->lines;
    struct note_mark *marks = lines ? memory_resize(notes->marks, notes->count + more, sizeof *marks) : NULL;
    notes->marks = marks ? marks : notes->marks;
    return marks ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static void tell_line(struct notes *notes, size_t index)
{
    const struct note_sink *sink = notes->sink;
    struct note_mark *mark = &notes->marks[index];
    if (sink && sink->log && !mark->is_passed) {
        sink->log(sink->user, &(const conus_note){mark->severity, sink->path, notes->lines[index]});
    }
    mark->is_passed = mark->is_passed || sink;
}

void notes_tell(struct notes *notes)
{
    for (size_t i = 0; i < notes->count; i++) {
        tell_line(notes, i);
    }
}

/* Appends a line, which is taken over and for which there is space. */
static void append_line(struct notes *notes, char *line, struct note_mark mark)
{
    notes->lines[notes->count] = line;
    notes->marks[notes->count] = mark;
    tell_line(notes, notes->count++);
}

conus_status notes_put(struct notes *notes, conus_severity severity, const char *format, ...)
{
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    text_make_plain(text, "");
    char *line = memory_text(text, strlen(text));
    if (!line || reserve_lines(notes, 1)) {
        memory_free(line);
        return CONUS_ERROR_MEMORY;
    }
    append_line(notes, line, (struct note_mark){.severity = severity});
    return CONUS_OK;
}

conus_severity notes_severity(const struct notes *notes, size_t index)
{
    return index < notes->count ? notes->marks[index].severity : CONUS_SEVERITY_NOTE;
}

void notes_cut(struct notes *notes, size_t count)
{
    while (notes->count > count) {
        memory_free(notes->lines[--notes->count]);
    }
}

conus_status notes_move(struct notes *notes, struct notes *from)
{
    if (reserve_lines(notes, from->count + 1)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < from->count; i++) {
        append_line(notes, from->lines[i], from->marks[i]);
    }
    free_lines(from);
    return CONUS_OK;
}

conus_status notes_move_in(struct notes *notes, struct notes *from, const char *where)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < from->count; i++) {
        status = notes_put(notes, from->marks[i].severity, "%s: %s", where, from->lines[i]);
    }
    notes_finish(from);
    return status;
}
