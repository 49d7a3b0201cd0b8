/* SPDX-License-Identifier: BSD-3-Clause */
/* Folders, links and copies in a new temporary folder, and its removal. */
#include "options/output.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "options/messages.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FOLDERS = 64, TRIES = 8, COPIED_AT_ONCE = 1 << 16 };

static const char root[] = "/root";     /* of absolute paths */
static const char drives[] = "/drive/"; /* of those that begin with one: "C/a" of "C:/a" */

/* Writes the folder of an absolute path in the stage; gives what of the path belongs behind it. */
static const char *put_folder(FILE *out, const struct stage *stage, const char *path)
{
    bool has_drive = path[0] != '/' && path[1] == ':';
    fprintf(out, "%s%s%.*s", stage->folder, has_drive ? drives : root, has_drive, path);
    return path + (has_drive ? 2 : 0);
}

/* How many components of `path` are "..". */
static int levels_up(const char *path)
{
    int count = 0;
    const char *part;
    for (size_t length; path_part(&path, &part, &length);) {
        count += length == 2 && part[0] == '.' && part[1] == '.';
    }
    return count;
}

static bool make_folder(void *user, const char *path)
{
    (void)user;
    return system_make_folder(path, true) || errno == EEXIST;
}

/* Makes every folder that `path` names before its last slash, from `from` on. */
static bool make_folders(char *path, size_t from)
{
    return path_each_folder(path, from, make_folder, NULL);
}

static bool is_no_link(void *user, const char *path)
{
    struct system_stat info;
    (void)user;
    return !system_stat_link(&info, path) || info.kind != SYSTEM_LINK;
}

/* Whether a folder of the path, from `from` on, is a link: to a store, whose files are there with it. */
static bool is_in_link(char *path, size_t from)
{
    return !path_each_folder(path, from, is_no_link, NULL);
}

/* Whether there is no other way to have a file in the stage than a copy. */
static bool cannot_link(void)
{
    return errno == ENOSYS || errno == EPERM;
}

bool file_copy(const char *from, const char *to)
{
    char bytes[COPIED_AT_ONCE];
    int in = system_open(from, SYSTEM_READ);
    int out = in < 0 ? SYSTEM_NO_FILE : system_open(to, SYSTEM_WRITE | SYSTEM_MAKE | SYSTEM_NEW);
    bool is_there = in >= 0 && out < 0 && errno == EEXIST;
    bool copied = out >= 0;
    ptrdiff_t size = 1;
    for (uint64_t at = 0; copied && size > 0; at += size > 0 ? (uint64_t)size : 0) {
        size = system_read_at(in, bytes, sizeof bytes, at);
        copied = size >= 0 && system_write(out, bytes, (size_t)size);
    }
    int error = errno;
    if (in >= 0) {
        close(in);
    }
    if (out >= 0 && close(out)) {
        copied = false;
    }
    errno = copied ? errno : error;
    return copied || is_there;
}

struct copying {
    const char *from, *to;
    int levels; /* of folders that may follow */
    bool done;
};

static bool copy_any(const char *from, const char *to, int levels);

static bool copy_entry(void *user, const char *name)
{
    struct copying *copying = user;
    char from[SYSTEM_PATH];
    char to[SYSTEM_PATH];
    if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0) {
        errno = ENAMETOOLONG;
        copying->done = snprintf(from, sizeof from, "%s/%s", copying->from, name) < SYSTEM_PATH &&
                        snprintf(to, sizeof to, "%s/%s", copying->to, name) < SYSTEM_PATH &&
                        copy_any(from, to, copying->levels);
    }
    return copying->done;
}

static bool copy_any(const char *from, const char *to, int levels)
{
    struct system_stat info;
    struct copying copying = {.from = from, .to = to, .levels = levels - 1, .done = true};
    if (!system_stat(&info, from)) {
        return false;
    }
    if (info.kind != SYSTEM_FOLDER) {
        return file_copy(from, to);
    }
    return levels && make_folder(NULL, to) && system_list(from, copy_entry, &copying) && copying.done;
}

/* Refuses ".." that could lead out of the folder. */
bool stage_link(const struct stage *stage, const char *path, const char *target)
{
    struct system_text text;
    const int up = levels_up(path);
    if (up && (path_is_whole(path) || up >= stage->levels)) {
        return refuse(path_is_whole(path) ? "%s: has \"..\" in it, and moved" : "%s: has too many \"..\"", path);
    }
    FILE *out = system_text_open(&text);
    if (out && path_is_whole(path)) {
        fputs(put_folder(out, stage, path), out);
    } else if (out) {
        fprintf(out, "%s/%s", stage->cwd, path);
    }
    char *link = system_text_close(&text);
    if (!link) {
        return refuse("not enough memory");
    }
    size_t from = strlen(stage->folder) + 1;
    bool made = is_in_link(link, from) ||
                (make_folders(link, from) &&
                 (system_link(target, link) || errno == EEXIST || (cannot_link() && copy_any(target, link, FOLDERS))));
    if (!made) {
        print_error_line("%s: cannot link: %s", path, text_error(errno));
    }
    free(link);
    return made;
}

/* A folder in which "x/../" of so many levels lead nowhere else. */
static bool make_cwd(struct stage *out)
{
    struct system_text text;
    FILE *cwd = system_text_open(&text);
    for (int i = 0; cwd && i <= out->levels; i++) {
        fputs(i ? "/d" : out->folder, cwd);
    }
    if (cwd) {
        fputc('/', cwd);
    }
    out->cwd = system_text_close(&text);
    if (!out->cwd) {
        return refuse("not enough memory");
    }
    bool made = make_folders(out->cwd, strlen(out->folder) + 1);
    out->cwd[strlen(out->cwd) - 1] = '\0';
    return made || (print_system_error(out->cwd, "make"), false);
}

bool stage_begin(struct stage *out, const char *name, int levels)
{
    const char *temporary = system_variable("TMPDIR");
    char path[SYSTEM_PATH];
    char real[SYSTEM_PATH];
    uint8_t random[3];
    *out = (struct stage){.levels = levels};
    do {
        errno = ENAMETOOLONG;
        bool fits =
            system_random(random, sizeof random) &&
            snprintf(path, sizeof path, "%s/conus-%s-%02x%02x%02x", path_is_whole(temporary) ? temporary : "/tmp", name,
                     random[0], random[1], random[2]) < SYSTEM_PATH;
        if (fits && system_make_folder(path, true)) {
            out->folder = strdup(system_real_path(real, path) ? real : path);
            return out->folder ? make_cwd(out) : refuse("not enough memory");
        }
    } while (errno == EEXIST);
    print_system_error(path, "make");
    return false;
}

/* Puts the folder before each absolute path in the word: "/a.nii", "from=/a.nii", "@/names.txt". */
char *stage_word(const struct stage *stage, const char *given)
{
    struct system_text word;
    FILE *out = system_text_open(&word);
    for (const char *at = given; out && *at;) {
        bool begins = at == given || at[-1] == '=' || at[-1] == '@';
        at = begins && path_is_whole(at) ? put_folder(out, stage, at) : at;
        if (*at) { /* a drive alone has nothing behind it */
            fputc(*at++, out);
        }
    }
    return system_text_close(&word);
}

void stage_leave(char *text, const char *folder)
{
    const size_t length = strlen(folder);
    for (char *at = text; (at = strstr(at, folder));) {
        const char *behind = at + length;
        size_t drive = strlen(drives);
        if (strncmp(behind, root, strlen(root)) == 0) {
            behind += strlen(root);
        } else if (strncmp(behind, drives, drive) == 0 && behind[drive]) {
            *at++ = behind[drive];
            *at++ = ':';
            behind += drive + 1;
        } else {
            at += length;
        }
        memmove(at, behind, strlen(behind) + 1);
    }
}

char *stage_output(const struct stage *stage, const char *option, const char *name)
{
    char *path = NULL;
    const char *own =
        !*name || strcmp(name, ".") == 0 || strcmp(name, "..") == 0 || !path_is_name(name) ? "rows" : name;
    if (asprintf(&path, "%s/out/%s/%s", stage->folder, option, own) < 0) {
        return NULL;
    }
    if (!make_folders(path, strlen(stage->folder) + 1)) {
        free(path);
        return NULL;
    }
    return path;
}

/* Files in a folder: how many, and the first by name, with and without a sidecar's. */
struct listed {
    char first[SYSTEM_NAME + 1], other[SYSTEM_NAME + 1];
    size_t count;
};

static void keep_first(char *first, const char *name)
{
    if (!*first || strcmp(name, first) < 0) {
        snprintf(first, SYSTEM_NAME + 1, "%s", name);
    }
}

static bool list_file(void *user, const char *name)
{
    struct listed *listed = user;
    if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0) {
        listed->count++;
    }
    if (name[0] != '.') {
        keep_first(listed->first, name);
    }
    if (name[0] != '.' && !path_ends_in(name, ".json")) {
        keep_first(listed->other, name);
    }
    return true;
}

/* The one of two files that is no sidecar: that has ".json" behind or in place of the other's ending. */
char *stage_find_output(const struct stage *stage, const char *option)
{
    char *path = NULL;
    char *found = NULL;
    struct listed listed = {0};
    if (asprintf(&path, "%s/out/%s", stage->folder, option) < 0) {
        return NULL;
    }
    (void)system_list(path, list_file, &listed);
    const char *name = listed.count > 1 ? listed.other : listed.first;
    if (*name && asprintf(&found, "%s/%s", path, name) < 0) {
        found = NULL;
    }
    free(path);
    return found;
}

static void remove_folder(char *path);

static bool remove_entry(void *user, const char *name)
{
    char path[SYSTEM_PATH];
    struct system_stat info;
    if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
        snprintf(path, sizeof path, "%s/%s", (const char *)user, name) < SYSTEM_PATH && system_stat_link(&info, path)) {
        if (info.kind == SYSTEM_FOLDER) {
            remove_folder(path);
        } else {
            (void)system_remove(path);
        }
    }
    return true;
}

/* Some systems leave out names of a folder from which others are removed meanwhile. */
static void remove_folder(char *path)
{
    for (size_t i = 0; i < TRIES && !system_remove_folder(path); i++) {
        (void)system_list(path, remove_entry, path);
    }
}

void stage_end(struct stage *stage, bool stays)
{
    if (stage->folder && !stays) {
        remove_folder(stage->folder);
    }
    free(stage->folder);
    free(stage->cwd);
    *stage = (struct stage){0};
}
