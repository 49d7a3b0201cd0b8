/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs every scenario in a child process and collects what the children print. */
#include "bench/all.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TIME_LIMIT = 900 }; /* seconds, of one scenario */

/* Writes {settings, runs, ratios, left_out}, or {error}; returns the exit code. */
static int run_here(struct bench *bench, const struct bench_scenario *scenario, int out)
{
    alarm(TIME_LIMIT);
    double start = bench_wall();
    double load = report_load();
    conus_status status = bench->runs && bench->ratios && bench->left_out ? scenario->run(bench)
                                                                          : fail(CONUS_ERROR_MEMORY, "out of memory");
    json_t *result =
        status ? json_pack("{s:s}", "error", conus_message())
               : json_pack("{s:o, s:O, s:O, s:O}", "settings", report_settings(bench, bench_wall() - start, load),
                           "runs", bench->runs, "ratios", bench->ratios, "left_out", bench->left_out);
    bool written = result && !json_dumpfd(result, out, JSON_REAL_PRECISION(17));
    json_decref(result);
    return written && !close(out) ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* The options with the poses, repeats and seconds that the scenario has in `all`. */
static struct bench_options options_for(const struct bench *bench, const struct bench_scenario *scenario)
{
    struct bench_options options = bench->options;
    if (!options.check) {
        options.poses = scenario->poses ? scenario->poses : options.poses;
        options.repeats = scenario->repeats ? scenario->repeats : options.repeats;
        options.seconds = scenario->seconds > 0 ? scenario->seconds : options.seconds;
    }
    return options;
}

/* Reads the child's result; NULL, with a message, if the child wrote none. */
static json_t *read_result(int in, pid_t pid)
{
    int how = 0;
    json_t *result = json_loadfd(in, 0, NULL);
    while (waitpid(pid, &how, 0) < 0) {
    }
    if (!result && WIFSIGNALED(how) && WTERMSIG(how) == SIGALRM) {
        (void)fail(CONUS_ERROR_ARGUMENT, "it took more than %d s", TIME_LIMIT);
    } else if (!result && WIFSIGNALED(how)) {
        (void)fail(CONUS_ERROR_ARGUMENT, "it was ended by signal %d", WTERMSIG(how));
    } else if (!result || !WIFEXITED(how) || WEXITSTATUS(how)) {
        json_decref(result);
        result = NULL;
        (void)fail(CONUS_ERROR_ARGUMENT, "it ended with status %d", WEXITSTATUS(how));
    }
    return result;
}

/* One scenario in a child; NULL, with a message, if there is no result. */
static json_t *run_apart(struct bench *bench, const struct bench_scenario *scenario)
{
    int ends[2];
    fflush(stdout);
    if (pipe(ends)) {
        (void)fail(CONUS_ERROR_MEMORY, "no pipe");
        return NULL;
    }
    pid_t pid = fork();
    if (pid == 0) {
        close(ends[0]);
        struct bench own = {.options = options_for(bench, scenario),
                            .folder = bench->folder,
                            .runs = json_array(),
                            .ratios = json_object(),
                            .left_out = json_object()};
        exit(run_here(&own, scenario, ends[1]));
    }
    close(ends[1]);
    json_t *result = pid > 0 ? read_result(ends[0], pid) : NULL;
    if (pid < 0) {
        (void)fail(CONUS_ERROR_MEMORY, "no process");
    }
    close(ends[0]);
    return result;
}

/* Adds the measurements of a scenario. */
static conus_status take_result(struct bench *bench, json_t *settings, const char *name, const json_t *result)
{
    int error = json_array_extend(bench->runs, json_object_get(result, "runs"));
    error |= json_object_update(bench->ratios, json_object_get(result, "ratios"));
    error |= json_object_update(bench->left_out, json_object_get(result, "left_out"));
    error |= json_object_set(settings, name, json_object_get(result, "settings"));
    return error ? fail(CONUS_ERROR_MEMORY, "out of memory") : CONUS_OK;
}

conus_status bench_all(struct bench *bench, json_t *settings, const struct bench_scenario *scenarios, size_t count)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        double start = bench_wall();
        fprintf(stderr, "[%zu/%zu] %s ...\n", i + 1, count, scenarios[i].name);
        json_t *result = run_apart(bench, &scenarios[i]);
        const char *error = json_string_value(json_object_get(result, "error"));
        if (error) {
            (void)fail(CONUS_ERROR_ARGUMENT, "%s", error);
        }
        bench->crashed += !result;
        status = !result || error ? bench_leave_out(bench, scenarios[i].name)
                                  : take_result(bench, settings, scenarios[i].name, result);
        fprintf(stderr, "[%zu/%zu] %s: %.0f s\n", i + 1, count, scenarios[i].name, bench_wall() - start);
        json_decref(result);
    }
    return status;
}
