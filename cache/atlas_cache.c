/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds atlases that were kept, and keeps them. */
#include "cache/atlas_cache.h"

#include "base/path.h"
#include "pack/atlas_pack.h"

#include <assert.h>
#include <stdalign.h>
#include <stddef.h>
#include <string.h>

/* An option that the key lacks would make two loads one. */
static_assert(sizeof(conus_load_options) <= offsetof(conus_load_options, cache) + alignof(conus_load_options),
              "atlas_cache_init() knows all options: cache is the last one");

static bool is_relative(const char *path)
{
    return path && !path_is_whole(path);
}

/* The head of a note; its strings follow. Sizes count a final NUL; a path of size 0 is NULL. */
struct heard_head {
    uint64_t severity, path_size, text_size;
};

static void hear_note(void *user, const conus_note *note)
{
    struct atlas_cache *cache = user;
    const struct heard_head head = {note->severity, note->path ? strlen(note->path) + 1 : 0, strlen(note->line) + 1};
    buffer_append(&cache->heard, &head, sizeof head);
    if (note->path) {
        buffer_append(&cache->heard, note->path, head.path_size);
    }
    buffer_append(&cache->heard, note->line, head.text_size);
    if (cache->given->log) {
        cache->given->log(cache->given->log_user, note);
    }
}

/* The note at the beginning of the bytes; its size, 0 where there is none. */
static size_t parse_note(conus_note *out, const uint8_t *data, size_t size)
{
    struct heard_head head;
    if (size < sizeof head) {
        return 0;
    }
    memcpy(&head, data, sizeof head);
    size -= sizeof head;
    const uint8_t *path = data + sizeof head;
    bool fits = head.severity <= CONUS_SEVERITY_WARNING && head.path_size <= size &&
                head.text_size <= size - head.path_size && head.text_size &&
                (!head.path_size || path[head.path_size - 1] == '\0') &&
                path[head.path_size + head.text_size - 1] == '\0';
    if (!fits) {
        return 0;
    }
    *out = (conus_note){(conus_severity)head.severity, head.path_size ? (const char *)path : NULL,
                        (const char *)path + head.path_size};
    return sizeof head + head.path_size + head.text_size;
}

bool atlas_cache_tell(const uint8_t *notes, size_t size, conus_log log, void *user)
{
    conus_note note;
    size_t used = 1;
    for (size_t at = 0; at < size && used; at += used) {
        used = parse_note(&note, notes + at, size - at);
        if (used && log) {
            log(user, &note);
        }
    }
    return used;
}

void atlas_cache_init(struct atlas_cache *out, const char *path, const char *kind, const conus_load_options *options)
{
    *out = (struct atlas_cache){.options = *options, .given = options};
    bool relative = is_relative(path) || is_relative(options->labels);
    if (options->cache && cache_store_begin(&out->store, ATLAS_CACHE_ENDING, path, relative)) {
        struct buffer *key = &out->store.key;
        cache_key_append(key, kind);
        cache_key_append(key, options->labels);
        buffer_append(key, &options->max_memory, sizeof options->max_memory);
        buffer_append(key, &options->probability, sizeof options->probability);
        buffer_append(key, options->labels_anyway ? "y" : "n", 1);
        buffer_append(key, options->without_context ? "y" : "n", 1);
        cache_store_name(&out->store);
    }
    out->options.cache = out->store.path.size;
}

void atlas_cache_finish(struct atlas_cache *cache)
{
    cache_store_finish(&cache->store);
    buffer_finish(&cache->heard);
    file_trace_finish(&cache->trace);
}

static bool is_used(const struct atlas_cache *cache)
{
    return cache->store.path.size;
}

void atlas_cache_begin_reading(struct atlas_cache *cache)
{
    if (is_used(cache)) {
        cache->options.log = hear_note;
        cache->options.log_user = cache;
        file_trace_begin(&cache->trace);
    }
}

void atlas_cache_end_reading(struct atlas_cache *cache)
{
    if (is_used(cache)) {
        file_trace_end(&cache->trace);
    }
}

/* Maps points that the entry left in the files of tractograms, which are as they were when it was made. */
static bool map_points(conus_atlas *atlas, const struct cache_part *bytes)
{
    struct file_trace trace = {0};
    bool fits = true;
    bool is_lean = false;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        is_lean = is_lean || atlas->tractograms[i].file_offset;
    }
    if (!is_lean) {
        return true;
    }
    fits = file_trace_parse(&trace, bytes->data, bytes->size);
    for (size_t i = 0; i < atlas->tractogram_count && fits; i++) {
        struct tractogram *tractogram = &atlas->tractograms[i];
        const struct traced *file = tractogram->file_offset ? file_trace_find(&trace, tractogram->path) : NULL;
        fits = !tractogram->file_offset || (file && tractogram_map_points(tractogram, &file->state));
    }
    file_trace_finish(&trace);
    return fits;
}

/* The atlas, mapped from its entry; `log`, unless NULL, hears its notes. NULL where no entry may be believed. */
static conus_atlas *find_entry(struct atlas_cache *cache, conus_log log, void *user)
{
    struct cache_mapping mapping = {0};
    conus_atlas *atlas = NULL;
    if (!cache_store_map(&mapping, &cache->store)) {
        return NULL;
    }
    const struct cache_part *notes = &mapping.entry.notes;
    const struct cache_part *packed = &mapping.entry.packed;
    if (!atlas_cache_tell(notes->data, notes->size, NULL, NULL) ||
        atlas_attach_verified(&atlas, packed->data, packed->size)) {
        cache_mapping_finish(&mapping);
        return NULL;
    }
    if (!map_points(atlas, &mapping.entry.trace)) {
        conus_atlas_destroy(atlas);
        cache_mapping_finish(&mapping);
        return NULL;
    }
    atlas->mapped = mapping.memory;
    atlas->mapped_size = mapping.size;
    atlas_cache_tell(notes->data, notes->size, log, user);
    return atlas;
}

conus_atlas *atlas_cache_find(struct atlas_cache *cache)
{
    return find_entry(cache, cache->given->log, cache->given->log_user);
}

/* A folder that stands for a manifest has no bytes of its own. */
static bool was_watched(const struct file_trace *trace, const char *path)
{
    return !path || !*path_base(path) || file_trace_find(trace, path);
}

/* Whether the trace has all files that the atlas says it was read from, so that no reader went past the trace.
 * Resampled volumes and surfaces around the areas have parts that packing leaves out. */
static bool can_be_kept(const conus_atlas *atlas, const struct file_trace *trace)
{
    bool may = file_trace_is_settled(trace) && trace->count && !atlas->context_surface_count;
    for (size_t i = 0; i < atlas->files.count && may; i++) {
        may = was_watched(trace, atlas->files.items[i].path);
    }
    for (size_t i = 0; i < atlas->volume_count && may; i++) {
        may = !atlas->volumes[i].source && was_watched(trace, atlas->volumes[i].path);
    }
    for (size_t i = 0; i < atlas->tractogram_count && may; i++) {
        may = was_watched(trace, atlas->tractograms[i].path);
    }
    for (size_t i = 0; i < atlas->mesh_count && may; i++) {
        may = was_watched(trace, atlas->meshes[i].path);
    }
    return may;
}

/* The entry to be written. */
struct writing {
    const conus_atlas *atlas;
    bool is_lean;
};

static bool write_atlas(void *user, int file, size_t at)
{
    const struct writing *writing = user;
    return atlas_pack_write(file, at, writing->atlas, writing->is_lean) == CONUS_OK;
}

enum { LARGE = 4 }; /* an entry that takes such a part of the cache leaves points in their files */

/* Such an entry of a .tck is less than half as large as the file, with points it would be larger than the file. */
bool atlas_cache_leaves_points(const char *path)
{
    struct file_state state;
    uint64_t limit;
    return cache_limit(&limit) && !file_state_find(&state, path) && state.size > limit / LARGE &&
           state.size / 2 < limit && state.size / (3 * sizeof(float)) < UINT32_MAX;
}

static void keep(struct atlas_cache *cache, conus_atlas **atlas)
{
    struct buffer trace = {0};
    if (!is_used(cache) || !can_be_kept(*atlas, &cache->trace)) {
        return;
    }
    bool is_lean = (*atlas)->tractogram_count && (*atlas)->tractograms[0].is_in_file;
    is_lean = is_lean || conus_atlas_packed_size(*atlas) > cache->store.limit / LARGE;
    struct writing writing = {*atlas, is_lean};
    file_trace_write(&trace, &cache->trace);
    struct cache_entry entry = {.notes = {(const uint8_t *)cache->heard.data, cache->heard.size},
                                .trace = {(const uint8_t *)trace.data, trace.size},
                                .packed = {NULL, atlas_pack_size(*atlas, is_lean)}};
    if (!buffer_status(&trace) && !cache->heard.failed &&
        cache_store_keep(&cache->store, &entry, write_atlas, &writing)) {
        /* maps what was just written: then the atlas is in memory once, and answers as it will the next time */
        cache->store.written = entry.trace;
        conus_atlas *mapped = find_entry(cache, NULL, NULL); /* the notes were heard while the files were read */
        cache->store.written = (struct cache_part){0};
        if (mapped) {
            conus_atlas_destroy(*atlas);
            *atlas = mapped;
        }
    }
    buffer_finish(&trace);
}

conus_status atlas_cache_keep(struct atlas_cache *cache, conus_atlas **atlas)
{
    conus_status status = CONUS_OK;
    keep(cache, atlas);
    for (size_t i = 0; i < (*atlas)->tractogram_count && !(*atlas)->mapped && !status; i++) {
        struct tractogram *tractogram = &(*atlas)->tractograms[i];
        if (tractogram->is_in_file) {
            const struct traced *file = file_trace_find(&cache->trace, tractogram->path);
            status = file ? tractogram_hold_points(tractogram, &file->state) : CONUS_ERROR_MEMORY;
        }
    }
    return status;
}
