/* SPDX-License-Identifier: BSD-3-Clause */
/* Processes as POSIX has them, and what only Linux or macOS know of them. */
#include "base/child/process.h"
#include "base/system/system.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#ifdef __linux__
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

#ifdef __GLIBC__
typedef __rlimit_resource_t limited;
#else
typedef int limited;
#endif

#ifndef CLOSE_RANGE_CLOEXEC
enum { CLOSE_RANGE_CLOEXEC = 4 };
#endif

enum { GIVEN = 3 };

/* A pipe that programs do not get. */
static bool open_pipe(int ends[2])
{
#ifdef __APPLE__
    return pipe(ends) == 0 && fcntl(ends[0], F_SETFD, FD_CLOEXEC) == 0 && fcntl(ends[1], F_SETFD, FD_CLOEXEC) == 0;
#else
    return pipe2(ends, O_CLOEXEC) == 0;
#endif
}

/* A limit that is already lower stays. The hard one may be higher, by what follows the signal of the soft one. */
static void limit_resource(limited resource, uint64_t value, uint64_t more)
{
    struct rlimit limit;
    if (getrlimit(resource, &limit) == 0) {
        limit.rlim_max = limit.rlim_max < value + more ? limit.rlim_max : value + more;
        limit.rlim_cur = limit.rlim_max < value ? limit.rlim_max : value;
        setrlimit(resource, &limit);
    }
}

/* Has the program get no descriptors but those that it is given. */
static void close_others(void)
{
#ifdef __APPLE__
    for (int i = GIVEN + 1; i < getdtablesize() && i < OPEN_MAX; i++) {
        fcntl(i, F_SETFD, FD_CLOEXEC);
    }
#elif defined                                                                                                          \
    SYS_close_range /* by its number: glibc has it since 2.34, Linux since 5.9; before, those of others stay */
    syscall(SYS_close_range, GIVEN + 1, UINT_MAX, CLOSE_RANGE_CLOEXEC);
#endif
}

/* The limits of a program of others, which gets no rights by what it runs and writes to no file. */
static void take_limits(const struct process_limits *limits)
{
#ifdef __linux__
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
#endif
    limit_resource(RLIMIT_AS, limits->space < RLIM_INFINITY ? limits->space : RLIM_INFINITY, 0);
    limit_resource(RLIMIT_CPU, limits->seconds, 1); /* SIGXCPU, and not the SIGKILL of a lack of memory */
    limit_resource(RLIMIT_CORE, 0, 0);
    limit_resource(RLIMIT_FSIZE, 0, 0); /* pipes have no size */
}

/* Descriptors of a start: reading and writing end of the pipes for stdout, for stderr and for what execv() says, and
 * what is given. All are above those that the program is to have. */
enum { OUT, ERR = 2, REPORT = 4, INPUT = 6, ENDS };

/* In the new process: becomes the program. Only calls that are allowed between fork and exec; ends in one way or the
 * other. */
static void become_program(const struct process_start *start, const int ends[ENDS])
{
    /* stdin is empty: no program of ours reads it, and a library that did would wait for ever. */
    int nothing = open("/dev/null", O_RDONLY); /* may be stdin already, so not to be closed */
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL); /* it does not outlive who asked */
#endif
    take_limits(start->limits);
    close_others();
    if (nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(ends[OUT + 1], STDOUT_FILENO) >= 0 &&
        dup2(ends[ERR + 1], STDERR_FILENO) >= 0 && (ends[INPUT] < 0 || dup2(ends[INPUT], GIVEN) >= 0)) {
        if (ends[INPUT] < 0) {
            close(GIVEN);
        }
        execv(start->path, start->words);
    }
    int error = errno;
    while (write(ends[REPORT + 1], &error, sizeof error) < 0 && errno == EINTR) {
    }
    kill(getpid(), SIGKILL);
}

/* The error of execv(), which writes nothing once it has succeeded. */
static int read_report(int ends[ENDS])
{
    int error = 0;
    ssize_t n;
    close(ends[REPORT + 1]);
    ends[REPORT + 1] = -1;
    do {
        n = read(ends[REPORT], &error, sizeof error);
    } while (n < 0 && errno == EINTR);
    return n == (ssize_t)sizeof error ? error : 0;
}

static bool move_up(int *descriptor)
{
    if (*descriptor > GIVEN) {
        return true;
    }
    int moved = fcntl(*descriptor, F_DUPFD_CLOEXEC, GIVEN + 1);
    if (moved < 0) {
        return false;
    }
    close(*descriptor);
    *descriptor = moved;
    return true;
}

static bool start_with(struct process *out, const struct process_start *start, int ends[ENDS])
{
    for (int i = 0; i < INPUT; i++) {
        if (!move_up(&ends[i])) {
            return false;
        }
    }
    pid_t pid = fork();
    if (pid == 0) {
        become_program(start, ends);
    }
    out->id = pid > 0 ? pid : 0;
    errno = pid < 0 ? errno : read_report(ends);
    if (errno) {
        int error = errno;
        process_finish(out);
        errno = error;
        return false;
    }
    out->ends[PROCESS_OUT] = ends[OUT];
    out->ends[PROCESS_ERR] = ends[ERR];
    ends[OUT] = ends[ERR] = -1;
    return true;
}

bool process_begin(struct process *out, const struct process_start *start)
{
    int ends[ENDS] = {-1, -1, -1, -1, -1, -1, -1};
    *out = (struct process){.ends = {-1, -1}};
    bool begun = open_pipe(ends + OUT) && open_pipe(ends + ERR) && open_pipe(ends + REPORT) &&
                 (start->given < 0 || (ends[INPUT] = fcntl(start->given, F_DUPFD_CLOEXEC, GIVEN + 1)) >= 0) &&
                 start_with(out, start, ends);
    int error = errno;
    for (int i = 0; i < ENDS; i++) {
        if (ends[i] >= 0) {
            close(ends[i]);
        }
    }
    errno = error;
    return begun;
}

bool process_writes(const struct process *process)
{
    return process->ends[PROCESS_OUT] >= 0 || process->ends[PROCESS_ERR] >= 0;
}

/* Reads what is there; closes the end at its own. */
static bool read_some(struct process_part *part, intptr_t *end)
{
    ssize_t n = read((int)*end, part->data, part->capacity);
    part->got = n > 0 ? (size_t)n : 0;
    if (n == 0) {
        close((int)*end);
        *end = -1;
    }
    return n >= 0 || errno == EINTR || errno == EAGAIN;
}

enum process_reading process_read(struct process_part parts[2], struct process *process, double seconds)
{
    static const double LONGEST = 1e6; /* whose milliseconds fit into an int */
    struct pollfd ends[2] = {{.fd = (int)process->ends[0], .events = POLLIN},
                             {.fd = (int)process->ends[1], .events = POLLIN}};
    parts[0].got = parts[1].got = 0;
    int ready = seconds > 0 ? poll(ends, 2, seconds < LONGEST ? (int)(1000 * seconds) + 1 : -1) : 0;
    bool fine = ready >= 0 || errno == EINTR;
    for (int i = 0; ready > 0 && fine && i < 2; i++) {
        fine = !ends[i].revents || read_some(&parts[i], &process->ends[i]);
    }
    return !fine ? PROCESS_FAILED : ready == 0 ? PROCESS_LATE : PROCESS_CAME;
}

bool process_wait(struct process_end *out, struct process *process, double seconds)
{
    static const struct timespec moment = {.tv_nsec = 1000000};
    const double deadline = process_now() + seconds;
    int how = 0;
    pid_t ended = 0;
    while (ended == 0 || (ended < 0 && errno == EINTR)) { /* it may have closed its output and still run */
        ended = waitpid((pid_t)process->id, &how, WNOHANG);
        if (ended == 0 && process_now() > deadline) {
            return false;
        }
        if (ended == 0) {
            nanosleep(&moment, NULL);
        }
    }
    process->id = 0;
    *out = (struct process_end){.kind = PROCESS_EXITED, .code = WEXITSTATUS(how)};
    if (WIFSIGNALED(how)) {
        int number = WTERMSIG(how);
        out->kind = number == SIGKILL ? PROCESS_NO_MEMORY : number == SIGXCPU ? PROCESS_NO_TIME : PROCESS_CRASHED;
        snprintf(out->how, sizeof out->how, "signal %d, %s", number, strsignal(number));
    }
    return true;
}

void process_finish(struct process *process)
{
    int how;
    if (process->id) {
        kill((pid_t)process->id, SIGKILL);
        while (waitpid((pid_t)process->id, &how, 0) < 0 && errno == EINTR) {
        }
        process->id = 0;
    }
    for (int i = 0; i < 2; i++) {
        if (process->ends[i] >= 0) {
            close((int)process->ends[i]);
            process->ends[i] = -1;
        }
    }
}
