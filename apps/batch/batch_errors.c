/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the poses without an answer in a file of rows of any format. */
#include "batch/batch_errors.h"

#include "options/input_file.h"
#include "options/messages.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The cell behind the first one of `line`, which may stand in quotation marks if it is separated by a comma. */
static const char *next_cell(const char *line, char separator)
{
    bool quoted = separator == ',' && *line == '"';
    for (line += quoted; *line && (quoted || *line != separator); line++) {
        quoted = quoted != (*line == '"' && separator == ','); /* doubled ones close it and open it again */
    }
    return *line ? line + 1 : line;
}

static bool is_error_cell(const char *cell, char separator)
{
    static const char kind[] = "error";
    return strncmp(cell, kind, sizeof kind - 1) == 0 && cell[sizeof kind - 1] == separator;
}

/* How errors look in a file. */
struct form {
    bool (*is_error)(const struct form *form, const char *line);
    char separator; /* of a table, */
    size_t kind;    /* and the number of its column of that name, from 0 */
};

static bool in_table(const struct form *form, const char *line)
{
    for (size_t i = 0; i < form->kind; i++) {
        line = next_cell(line, form->separator);
    }
    return is_error_cell(line, form->separator);
}

static bool in_ndjson(const struct form *form, const char *line)
{
    (void)form;
    return strstr(line, "\"kind\":\"error\""); /* marks inside of texts have a backslash before them */
}

static bool in_afni(const struct form *form, const char *line)
{
    (void)form;
    return strncmp(line, "***** ", 6) == 0 && strncmp(line, "***** Not near any region", 25) != 0;
}

/* The last column is area_error. */
static bool in_bids(const struct form *form, const char *line)
{
    (void)form;
    const char *tab = strrchr(line, '\t');
    return tab && strcmp(tab, "\tarea_error\n") != 0 && strcmp(tab, "\tn/a\n") != 0;
}

/* Of a table whose header row begins with the column query. */
static struct form form_of_table(const char *header)
{
    struct form form = {.is_error = in_table, .separator = header[strlen("query")]};
    const char name[] = {'k', 'i', 'n', 'd', form.separator, '\0'};
    for (const char *cell = header; *cell && strncmp(cell, name, sizeof name - 1) != 0; form.kind++) {
        cell = next_cell(cell, form.separator);
    }
    return form;
}

/* Of a file with this first line. */
static struct form form_after(const char *first)
{
    bool is_table = strncmp(first, "query\t", 6) == 0 || strncmp(first, "query,", 6) == 0;
    return is_table ? form_of_table(first)
                    : (struct form){.is_error = *first == '{'                        ? in_ndjson
                                                : strncmp(first, "+++++++ ", 8) == 0 ? in_afni
                                                                                     : in_bids};
}

bool batch_errors_count(uint64_t *errors, const char *path)
{
    char *line = NULL;
    size_t capacity = 0;
    struct form form = {0};
    FILE *file = input_file_open(path);
    if (!file) {
        return false;
    }
    for (*errors = 0; getline(&line, &capacity, file) > 0;) {
        form = form.is_error ? form : form_after(line);
        *errors += form.is_error(&form, line);
    }
    bool whole = feof(file) && !ferror(file);
    if (!whole) {
        print_system_error(path, "read");
    }
    free(line);
    fclose(file);
    return whole;
}
