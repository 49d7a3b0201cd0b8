/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes packs, and opens them. */
#include "pack/pack.h"

#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "base/threads.h"
#include "base/writer.h"
#include "conus/own.h"

#include <assert.h>
#include <libdeflate.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

static const char magic[16] = "conus pack";
enum { BYTE_ORDER_HERE = 0x01020304 };
static_assert(sizeof(struct pack_head) == PACK_PAGE && offsetof(struct pack_head, crc) == PACK_PAGE - 4,
              "the head is a page, with its sum at the end");

/* A source in the file; its path, whole path and path from the pack's folder follow, each with its NUL. */
struct source_head {
    uint64_t size;
    int64_t seconds, nanoseconds; /* of its last change */
    char sha256[72];
    uint64_t bytes; /* of all with the texts, to a multiple of 8 */
};

/* The texts of a source: as it was given, from the root on, from the pack's folder or "". */
enum { GIVEN, WHOLE, FROM_PACK, SOURCE_TEXTS };

bool pack_is(const char *path)
{
    return path_ends_in(path, CONUS_PACK_ENDING);
}

/* --- Writing --- */

struct pack_writer {
    struct writer file;
    struct sha256_ctx sha256;
    struct buffer sums;
    uint64_t at;
    uint32_t crc;
};

static conus_status put(void *user, const void *data, size_t size)
{
    struct pack_writer *writer = user;
    const uint8_t *bytes = data;
    conus_status status = file_append(&writer->file, data, size);
    sha256_update(&writer->sha256, size, bytes);
    while (size && !status) { /* sums end at multiples of a chunk */
        size_t left = PACK_CHUNK - (size_t)((writer->at - PACK_PAGE) % PACK_CHUNK);
        size_t part = size < left ? size : left;
        writer->crc = libdeflate_crc32(writer->crc, bytes, part);
        writer->at += part;
        bytes += part;
        size -= part;
        if (part == left) {
            buffer_append(&writer->sums, &writer->crc, sizeof writer->crc);
            writer->crc = 0;
        }
    }
    return status;
}

/* Writes a part, and then zeros up to a multiple of `step`. */
static conus_status put_part(struct pack_part *out, struct pack_writer *writer, const void *data, size_t size,
                             size_t step)
{
    static const uint8_t zeros[PACK_PAGE];
    *out = (struct pack_part){writer->at, size};
    conus_status status = put(writer, data, size);
    size_t over = (size_t)(writer->at % step);
    return status || !over ? status : put(writer, zeros, step - over);
}

/* The path from a folder to a file, both from the root on; nothing where they have no root in common. */
static void append_path_from(struct buffer *out, const char *folder, const char *file)
{
    size_t same = 0; /* bytes of what both begin with, with its '/' */
    for (size_t i = 0; folder[i] && folder[i] == file[i]; i++) {
        same = folder[i] == '/' ? i + 1 : same;
    }
    size_t length = strlen(folder);
    if (strncmp(folder, file, length) == 0 && file[length] == '/') {
        same = length + 1;
    }
    for (const char *at = folder + same; same && same <= length && at && *at; at = strchr(at, '/')) {
        buffer_text(out, "../");
        at += *at == '/';
    }
    buffer_text(out, same ? file + same : "");
}

/* The part of the sources. */
struct sources {
    struct buffer bytes;
    struct file_sums known;   /* by their paths from the root on */
    char folder[SYSTEM_PATH]; /* the pack's, likewise */
};

/* Whether the sum of a volume is that of its file alone. */
static bool is_one_file(const char *path)
{
    return !path_ending_length(path, ".nhdr/.mhd/.hdr/.img/.img.gz/.head/.brik/.brik.gz");
}

/* A store of Zarr has its metadata beside its chunks. */
static bool is_chunk(const char *path)
{
    return strstr(path, ".zarr/") && !path_ending_length(path, "zarr.json/.zarray/.zgroup/.zattrs/.zmetadata");
}

static bool is_known(const struct sources *sources, const char *whole)
{
    bool is = false;
    for (size_t i = 0; i < sources->known.count && !is; i++) {
        is = strcmp(sources->known.items[i].path, whole) == 0;
    }
    return is;
}

/* Adds a regular file, once; `sum`, unless NULL or "", is what was read. */
static conus_status add_source(struct sources *sources, const char *path, const char *sum)
{
    static const char zeros[8];
    char whole[SYSTEM_PATH];
    struct system_stat info;
    struct open_file file;
    struct buffer *out = &sources->bytes;
    size_t at = out->size;
    if (!path || is_chunk(path) || !system_real_path(whole, path) || is_known(sources, whole) ||
        !system_stat(&info, whole) || info.kind != SYSTEM_FILE) {
        return CONUS_OK;
    }
    conus_status status = file_open(&file, whole);
    if (status) {
        return status;
    }
    status = file_sums_add_open(&sources->known, &file);
    file_close(&file);
    if (status) {
        return status;
    }
    struct source_head head = {
        .size = file.before.size, .seconds = file.before.times[0], .nanoseconds = file.before.times[1]};
    memcpy(head.sha256, sources->known.items[sources->known.count - 1].sha256, sizeof sources->known.items[0].sha256);
    if (sum && *sum && strcmp(head.sha256, sum) != 0) {
        return fail(CONUS_ERROR_IO, "%s: has changed since it was read", path);
    }
    buffer_append(out, &head, sizeof head);
    buffer_append(out, path, strlen(path) + 1);
    buffer_append(out, whole, strlen(whole) + 1);
    append_path_from(out, sources->folder, whole);
    buffer_append(out, zeros, sizeof zeros - (out->size - at) % sizeof zeros);
    status = buffer_status(out);
    if (!status) {
        head.bytes = out->size - at;
        memcpy(out->data + at, &head, sizeof head);
    }
    return status;
}

/* What the atlas was made of, and what else info says. */
static conus_status find_sources(struct sources *out, const char *path, const conus_atlas *atlas,
                                 const conus_save_options *options)
{
    char *folder = file_beside(path, ".");
    conus_status status = !folder ? CONUS_ERROR_MEMORY
                          : system_real_path(out->folder, folder)
                              ? CONUS_OK
                              : fail(CONUS_ERROR_IO, "%s: there is no such folder", path);
    memory_free(folder);
    for (size_t i = 0; i < atlas->files.count && !status; i++) {
        status = add_source(out, atlas->files.items[i].path, atlas->files.items[i].sha256);
    }
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        const conus_volume_info *info = &atlas->volumes[i].info;
        status = add_source(out, info->path, is_one_file(info->path) ? info->sha256 : NULL);
    }
    for (size_t i = 0; i < atlas->tractogram_count && !status; i++) {
        status = add_source(out, atlas->tractograms[i].path, atlas->tractograms[i].sha256);
    }
    for (size_t i = 0; i < atlas->mesh_count && !status; i++) {
        status = add_source(out, atlas->meshes[i].path, NULL);
    }
    for (size_t i = 0; i < atlas->context_surface_count && !status; i++) {
        status = add_source(out, atlas->context_surfaces[i].mesh.path, NULL);
    }
    for (size_t i = 0; i < options->source_count && !status; i++) {
        status = add_source(out, options->sources[i], NULL);
    }
    return status;
}

/* The parts behind the head, and the head. */
static conus_status write_parts(struct pack_writer *writer, const conus_atlas *atlas, const char *words,
                                const struct sources *sources)
{
    struct pack_head head = {.format = PACK_FORMAT,
                             .byte_order = BYTE_ORDER_HERE,
                             .layout = pack_layout(),
                             .readers = PACK_READERS,
                             .version = CONUS_VERSION};
    memcpy(head.magic, magic, sizeof magic);
    conus_status status = file_append(&writer->file, &head, sizeof head);
    status = status ? status : put_part(&head.words, writer, words, strlen(words) + 1, 8);
    status = status ? status : put_part(&head.sources, writer, sources->bytes.data, sources->bytes.size, PACK_PAGE);
    head.atlas.at = writer->at;
    status = status ? status : atlas_pack_give(atlas, put, writer);
    head.atlas.size = writer->at - head.atlas.at;
    if (!status && (writer->at - PACK_PAGE) % PACK_CHUNK) {
        buffer_append(&writer->sums, &writer->crc, sizeof writer->crc);
    }
    status = status ? status : buffer_status(&writer->sums);
    if (status) {
        return status;
    }
    head.sums = (struct pack_part){writer->at, writer->sums.size};
    head.sums_crc = libdeflate_crc32(0, writer->sums.data, writer->sums.size);
    head.size = writer->at + writer->sums.size;
    status = file_append(&writer->file, writer->sums.data, writer->sums.size);
    sha256_update(&writer->sha256, writer->sums.size, (const uint8_t *)writer->sums.data);
    sha256_digest(&writer->sha256, sizeof head.sha256, head.sha256);
    head.crc = libdeflate_crc32(0, &head, offsetof(struct pack_head, crc));
    return status || system_write_at(writer->file.file, &head, sizeof head, 0)
               ? status
               : fail(CONUS_ERROR_IO, "%s: cannot write: %s", writer->file.path, text_error(errno));
}

conus_status conus_atlas_save(const char *path, const conus_atlas *atlas, const conus_save_options *options)
{
    if (!path || !atlas) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_save: a path and an atlas are needed");
    }
    if (!pack_is(path)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: a pack's name ends in " CONUS_PACK_ENDING, path);
    }
    if (atlas->pack) {
        return fail(CONUS_ERROR_ARGUMENT, "%s is a pack already: pack what it was packed from", atlas->pack->info.path);
    }
    options = options_of(conus_save_options, options);
    struct sources sources = {0};
    struct pack_writer writer = {.file.file = -1, .at = PACK_PAGE};
    sha256_init(&writer.sha256);
    conus_status status = find_sources(&sources, path, atlas, options);
    status = status ? status : file_begin(&writer.file, path, 0);
    if (!status && writer.file.is_direct) {
        status = fail(CONUS_ERROR_IO, "%s: cannot write: is a device or pipe, a regular file is needed", path);
    }
    status = status ? status : write_parts(&writer, atlas, options->words ? options->words : "", &sources);
    status = status ? status : file_end(&writer.file);
    writer_drop(&writer.file);
    buffer_finish(&writer.sums);
    buffer_finish(&sources.bytes);
    file_sums_finish(&sources.known);
    return status;
}

/* --- Opening --- */

/* A mapped pack; its head is a copy. */
struct opening {
    const char *path;
    uint8_t *memory;
    size_t size;
    struct pack_head head;
};

/* The words that pack it again, behind a message, where there are some. */
static const char *words_of(const struct opening *opening)
{
    return (const char *)opening->memory + opening->head.words.at;
}

static conus_status fail_again(const struct opening *opening, const char *what)
{
    const char *words = opening->head.size == opening->size ? words_of(opening) : "";
    return fail(CONUS_ERROR_DATA, "%s: %s; pack it again%s%s", opening->path, what, *words ? ": " : "", words);
}

/* Whether a part lies behind the head and in the file, at a multiple of `step`. */
static bool part_fits(const struct opening *opening, const struct pack_part *part, size_t step)
{
    return part->at >= PACK_PAGE && part->at % step == 0 && part->at <= opening->size &&
           part->size <= opening->size - part->at;
}

static conus_status check_head(struct opening *opening)
{
    struct pack_head *head = &opening->head;
    const char *path = opening->path;
    if (opening->size >= sizeof head->magic && memcmp(opening->memory, magic, sizeof magic) != 0) {
        return fail(CONUS_ERROR_DATA, "%s: is no pack: it does not begin with \"conus pack\"", path);
    }
    if (opening->size < sizeof *head) {
        return fail(CONUS_ERROR_DATA, "%s: is cut off: found %zu bytes, a pack has a head of %d", path, opening->size,
                    PACK_PAGE);
    }
    memcpy(head, opening->memory, sizeof *head);
    if (head->byte_order == __builtin_bswap32(BYTE_ORDER_HERE)) {
        return fail(CONUS_ERROR_DATA, "%s: was packed on a machine with another byte order; pack it again here", path);
    }
    if (head->format != PACK_FORMAT) {
        return fail(CONUS_ERROR_DATA, "%s: found format %u, this conus reads format %d; pack it again", path,
                    head->format, PACK_FORMAT);
    }
    if (libdeflate_crc32(0, head, offsetof(struct pack_head, crc)) != head->crc) {
        return fail(CONUS_ERROR_DATA, "%s: is damaged in its head, bytes 0 to %d; pack it again", path, PACK_PAGE - 1);
    }
    if (head->size != opening->size) {
        return fail(CONUS_ERROR_DATA, "%s: found %zu bytes, its head says %llu; pack it again", path, opening->size,
                    (unsigned long long)head->size);
    }
    bool fits = head->byte_order == BYTE_ORDER_HERE && memchr(head->version, 0, sizeof head->version) &&
                part_fits(opening, &head->words, 8) && head->words.size && part_fits(opening, &head->sources, 8) &&
                part_fits(opening, &head->atlas, PACK_PAGE) && part_fits(opening, &head->sums, 8) &&
                head->sums.at + head->sums.size == head->size &&
                head->sums.size / sizeof(uint32_t) == (head->sums.at - PACK_PAGE + PACK_CHUNK - 1) / PACK_CHUNK &&
                opening->memory[head->words.at + head->words.size - 1] == 0;
    if (!fits) {
        return fail(CONUS_ERROR_DATA, "%s: its head leads out of the file; pack it again", path);
    }
    if (head->layout != pack_layout()) {
        return fail_again(opening, "is for another build of conus");
    }
    return libdeflate_crc32(0, opening->memory + head->sums.at, head->sums.size) == head->sums_crc
               ? CONUS_OK
               : fail_again(opening, "is damaged in its sums");
}

static bool chunks_are_sound(const void *user, size_t from, size_t to)
{
    const struct opening *opening = user;
    bool sound = true;
    for (size_t i = from; i < to && sound; i++) {
        uint64_t at = PACK_PAGE + (uint64_t)i * PACK_CHUNK;
        uint64_t left = opening->head.sums.at - at;
        uint32_t sum;
        memcpy(&sum, opening->memory + opening->head.sums.at + i * sizeof sum, sizeof sum);
        sound = libdeflate_crc32(0, opening->memory + at, left < PACK_CHUNK ? (size_t)left : PACK_CHUNK) == sum;
    }
    return sound;
}

static conus_status check_sums(const struct opening *opening)
{
    const size_t count = opening->head.sums.size / sizeof(uint32_t);
    char what[96];
    size_t i = 0;
    if (threads_check(chunks_are_sound, opening, count, 1)) {
        return CONUS_OK;
    }
    while (i + 1 < count && chunks_are_sound(opening, i, i + 1)) {
        i++;
    }
    uint64_t at = PACK_PAGE + (uint64_t)i * PACK_CHUNK;
    uint64_t end = at + PACK_CHUNK < opening->head.sums.at ? at + PACK_CHUNK : opening->head.sums.at;
    snprintf(what, sizeof what, "is damaged between the bytes %llu and %llu", (unsigned long long)at,
             (unsigned long long)end - 1);
    return fail_again(opening, what);
}

/* The source at `at` of the part, and its texts; false where there is no whole one. */
static bool parse_source(struct source_head *out, const char *texts[SOURCE_TEXTS], const uint8_t *at, size_t size)
{
    if (size < sizeof *out) {
        return false;
    }
    memcpy(out, at, sizeof *out);
    const uint8_t *text = at + sizeof *out;
    bool fits = out->bytes >= sizeof *out && out->bytes <= size && memchr(out->sha256, 0, sizeof out->sha256);
    for (int i = 0; i < SOURCE_TEXTS && fits; i++) {
        const uint8_t *end = memchr(text, 0, (size_t)(at + out->bytes - text));
        fits = end;
        texts[i] = (const char *)text;
        text = fits ? end + 1 : text;
    }
    return fits;
}

/* Whether the file has these bytes. One with another size or, unless they are read, another time has not. */
static conus_source_state compare_source(const struct source_head *head, const char *path)
{
    struct open_file file;
    struct file_sums read = {0};
    bool before = inputs_search(true); /* it is no input of what is asked */
    conus_source_state state = file_open_here(&file, path) ? CONUS_SOURCE_MISSING : CONUS_SOURCE_CHANGED;
    inputs_search(before);
    if (state == CONUS_SOURCE_CHANGED) {
        bool is_same = file.before.size == head->size && file.before.times[0] == head->seconds &&
                       file.before.times[1] == head->nanoseconds;
        if (!is_same && file.before.size == head->size && !file_sums_add_open(&read, &file)) {
            is_same = strcmp(read.items[0].sha256, head->sha256) == 0;
        }
        state = is_same ? CONUS_SOURCE_SAME : state;
        file_close(&file);
    }
    file_sums_finish(&read);
    return state;
}

/* Whether it is a path of another machine, which is not asked because a pack says so. */
static bool is_elsewhere(const char *path)
{
    return strchr(SYSTEM_SEPARATORS, path[0]) && path[0] && strchr(SYSTEM_SEPARATORS, path[1]) && path[1];
}

/* Where it lay from the pack, or else by its whole path. */
static conus_source_state find_source(const struct source_head *head, const char *const texts[SOURCE_TEXTS],
                                      const char *pack)
{
    char *beside = *texts[FROM_PACK] && !path_is_whole(texts[FROM_PACK]) ? file_beside(pack, texts[FROM_PACK]) : NULL;
    conus_source_state state = beside ? compare_source(head, beside) : CONUS_SOURCE_MISSING;
    memory_free(beside);
    return state == CONUS_SOURCE_MISSING && !is_elsewhere(texts[WHOLE]) ? compare_source(head, texts[WHOLE]) : state;
}

/* The pack as the atlas knows it. */
static conus_status make_origin(struct pack_origin **out, const struct opening *opening)
{
    const struct pack_head *head = &opening->head;
    const uint8_t *sources = opening->memory + head->sources.at;
    const char *texts[SOURCE_TEXTS];
    struct source_head source;
    size_t count = 0;
    for (size_t at = 0; at < head->sources.size; at += source.bytes, count++) {
        if (!parse_source(&source, texts, sources + at, head->sources.size - at)) {
            return fail_again(opening, "is damaged in its list of sources");
        }
    }
    size_t path_size = strlen(opening->path) + 1;
    struct pack_origin *origin = memory_zeroed(sizeof *origin + count * sizeof origin->sources[0] + path_size, 1);
    if (!origin) {
        return CONUS_ERROR_MEMORY;
    }
    char *path = (char *)(origin->sources + count);
    memcpy(path, opening->path, path_size);
    for (size_t i = 0; i < sizeof head->sha256; i++) {
        snprintf(origin->sha256 + 2 * i, 3, "%02x", head->sha256[i]);
    }
    origin->info = (conus_pack_info){.path = path,
                                     .sha256 = origin->sha256,
                                     .words = words_of(opening),
                                     .version = (const char *)opening->memory + offsetof(struct pack_head, version),
                                     .size = head->size,
                                     .source_count = count};
    for (size_t at = 0, i = 0; i < count; at += source.bytes, i++) {
        parse_source(&source, texts, sources + at, head->sources.size - at);
        origin->sources[i] = (struct pack_source){texts[GIVEN], find_source(&source, texts, path)};
    }
    *out = origin;
    return CONUS_OK;
}

/* Warns of a pack that is older than its sources or than the readers. */
static conus_status note_age(conus_atlas *atlas, const struct opening *opening)
{
    const conus_pack_info *info = &atlas->pack->info;
    const char *behind = *info->words ? ": " : "";
    const char *first = NULL;
    size_t changed = 0;
    char more[48] = "";
    for (size_t i = 0; i < info->source_count; i++) {
        const struct pack_source *source = &atlas->pack->sources[i];
        bool has_changed = source->state == CONUS_SOURCE_CHANGED;
        first = has_changed && !first ? source->path : first;
        changed += has_changed;
    }
    if (changed > 1) {
        snprintf(more, sizeof more, " and %zu more", changed - 1);
    }
    conus_status status = CONUS_OK;
    if (changed) {
        status = notes_warn(&atlas->notes, "%s was packed from %s%s, which %s changed since; pack it again%s%s",
                            info->path, first, more, changed > 1 ? "have" : "has", behind, info->words);
    }
    if (!status && opening->head.readers < PACK_READERS) {
        status =
            notes_warn(&atlas->notes, "%s was packed by conus %s, whose readers were mended since; pack it again%s%s",
                       info->path, info->version, behind, info->words);
    }
    return status;
}

/* Leaves out a context that no answer needs, as a manifest's is (conus_load_options.without_context). */
static void leave_context(conus_atlas *atlas)
{
    struct volume *last = atlas->volume_count > 1 ? &atlas->volumes[atlas->volume_count - 1] : NULL;
    if (last && last->info.role == CONUS_ROLE_CONTEXT && !last->objects32 && !atlas->is_moved) {
        volume_finish(last);
        atlas->volume_count--;
        atlas->lacks_context = true;
    }
}

/* Labels and thresholds are those that it was packed with. */
static conus_status check_options(const char *path, const conus_load_options *options)
{
    const char *given = options->labels          ? "labels"
                        : options->labels_anyway ? "labels_anyway"
                        : options->probability   ? "probability"
                                                 : NULL;
    return given ? fail(CONUS_ERROR_ARGUMENT, "%s: %s has no effect on a pack: give it when packing", path, given)
                 : CONUS_OK;
}

static conus_status map_file(struct opening *out, const char *path)
{
    struct open_file file;
    *out = (struct opening){.path = path};
    conus_status status = file_open(&file, path);
    if (status) {
        return status;
    }
    out->size = (size_t)file.before.size;
    out->memory = out->size ? system_map(file.descriptor, out->size) : NULL;
    status = out->memory ? CONUS_OK
             : out->size ? fail(CONUS_ERROR_IO, "%s: cannot map it: %s", path, text_error(errno))
                         : fail(CONUS_ERROR_DATA, "%s: is empty, a pack is needed", path);
    file_close(&file);
    return status;
}

static conus_status attach(conus_atlas **out, const struct opening *opening)
{
    const struct pack_part *part = &opening->head.atlas;
    conus_atlas *atlas = NULL;
    struct pack_origin *origin = NULL;
    conus_status status = make_origin(&origin, opening);
    status = status ? status : atlas_attach_verified(&atlas, opening->memory + part->at, (size_t)part->size);
    status = status ? status : pack_check_atlas(atlas);
    if (status) {
        status = origin && status == CONUS_ERROR_DATA ? fail_in(status, opening->path) : status;
        conus_atlas_destroy(atlas);
        memory_free(origin);
        return status;
    }
    atlas->pack = origin;
    status = note_age(atlas, opening);
    return atlas_give(out, atlas, status);
}

conus_status pack_load(conus_atlas **out, const char *path, const conus_load_options *options)
{
    struct opening opening;
    conus_atlas *atlas = NULL;
    conus_status status = check_options(path, options);
    status = status ? status : map_file(&opening, path);
    if (status) {
        return status;
    }
    if (options->progress && !options->progress(options->progress_user, path, 0, 1)) {
        status = fail(CONUS_ERROR_CANCELLED, "%s: cancelled before it was read", path);
    }
    status = status ? status : check_head(&opening);
    status = status ? status : check_sums(&opening);
    status = status ? status : attach(&atlas, &opening);
    if (status) {
        file_unmap(opening.memory, opening.size);
        return status;
    }
    atlas->mapped = opening.memory;
    atlas->mapped_size = opening.size;
    if (options->without_context) {
        leave_context(atlas);
    }
    for (size_t i = 0; i < atlas->notes.count && options->log; i++) {
        options->log(options->log_user,
                     &(const conus_note){atlas->notes.marks[i].severity, path, atlas->notes.lines[i]});
    }
    *out = atlas;
    return CONUS_OK;
}
