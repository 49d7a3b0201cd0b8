/* SPDX-License-Identifier: BSD-3-Clause */
/* From nothing to an answer: loading an atlas from files and from a pack, making a selector, and the whole program. */
#include "base/memory.h"
#include "bench/support/bench.h"
#include "conus/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

/* Unpacks the atlas, and nothing else: what a program must do that has no pack. */
static void run_gzip(void *data)
{
    struct job *job = data;
    char *arguments[] = {"/bin/gzip", "-dc", (char *)job->path, NULL};
    keep_first_error(job, program_run(arguments));
}

/* The rows of a cone; memory_free() them. */
static conus_status ask(char **rows, const char *path)
{
    conus_atlas *atlas = NULL;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    conus_pose pose;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_atlas_load(&atlas, path, NULL);
    status = status ? status : conus_selector_create(&selector, atlas, NULL);
    status = status ? status : conus_pose_toward(&pose, (double[]){-90, 20, 20}, (double[]){0, -10, 10}, NULL);
    status = status ? status : conus_select(&selection, selector, &pose, 11.5);
    status = status ? status : conus_report_create(&report, selector, NULL);
    status = status ? status : conus_report_add(report, "1", selection);
    status = status ? status : conus_report_text(&text, &size, report);
    *rows = status ? NULL : memory_text(text, size);
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
    return status;
}

/* Packs the atlas at `files` to `path`; an error where the pack gives other rows. */
static conus_status make_pack(struct job *out, const char *path, const struct job *files)
{
    conus_atlas *atlas = NULL;
    char *rows[2] = {NULL, NULL};
    conus_status status = conus_atlas_load(&atlas, files->path, NULL);
    status = status ? status : conus_atlas_save(path, atlas, NULL);
    status = status ? status : ask(&rows[0], files->path);
    status = status ? status : ask(&rows[1], path);
    if (!status && (!rows[0] || !rows[1] || strcmp(rows[0], rows[1]) != 0)) {
        status = fail(CONUS_ERROR_DATA, "%s: gives other rows than %s", path, files->path);
    }
    memory_free(rows[0]);
    memory_free(rows[1]);
    conus_atlas_destroy(atlas);
    *out = (struct job){.path = path, .program = files->program, .status = status};
    return status;
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
    struct job packs[2];
    char paths[2][PATH_SIZE];
    snprintf(paths[0], PATH_SIZE, "%s/labels.conus", bench->folder);
    snprintf(paths[1], PATH_SIZE, "%s/brain.conus", bench->folder);
    if (make_pack(&packs[0], paths[0], labels) || make_pack(&packs[1], paths[1], brain)) {
        return packs[0].status ? packs[0].status : packs[1].status;
    }
    rays.engine = CONUS_ENGINE_RAYS;
    gl.engine = CONUS_ENGINE_GL;
    struct bench_variant variants[] = {{.name = "labelled volume, from memory", .run = load_atlas, .data = labels},
                                       {.name = "labelled volume, from a pack", .run = load_atlas, .data = &packs[0]},
                                       {.name = "brain phantom, from memory", .run = load_atlas, .data = brain},
                                       {.name = "brain phantom, from a pack", .run = load_atlas, .data = &packs[1]},
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
    char program[PATH_SIZE], path[PATH_SIZE];
    if (program_find(program, sizeof program, "conus", "CONUS")) {
        return bench_leave_out(bench, "conus query");
    }
    labels->program = program;
    struct job gzip = *labels;
    struct job pack;
    snprintf(path, sizeof path, "%s/labels.conus", bench->folder);
    conus_status status = make_pack(&pack, path, labels);
    if (status) {
        return status;
    }
    struct bench_variant variants[] = {{.name = "conus query, whole process", .run = run_query, .data = labels},
                                       {.name = "conus query of a pack", .run = run_query, .data = &pack}};
    try_all(variants, 2);
    double cpu_s = cpu_of(run_query, labels), pack_cpu_s = cpu_of(run_query, &pack),
           gzip_cpu_s = cpu_of(run_gzip, &gzip);
    status = bench_measure(bench, "startup", variants, 2, 1, 10);
    status = status ? status : bench_value(bench, "query_process_cpu_s", cpu_s, variants[0].equal);
    status = status ? status : bench_value(bench, "query_packed_cpu_s", pack_cpu_s, variants[1].equal);
    status = status ? status : bench_value(bench, "query_process_s", variants[0].median_ms / 1e3, variants[0].equal);
    if (status || gzip.status) {
        return status ? status : bench_leave_out(bench, "gzip -dc of the atlas");
    }
    return bench_value(bench, "query_packed_over_gunzip", pack_cpu_s / gzip_cpu_s, variants[1].equal);
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
