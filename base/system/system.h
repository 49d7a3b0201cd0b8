/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * What operating systems do differently. Nothing else includes their headers, but base/child (processes), apps/link
 * (sockets) and the programs that only one system has. What they have alike comes in through this header: close(),
 * lseek(), ftruncate(), fdopen(), clock_gettime() and nanosleep().
 *
 * Paths are UTF-8 with '/'. What fails returns false or -1, with errno set, and its text is the caller's. Nothing here
 * needs anything else of conus, so that programs have it, too. */
#ifndef CONUS_BASE_SYSTEM_H
#define CONUS_BASE_SYSTEM_H

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum {
    SYSTEM_PATH = 4096, /**< The most bytes of a path, with its NUL. */
    SYSTEM_NAME = 255,  /**< The most bytes of a name in a folder, without it. */
    SYSTEM_NO_FILE = -1 /**< No open file. */
};

/** What stands between the names of a path, all that are taken; conus writes '/'. */
#ifdef _WIN32
#define SYSTEM_SEPARATORS "/\\"
#else
#define SYSTEM_SEPARATORS "/"
#endif
/** What stands between the folders of a list, such as $PATH, and the list of those with data of all users. */
#ifdef _WIN32
#define SYSTEM_LIST ';'
#define SYSTEM_DATA_FOLDERS ""
#else
#define SYSTEM_LIST ':'
#define SYSTEM_DATA_FOLDERS "/usr/local/share:/usr/share"
#endif

enum system_kind { SYSTEM_FILE, SYSTEM_FOLDER, SYSTEM_LINK, SYSTEM_PIPE, SYSTEM_OTHER };

struct system_stat {
    uint64_t device, inode, size;
    struct timespec changed, altered; /**< Last change of the bytes, and of anything about it. */
    enum system_kind kind;
};

/** The file or folder that @p path leads to. */
bool system_stat(struct system_stat *out, const char *path);
/** The same of what is at @p path itself; a link is one. */
bool system_stat_link(struct system_stat *out, const char *path);
bool system_stat_open(struct system_stat *out, int file);

/** Whether all that @p how asks for is allowed: a sum of SYSTEM_READ, SYSTEM_WRITE and SYSTEM_RUN; 0 = it is there. */
bool system_allows(const char *path, unsigned how);

enum {
    SYSTEM_READ = 1,
    SYSTEM_WRITE = 2,
    SYSTEM_RUN = 4,      /**< Of system_allows() only. */
    SYSTEM_APPEND = 8,   /**< Each writing goes to the end. */
    SYSTEM_MAKE = 16,    /**< It is made where it is not there, */
    SYSTEM_NEW = 32,     /**< and must not be there. */
    SYSTEM_EMPTY = 64,   /**< What is in it goes. */
    SYSTEM_AT_ONCE = 128 /**< Neither opening nor reading waits for the other end of a pipe. */
};

/** Opens a file; programs that are started do not get it. @p how is a sum of the above. */
int system_open(const char *path, unsigned how);
/** Opens a new file, for the user alone or with the rights of any new one, whose name has other letters in place of the
 * XXXXXX before its last @p ending bytes. */
int system_open_temporary(char *path, size_t ending, bool for_us_alone);
/** Opens a new file in @p folder that has no name, so that nothing is left of it when the process is killed. -1 where
 * the file system has no such files. */
int system_open_nameless(const char *folder);
/** Gives it a name, which must not be there. */
bool system_name(int file, const char *path);
/** Opens an empty file, in memory where there are such, that is gone once it is closed; @p name is for people. */
int system_open_scratch(const char *name);
/** Another number for the same open file. */
int system_copy(int file);

/** fopen(), whose file programs that are started do not get. */
FILE *system_stream(const char *path, const char *how);

/** The errno of a stream that cannot be written to. */
#ifdef _WIN32
int system_stream_error(void);
#else
static inline int system_stream_error(void)
{
    return errno;
}
#endif

/** read(), of any size. */
ptrdiff_t system_read(int file, void *out, size_t size);
/** Reads @p size bytes from byte @p at on; their number, which is smaller only at the end of the file. */
ptrdiff_t system_read_at(int file, void *out, size_t size, uint64_t at);
/** Write all of it, from byte @p at on or where the file stands. */
bool system_write_at(int file, const void *data, size_t size, uint64_t at);
bool system_write(int file, const void *data, size_t size);
/** What was written is on the disk. */
bool system_to_disk(int file);

/** Gives a file the name @p to, in the place of another only if @p replace; one move, between names in one folder. */
bool system_rename(const char *from, const char *to, bool replace);
/** Removes a file or a link. */
bool system_remove(const char *path);
bool system_make_folder(const char *path, bool for_us_alone);
/** Removes an empty folder. */
bool system_remove_folder(const char *path);
/** Makes a link, which must not be there, to the file or folder at a whole path; ENOSYS where there are none. */
bool system_link(const char *target, const char *path);
/** Gives each name in a folder, "." and ".." too, while @p take returns true. */
bool system_list(const char *folder, bool (*take)(void *user, const char *name), void *user);
/** The path from the root on, without links, "." and "..". */
bool system_real_path(char out[SYSTEM_PATH], const char *path);
/** The current folder. */
bool system_here(char out[SYSTEM_PATH]);
/** Makes another folder the current one. */
bool system_enter(const char *folder);
/** Whether a path is a name of what some process has open, or of a device: what is there belongs to others. */
bool system_is_open_name(const char *path);
/** As strcmp(), of names in a folder: 0 where both lead to one file. Windows, and macOS as most have it, do not tell
 * upper and lower case apart. */
int system_name_order(const char *a, const char *b);
/** The path of the program that runs. */
bool system_program(char out[SYSTEM_PATH]);

/** What the environment says, in UTF-8; NULL where it says nothing. */
#ifdef _WIN32
const char *system_variable(const char *name);
#else
static inline const char *system_variable(const char *name)
{
    return getenv(name);
}
#endif

/** Sets it, for this program and those that it starts. */
void system_set_variable(const char *name, const char *value);

/** strtod() and strtof() of the C locale, whatever the process's is. */
double system_to_double(const char *text, char **end);
float system_to_float(const char *text, char **end);

/** The first @p size bytes of an open file, for reading; NULL where that fails. Who reads where the file was cut off
 * meanwhile ends by SIGBUS. */
void *system_map(int file, size_t size);
void system_unmap(const void *memory, size_t size);
/** Has memory take space by the smallest pages: parts that are not written to take none. */
void system_make_sparse(void *memory, size_t size);

bool system_random(void *out, size_t size);

/** Processors that the process may use. */
size_t system_processors(void);
/** pthread_create(), of a thread that gets no signals; @p stack bytes of stack, 0 = as many as threads have. */
bool system_thread(pthread_t *out, size_t stack, void *(*run)(void *user), void *user);

/** A function of a library that is loaded when it is needed, or its data; NULL where that is not there. Without a name,
 * not NULL where the library is there. */
void *system_function(const char *library, const char *name);

/** What ends a wait from another thread, or from a signal's handler. */
struct system_wake {
    intptr_t file; /**< Can be read from once it is woken, */
    int end;       /**< by what is written here; unused on Windows, where file is an event. */
};
bool system_wake_begin(struct system_wake *out);
void system_wake(const struct system_wake *wake);
void system_wake_end(const struct system_wake *wake);
/** Waits until a file can be read, or until system_wake(): false then; or, *silent, for so many milliseconds, -1 =
 * without end. */
bool system_wait(int file, const struct system_wake *wake, int most_ms, bool *silent);

/* Of programs, not of the library. */

/** Gives the words of the command line in UTF-8, and has streams be binary. Has a limit on files be an error of
 * writing, not a sudden end; if @p pipes, a broken pipe, too. */
void system_begin(int *count, char ***words, bool pipes);
/** Lets the first SIGINT or SIGTERM call @p call; not one that is ignored. */
void system_interrupt(void (*call)(int number));
/** Whether the first thread's stack has less than @p size bytes. */
bool system_stack_is_below(size_t size);
/** Leaves all signals to other threads. */
bool system_leave_signals(void);
/** Has the calling thread, and those that it starts, step back for others: @p by more of the steps of nice(). */
void system_step_back(int by);
/** Has @p call called after so many seconds, 0 = never, from whatever the program waits for. */
void system_alarm(unsigned seconds, void (*call)(int number));
/** Has getenv() find nothing, in whatever library. */
void system_forget_variables(void);
/** Becomes another program, a path or a name in $PATH; comes back, with errno, only where that fails. */
void system_become(const char *program, char **words);
/** Has the desktop show a file, of a path from the root on, by the program that it has for such files, and does not
 * wait for that. False where it is known that it cannot. */
bool system_show(const char *path);
/** Whether a person sees what is written there; Windows' isatty() takes NUL for a terminal. */
bool system_is_terminal(int file);
/** Columns of a terminal; 0 = none, or not known. */
unsigned system_columns(int file);

/** A text that is written as a stream; not to be copied while that is open. */
struct system_text {
    FILE *stream;
    char *data; /**< Once the stream is closed; with a NUL behind its size. */
    size_t size;
};

/** The stream; NULL without memory. */
FILE *system_text_open(struct system_text *out);
/** Closes the stream. The text is the caller's to free(); NULL without memory, or where opening or writing failed. */
char *system_text_close(struct system_text *text);

#endif
