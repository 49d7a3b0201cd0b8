/* SPDX-License-Identifier: BSD-3-Clause */
/* Maps files, and survives that they are cut off. */
#include "base/files/file_map.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

void *file_map(const char *path, const struct file_state *before)
{
    struct file_state now;
    struct open_file file;
    if (file_open(&file, path)) {
        return NULL;
    }
    bool is_same = file_state_of(&now, file.descriptor) && file_state_equal(&now, before);
    void *mapped = is_same ? mmap(NULL, (size_t)before->size, PROT_READ, MAP_SHARED, file.descriptor, 0) : MAP_FAILED;
    file_close(&file);
    return mapped == MAP_FAILED ? NULL : mapped;
}

/* What the handler of SIGBUS needs, which gets nothing from its caller. */
static struct {
    pthread_mutex_t turn;
    char *mapped;
    size_t size, page;
    volatile sig_atomic_t had_hole;
    struct sigaction before;
    sigset_t mask;
} guard = {.turn = PTHREAD_MUTEX_INITIALIZER};

/* Puts zeros from the page that is missing to the end. A fault elsewhere happens again, as without a guard. */
static void fill_hole(int number, siginfo_t *info, void *context)
{
    (void)context;
    int error = errno;
    size_t at = (uintptr_t)info->si_addr - (uintptr_t)guard.mapped;
    at -= at % guard.page;
    bool is_filled = at < guard.size && mmap(guard.mapped + at, guard.size - at, PROT_READ,
                                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
    if (is_filled) {
        guard.had_hole = true;
    } else {
        sigaction(number, &guard.before, NULL);
    }
    errno = error;
}

void file_guard_begin(void *mapped, size_t size)
{
    struct sigaction action = {.sa_sigaction = fill_hole, .sa_flags = SA_SIGINFO};
    sigset_t bus;
    pthread_mutex_lock(&guard.turn);
    guard.mapped = mapped;
    guard.size = size;
    guard.page = (size_t)sysconf(_SC_PAGESIZE);
    guard.had_hole = false;
    sigemptyset(&bus);
    sigaddset(&bus, SIGBUS);
    sigaction(SIGBUS, &action, &guard.before);
    pthread_sigmask(SIG_UNBLOCK, &bus, &guard.mask);
}

conus_status file_guard_end(const char *path, const struct file_state *before)
{
    bool had_hole = guard.had_hole;
    pthread_sigmask(SIG_SETMASK, &guard.mask, NULL);
    sigaction(SIGBUS, &guard.before, NULL);
    pthread_mutex_unlock(&guard.turn);
    conus_status status = file_state_check(before, path);
    return status || !had_hole ? status : fail(CONUS_ERROR_IO, "%s: cannot be read to its end", path);
}
