/* SPDX-License-Identifier: BSD-3-Clause */
/* Processor time of conus batch against the number of poses and threads, and of conus-mpi against ranks: whole
 * processes. */
#include "base/memory.h"
#include "bench/growth/growth.h"
#include "bench/support/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_SIZE = 512, POINTS = 5, WORKERS = 3, WORDS = 24 };
enum { WORKER_POSES = 200000 };

/* A batch in processes of its own. */
struct job {
    char program[PATH_SIZE], poses[PATH_SIZE], rows[PATH_SIZE];
    char angle[32], workers[16];
    const char *atlas;
    bool by_mpi;
    conus_status status;
};

static conus_status job_init(struct job *out, const struct bench *bench, size_t poses, bool by_mpi, size_t workers)
{
    conus_atlas *atlas = NULL;
    *out = (struct job){.atlas = bench->options.atlas, .by_mpi = by_mpi};
    snprintf(out->poses, sizeof out->poses, "%s/poses-%zu.tsv", bench->folder, poses);
    snprintf(out->rows, sizeof out->rows, "%s/rows-%d-%zu.tsv", bench->folder, by_mpi, workers);
    snprintf(out->angle, sizeof out->angle, "%.10g", bench->options.angle);
    snprintf(out->workers, sizeof out->workers, "%zu", workers);
    conus_status status =
        program_find(out->program, sizeof out->program, by_mpi ? "conus-mpi" : "conus", by_mpi ? "CONUS_MPI" : "CONUS");
    if (status || access(out->poses, R_OK) == 0) {
        return status;
    }
    status = conus_atlas_load(&atlas, out->atlas, NULL);
    status =
        status ? status : program_write_poses(out->poses, poses, conus_atlas_volume(atlas, 0), bench->options.angle);
    conus_atlas_destroy(atlas);
    return status;
}

static void run_job(void *data)
{
    struct job *job = data;
    char *const mpi[] = {"/usr/bin/env", "mpirun", "--oversubscribe", "-n", job->workers, job->program};
    char *const alone[] = {job->program};
    char *const batch[] = {
        "batch", (char *)job->atlas, "--poses", job->poses, "--angle", job->angle,  "--progress",
        "none",  "--quiet",          "-o",      job->rows,  "--force", "--threads", job->by_mpi ? "1" : job->workers};
    char *words[WORDS] = {0}; /* ends with NULL */
    size_t first = job->by_mpi ? sizeof mpi / sizeof *mpi : sizeof alone / sizeof *alone;
    memcpy(words, job->by_mpi ? mpi : alone, first * sizeof *words);
    memcpy(words + first, batch, sizeof batch);
    conus_status status = program_run(words);
    job->status = job->status ? job->status : status;
}

static conus_status measure_poses(struct bench *bench, struct job jobs[POINTS], const double *x, size_t count)
{
    struct growth_curve curve = growth_begin(bench, "poses", bench->options.angle);
    struct bench_variant variants[POINTS];
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        status = job_init(&jobs[i], bench, (size_t)x[i], false, 1);
        if (!status) {
            run_job(&jobs[i]);
            variants[i] = (struct bench_variant){.run = run_job, .data = &jobs[i], .equal = !jobs[i].status};
        }
    }
    status = status ? status : growth_add(&curve, x, variants, count, 1);
    return status ? status : growth_end(&curve);
}

conus_status growth_poses(struct bench *bench)
{
    static const double x[POINTS] = {100, 1000, 10000, 100000, 1000000};
    struct job jobs[POINTS];
    bench->one_thread = false;
    bench->children = true;
    conus_status status = measure_poses(bench, jobs, x, growth_sizes(bench, POINTS));
    bench->one_thread = true;
    bench->children = false;
    return status == CONUS_ERROR_ARGUMENT ? bench_leave_out(bench, "growth of poses") : status;
}

/* Whether the files have the same bytes. */
static bool same_files(const char *a, const char *b)
{
    enum { BLOCK = 1 << 16 };
    static char bytes[2][BLOCK];
    FILE *files[2] = {fopen(a, "rb"), fopen(b, "rb")};
    bool same = files[0] && files[1];
    for (size_t count = BLOCK; same && count == BLOCK;) {
        count = fread(bytes[0], 1, BLOCK, files[0]);
        same = fread(bytes[1], 1, BLOCK, files[1]) == count && memcmp(bytes[0], bytes[1], count) == 0;
    }
    for (int i = 0; i < 2; i++) {
        if (files[i]) {
            fclose(files[i]);
        }
    }
    return same;
}

/* @p first: rows of one thread, with which all are compared. */
static conus_status measure_workers(struct bench *bench, const char *name, bool by_mpi, const struct job *first)
{
    static const double x[WORKERS] = {1, 2, 4};
    struct growth_curve curve = growth_begin(bench, name, bench->options.angle);
    struct job jobs[WORKERS];
    struct bench_variant variants[WORKERS];
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < WORKERS && !status; i++) {
        status = job_init(&jobs[i], bench, WORKER_POSES, by_mpi, (size_t)x[i]);
        if (!status) {
            run_job(&jobs[i]);
            status = jobs[i].status;
            variants[i] = (struct bench_variant){.run = run_job, .data = &jobs[i], .per = WORKER_POSES};
            variants[i].equal = same_files(first->rows, jobs[i].rows);
        }
    }
    status = status ? status : growth_add(&curve, x, variants, WORKERS, 1);
    return status ? status : growth_end(&curve);
}

static conus_status measure_threads_and_ranks(struct bench *bench)
{
    struct job first;
    conus_status status = job_init(&first, bench, WORKER_POSES, false, 0);
    snprintf(first.workers, sizeof first.workers, "1");
    if (!status) {
        run_job(&first);
        status = first.status;
    }
    status = status ? status : measure_workers(bench, "threads", false, &first);
    if (status) {
        return status == CONUS_ERROR_ARGUMENT ? bench_leave_out(bench, "growth of threads") : status;
    }
    status = measure_workers(bench, "ranks", true, &first);
    return status == CONUS_ERROR_ARGUMENT ? bench_leave_out(bench, "growth of ranks") : status;
}

/* OpenMPI asks before root runs it, and its hwloc opens the X display :0. */
conus_status growth_ranks(struct bench *bench)
{
    if (bench->options.check) {
        return CONUS_OK; /* mpirun takes longer than all else; the tests of conus-mpi compare its rows */
    }
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
    setenv("HWLOC_COMPONENTS", "-gl", 0);
    bench->one_thread = false;
    bench->children = true;
    conus_status status = measure_threads_and_ranks(bench);
    bench->one_thread = true;
    bench->children = false;
    return status;
}
