/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for processes where there are none: in WebAssembly. */
#include "base/child/process.h"

#include <errno.h>

bool process_begin(struct process *out, const struct process_start *start)
{
    (void)start;
    *out = (struct process){.ends = {-1, -1}};
    errno = ENOSYS;
    return false;
}

bool process_writes(const struct process *process)
{
    (void)process;
    return false;
}

enum process_reading process_read(struct process_part parts[2], struct process *process, double seconds)
{
    (void)parts;
    (void)process;
    (void)seconds;
    return PROCESS_FAILED;
}

bool process_wait(struct process_end *out, struct process *process, double seconds)
{
    (void)out;
    (void)process;
    (void)seconds;
    return false;
}

void process_finish(struct process *process)
{
    (void)process;
}
