/* SPDX-License-Identifier: BSD-3-Clause */
/* From nothing to an answer: loading an atlas, making a selector, and the whole program. */
#include "bench/support/program.h"
#include "conus/phantom.h"
#include "conus/selection.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

enum { PATH_SIZE = 512, PROCESSES = 5 };

/* An atlas, and the question to it. */
struct job {
    const char *path;
    const char *program; /* of conus, for a whole process */
    conus_atlas *atlas;  /* loaded, for a selector        */
    conus_engine engine;
    conus_status status;
};

static void keep_first_error(struct job *job, conus_status status)
{
    job->status = job->status ? job->status : status;
}

static void load_atlas(void *data)
{
    struct job *job = data;
    conus_atlas *atlas = NULL;
    keep_first_error(job, conus_atlas_load(&atlas, job->path, NULL));
    conus_atlas_destroy(atlas);
}

static void make_selector(void *data)
{
    struct job *job = data;
    const conus_selector_options options = {.engine = job->engine};
    conus_selector *selector = NULL;
    keep_first_error(job, conus_selector_create(&selector, job->atlas, &options));
    conus_selector_destroy(selector);
}

static void run_query(void *data)
{
    struct job *job = data;
    char *arguments[] = {(char *)job->program,
                         "query",
                         (char *)job->path,
                         "--origin=-90,20,20",
                         "--toward=0,-10,10",
                         "--angle",
                         "10",
                         "--resolution",
                         "16",
                         NULL};
    keep_first_error(job, program_run(arguments));
}

/* Runs all variants once, to find errors. */
static void try_all(struct bench_variant *variants, size_t count)
{
    for (size_t v = 0; v < count; v++) {
        struct job *job = variants[v].data;
        variants[v].run(job);
        variants[v].equal = !job->status;
    }
}

static conus_status measure_loading(struct bench *bench, struct job *labels, struct job *brain)
{
    struct job rays = *labels, gl = *labels;
    rays.engine = CONUS_ENGINE_RAYS;
    gl.engine = CONUS_ENGINE_GL;
    struct bench_variant variants[] = {{.name = "labelled volume, from memory", .run = load_atlas, .data = labels},
                                       {.name = "brain phantom, from memory", .run = load_atlas, .data = brain},
                                       {.name = "labelled volume, selector, rays", .run = make_selector, .data = &rays},
                                       {.name = "labelled volume, selector, gl", .run = make_selector, .data = &gl}};
    size_t count = sizeof variants / sizeof *variants;
    try_all(variants, count);
    if (gl.status == CONUS_ERROR_GL) {
        conus_status status = bench_leave_out(bench, "startup by OpenGL");
        count--;
        if (status) {
            return status;
        }
    }
    return bench_measure(bench, "startup", variants, count, 1, 0);
}

static double seconds_of(const struct timeval *time)
{
    return (double)time->tv_sec + (double)time->tv_usec * 1e-6;
}

/* Processor time of one process, which other programs hardly disturb. */
static double cpu_of(void run(void *), struct job *job)
{
    struct rusage before, after;
    getrusage(RUSAGE_CHILDREN, &before);
    for (int i = 0; i < PROCESSES; i++) {
        run(job);
    }
    getrusage(RUSAGE_CHILDREN, &after);
    return (seconds_of(&after.ru_utime) + seconds_of(&after.ru_stime) - seconds_of(&before.ru_utime) -
            seconds_of(&before.ru_stime)) /
           PROCESSES;
}

static conus_status measure_query(struct bench *bench, struct job *labels)
{
    char program[PATH_SIZE];
    if (program_find(program, sizeof program, "conus", "CONUS")) {
        return bench_leave_out(bench, "conus query");
    }
    labels->program = program;
    struct bench_variant variant = {.name = "conus query, whole process", .run = run_query, .data = labels};
    try_all(&variant, 1);
    double cpu_s = cpu_of(run_query, labels);
    conus_status status = bench_measure(bench, "startup", &variant, 1, 1, 10);
    status = status ? status : bench_value(bench, "query_process_cpu_s", cpu_s, variant.equal);
    return status ? status : bench_value(bench, "query_process_s", variant.median_ms / 1e3, variant.equal);
}

conus_status bench_startup(struct bench *bench)
{
    char path[PATH_SIZE];
    struct job labels = {.path = bench->options.atlas};
    struct job brain = {.path = path};
    snprintf(path, sizeof path, "%s/brain.atlas.json", bench->folder);
    conus_status status = conus_phantom_write("brain", bench->folder, NULL);
    status = status ? status : conus_atlas_load(&labels.atlas, labels.path, NULL);
    status = status ? status : measure_loading(bench, &labels, &brain);
    status = status ? status : measure_query(bench, &labels);
    conus_atlas_destroy(labels.atlas);
    return status;
}
