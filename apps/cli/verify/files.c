/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds files that a sidecar records, by their paths and checksums. */
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/verify/verify.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdlib.h>
#include <string.h>

char *recorded_folder(const char *recorded, const char *actual)
{
    size_t folders = recorded ? path_folder_length(recorded) : 0; /* "out/" of "out/rows.tsv" */
    size_t length = path_folder_length(actual);
    bool fits = length >= folders && !*path_joint(actual, length - folders) &&
                memcmp(actual + length - folders, recorded ? recorded : "", folders) == 0;
    return text_copy(actual, fits && recorded && !path_is_whole(recorded) ? length - folders : 0);
}

static bool has_sum(const struct recorded_file *file, const char *path, uint64_t bytes)
{
    char sum[SHA256_TEXT];
    return file->sha256 && (file->bytes < 0 || (uint64_t)file->bytes == bytes) && system_allows(path, SYSTEM_READ) &&
           !provenance_hash_file(sum, path) && strcmp(sum, file->sha256) == 0;
}

/* Takes the path in the folder if the file is there; where it was, keeps in mind that there is another one. */
static bool try_path(struct found_file *out, const struct recorded_file *file, const char *folder, const char *path,
                     enum file_state state)
{
    char joined[SYSTEM_PATH];
    char real[SYSTEM_PATH];
    struct system_stat info;
    folder = path_is_whole(path) ? "" : folder;
    bool fits =
        snprintf(joined, sizeof joined, "%s%s%s", folder, path_joint(folder, strlen(folder)), path) < SYSTEM_PATH;
    if (!fits || !system_real_path(real, joined) || !system_stat(&info, real)) {
        return false;
    }
    bool is_folder = info.kind == SYSTEM_FOLDER && file->sha256 && file->bytes < 0;
    bool is_same = is_folder || (info.kind == SYSTEM_FILE && has_sum(file, joined, info.size));
    if (is_same || (info.kind == SYSTEM_FILE && state == FILE_SAME)) {
        free(out->path);
        out->path = strdup(real);
        out->is_folder = is_folder;
        out->is_replaced = out->is_replaced || !is_same;
        out->state = !is_same ? FILE_CHANGED : is_folder && state == FILE_SAME ? FILE_UNSUMMED : state;
    }
    return is_same;
}

struct search {
    struct found_file *out;
    const struct recorded_file *file;
    const char *folder;
};

static bool take_other(void *user, const char *name)
{
    struct search *search = user;
    return !try_path(search->out, search->file, search->folder, name, FILE_MOVED);
}

/* Whether it is in the folder, by its path, less and less of it, or its bytes. */
static bool search_folder(struct found_file *out, const struct recorded_file *file, const char *folder)
{
    struct search search = {out, file, folder};
    const char *rest = file->path;
    const char *part;
    size_t length;
    bool found = try_path(out, file, folder, rest, FILE_SAME);
    while (!found && path_part(&rest, &part, &length)) {
        found = length && try_path(out, file, folder, part, FILE_MOVED);
    }
    if (!found && file->bytes >= 0) { /* only then the length tells most of them apart, unread */
        system_list(*folder ? folder : ".", take_other, &search);
    }
    return found || out->state == FILE_MOVED;
}

bool file_find(struct found_file *out, const struct recorded_file *file, const char *ran, const char *told)
{
    *out = (struct found_file){.state = FILE_MISSING};
    if (!search_folder(out, file, ran) && told) {
        search_folder(out, file, told);
    }
    return out->state == FILE_MISSING || out->path || refuse("not enough memory");
}

int record_read(struct record *out, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    int code = input_file_read(&text, &size, path, INPUT_FILE, RECORD_LIMIT);
    const char *bad = code ? NULL : record_parse(out, text, size);
    free(text);
    return bad ? print_data_error("%s: %s", path, bad) : code;
}

/* "a.json" of "a.tsv", "a.nii.gz", "a.png" and "a". */
static char *path_without_ending(const char *result)
{
    static const char endings[] = ".func.gii/.shape.gii/.nii.gz/.tsv/.csv/.txt/.nii/.tck/.vtk/.png/.exr";
    size_t length = strlen(result) - path_ending_length(result, endings);
    char *path = NULL;
    return asprintf(&path, "%.*s.json", (int)length, result) < 0 ? NULL : path;
}

char *sidecar_find(const char *result)
{
    char *beside = NULL;
    if (path_ends_in(result, ".json") && system_allows(result, 0)) {
        return strdup(result);
    }
    if (asprintf(&beside, "%s.json", result) < 0) {
        return NULL;
    }
    if (!system_allows(beside, 0)) {
        free(beside);
        beside = path_without_ending(result);
    }
    if (beside && !system_allows(beside, 0)) {
        free(beside);
        beside = NULL;
    }
    return beside;
}
