/* SPDX-License-Identifier: BSD-3-Clause */
/* Processes as Windows 10 and later have them: in a job, which ends with the handle to it. */
#include "base/child/process.h"
#include "base/system/system.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>
/* Behind windows.h, whose names they use. */
#include <errno.h>
#include <io.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS_LIMIT = 32767, READ_SIZE = 1 << 16, GIVEN = 3, DESCRIPTORS };

/* A pipe that is read from while others are waited for. */
struct reading {
    OVERLAPPED operation; /* with the event */
    HANDLE pipe;
    bool waits; /* for what comes into the data */
    DWORD at, size;
    uint8_t data[READ_SIZE];
};

struct parts {
    HANDLE job;
    struct reading readings[2];
};

static bool fail_last(void)
{
    DWORD error = GetLastError();
    errno = error == ERROR_FILE_NOT_FOUND || error == ERROR_PATH_NOT_FOUND ? ENOENT
            : error == ERROR_ACCESS_DENIED                                 ? EACCES
            : error == ERROR_BAD_EXE_FORMAT                                ? ENOEXEC
            : error == ERROR_FILENAME_EXCED_RANGE                          ? E2BIG
            : error == ERROR_NOT_ENOUGH_MEMORY                             ? ENOMEM
                                                                           : EIO;
    return false;
}

/* The words as one text, so that CommandLineToArgvW() and the start of C programs give them back: a quotation mark and
 * what backslashes stand before one are escaped by backslashes. */
static bool join_words(wchar_t out[WORDS_LIMIT], char *const *words)
{
    size_t length = 0;
    bool fits = true;
    for (size_t i = 0; words[i] && fits; i++) {
        wchar_t *word = malloc(WORDS_LIMIT * sizeof *word);
        fits = word && MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, words[i], -1, word, WORDS_LIMIT);
        size_t size = fits ? wcslen(word) : 0;
        fits = fits && length + 2 * size + 4 < WORDS_LIMIT;
        if (fits) {
            size_t slashes = 0;
            if (i) {
                out[length++] = ' ';
            }
            out[length++] = '"';
            for (size_t k = 0; k <= size; k++) {
                bool ends = k == size;
                for (; slashes && (ends || word[k] == '"'); slashes--) {
                    out[length++] = '\\';
                }
                if (!ends && word[k] == '"') {
                    out[length++] = '\\';
                }
                out[length++] = ends ? '"' : word[k];
                slashes = word[k] == '\\' ? slashes + 1 : 0;
            }
            out[length] = 0;
        }
        free(word);
    }
    errno = fits ? errno : E2BIG;
    return fits;
}

/* A pipe whose writing end programs get. */
static bool open_pipe(struct reading *out, HANDLE *end, const struct process *process, int which)
{
    wchar_t name[96];
    LARGE_INTEGER now;
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    QueryPerformanceCounter(&now);
    swprintf(name, sizeof name / sizeof name[0], L"\\\\.\\pipe\\conus-%lu-%lu-%llx-%p-%d", GetCurrentProcessId(),
             GetCurrentThreadId(), (unsigned long long)now.QuadPart, (const void *)process, which);
    out->pipe = CreateNamedPipeW(name, PIPE_ACCESS_INBOUND | FILE_FLAG_OVERLAPPED | FILE_FLAG_FIRST_PIPE_INSTANCE,
                                 PIPE_TYPE_BYTE | PIPE_READMODE_BYTE | PIPE_WAIT | PIPE_REJECT_REMOTE_CLIENTS, 1, 0,
                                 READ_SIZE, 0, NULL);
    *end = out->pipe != INVALID_HANDLE_VALUE
               ? CreateFileW(name, GENERIC_WRITE, 0, &inherited, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, NULL)
               : INVALID_HANDLE_VALUE;
    out->operation.hEvent = CreateEventW(NULL, TRUE, FALSE, NULL);
    return (*end != INVALID_HANDLE_VALUE && out->operation.hEvent) || fail_last();
}

/* A job that ends its processes with the handle to it, and holds the limits. */
static bool make_job(HANDLE *out, const struct process_limits *limits)
{
    JOBOBJECT_EXTENDED_LIMIT_INFORMATION info = {0};
    info.BasicLimitInformation.LimitFlags = JOB_OBJECT_LIMIT_KILL_ON_JOB_CLOSE | JOB_OBJECT_LIMIT_PROCESS_TIME |
                                            JOB_OBJECT_LIMIT_ACTIVE_PROCESS |
                                            JOB_OBJECT_LIMIT_DIE_ON_UNHANDLED_EXCEPTION;
    info.BasicLimitInformation.PerProcessUserTimeLimit.QuadPart = (LONGLONG)limits->seconds * 10000000;
    info.BasicLimitInformation.ActiveProcessLimit = 1;
    if (limits->space < SIZE_MAX) {
        info.BasicLimitInformation.LimitFlags |= JOB_OBJECT_LIMIT_PROCESS_MEMORY;
        info.ProcessMemoryLimit = (SIZE_T)limits->space;
    }
    *out = CreateJobObjectW(NULL, NULL);
    return (*out && SetInformationJobObject(*out, JobObjectExtendedLimitInformation, &info, sizeof info)) ||
           fail_last();
}

/* The descriptors of the new process, as the C library of Windows hands them on: their number, a byte of flags and a
 * handle of each. */
struct handed_on {
    uint8_t bytes[sizeof(int) + DESCRIPTORS * (1 + sizeof(HANDLE))];
    WORD size;
};

static void hand_on(struct handed_on *out, const HANDLE handles[DESCRIPTORS])
{
    enum { OPEN = 0x01, PIPE = 0x08, DEVICE = 0x40 };
    const int count = handles[GIVEN] ? DESCRIPTORS : GIVEN;
    memcpy(out->bytes, &count, sizeof count);
    for (int i = 0; i < count; i++) {
        DWORD type = GetFileType(handles[i]);
        out->bytes[sizeof count + (size_t)i] = (uint8_t)(OPEN | (type == FILE_TYPE_PIPE   ? PIPE
                                                                 : type == FILE_TYPE_CHAR ? DEVICE
                                                                                          : 0));
        memcpy(out->bytes + sizeof count + (size_t)count + (size_t)i * sizeof(HANDLE), &handles[i], sizeof(HANDLE));
    }
    out->size = (WORD)(sizeof count + (size_t)count * (1 + sizeof(HANDLE)));
}

/* Starts the program in the job with these handles as its descriptors, and no others. */
static bool start_with(HANDLE *out, const struct process_start *start, HANDLE handles[DESCRIPTORS], HANDLE job)
{
    wchar_t path[SYSTEM_PATH];
    wchar_t *words = malloc(WORDS_LIMIT * sizeof *words);
    struct handed_on handed_on;
    SIZE_T size = 0;
    PROCESS_INFORMATION made = {0};
    STARTUPINFOEXW info = {.StartupInfo = {.cb = sizeof info,
                                           .dwFlags = STARTF_USESTDHANDLES,
                                           .hStdInput = handles[0],
                                           .hStdOutput = handles[1],
                                           .hStdError = handles[2]}};
    hand_on(&handed_on, handles);
    info.StartupInfo.cbReserved2 = handed_on.size;
    info.StartupInfo.lpReserved2 = handed_on.bytes;
    InitializeProcThreadAttributeList(NULL, 1, 0, &size);
    info.lpAttributeList = malloc(size);
    bool listed = info.lpAttributeList && InitializeProcThreadAttributeList(info.lpAttributeList, 1, 0, &size);
    errno = ENOMEM;
    bool begun = words && listed && join_words(words, start->words) &&
                 MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, start->path, -1, path, SYSTEM_PATH) &&
                 ((UpdateProcThreadAttribute(info.lpAttributeList, 0, PROC_THREAD_ATTRIBUTE_HANDLE_LIST, handles,
                                             (handles[GIVEN] ? DESCRIPTORS : GIVEN) * sizeof(HANDLE), NULL, NULL) &&
                   CreateProcessW(path, words, NULL, NULL, TRUE,
                                  CREATE_SUSPENDED | EXTENDED_STARTUPINFO_PRESENT | CREATE_UNICODE_ENVIRONMENT, NULL,
                                  NULL, &info.StartupInfo, &made)) ||
                  fail_last());
    if (begun && !(AssignProcessToJobObject(job, made.hProcess) && ResumeThread(made.hThread) != (DWORD)-1)) {
        begun = fail_last();
        TerminateProcess(made.hProcess, 1);
        CloseHandle(made.hProcess);
    }
    if (made.hThread) {
        CloseHandle(made.hThread);
    }
    if (listed) {
        DeleteProcThreadAttributeList(info.lpAttributeList);
    }
    free(info.lpAttributeList);
    free(words);
    *out = begun ? made.hProcess : NULL;
    return begun;
}

bool process_begin(struct process *out, const struct process_start *start)
{
    struct parts *parts = calloc(1, sizeof *parts);
    HANDLE handles[DESCRIPTORS] = {INVALID_HANDLE_VALUE, INVALID_HANDLE_VALUE, INVALID_HANDLE_VALUE, NULL};
    HANDLE process = NULL;
    SECURITY_ATTRIBUTES inherited = {.nLength = sizeof inherited, .bInheritHandle = TRUE};
    *out = (struct process){.ends = {-1, -1}, .state = parts};
    if (!parts) {
        return false;
    }
    handles[0] =
        CreateFileW(L"NUL", GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited, OPEN_EXISTING, 0, NULL);
    bool begun = handles[0] != INVALID_HANDLE_VALUE || fail_last();
    for (int i = 0; i < 2; i++) {
        begun = open_pipe(&parts->readings[i], &handles[1 + i], out, i) && begun;
        out->ends[i] = 1;
    }
    begun = begun && (start->given < 0 ||
                      DuplicateHandle(GetCurrentProcess(), (HANDLE)_get_osfhandle(start->given), GetCurrentProcess(),
                                      &handles[GIVEN], 0, TRUE, DUPLICATE_SAME_ACCESS) ||
                      fail_last());
    begun = begun && make_job(&parts->job, start->limits) && start_with(&process, start, handles, parts->job);
    int error = errno;
    for (int i = 0; i < DESCRIPTORS; i++) {
        if (handles[i] && handles[i] != INVALID_HANDLE_VALUE) {
            CloseHandle(handles[i]);
        }
    }
    out->id = (intptr_t)process;
    if (!begun) {
        process_finish(out);
    }
    errno = error;
    return begun;
}

bool process_writes(const struct process *process)
{
    return process->ends[PROCESS_OUT] >= 0 || process->ends[PROCESS_ERR] >= 0;
}

/* Of a pipe the end is an error here; false of any other one. */
static bool take_end(intptr_t *end, DWORD error)
{
    if (error == ERROR_BROKEN_PIPE || error == ERROR_PIPE_NOT_CONNECTED) {
        *end = -1;
    }
    return *end < 0 || fail_last();
}

/* Has the pipe read when nothing is left of what it gave. */
static bool read_on(struct reading *reading, intptr_t *end)
{
    if (*end < 0 || reading->waits || reading->at < reading->size) {
        return true;
    }
    reading->at = reading->size = 0;
    reading->waits = ReadFile(reading->pipe, reading->data, READ_SIZE, NULL, &reading->operation) ||
                     GetLastError() == ERROR_IO_PENDING;
    return reading->waits || take_end(end, GetLastError());
}

/* Takes what came, without waiting. */
static bool take_part(struct process_part *part, struct reading *reading, intptr_t *end)
{
    DWORD size = 0;
    if (reading->waits && GetOverlappedResult(reading->pipe, &reading->operation, &size, FALSE)) {
        reading->waits = false;
        reading->size = size;
    } else if (reading->waits && GetLastError() != ERROR_IO_INCOMPLETE) {
        reading->waits = false;
        return take_end(end, GetLastError());
    }
    size_t left = reading->size - reading->at; /* 0 of one that waits */
    part->got = left < part->capacity ? left : part->capacity;
    memcpy(part->data, reading->data + reading->at, part->got);
    reading->at += (DWORD)part->got;
    return true;
}

static DWORD milliseconds(double seconds)
{
    static const double LONGEST = 1e6;
    return seconds <= 0 ? 0 : seconds < LONGEST ? (DWORD)(1000 * seconds) + 1 : INFINITE;
}

enum process_reading process_read(struct process_part parts[2], struct process *process, double seconds)
{
    struct reading *readings = ((struct parts *)process->state)->readings;
    HANDLE events[2];
    DWORD count = 0;
    bool fine = true;
    bool is_there = false;
    for (int i = 0; i < 2; i++) {
        parts[i].got = 0;
        is_there = is_there || readings[i].at < readings[i].size;
        intptr_t before = process->ends[i];
        fine = read_on(&readings[i], &process->ends[i]) && fine;
        is_there = is_there || process->ends[i] != before;
        if (readings[i].waits) {
            events[count++] = readings[i].operation.hEvent;
        }
    }
    bool late =
        fine && !is_there && WaitForMultipleObjects(count, events, FALSE, milliseconds(seconds)) == WAIT_TIMEOUT;
    for (int i = 0; i < 2 && fine; i++) {
        fine = process->ends[i] < 0 || take_part(&parts[i], &readings[i], &process->ends[i]);
    }
    return !fine ? PROCESS_FAILED : late ? PROCESS_LATE : PROCESS_CAME;
}

bool process_wait(struct process_end *out, struct process *process, double seconds)
{
    enum { EXCEPTIONS = 0xC }; /* the highest four bits of a code that says one */
    DWORD code = 0;
    if (WaitForSingleObject((HANDLE)process->id, milliseconds(seconds)) == WAIT_TIMEOUT) {
        return false;
    }
    GetExitCodeProcess((HANDLE)process->id, &code);
    CloseHandle((HANDLE)process->id);
    process->id = 0;
    *out = (struct process_end){.kind = code == STATUS_NO_MEMORY         ? PROCESS_NO_MEMORY
                                        : code == ERROR_NOT_ENOUGH_QUOTA ? PROCESS_NO_TIME
                                        : code >> 28 == EXCEPTIONS       ? PROCESS_CRASHED
                                                                         : PROCESS_EXITED,
                                .code = (int)code};
    snprintf(out->how, sizeof out->how, "exception %lx", code);
    return true;
}

void process_finish(struct process *process)
{
    struct parts *parts = process->state;
    if (process->id) {
        TerminateJobObject(parts->job, 1);
        WaitForSingleObject((HANDLE)process->id, INFINITE);
        CloseHandle((HANDLE)process->id);
    }
    for (int i = 0; parts && i < 2; i++) {
        struct reading *reading = &parts->readings[i];
        DWORD size;
        if (reading->waits && CancelIoEx(reading->pipe, &reading->operation)) {
            GetOverlappedResult(reading->pipe, &reading->operation, &size, TRUE);
        }
        if (reading->pipe && reading->pipe != INVALID_HANDLE_VALUE) {
            CloseHandle(reading->pipe);
        }
        if (reading->operation.hEvent) {
            CloseHandle(reading->operation.hEvent);
        }
    }
    if (parts && parts->job) {
        CloseHandle(parts->job);
    }
    free(parts);
    *process = (struct process){.ends = {-1, -1}};
}
