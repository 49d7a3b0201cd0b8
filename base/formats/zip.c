/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists and unpacks zip archives: the record at the end leads to the central directory, that to the files. */
#include "base/formats/packed.h"

#include "base/byte_order.h"
#include "base/order.h"

#include <libdeflate.h>
#include <string.h>

enum {
    END_SIZE = 22,     /* of the record at the end, without the archive's remark */
    END64_SIZE = 56,   /* of ZIP64's, without what may follow in it */
    LOCATOR_SIZE = 20, /* between these two */
    CENTRAL_SIZE = 46, /* of an entry of the central directory, without name, extra fields and remark */
    LOCAL_SIZE = 30,   /* of the header before a file, without name and extra fields */
    REMARK_LIMIT = 0xffff,
    IN_ZIP64_16 = 0xffff, /* instead of a number that is in ZIP64's record or field */
    ZIP64_FIELD = 1,
    INFLATE_RATIO = 1032, /* the most that deflate makes of a byte */
    SHOWN = 100
};

static const uint32_t in_zip64_32 = 0xffffffff;

enum signature { LOCAL = 0x04034b50, CENTRAL = 0x02014b50, END = 0x06054b50, END64 = 0x06064b50, LOCATOR = 0x07064b50 };

enum { FLAG_ENCRYPTED = 1, FLAG_SIZES_BEHIND = 8, FLAG_PATCH = 0x20, FLAG_STRONG = 0x40, FLAG_MASKED = 0x2000 };

enum { METHOD_STORED = 0, METHOD_DEFLATE = 8 };

static uint16_t u16_at(const uint8_t *data)
{
    return order_u16(data, !BIG_ENDIAN_IS_SWAPPED);
}

static uint32_t u32_at(const uint8_t *data)
{
    return order_u32(data, !BIG_ENDIAN_IS_SWAPPED);
}

static uint64_t u64_at(const uint8_t *data)
{
    return order_u64(data, !BIG_ENDIAN_IS_SWAPPED);
}

bool zip_is(const uint8_t *data, size_t size)
{
    return size >= 4 && (u32_at(data) == LOCAL || u32_at(data) == END);
}

static void bad_entry(struct job *job, struct text name, const char *what)
{
    job_bad(job, "zip: %.*s: %s", TEXT_SHOW(name, SHOWN), what);
}

/* Where the central directory is. */
struct directory {
    uint64_t at, size, count;
};

/* The record ends, with its remark, where the archive does. */
static const uint8_t *find_end(const uint8_t *data, size_t size)
{
    for (size_t remark = 0; remark <= REMARK_LIMIT && remark + END_SIZE <= size; remark++) {
        const uint8_t *end = data + size - remark - END_SIZE;
        if (u32_at(end) == END && u16_at(end + 20) == remark) {
            return end;
        }
    }
    return NULL;
}

static void refuse_part(struct job *job)
{
    job_refuse(job, "zip: one part of several, a whole archive is needed");
}

/* ZIP64's record, of an archive with one; its place is where it ends in the archive. */
static struct directory read_end64(struct job *job, const uint8_t *data, size_t *end_at)
{
    const struct directory none = {0};
    size_t locator_at = *end_at - LOCATOR_SIZE;
    uint64_t at = u64_at(data + locator_at + 8);
    if (u32_at(data + locator_at + 4) || u32_at(data + locator_at + 16) > 1) {
        refuse_part(job);
        return none;
    }
    if (locator_at < END64_SIZE || at > locator_at - END64_SIZE || u32_at(data + at) != END64 ||
        u64_at(data + at + 4) != locator_at - at - 12) {
        job_bad(job, "zip: the ZIP64 record is not at byte %llu, as its locator says", (unsigned long long)at);
        return none;
    }
    if (u64_at(data + at + 24) != u64_at(data + at + 32)) {
        refuse_part(job);
    }
    *end_at = (size_t)at;
    return (struct directory){u64_at(data + at + 48), u64_at(data + at + 40), u64_at(data + at + 32)};
}

static struct directory read_end(struct job *job, const uint8_t *data, size_t size)
{
    const uint8_t *end = find_end(data, size);
    if (!end) {
        job_bad(job, "zip: no record of the central directory at its end: cut off, or no archive");
        return (struct directory){0};
    }
    struct directory directory = {u32_at(end + 16), u32_at(end + 12), u16_at(end + 10)};
    bool wide = directory.at == in_zip64_32 || directory.size == in_zip64_32 || directory.count == IN_ZIP64_16;
    size_t end_at = (size_t)(end - data);
    if (u16_at(end + 4) != u16_at(end + 6) || u16_at(end + 8) != u16_at(end + 10) ||
        (u16_at(end + 4) && u16_at(end + 4) != IN_ZIP64_16)) {
        refuse_part(job);
    }
    if (wide && end_at >= LOCATOR_SIZE && u32_at(end - LOCATOR_SIZE) == LOCATOR) {
        directory = read_end64(job, data, &end_at);
    }
    if (directory.size > end_at || directory.at != end_at - directory.size) {
        job_bad(job, "zip: a central directory of %llu bytes from byte %llu, it ends at byte %zu",
                (unsigned long long)directory.size, (unsigned long long)directory.at, end_at);
    }
    if (directory.count > directory.size / CENTRAL_SIZE) {
        job_bad(job, "zip: %llu files in a central directory of %llu bytes", (unsigned long long)directory.count,
                (unsigned long long)directory.size);
    }
    return job_ok(job) ? directory : (struct directory){0};
}

/* The fields that a header before a file and its entry of the directory have in common. */
struct record {
    uint16_t flags, method;
    uint32_t checksum;
    uint64_t stored, size, header_at;
    struct text name, extra;
};

/* Numbers that did not fit are in ZIP64's extra field, one behind the other. False where they are not. */
static bool widen(struct record *record)
{
    uint64_t *numbers[] = {&record->size, &record->stored, &record->header_at};
    const uint8_t *extra = (const uint8_t *)record->extra.data;
    size_t left = record->extra.size;
    size_t field = 0;
    for (; left >= 4 && u16_at(extra) != ZIP64_FIELD; extra += field, left -= field) {
        field = 4 + (size_t)u16_at(extra + 2);
        if (field > left) {
            return false;
        }
    }
    size_t there = left >= 4 ? u16_at(extra + 2) : 0;
    const uint8_t *from = extra + 4;
    for (size_t i = 0; i < 3; i++) {
        if (*numbers[i] == in_zip64_32) {
            if (there < 8 || there > left - 4) {
                return false;
            }
            *numbers[i] = u64_at(from);
            from += 8;
            there -= 8;
        }
    }
    return true;
}

/* Refuses names that would lead somewhere else when a program unpacks them, or that a terminal would not show as they
 * are. */
static bool is_good_name(struct text name)
{
    struct text part;
    bool more = true;
    bool is_folder = name.size && name.data[name.size - 1] == '/';
    struct text rest = {name.data, name.size - is_folder};
    for (size_t i = 0; i < name.size; i++) {
        if ((unsigned char)name.data[i] < 0x20 || name.data[i] == 0x7f || name.data[i] == '\\' || name.data[i] == ':') {
            return false;
        }
    }
    while (text_field(&rest, '/', &more, &part)) {
        if (!part.size || text_equal(part, ".") || text_equal(part, "..")) {
            return false;
        }
    }
    return name.size && text_is_utf8(name);
}

static void check_kind(struct job *job, const struct record *record)
{
    if (!is_good_name(record->name)) {
        job_bad(job, "zip: a file's name is absolute, climbs with \"..\", or is no plain UTF-8");
    }
    if (record->flags & (FLAG_ENCRYPTED | FLAG_STRONG | FLAG_MASKED)) {
        job_refuse(job, "zip: %.*s: encrypted, needed is one that is not", TEXT_SHOW(record->name, SHOWN));
    }
    if ((record->method != METHOD_STORED && record->method != METHOD_DEFLATE) || record->flags & FLAG_PATCH) {
        job_refuse(job, "zip: %.*s: packed by method %u, only deflate (8) is unpacked", TEXT_SHOW(record->name, SHOWN),
                   record->method);
    }
    if (record->method == METHOD_STORED ? record->stored != record->size
                                        : record->size / INFLATE_RATIO > record->stored) {
        job_bad(job, "zip: %.*s: %llu bytes cannot be %llu, unpacked", TEXT_SHOW(record->name, SHOWN),
                (unsigned long long)record->stored, (unsigned long long)record->size);
    }
}

/* Of the header before a file, or of its entry, whose fields stand so many bytes later. */
static struct record read_record(const uint8_t *from, size_t later, const char *name)
{
    from += later;
    const size_t size = u16_at(from + 26);
    return (struct record){.flags = u16_at(from + 6),
                           .method = u16_at(from + 8),
                           .checksum = u32_at(from + 14),
                           .stored = u32_at(from + 18),
                           .size = u32_at(from + 22),
                           .name = {name, size},
                           .extra = {name + size, u16_at(from + 28)}};
}

/* The header before a file, which lies before `end`; sizes and checksum may stand behind the file instead. Gives where
 * the file begins, 0 after a failure. */
static size_t zip_check_header(struct job *job, const uint8_t *data, const struct record *entry, uint64_t end)
{
    bool fits = entry->header_at <= end && end - entry->header_at >= LOCAL_SIZE;
    const uint8_t *header = data + (fits ? entry->header_at : 0);
    if (!fits || u32_at(header) != LOCAL) {
        bad_entry(job, entry->name, "no header where the central directory says");
        return 0;
    }
    size_t names = (size_t)u16_at(header + 26) + u16_at(header + 28);
    uint64_t left = end - entry->header_at - LOCAL_SIZE;
    if (names > left || entry->stored > left - names) {
        bad_entry(job, entry->name, "reaches into the central directory");
        return 0;
    }
    struct record local = read_record(header, 0, (const char *)header + LOCAL_SIZE);
    bool behind = entry->flags & FLAG_SIZES_BEHIND;
    if ((local.flags ^ entry->flags) & (FLAG_ENCRYPTED | FLAG_SIZES_BEHIND) || local.method != entry->method ||
        text_compare(local.name, entry->name) != 0 ||
        (!behind && (!widen(&local) || local.checksum != entry->checksum || local.stored != entry->stored ||
                     local.size != entry->size))) {
        bad_entry(job, entry->name, "its header and the central directory differ");
    }
    return (size_t)entry->header_at + LOCAL_SIZE + names;
}

/* Reads one entry of the directory, which has `rest` left; *place is where the entry's header begins. */
static struct zip_entry read_entry(struct job *job, uint64_t *place, const uint8_t *data, struct text *rest,
                                   uint64_t end)
{
    const uint8_t *from = (const uint8_t *)rest->data;
    bool there = rest->size >= CENTRAL_SIZE && u32_at(from) == CENTRAL;
    size_t whole = there ? CENTRAL_SIZE + (size_t)u16_at(from + 28) + u16_at(from + 30) + u16_at(from + 32) : 0;
    if (!there || whole > rest->size) {
        job_bad(job, "zip: the central directory has fewer files than it says");
        return (struct zip_entry){0};
    }
    struct record record = read_record(from, 2, rest->data + CENTRAL_SIZE);
    record.header_at = u32_at(from + 42);
    bool wide = widen(&record);
    check_kind(job, &record);
    if (!wide) {
        bad_entry(job, record.name, "sizes of ZIP64 are needed, and not there");
    }
    size_t at = zip_check_header(job, data, &record, end);
    *rest = (struct text){rest->data + whole, rest->size - whole};
    *place = record.header_at;
    return (struct zip_entry){
        record.name, at, (size_t)record.stored, record.size, record.checksum, record.method == METHOD_DEFLATE};
}

/* From a file's header to its last byte. */
struct extent {
    uint64_t from, to;
};

static int compare_extents(const void *a, const void *b)
{
    return compare_unsigned(((const struct extent *)a)->from, ((const struct extent *)b)->from);
}

static int compare_entries(const void *a, const void *b)
{
    return text_compare(((const struct zip_entry *)a)->name, ((const struct zip_entry *)b)->name);
}

/* Sorts them, and leaves out folders. */
static void sort_entries(struct job *job, struct zip *zip)
{
    size_t kept = 0;
    order_sort(zip->entries, zip->count, sizeof *zip->entries, compare_entries);
    for (size_t i = 1; i < zip->count; i++) {
        if (compare_entries(&zip->entries[i - 1], &zip->entries[i]) == 0) {
            bad_entry(job, zip->entries[i].name, "there are two of this name");
        }
    }
    for (size_t i = 0; job_ok(job) && i < zip->count; i++) {
        struct text name = zip->entries[i].name;
        if (name.data[name.size - 1] != '/') {
            zip->entries[kept++] = zip->entries[i];
        } else if (zip->entries[i].size) {
            bad_entry(job, name, "a folder with bytes of its own");
        }
    }
    zip->count = job_ok(job) ? kept : 0;
}

static void check_extents(struct job *job, struct extent *extents, size_t count)
{
    order_sort(extents, count, sizeof *extents, compare_extents);
    for (size_t i = 1; i < count; i++) {
        if (extents[i].from < extents[i - 1].to) {
            job_bad(job, "zip: two files share the byte %llu", (unsigned long long)extents[i].from);
        }
    }
}

struct zip zip_parse(struct job *job, const uint8_t *data, size_t size)
{
    const struct directory directory = read_end(job, data, size);
    struct text rest = {(const char *)data + directory.at, (size_t)directory.size};
    struct zip zip = {.data = data, .count = (size_t)directory.count};
    struct extent *extents = job_array(job, &zip.count, sizeof *extents);
    zip.entries = job_array(job, &zip.count, sizeof *zip.entries);
    for (size_t i = 0; i < zip.count && job_ok(job); i++) {
        zip.entries[i] = read_entry(job, &extents[i].from, data, &rest, directory.at);
        extents[i].to = zip.entries[i].at + zip.entries[i].stored;
    }
    if (rest.size) {
        job_bad(job, "zip: %zu bytes behind the last file of the central directory", rest.size);
    }
    if (!job_ok(job)) {
        return (struct zip){.data = data};
    }
    check_extents(job, extents, zip.count);
    sort_entries(job, &zip);
    return zip;
}

static void check_sum(struct job *job, const uint8_t *data, const struct zip_entry *entry)
{
    if (job_step(job) && libdeflate_crc32(0, data, (size_t)entry->size) != entry->checksum) {
        bad_entry(job, entry->name, "damaged: its checksum is another one");
    }
}

void zip_verify(struct job *job, const struct zip *zip, const struct zip_entry *entry)
{
    check_sum(job, zip->data + entry->at, entry);
}

static void inflate_entry(struct job *job, uint8_t *out, const struct zip *zip, const struct zip_entry *entry)
{
    struct libdeflate_decompressor *unpacker = libdeflate_alloc_decompressor();
    size_t used = 0;
    size_t got = 0;
    if (!unpacker) {
        job_fail(job, CONUS_ERROR_MEMORY, "zip: no memory to unpack");
        return;
    }
    bool good = libdeflate_deflate_decompress_ex(unpacker, zip->data + entry->at, entry->stored, out,
                                                 (size_t)entry->size, &used, &got) == LIBDEFLATE_SUCCESS &&
                used == entry->stored && got == entry->size;
    libdeflate_free_decompressor(unpacker);
    if (!good) {
        job_bad(job, "zip: %.*s: damaged, or does not unpack to %llu bytes", TEXT_SHOW(entry->name, SHOWN),
                (unsigned long long)entry->size);
    }
}

struct bytes zip_unpack(struct job *job, const struct zip *zip, const struct zip_entry *entry, uint64_t limit)
{
    if (entry->size > limit) {
        job_fail(job, CONUS_ERROR_MEMORY, "zip: %.*s: %llu bytes, allowed are %llu (--max-memory)",
                 TEXT_SHOW(entry->name, SHOWN), (unsigned long long)entry->size, (unsigned long long)limit);
    }
    struct bytes bytes = {.size = (size_t)entry->size};
    bytes.data = job_array(job, &bytes.size, 1);
    if (bytes.data && entry->is_packed) {
        inflate_entry(job, bytes.data, zip, entry);
    } else if (bytes.data) {
        memcpy(bytes.data, zip->data + entry->at, bytes.size);
    }
    check_sum(job, bytes.data, entry);
    return job_ok(job) ? bytes : (struct bytes){0};
}
