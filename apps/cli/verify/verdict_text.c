/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a verdict for people and for programs. */
#include "cli/verify/verdict.h"
#include "options/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const kinds[] = {"identical", "different", "not verified"};

static void put_lines(FILE *out, const char *before, const struct lines *lines)
{
    for (size_t i = 0; i < lines->count; i++) {
        fprintf(out, "  %s: %s\n", before, lines->items[i]);
    }
    if (lines->more) {
        fprintf(out, "  %s: and %zu more\n", before, lines->more);
    }
}

static const char *shown(const char *text)
{
    return text ? text + strspn(text, " ") : "nothing";
}

static void put_differences(FILE *out, const struct differences *found)
{
    for (size_t i = 0; i < found->listed; i++) {
        const struct difference *item = &found->items[i];
        fprintf(out, "  line %zu%s%s: %s, answered again: %s\n", item->line, *item->where ? ", " : "", item->where,
                shown(item->before), shown(item->after));
    }
    if (found->count) {
        fprintf(out, "  %zu of %zu lines differ\n", found->count, found->lines);
    }
}

static void put_files(FILE *out, const struct verdict *verdict)
{
    size_t same = 0;
    size_t count = verdict->record.input_count;
    for (size_t i = 0; i < count; i++) {
        same += verdict->found[i].state == FILE_SAME || verdict->found[i].state == FILE_MOVED;
    }
    fprintf(out, "  answered again from %zu file%s, %zu with the SHA-256 in %s\n", count, count == 1 ? "" : "s", same,
            verdict->sidecar);
}

char *verdict_text(const struct verdict *verdict)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) {
        return NULL;
    }
    bool rows_only = verdict->kind == VERDICT_DIFFERENT && verdict->same;
    fprintf(out, "%s: %s%s\n", verdict->result, kinds[verdict->kind],
            rows_only ? ": it is answered the same again, but not all else is as it was" : "");
    put_files(out, verdict);
    put_differences(out, &verdict->differences);
    put_lines(out, "why", &verdict->why);
    put_lines(out, "note", &verdict->notes);
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    conus_plain_text(text);
    return text;
}

void verdict_print_error(const struct verdict *verdict)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    for (size_t i = 0; out && i < verdict->why.count; i++) {
        fprintf(out, "%s%s", i ? "; " : "", verdict->why.items[i]);
    }
    bool written = out && !fclose(out);
    print_error_line("%s: cannot be verified: %s", verdict->result, written ? text : "not enough memory");
    free(text);
}

/* Bytes that are no UTF-8 become null. */
static json_t *json_from_text(const char *text)
{
    json_t *string = text ? json_string(text) : NULL;
    return string ? string : json_null();
}

static json_t *json_from_lines(const struct lines *lines)
{
    json_t *list = json_array();
    for (size_t i = 0; i < lines->count; i++) {
        json_array_append_new(list, json_from_text(lines->items[i]));
    }
    return list;
}

static json_t *json_from_differences(const struct differences *found)
{
    json_t *list = json_array();
    for (size_t i = 0; i < found->listed; i++) {
        const struct difference *item = &found->items[i];
        json_array_append_new(list, json_pack("{s: I, s: o, s: o, s: o}", "line", (json_int_t)item->line, "where",
                                              json_from_text(item->where), "recorded", json_from_text(item->before),
                                              "again", json_from_text(item->after)));
    }
    return list;
}

static json_t *json_from_files(const struct verdict *verdict)
{
    json_t *list = json_array();
    for (size_t i = 0; verdict->found && i < verdict->record.input_count; i++) {
        const struct recorded_file *file = &verdict->record.inputs[i];
        json_array_append_new(list,
                              json_pack("{s: s, s: o, s: o, s: s}", "path", file->path, "sha256",
                                        json_from_text(file->sha256), "found", json_from_text(verdict->found[i].path),
                                        "state", file_state_names[verdict->found[i].state]));
    }
    return list;
}

char *verdict_json(const struct verdict *verdict)
{
    json_t *root =
        json_pack("{s: o, s: o, s: s, s: b, s: o, s: o, s: I, s: o, s: o}", "result", json_from_text(verdict->result),
                  "sidecar", json_from_text(verdict->sidecar), "verdict", kinds[verdict->kind], "same_rows",
                  verdict->compared && verdict->same, "why", json_from_lines(&verdict->why), "notes",
                  json_from_lines(&verdict->notes), "lines_that_differ", (json_int_t)verdict->differences.count,
                  "differences", json_from_differences(&verdict->differences), "files", json_from_files(verdict));
    char *dumped = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    char *text = NULL;
    if (dumped && asprintf(&text, "%s\n", dumped) < 0) {
        text = NULL;
    }
    free(dumped);
    json_decref(root);
    return text;
}
