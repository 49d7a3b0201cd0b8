/* SPDX-License-Identifier: BSD-3-Clause */
/* Words of the command line that add a file to an atlas: made, taken apart, described and found again. */
#include "viewer/model/additions.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/output.h"
#include "sources/names.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const addition_names[ADDITION_COUNT] = {"context", "pathway", "streamlines", "pose", "atlas"};

const char *word_value(const char *word, const char *name)
{
    size_t length = strlen(name);
    bool is = word && strncmp(word, "--", 2) == 0 && strncmp(word + 2, name, length) == 0 && word[2 + length] == '=';
    return is ? word + 3 + length : NULL;
}

json_t *words_or_none(json_t *made, bool fine)
{
    if (!fine) {
        json_decref(made);
    }
    return fine ? made : NULL;
}

size_t words_place(const json_t *words, const json_t *word)
{
    size_t place = 0;
    for (size_t i = json_array_size(words); i-- > 0;) {
        place = json_equal(json_array_get(words, i), word) ? i + 1 : place;
    }
    return place;
}

enum addition addition_of(const char **value, const char *word)
{
    int kind = 0;
    while (kind < ADDITION_COUNT && !(*value = word_value(word, addition_names[kind]))) {
        kind++;
    }
    *value = *value ? *value : "";
    return (enum addition)kind;
}

/* The kinds of keys, in the order of enum addition. */
static const enum key_kind addition_keys[ADDITION_COUNT] = {KEYS_VOLUME, KEYS_PATHWAY, KEYS_STREAMLINES, KEYS_POSES,
                                                            KEYS_ATLAS};

bool addition_path(char path[SYSTEM_PATH], enum addition kind, const char *value)
{
    const size_t length = keys_file_length(value, addition_keys[kind]);
    return snprintf(path, SYSTEM_PATH, "%.*s", (int)length, value) < SYSTEM_PATH;
}

/* Where ",key" or ",key=TEXT" stands behind the file, and its length; the end where it does not, and 0. */
static const char *find_key(size_t *size, enum addition kind, const char *value, const char *key)
{
    const size_t length = strlen(key);
    const char *at = value + keys_file_length(value, addition_keys[kind]);
    while (*at == ',' && (strncmp(at + 1, key, length) != 0 || !strchr(",=", at[1 + length]))) {
        at += 1 + strcspn(at + 1, ",");
    }
    *size = *at ? 1 + strcspn(at + 1, ",") : 0;
    return at;
}

bool addition_key(char *out, size_t size, enum addition kind, const char *value, const char *key)
{
    size_t length;
    const char *at = find_key(&length, kind, value, key);
    const size_t head = strlen(key) + 2;
    snprintf(out, size, "%.*s", length > head ? (int)(length - head) : 0, at + (length > head ? head : 0));
    return length;
}

void addition_put_key(char *value, size_t bytes, enum addition kind, const char *key, const char *text)
{
    size_t size;
    const char *at = find_key(&size, kind, value, key);
    char *made = NULL;
    const int length = asprintf(&made, "%.*s%s%s%s%s%s", (int)(at - value), value, text ? "," : "", text ? key : "",
                                text && *text ? "=" : "", text ? text : "", at + size);
    if (length >= 0 && (size_t)length < bytes) {
        memcpy(value, made, (size_t)length + 1);
    }
    free(length >= 0 ? made : NULL);
}

static const char *word_at(const json_t *words, size_t index)
{
    const char *word = json_string_value(json_array_get(words, index));
    return word ? word : "";
}

/* The kind and file of a word; false where it is none. */
static bool read_word(enum addition *kind, char path[SYSTEM_PATH], const char *word)
{
    const char *value = NULL;
    *kind = addition_of(&value, word);
    return *kind < ADDITION_COUNT && addition_path(path, *kind, value);
}

static bool is_context_surface(const char *word, bool surface)
{
    enum addition kind;
    char path[SYSTEM_PATH];
    return read_word(&kind, path, word) && kind == ADD_CONTEXT && conus_context_is_surface(path) == surface;
}

/* Whether an atlas has one such addition at most. */
static bool is_one_only(enum addition kind, const char *word)
{
    return kind == ADD_POSE || is_context_surface(word, false);
}

json_t *additions_with(const json_t *words, enum addition kind, const char *value)
{
    json_t *with = json_array();
    json_t *added = json_sprintf("--%s=%s", addition_names[kind], value);
    bool replaces = added && is_one_only(kind, json_string_value(added));
    bool fine = with && added;
    for (size_t i = 0; i < json_array_size(words) && fine; i++) {
        const char *other;
        bool is_replaced =
            replaces && addition_of(&other, word_at(words, i)) == kind && is_one_only(kind, word_at(words, i));
        fine = is_replaced || !json_array_append(with, json_array_get(words, i));
    }
    fine = fine && !json_array_append(with, added);
    json_decref(added);
    return words_or_none(with, fine);
}

json_t *additions_without(const json_t *words, size_t index)
{
    json_t *without = json_copy((json_t *)words);
    bool has_surface = false;
    json_array_remove(without, index);
    for (size_t i = 0; i < json_array_size(without); i++) {
        has_surface = has_surface || is_context_surface(word_at(without, i), true);
    }
    for (size_t i = has_surface ? 0 : json_array_size(without); i-- > 0;) {
        if (word_value(word_at(without, i), "context-opacity")) {
            json_array_remove(without, i);
        }
    }
    return without;
}

json_t *additions_atlases(const json_t *words)
{
    json_t *atlases = json_array();
    bool fine = atlases;
    for (size_t i = 0; i < json_array_size(words) && fine; i++) {
        const char *value;
        fine = addition_of(&value, word_at(words, i)) != ADD_ATLAS ||
               !json_array_append(atlases, json_array_get(words, i));
    }
    return words_or_none(atlases, fine);
}

/* Whether both lead to the same file, or folder. */
static bool is_same_place(const char *a, const char *b)
{
    struct system_stat one;
    struct system_stat other;
    return strcmp(a, b) == 0 ||
           (system_stat(&one, a) && system_stat(&other, b) && one.device == other.device && one.inode == other.inode);
}

size_t additions_index(const json_t *words, const char *path)
{
    size_t count = json_array_size(words);
    size_t named = count;
    for (size_t i = count; i-- > 0;) {
        enum addition kind;
        char file[SYSTEM_PATH];
        bool is = read_word(&kind, file, word_at(words, i));
        if (is && is_same_place(file, path)) {
            return i;
        }
        named = is && named == count && strcmp(path_name(file), path) == 0 ? i : named;
    }
    return named;
}

/* Appends the @p count object numbers from `first` on. */
static void put_numbers(json_t *entry, size_t first, size_t count)
{
    json_t *numbers = json_object_get(entry, "objects");
    for (size_t i = 0; i < count; i++) {
        json_array_append_new(numbers, json_integer((json_int_t)first + (json_int_t)i));
    }
}

static void put_sum(json_t *entry, const char *sha256, const char *path)
{
    struct system_stat info;
    if (sha256[0] && system_stat(&info, path)) {
        json_object_set_new(entry, "sha256", json_string(sha256));
        json_object_set_new(entry, "bytes", json_integer((json_int_t)info.size));
    }
}

/* Tractograms and volumes that an entry has, so that a file that was added twice is not found twice. */
struct taken {
    bool *tractograms, *volumes;
};

static void describe_streamlines(json_t *entry, struct taken *taken, const conus_atlas *atlas, const char *path)
{
    for (size_t i = 0; i < conus_atlas_tractogram_count(atlas); i++) {
        conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
        if (!taken->tractograms[i] && !conus_atlas_tractogram(&info, atlas, i) && is_same_place(info.path, path)) {
            taken->tractograms[i] = true;
            put_sum(entry, info.sha256, path);
            put_numbers(entry, info.bundle, info.bundles);
            return;
        }
    }
}

/* In a 4-D file it is the volume that ",volume=K" names, or the first. */
static void describe_volume(json_t *entry, struct taken *taken, const conus_atlas *atlas, conus_role role,
                            const char *value, const char *path)
{
    struct source_keys keys;
    (void)keys_read(&keys, value, role == CONUS_ROLE_CONTEXT ? KEYS_VOLUME : KEYS_PATHWAY);
    const uint64_t index = (uint64_t)keys_value(&keys, KEY_VOLUME)->numbers[0];
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        if (taken->volumes[i] || info->role != role || info->volume != index || !is_same_place(info->path, path)) {
            continue;
        }
        taken->volumes[i] = true;
        put_sum(entry, info->sha256, path);
        size_t objects = role == CONUS_ROLE_SCALAR ? conus_atlas_object_count(atlas) : 0;
        for (size_t number = 1; number <= objects; number++) { /* bands of a volume follow each other */
            const conus_object *object = conus_atlas_object(atlas, number);
            if (object->kind == CONUS_KIND_PATHWAY && object->volume == i) {
                put_numbers(entry, number, 1);
            }
        }
        return;
    }
}

static json_t *describe(struct taken *taken, const conus_atlas *atlas, const char *word)
{
    const char *value = NULL;
    char path[SYSTEM_PATH];
    enum addition kind = addition_of(&value, word);
    json_t *entry = addition_path(path, kind, value)
                        ? json_pack("{s: s, s: s, s: []}", "option", word, "path", path, "objects")
                        : NULL;
    if (entry && kind == ADD_STREAMLINES) {
        describe_streamlines(entry, taken, atlas, path);
    } else if (entry && kind != ADD_POSE) {
        conus_role role = kind == ADD_CONTEXT ? CONUS_ROLE_CONTEXT : CONUS_ROLE_SCALAR;
        describe_volume(entry, taken, atlas, role, value, path);
    }
    return entry;
}

json_t *additions_describe(const conus_atlas *atlas, const json_t *words)
{
    json_t *list = json_array();
    struct taken taken = {calloc(conus_atlas_tractogram_count(atlas) + 1, sizeof *taken.tractograms),
                          calloc(conus_atlas_volume_count(atlas) + 1, sizeof *taken.volumes)};
    bool fine = list && taken.tractograms && taken.volumes;
    for (size_t i = 0; i < json_array_size(words) && fine; i++) {
        const char *value;
        if (addition_of(&value, word_at(words, i)) < ADD_ATLAS) {
            fine = !json_array_append_new(list, describe(&taken, atlas, word_at(words, i)));
        }
    }
    free(taken.tractograms);
    free(taken.volumes);
    return words_or_none(list, fine);
}

json_t *opened_describe(const conus_atlas *atlas, const char *path, json_t *options)
{
    char folder[SYSTEM_PATH];
    struct system_stat info;
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    json_t *opened = json_pack("{s: s, s: o, s: o}", "folder", system_here(folder) ? folder : "", "added",
                               additions_describe(atlas, options), "options", options);
    if (opened && volume && paths_equal(volume->path, path) && system_stat(&info, path)) {
        json_object_set_new(opened, "sha256", json_string(volume->sha256));
        json_object_set_new(opened, "bytes", json_integer((json_int_t)info.size));
    }
    return opened;
}

bool addition_is_volume_context(const json_t *entry)
{
    return is_context_surface(json_text(entry, "option"), false);
}

void additions_names(char out[ADDITIONS_MISSING], const json_t *entries)
{
    out[0] = '\0';
    for (size_t i = 0; i < json_array_size(entries); i++) {
        enum addition kind;
        char path[SYSTEM_PATH] = "";
        size_t used = strlen(out);
        (void)read_word(&kind, path, json_text(json_array_get(entries, i), "option"));
        snprintf(out + used, ADDITIONS_MISSING - used, "%s%s", used ? ", " : "", path_name(path));
        conus_plain_text(out);
    }
}

json_t *additions_find(json_t *lost, const json_t *words, const json_t *described, const char *session,
                       const char *atlas)
{
    json_t *found = json_array();
    bool fine = found && lost;
    for (size_t i = 0; i < json_array_size(words) && fine; i++) {
        enum addition kind;
        char path[SYSTEM_PATH] = "";
        const char *word = word_at(words, i);
        json_t *entry = NULL;
        for (size_t k = 0; k < json_array_size(described) && !entry; k++) {
            json_t *one = json_array_get(described, k);
            entry = strcmp(json_text(one, "option"), word) == 0 ? one : NULL;
        }
        if (!entry || !read_word(&kind, path, word)) {
            fine = !json_array_append(found, json_array_get(words, i));
            continue;
        }
        const char *value = NULL;
        char where[SYSTEM_PATH];
        const struct session_file file = {.atlas = path,
                                          .folder = "",
                                          .sha256 = json_text(entry, "sha256"),
                                          .bytes = (uint64_t)json_integer_value(json_object_get(entry, "bytes"))};
        (void)addition_of(&value, word);
        if (session_file_find(where, &file, session, NULL, 0) ||
            (atlas && session_file_find_near(where, &file, atlas))) {
            char *now = NULL; /* not always UTF-8, as the session is: its folder may have any name */
            int size = asprintf(&now, "--%s=%s%s", addition_names[kind], where, value + strlen(path));
            fine = size >= 0 && !json_array_append_new(found, json_string_nocheck(now));
            free(size >= 0 ? now : NULL);
        } else {
            fine = !json_array_append(lost, entry);
        }
    }
    return words_or_none(found, fine);
}

/* The keys behind the file's name. */
static const char *keys_of(const json_t *entry, enum addition *kind)
{
    const char *value = "";
    *kind = addition_of(&value, json_text(entry, "option"));
    size_t length = strlen(json_text(entry, "path"));
    return strlen(value) >= length ? value + length : "";
}

/* How closely both entries agree: 3 in the word, 2 in the file and its keys, 1 in the file, 0 = not at all. */
static int likeness(const json_t *then, const json_t *now)
{
    enum addition kinds[2];
    const char *keys[2] = {keys_of(then, &kinds[0]), keys_of(now, &kinds[1])};
    const char *sum = json_text(then, "sha256");
    bool same_file = (sum[0] && strcmp(sum, json_text(now, "sha256")) == 0) ||
                     strcmp(path_name(json_text(then, "path")), path_name(json_text(now, "path"))) == 0;
    if (strcmp(json_text(then, "option"), json_text(now, "option")) == 0) {
        return 3;
    }
    return kinds[0] != kinds[1] || !same_file ? 0 : strcmp(keys[0], keys[1]) == 0 ? 2 : 1;
}

bool addition_is_same(const json_t *then, const json_t *now)
{
    const char *sum = json_text(then, "sha256");
    return likeness(then, now) > 1 && sum[0] && strcmp(sum, json_text(now, "sha256")) == 0;
}

/* Pairs the entries that agree at this level. */
static void match_level(size_t *match, bool *taken, const json_t *then, const json_t *now, int level)
{
    for (size_t i = 0; i < json_array_size(then); i++) {
        for (size_t k = 0; k < json_array_size(now) && match[i] == SIZE_MAX; k++) {
            if (!taken[k] && likeness(json_array_get(then, i), json_array_get(now, k)) == level) {
                match[i] = k;
                taken[k] = true;
            }
        }
    }
}

size_t *additions_match(const json_t *then, const json_t *now)
{
    bool *taken = calloc(json_array_size(now) + 1, sizeof *taken);
    size_t *match = taken ? calloc(json_array_size(then) + 1, sizeof *match) : NULL;
    for (size_t i = 0; i < json_array_size(then) && match; i++) {
        match[i] = SIZE_MAX;
    }
    for (int level = 3; level > 0 && match; level--) {
        match_level(match, taken, then, now, level);
    }
    free(taken);
    return match;
}

bool additions_differ(char name[ADDITIONS_MISSING], const json_t *then, const json_t *now)
{
    size_t *match = additions_match(then, now);
    bool differ = false;
    for (size_t i = 0; match && i < json_array_size(then) && !differ; i++) {
        const json_t *entry = match[i] == SIZE_MAX ? NULL : json_array_get(now, match[i]);
        const char *sum = json_text(json_array_get(then, i), "sha256");
        differ = entry && sum[0] && strcmp(sum, json_text(entry, "sha256")) != 0;
        if (differ) {
            snprintf(name, ADDITIONS_MISSING, "%s", path_name(json_text(entry, "path")));
            conus_plain_text(name);
        }
    }
    free(match);
    return differ;
}
