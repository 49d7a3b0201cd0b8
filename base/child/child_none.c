/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for the programs that read with a large library, where no program can be started: in WebAssembly. */
#include "base/child/child.h"

conus_status child_find(char **path, const struct child_program *program)
{
    (void)path;
    return fail(CONUS_ERROR_UNSUPPORTED,
                "%s reads this, which WebAssembly (a web page, npx) cannot start; the program conus can",
                program->name);
}

conus_status child_run(struct bytes *rest, const struct child_task *task)
{
    (void)rest;
    char *path = NULL;
    return child_find(&path, task->program);
}
