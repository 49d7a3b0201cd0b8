/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds a program, starts it, and takes what it writes. */
#include "base/child/child.h"

#include "base/memory.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#ifndef CLOSE_RANGE_CLOEXEC
enum { CLOSE_RANGE_CLOEXEC = 4 };
#endif

enum { WORDS_SIZE = 512, INPUT_DESCRIPTOR = 3, READ_SIZE = 1 << 20 };

/* Monotonic: setting the date does not move a deadline. */
static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool is_program(const char *path)
{
    return file_exists(path) && access(path, X_OK) == 0;
}

/* "folder/program" if it is there. NULL in *found otherwise. */
static conus_status look_in(char **found, const char *program, const char *folder, size_t length)
{
    struct buffer path = {0};
    buffer_append(&path, folder, length);
    buffer_format(&path, "/%s", program);
    conus_status status = buffer_status(&path);
    if (!status && length && is_program(path.data)) {
        *found = path.data;
        return CONUS_OK;
    }
    buffer_finish(&path);
    return status;
}

/* The program that the environment names. */
static conus_status take_chosen(char **path, const char *chosen, const struct child_program *program)
{
    if (!is_program(chosen)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s: %s is no program; %s is needed (Debian package %s)",
                    program->variable, chosen, program->name, program->name);
    }
    char *found = memory_text(chosen, strlen(chosen));
    if (!found) {
        return CONUS_ERROR_MEMORY;
    }
    *path = found;
    return CONUS_OK;
}

int child_create_input(const char *name)
{
    return memfd_create(name, MFD_CLOEXEC);
}

conus_status child_find(char **path, const struct child_program *program)
{
    const char *chosen = getenv(program->variable);
    if (chosen && *chosen) {
        return take_chosen(path, chosen, program);
    }
    char *found = NULL;
    char self[SYSTEM_PATH];
    size_t length = system_program(self) ? path_folder_length(self) : 0;
    conus_status status = length > 1 ? look_in(&found, program->name, self, length - 1) : CONUS_OK;
    const char *list = getenv("PATH");
    struct text rest = text_from(list ? list : "");
    struct text folder;
    for (bool more = true; !status && !found && text_field(&rest, ':', &more, &folder);) {
        status = look_in(&found, program->name, folder.data, folder.size);
    }
    if (!status && !found) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "the program %s is not installed (Debian package %s): it is neither beside this program nor in "
                    "PATH nor named by %s",
                    program->name, program->name, program->variable);
    }
    if (!status) {
        *path = found;
    }
    return status;
}

struct child {
    const struct child_task *task;
    const char *name;
    pid_t pid; /* 0 = none, or already waited for */
    int out, err;
    double deadline; /* monotonic seconds */
    uint8_t *data;   /* what came and is not used */
    size_t size, capacity;
    char words[WORDS_SIZE]; /* the beginning of what it said on stderr */
    size_t word_count;
};

static conus_status fail_system(const struct child *child, const char *action)
{
    return fail(CONUS_ERROR_IO, "%s: cannot %s: %s", child->name, action, strerror(errno));
}

/* A limit that is already lower stays. The hard one may be higher, by what follows the signal of the soft one. */
static void limit_resource(__rlimit_resource_t resource, uint64_t value, uint64_t more)
{
    struct rlimit limit;
    if (getrlimit(resource, &limit) == 0) {
        limit.rlim_max = limit.rlim_max < value + more ? limit.rlim_max : value + more;
        limit.rlim_cur = limit.rlim_max < value ? limit.rlim_max : value;
        setrlimit(resource, &limit);
    }
}

/* Descriptors of a start: reading and writing end of the pipes for stdout, for stderr and for what execv() says, and
 * the input. All are above those that the program is to have. */
enum { OUT, ERR = 2, REPORT = 4, INPUT = 6, ENDS };

/* By its number: glibc has close_range() since 2.34, Linux since 5.9. Before, descriptors that others left open stay. */
static void close_others(void)
{
#ifdef SYS_close_range
    syscall(SYS_close_range, INPUT_DESCRIPTOR + 1, UINT_MAX, CLOSE_RANGE_CLOEXEC);
#endif
}

/* In the new process: becomes the program, which gets no rights by what it runs, writes to no file, and has no
 * descriptors but those that it is given. Only calls that are allowed between fork and exec; ends in one way or the
 * other. */
static void become_program(const char *path, const struct child_task *task, const int ends[ENDS])
{
    /* stdin is empty: no program of ours reads it, and a library that did would wait for ever. */
    int nothing = open("/dev/null", O_RDONLY); /* may be stdin already, so not to be closed */
    prctl(PR_SET_PDEATHSIG, SIGKILL);          /* it does not outlive who asked */
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    uint64_t space = task->limits.memory + task->limits.beside;
    limit_resource(RLIMIT_AS, space < task->limits.memory ? RLIM_INFINITY : space, 0);
    limit_resource(RLIMIT_CPU, task->limits.seconds, 1); /* SIGXCPU, and not the SIGKILL of a lack of memory */
    limit_resource(RLIMIT_CORE, 0, 0);
    limit_resource(RLIMIT_FSIZE, 0, 0); /* pipes have no size */
    close_others();
    if (nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(ends[OUT + 1], STDOUT_FILENO) >= 0 &&
        dup2(ends[ERR + 1], STDERR_FILENO) >= 0 && dup2(ends[INPUT], INPUT_DESCRIPTOR) >= 0) {
        execv(path, task->words);
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
    if (*descriptor > INPUT_DESCRIPTOR) {
        return true;
    }
    int moved = fcntl(*descriptor, F_DUPFD_CLOEXEC, INPUT_DESCRIPTOR + 1);
    if (moved < 0) {
        return false;
    }
    close(*descriptor);
    *descriptor = moved;
    return true;
}

static conus_status start_with(struct child *child, const char *path, int ends[ENDS])
{
    for (int i = 0; i < ENDS; i++) {
        if (ends[i] < 0 || !move_up(&ends[i])) {
            return fail_system(child, "start");
        }
    }
    pid_t pid = fork();
    if (pid < 0) {
        return fail_system(child, "start");
    }
    if (pid == 0) {
        become_program(path, child->task, ends);
    }
    child->pid = pid;
    errno = read_report(ends);
    if (errno) {
        return fail_system(child, "start");
    }
    child->deadline = seconds_now() + child->task->limits.wait;
    child->out = ends[OUT];
    child->err = ends[ERR];
    ends[OUT] = ends[ERR] = -1;
    return CONUS_OK;
}

static conus_status start_child(struct child *child, const char *path)
{
    int ends[ENDS] = {-1, -1, -1, -1, -1, -1, -1};
    conus_status status = CONUS_OK;
    if (pipe2(ends + OUT, O_CLOEXEC) || pipe2(ends + ERR, O_CLOEXEC) || pipe2(ends + REPORT, O_CLOEXEC) ||
        (ends[INPUT] = fcntl(child->task->descriptor, F_DUPFD_CLOEXEC, INPUT_DESCRIPTOR + 1)) < 0) {
        status = fail_system(child, "start");
    }
    status = status ? status : start_with(child, path, ends);
    for (int i = 0; i < ENDS; i++) {
        if (ends[i] >= 0) {
            close(ends[i]);
        }
    }
    return status;
}

/* Capacity for the `wanted` bytes of the next step, and for one more reading. */
static conus_status child_reserve(struct child *child, size_t wanted)
{
    size_t most = wanted > child->size ? wanted : child->size;
    size_t needed = wanted > child->size + READ_SIZE ? wanted : child->size + READ_SIZE;
    if (most > child->task->limits.memory) {
        return fail(CONUS_ERROR_MEMORY, "%s: an answer of %zu bytes, allowed are %llu (--max-memory)", child->name,
                    most, (unsigned long long)child->task->limits.memory);
    }
    if (needed > child->capacity) {
        uint8_t *grown = memory_resize(child->data, needed + needed / 2, 1);
        if (!grown) {
            return CONUS_ERROR_MEMORY;
        }
        child->data = grown;
        child->capacity = needed + needed / 2;
    }
    return CONUS_OK;
}

static conus_status take_output(struct child *child)
{
    size_t used = 0;
    size_t wanted = 0;
    const struct child_task *task = child->task;
    conus_status status = task->take ? task->take(task->user, &used, &wanted, child->data, child->size) : CONUS_OK;
    if (!status && used) {
        child->size -= used;
        memmove(child->data, child->data + used, child->size);
    }
    return status ? status : child_reserve(child, wanted);
}

/* Reads what is there; closes *descriptor at its end. */
static conus_status read_some(const struct child *child, int *descriptor, uint8_t *data, size_t capacity, size_t *got)
{
    ssize_t n = read(*descriptor, data, capacity);
    *got = n > 0 ? (size_t)n : 0;
    if (n < 0 && errno != EINTR && errno != EAGAIN) {
        return fail_system(child, "read what it writes");
    }
    if (n == 0) {
        close(*descriptor);
        *descriptor = -1;
    }
    return CONUS_OK;
}

static conus_status read_words(struct child *child)
{
    uint8_t rest[WORDS_SIZE];
    size_t got = 0;
    conus_status status = read_some(child, &child->err, rest, sizeof rest, &got);
    size_t capacity = WORDS_SIZE - 1 - child->word_count;
    size_t kept = got < capacity ? got : capacity;
    memcpy(child->words + child->word_count, rest, kept);
    child->word_count += kept;
    return status;
}

static conus_status fail_late(const struct child *child)
{
    return fail(CONUS_ERROR_DATA, "%s: no end after %u seconds", child->name, child->task->limits.wait);
}

static conus_status read_output(struct child *child)
{
    struct pollfd ends[2] = {{.fd = child->out, .events = POLLIN}, {.fd = child->err, .events = POLLIN}};
    double left = child->deadline - seconds_now();
    int ready = left > 0 ? poll(ends, 2, (int)(1000 * left) + 1) : 0;
    if (ready == 0) {
        return fail_late(child);
    }
    if (ready < 0) {
        return errno == EINTR ? CONUS_OK : fail_system(child, "wait for it");
    }
    conus_status status = ends[1].revents ? read_words(child) : CONUS_OK;
    if (status || !ends[0].revents) {
        return status;
    }
    size_t got = 0;
    status = read_some(child, &child->out, child->data + child->size, child->capacity - child->size, &got);
    child->size += got;
    return status || !got ? status : take_output(child);
}

static conus_status check_exit(const struct child *child, int how)
{
    if (WIFSIGNALED(how)) {
        int number = WTERMSIG(how);
        if (number == SIGKILL) {
            return fail(CONUS_ERROR_MEMORY, "%s: killed, most likely since the computer had no memory left",
                        child->name);
        }
        return number == SIGXCPU ? fail(CONUS_ERROR_DATA, "%s: no end after %u seconds of work", child->name,
                                        child->task->limits.seconds)
                                 : fail(CONUS_ERROR_DATA, "%s: %s crashed (signal %d, %s)", child->name,
                                        child->task->program->library, number, strsignal(number));
    }
    if (WEXITSTATUS(how)) {
        struct text rest = {child->words, child->word_count};
        struct text line = {0};
        text_line(&rest, &line);
        return fail(CONUS_ERROR_DATA, "%s: %.*s (exit code %d)", child->name, (int)line.size,
                    line.size ? line.data : "", WEXITSTATUS(how));
    }
    return CONUS_OK;
}

/* Waits for the end of the program, which may have closed its output and still run. */
static conus_status await_end(const struct child *child, int *how)
{
    static const struct timespec moment = {.tv_nsec = 1000000};
    pid_t ended = 0;
    while (ended == 0 || (ended < 0 && errno == EINTR)) {
        ended = waitpid(child->pid, how, WNOHANG);
        if (ended == 0 && seconds_now() > child->deadline) {
            return fail_late(child);
        }
        if (ended == 0) {
            nanosleep(&moment, NULL);
        }
    }
    return CONUS_OK;
}

static conus_status finish_child(struct child *child, conus_status status)
{
    int how = 0;
    status = status ? status : await_end(child, &how);
    if (status && child->pid) {
        kill(child->pid, SIGKILL);
        while (waitpid(child->pid, &how, 0) < 0 && errno == EINTR) {
        }
    }
    if (child->out >= 0) {
        close(child->out);
    }
    if (child->err >= 0) {
        close(child->err);
    }
    return status ? status : check_exit(child, how);
}

conus_status child_run(struct bytes *rest, const struct child_task *task)
{
    char *path = NULL;
    struct child child = {.task = task, .name = task->program->name, .out = -1, .err = -1};
    conus_status status = child_find(&path, task->program);
    if (status) {
        return status;
    }
    status = start_child(&child, path);
    memory_free(path);
    status = status ? status : child_reserve(&child, 0);
    while (!status && (child.out >= 0 || child.err >= 0)) {
        status = read_output(&child);
    }
    status = finish_child(&child, status);
    if (status) {
        memory_free(child.data);
        return status;
    }
    *rest = (struct bytes){child.data, child.size};
    return CONUS_OK;
}
