/* SPDX-License-Identifier: BSD-3-Clause */
/* The progress line on a terminal, or as JSON. */
#include "common/progress.h"

#include "link/clock.h"

#include <stdio.h>
#include <unistd.h>

const char *const progress_kinds[] = {"auto", "json", "none", NULL};

static const double interval_ms = 100;

void progress_start(struct progress *out, enum progress_kind kind, bool quiet)
{
    double start = clock_ms();
    *out = (struct progress){.kind = kind, .started = start, .shown = start};
    if (kind == PROGRESS_JSON) {
        out->shown -= 2 * interval_ms; /* a program hears of the first block at once */
    }
    out->on_terminal = kind == PROGRESS_AUTO && !quiet && isatty(STDERR_FILENO);
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

static void show_line(const struct progress *progress, uint64_t done, uint64_t errors)
{
    double rate = rate_of(progress, done);
    fprintf(stderr, "\r\033[K%llu", (unsigned long long)done);
    if (progress->total) {
        fprintf(stderr, " of %llu", (unsigned long long)progress->total);
    }
    fprintf(stderr, " poses, %.0f/s", rate);
    if (progress->total && rate > 0) {
        fprintf(stderr, ", %.0f %%, %.0f s left", 100 * (double)done / (double)progress->total,
                (double)(progress->total - done) / rate);
    }
    if (errors) {
        fprintf(stderr, ", %llu errors", (unsigned long long)errors);
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
    if (!progress_is_shown(progress) || time - progress->shown < interval_ms) {
        return;
    }
    progress->shown = time;
    if (progress->on_terminal) {
        show_line(progress, done, errors);
    } else {
        show_json(progress, done, errors, false);
    }
}

void progress_finish(struct progress *progress, uint64_t done, uint64_t errors)
{
    if (progress->on_terminal) {
        fputs("\r\033[K", stderr);
    } else if (progress->kind == PROGRESS_JSON) {
        show_json(progress, done, errors, true);
    }
    progress->kind = PROGRESS_NONE;
    progress->on_terminal = false;
}
