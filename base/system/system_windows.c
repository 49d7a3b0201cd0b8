/* SPDX-License-Identifier: BSD-3-Clause */
/* The system as Windows 10 and later have it. Paths are widened for each call; what conus gets has '/'. */
#include "base/system/system.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>
/* Behind windows.h, whose names they use. */
#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <locale.h>
#include <ntsecapi.h>
#include <sddl.h>
#include <shellapi.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_AT_ONCE = 1 << 30, STACK = 8 << 20, SHARED = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE };
typedef wchar_t wide_path[SYSTEM_PATH];

/* What the system says, as errno has it; false. */
static bool fail_with(DWORD error)
{
    static const struct {
        DWORD windows;
        int posix;
    } known[] = {{ERROR_FILE_NOT_FOUND, ENOENT},
                 {ERROR_PATH_NOT_FOUND, ENOENT},
                 {ERROR_INVALID_NAME, ENOENT},
                 {ERROR_INVALID_DRIVE, ENOENT},
                 {ERROR_BAD_NETPATH, ENOENT},
                 {ERROR_BAD_NET_NAME, ENOENT},
                 {ERROR_BAD_PATHNAME, ENOENT},
                 {ERROR_FILE_EXISTS, EEXIST},
                 {ERROR_ALREADY_EXISTS, EEXIST},
                 {ERROR_ACCESS_DENIED, EACCES},
                 {ERROR_SHARING_VIOLATION, EACCES},
                 {ERROR_WRITE_PROTECT, EROFS},
                 {ERROR_LOCK_VIOLATION, EAGAIN},
                 {ERROR_DISK_FULL, ENOSPC},
                 {ERROR_HANDLE_DISK_FULL, ENOSPC},
                 {ERROR_DIRECTORY, ENOTDIR},
                 {ERROR_DIR_NOT_EMPTY, ENOTEMPTY},
                 {ERROR_NOT_ENOUGH_MEMORY, ENOMEM},
                 {ERROR_OUTOFMEMORY, ENOMEM},
                 {ERROR_COMMITMENT_LIMIT, ENOMEM},
                 {ERROR_TOO_MANY_OPEN_FILES, EMFILE},
                 {ERROR_FILENAME_EXCED_RANGE, ENAMETOOLONG},
                 {ERROR_BROKEN_PIPE, EPIPE},
                 {ERROR_PIPE_NOT_CONNECTED, EPIPE},
                 {ERROR_NO_DATA, EPIPE},
                 {ERROR_INVALID_HANDLE, EBADF},
                 {ERROR_NOT_SUPPORTED, ENOSYS},
                 {ERROR_INVALID_FUNCTION, ENOSYS},
                 {ERROR_CALL_NOT_IMPLEMENTED, ENOSYS}};
    errno = EIO;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        errno = known[i].windows == error ? known[i].posix : errno;
    }
    return false;
}

static bool fail_last(void)
{
    return fail_with(GetLastError());
}

/* The open file that has a name on other systems, which results of theirs have; else SYSTEM_NO_FILE. */
static int find_standard(const char *path)
{
    static const char *const names[] = {"/dev/stdin", "/dev/stdout", "/dev/stderr"};
    for (int i = 0; i < 3; i++) {
        if (strcmp(path, names[i]) == 0) {
            return i;
        }
    }
    return SYSTEM_NO_FILE;
}

static bool is_nothing(const char *path)
{
    return strcmp(path, "/dev/null") == 0;
}

static const char *last_name(const char *path)
{
    const char *name = path;
    for (const char *at = path; *at; at++) {
        name = *at == '/' || *at == '\\' ? at + 1 : name;
    }
    return name;
}

/* Whether Windows would open another file by it: it drops dots and spaces at the end, and opens streams after a colon.
 */
static bool is_of_another(const char *path)
{
    const char *name = last_name(path);
    const char *colon = strrchr(name, ':');
    size_t length = strlen(name);
    bool is_dropped = length && (name[length - 1] == ' ' || name[length - 1] == '.');
    return (is_dropped && strcmp(name, ".") != 0 && strcmp(name, "..") != 0) || (colon && colon != path + 1);
}

/* A path for the system, of any length; false with errno where it is no UTF-8, too long, or of no file here. */
static bool widen(wide_path out, const char *path)
{
    wide_path plain;
    path = is_nothing(path) ? "NUL" : path;
    if (is_of_another(path)) {
        errno = ENOENT;
        return false;
    }
    DWORD length = (DWORD)MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, plain, SYSTEM_PATH);
    if (!length || length == 1) {
        errno = !length && GetLastError() == ERROR_INSUFFICIENT_BUFFER ? ENAMETOOLONG : ENOENT;
        return false;
    }
    wide_path whole;
    DWORD whole_length = GetFullPathNameW(plain, SYSTEM_PATH, whole, NULL);
    if (whole_length && whole_length < MAX_PATH - 12) { /* the least of a folder's */
        memcpy(out, plain, length * sizeof out[0]);
        return true;
    }
    length = whole_length;
    bool is_server = whole[0] == '\\' && whole[1] == '\\';
    if (!length || length >= SYSTEM_PATH - 8) {
        errno = ENAMETOOLONG;
        return false;
    }
    swprintf(out, SYSTEM_PATH, L"%ls%ls",
             !is_server        ? L"\\\\?\\"
             : whole[2] == '?' ? L""
                               : L"\\\\?\\UNC",
             whole + (is_server && whole[2] != '?'));
    return true;
}

static void put_slashes(char *path)
{
    for (char *at = path; *at; at++) {
        *at = *at == '\\' ? '/' : *at;
    }
}

/* A path of the system, with '/' and without its mark of long ones. */
static bool narrow(char *out, size_t size, const wchar_t *path)
{
    static const wchar_t server[] = L"\\\\?\\UNC\\";
    static const wchar_t mark[] = L"\\\\?\\";
    bool is_server = wcsncmp(path, server, wcslen(server)) == 0;
    path += is_server ? wcslen(server) - 1 : wcsncmp(path, mark, wcslen(mark)) == 0 ? wcslen(mark) : 0;
    out[0] = '/';
    if (!WideCharToMultiByte(CP_UTF8, WC_ERR_INVALID_CHARS, path, -1, out + is_server, (int)(size - is_server), NULL,
                             NULL)) {
        errno = GetLastError() == ERROR_INSUFFICIENT_BUFFER ? ENAMETOOLONG : EILSEQ;
        return false;
    }
    put_slashes(out);
    return true;
}

static HANDLE handle_of(int file)
{
    return (HANDLE)_get_osfhandle(file);
}

/* The reason why there is nothing at a path: on its way there may be a file, or a name that is too long, which other
 * systems say. */
static bool fail_at(const wchar_t *path, DWORD error)
{
    wide_path above;
    fail_with(error);
    size_t length = wcslen(path);
    memcpy(above, path, (length + 1) * sizeof above[0]);
    for (const wchar_t *at = path; errno == ENOENT && *at;) {
        size_t name = wcscspn(at, L"/\\");
        errno = name > SYSTEM_NAME ? ENAMETOOLONG : ENOENT;
        at += name + (at[name] != 0);
    }
    for (; errno == ENOENT && length; length--) {
        if (above[length - 1] == '\\' || above[length - 1] == '/') {
            above[length - 1] = 0;
            DWORD is = GetFileAttributesW(above);
            if (is != INVALID_FILE_ATTRIBUTES) {
                errno = is & FILE_ATTRIBUTE_DIRECTORY ? ENOENT : ENOTDIR;
                break;
            }
        }
    }
    return false;
}

static HANDLE open_handle(const wchar_t *path, DWORD access, DWORD make, DWORD more)
{
    HANDLE handle = CreateFileW(path, access, SHARED, NULL, make, FILE_FLAG_BACKUP_SEMANTICS | more, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        DWORD error = GetLastError();
        DWORD is = error == ERROR_ACCESS_DENIED || error == ERROR_FILE_EXISTS ? GetFileAttributesW(path) : 0;
        bool is_folder = is != INVALID_FILE_ATTRIBUTES && is & FILE_ATTRIBUTE_DIRECTORY;
        fail_at(path, error);
        errno = errno == EACCES && is_folder && access & GENERIC_WRITE ? EISDIR : errno;
    }
    return handle;
}

static bool is_link(HANDLE handle)
{
    FILE_ATTRIBUTE_TAG_INFO info;
    return GetFileInformationByHandleEx(handle, FileAttributeTagInfo, &info, sizeof info) &&
           info.FileAttributes & FILE_ATTRIBUTE_REPARSE_POINT &&
           (info.ReparseTag == IO_REPARSE_TAG_SYMLINK || info.ReparseTag == IO_REPARSE_TAG_MOUNT_POINT);
}

static bool is_folder(HANDLE handle)
{
    FILE_STANDARD_INFO info;
    return GetFileInformationByHandleEx(handle, FileStandardInfo, &info, sizeof info) && info.Directory;
}

/* A descriptor that owns the handle; of -1 errno stays. */
static int own_handle(HANDLE handle)
{
    int file = handle == INVALID_HANDLE_VALUE ? -1 : _open_osfhandle((intptr_t)handle, _O_BINARY | _O_NOINHERIT);
    if (file < 0 && handle != INVALID_HANDLE_VALUE) {
        CloseHandle(handle);
    }
    return file;
}

/* The user that the process is of; the size is that of the longest. */
struct user {
    TOKEN_USER token;
    uint8_t id[SECURITY_MAX_SID_SIZE];
};

static bool find_user(struct user *out)
{
    DWORD size;
    return GetTokenInformation(GetCurrentProcessToken(), TokenUser, out, sizeof *out, &size);
}

/* Times are in 100 ns since 1601. */
static const int64_t UNIX_BEGINS = 116444736000000000;

static struct timespec time_from(LARGE_INTEGER time)
{
    int64_t units = time.QuadPart - UNIX_BEGINS;
    int64_t rest = (units % 10000000 + 10000000) % 10000000;
    return (struct timespec){.tv_sec = (units - rest) / 10000000, .tv_nsec = (long)(100 * rest)};
}

/* The volume and the number of a file in it, 0 where none are known; what FAT has is smaller. */
static void find_identity(uint64_t *device, uint64_t *inode, HANDLE handle)
{
    FILE_ID_INFO id;
    BY_HANDLE_FILE_INFORMATION small;
    uint64_t parts[2];
    if (GetFileInformationByHandleEx(handle, FileIdInfo, &id, sizeof id)) {
        memcpy(parts, &id.FileId, sizeof parts);
        *device = id.VolumeSerialNumber;
        *inode = parts[0] ^ parts[1];
        return;
    }
    bool known = GetFileInformationByHandle(handle, &small);
    *device = known ? small.dwVolumeSerialNumber : 0;
    *inode = known ? (uint64_t)small.nFileIndexHigh << 32 | small.nFileIndexLow : 0;
}

static bool stat_handle(struct system_stat *out, HANDLE handle)
{
    FILE_STANDARD_INFO info;
    FILE_BASIC_INFO times;
    DWORD type = GetFileType(handle);
    if (type != FILE_TYPE_DISK) {
        *out = (struct system_stat){.kind = type == FILE_TYPE_PIPE ? SYSTEM_PIPE : SYSTEM_OTHER};
        return handle != INVALID_HANDLE_VALUE || fail_with(ERROR_INVALID_HANDLE);
    }
    if (!GetFileInformationByHandleEx(handle, FileStandardInfo, &info, sizeof info) ||
        !GetFileInformationByHandleEx(handle, FileBasicInfo, &times, sizeof times)) {
        return fail_last();
    }
    *out = (struct system_stat){.size = (uint64_t)info.EndOfFile.QuadPart,
                                .changed = time_from(times.LastWriteTime),
                                .altered = time_from(times.ChangeTime),
                                .kind = is_link(handle)  ? SYSTEM_LINK
                                        : info.Directory ? SYSTEM_FOLDER
                                                         : SYSTEM_FILE};
    find_identity(&out->device, &out->inode, handle);
    return true;
}

static bool stat_path(struct system_stat *out, const wchar_t *path, DWORD more)
{
    HANDLE handle = open_handle(path, FILE_READ_ATTRIBUTES | READ_CONTROL, OPEN_EXISTING, more);
    bool done = handle != INVALID_HANDLE_VALUE && stat_handle(out, handle);
    if (handle != INVALID_HANDLE_VALUE) {
        CloseHandle(handle);
    }
    return done;
}

bool system_stat(struct system_stat *out, const char *path)
{
    wide_path wide;
    int standard = find_standard(path);
    return standard >= 0 ? system_stat_open(out, standard) : widen(wide, path) && stat_path(out, wide, 0);
}

bool system_stat_link(struct system_stat *out, const char *path)
{
    wide_path wide;
    return widen(wide, path) && stat_path(out, wide, FILE_FLAG_OPEN_REPARSE_POINT);
}

bool system_stat_open(struct system_stat *out, int file)
{
    return stat_handle(out, handle_of(file));
}

bool system_allows(const char *path, unsigned how)
{
    wide_path wide;
    if (!widen(wide, path)) {
        return false;
    }
    DWORD is = GetFileAttributesW(wide);
    if (is == INVALID_FILE_ATTRIBUTES) {
        return fail_at(wide, GetLastError());
    }
    bool is_folder = is & FILE_ATTRIBUTE_DIRECTORY;
    errno = EACCES;
    return !(how & SYSTEM_WRITE && is & FILE_ATTRIBUTE_READONLY && !is_folder);
}

int system_open(const char *path, unsigned how)
{
    int standard = find_standard(path);
    if (standard >= 0) {
        return system_copy(standard);
    }
    wide_path wide;
    DWORD access = (how & SYSTEM_READ || !(how & SYSTEM_WRITE) ? GENERIC_READ : 0) |
                   (how & SYSTEM_APPEND  ? FILE_APPEND_DATA | SYNCHRONIZE
                    : how & SYSTEM_WRITE ? GENERIC_WRITE
                                         : 0);
    DWORD make = how & SYSTEM_NEW ? CREATE_NEW : how & SYSTEM_MAKE ? OPEN_ALWAYS : OPEN_EXISTING;
    if (!widen(wide, path)) {
        return -1;
    }
    /* The time of its use is set by who reads, where that is allowed. */
    HANDLE handle = open_handle(wide, access | FILE_WRITE_ATTRIBUTES, make, 0);
    if (handle == INVALID_HANDLE_VALUE && errno == EACCES) {
        handle = open_handle(wide, access, make, 0);
    }
    if (handle != INVALID_HANDLE_VALUE && how & SYSTEM_WRITE && is_folder(handle)) {
        CloseHandle(handle);
        errno = EISDIR;
        return -1;
    }
    int file = own_handle(handle);
    if (file >= 0 && how & SYSTEM_EMPTY && GetFileType(handle) == FILE_TYPE_DISK && ftruncate(file, 0)) {
        close(file);
        file = -1;
    }
    return file;
}

int system_open_temporary(char *path, size_t ending, bool for_us_alone)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz234567"; /* one case, as names have here */
    enum { LETTERS = 6, TRIES = 100 };
    char *at = path + strlen(path) - ending - LETTERS;
    int file = -1;
    (void)for_us_alone; /* who may read it, the folder says */
    errno = EEXIST;
    for (int i = 0; i < TRIES && file < 0 && errno == EEXIST; i++) {
        uint8_t random[LETTERS];
        if (!system_random(random, sizeof random)) {
            errno = EIO;
            return -1;
        }
        for (size_t k = 0; k < LETTERS; k++) {
            at[k] = letters[random[k] % (sizeof letters - 1)];
        }
        file = system_open(path, SYSTEM_READ | SYSTEM_WRITE | SYSTEM_NEW);
    }
    return file;
}

int system_open_nameless(const char *folder)
{
    (void)folder;
    errno = ENOSYS;
    return -1;
}

int system_open_scratch(const char *name)
{
    wide_path folder;
    wide_path path;
    (void)name;
    if (!GetTempPathW(SYSTEM_PATH, folder) || !GetTempFileNameW(folder, L"con", 0, path)) {
        fail_last();
        return -1;
    }
    HANDLE handle = CreateFileW(path, GENERIC_READ | GENERIC_WRITE | DELETE, SHARED, NULL, CREATE_ALWAYS,
                                FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE, NULL);
    if (handle == INVALID_HANDLE_VALUE) {
        fail_last();
        DeleteFileW(path);
    }
    return own_handle(handle);
}

bool system_name(int file, const char *path)
{
    (void)file;
    (void)path;
    errno = ENOSYS;
    return false;
}

int system_copy(int file)
{
    HANDLE copy = INVALID_HANDLE_VALUE;
    if (!DuplicateHandle(GetCurrentProcess(), handle_of(file), GetCurrentProcess(), &copy, 0, FALSE,
                         DUPLICATE_SAME_ACCESS)) {
        fail_last();
    }
    return own_handle(copy);
}

FILE *system_stream(const char *path, const char *how)
{
    bool both = strchr(how, '+');
    unsigned all = (*how == 'r' || both ? SYSTEM_READ : 0) | (*how != 'r' || both ? SYSTEM_WRITE : 0) |
                   (*how != 'r' ? SYSTEM_MAKE : 0) | (*how == 'a' ? SYSTEM_APPEND : 0) |
                   (*how == 'w' ? SYSTEM_EMPTY : 0) | (strchr(how, 'x') ? SYSTEM_NEW : 0);
    int file = system_open(path, all);
    const char mode[4] = {how[0], 'b', both ? '+' : '\0', '\0'};
    FILE *stream = file < 0 ? NULL : fdopen(file, mode);
    if (file >= 0 && !stream) {
        close(file);
    }
    return stream;
}

/* Reading and writing at a place move the place of the file, too, so that it is put back. */
static LARGE_INTEGER place_of(HANDLE handle)
{
    LARGE_INTEGER place = {.QuadPart = -1};
    return SetFilePointerEx(handle, (LARGE_INTEGER){0}, &place, FILE_CURRENT) ? place : (LARGE_INTEGER){.QuadPart = -1};
}

static void put_back(HANDLE handle, LARGE_INTEGER place)
{
    if (place.QuadPart >= 0) {
        SetFilePointerEx(handle, place, NULL, FILE_BEGIN);
    }
}

static DWORD at_once(size_t size)
{
    return size > MOST_AT_ONCE ? MOST_AT_ONCE : (DWORD)size;
}

static OVERLAPPED offset_of(uint64_t at)
{
    return (OVERLAPPED){.Offset = (DWORD)at, .OffsetHigh = (DWORD)(at >> 32)};
}

ptrdiff_t system_read(int file, void *out, size_t size)
{
    DWORD n = 0;
    bool fine = ReadFile(handle_of(file), out, at_once(size), &n, NULL) || GetLastError() == ERROR_BROKEN_PIPE ||
                GetLastError() == ERROR_HANDLE_EOF; /* the end of a pipe, of a file */
    return fine ? (ptrdiff_t)n : (fail_last(), -1);
}

ptrdiff_t system_read_at(int file, void *out, size_t size, uint64_t at)
{
    HANDLE handle = handle_of(file);
    LARGE_INTEGER place = place_of(handle);
    size_t got = 0;
    DWORD n = 1;
    bool fine = true;
    while (n && got < size && fine) {
        OVERLAPPED where = offset_of(at + got);
        fine = ReadFile(handle, (char *)out + got, at_once(size - got), &n, &where);
        if (!fine && GetLastError() == ERROR_HANDLE_EOF) {
            fine = true;
            n = 0;
        }
        got += fine ? n : 0;
    }
    DWORD error = GetLastError();
    put_back(handle, place);
    return fine ? (ptrdiff_t)got : (fail_with(error), -1);
}

bool system_write_at(int file, const void *data, size_t size, uint64_t at)
{
    HANDLE handle = handle_of(file);
    LARGE_INTEGER place = place_of(handle);
    bool fine = true;
    DWORD error = 0;
    for (size_t done = 0; done < size && fine;) {
        DWORD n = 0;
        OVERLAPPED where = offset_of(at + done);
        fine = WriteFile(handle, (const char *)data + done, at_once(size - done), &n, &where);
        error = fine ? 0 : GetLastError();
        done += n;
    }
    put_back(handle, place);
    return fine || fail_with(error);
}

bool system_write(int file, const void *data, size_t size)
{
    for (size_t done = 0; done < size;) {
        DWORD n = 0;
        if (!WriteFile(handle_of(file), (const char *)data + done, at_once(size - done), &n, NULL)) {
            return fail_last();
        }
        done += n;
    }
    return true;
}

int system_stream_error(void)
{
    if (errno == EINVAL) { /* UCRT has it for what it knows no other for: a full disk, a pipe that nobody reads */
        fail_with(_doserrno);
    }
    return errno;
}

bool system_to_disk(int file)
{
    return FlushFileBuffers(handle_of(file)) || fail_last();
}

/* First as POSIX does, also where the file in its place is open; then as older file systems can. */
static bool rename_wide(const wchar_t *from, const wchar_t *to, bool replace)
{
    struct {
        FILE_RENAME_INFO info;
        wide_path name;
    } whole = {.info = {.Flags = 0}};
    enum { REPLACE = 1, AS_POSIX = 2 };
    wide_path full;
    DWORD length = GetFullPathNameW(to, SYSTEM_PATH, full, NULL);
    HANDLE handle = replace && length && length < SYSTEM_PATH
                        ? CreateFileW(from, DELETE | SYNCHRONIZE, SHARED, NULL, OPEN_EXISTING,
                                      FILE_FLAG_BACKUP_SEMANTICS | FILE_FLAG_OPEN_REPARSE_POINT, NULL)
                        : INVALID_HANDLE_VALUE;
    bool done = false;
    if (handle != INVALID_HANDLE_VALUE) {
        whole.info.Flags = REPLACE | AS_POSIX;
        whole.info.FileNameLength = length * (DWORD)sizeof full[0];
        memcpy(whole.info.FileName, full, (length + 1) * sizeof full[0]);
        done = SetFileInformationByHandle(handle, FileRenameInfoEx, &whole, sizeof whole);
        CloseHandle(handle);
    }
    return done || MoveFileExW(from, to, replace ? MOVEFILE_REPLACE_EXISTING : 0) || fail_at(from, GetLastError());
}

bool system_rename(const char *from, const char *to, bool replace)
{
    wide_path a;
    wide_path b;
    return widen(a, from) && widen(b, to) && rename_wide(a, b, replace);
}

bool system_remove(const char *path)
{
    wide_path wide;
    if (!widen(wide, path)) {
        return false;
    }
    DWORD is = GetFileAttributesW(wide);
    bool is_folder_link =
        is != INVALID_FILE_ATTRIBUTES && is & FILE_ATTRIBUTE_DIRECTORY && is & FILE_ATTRIBUTE_REPARSE_POINT;
    return (is_folder_link ? RemoveDirectoryW(wide) : DeleteFileW(wide)) || fail_at(wide, GetLastError());
}

bool system_make_folder(const char *path, bool for_us_alone)
{
    wide_path wide;
    wchar_t text[512];
    struct user user;
    wchar_t *id = NULL;
    SECURITY_ATTRIBUTES rights = {.nLength = sizeof rights};
    if (!widen(wide, path)) {
        return false;
    }
    if (for_us_alone && find_user(&user) && ConvertSidToStringSidW(user.token.User.Sid, &id)) {
        swprintf(text, sizeof text / sizeof text[0], L"O:%lsD:P(A;OICI;FA;;;%ls)(A;OICI;FA;;;SY)", id, id);
        ConvertStringSecurityDescriptorToSecurityDescriptorW(text, SDDL_REVISION_1, &rights.lpSecurityDescriptor, NULL);
        LocalFree(id);
    }
    bool made = (!for_us_alone || rights.lpSecurityDescriptor) && CreateDirectoryW(wide, &rights);
    DWORD error = GetLastError();
    LocalFree(rights.lpSecurityDescriptor);
    return made ||
           (fail_at(wide, error),
            errno = errno == EACCES && GetFileAttributesW(wide) != INVALID_FILE_ATTRIBUTES ? EEXIST : errno, false);
}

bool system_remove_folder(const char *path)
{
    wide_path wide;
    return widen(wide, path) && (RemoveDirectoryW(wide) || fail_at(wide, GetLastError()));
}

/* A right that few have here: those who ask copy. */
bool system_link(const char *target, const char *path)
{
    (void)target;
    (void)path;
    errno = ENOSYS;
    return false;
}

bool system_list(const char *folder, bool (*take)(void *user, const char *name), void *user)
{
    char pattern[SYSTEM_PATH];
    wide_path wide;
    WIN32_FIND_DATAW found;
    if (snprintf(pattern, sizeof pattern, "%s/*", folder) >= (int)sizeof pattern || !widen(wide, pattern)) {
        return false;
    }
    HANDLE find = FindFirstFileExW(wide, FindExInfoBasic, &found, FindExSearchNameMatch, NULL, 0);
    if (find == INVALID_HANDLE_VALUE) {
        return fail_at(wide, GetLastError());
    }
    bool more = true;
    while (more) {
        char name[4 * SYSTEM_NAME];
        more = !narrow(name, sizeof name, found.cFileName) || take(user, name); /* one that is no text is passed over */
        more = more && FindNextFileW(find, &found);
    }
    FindClose(find);
    return true;
}

bool system_real_path(char out[SYSTEM_PATH], const char *path)
{
    wide_path wide;
    wide_path real;
    HANDLE handle =
        widen(wide, path) ? open_handle(wide, FILE_READ_ATTRIBUTES, OPEN_EXISTING, 0) : INVALID_HANDLE_VALUE;
    if (handle == INVALID_HANDLE_VALUE) {
        return false;
    }
    DWORD length = GetFinalPathNameByHandleW(handle, real, SYSTEM_PATH, FILE_NAME_NORMALIZED);
    DWORD error = length ? ERROR_FILENAME_EXCED_RANGE : GetLastError();
    CloseHandle(handle);
    return length && length < SYSTEM_PATH ? narrow(out, SYSTEM_PATH, real) : fail_with(error);
}

bool system_here(char out[SYSTEM_PATH])
{
    wide_path wide;
    DWORD length = GetCurrentDirectoryW(SYSTEM_PATH, wide);
    return length && length < SYSTEM_PATH ? narrow(out, SYSTEM_PATH, wide) : fail_last();
}

bool system_enter(const char *folder)
{
    wide_path wide;
    return widen(wide, folder) && (SetCurrentDirectoryW(wide) || fail_last());
}

/* Devices have their names in every folder, also with an ending. */
bool system_is_open_name(const char *path)
{
    static const char *const names[] = {"CON", "CONIN$", "CONOUT$", "NUL", "PRN", "AUX", "COM#", "LPT#"};
    const char *name = last_name(path);
    size_t length = strcspn(name, ".: ");
    bool found = find_standard(path) >= 0 || is_nothing(path) || strncmp(path, "\\\\.\\", 4) == 0 ||
                 strncmp(path, "//./", 4) == 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0] && !found; i++) {
        size_t same = strcspn(names[i], "#");
        bool has_number = names[i][same] && length == same + 1 && name[same] >= '1' && name[same] <= '9';
        found = (length == same && !names[i][same] && _strnicmp(name, names[i], same) == 0) ||
                (has_number && _strnicmp(name, names[i], same) == 0);
    }
    return found;
}

int system_name_order(const char *a, const char *b)
{
    wide_path one;
    wide_path other;
    bool are_text = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, a, -1, one, SYSTEM_PATH) &&
                    MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, b, -1, other, SYSTEM_PATH);
    return are_text ? CompareStringOrdinal(one, -1, other, -1, TRUE) - CSTR_EQUAL : strcmp(a, b);
}

bool system_program(char out[SYSTEM_PATH])
{
    wide_path wide;
    DWORD length = GetModuleFileNameW(NULL, wide, SYSTEM_PATH);
    return length && length < SYSTEM_PATH && narrow(out, SYSTEM_PATH, wide);
}

/* HOME and TMPDIR have other names here. */
const char *system_variable(const char *name)
{
    static const char *const others[][2] = {{"HOME", "USERPROFILE"}, {"TMPDIR", "TEMP"}};
    /* Values stay for ever, as getenv()'s do: each that was asked for, once. */
    static struct kept {
        struct kept *next;
        char text[];
    } * kept;
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    wchar_t wide[64];
    const wchar_t *value = MultiByteToWideChar(CP_UTF8, 0, name, -1, wide, 64) ? _wgetenv(wide) : NULL;
    for (size_t i = 0; i < sizeof others / sizeof others[0] && !value; i++) {
        if (strcmp(name, others[i][0]) == 0) {
            return system_variable(others[i][1]);
        }
    }
    int size = value ? WideCharToMultiByte(CP_UTF8, WC_ERR_INVALID_CHARS, value, -1, NULL, 0, NULL, NULL) : 0;
    struct kept *made = size > 0 ? malloc(sizeof *made + (size_t)size) : NULL;
    if (!made) {
        return NULL;
    }
    WideCharToMultiByte(CP_UTF8, WC_ERR_INVALID_CHARS, value, -1, made->text, size, NULL, NULL);
    if (wcsncmp(value + (*value != 0), L":\\", 2) == 0) { /* a folder: conus joins names to it, and shows it */
        put_slashes(made->text);
    }
    pthread_mutex_lock(&lock);
    struct kept *found = kept;
    while (found && strcmp(found->text, made->text) != 0) {
        found = found->next;
    }
    if (!found) {
        made->next = kept;
        kept = made;
    }
    pthread_mutex_unlock(&lock);
    if (found) {
        free(made);
    }
    return found ? found->text : made->text;
}

void system_set_variable(const char *name, const char *value)
{
    wide_path wide;
    wide_path set;
    if (MultiByteToWideChar(CP_UTF8, 0, name, -1, wide, SYSTEM_PATH) &&
        MultiByteToWideChar(CP_UTF8, 0, value, -1, set, SYSTEM_PATH)) {
        _wputenv_s(wide, set);
    }
}

void system_forget_variables(void)
{
    static char *none[1];
    _environ = none;
}

double system_to_double(const char *text, char **end)
{
    _locale_t c_locale = _create_locale(LC_ALL, "C");
    double value = _strtod_l(text, end, c_locale);
    _free_locale(c_locale);
    return value;
}

float system_to_float(const char *text, char **end)
{
    _locale_t c_locale = _create_locale(LC_ALL, "C");
    float value = _strtof_l(text, end, c_locale);
    _free_locale(c_locale);
    return value;
}

void *system_map(int file, size_t size)
{
    HANDLE map = CreateFileMappingW(handle_of(file), NULL, PAGE_READONLY, 0, 0, NULL);
    void *memory = map ? MapViewOfFile(map, FILE_MAP_READ, 0, 0, size) : NULL;
    DWORD error = GetLastError();
    if (map) {
        CloseHandle(map);
    }
    return memory ? memory : (fail_with(error), NULL);
}

void system_unmap(const void *memory, size_t size)
{
    (void)size;
    UnmapViewOfFile(memory);
}

void system_make_sparse(void *memory, size_t size)
{
    (void)memory;
    (void)size;
}

bool system_random(void *out, size_t size)
{
    return RtlGenRandom(out, (ULONG)size);
}

size_t system_processors(void)
{
    DWORD_PTR own;
    DWORD_PTR all;
    int count = GetProcessAffinityMask(GetCurrentProcess(), &own, &all) ? __builtin_popcountll(own) : 1;
    return count > 0 ? (size_t)count : 1;
}

bool system_thread(pthread_t *out, size_t stack, void *(*run)(void *user), void *user)
{
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes)) {
        return false;
    }
    (void)pthread_attr_setstacksize(&attributes,
                                    stack ? stack : STACK); /* else it is the program's: Python's is small */
    bool runs = pthread_create(out, &attributes, run, user) == 0;
    pthread_attr_destroy(&attributes);
    return runs;
}

void *system_function(const char *library, const char *name)
{
    wide_path wide;
    HMODULE loaded = widen(wide, library) ? LoadLibraryW(wide) : NULL; /* stays */
    return loaded && name ? (void *)(uintptr_t)GetProcAddress(loaded, name) : (void *)loaded;
}

bool system_wake_begin(struct system_wake *out)
{
    out->file = (intptr_t)CreateEventW(NULL, TRUE, FALSE, NULL);
    return out->file || fail_last();
}

void system_wake(const struct system_wake *wake)
{
    SetEvent((HANDLE)wake->file);
}

void system_wake_end(const struct system_wake *wake)
{
    CloseHandle((HANDLE)wake->file);
}

bool system_wait(int file, const struct system_wake *wake, int most_ms, bool *silent)
{
    enum { LOOK_AGAIN_MS = 5 }; /* a pipe cannot be waited for */
    int waited = 0;
    *silent = false;
    HANDLE handle = handle_of(file);
    HANDLE event = (HANDLE)wake->file;
    DWORD type = GetFileType(handle);
    DWORD there = 0;
    if (type == FILE_TYPE_CHAR) {
        const HANDLE both[] = {event, handle};
        DWORD got = WaitForMultipleObjects(2, both, FALSE, most_ms < 0 ? INFINITE : (DWORD)most_ms);
        *silent = got == WAIT_TIMEOUT;
        return got != WAIT_OBJECT_0;
    }
    while (type == FILE_TYPE_PIPE && PeekNamedPipe(handle, NULL, 0, NULL, &there, NULL) && !there && !*silent) {
        if (WaitForSingleObject(event, LOOK_AGAIN_MS) == WAIT_OBJECT_0) {
            return false;
        }
        waited += LOOK_AGAIN_MS;
        *silent = most_ms >= 0 && waited >= most_ms;
    }
    return WaitForSingleObject(event, 0) != WAIT_OBJECT_0;
}

/* Frees the words until *count; where memory fails, the words are those that the runtime gave. */
static void take_words(int *count, char ***words)
{
    int found = 0;
    wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &found);
    char **narrow_words = wide ? calloc((size_t)found + 1, sizeof *narrow_words) : NULL;
    bool whole = narrow_words;
    for (int i = 0; i < found && whole; i++) {
        int size = WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, NULL, 0, NULL, NULL);
        narrow_words[i] = size > 0 ? malloc((size_t)size) : NULL;
        whole = narrow_words[i] && WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, narrow_words[i], size, NULL, NULL);
    }
    LocalFree((void *)wide);
    if (whole) { /* until the end of the program */
        *count = found;
        *words = narrow_words;
    }
}

/* The word that shells of other systems have for a program that crashes; then the system does what it does. */
static LONG WINAPI say_crash(EXCEPTION_POINTERS *why)
{
    char text[64];
    DWORD n;
    int size = snprintf(text, sizeof text, "conus: ended by exception %lx\n", why->ExceptionRecord->ExceptionCode);
    WriteFile(GetStdHandle(STD_ERROR_HANDLE), text, (DWORD)size, &n, NULL);
    return EXCEPTION_CONTINUE_SEARCH;
}

void system_begin(int *count, char ***words, bool pipes)
{
    (void)pipes; /* a broken one is an error of writing */
    take_words(count, words);
    SetUnhandledExceptionFilter(say_crash);
    for (int file = 0; file <= 2; file++) {
        _setmode(file, _O_BINARY);
        DWORD mode;
        if (GetConsoleMode(handle_of(file), &mode) && file) {
            SetConsoleMode(handle_of(file), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
        }
    }
    SetConsoleOutputCP(CP_UTF8);
    SetConsoleCP(CP_UTF8);
    SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOOPENFILEERRORBOX); /* no window about an empty drive */
}

void system_interrupt(void (*call)(int number))
{
    static const int numbers[] = {SIGINT, SIGBREAK, SIGTERM}; /* SIGBREAK: the console is closed, too */
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (signal(numbers[i], call) == SIG_IGN) {
            signal(numbers[i], SIG_IGN);
        }
    }
}

bool system_stack_is_below(size_t size)
{
    ULONG_PTR low;
    ULONG_PTR high;
    GetCurrentThreadStackLimits(&low, &high);
    return high - low < size;
}

bool system_leave_signals(void)
{
    return true; /* they get threads of their own */
}

void system_step_back(int by)
{
    SetThreadPriority(GetCurrentThread(), by > 10 ? THREAD_PRIORITY_LOWEST : THREAD_PRIORITY_BELOW_NORMAL);
}

bool system_is_terminal(int file)
{
    DWORD mode;
    return GetConsoleMode(handle_of(file), &mode);
}

/* The window and other programs for Unix are not here. */
void system_become(const char *program, char **words)
{
    (void)program;
    (void)words;
    errno = ENOENT;
}

bool system_show(const char *path)
{
    wide_path wide;
    return widen(wide, path) && (intptr_t)ShellExecuteW(NULL, L"open", wide, NULL, NULL, SW_SHOWNORMAL) > 32;
}

unsigned system_columns(int file)
{
    CONSOLE_SCREEN_BUFFER_INFO info;
    return GetConsoleScreenBufferInfo(handle_of(file), &info) ? (unsigned)(info.srWindow.Right - info.srWindow.Left + 1)
                                                              : 0;
}

FILE *system_text_open(struct system_text *out)
{
    int file = system_open_scratch("text");
    *out = (struct system_text){0};
    out->stream = file < 0 ? NULL : fdopen(file, "w+b");
    if (file >= 0 && !out->stream) {
        close(file);
    }
    return out->stream;
}

char *system_text_close(struct system_text *text)
{
    struct system_stat info;
    bool whole =
        text->stream && !ferror(text->stream) && !fflush(text->stream) && system_stat_open(&info, fileno(text->stream));
    text->data = whole ? malloc((size_t)info.size + 1) : NULL;
    whole =
        text->data && system_read_at(fileno(text->stream), text->data, (size_t)info.size, 0) == (ptrdiff_t)info.size;
    if (text->stream) {
        fclose(text->stream);
    }
    if (!whole) {
        free(text->data);
    } else {
        text->data[info.size] = '\0';
    }
    *text = (struct system_text){.data = whole ? text->data : NULL, .size = whole ? (size_t)info.size : 0};
    return text->data;
}
