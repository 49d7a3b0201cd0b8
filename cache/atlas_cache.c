/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds atlases that were kept, and keeps them. */
#include "cache/atlas_cache.h"

#include "base/cache_folder.h"
#include "base/memory.h"
#include "cache/build_id.h"
#include "cache/cache_entry.h"
#include "selection/batch/atlas_pack.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdalign.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* An option that the key lacks would make two loads one. */
static_assert(sizeof(conus_load_options) <= offsetof(conus_load_options, cache) + alignof(conus_load_options),
              "append_key() knows all options: cache is the last one");

#if defined __x86_64__
#define CPU "x86-64"
#elif defined __aarch64__
#define CPU "arm64"
#else
#define CPU "other"
#endif

/* ---- Where an entry is ------------------------------------------------------------------------------------------- */

bool atlas_cache_limit(uint64_t *out)
{
    static const char units[] = "KMGT";
    const char *text = getenv("CONUS_CACHE");
    char *end = NULL;
    *out = ATLAS_CACHE_LIMIT;
    if (!text || !*text) {
        return true;
    }
    errno = 0;
    uint64_t size = strtoull(text, &end, 10);
    const char *unit = *end ? strchr(units, *end) : NULL;
    unsigned shift = unit ? 10 * (unsigned)(unit - units + 1) : 0;
    bool is_size =
        text[0] >= '0' && text[0] <= '9' && !errno && (!*end || (unit && !end[1])) && size <= UINT64_MAX >> shift;
    *out = is_size ? size << shift : 0;
    return is_size || strcmp(text, "off") == 0;
}

/* A string and its end, with a mark that tells none from an empty one. */
static void append_text(struct buffer *key, const char *text)
{
    buffer_append(key, text ? "=" : "-", 1);
    buffer_append(key, text ? text : "", strlen(text ? text : "") + 1);
}

static void append_key(struct buffer *key, const char *path, const char *build, const conus_load_options *options)
{
    char here[PATH_MAX] = "";
    bool relative = path[0] != '/' || (options->labels && options->labels[0] != '/');
    append_text(key, "conus " CONUS_VERSION);
    append_text(key, build);
    append_text(key, BYTE_ORDER == LITTLE_ENDIAN ? CPU " little" : CPU " big");
    append_text(key, relative && getcwd(here, sizeof here) ? here : NULL);
    append_text(key, path);
    append_text(key, options->labels);
    buffer_append(key, &options->max_memory, sizeof options->max_memory);
    buffer_append(key, &options->probability, sizeof options->probability);
    buffer_append(key, options->labels_anyway ? "y" : "n", 1);
}

const char *atlas_cache_path_of(const uint8_t *key, size_t size)
{
    enum { PATH = 4 };
    const uint8_t *at = key;
    for (int i = 0; i <= PATH; i++) {
        const uint8_t *end = memchr(at, 0, size);
        if (!end || end == at) {
            return NULL;
        }
        if (i < PATH) {
            size -= (size_t)(end + 1 - at);
            at = end + 1;
        }
    }
    return (const char *)at + 1;
}

static void name_entry(struct atlas_cache *cache)
{
    char name[65];
    const struct bytes bytes = {(uint8_t *)cache->key.data, cache->key.size};
    if (buffer_status(&cache->key) || cache_folder_path(&cache->path) || !cache->path.size) {
        buffer_clear(&cache->path);
        return;
    }
    file_sha256(name, &bytes);
    buffer_format(&cache->path, "/%s" ATLAS_CACHE_ENDING, name);
    if (buffer_status(&cache->path)) {
        buffer_clear(&cache->path);
    }
}

/* ---- Notes ------------------------------------------------------------------------------------------------------- */

/* Ahead of the strings of a note. Sizes count a final NUL; a path of 0 is none. */
struct heard_head {
    uint64_t severity, path_size, text_size;
};

static void hear(void *user, const conus_note *note)
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

/* ---- Beginning and ending ---------------------------------------------------------------------------------------- */

void atlas_cache_init(struct atlas_cache *out, const char *path, const conus_load_options *options)
{
    char build[BUILD_ID_SIZE];
    *out = (struct atlas_cache){.options = *options, .given = options, .small = CACHE_SMALL};
    bool wanted = options->cache && atlas_cache_limit(&out->limit);
    if (wanted && out->limit && build_id_find(build)) {
        append_key(&out->key, path, build, options);
        name_entry(out);
    }
}

void atlas_cache_finish(struct atlas_cache *cache)
{
    buffer_finish(&cache->key);
    buffer_finish(&cache->path);
    buffer_finish(&cache->heard);
    file_trace_finish(&cache->trace);
}

static bool is_used(const struct atlas_cache *cache)
{
    return cache->path.size;
}

void atlas_cache_watch(struct atlas_cache *cache)
{
    if (is_used(cache)) {
        cache->options.log = hear;
        cache->options.log_user = cache;
        file_trace_begin(&cache->trace);
    }
}

void atlas_cache_watched(struct atlas_cache *cache)
{
    if (is_used(cache)) {
        file_trace_end(&cache->trace);
    }
}

/* ---- Finding ----------------------------------------------------------------------------------------------------- */

/* The name of the entry in its folder. */
static const char *name_in_folder(const struct atlas_cache *cache)
{
    return strrchr(cache->path.data, '/') + 1;
}

/* The folder, -1 where it is not there, or not ours alone. */
static int open_folder(const struct atlas_cache *cache)
{
    bool theirs;
    char *end = strrchr(cache->path.data, '/');
    *end = '\0';
    int folder = cache_folder_open(cache->path.data, &theirs);
    *end = '/';
    return folder;
}

struct mapping {
    void *memory; /* NULL = none */
    size_t size;
};

static struct mapping map_entry(int descriptor)
{
    struct stat info;
    struct mapping mapping = {0};
    if (cache_is_ours(descriptor, S_IFREG) && fstat(descriptor, &info) == 0 && info.st_size > 0) {
        mapping.size = (size_t)info.st_size;
        mapping.memory = mmap(NULL, mapping.size, PROT_READ, MAP_SHARED, descriptor, 0);
        mapping.memory = mapping.memory == MAP_FAILED ? NULL : mapping.memory;
    }
    return mapping;
}

/* Whether every file and folder is as it was. */
static bool sources_hold(const struct cache_entry *entry)
{
    struct file_trace trace = {0};
    bool same = file_trace_parse(&trace, entry->trace.data, entry->trace.size) && file_trace_holds(&trace);
    file_trace_finish(&trace);
    return same;
}

/* Writes into the open entry that this run of the kernel has verified it. */
static void mark_verified(int descriptor, const uint8_t boot[CACHE_BOOT_SIZE])
{
    char path[32];
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    int file = open(path, O_WRONLY | O_CLOEXEC);
    if (file >= 0) {
        ssize_t written = pwrite(file, boot, CACHE_BOOT_SIZE, (off_t)cache_entry_boot_at());
        (void)written; /* else it is verified again */
        close(file);
    }
}

/* Small entries are verified each time, large ones once in each run of the kernel. */
static bool verify(const struct cache_entry *entry, uint64_t small, int descriptor)
{
    uint8_t boot[CACHE_BOOT_SIZE];
    bool known = cache_boot_find(boot);
    bool verified = known && memcmp(boot, entry->boot, sizeof boot) == 0;
    if (verified && entry->packed.size > small) {
        return true;
    }
    if (!cache_entry_is_whole(entry)) {
        return false;
    }
    if (known && !verified) {
        mark_verified(descriptor, boot);
    }
    return true;
}

/* From the cheapest question to the dearest. */
static bool may_be_believed(const struct cache_entry *entry, const struct atlas_cache *cache, int descriptor)
{
    return entry->key.size == cache->key.size && memcmp(entry->key.data, cache->key.data, entry->key.size) == 0 &&
           atlas_cache_tell(entry->notes.data, entry->notes.size, NULL, NULL) && sources_hold(entry) &&
           verify(entry, cache->small, descriptor);
}

/* The atlas of the open entry; the mapping is the atlas's, or gone. */
static conus_atlas *attach(const struct atlas_cache *cache, int descriptor)
{
    struct cache_entry entry;
    conus_atlas *atlas = NULL;
    struct mapping mapping = map_entry(descriptor);
    bool believed = mapping.memory && cache_entry_parse(&entry, mapping.memory, mapping.size) &&
                    may_be_believed(&entry, cache, descriptor);
    if (believed && !conus_atlas_attach(&atlas, entry.packed.data, entry.packed.size)) {
        atlas->mapped = mapping.memory;
        atlas->mapped_size = mapping.size;
        atlas_cache_tell(entry.notes.data, entry.notes.size, cache->given->log, cache->given->log_user);
        return atlas;
    }
    if (mapping.memory) {
        munmap(mapping.memory, mapping.size);
    }
    return NULL;
}

static conus_atlas *find_entry(const struct atlas_cache *cache)
{
    conus_atlas *atlas = NULL;
    int folder = open_folder(cache);
    int entry = folder < 0 ? -1 : openat(folder, name_in_folder(cache), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (entry >= 0) {
        atlas = attach(cache, entry);
        if (atlas) {
            futimens(entry, NULL); /* used just now */
        }
        close(entry);
    }
    if (folder >= 0) {
        close(folder);
    }
    return atlas;
}

conus_atlas *atlas_cache_find(struct atlas_cache *cache)
{
    return is_used(cache) ? find_entry(cache) : NULL;
}

/* ---- Keeping ----------------------------------------------------------------------------------------------------- */

/* A folder that stands for a manifest has no bytes of its own. */
static bool was_watched(const struct file_trace *trace, const char *path)
{
    return !path || !*path || path[strlen(path) - 1] == '/' || file_trace_find(trace, path);
}

/* Whether the trace has all files that the atlas says it was read from: a reader that asks behind the trace's back is
 * found out. Volumes that were resampled, and surfaces around the areas, have something that packing leaves out. */
static bool may_be_kept(const conus_atlas *atlas, const struct file_trace *trace)
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

/* A limit on the sizes of files (ulimit -f) ends programs that exceed it. */
static bool is_allowed(uint64_t size)
{
    struct rlimit limit;
    return getrlimit(RLIMIT_FSIZE, &limit) == 0 && (limit.rlim_cur == RLIM_INFINITY || size <= limit.rlim_cur);
}

/* Whether the disk has so much, and as much again for others. */
static bool has_space(int folder, uint64_t size)
{
    struct statvfs info;
    return fstatvfs(folder, &info) == 0 && info.f_frsize && size / info.f_frsize < info.f_bavail / 2;
}

/* The checksum of what was written, as it is read back. */
static bool sum_file(uint32_t *out, int file, size_t at, size_t size)
{
    enum { CHUNK = 1 << 20 };
    uint8_t *chunk = memory_raw(CHUNK, 1);
    uint32_t sum = 0;
    while (chunk && size) {
        ssize_t n = pread(file, chunk, size < CHUNK ? size : CHUNK, (off_t)at);
        if (n <= 0) {
            break;
        }
        sum = cache_crc(sum, chunk, (size_t)n);
        at += (size_t)n;
        size -= (size_t)n;
    }
    bool whole = chunk && size == 0;
    memory_free(chunk);
    *out = sum;
    return whole;
}

static bool write_ahead(int file, const struct cache_entry *entry)
{
    struct buffer ahead = {0};
    cache_entry_write(&ahead, entry);
    bool written = !buffer_status(&ahead) && pwrite(file, ahead.data, ahead.size, 0) == (ssize_t)ahead.size;
    buffer_finish(&ahead);
    return written;
}

/* A large one is on the disk before it has a name: an error of the disk shows here, and a crash leaves no half of it.
 * Of a small one the checksum is verified each time. */
static bool write_entry(int file, struct cache_entry *entry, uint64_t small, const conus_atlas *atlas)
{
    size_t at = cache_entry_packed_at(entry);
    size_t size = at + entry->packed.size;
    return posix_fallocate(file, 0, (off_t)size) == 0 && atlas_pack_write(file, at, atlas) == CONUS_OK &&
           sum_file(&entry->packed_crc, file, at, entry->packed.size) && write_ahead(file, entry) &&
           (entry->packed.size <= small || fdatasync(file) == 0);
}

/* The atlas as an entry, whose parts are borrowed. */
static struct cache_entry describe(const struct atlas_cache *cache, const struct buffer *trace,
                                   const conus_atlas *atlas)
{
    struct cache_entry entry = {.key = {(const uint8_t *)cache->key.data, cache->key.size},
                                .notes = {(const uint8_t *)cache->heard.data, cache->heard.size},
                                .trace = {(const uint8_t *)trace->data, trace->size},
                                .packed = {NULL, conus_atlas_packed_size(atlas)}};
    cache_boot_find(entry.boot);
    return entry;
}

/* Under a name of its own at first; an entry like others, should it be left behind. */
static bool write_and_rename(struct atlas_cache *cache, int folder, struct cache_entry *entry, const conus_atlas *atlas)
{
    struct buffer temporary = {0};
    buffer_format(&temporary, "%s.XXXXXX" ATLAS_CACHE_ENDING, cache->path.data);
    int file = buffer_status(&temporary) ? -1 : mkostemps(temporary.data, (int)strlen(ATLAS_CACHE_ENDING), O_CLOEXEC);
    bool written = file >= 0 && write_entry(file, entry, cache->small, atlas);
    if (file >= 0) {
        const char *name = strrchr(temporary.data, '/') + 1;
        written = close(file) == 0 && written;
        if (!written || renameat(folder, name, folder, name_in_folder(cache))) {
            unlinkat(folder, name, 0);
            written = false;
        }
    }
    buffer_finish(&temporary);
    return written;
}

/* Makes space for an entry: others leave, those unused for longest first. */
static bool make_space(struct atlas_cache *cache, int folder, uint64_t size)
{
    if (size > cache->limit || !is_allowed(size) || !has_space(folder, size)) {
        return false;
    }
    char *end = strrchr(cache->path.data, '/');
    *end = '\0';
    conus_status status = cache_folder_fit(cache->path.data, ATLAS_CACHE_ENDING, cache->limit - size);
    *end = '/';
    return !status;
}

static bool keep_in(struct atlas_cache *cache, int folder, const conus_atlas *atlas)
{
    struct buffer trace = {0};
    file_trace_write(&trace, &cache->trace);
    struct cache_entry entry = describe(cache, &trace, atlas);
    bool kept = !buffer_status(&trace) && !cache->heard.failed &&
                make_space(cache, folder, cache_entry_packed_at(&entry) + entry.packed.size) &&
                write_and_rename(cache, folder, &entry, atlas);
    buffer_finish(&trace);
    return kept;
}

/* Maps what was just written: then the atlas is in memory once, and answers as it will the next time. */
static void exchange(struct atlas_cache *cache, conus_atlas **atlas)
{
    const struct conus_load_options *given = cache->given;
    const struct conus_load_options silent = {0};
    cache->given = &silent; /* who listens has heard the notes */
    conus_atlas *mapped = find_entry(cache);
    cache->given = given;
    if (mapped) {
        conus_atlas_destroy(*atlas);
        *atlas = mapped;
    }
}

void atlas_cache_keep(struct atlas_cache *cache, conus_atlas **atlas)
{
    if (!is_used(cache) || !may_be_kept(*atlas, &cache->trace) || !cache_folder_make(cache->path.data)) {
        return;
    }
    int folder = open_folder(cache);
    if (folder >= 0) {
        if (keep_in(cache, folder, *atlas)) {
            exchange(cache, atlas);
        }
        close(folder);
    }
}
