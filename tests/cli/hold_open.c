/* SPDX-License-Identifier: BSD-3-Clause */
/* For LD_PRELOAD: a program that opens a file called $HOLD_NAME makes the file $HOLD_FOLDER/begun and waits for
 * $HOLD_FOLDER/released. So a test holds a program while it loads an atlas. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

typedef int (*open_function)(const char *path, int flags, ...);

static bool is_held(const char *path)
{
    const char *name = getenv("HOLD_NAME");
    const char *slash = strrchr(path, '/');
    return name && strcmp(slash ? slash + 1 : path, name) == 0;
}

static void hold(open_function next)
{
    char path[4096];
    const char *folder = getenv("HOLD_FOLDER");
    snprintf(path, sizeof path, "%s/begun", folder ? folder : ".");
    close(next(path, O_WRONLY | O_CREAT, 0600));
    snprintf(path, sizeof path, "%s/released", folder ? folder : ".");
    while (access(path, F_OK) != 0) {
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
}

/* All files are opened by it (base/system). */
int open(const char *path, int flags, ...)
{
    open_function next = NULL;
    void *symbol = dlsym(RTLD_NEXT, "open");
    va_list arguments;
    memcpy(&next, &symbol, sizeof next);
    va_start(arguments, flags);
    int mode = flags & O_CREAT ? va_arg(arguments, int) : 0;
    va_end(arguments);
    if (is_held(path)) {
        hold(next);
    }
    return next(path, flags, mode);
}
