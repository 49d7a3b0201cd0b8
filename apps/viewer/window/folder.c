/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads, filters and sorts the entries of a folder. */
#include "viewer/window/folder.h"

#include "options/output.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool folder_can_open(const char *name)
{
    static const char *const endings[] = {".nii", ".mgz",  ".mgh",  ".nrrd", ".nhdr", ".mha",  ".mhd",
                                          ".img", ".hdr",  ".head", ".brik", ".tif",  ".tiff", ".gii",
                                          ".obj", ".ply",  ".stl",  ".off",  ".mz3",  ".vtk",  ".annot",
                                          ".vtp", ".json", ".xml",  ".trk",  ".tck",  ".trx",  ".tt"};
    char plain[NAME_MAX + 1];
    snprintf(plain, sizeof plain, "%s", name);
    if (path_ends(plain, ".gz")) {
        plain[strlen(plain) - 3] = '\0';
    }
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends(plain, endings[i])) {
            return true;
        }
    }
    return false;
}

bool folder_fits(const char *name, const char *text)
{
    return !*text || strcasestr(name, text);
}

static bool is_listed(const char *name, bool is_folder, enum folder_filter filter)
{
    bool fits = filter == FOLDER_ALL || (filter == FOLDER_SESSIONS ? path_ends(name, ".json") : folder_can_open(name));
    return name[0] != '.' && (is_folder || fits);
}

static bool is_folder_at(const char *folder, const char *name)
{
    char path[PATH_MAX];
    struct stat info;
    int size = snprintf(path, sizeof path, "%s/%s", folder, name);
    return size < PATH_MAX && stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* Takes one more; false without memory. */
static bool add(struct folder *folder, const char *name, bool is_folder)
{
    bool is_full = !(folder->count & (folder->count - 1)); /* at 0, 1, 2, 4 ... it doubles */
    size_t room = folder->count ? 2 * folder->count : 1;
    struct folder_entry *entries = is_full ? realloc(folder->entries, room * sizeof *entries) : folder->entries;
    folder->entries = entries ? entries : folder->entries;
    char *copy = entries ? strdup(name) : NULL;
    if (copy) {
        folder->entries[folder->count++] = (struct folder_entry){copy, is_folder};
    }
    return copy;
}

static int compare(const void *a, const void *b)
{
    const struct folder_entry *one = a;
    const struct folder_entry *other = b;
    int order = one->is_folder == other->is_folder ? strcasecmp(one->name, other->name) : 0;
    return one->is_folder != other->is_folder ? other->is_folder - one->is_folder
           : order                            ? order
                                              : strcmp(one->name, other->name);
}

void folder_read(struct folder *folder, const char *path, enum folder_filter filter)
{
    folder_finish(folder);
    DIR *entries = opendir(path);
    snprintf(folder->path, sizeof folder->path, "%s", path);
    folder->filter = filter;
    folder->failed = !entries;
    for (const struct dirent *entry; entries && !folder->failed && folder->count < FOLDER_LIMIT;) {
        entry = readdir(entries);
        if (!entry) {
            break;
        }
        bool may_be_folder = entry->d_type == DT_DIR || entry->d_type == DT_LNK || entry->d_type == DT_UNKNOWN;
        bool is_folder = entry->d_name[0] != '.' && may_be_folder && is_folder_at(path, entry->d_name);
        folder->failed = is_listed(entry->d_name, is_folder, filter) && !add(folder, entry->d_name, is_folder);
    }
    if (entries) {
        closedir(entries);
    }
    if (folder->count) {
        qsort(folder->entries, folder->count, sizeof *folder->entries, compare);
    }
}

void folder_finish(struct folder *folder)
{
    for (size_t i = 0; i < folder->count; i++) {
        free(folder->entries[i].name);
    }
    free(folder->entries);
    *folder = (struct folder){.path = ""};
}
