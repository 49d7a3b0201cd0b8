/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The files of an atlas in the window: what was added to it, where a session finds them, and whether they
 * change. */
#ifndef CONUS_VIEWER_MODEL_ADDITIONS_H
#define CONUS_VIEWER_MODEL_ADDITIONS_H

#include "base/system/system.h"
#include "conus/atlas.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* Additions to an atlas: contexts, pathways, tractograms, a list of points and further atlases, as options of the
 * command line, words such as "--streamlines=FILE,radius=1". */

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

/** Whether @p key stands behind the file of @p value, as ",key" or ",key=TEXT"; the text is in @p out, "" of a flag. */
bool addition_key(char *out, size_t size, enum addition kind, const char *value, const char *key);
/** Puts it there, a flag where @p text is ""; NULL = takes it out. Of no effect where @p value, of so many bytes, has
 * no room for it. */
void addition_put_key(char *value, size_t bytes, enum addition kind, const char *key, const char *text);

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
/** Whether both entries are of the same bytes, with the same keys. */
bool addition_is_same(const json_t *then, const json_t *now);
/** Which entry of @p now each of @p then is, by its word, or its file's checksum or name; SIZE_MAX = none. No two are
 * the same one. Both as additions_describe() has them, or NULL. To be freed; NULL without memory. */
size_t *additions_match(const json_t *then, const json_t *now);
/** Whether a file of @p now is another than that of the same name in @p then, by its checksum; @p name says which. */
bool additions_differ(char name[ADDITIONS_MISSING], const json_t *then, const json_t *now);

/* Reads from a session's file which atlas it belongs to, and finds that atlas again. */

/** A session as it was read. */
struct session_file {
    json_t *root;
    const char *atlas;     /**< As it was given; borrowed from root, as what follows. */
    const char *folder;    /**< "" = unknown. */
    const char *sha256;    /**< "" = unknown. */
    uint64_t bytes;        /**< With sha256. */
    const json_t *options; /**< An array of texts; NULL = unknown. */
};

/** Whether @p path is a session's file; then end @p out with session_file_finish(). A damaged file does not count. */
bool session_file_read(struct session_file *out, const char *path);
void session_file_finish(struct session_file *file);

/** Finds the atlas: where it was, beside the session, and, if its checksum is known, any file beside the session and
 * among @p others that has it. False: it is nowhere there. */
bool session_file_find(char out[SYSTEM_PATH], const struct session_file *file, const char *session,
                       const char *const *others, size_t count);
/** Finds what was beside the atlas @p atlas, a path: the same file, by its checksum, or by name where none is known. */
bool session_file_find_near(char out[SYSTEM_PATH], const struct session_file *file, const char *atlas);

/** The text of @p key in a JSON object; "" = none. */
const char *json_text(const json_t *object, const char *key);

/* Watches the files of an atlas that is shown, which stays as it was read when one changes on disk. */

enum { FILE_WATCH_TEXT = 160 };

struct file_watch;

/** Notes how the files are now; NULL without memory. The atlas outlives it. */
struct file_watch *file_watch_create(const conus_atlas *atlas);
void file_watch_destroy(struct file_watch *watch);

/** Looks again. True: one changed, went away or came back since the last look, as @p text says in a line. */
bool file_watch_check(struct file_watch *watch, char text[FILE_WATCH_TEXT]);
/** The name of a file that has changed since the watch began, and that @p now was read from, too; NULL = none has. */
const char *file_watch_find_other(const struct file_watch *watch, const conus_atlas *now);

#endif
