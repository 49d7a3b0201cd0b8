/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes and removes a folder of links and outputs. No name of a sidecar leads out of it. */
#include "cli/verify/stage.h"

#include "options/messages.h"
#include "options/output.h"

#include <dirent.h>
#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OPEN_FOLDERS = 16, LEVELS = 64 };

static const char root[] = "/root"; /* of absolute paths */

/* How many components of `path` are "..". */
static size_t levels_up(const char *path)
{
    size_t count = 0;
    for (const char *at = path; *at;) {
        size_t length = strcspn(at, "/");
        count += length == 2 && at[0] == '.' && at[1] == '.';
        at += length + (at[length] == '/');
    }
    return count;
}

/* Makes every folder that `path` names before its last slash, from `from` on. */
static bool make_folders(char *path, size_t from)
{
    for (char *slash = path + from; (slash = strchr(slash, '/')); slash++) {
        *slash = '\0';
        bool made = mkdir(path, 0700) == 0 || errno == EEXIST;
        *slash = '/';
        if (!made) {
            return false;
        }
    }
    return true;
}

/* A ".." of an absolute path could lead out of the folder, and none of ours has one behind its first folder. */
static bool link_file(const struct stage *stage, const char *path, const char *target)
{
    bool absolute = *path == '/';
    const char *below = absolute ? stage->folder : stage->cwd;
    char *link = NULL;
    if (absolute && levels_up(path)) {
        print_error_line("%s: has \"..\" in it, and moved", path);
        return false;
    }
    if (asprintf(&link, "%s%s%s", below, absolute ? root : "/", path) < 0) {
        print_error_line("not enough memory");
        return false;
    }
    bool made = make_folders(link, strlen(stage->folder) + 1) && (symlink(target, link) == 0 || errno == EEXIST);
    if (!made) {
        print_error_line("%s: cannot link: %s", path, strerror(errno));
    }
    free(link);
    return made;
}

static bool make_cwd(struct stage *out, const struct record *record)
{
    size_t levels = 1;
    for (size_t i = 0; i < record->input_count; i++) {
        const char *path = record->inputs[i].path;
        size_t up = *path == '/' ? 0 : 1 + levels_up(path);
        levels = up > levels ? up : levels;
    }
    if (levels > LEVELS) {
        print_error_line("a path has more than %d \"..\"", LEVELS);
        return false;
    }
    size_t length = strlen(out->folder);
    out->cwd = calloc(1, length + sizeof "/files" + 2 * levels + 1);
    if (!out->cwd) {
        print_error_line("not enough memory");
        return false;
    }
    char *end = stpcpy(stpcpy(out->cwd, out->folder), "/files");
    for (size_t i = 0; i < levels; i++) {
        end = stpcpy(end, "/d");
    }
    *end = '/';
    bool made = make_folders(out->cwd, length + 1);
    *end = '\0';
    return made || (print_system_error(out->cwd, "make"), false);
}

static bool make_folder(struct stage *out)
{
    const char *temporary = getenv("TMPDIR");
    if (asprintf(&out->folder, "%s/conus-verify-XXXXXX", temporary && *temporary == '/' ? temporary : "/tmp") < 0) {
        out->folder = NULL;
        print_error_line("not enough memory");
        return false;
    }
    if (!mkdtemp(out->folder)) {
        print_system_error(out->folder, "make");
        free(out->folder);
        out->folder = NULL;
        return false;
    }
    return asprintf(&out->messages, "%s/messages", out->folder) >= 0 || (out->messages = NULL);
}

bool stage_make(struct stage *out, const struct record *record, const struct found_file *found)
{
    *out = (struct stage){0};
    bool made = make_folder(out) && make_cwd(out, record);
    for (size_t i = 0; i < record->input_count; i++) {
        const char *path = record->inputs[i].path;
        char *here = *path == '/' && found[i].path ? realpath(path, NULL) : NULL;
        out->is_moved = out->is_moved || (*path == '/' && found[i].path && (!here || strcmp(here, found[i].path) != 0));
        free(here);
    }
    for (size_t i = 0; i < record->input_count && made; i++) {
        const char *path = record->inputs[i].path;
        bool links = found[i].path && (*path != '/' || out->is_moved);
        made = !links || link_file(out, path, found[i].path);
    }
    return made;
}

void stage_finish(struct stage *stage)
{
    free(stage->cwd);
    free(stage->messages);
    *stage = (struct stage){.folder = stage->folder};
}

/* Before every path that begins with a slash: the word's, "from=/a.nii", "@/names.txt". */
char *stage_word(const struct stage *stage, const char *given)
{
    char *word = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&word, &size);
    for (const char *at = given; out && *at; at++) {
        bool begins = at == given || at[-1] == '=' || at[-1] == '@';
        if (*at == '/' && begins && stage->is_moved) {
            fprintf(out, "%s%s", stage->folder, root);
        }
        fputc(*at, out);
    }
    if (!out || fclose(out)) {
        free(word);
        return NULL;
    }
    return word;
}

char *stage_output(const struct stage *stage, const char *option, const char *name)
{
    char *path = NULL;
    const char *own = !*name || strcmp(name, ".") == 0 || strcmp(name, "..") == 0 || strchr(name, '/') ? "rows" : name;
    if (asprintf(&path, "%s/out/%s/%s", stage->folder, option, own) < 0) {
        return NULL;
    }
    if (!make_folders(path, strlen(stage->folder) + 1)) {
        free(path);
        return NULL;
    }
    return path;
}

/* The one without another that has ".json" behind or in place of its ending: with a sidecar there are two files. */
char *stage_find_output(const char *folder, const char *option)
{
    char *path = NULL;
    char *found = NULL;
    if (!folder || asprintf(&path, "%s/out/%s", folder, option) < 0) {
        return NULL;
    }
    struct dirent **entries = NULL;
    int count = scandir(path, &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        const char *name = entries[i]->d_name;
        bool is_sidecar = path_ends(name, ".json") && count > 3; /* with . and .. */
        if (name[0] != '.' && !is_sidecar && !found && asprintf(&found, "%s/%s", path, name) < 0) {
            found = NULL;
        }
    }
    for (int i = 0; i < count; i++) {
        free(entries[i]);
    }
    free((void *)entries);
    free(path);
    return found;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *at)
{
    (void)info;
    (void)kind;
    (void)at;
    return remove(path);
}

void stage_remove(char *folder)
{
    if (folder) {
        nftw(folder, remove_entry, OPEN_FOLDERS, FTW_DEPTH | FTW_PHYS);
    }
    free(folder);
}
