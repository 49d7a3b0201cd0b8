/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds and runs the programs of conus, and writes poses for them. */
#include "bench/support/bench.h"

#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/support/trace.h"

#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { SEED = 2010, AHEAD_MM = 200 };

void program_folder(char *out, size_t size)
{
    ssize_t length = readlink("/proc/self/exe", out, size - 1);
    out[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(out, '/');
    if (slash) {
        *slash = '\0';
    } else {
        snprintf(out, size, ".");
    }
}

conus_status program_find(char *out, size_t size, const char *program, const char *given)
{
    static const char *const places[] = {"", "../apps/cli/"};
    char folder[256];
    if (getenv(given)) {
        snprintf(out, size, "%s", getenv(given));
        return CONUS_OK;
    }
    program_folder(folder, sizeof folder);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        snprintf(out, size, "%s/%s%s", folder, places[i], program);
        if (access(out, X_OK) == 0) {
            return CONUS_OK;
        }
    }
    return fail(CONUS_ERROR_ARGUMENT, "there is no program %s beside conus-bench; $%s may name it", program, given);
}

conus_status program_run(char *const arguments[])
{
    posix_spawn_file_actions_t actions;
    pid_t pid;
    int how = -1;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (!posix_spawn(&pid, arguments[0], &actions, NULL, arguments, environ)) {
        while (waitpid(pid, &how, 0) < 0) {
        }
    }
    posix_spawn_file_actions_destroy(&actions);
    if (!WIFEXITED(how) || WEXITSTATUS(how) != EXIT_SUCCESS) {
        return fail(CONUS_ERROR_ARGUMENT, "%s %s %s: it failed", arguments[0], arguments[1], arguments[2]);
    }
    return CONUS_OK;
}

/* Writes the poses of cones_round_grid(), each as a position and a point at which the device points. */
conus_status program_write_poses(const char *path, size_t count, const conus_volume_info *info, double angle_deg)
{
    struct buffer text = {0};
    struct cone *cones = memory_zeroed(count, sizeof *cones);
    if (!cones) {
        return CONUS_ERROR_MEMORY;
    }
    cones_round_grid(cones, count, info, angle_deg, SEED);
    buffer_text(&text, "x\ty\tz\ttx\tty\ttz\n");
    for (size_t i = 0; i < count; i++) {
        const double *m = cones[i].pose.world_from_device;
        double target[3];
        vec3_add_scaled(target, m + 12, -AHEAD_MM, m + 8);
        buffer_format(&text, "%.3f\t%.3f\t%.3f\t%.3f\t%.3f\t%.3f\n", m[12], m[13], m[14], target[0], target[1],
                      target[2]);
    }
    conus_status status = buffer_status(&text);
    status = status ? status : file_write_soon(path, text.data, text.size);
    buffer_finish(&text);
    memory_free(cones);
    return status;
}
