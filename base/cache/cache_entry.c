/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes and checks the bytes of an entry. */
#include "base/cache/cache_entry.h"

#include "base/system/system.h"

#include <libdeflate.h>
#include <stddef.h>
#include <string.h>

static const char magic[16] = "conus-cache 1\n";

struct entry_head {
    char magic[16];
    uint8_t stamp[CACHE_STAMP_SIZE]; /* the only bytes that no checksum covers: another value only costs time */
    uint64_t size, packed_at, packed_size;
    uint64_t key_size, notes_size, trace_size;
    uint32_t packed_crc;
    uint32_t crc; /* of the head from `size` on, and of all from the head to packed_at */
};

uint32_t cache_crc(uint32_t sum, const void *data, size_t size)
{
    return size ? libdeflate_crc32(sum, data, size) : sum; /* without data it would begin anew */
}

size_t cache_entry_stamp_at(void)
{
    return offsetof(struct entry_head, stamp);
}

size_t cache_entry_packed_at(const struct cache_entry *entry)
{
    size_t ahead = sizeof(struct entry_head) + entry->key.size + entry->notes.size + entry->trace.size;
    return (ahead + CACHE_PAGE - 1) / CACHE_PAGE * CACHE_PAGE;
}

static uint32_t crc_ahead(const uint8_t *memory, size_t packed_at)
{
    size_t from = offsetof(struct entry_head, size);
    uint32_t sum = cache_crc(0, memory + from, offsetof(struct entry_head, crc) - from);
    return cache_crc(sum, memory + sizeof(struct entry_head), packed_at - sizeof(struct entry_head));
}

/* Whether the parts lie one behind the other, and end where the file does. */
static bool fits(const struct entry_head *head, size_t size)
{
    uint64_t left = size; /* each size is compared with what is left, so that no sum can overflow */
    const uint64_t sizes[] = {sizeof *head, head->key_size, head->notes_size, head->trace_size};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        if (sizes[i] > left) {
            return false;
        }
        left -= sizes[i];
    }
    uint64_t ahead = size - left;
    return head->size == size && head->packed_at == (ahead + CACHE_PAGE - 1) / CACHE_PAGE * CACHE_PAGE &&
           head->packed_at <= size && head->packed_size == size - head->packed_at;
}

bool cache_entry_parse(struct cache_entry *out, const uint8_t *memory, size_t size)
{
    struct entry_head head;
    if (size < sizeof head) {
        return false;
    }
    memcpy(&head, memory, sizeof head);
    if (memcmp(head.magic, magic, sizeof magic) != 0 || !fits(&head, size) ||
        crc_ahead(memory, head.packed_at) != head.crc) {
        return false;
    }
    const uint8_t *at = memory + sizeof head;
    out->key = (struct cache_part){at, head.key_size};
    out->notes = (struct cache_part){at + head.key_size, head.notes_size};
    out->trace = (struct cache_part){at + head.key_size + head.notes_size, head.trace_size};
    out->packed = (struct cache_part){memory + head.packed_at, head.packed_size};
    out->packed_crc = head.packed_crc;
    memcpy(out->stamp, head.stamp, sizeof out->stamp);
    return true;
}

bool cache_entry_is_whole(const struct cache_entry *entry)
{
    return cache_crc(0, entry->packed.data, entry->packed.size) == entry->packed_crc;
}

void cache_entry_write(struct buffer *out, const struct cache_entry *entry)
{
    static const uint8_t zeros[CACHE_PAGE];
    struct entry_head head = {.packed_at = cache_entry_packed_at(entry),
                              .packed_size = entry->packed.size,
                              .key_size = entry->key.size,
                              .notes_size = entry->notes.size,
                              .trace_size = entry->trace.size,
                              .packed_crc = entry->packed_crc};
    size_t start = out->size;
    memcpy(head.magic, magic, sizeof magic);
    memcpy(head.stamp, entry->stamp, sizeof head.stamp);
    head.size = head.packed_at + head.packed_size;
    buffer_append(out, &head, sizeof head);
    buffer_append(out, entry->key.data, entry->key.size);
    buffer_append(out, entry->notes.data, entry->notes.size);
    buffer_append(out, entry->trace.data, entry->trace.size);
    buffer_append(out, zeros, head.packed_at + start - out->size);
    if (!out->failed) {
        head.crc = crc_ahead((const uint8_t *)out->data + start, head.packed_at);
        memcpy(out->data + start, &head, sizeof head);
    }
}

bool cache_stamp_find(uint8_t out[CACHE_STAMP_SIZE], int descriptor, const struct timespec *written)
{
    struct system_stat info;
    if (!system_boot(out) || !system_stat_open(&info, descriptor)) {
        return false;
    }
    const uint64_t own[CACHE_STAMP_SIZE / sizeof(uint64_t)] = {
        info.inode, (uint64_t)written->tv_sec * UINT64_C(1000000000) + (uint64_t)written->tv_nsec};
    for (size_t i = 0; i < CACHE_STAMP_SIZE; i++) {
        out[i] ^= (uint8_t)(own[i / 8] >> 8 * (i % 8));
    }
    return true;
}
