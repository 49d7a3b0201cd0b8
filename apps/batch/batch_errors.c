/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the poses without an answer in a file of rows of any format. */
#include "batch/batch_errors.h"

#include "common/input_file.h"
#include "common/messages.h"

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

/* Columns query and kind, */
static bool in_tsv(const char *line)
{
    return is_error_cell(next_cell(line, '\t'), '\t');
}

static bool in_csv(const char *line)
{
    return is_error_cell(next_cell(line, ','), ',');
}

/* or query, atlas and kind. */
static bool in_tsv_of_atlases(const char *line)
{
    return is_error_cell(next_cell(next_cell(line, '\t'), '\t'), '\t');
}

static bool in_csv_of_atlases(const char *line)
{
    return is_error_cell(next_cell(next_cell(line, ','), ','), ',');
}

static bool in_ndjson(const char *line)
{
    return strstr(line, "\"kind\":\"error\""); /* marks inside of texts have a backslash before them */
}

static bool in_afni(const char *line)
{
    return strncmp(line, "***** ", 6) == 0 && strncmp(line, "***** Not near any region", 25) != 0;
}

/* The last column is area_error. */
static bool in_bids(const char *line)
{
    const char *tab = strrchr(line, '\t');
    return tab && strcmp(tab, "\tarea_error\n") != 0 && strcmp(tab, "\tn/a\n") != 0;
}

typedef bool is_error(const char *line);

/* How errors look in a file with this first line. */
static is_error *errors_after(const char *first)
{
    return strncmp(first, "query\tatlas\t", 12) == 0 ? in_tsv_of_atlases
           : strncmp(first, "query,atlas,", 12) == 0 ? in_csv_of_atlases
           : strncmp(first, "query\t", 6) == 0       ? in_tsv
           : strncmp(first, "query,", 6) == 0        ? in_csv
           : *first == '{'                           ? in_ndjson
           : strncmp(first, "+++++++ ", 8) == 0      ? in_afni
                                                     : in_bids;
}

bool batch_errors_count(uint64_t *errors, const char *path)
{
    char *line = NULL;
    size_t capacity = 0;
    is_error *is = NULL;
    FILE *file = input_file_open(path);
    if (!file) {
        return false;
    }
    for (*errors = 0; getline(&line, &capacity, file) > 0;) {
        is = is ? is : errors_after(line);
        *errors += is(line);
    }
    bool whole = feof(file) && !ferror(file);
    if (!whole) {
        print_system_error(path, "read");
    }
    free(line);
    fclose(file);
    return whole;
}
