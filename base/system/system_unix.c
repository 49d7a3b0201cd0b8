/* SPDX-License-Identifier: BSD-3-Clause */
/* The system as POSIX has it, and what only Linux or macOS have. */
#include "base/system/system.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#ifdef __linux__
#include <sys/auxv.h>
#elif defined __APPLE__
#include <crt_externs.h>
#include <mach-o/dyld.h>
#include <sys/random.h>
#include <xlocale.h>
#define st_mtim st_mtimespec
#define st_ctim st_ctimespec
#endif

static bool take_stat(struct system_stat *out, const struct stat *info)
{
    *out = (struct system_stat){.device = (uint64_t)info->st_dev,
                                .inode = (uint64_t)info->st_ino,
                                .size = (uint64_t)info->st_size,
                                .changed = info->st_mtim,
                                .altered = info->st_ctim,
                                .kind = S_ISREG(info->st_mode)    ? SYSTEM_FILE
                                        : S_ISDIR(info->st_mode)  ? SYSTEM_FOLDER
                                        : S_ISLNK(info->st_mode)  ? SYSTEM_LINK
                                        : S_ISFIFO(info->st_mode) ? SYSTEM_PIPE
                                                                  : SYSTEM_OTHER};
    return true;
}

bool system_stat(struct system_stat *out, const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && take_stat(out, &info);
}

bool system_stat_link(struct system_stat *out, const char *path)
{
    struct stat info;
    return lstat(path, &info) == 0 && take_stat(out, &info);
}

bool system_stat_open(struct system_stat *out, int file)
{
    struct stat info;
    return fstat(file, &info) == 0 && take_stat(out, &info);
}

bool system_allows(const char *path, unsigned how)
{
    return access(path, (how & SYSTEM_READ ? R_OK : 0) | (how & SYSTEM_WRITE ? W_OK : 0) |
                            (how & SYSTEM_RUN ? X_OK : 0)) == 0;
}

int system_open(const char *path, unsigned how)
{
    static const int flags[] = {O_APPEND, O_CREAT, O_CREAT | O_EXCL, O_TRUNC, O_NONBLOCK};
    int all = O_CLOEXEC | O_NOCTTY | (!(how & SYSTEM_WRITE) ? O_RDONLY : how & SYSTEM_READ ? O_RDWR : O_WRONLY);
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++) {
        all |= how & (unsigned)SYSTEM_APPEND << i ? flags[i] : 0;
    }
    return open(path, all, 0666);
}

int system_open_temporary(char *path, size_t ending, bool for_us_alone)
{
    int file = mkostemps(path, (int)ending, O_CLOEXEC);
    if (file >= 0 && !for_us_alone) {
#ifdef __EMSCRIPTEN__ /* whose umask() is not node's: system_node.js takes that */
        mode_t mask = 0;
#else
        mode_t mask = umask(0);
        umask(mask);
#endif
        if (fchmod(file, 0666 & ~mask)) {
            int error = errno;
            close(file);
            unlink(path);
            errno = error;
            file = -1;
        }
    }
    return file;
}

int system_open_nameless(const char *folder)
{
#ifdef O_TMPFILE
    return access("/proc/self/fd", F_OK) ? -1 : open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
#else
    (void)folder;
    errno = ENOSYS;
    return -1;
#endif
}

int system_open_scratch(const char *name)
{
#ifdef __linux__
    return memfd_create(name, MFD_CLOEXEC);
#else
    char path[SYSTEM_PATH];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/%s-XXXXXX", folder && *folder ? folder : "/tmp", name);
    int file = system_open_temporary(path, 0, true);
    if (file >= 0) {
        unlink(path);
    }
    return file;
#endif
}

/* The name by which an open file can be opened again. There is no such one on macOS, whose /dev/fd has copies. */
static void name_open(char out[32], int file)
{
    snprintf(out, 32, "/proc/self/fd/%d", file);
}

bool system_name(int file, const char *path)
{
    char own[32];
    name_open(own, file);
    return linkat(AT_FDCWD, own, AT_FDCWD, path, AT_SYMLINK_FOLLOW) == 0;
}

int system_copy(int file)
{
    return fcntl(file, F_DUPFD_CLOEXEC, 0);
}

FILE *system_stream(const char *path, const char *how)
{
    char all[8];
    snprintf(all, sizeof all, "%se", how);
    return fopen(path, all);
}

ptrdiff_t system_read(int file, void *out, size_t size)
{
    return read(file, out, size);
}

ptrdiff_t system_read_at(int file, void *out, size_t size, uint64_t at)
{
    size_t got = 0;
    for (ssize_t n = 1; n && got<size; got += n> 0 ? (size_t)n : 0) {
        n = pread(file, (char *)out + got, size - got, (off_t)(at + got));
        if (n < 0 && errno != EINTR) {
            return -1;
        }
    }
    return (ptrdiff_t)got;
}

bool system_write_at(int file, const void *data, size_t size, uint64_t at)
{
    for (size_t done = 0; done < size;) {
        ssize_t n = pwrite(file, (const char *)data + done, size - done, (off_t)(at + done));
        if (n < 0 && errno != EINTR) {
            return false;
        }
        done += n > 0 ? (size_t)n : 0;
    }
    return true;
}

bool system_write(int file, const void *data, size_t size)
{
    for (size_t done = 0; done < size;) {
        ssize_t n = write(file, (const char *)data + done, size - done);
        if (n < 0 && errno != EINTR) {
            return false;
        }
        done += n > 0 ? (size_t)n : 0;
    }
    return true;
}

bool system_to_disk(int file)
{
#ifdef F_FULLFSYNC /* of macOS, whose fsync() leaves it in the disk's own memory */
    return fcntl(file, F_FULLFSYNC) == 0 || fsync(file) == 0;
#else
    return fsync(file) == 0;
#endif
}

bool system_rename(const char *from, const char *to, bool replace)
{
    if (replace) {
        return rename(from, to) == 0;
    }
    bool is_new = linkat(AT_FDCWD, from, AT_FDCWD, to, 0) == 0; /* unlike rename(), never in the place of another */
    if (is_new) {
        unlink(from);
    }
    return is_new;
}

bool system_remove(const char *path)
{
    return unlink(path) == 0;
}

bool system_make_folder(const char *path, bool for_us_alone)
{
    return mkdir(path, for_us_alone ? 0700 : 0777) == 0;
}

bool system_remove_folder(const char *path)
{
    return rmdir(path) == 0;
}

bool system_link(const char *target, const char *path)
{
    return symlink(target, path) == 0;
}

bool system_list(const char *folder, bool (*take)(void *user, const char *name), void *user)
{
    DIR *entries = opendir(folder);
    if (!entries) {
        return false;
    }
    for (const struct dirent *entry; (entry = readdir(entries)) && take(user, entry->d_name);) {
    }
    closedir(entries);
    return true;
}

bool system_real_path(char out[SYSTEM_PATH], const char *path)
{
    return realpath(path, out);
}

bool system_here(char out[SYSTEM_PATH])
{
    return getcwd(out, SYSTEM_PATH);
}

bool system_enter(const char *folder)
{
    return chdir(folder) == 0;
}

bool system_is_open_name(const char *path)
{
    return strncmp(path, "/dev/", strlen("/dev/")) == 0 || strncmp(path, "/proc/", strlen("/proc/")) == 0;
}

int system_name_order(const char *a, const char *b)
{
#ifdef __APPLE__ /* which has letters beside a to z alike, too */
    return strcasecmp(a, b);
#else
    return strcmp(a, b);
#endif
}

bool system_program(char out[SYSTEM_PATH])
{
#ifdef __APPLE__
    char path[SYSTEM_PATH]; /* as it was started: by a link, say */
    uint32_t size = sizeof path;
    return _NSGetExecutablePath(path, &size) == 0 && realpath(path, out);
#elif defined __EMSCRIPTEN__ /* what runs is node: system_node.js says where conus is */
    const char *path = getenv("_");
    return path && realpath(path, out);
#else
    ssize_t length = readlink("/proc/self/exe", out, SYSTEM_PATH - 1);
    out[length > 0 ? length : 0] = '\0';
#ifdef __linux__
    if (length <= 0) { /* there is no /proc: how it was started */
        const char *started = (const char *)getauxval(AT_EXECFN);
        return started && realpath(started, out);
    }
#endif
    return length > 0;
#endif
}

/* That of glibc and musl is a static one. */
static locale_t find_c_locale(void)
{
#ifdef __APPLE__
    return NULL; /* which stands for it */
#else
    return newlocale(LC_ALL_MASK, "C", (locale_t)0);
#endif
}

double system_to_double(const char *text, char **end)
{
    return strtod_l(text, end, find_c_locale());
}

float system_to_float(const char *text, char **end)
{
    return strtof_l(text, end, find_c_locale());
}

void system_set_variable(const char *name, const char *value)
{
    setenv(name, value, 1);
}

void system_forget_variables(void)
{
#ifdef __APPLE__
    static char *none[1];
    *_NSGetEnviron() = none;
#else
    clearenv();
#endif
}

void *system_map(int file, size_t size)
{
    void *memory = mmap(NULL, size, PROT_READ, MAP_SHARED, file, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void system_unmap(const void *memory, size_t size)
{
    munmap((void *)memory, size);
}

void system_make_sparse(void *memory, size_t size)
{
#ifdef MADV_NOHUGEPAGE
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    size_t skipped = (page - (uintptr_t)memory % page) % page;
    if (size > skipped) {
        (void)madvise((char *)memory + skipped, size - skipped, MADV_NOHUGEPAGE); /* or a byte would take 2 MiB */
    }
#else
    (void)memory;
    (void)size;
#endif
}

bool system_random(void *out, size_t size)
{
    return getentropy(out, size) == 0;
}

size_t system_processors(void)
{
#ifdef __EMSCRIPTEN__ /* whose pages have no threads here */
    return 1;
#elif defined __APPLE__
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (size_t)count : 1;
#else
    cpu_set_t set;
    CPU_ZERO(&set);
    int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return count > 0 ? (size_t)count : 1;
#endif
}

bool system_thread(pthread_t *out, size_t stack, void *(*run)(void *user), void *user)
{
    sigset_t all;
    sigset_t before;
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes)) {
        return false;
    }
    if (stack) {
        (void)pthread_attr_setstacksize(&attributes, stack);
    }
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    bool runs = pthread_create(out, &attributes, run, user) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return runs;
}

void *system_function(const char *library, const char *name)
{
    void *loaded = dlopen(library, RTLD_LAZY | RTLD_LOCAL); /* stays */
    return loaded && name ? dlsym(loaded, name) : loaded;
}

bool system_wake_begin(struct system_wake *out)
{
    int ends[2];
#ifdef __APPLE__
    bool made = pipe(ends) == 0;
    for (size_t i = 0; made && i < 2; i++) {
        fcntl(ends[i], F_SETFD, FD_CLOEXEC);
        fcntl(ends[i], F_SETFL, O_NONBLOCK);
    }
#else
    bool made = pipe2(ends, O_CLOEXEC | O_NONBLOCK) == 0;
#endif
    if (made) {
        *out = (struct system_wake){ends[0], ends[1]};
    }
    return made;
}

void system_wake(const struct system_wake *wake)
{
    int error = errno; /* of what a signal interrupts */
    ssize_t written = write(wake->end, "", 1);
    (void)written; /* it fails only where it was woken very often already */
    errno = error;
}

void system_wake_end(const struct system_wake *wake)
{
    close((int)wake->file);
    close(wake->end);
}

bool system_wait(int file, const struct system_wake *wake, int most_ms, bool *silent)
{
    struct pollfd wanted[] = {{.fd = file, .events = POLLIN}, {.fd = (int)wake->file, .events = POLLIN}};
    int count;
    do {
        count = poll(wanted, 2, most_ms);
    } while (count < 0 && errno == EINTR);
    *silent = count == 0;
    return !(count > 0 && wanted[1].revents);
}

void system_begin(int *count, char ***words, bool pipes)
{
    (void)count;
    (void)words;
    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigaction(SIGXFSZ, &ignore, NULL);
    if (pipes) {
        sigaction(SIGPIPE, &ignore, NULL);
    }
}

void system_interrupt(void (*call)(int number))
{
    static const int numbers[] = {SIGINT, SIGTERM};
    struct sigaction action = {.sa_handler = call, .sa_flags = SA_RESTART | (int)SA_RESETHAND};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        struct sigaction before;
        if (sigaction(numbers[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
            sigaction(numbers[i], &action, NULL);
        }
    }
}

bool system_stack_is_below(size_t size)
{
    struct rlimit limit;
    return getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur < size;
}

bool system_leave_signals(void)
{
    sigset_t all;
    sigfillset(&all);
    return pthread_sigmask(SIG_SETMASK, &all, NULL) == 0;
}

void system_step_back(int by)
{
    setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + by); /* of Linux's threads each has its own */
}

void system_alarm(unsigned seconds, void (*call)(int number))
{
    signal(SIGALRM, call);
    alarm(seconds);
}

#ifdef __EMSCRIPTEN__ /* which starts no programs */
void system_become(const char *program, char **words)
{
    (void)program;
    (void)words;
    errno = ENOENT;
}

bool system_show(const char *path)
{
    (void)path;
    return false;
}
#else
void system_become(const char *program, char **words)
{
    (void)(strchr(program, '/') ? execv : execvp)(program, words);
}

/* Becomes the program that shows a file, without this one's terminal, streams and signals. */
static void become_shower(const char *program, const char *path)
{
    struct sigaction usual = {.sa_handler = SIG_DFL};
    sigset_t none;
    sigemptyset(&none);
    sigaction(SIGXFSZ, &usual, NULL);
    sigaction(SIGPIPE, &usual, NULL);
    pthread_sigmask(SIG_SETMASK, &none, NULL);
    setsid();
    int nothing = open("/dev/null", O_RDWR);
    for (int file = 0; file <= 2 && nothing >= 0; file++) {
        dup2(nothing, file);
    }
    char *words[] = {(char *)program, (char *)path, NULL};
    execvp(program, words);
    kill(getpid(), SIGKILL);
}

bool system_show(const char *path)
{
    enum { STEPS = 100, STEP = 20000000 }; /* 2 s: it may be the browser that runs, until it is closed */
#ifdef __APPLE__
    static const char program[] = "open";
#else
    static const char program[] = "xdg-open";
    /* Without a screen it would take a browser for terminals. */
    if (!getenv("DISPLAY") && !getenv("WAYLAND_DISPLAY") && !getenv("BROWSER")) {
        return false;
    }
#endif
    int status = 0;
    pid_t child = fork();
    if (child == 0) {
        become_shower(program, path);
    }
    for (int i = 0; i < STEPS && child > 0 && waitpid(child, &status, WNOHANG) == 0; i++) {
        nanosleep(&(struct timespec){.tv_nsec = STEP}, NULL);
    }
    return child > 0 && status == 0;
}
#endif

bool system_is_terminal(int file)
{
    return isatty(file);
}

unsigned system_columns(int file)
{
    struct winsize size = {0};
    return isatty(file) && ioctl(file, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

FILE *system_text_open(struct system_text *out)
{
    *out = (struct system_text){0};
    out->stream = open_memstream(&out->data, &out->size);
    return out->stream;
}

char *system_text_close(struct system_text *text)
{
    bool failed = !text->stream || ferror(text->stream);
    failed = (text->stream && fclose(text->stream)) || failed;
    text->stream = NULL;
    if (failed) {
        free(text->data);
        text->data = NULL;
        text->size = 0;
    }
    return text->data;
}
