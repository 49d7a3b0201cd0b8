/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Additions to an atlas: contexts, pathways, tractograms, a list of points and further atlases, as options of
 * the command line, words such as "--streamlines=FILE,radius=1". */
#ifndef CONUS_VIEWER_MODEL_ADDITIONS_H
#define CONUS_VIEWER_MODEL_ADDITIONS_H

#include "conus/atlas.h"

#include "base/system/system.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

enum addition { ADD_CONTEXT = 0, ADD_PATHWAY, ADD_STREAMLINES, ADD_POSE, ADD_ATLAS, ADDITION_COUNT };
/** Their options, without dashes: "context". */
extern const char *const addition_names[ADDITION_COUNT];

/** The value of a word such as "--space=lps"; NULL for a word of another option than @p name, or for NULL. */
const char *word_value(const char *word, const char *name);
/** Returns @p made where all is fine; else it ends, and NULL is returned. */
json_t *words_or_none(json_t *made, bool fine);
/** The place of a word among others, from 1; 0 = it is not there. */
size_t words_place(const json_t *words, const json_t *word);

/** Which kind @p word is, ADDITION_COUNT = none; *value is the text behind its '=', or "". */
enum addition addition_of(const char **value, const char *word);
/** The file in a value, without the keys behind it, as the command line finds it; false where it is too long. */
bool addition_path(char path[SYSTEM_PATH], enum addition kind, const char *value);

/** @p words with one more; a volume takes the place of another one as context, a list that of another list. NULL: no
 * memory, or no UTF-8. */
json_t *additions_with(const json_t *words, enum addition kind, const char *value);
/** @p words without that of @p index, and without --context-opacity where no surface is left. NULL without memory. */
json_t *additions_without(const json_t *words, size_t index);
/** Index in @p words of the newest one whose file is @p path, or has that name; the number of words = none. */
size_t additions_index(const json_t *words, const char *path);

/** Those of @p words that name further atlases, in their order. NULL without memory. */
json_t *additions_atlases(const json_t *words);

/** The additions as a session keeps them, but for further atlases: an array, in the order of @p words, of {"option":
 * the word, "path": its file, "sha256" and "bytes" of that where they are known, "objects": numbers in @p atlas}. NULL
 * without memory. */
json_t *additions_describe(const conus_atlas *atlas, const json_t *words);
/** The opened files, as "opened" of a session has them: {"folder": where conus was started, "options": words of the
 * command line, "added": what they add (additions_describe()), "sha256" and "bytes" of the atlas's file}. NULL without
 * memory, or where a text is not UTF-8. @p options is taken over. The checksum is left out where the atlas has no
 * volume that is the file @p path. */
json_t *opened_describe(const conus_atlas *atlas, const char *path, json_t *options);

enum { ADDITIONS_MISSING = 256 };

/** Finds the files of @p described again, where they were, or beside the session @p session by name or checksum, or
 * beside its @p atlas (NULL = not known): the session's @p words, where they are now, without those that are nowhere,
 * whose entries are appended to @p lost. NULL without memory. */
json_t *additions_find(json_t *lost, const json_t *words, const json_t *described, const char *session,
                       const char *atlas);
/** The names of the files of such entries, plain. */
void additions_names(char out[ADDITIONS_MISSING], const json_t *entries);
/** Whether @p entry adds a context that is a volume, of which an atlas has one. */
bool addition_is_volume_context(const json_t *entry);
/** Which entry of @p now each of @p then is, by its word, or its file's checksum or name: @p match is [entries of @p
 * then], SIZE_MAX = none. No two are the same one. Both as additions_describe() has them, or NULL. False without
 * memory. */
bool additions_match(size_t *match, const json_t *then, const json_t *now);
/** Whether a file of @p now is another than that of the same name in @p then, by its checksum; @p name says which. */
bool additions_differ(char name[ADDITIONS_MISSING], const json_t *then, const json_t *now);

#endif
