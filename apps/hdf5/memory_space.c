/* SPDX-License-Identifier: BSD-3-Clause */
/* The memory of a libhdf5 that others have built: all space of this process has a limit, as Linux has it. */
#include "memory_limit.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

/* The address space that is in use, bytes; 0 where nothing says so. */
static uint64_t space_in_use(void)
{
    char line[128] = ""; /* pages, and more */
    FILE *file = fopen("/proc/self/statm", "r");
    bool is_read = file && fgets(line, sizeof line, file);
    if (file) {
        fclose(file);
    }
    return is_read ? strtoull(line, NULL, 10) * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

void memory_allow(uint64_t bytes)
{
    static uint64_t space;
    struct rlimit limit;
    space = space ? space : space_in_use();
    if (space && !__builtin_add_overflow(space, bytes, &space) && getrlimit(RLIMIT_AS, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max < space ? limit.rlim_max : space;
        setrlimit(RLIMIT_AS, &limit);
    }
}
