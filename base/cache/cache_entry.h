/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The bytes of an entry: a head, then what it is about (the key, what was noted, what was asked of the file system),
 * zeros up to a page, and the packed atlas. The numbers are this machine's: the key says which machine and build. */
#ifndef CONUS_CACHE_CACHE_ENTRY_H
#define CONUS_CACHE_CACHE_ENTRY_H

#include "base/buffer.h"

#include <time.h>

enum { CACHE_PAGE = 4096, CACHE_STAMP_SIZE = 16 };

/** Up to this size of the packed atlas its checksum is verified whenever an entry is opened, beyond it once in each run
 * of the kernel. */
#define CACHE_SMALL (UINT64_C(1) << 20)

/** A stretch of an entry: borrowed. */
struct cache_part {
    const uint8_t *data;
    size_t size;
};

struct cache_entry {
    struct cache_part key, notes, trace, packed;
    uint32_t packed_crc;
    uint8_t stamp[CACHE_STAMP_SIZE]; /**< cache_stamp_find() of when all of it was verified, or written. */
};

/** Where the stamp stands in a file. */
size_t cache_entry_stamp_at(void);

/** Finds the parts of an entry of @p size bytes. False where the head is damaged or gives another size, or the checksum
 * of the bytes before the packed atlas differs. @p memory is 8-aligned. */
bool cache_entry_parse(struct cache_entry *out, const uint8_t *memory, size_t size);

/** Whether the checksum of the packed atlas holds. It is read from one end to the other. */
bool cache_entry_is_whole(const struct cache_entry *entry);

/** Where the packed atlas begins in the file of @p entry. */
size_t cache_entry_packed_at(const struct cache_entry *entry);

/** Appends what stands ahead of the packed atlas: packed.size and packed_crc count, packed.data does not. */
void cache_entry_write(struct buffer *out, const struct cache_entry *entry);

/** CRC-32 of @p data behind those that gave @p sum, 0 at first. */
uint32_t cache_crc(uint32_t sum, const void *data, size_t size);

/** A stamp of this run of the kernel, the file behind @p descriptor and @p written, the time when that was last
 * written; false where the run of the kernel has no name. */
bool cache_stamp_find(uint8_t out[CACHE_STAMP_SIZE], int descriptor, const struct timespec *written);

#endif
