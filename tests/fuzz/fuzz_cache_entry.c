/* SPDX-License-Identifier: BSD-3-Clause */
/* An entry of the cache of atlases that somebody else may have written: the input as it is; the input as the parts of
 * an entry with valid checksums; and that entry with one wrong byte in its head. The first eight bytes are the sizes of
 * key, notes and trace, and the place and value of that byte; the parts follow. */
#include "base/cache/cache_entry.h"
#include "base/memory.h"
#include "cache/atlas_cache.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The head by hand: magic, stamp, then the size and where the packed atlas begins; two checksums end it. */
enum { SIZE_AT = 32, PACKED_AT = 40, CRC_AT = 84, HEAD = 88, FIRST = 8 };

static void must(bool holds)
{
    if (!holds) {
        abort();
    }
}

static void hear(void *user, const conus_note *note)
{
    *(size_t *)user += strlen(note->line) + (note->path ? strlen(note->path) : 0);
}

/* Reads all parts of an accepted entry but its voxels. */
static void use_parts(const struct cache_entry *entry)
{
    size_t length = 0;
    struct file_trace trace = {0};
    struct buffer path = {0};
    cache_key_path(&path, entry->key.data, entry->key.size);
    length += path.size;
    buffer_finish(&path);
    (void)atlas_cache_tell(entry->notes.data, entry->notes.size, hear, &length);
    if (file_trace_parse(&trace, entry->trace.data, entry->trace.size)) {
        struct buffer again = {0};
        file_trace_write(&again, &trace);
        struct file_trace second = {0};
        must(file_trace_parse(&second, (const uint8_t *)again.data, again.size) && second.count == trace.count);
        file_trace_finish(&second);
        file_trace_finish(&trace);
        buffer_finish(&again);
    }
    must(length <= entry->key.size + entry->notes.size);
}

static struct cache_part take_part(const uint8_t **at, size_t *left, size_t size)
{
    struct cache_part part = {*at, size < *left ? size : *left};
    *at += part.size;
    *left -= part.size;
    return part;
}

/* Changes a byte of the head, and corrects the checksum if the head says where the packed atlas begins. */
static void lie(uint8_t *entry, size_t size, size_t at, uint8_t byte)
{
    uint64_t packed_at;
    struct cache_entry parsed;
    entry[SIZE_AT + at % (CRC_AT - SIZE_AT)] = byte;
    memcpy(&packed_at, entry + PACKED_AT, sizeof packed_at);
    if (packed_at >= HEAD && packed_at <= size) {
        uint32_t crc = libdeflate_crc32(0, entry + SIZE_AT, CRC_AT - SIZE_AT);
        crc = packed_at > HEAD ? libdeflate_crc32(crc, entry + HEAD, packed_at - HEAD) : crc;
        memcpy(entry + CRC_AT, &crc, sizeof crc);
    }
    if (cache_entry_parse(&parsed, entry, size)) {
        must(parsed.packed.data + parsed.packed.size == entry + size);
        (void)cache_entry_is_whole(&parsed);
        use_parts(&parsed);
    }
}

static void check_entry(struct buffer *bytes, const struct cache_entry *entry, const uint8_t *first)
{
    struct cache_entry parsed;
    uint8_t *memory = memory_copy(bytes->data, bytes->size, 1); /* of exactly this size, for sanitizers */
    must(memory && cache_entry_parse(&parsed, memory, bytes->size));
    must(parsed.key.size == entry->key.size && parsed.notes.size == entry->notes.size &&
         parsed.trace.size == entry->trace.size && parsed.packed.size == entry->packed.size);
    must(cache_entry_is_whole(&parsed));
    must(!cache_entry_parse(&parsed, memory, bytes->size - 1));
    must(cache_entry_parse(&parsed, memory, bytes->size));
    use_parts(&parsed);
    lie(memory, bytes->size, first[6], first[7]);
    memory_free(memory);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct cache_entry entry;
    struct buffer bytes = {0};
    if (size && cache_entry_parse(&entry, data, size)) {
        use_parts(&entry);
    }
    if (size < FIRST) {
        return 0;
    }
    const uint8_t *at = data + FIRST;
    size_t left = size - FIRST;
    memset(&entry, 0, sizeof entry);
    entry.key = take_part(&at, &left, data[0] | (size_t)data[1] << 8);
    entry.notes = take_part(&at, &left, data[2] | (size_t)data[3] << 8);
    entry.trace = take_part(&at, &left, data[4] | (size_t)data[5] << 8);
    entry.packed = take_part(&at, &left, left);
    entry.packed_crc = cache_crc(0, entry.packed.data, entry.packed.size);
    cache_entry_write(&bytes, &entry);
    buffer_append(&bytes, entry.packed.data, entry.packed.size);
    must(!buffer_status(&bytes));
    check_entry(&bytes, &entry, data);
    buffer_finish(&bytes);
    return 0;
}
