/* SPDX-License-Identifier: BSD-3-Clause */
/* Collects times and writes their medians. */
#include "viewer/model/viewer.h"

#include "base/order.h"
#include "base/system/system.h"
#include "conus/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const char *const names[TIMED_KINDS] = {"frame_ms", "period_ms", "selection_ms", "latency_ms", "picture_ms"};

void times_start(struct times *times, double started)
{
    memset(times, 0, sizeof *times);
    times->started = times->written = started;
}

void times_add(struct times *times, enum timed kind, double milliseconds)
{
    times->samples[kind][times->counts[kind]++ % TIMES_KEPT] = milliseconds;
}

void times_begin_frame(struct times *times)
{
    double now = clock_ms();
    if (times->frame_started > 0) {
        times_add(times, TIMED_PERIOD, now - times->frame_started);
    }
    times->frame_started = now;
}

conus_status times_write(struct times *times, const char *path)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return CONUS_ERROR_MEMORY;
    }
    double now = clock_ms();
    struct timespec processor;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &processor);
    double used = 1e3 * (double)processor.tv_sec + 1e-6 * (double)processor.tv_nsec;
    fprintf(out, "{\"first_frame_ms\": %.1f, \"first_picture_ms\": %.1f,\n \"wall_ms\": %.1f, \"cpu_ms\": %.1f",
            times->first_frame, times->first_picture, now - times->written, used - times->used);
    times->written = now;
    times->used = used;
    for (int kind = 0; kind < TIMED_KINDS; kind++) {
        size_t count = times->counts[kind] < TIMES_KEPT ? times->counts[kind] : TIMES_KEPT;
        double *samples = times->samples[kind];
        if (count) {
            order_sort(samples, count, sizeof *samples, compare_f64);
            fprintf(out, ",\n \"%s\": {\"count\": %zu, \"median\": %.3f, \"p90\": %.3f, \"max\": %.3f}", names[kind],
                    count, samples[count / 2], samples[count * 9 / 10], samples[count - 1]);
        }
        times->counts[kind] = 0;
    }
    fputs("}\n", out);
    bool written = system_text_close(&text);
    conus_status status = written ? conus_write_file(path, text.data, text.size) : CONUS_ERROR_MEMORY;
    free(text.data);
    return status;
}
