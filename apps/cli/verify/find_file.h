/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Finds files that a sidecar records, where they were or by their checksums. */
#ifndef CONUS_CLI_VERIFY_FIND_FILE_H
#define CONUS_CLI_VERIFY_FIND_FILE_H

#include "cli/verify/record.h"

enum { SEARCH_ENTRIES = 100000, SEARCH_DEPTH = 16 };

enum file_state {
    FILE_SAME,     /**< Where it was, with its checksum. */
    FILE_MOVED,    /**< Elsewhere, with its checksum. */
    FILE_UNKNOWN,  /**< Where it was; its checksum is not recorded. */
    FILE_UNSUMMED, /**< A folder. Its checksum is that of the chunks that were read: a different answer may have read
                      others. */
    FILE_CHANGED,  /**< A file of its name is there, with another checksum. */
    FILE_MISSING,
};

extern const char *const file_state_names[]; /**< By file_state. */

struct found_file {
    char *path; /**< Absolute; NULL where it is missing. */
    enum file_state state;
    bool is_folder; /**< A Zarr store, whose checksum is that of the chunks read: only the new answer can tell it. */
};

/** Where to look. Zeroed, only where the files were. */
struct places {
    char *base;               /**< The folder in which conus ran, "" = this one. NULL = not known. */
    const char *beside[2];    /**< Files in whose folders to look: the result, its sidecar. NULL = none. */
    struct place *candidates; /**< [candidate_count] Regular files in the folders of --search. */
    size_t candidate_count;
    bool is_cut; /**< There were more entries than SEARCH_ENTRIES. */
};

struct place {
    char *path;
    int64_t bytes;
};

/** Lists the regular files in @p folder and its folders, without following links. Returns the exit code and prints an
 * error unless it is 0. */
int places_add(struct places *places, const char *folder);
void places_finish(struct places *places);

/** Finds the folder in which @p actual has the relative path @p recorded; "" is the current one. NULL where there is
 * none, or without memory. The caller frees it. */
char *base_folder(const char *recorded, const char *actual);

/** Finds @p file. False, after an error message, without memory. @p out->path is the caller's to free(). */
bool file_find(struct found_file *out, const struct recorded_file *file, const struct places *places);

/** Finds the folders among all @p count @p files, sorted by path, that are missing: they are where a file of theirs
 * was found. */
void files_find_folders(struct found_file *found, const struct recorded_file *files, size_t count);

#endif
