/* SPDX-License-Identifier: BSD-3-Clause */
/* The progress line on a terminal or in a log, or as JSON. */
#include "options/progress.h"

#include "base/system/system.h"
#include "options/messages.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const progress_kinds[] = {"auto", "json", "none", NULL};

enum { LINE_SIZE = 256 };

static const double interval_ms = 100;
static const double log_interval_ms = 5 * 60 * 1000;

void progress_start(struct progress *out, enum progress_kind kind, bool quiet, const char *what, uint64_t total)
{
    double start = clock_ms();
    bool is_for_people = kind == PROGRESS_AUTO && !quiet;
    *out = (struct progress){.kind = kind, .what = what, .total = total, .started = start, .shown = start};
    if (out->kind == PROGRESS_JSON) {
        out->shown -= 2 * interval_ms; /* a program that reads along gets the first block at once */
    }
    out->on_terminal = is_for_people && system_is_terminal(STDERR_FILENO);
    out->in_log = is_for_people && !out->on_terminal;
}

bool progress_is_shown(const struct progress *progress)
{
    return progress->on_terminal || progress->kind == PROGRESS_JSON;
}

static double rate_of(const struct progress *progress, uint64_t done)
{
    double seconds = 1e-3 * (clock_ms() - progress->started);
    return seconds > 0 ? (double)(done - progress->before) / seconds : 0;
}

/* "120 of 1000 poses, 25/s, 12 %, 35 s left, 3 errors" */
static void make_line(char line[LINE_SIZE], const struct progress *progress, uint64_t done, uint64_t errors)
{
    double rate = rate_of(progress, done);
    char total[32] = "";
    if (progress->total) {
        snprintf(total, sizeof total, " of %llu", (unsigned long long)progress->total);
    }
    snprintf(line, LINE_SIZE, rate < 10 ? "%llu%s %s, %.2g/s" : "%llu%s %s, %.0f/s", (unsigned long long)done, total,
             progress->what, rate);
    if (progress->total && rate > 0) {
        size_t used = strlen(line);
        snprintf(line + used, LINE_SIZE - used, ", %.0f %%", 100 * (double)done / (double)progress->total);
        used = strlen(line);
        double seconds =
            (double)(progress->total - done) / rate; /* said in minutes from two on, in hours from two on */
        const char *form = seconds < 120 ? ", %.0f s left" : seconds < 7200 ? ", %.0f min left" : ", %.1f h left";
        snprintf(line + used, LINE_SIZE - used, form, seconds / (seconds < 120 ? 1 : seconds < 7200 ? 60 : 3600));
    }
    if (errors) {
        size_t used = strlen(line);
        snprintf(line + used, LINE_SIZE - used, ", %llu errors", (unsigned long long)errors);
    }
    if (progress->more) {
        size_t used = strlen(line);
        snprintf(line + used, LINE_SIZE - used, "%s", progress->more);
    }
}

static void show_json(const struct progress *progress, uint64_t done, uint64_t errors, bool finished)
{
    double rate = rate_of(progress, done);
    fprintf(stderr, "{\"done\":%llu,\"total\":", (unsigned long long)done);
    fprintf(stderr, progress->total ? "%llu" : "null", (unsigned long long)progress->total);
    fprintf(stderr, ",\"errors\":%llu,\"rate\":%.0f,\"eta_s\":", (unsigned long long)errors, rate);
    if (progress->total && rate > 0) {
        fprintf(stderr, "%.0f", (double)(progress->total - done) / rate);
    } else {
        fputs("null", stderr);
    }
    fprintf(stderr, ",\"finished\":%s}\n", finished ? "true" : "false");
}

void progress_update(struct progress *progress, uint64_t done, uint64_t errors)
{
    double time = clock_ms();
    bool is_shown = progress_is_shown(progress);
    if ((!is_shown && !progress->in_log) ||
        time - progress->shown < (progress->in_log ? log_interval_ms : interval_ms)) {
        return;
    }
    progress->shown = time;
    if (progress->kind == PROGRESS_JSON) {
        show_json(progress, done, errors, false);
        return;
    }
    char line[LINE_SIZE];
    make_line(line, progress, done, errors);
    if (progress->on_terminal) {
        char shown[LINE_SIZE + 8];
        system_write(STDERR_FILENO, shown, (size_t)snprintf(shown, sizeof shown, "\r\033[K%s", line));
        messages_unfinished(true);
    } else {
        print_error_line("%s", line);
    }
}

void progress_finish(struct progress *progress, uint64_t done, uint64_t errors)
{
    if (progress->on_terminal) {
        system_write(STDERR_FILENO, "\r\033[K", strlen("\r\033[K"));
        messages_unfinished(false);
    }
    if (progress->kind == PROGRESS_JSON) {
        show_json(progress, done, errors, true);
    }
    progress->kind = PROGRESS_NONE;
    progress->on_terminal = false;
    progress->in_log = false;
}
