/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a table of batches. */
#include "batch/batch_table.h"

#include "common/input_file.h"
#include "common/messages.h"
#include "common/output.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 3, SIZE_LIMIT = 1 << 26 };

static const char *const names[COLUMNS] = {"atlas", "poses", "output"};

void batch_jobs_finish(struct batch_jobs *jobs)
{
    free(jobs->jobs);
    free(jobs->text);
    *jobs = (struct batch_jobs){0};
}

/* Cuts a line into its fields; false unless there are COLUMNS. */
static bool split(char *fields[COLUMNS], char *line)
{
    size_t count = 0;
    for (char *field; (field = strsep(&line, "\t")); count++) {
        if (count < COLUMNS) {
            fields[count] = field;
        }
    }
    return count == COLUMNS;
}

/* Where each of the names stands in the header. */
static bool read_header(size_t place[COLUMNS], char *line)
{
    char *fields[COLUMNS] = {NULL};
    bool found = split(fields, line);
    for (size_t i = 0; i < COLUMNS && found; i++) {
        place[i] = 0;
        while (place[i] < COLUMNS && strcmp(fields[place[i]], names[i]) != 0) {
            place[i]++;
        }
        found = place[i] < COLUMNS;
    }
    return found;
}

static bool same_output(const struct batch_jobs *jobs, const char *output)
{
    for (size_t i = 0; i < jobs->count; i++) {
        if (strcmp(jobs->jobs[i].output, output) == 0 || paths_equal(jobs->jobs[i].output, output)) {
            return true;
        }
    }
    return false;
}

static bool add_job(struct batch_jobs *jobs, const size_t place[COLUMNS], char *line, const char *path, size_t number)
{
    char *fields[COLUMNS] = {NULL};
    if (!split(fields, line)) {
        print_error_line("%s:%zu: not three fields with tabs between them", path, number);
        return false;
    }
    struct batch_job job = {fields[place[0]], fields[place[1]], fields[place[2]]};
    if (!*job.atlas || output_is_stdout(job.poses) || !*job.poses || output_is_stdout(job.output) || !*job.output) {
        print_error_line("%s:%zu: atlas, poses and output must be files", path, number);
        return false;
    }
    if (same_output(jobs, job.output)) {
        print_error_line("%s:%zu: output %s is another row's, too", path, number, job.output);
        return false;
    }
    struct batch_job *more = realloc(jobs->jobs, (jobs->count + 1) * sizeof *more);
    if (!more) {
        print_error_line("not enough memory");
        return false;
    }
    jobs->jobs = more;
    jobs->jobs[jobs->count++] = job;
    return true;
}

static bool check_text(const char *text, size_t size, const char *path)
{
    if (!size || memchr(text, '\0', size)) {
        print_error_line("%s: %s", path, size ? "a zero byte: not a table of batches" : "cannot read: it is empty");
        return false;
    }
    return true;
}

int batch_jobs_parse(struct batch_jobs *out, const char *path, char *text, size_t size)
{
    struct batch_jobs jobs = {.text = text};
    size_t place[COLUMNS];
    size_t number = 0;
    bool whole = check_text(text, size, path);
    for (char *rest = jobs.text, *line; whole && (line = strsep(&rest, "\n"));) {
        number++;
        line[strcspn(line, "\r")] = '\0';
        if (number == 1) {
            whole = read_header(place, line);
            if (!whole) {
                print_error_line("%s:1: the header is not atlas, poses and output, with tabs between them", path);
            }
        } else if (*line && *line != '#') {
            whole = add_job(&jobs, place, line, path, number);
        }
    }
    if (!whole) {
        batch_jobs_finish(&jobs);
        return EXIT_DATA;
    }
    *out = jobs;
    return EXIT_DONE;
}

int batch_jobs_read(struct batch_jobs *out, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    int code = input_file_read(&text, &size, path, INPUT_FILE_OR_PIPE, SIZE_LIMIT);
    return code ? code : batch_jobs_parse(out, path, text, size);
}
