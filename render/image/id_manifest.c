/* SPDX-License-Identifier: BSD-3-Clause */
/* Encodes ID manifests. */
#include "render/image/id_manifest.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "base/order.h"

#include <string.h>
#include <zlib.h>

enum {
    LIFETIME_STABLE = 2,
    STORE_U32 = 1,
    STORE_VARINT = 2,
    LONG_TEXT = 255,          /* the text after a longer one counts shared bytes in two bytes */
    SHARED_LIMIT = 65535,     /* the most that two bytes hold */
    SIZE_LIMIT = 1 << 30,     /* readers count in 32 bits */
    VARINT_CLASS_LIMIT = 128, /* the largest rank of one byte, and each further byte makes it 128 times as large */
};

/* A text where it is used: place `slot` of all texts of all groups, one after the other. */
struct use {
    const char *text;
    size_t slot;
};

/* A text, once. */
struct word {
    const char *text;
    uint32_t index; /* in alphabetical order */
    uint32_t uses;
};

struct dictionary {
    struct word *words; /* by rank once it is made */
    size_t count;
    uint32_t *index_of; /* [slots] */
    uint32_t *rank_of;  /* [count] rank of the word with an index */
};

static void put_u32(struct buffer *out, uint32_t value)
{
    const uint8_t bytes[] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16), (uint8_t)(value >> 24)};
    buffer_append(out, bytes, sizeof bytes);
}

static void put_varint(struct buffer *out, uint64_t value)
{
    do {
        uint8_t byte = (uint8_t)((value & 127) | (value > 127 ? 128 : 0));
        buffer_append(out, &byte, 1);
        value >>= 7;
    } while (value);
}

/* Moves `from` to the end of `out`. */
static void take(struct buffer *out, struct buffer *from)
{
    buffer_append(out, from->data, from->size);
    out->failed = out->failed || from->failed;
    buffer_finish(from);
}

static int by_text(const void *a, const void *b)
{
    return strcmp(((const struct use *)a)->text, ((const struct use *)b)->text);
}

static int by_uses(const void *a, const void *b)
{
    return compare_unsigned(((const struct word *)b)->uses, ((const struct word *)a)->uses);
}

static int by_index(const void *a, const void *b)
{
    return compare_unsigned(((const struct word *)a)->index, ((const struct word *)b)->index);
}

/* The most frequent 128 words get numbers of one byte, the next up to 16384 of two, and so on; among those of one
 * length they stay in alphabetical order, which makes long runs. */
static void rank(struct dictionary *dictionary)
{
    struct word *words = dictionary->words;
    order_sort(words, dictionary->count, sizeof *words, by_uses);
    for (size_t start = 0, end = VARINT_CLASS_LIMIT; start < dictionary->count; start = end, end *= 128) {
        size_t last = end < dictionary->count ? end : dictionary->count;
        order_sort(words + start, last - start, sizeof *words, by_index);
    }
    for (size_t i = 0; i < dictionary->count; i++) {
        dictionary->rank_of[words[i].index] = (uint32_t)i;
    }
}

static conus_status dictionary_init(struct dictionary *out, const struct id_manifest_group *groups, size_t group_count)
{
    size_t slots = 0;
    for (size_t g = 0; g < group_count; g++) {
        slots += groups[g].count * groups[g].component_count;
    }
    struct use *uses = memory_raw(slots, sizeof *uses);
    for (size_t g = 0, slot = 0; uses && g < group_count; g++) {
        size_t texts = groups[g].count * groups[g].component_count;
        for (size_t i = 0; i < texts; i++, slot++) {
            uses[slot] = (struct use){groups[g].texts[i], slot};
        }
    }
    if (uses) {
        order_sort(uses, slots, sizeof *uses, by_text);
    }
    *out = (struct dictionary){.words = memory_raw(slots, sizeof *out->words),
                               .index_of = memory_raw(slots, sizeof *out->index_of),
                               .rank_of = memory_raw(slots, sizeof *out->rank_of)};
    if (!uses || !out->words || !out->index_of || !out->rank_of) {
        memory_free(uses);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < slots; i++) {
        if (i == 0 || by_text(&uses[i - 1], &uses[i]) != 0) {
            out->words[out->count] = (struct word){.text = uses[i].text, .index = (uint32_t)out->count};
            out->count++;
        }
        out->words[out->count - 1].uses++;
        out->index_of[uses[i].slot] = (uint32_t)(out->count - 1);
    }
    memory_free(uses);
    return CONUS_OK;
}

/* Words in alphabetical order, lengths first. */
static void put_words(struct buffer *out, const struct dictionary *dictionary)
{
    struct buffer bytes = {0};
    const char *before = NULL;
    put_u32(out, (uint32_t)dictionary->count);
    for (size_t i = 0; i < dictionary->count; i++) {
        const char *text = dictionary->words[i].text;
        size_t shared = 0;
        while (before && shared < SHARED_LIMIT && before[shared] && before[shared] == text[shared]) {
            shared++;
        }
        bool two = before && strlen(before) > LONG_TEXT;
        const uint8_t count[] = {(uint8_t)(shared >> 8), (uint8_t)shared};
        size_t head = before ? 1 + two : 0;
        size_t rest = strlen(text) - shared;
        buffer_append(&bytes, count + (two ? 0 : 1), head);
        buffer_append(&bytes, text + shared, rest);
        put_varint(out, head + rest);
        before = text;
    }
    take(out, &bytes);
}

/* The runs of indices that the ranks make. A run skips words of earlier runs. As in OpenEXR's own encoder, the first
 * run goes on only where it begins with word 0. */
static void put_ranks(struct buffer *out, const struct dictionary *dictionary)
{
    struct buffer runs = {0};
    uint32_t first = dictionary->count ? dictionary->words[0].index : 0;
    uint32_t last = first;
    uint32_t next = 1; /* the index that would lengthen the run */
    for (size_t i = 1; i < dictionary->count; i++) {
        uint32_t index = dictionary->words[i].index;
        if (index != next) {
            put_u32(&runs, first);
            put_u32(&runs, last);
            first = index;
        }
        last = index;
        next = index + 1;
        while (next < dictionary->count && dictionary->rank_of[next] <= i) {
            next++;
        }
    }
    if (dictionary->count) {
        put_u32(&runs, first);
        put_u32(&runs, last);
    }
    put_u32(out, (uint32_t)(runs.size / (2 * sizeof first)));
    take(out, &runs);
}

static void put_pascal(struct buffer *out, const char *text)
{
    put_u32(out, (uint32_t)strlen(text));
    buffer_text(out, text);
}

static void put_strings(struct buffer *out, const char *const *texts, size_t count)
{
    put_u32(out, (uint32_t)count);
    for (size_t i = 0; i < count; i++) {
        put_varint(out, strlen(texts[i]));
    }
    for (size_t i = 0; i < count; i++) {
        buffer_text(out, texts[i]);
    }
}

static void put_group(struct buffer *out, const struct id_manifest_group *group, const struct dictionary *dictionary,
                      size_t slot)
{
    const uint8_t lifetime = LIFETIME_STABLE;
    size_t size = 0; /* of the differences between ids as varints */
    for (size_t i = 0; i < group->count; i++) {
        size++;
        for (uint32_t difference = group->ids[i] - (i ? group->ids[i - 1] : 0); difference > 127; difference >>= 7) {
            size++;
        }
    }
    const uint8_t storage = size < 4 * group->count ? STORE_VARINT : STORE_U32;
    put_strings(out, &group->channel, 1);
    put_strings(out, group->components, group->component_count);
    buffer_append(out, &lifetime, 1);
    put_pascal(out, "none");
    put_pascal(out, "id");
    buffer_append(out, &storage, 1);
    put_u32(out, (uint32_t)group->count);
    for (size_t i = 0; i < group->count; i++) {
        uint32_t difference = group->ids[i] - (i ? group->ids[i - 1] : 0);
        if (storage == STORE_VARINT) {
            put_varint(out, difference);
        } else {
            put_u32(out, difference);
        }
        for (size_t c = 0; c < group->component_count; c++) {
            put_varint(out, dictionary->rank_of[dictionary->index_of[slot++]]);
        }
    }
}

static conus_status deflate_manifest(struct bytes *out, const struct buffer *plain)
{
    if (plain->size > SIZE_LIMIT) {
        return fail(CONUS_ERROR_UNSUPPORTED, "names of %zu bytes for an OpenEXR image, allowed are %d", plain->size,
                    SIZE_LIMIT);
    }
    uLongf size = compressBound(plain->size);
    uint8_t *packed = memory_raw(8 + size, 1);
    if (!packed) {
        return CONUS_ERROR_MEMORY;
    }
    if (compress(packed + 8, &size, (const uint8_t *)plain->data, plain->size) != Z_OK) {
        memory_free(packed);
        return fail(CONUS_ERROR_MEMORY, "no memory to pack the names for an OpenEXR image");
    }
    for (int i = 0; i < 8; i++) {
        packed[i] = (uint8_t)((uint64_t)plain->size >> 8 * i);
    }
    *out = (struct bytes){packed, 8 + size};
    return CONUS_OK;
}

conus_status id_manifest_format(struct bytes *out, const struct id_manifest_group *groups, size_t group_count)
{
    struct dictionary dictionary;
    struct buffer plain = {0};
    conus_status status = dictionary_init(&dictionary, groups, group_count);
    if (!status) {
        size_t slot = 0;
        put_u32(&plain, 0);
        put_words(&plain, &dictionary);
        rank(&dictionary);
        put_ranks(&plain, &dictionary);
        put_u32(&plain, (uint32_t)group_count);
        for (size_t g = 0; g < group_count; g++) {
            put_group(&plain, &groups[g], &dictionary, slot);
            slot += groups[g].count * groups[g].component_count;
        }
        status = buffer_status(&plain);
    }
    status = status ? status : deflate_manifest(out, &plain);
    memory_free(dictionary.words);
    memory_free(dictionary.index_of);
    memory_free(dictionary.rank_of);
    buffer_finish(&plain);
    return status;
}
