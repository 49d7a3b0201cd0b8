/* SPDX-License-Identifier: BSD-3-Clause */
/* The Python package beside the program: from the path of an atlas and a table of poses to all answers. */
#include "bench/support/bench.h"

#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { PATH_SIZE = 512, MANY = 0, BATCH, BATCH_READ, WAYS };

/* A Python that has imported conus, and the arguments of conus batch. */
struct scene {
    pid_t python;
    FILE *to, *from;
    char program[PATH_SIZE], poses[PATH_SIZE], rows[PATH_SIZE], angle[32];
    const char *atlas;
    conus_status status;
};

/* Starts a child with a socket as its standard input and output. */
static bool spawn_python(struct scene *scene, char *const arguments[])
{
    int ends[2];
    posix_spawn_file_actions_t actions;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends)) {
        return false;
    }
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    bool began = posix_spawn(&scene->python, arguments[0], &actions, NULL, arguments, environ) == 0;
    scene->python = began ? scene->python : 0;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    scene->from = fdopen(ends[0], "r");
    scene->to = fdopen(dup(ends[0]), "w");
    return began && scene->to && scene->from;
}

/* Whether Python's next line is @p wanted. */
static bool answers_with(struct scene *scene, const char *wanted)
{
    char line[64];
    return fgets(line, sizeof line, scene->from) && strncmp(line, wanted, strlen(wanted)) == 0;
}

static void keep_first_error(struct scene *scene, conus_status status)
{
    scene->status = scene->status ? scene->status : status;
}

static void ask(struct scene *scene, const char *question, const char *answer)
{
    if (scene->status) {
        return; /* Python may have ended */
    }
    fprintf(scene->to, "%s\n", question);
    fflush(scene->to);
    if (!answers_with(scene, answer)) {
        keep_first_error(scene, fail(CONUS_ERROR_DATA, "select_many.py did not answer %s to %s", answer, question));
    }
}

static conus_status start_python(struct scene *scene)
{
    char folder[PATH_SIZE / 2], path[PATH_SIZE];
    program_folder(folder, sizeof folder);
    snprintf(path, sizeof path, "%s/../python", folder);
    setenv("PYTHONPATH", path, 0);
    char *arguments[] = {
        CONUS_PYTHON, CONUS_BENCH_WORKER, (char *)scene->atlas, scene->poses, scene->rows, scene->angle, NULL};
    if (!spawn_python(scene, arguments) || !answers_with(scene, "ready")) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s cannot import conus and pandas", CONUS_PYTHON);
    }
    return CONUS_OK;
}

static void finish_scene(struct scene *scene)
{
    if (scene->to) {
        fclose(scene->to);
    }
    if (scene->from) {
        fclose(scene->from);
    }
    while (scene->python && waitpid(scene->python, NULL, 0) < 0) {
    }
}

static void run_select_many(void *data)
{
    ask(data, "many", "done");
}

static void run_batch(void *data)
{
    struct scene *scene = data;
    char *arguments[] = {
        scene->program, "batch", (char *)scene->atlas, "--poses", scene->poses, "--angle", scene->angle,
        "--resolution", "16",    "--progress",         "none",    "-q",         "--force", "-o",
        scene->rows,    NULL};
    keep_first_error(scene, program_run(arguments));
}

static void run_batch_and_read(void *data)
{
    run_batch(data);
    ask(data, "read", "done");
}

static conus_status prepare(struct scene *scene, const struct bench *bench)
{
    conus_atlas *atlas = NULL;
    snprintf(scene->angle, sizeof scene->angle, "%.17g", bench->options.angle);
    snprintf(scene->poses, sizeof scene->poses, "%s/poses.tsv", bench->folder);
    snprintf(scene->rows, sizeof scene->rows, "%s/rows.tsv", bench->folder);
    conus_status status = bench_load_labels(&atlas, scene->atlas);
    if (!status) {
        status = program_write_poses(scene->poses, bench->options.poses, &atlas->volumes[0].info, bench->options.angle);
    }
    conus_atlas_destroy(atlas);
    return status;
}

static conus_status measure(struct bench *bench, struct scene *scene)
{
    struct bench_variant variants[WAYS] = {
        {.name = "select_many(), to a DataFrame", .run = run_select_many, .data = scene},
        {.name = "conus batch, whole process, to a file", .run = run_batch, .data = scene},
        {.name = "conus batch, and read_csv() of the file", .run = run_batch_and_read, .data = scene}};
    run_select_many(scene);
    run_batch_and_read(scene);
    ask(scene, "same", "yes");
    for (size_t i = 0; i < WAYS; i++) {
        variants[i].equal = !scene->status;
    }
    conus_status status = bench_measure(bench, "python", variants, WAYS, bench->options.poses, bench->options.angle);
    status = status ? status : bench_ratio(bench, "python_over_batch", &variants[BATCH], &variants[MANY]);
    return status ? status : bench_ratio(bench, "python_over_batch_and_read", &variants[BATCH_READ], &variants[MANY]);
}

conus_status bench_python(struct bench *bench)
{
    struct scene scene = {.atlas = bench->options.atlas};
    conus_status status = prepare(&scene, bench);
    if (!status && (program_find(scene.program, sizeof scene.program, "conus", "CONUS") || start_python(&scene))) {
        status = bench_leave_out(bench, "the Python package");
    } else if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", CONUS_PYTHON);
        status = measure(bench, &scene);
    }
    finish_scene(&scene);
    return status;
}
