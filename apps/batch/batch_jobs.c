/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a table of batches. */
#include "batch/batch_jobs.h"

#include "base/order.h"
#include "base/text.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 3 };

static const char *const names[COLUMNS] = {"atlas", "poses", "output"};

void batch_jobs_finish(struct batch_jobs *jobs)
{
    free(jobs->jobs);
    free(jobs->text);
    *jobs = (struct batch_jobs){0};
}

/* Splits a line into its fields; false unless there are COLUMNS. */
static bool split_fields(char *fields[COLUMNS], char *line)
{
    size_t count = 0;
    for (char *field; (field = text_next(&line, "\t")); count++) {
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
    bool found = split_fields(fields, line);
    for (size_t i = 0; i < COLUMNS && found; i++) {
        place[i] = 0;
        while (place[i] < COLUMNS && strcmp(fields[place[i]], names[i]) != 0) {
            place[i]++;
        }
        found = place[i] < COLUMNS;
    }
    return found;
}

static bool add_job(struct batch_jobs *jobs, const size_t place[COLUMNS], char *line, const char *path, size_t number)
{
    char *fields[COLUMNS] = {NULL};
    if (!split_fields(fields, line)) {
        return refuse("%s:%zu: not three fields with tabs between them", path, number);
    }
    struct batch_job job = {fields[place[0]], fields[place[1]], fields[place[2]], number};
    if (!*job.atlas || output_is_stdout(job.poses) || !*job.poses || output_is_stdout(job.output) || !*job.output) {
        return refuse("%s:%zu: atlas, poses and output must be files", path, number);
    }
    if ((jobs->count & (jobs->count - 1)) == 0) { /* 0 and powers of two: the array is full */
        struct batch_job *more = realloc(jobs->jobs, (jobs->count ? 2 * jobs->count : 1) * sizeof *more);
        if (!more) {
            return refuse("not enough memory");
        }
        jobs->jobs = more;
    }
    jobs->jobs[jobs->count++] = job;
    return true;
}

/* A file that a row of the table writes. */
struct claim {
    struct path_place place;
    const char *path;
    char *sidecar; /* the path, owned, if it is a sidecar */
    size_t line;
};

static int by_place(const void *a, const void *b)
{
    return path_place_order(&((const struct claim *)a)->place, &((const struct claim *)b)->place);
}

/* The first in the table whose place an earlier one has; NULL = none. */
static const struct claim *find_double(const struct claim *claims, size_t count)
{
    const struct claim *found = NULL;
    for (size_t i = 1; i < count; i++) {
        const struct claim *claim = &claims[i];
        bool is_first = !found || claim->line < found->line || (claim->line == found->line && !claim->sidecar);
        if (is_first && path_place_order(&claim[-1].place, &claim->place) == 0) {
            found = claim;
        }
    }
    return found;
}

/* Two for each row: its output and the sidecar of that. */
static bool make_claims(struct claim *claims, const struct batch_jobs *jobs)
{
    for (size_t i = 0; i < jobs->count; i++) {
        const struct batch_job *job = &jobs->jobs[i];
        claims[2 * i] = (struct claim){.path = job->output, .line = job->line};
        char *sidecar = provenance_path(job->output);
        if (!sidecar) {
            return false;
        }
        claims[2 * i + 1] = (struct claim){.path = sidecar, .sidecar = sidecar, .line = job->line};
        path_find_place(&claims[2 * i].place, job->output);
        path_find_place(&claims[2 * i + 1].place, sidecar);
    }
    return true;
}

/* Sorts the claims: a table may have a million rows. Those of one place stay in order of their lines. */
static bool check_outputs(const struct batch_jobs *jobs, const char *path)
{
    size_t count = 2 * jobs->count;
    struct claim *claims = calloc(count + 1, sizeof *claims);
    bool fine = claims && make_claims(claims, jobs);
    const struct claim *twice = NULL;
    if (!fine) {
        print_error_line("not enough memory");
    } else {
        order_sort(claims, count, sizeof *claims, by_place);
        twice = find_double(claims, count);
    }
    if (twice) {
        print_error_line("%s:%zu: %s %s is another row's, too", path, twice->line,
                         twice->sidecar ? "sidecar" : "output", twice->path);
    }
    for (size_t i = 0; claims && i < count; i++) {
        free(claims[i].sidecar);
    }
    free(claims);
    return fine && !twice;
}

int batch_jobs_parse(struct batch_jobs *out, const char *path, char *text, size_t size)
{
    struct batch_jobs jobs = {.text = text};
    size_t place[COLUMNS];
    size_t number = 0;
    bool whole = size && !memchr(text, '\0', size);
    if (!whole) {
        print_error_line("%s: %s", path, size ? "a zero byte: not a table of batches" : "cannot read: it is empty");
    }
    char *first = size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? text + 3 : text; /* behind a byte order mark */
    for (char *rest = first, *line; whole && (line = text_next(&rest, "\n"));) {
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
    if (!whole || !check_outputs(&jobs, path)) {
        batch_jobs_finish(&jobs);
        return EXIT_DATA;
    }
    *out = jobs;
    return EXIT_DONE;
}
