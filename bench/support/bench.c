/* SPDX-License-Identifier: BSD-3-Clause */
/* Times the variants of a scenario in turn, and keeps runs, ratios and the reasons for those left out. */
#include "bench/support/bench.h"

#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* Milliseconds from which on the contents of the caches make no difference to a run. */
#define LONG_RUN 250.0

/* Milliseconds up to which other programs on the machine may spoil a run altogether, so that it is repeated AGAIN
 * times. */
#define SHORT_RUN 50.0
enum { AGAIN = 3 };

static double clock_ms(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

void bench_draw_on_this_thread(void)
{
    setenv("LP_NUM_THREADS", "0", 0);
}

double bench_wall(void)
{
    return clock_ms(CLOCK_MONOTONIC) / 1e3;
}

double bench_cpu(void)
{
    return clock_ms(CLOCK_PROCESS_CPUTIME_ID) / 1e3;
}

double bench_resident(void)
{
    char line[128];
    char *resident = NULL; /* the second number, pages */
    FILE *file = fopen("/proc/self/statm", "re");
#ifdef __GLIBC__
    malloc_trim(0); /* freed memory does not count */
#endif
    if (file && fgets(line, sizeof line, file)) {
        (void)strtoull(line, &resident, 10);
    }
    if (file) {
        (void)fclose(file);
    }
    return resident ? (double)strtoull(resident, NULL, 10) * (double)sysconf(_SC_PAGESIZE) : 0;
}

double bench_random(uint64_t *state, double low, double high)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return low + (high - low) * ((double)((z ^ z >> 31) >> 11) * 0x1p-53);
}

size_t bench_size(const struct bench_options *options, size_t full)
{
    return options->check ? (full + 49) / 50 : full;
}

conus_status bench_load_labels(conus_atlas **out, const char *path)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, path, NULL);
    if (!status && !atlas_parcellation(atlas)) {
        conus_atlas_destroy(atlas);
        return fail(CONUS_ERROR_DATA, "%s: has no labelled voxels", path);
    }
    *out = status ? *out : atlas;
    return status;
}

static double median(const double *sorted, size_t count)
{
    return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

/* Times of one variant: in every round its first run, and the run that counts. */
struct times {
    double *cold, *warm;
    double *cpu;   /* of all threads, of the one that counts */
    bool has_cold; /* apart from the other                   */
};

/* Fills in the variant's numbers; returns how far apart the middle half of its times is, as a part of the median. */
static double summarise(struct bench_variant *variant, const struct times *times, size_t rounds)
{
    order_sort(times->warm, rounds, sizeof *times->warm, compare_f64);
    order_sort(times->cold, rounds, sizeof *times->cold, compare_f64);
    order_sort(times->cpu, rounds, sizeof *times->cpu, compare_f64);
    variant->median_ms = median(times->warm, rounds);
    variant->min_ms = times->warm[0];
    variant->p90_ms = times->warm[(rounds - 1) * 9 / 10];
    variant->cold_ms = times->has_cold ? median(times->cold, rounds) : (double)NAN;
    double spread = times->warm[(rounds - 1) * 3 / 4] - times->warm[(rounds - 1) / 4];
    return variant->median_ms > 0 ? spread / variant->median_ms : 0;
}

static void print_run(const char *scenario, const struct bench_variant *variant)
{
    char cold[32] = "";
    if (!isnan(variant->cold_ms)) {
        snprintf(cold, sizeof cold, ", cold %.4f", variant->cold_ms);
    }
    printf("%-11s %-44s %10.4f ms (min %.4f, p90 %.4f%s)%s\n", scenario, variant->name, variant->median_ms,
           variant->min_ms, variant->p90_ms, cold,
           variant->equal             ? ""
           : variant->other_by_design ? "  other answers by design"
                                      : "  ANSWERS DIFFER");
}

static conus_status add_run(struct bench *bench, const char *scenario, struct bench_variant *variant,
                            const struct times *times, size_t rounds, size_t per, double angle_deg)
{
    double spread = summarise(variant, times, rounds);
    json_t *cold = times->has_cold ? json_real(variant->cold_ms) : json_null();
    json_t *run = json_pack("{s:s, s:s, s:I, s:f, s:f, s:f, s:f, s:o, s:f, s:f, s:I, s:b, s:b, s:s}", "scenario",
                            scenario, "variant", variant->name, "count", (json_int_t)per, "angle_deg", angle_deg,
                            "median_ms", variant->median_ms, "min_ms", variant->min_ms, "p90_ms", variant->p90_ms,
                            "cold_ms", cold, "cpu_ms", median(times->cpu, rounds), "spread", spread, "repeats",
                            (json_int_t)rounds, "equal", variant->equal, "other_by_design", variant->other_by_design,
                            "clock", bench->one_thread ? "CPU time of one thread" : "wall");
    int error = !run || (variant->more && json_object_update(run, variant->more));
    error = error || json_array_append(bench->runs, run);
    json_decref(variant->more);
    variant->more = NULL;
    print_run(scenario, variant);
    json_decref(run);
    return error ? fail(CONUS_ERROR_MEMORY, "out of memory") : CONUS_OK;
}

static double time_once(const struct bench *bench, const struct bench_variant *variant, double *cpu)
{
    if (variant->prepare) {
        variant->prepare(variant->data);
    }
    double cpu_start = clock_ms(CLOCK_PROCESS_CPUTIME_ID);
    clockid_t clock = bench->one_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
    double start = clock_ms(clock);
    variant->run(variant->data);
    double time = clock_ms(clock) - start;
    *cpu = clock_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_start;
    return time;
}

static void take_round(const struct bench *bench, const struct bench_variant *variant, struct times *times,
                       size_t round, size_t per)
{
    double cpu;
    double first = time_once(bench, variant, &cpu); /* its neighbours emptied the caches */
    double warm = first;
    times->has_cold = first < LONG_RUN && !bench->options.check;
    if (times->has_cold) {
        double runs[AGAIN];
        int count = first < SHORT_RUN ? AGAIN : 1;
        for (int i = 0; i < count; i++) {
            runs[i] = time_once(bench, variant, &cpu);
        }
        order_sort(runs, (size_t)count, sizeof *runs, compare_f64);
        warm = median(runs, (size_t)count);
    }
    times->cold[round] = first / (double)per;
    times->warm[round] = warm / (double)per;
    times->cpu[round] = cpu / (double)per;
}

static size_t queries_in(const struct bench_variant *variant, size_t per)
{
    return variant->per ? variant->per : per;
}

/* As many rounds as there is time for; returns their number. */
static size_t take_rounds(const struct bench *bench, const struct bench_variant *variants, size_t count,
                          struct times *times, size_t per)
{
    double start = bench_wall();
    double limit = bench->options.seconds > 0 ? bench->options.seconds : (double)INFINITY;
    size_t round = 0;
    while (round < bench->options.repeats && (round == 0 || bench_wall() - start < limit)) {
        for (size_t v = 0; v < count; v++) {
            take_round(bench, &variants[v], &times[v], round, queries_in(&variants[v], per));
        }
        round++;
    }
    return round;
}

conus_status bench_measure(struct bench *bench, const char *scenario, struct bench_variant *variants, size_t count,
                           size_t per, double angle_deg)
{
    size_t repeats = bench->options.repeats;
    double *scratch = memory_raw(3 * count * repeats, sizeof *scratch);
    struct times *times = memory_zeroed(count, sizeof *times);
    conus_status status = scratch && times ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t v = 0; v < count && !status; v++) {
        double *own = scratch + 3 * v * repeats;
        times[v] = (struct times){.cold = own, .warm = own + repeats, .cpu = own + 2 * repeats};
    }
    size_t rounds = status ? 0 : take_rounds(bench, variants, count, times, per);
    for (size_t v = 0; v < count && !status; v++) {
        status = add_run(bench, scenario, &variants[v], &times[v], rounds, queries_in(&variants[v], per), angle_deg);
    }
    memory_free(times);
    memory_free(scratch);
    return status;
}

conus_status bench_value(struct bench *bench, const char *key, double value, bool equal)
{
    int error;
    if (equal && isfinite(value)) {
        printf("%s = %.4g\n", key, value);
        error = json_object_set_new(bench->ratios, key, json_real(value));
    } else {
        const char *why = equal ? "it was not measured" : "the answers differ";
        char name[96];
        snprintf(name, sizeof name, "%s_null_because", key);
        printf("%s = null: %s\n", key, why);
        error = json_object_set_new(bench->ratios, key, json_null());
        error |= json_object_set_new(bench->ratios, name, json_string(why));
    }
    return error ? fail(CONUS_ERROR_MEMORY, "out of memory") : CONUS_OK;
}

conus_status bench_ratio(struct bench *bench, const char *key, const struct bench_variant *above,
                         const struct bench_variant *below)
{
    return bench_value(bench, key, above->median_ms / below->median_ms, above->equal && below->equal);
}

conus_status bench_leave_out(struct bench *bench, const char *what)
{
    printf("%s: left out: %s\n", what, conus_message());
    return json_object_set_new(bench->left_out, what, json_string(conus_message()))
               ? fail(CONUS_ERROR_MEMORY, "out of memory")
               : CONUS_OK;
}

/* The distances from the mean of log x sum to 0, so the mean of log y does not matter. */
double bench_exponent(const double *x, const double *y, size_t count)
{
    double mean_x = 0;
    double above = 0;
    double below = 0;
    for (size_t i = 0; i < count; i++) {
        mean_x += log(x[i]) / (double)count;
    }
    for (size_t i = 0; i < count; i++) {
        double away = log(x[i]) - mean_x;
        above += away * log(y[i]);
        below += away * away;
    }
    return below > 0 ? above / below : (double)NAN;
}
