/* SPDX-License-Identifier: BSD-3-Clause */
#include "apps/bench/bench.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

double bench_now(const struct bench *bench)
{
    struct timespec now;
    clock_gettime(bench->one_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

double bench_random(uint64_t *state, double low, double high)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return low + (high - low) * ((double)((z ^ z >> 31) >> 11) * 0x1p-53);
}

static int compare_times(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

static void summarise(struct bench_variant *variant, double *times, size_t count)
{
    qsort(times, count, sizeof *times, compare_times);
    variant->median_ms = 0.5 * (times[(count - 1) / 2] + times[count / 2]);
    variant->min_ms = times[0];
    variant->p90_ms = times[(count - 1) * 9 / 10];
}

static conus_status add_run(struct bench *bench, const char *scenario, const struct bench_variant *variant, size_t per,
                            double angle_deg)
{
    json_t *run = json_pack("{s:s, s:s, s:I, s:f, s:f, s:f, s:f, s:I, s:b}", "scenario", scenario, "variant",
                            variant->name, "count", (json_int_t)per, "angle_deg", angle_deg, "median_ms",
                            variant->median_ms, "min_ms", variant->min_ms, "p90_ms", variant->p90_ms, "repeats",
                            (json_int_t)bench->options.repeats, "equal", variant->equal);
    printf("%-8s %-40s %9.4f ms (min %.4f, p90 %.4f)%s\n", scenario, variant->name, variant->median_ms, variant->min_ms,
           variant->p90_ms, variant->equal ? "" : "  ANSWERS DIFFER");
    return run && !json_array_append_new(bench->runs, run) ? CONUS_OK : fail(CONUS_ERROR_MEMORY, "out of memory");
}

conus_status bench_measure(struct bench *bench, const char *scenario, struct bench_variant *variants, size_t count,
                           size_t per, double angle_deg)
{
    size_t repeats = bench->options.repeats;
    double *times = memory_raw(count * repeats, sizeof *times);
    if (!times) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t round = 0; round < repeats; round++) {
        for (size_t v = 0; v < count; v++) {
            variants[v].run(variants[v].data); /* its neighbours emptied the caches */
            double start = bench_now(bench);
            variants[v].run(variants[v].data);
            times[v * repeats + round] = (bench_now(bench) - start) / (double)per;
        }
    }
    conus_status status = CONUS_OK;
    for (size_t v = 0; v < count && !status; v++) {
        summarise(&variants[v], times + v * repeats, repeats);
        status = add_run(bench, scenario, &variants[v], per, angle_deg);
    }
    memory_free(times);
    return status;
}

conus_status bench_ratio(struct bench *bench, const char *key, const struct bench_variant *above,
                         const struct bench_variant *below)
{
    double value = above->median_ms / below->median_ms;
    int error;
    if (above->equal && below->equal) {
        printf("%s = %.2f (%s / %s)\n", key, value, above->name, below->name);
        error = json_object_set_new(bench->ratios, key, json_real(value));
    } else {
        char why[64];
        snprintf(why, sizeof why, "%s_null_because", key);
        printf("%s = null: the answers differ\n", key);
        error = json_object_set_new(bench->ratios, key, json_null());
        error |= json_object_set_new(bench->ratios, why, json_string("the answers differ"));
    }
    return error ? fail(CONUS_ERROR_MEMORY, "out of memory") : CONUS_OK;
}
