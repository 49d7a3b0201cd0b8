/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a table of batches, and answers one batch or each row of such a table. */
#include "batch/batch_jobs.h"

#include "batch/batch_run.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

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

/* Splits a line into its fields; false unless there are COLUMNS. */
static bool split_fields(char *fields[COLUMNS], char *line)
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
        print_error_line("%s:%zu: not three fields with tabs between them", path, number);
        return false;
    }
    struct batch_job job = {fields[place[0]], fields[place[1]], fields[place[2]], number};
    if (!*job.atlas || output_is_stdout(job.poses) || !*job.poses || output_is_stdout(job.output) || !*job.output) {
        print_error_line("%s:%zu: atlas, poses and output must be files", path, number);
        return false;
    }
    if ((jobs->count & (jobs->count - 1)) == 0) { /* 0 and powers of two: the array is full */
        struct batch_job *more = realloc(jobs->jobs, (jobs->count ? 2 * jobs->count : 1) * sizeof *more);
        if (!more) {
            print_error_line("not enough memory");
            return false;
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

/* Sorts by place, then by line, the output of a line before its sidecar. */
static int by_place(const void *a, const void *b)
{
    const struct claim *x = a;
    const struct claim *y = b;
    int order = path_place_order(&x->place, &y->place);
    order = order ? order : (x->line > y->line) - (x->line < y->line);
    return order ? order : !!x->sidecar - !!y->sidecar;
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

/* Sorts the claims: a table may have a million rows. */
static bool check_outputs(const struct batch_jobs *jobs, const char *path)
{
    size_t count = 2 * jobs->count;
    struct claim *claims = calloc(count + 1, sizeof *claims);
    bool fine = claims && make_claims(claims, jobs);
    const struct claim *twice = NULL;
    if (!fine) {
        print_error_line("not enough memory");
    } else {
        qsort(claims, count, sizeof *claims, by_place);
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
    for (char *rest = first, *line; whole && (line = strsep(&rest, "\n"));) {
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

/* The more serious of two exit codes. */
static int worse_code(int a, int b)
{
    return a == EXIT_DONE || (a == EXIT_DIFFERENT && b != EXIT_DONE) ? b : a;
}

static bool is_signal(int code)
{
    return code >= 128;
}

static int answer_table(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                        void *user)
{
    char *text = NULL;
    size_t size = 0;
    struct batch_jobs jobs;
    struct shard shard;
    uint64_t first = 0;
    uint64_t count = 0;
    int code = batch_shard(&shard, settings);
    code = code ? code : input_file_read(&text, &size, settings->jobs, INPUT_FILE_OR_PIPE, SIZE_LIMIT);
    code = code ? code : batch_jobs_parse(&jobs, settings->jobs, text, size);
    if (code) {
        return code;
    }
    int last = EXIT_DONE;
    shard_range(&first, &count, shard, jobs.count);
    for (uint64_t i = first; i < first + count && jobs.jobs && !is_signal(last); i++) {
        struct batch_settings own = *settings;
        struct arguments aimed = *arguments;
        own.poses = jobs.jobs[i].poses;
        own.output = jobs.jobs[i].output;
        own.shard = "0/1";
        aimed.operands[0] = jobs.jobs[i].atlas;
        last = answer(user, &own, &aimed);
        code = worse_code(code, last);
    }
    batch_jobs_finish(&jobs);
    return is_signal(last) ? last : code;
}

/* A file of rows of one batch, and what is in it: answers where that is NULL. */
struct batch_output {
    const char *path;
    const struct rows_kind *kind;
};

static const char *option_of(const struct batch_output *output)
{
    return output->kind ? output->kind->option : "output";
}

/* Whether they are two files with two sidecars: rows.tsv and rows.csv have one, rows.json. */
static bool outputs_differ_from(const struct batch_output *one, const struct batch_output *other)
{
    if (output_is_stdout(one->path) ? output_is_stdout(other->path) : paths_equal(one->path, other->path)) {
        print_error_line("--%s and --%s are the same file", option_of(one), option_of(other));
        return false;
    }
    if (output_is_stdout(one->path) || output_is_stdout(other->path)) {
        return true;
    }
    char *sidecar = provenance_path(one->path);
    char *its = provenance_path(other->path);
    bool shared = sidecar && its && paths_equal(sidecar, its);
    if (shared) {
        print_error_line("--%s and --%s have one sidecar, %s; give them other names", option_of(one), option_of(other),
                         sidecar);
    }
    free(sidecar);
    free(its);
    return !shared;
}

/* Several are of as many runs over the same poses. */
static bool check_outputs_differ(const struct batch_output *outputs, size_t count, const char *poses)
{
    for (size_t i = 1; i < count; i++) {
        for (size_t k = 0; k < i; k++) {
            if (!outputs_differ_from(&outputs[k], &outputs[i])) {
                return false;
            }
        }
    }
    if (count > 1 && output_is_no_file(poses)) {
        print_error_line("--%s besides --%s reads the poses once more: it needs a file of poses, not %s",
                         option_of(&outputs[1]), option_of(&outputs[0]),
                         output_is_stdout(poses) ? "standard input" : "a pipe");
        return false;
    }
    return true;
}

static int answer_outputs(const struct batch_settings *settings, const struct arguments *arguments,
                          batch_answer *answer, void *user)
{
    struct batch_output outputs[1 + AXIS_FILES] = {{settings->output, NULL}};
    size_t count = settings->output != NULL;
    for (size_t i = 0; i < AXIS_FILES; i++) {
        if (settings->axis.files[i]) {
            outputs[count++] = (struct batch_output){settings->axis.files[i], &settings_axis_rows[i]};
        }
    }
    count = count ? count : 1; /* the answers, on standard output */
    int code = check_outputs_differ(outputs, count, settings->poses) ? EXIT_DONE : EXIT_USAGE;
    for (size_t i = 0; i < count && (code == EXIT_DONE || code == EXIT_DIFFERENT); i++) {
        struct batch_settings own = *settings;
        own.output = outputs[i].path;
        own.of_axis = outputs[i].kind;
        own.is_again = i > 0;
        own.common.quiet = settings->common.quiet || i > 0; /* the notes are said */
        code = worse_code(code, answer(user, &own, arguments));
    }
    return code;
}

int batch_jobs_answer(const struct batch_settings *settings, const struct arguments *arguments, batch_answer *answer,
                      void *user)
{
    if (settings->jobs && arguments->operand_count) {
        return print_usage_error("ATLAS and --jobs exclude each other");
    }
    if (settings->jobs) {
        return answer_table(settings, arguments, answer, user);
    }
    if (!arguments->operand_count) {
        const char *program = arguments->command->program;
        return print_usage_error("ATLAS is missing; %s batch --help shows how", program ? program : "conus");
    }
    if (!settings->poses) {
        return print_usage_error("--poses FILE is missing");
    }
    return answer_outputs(settings, arguments, answer, user);
}
