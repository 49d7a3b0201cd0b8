/* SPDX-License-Identifier: BSD-3-Clause */
/* How often each way of selecting finds what a trembling hand points at. It measures no time. */
#include "bench/bench.h"

#include "tests/support/hand.h"

#include <stdio.h>

static conus_status add_method(struct bench *bench, const struct hand_outcome *outcome, size_t method)
{
    size_t trials = bench->options.poses;
    double part = (double)outcome->hits[method] / (double)trials;
    double changes = (double)outcome->changes[method] / outcome->seconds;
    const char *name = hand_methods[method].name;
    printf("%-32s %5.1f %% right, %5.2f changes/s\n", name, 100 * part, changes);
    json_t *run =
        json_pack("{s:s, s:s, s:I, s:f, s:n, s:n, s:n, s:i, s:b, s:I, s:f}", "scenario", "hand", "variant", name,
                  "count", (json_int_t)trials, "angle_deg", 0.0, "median_ms", "min_ms", "p90_ms", "repeats", 1, "equal",
                  true, "right", (json_int_t)outcome->hits[method], "changes_per_s", changes);
    return run && !json_array_append_new(bench->runs, run) ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "out of memory");
}

/* Nothing is timed here: it says how often a trembling hand selects what is meant. */
conus_status bench_hand(struct bench *bench)
{
    conus_atlas *atlas = NULL;
    struct hand_outcome outcome;
    struct buffer record = {0};
    const char *path = bench->options.record;
    conus_status status = conus_atlas_load(&atlas, bench->options.atlas, NULL);
    if (!status && !conus_atlas_volume_count(atlas)) {
        status = fail(CONUS_ERROR_ARGUMENT, "--atlas: %s has no volume", bench->options.atlas);
    }
    status = status ? status : hand_run(&outcome, atlas, bench->options.poses, bench_random, path ? &record : NULL);
    for (size_t i = 0; !status && i < HAND_METHODS; i++) {
        status = add_method(bench, &outcome, i);
    }
    status = status ? status : buffer_status(&record);
    if (!status && path) {
        status = conus_write_file(path, record.data, record.size);
    }
    buffer_finish(&record);
    conus_atlas_destroy(atlas);
    return status;
}
