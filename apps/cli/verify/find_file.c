/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries the places where a file may be, by its size first and then by its SHA-256. */
#include "cli/verify/find_file.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char *const file_state_names[] = {"same", "moved", "not recorded", "not compared", "changed", "missing"};

static bool add_candidate(struct places *places, const char *path, int64_t bytes)
{
    size_t count = places->candidate_count;
    if (!(count & (count - 1))) { /* a power of two is full */
        struct place *more = realloc(places->candidates, (count ? 2 * count : 1) * sizeof *more);
        if (!more) {
            return false;
        }
        places->candidates = more;
    }
    char *copy = strdup(path);
    if (copy) {
        places->candidates[places->candidate_count++] = (struct place){copy, bytes};
    }
    return copy;
}

/* A walk through a folder. */
struct search {
    struct places *places;
    const char *folder;
    size_t *entries;
    int depth;
    bool whole; /* there was memory */
};

static bool walk(struct places *places, const char *folder, size_t *entries, int depth);

static bool take_entry(void *user, const char *name)
{
    struct search *search = user;
    struct places *places = search->places;
    struct system_stat info;
    char *path = NULL;
    if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) {
        return true;
    }
    places->is_cut = places->is_cut || ++*search->entries > SEARCH_ENTRIES;
    if (places->is_cut) {
        return false;
    }
    search->whole = asprintf(&path, "%s/%s", search->folder, name) >= 0;
    if (search->whole && system_stat_link(&info, SYSTEM_HERE, path)) { /* links are not followed */
        search->whole = info.kind == SYSTEM_FOLDER ? walk(places, path, search->entries, search->depth + 1)
                        : info.kind == SYSTEM_FILE ? add_candidate(places, path, (int64_t)info.size)
                                                   : true;
    }
    free(path);
    return search->whole;
}

/* A folder that cannot be read has nothing that could be found. */
static bool walk(struct places *places, const char *folder, size_t *entries, int depth)
{
    struct search search = {places, folder, entries, depth, true};
    if (depth < SEARCH_DEPTH) {
        system_list(folder, take_entry, &search);
    }
    return search.whole;
}

int places_add(struct places *places, const char *folder)
{
    struct system_stat info;
    size_t entries = places->candidate_count;
    if (!system_stat(&info, folder)) {
        return print_system_error(folder, "search");
    }
    if (info.kind != SYSTEM_FOLDER) {
        return print_usage_error("--search: %s is no folder", folder);
    }
    if (!walk(places, folder, &entries, 0)) {
        return print_no_memory();
    }
    return EXIT_DONE;
}

void places_finish(struct places *places)
{
    for (size_t i = 0; i < places->candidate_count; i++) {
        free(places->candidates[i].path);
    }
    free(places->candidates);
    free(places->base);
    *places = (struct places){0};
}

char *base_folder(const char *recorded, const char *actual)
{
    size_t folders = recorded ? path_folder_length(recorded) : 0; /* "out/" of "out/rows.tsv" */
    size_t length = path_folder_length(actual);
    bool fits = length >= folders && !*path_joint(actual, length - folders) &&
                memcmp(actual + length - folders, recorded ? recorded : "", folders) == 0;
    return fits && !path_is_whole(recorded) ? text_copy(actual, length - folders) : NULL;
}

static bool has_sum(const struct recorded_file *file, const char *path, int64_t bytes)
{
    char sum[SHA256_TEXT];
    return (file->bytes < 0 || file->bytes == bytes) && system_allows(path, SYSTEM_READ) &&
           !provenance_hash_file(sum, path) && strcmp(sum, file->sha256) == 0;
}

/* Takes `path`, which it frees, if it is the file; else, where it was, keeps in mind that there is another one. The sum
 * of a folder is that of the chunks in it, which answering again finds. */
static bool try_path(struct found_file *out, const struct recorded_file *file, char *path, enum file_state state)
{
    struct system_stat info;
    bool is_there = path && system_stat(&info, path);
    bool known = file->sha256;
    bool is_folder = is_there && info.kind == SYSTEM_FOLDER && known && file->bytes < 0;
    bool is = is_folder || (is_there && info.kind == SYSTEM_FILE);
    bool same = is_folder || (is && known && has_sum(file, path, (int64_t)info.size));
    if (same || (is && state == FILE_SAME && !out->path)) {
        free(out->path);
        char real[SYSTEM_PATH];
        out->path = system_real_path(real, path) ? strdup(real) : NULL;
        out->state = same ? state : known ? FILE_CHANGED : FILE_UNKNOWN;
        out->is_folder = is_folder;
    }
    free(path);
    return same || (is && state == FILE_SAME && !known);
}

/* Tries files of its name first: among many of one size, one of these is most likely. */
static void search(struct found_file *out, const struct recorded_file *file, const struct places *places)
{
    for (int named = 1; named >= 0; named--) {
        for (size_t i = 0; i < places->candidate_count; i++) {
            const struct place *place = &places->candidates[i];
            bool is_named = strcmp(path_name(place->path), path_name(file->path)) == 0;
            if (is_named == named && (file->bytes < 0 || file->bytes == place->bytes) &&
                has_sum(file, place->path, place->bytes)) {
                try_path(out, file, strdup(place->path), FILE_MOVED);
                return;
            }
        }
    }
}

bool file_find(struct found_file *out, const struct recorded_file *file, const struct places *places)
{
    *out = (struct found_file){.state = FILE_MISSING};
    bool found = !output_is_stdout(file->path) && try_path(out, file, strdup(file->path), FILE_SAME);
    char *path = NULL;
    if (!found && places->base && !path_is_whole(file->path) &&
        asprintf(&path, "%s%s", places->base, file->path) >= 0) {
        found = try_path(out, file, path, FILE_SAME);
    }
    for (size_t i = 0; i < 2 && !found; i++) {
        const char *other = places->beside[i];
        if (other && asprintf(&path, "%.*s%s", (int)(path_name(other) - other), other, path_name(file->path)) >= 0) {
            found = try_path(out, file, path, FILE_MOVED);
        }
    }
    if (!found && file->sha256) {
        search(out, file, places);
    }
    if (out->state != FILE_MISSING && !out->path) {
        print_error_line("%s: %s", file->path, text_error(errno));
    }
    return out->state == FILE_MISSING || out->path;
}

/* The path without `rest` at its end; NULL where it does not end so. */
static char *folder_of(const char *path, const char *rest)
{
    size_t size = path ? strlen(path) : 0;
    size_t length = strlen(rest);
    bool fits = path_is_whole(rest) && size > length && strcmp(path + size - length, rest) == 0;
    return fits ? text_copy(path, size - length) : NULL;
}

void files_find_folders(struct found_file *found, const struct recorded_file *files, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t length = strlen(files[i].path);
        size_t best = length; /* the file that is deepest in it says most */
        bool is_missing = found[i].state == FILE_MISSING;
        for (size_t k = i + 1; is_missing && k < count && strncmp(files[k].path, files[i].path, length) == 0; k++) {
            char *folder = strlen(files[k].path) > best ? folder_of(found[k].path, files[k].path + length) : NULL;
            if (folder) {
                best = strlen(files[k].path);
                free(found[i].path);
                found[i] = (struct found_file){.path = folder, .state = FILE_MOVED, .is_folder = true};
            }
        }
    }
}
