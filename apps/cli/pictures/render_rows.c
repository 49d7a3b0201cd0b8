/* SPDX-License-Identifier: BSD-3-Clause */
/* Chooses the poses that are drawn, and gives each picture a name of its own. */
#include "cli/pictures/render_rows.h"

#include "options/messages.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_LIMIT = 200 }; /* bytes of a row's name in that of a file */

static const char QUERY[] = "{query}";
static const char ROW[] = "{row}";

static int print_no_memory(void)
{
    print_error_line("not enough memory");
    return EXIT_DATA;
}

static bool begins(const char *text, const char *word)
{
    return strncmp(text, word, strlen(word)) == 0;
}

bool render_pattern_check(const char *pattern)
{
    for (const char *at = strchr(pattern, '{'); at; at = strchr(at + 1, '{')) {
        if (!begins(at, QUERY) && !begins(at, ROW)) {
            const char *end = strchr(at, '}');
            int length = end ? (int)(end - at + 1) : (int)strlen(at);
            print_error_line("--output: \"%.*s\" stands for nothing, allowed are %s and %s", length, at, QUERY, ROW);
            return false;
        }
    }
    return true;
}

bool render_pattern_varies(const char *pattern)
{
    return strstr(pattern, QUERY) || strstr(pattern, ROW);
}

/* No more of UTF-8 than fits, and no half of a character. */
static size_t safe_length(const char *id)
{
    size_t length = strnlen(id, NAME_LIMIT);
    while (length && id[length] && ((unsigned char)id[length] & 0xC0) == 0x80) {
        length--;
    }
    return length;
}

/* What separates folders, what some system does not allow in a name, and a first dot become "_". */
static void write_safe(FILE *out, const char *id)
{
    size_t length = safe_length(id);
    for (size_t i = 0; i < length; i++) {
        bool unsafe = (unsigned char)id[i] < ' ' || id[i] == '\x7f' || strchr("/\\:*?\"<>|", id[i]) ||
                      (i == 0 && (id[i] == '.' || id[i] == '-'));
        fputc(unsafe ? '_' : id[i], out);
    }
    if (!length) {
        fputc('_', out);
    }
}

/* The name of one picture; NULL without memory. */
static char *format_path(const char *pattern, size_t number, const char *id)
{
    char *path = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&path, &size);
    if (!out) {
        return NULL;
    }
    while (*pattern) {
        if (begins(pattern, QUERY)) {
            write_safe(out, id);
            pattern += strlen(QUERY);
        } else if (begins(pattern, ROW)) {
            fprintf(out, "%zu", number);
            pattern += strlen(ROW);
        } else {
            fputc(*pattern++, out);
        }
    }
    if (fclose(out)) {
        free(path);
        return NULL;
    }
    return path;
}

static int compare_paths(const void *a, const void *b)
{
    const struct drawn_row *one = a;
    const struct drawn_row *other = b;
    int order = strcmp(one->path ? one->path : "", other->path ? other->path : "");
    return order ? order : (one->row->line > other->row->line) - (one->row->line < other->row->line);
}

static int check_clashes(const struct drawn_rows *rows)
{
    struct drawn_row *sorted = calloc(rows->count + 1, sizeof *sorted);
    int code = sorted ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; sorted && i < rows->count; i++) {
        sorted[i] = rows->items[i];
    }
    if (sorted) {
        qsort(sorted, rows->count, sizeof *sorted, compare_paths);
    }
    for (size_t i = 1; i < rows->count && !code; i++) {
        const char *path = sorted[i].path;
        if (path && sorted[i - 1].path && strcmp(path, sorted[i - 1].path) == 0) {
            code = print_usage_error("%s: the poses in lines %zu and %zu would both be drawn into %s; %s in --output's "
                                     "name tells them apart",
                                     rows->file, sorted[i - 1].row->line, sorted[i].row->line, path, ROW);
        }
    }
    free(sorted);
    return code;
}

static bool is_chosen(const conus_pose_row *row, size_t number, const struct row_choice *choice)
{
    return (!choice->number || choice->number == number) && (!choice->id || strcmp(choice->id, row->id) == 0);
}

static const char *name_at(const void *list, size_t index)
{
    const conus_pose_row *row = conus_pose_list_row(list, index);
    return row ? row->id : NULL;
}

/* The name of which @p id is the part behind the last "/", as in target/M1; NULL if there is none. */
static const char *name_behind(const conus_pose_list *list, const char *id)
{
    const char *found = NULL;
    for (size_t i = 0; !found && i < conus_pose_list_count(list); i++) {
        const char *name = conus_pose_list_row(list, i)->id;
        const char *slash = strrchr(name, '/');
        found = slash && strcmp(slash + 1, id) == 0 ? name : NULL;
    }
    return found;
}

static int refuse_choice(const struct drawn_rows *rows, const conus_pose_list *list, const struct row_choice *choice)
{
    size_t count = conus_pose_list_count(list);
    if (choice->number) {
        return print_usage_error("--row %" PRIu32 ": %s has %zu poses", choice->number, rows->file, count);
    }
    const char *close = name_behind(list, choice->id);
    close = close ? close : closest_name(choice->id, name_at, list);
    return print_usage_error("--query-id: %s has no pose \"%s\"%s%s%s", rows->file, choice->id,
                             close ? ", did you mean \"" : "", close ? close : "", close ? "\"?" : "");
}

static int check_count(const struct drawn_rows *rows, const conus_pose_list *list, const struct row_choice *choice,
                       const char *pattern)
{
    if (!rows->count && (choice->number || choice->id)) {
        return refuse_choice(rows, list, choice);
    }
    if (rows->count == 1 || render_pattern_varies(pattern)) {
        return EXIT_DONE;
    }
    return print_usage_error("%s has %zu poses, a picture takes one%s", rows->file, rows->count,
                             rows->count ? ": --output needs {query} or {row} in its name, or --row N or --query-id "
                                           "NAME chooses one"
                                         : "");
}

int render_rows_choose(struct drawn_rows *out, const conus_pose_list *list, const struct row_choice *choice,
                       const char *pattern)
{
    size_t count = conus_pose_list_count(list);
    out->items = calloc(count + 1, sizeof *out->items);
    for (size_t i = 0; out->items && i < count; i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        if (is_chosen(row, i + 1, choice)) {
            struct drawn_row *drawn = &out->items[out->count++];
            drawn->row = row;
            drawn->path = row->error ? NULL : format_path(pattern, i + 1, row->id);
            if (!drawn->path && !row->error) {
                return print_no_memory();
            }
        }
    }
    int code = out->items ? check_count(out, list, choice, pattern) : print_no_memory();
    return code ? code : check_clashes(out);
}

void render_rows_finish(struct drawn_rows *rows)
{
    for (size_t i = 0; i < rows->count; i++) {
        free(rows->items[i].path);
    }
    free(rows->items);
    *rows = (struct drawn_rows){0};
}
