/* SPDX-License-Identifier: BSD-3-Clause */
/* Processor time of conus batch, a whole process, against the number of poses. */
#include "bench/growth/growth.h"
#include "bench/support/program.h"

#include <stdio.h>

enum { PATH_SIZE = 512, POINTS = 5 };

struct job {
    char program[PATH_SIZE], poses[PATH_SIZE], rows[PATH_SIZE], angle[32];
    const char *atlas;
    conus_status status;
};

static void run_job(void *data)
{
    struct job *job = data;
    char *words[] = {job->program, "batch", (char *)job->atlas, "--poses", job->poses, "--angle", job->angle,
                     "--progress", "none",  "--quiet",          "-o",      job->rows,  "--force", "--threads",
                     "1",          NULL};
    conus_status status = program_run(words);
    job->status = job->status ? job->status : status;
}

static conus_status measure_poses(struct bench *bench, const conus_volume_info *volume)
{
    static const double x[POINTS] = {100, 1000, 10000, 100000, 1000000};
    struct growth_curve curve = growth_begin(bench, "poses", bench->options.angle);
    struct job jobs[POINTS];
    struct bench_variant variants[POINTS];
    size_t count = growth_sizes(bench, POINTS);
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        struct job *job = &jobs[i];
        *job = (struct job){.atlas = bench->options.atlas};
        snprintf(job->poses, sizeof job->poses, "%s/poses-%zu.tsv", bench->folder, i);
        snprintf(job->rows, sizeof job->rows, "%s/rows-%zu.tsv", bench->folder, i);
        snprintf(job->angle, sizeof job->angle, "%.10g", bench->options.angle);
        status = program_find(job->program, sizeof job->program, "conus", "CONUS");
        status = status ? status : program_write_poses(job->poses, (size_t)x[i], volume, bench->options.angle);
        if (!status) {
            run_job(job);
            variants[i] = (struct bench_variant){.run = run_job, .data = job, .equal = !job->status};
        }
    }
    status = status ? status : growth_add(&curve, x, variants, count, 1);
    return status ? status : growth_end(&curve);
}

conus_status growth_poses(struct bench *bench)
{
    conus_atlas *atlas = NULL;
    bench->one_thread = false;
    bench->children = true;
    conus_status status = conus_atlas_load(&atlas, bench->options.atlas, NULL);
    status = status ? status : measure_poses(bench, conus_atlas_volume(atlas, 0));
    conus_atlas_destroy(atlas);
    bench->one_thread = true;
    bench->children = false;
    return status == CONUS_ERROR_ARGUMENT ? bench_leave_out(bench, "growth of poses") : status;
}
