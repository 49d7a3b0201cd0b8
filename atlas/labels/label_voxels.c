/* SPDX-License-Identifier: BSD-3-Clause */
/* Stores the labels of voxels as places in a list of labels. */
#include "atlas/labels/labels.h"

#include "base/memory.h"

#include <string.h>

void label_map_finish(struct label_map *map)
{
    memory_free(map->slots);
    *map = (struct label_map){0};
}

/* The slot that holds `label` or the free one where it belongs (Fibonacci hashing, Knuth TAOCP 6.4). */
static struct label_map_slot *find_slot(struct label_map_slot *slots, size_t mask, uint32_t label)
{
    size_t at = (label * UINT64_C(0x9e3779b97f4a7c15)) >> 32 & mask;
    while (slots[at].used && slots[at].label != label) {
        at = (at + 1) & mask;
    }
    return &slots[at];
}

static bool grow_slots(struct label_map *map)
{
    size_t mask = map->slots ? 2 * map->mask + 1 : 255;
    struct label_map_slot *slots = memory_zeroed(mask + 1, sizeof *slots);
    if (!slots) {
        return false;
    }
    for (size_t i = 0; map->slots && i <= map->mask; i++) {
        if (map->slots[i].used) {
            *find_slot(slots, mask, map->slots[i].label) = map->slots[i];
        }
    }
    memory_free(map->slots);
    map->slots = slots;
    map->mask = mask;
    return true;
}

uint64_t *label_map_at(struct label_map *map, uint32_t label)
{
    if (2 * (map->count + 1) > map->mask && !grow_slots(map)) {
        return NULL;
    }
    struct label_map_slot *slot = find_slot(map->slots, map->mask, label);
    if (!slot->used) {
        *slot = (struct label_map_slot){.label = label, .used = true};
        map->count++;
    }
    return &slot->value;
}

enum { NARROW = sizeof(uint16_t), WIDE = sizeof(uint32_t) };

/* Voxels that are looked at side by side: neighbours mostly have one label. */
enum { TOGETHER = 16 };
typedef uint16_t eight_places __attribute__((vector_size(16), aligned(2), may_alias));
typedef uint32_t four_labels __attribute__((vector_size(16), aligned(4), may_alias));
typedef uint64_t bits __attribute__((vector_size(16)));

static bool is_zero(bits all)
{
    return !(all[0] | all[1]);
}

static bool all_are_place(const uint16_t *places, uint16_t place)
{
    const eight_places *at = (const void *)places;
    return is_zero((bits)((at[0] ^ place) | (at[1] ^ place)));
}

static bool all_are_label(const uint32_t *labels, uint32_t label)
{
    const four_labels *at = (const void *)labels;
    return is_zero((bits)((at[0] ^ label) | (at[1] ^ label) | (at[2] ^ label) | (at[3] ^ label)));
}

static void set_places(uint16_t *places, uint16_t place)
{
    eight_places *at = (void *)places;
    at[0] = (eight_places){0} + place;
    at[1] = (eight_places){0} + place;
}

void label_voxels_finish(struct label_voxels *voxels)
{
    memory_free(voxels->narrow);
    memory_free(voxels->wide);
    memory_free(voxels->labels);
    memory_free(voxels->counts);
    memory_free(voxels->filled);
    *voxels = (struct label_voxels){0};
}

static uint32_t place_at(const struct label_voxels *voxels, size_t voxel)
{
    return voxels->narrow ? voxels->narrow[voxel] : voxels->wide[voxel];
}

/* The voxel moves from one place to another. */
static void move_voxel(struct label_voxels *voxels, size_t voxel, uint32_t place)
{
    voxels->counts[place_at(voxels, voxel)]--;
    voxels->counts[place]++;
    voxels->filled[voxel / LABEL_BLOCK] |= place != 0;
    if (voxels->narrow) {
        voxels->narrow[voxel] = (uint16_t)place;
    } else {
        voxels->wide[voxel] = place;
    }
}

void label_voxels_get(uint32_t *out, const struct label_voxels *voxels, size_t first, size_t count)
{
    for (size_t i = 0; voxels->narrow && i < count; i++) {
        out[i] = voxels->labels[voxels->narrow[first + i]];
    }
    for (size_t i = 0; voxels->wide && i < count; i++) {
        out[i] = voxels->labels[voxels->wide[first + i]];
    }
}

void label_voxels_clear(struct label_voxels *voxels, size_t voxel)
{
    move_voxel(voxels, voxel, 0);
}

conus_status label_voxels_tally(struct label_map *out, const struct label_voxels *voxels)
{
    for (size_t p = 1; p < voxels->label_count; p++) {
        if (voxels->labels[p] && voxels->counts[p]) {
            uint64_t *count = label_map_at(out, voxels->labels[p]);
            if (!count) {
                return CONUS_ERROR_MEMORY;
            }
            *count += voxels->counts[p];
        }
    }
    return CONUS_OK;
}

/* Widens the first `count` numbers from 2 to 4 bytes, in the same memory or elsewhere. */
static void widen_places(uint8_t *to, const uint8_t *from, size_t count)
{
    for (size_t i = count; i-- > 0;) {
        uint16_t narrow;
        memcpy(&narrow, from + i * NARROW, NARROW);
        uint32_t wide = narrow;
        memcpy(to + i * WIDE, &wide, WIDE);
    }
}

static conus_status make_wide(struct label_voxels *voxels)
{
    if (voxels->wide) {
        return CONUS_OK;
    }
    uint32_t *wide = memory_resize(voxels->narrow, voxels->count, sizeof *wide);
    if (!wide) {
        return CONUS_ERROR_MEMORY;
    }
    widen_places((uint8_t *)wide, (uint8_t *)wide, voxels->count);
    voxels->wide = wide;
    voxels->narrow = NULL;
    return CONUS_OK;
}

conus_status label_voxels_merge(struct label_voxels *to, const struct label_voxels *from)
{
    size_t shift = to->label_count - 1; /* of a place: label 0 is there once */
    size_t count = shift + from->label_count;
    uint32_t *labels = memory_resize(to->labels, count, sizeof *labels);
    if (!labels) {
        return CONUS_ERROR_MEMORY;
    }
    to->labels = labels;
    uint64_t *counts = memory_resize(to->counts, count, sizeof *counts);
    if (!counts) {
        return CONUS_ERROR_MEMORY;
    }
    to->counts = counts;
    if (count > UINT16_MAX + (size_t)1 && make_wide(to)) {
        return CONUS_ERROR_MEMORY;
    }
    memcpy(labels + to->label_count, from->labels + 1, (from->label_count - 1) * sizeof *labels);
    memset(counts + to->label_count, 0, (from->label_count - 1) * sizeof *counts);
    to->label_count = count;
    for (size_t i = 0; i < to->count; i++) {
        uint32_t place = place_at(from, i);
        if (place && !labels[place_at(to, i)]) {
            move_voxel(to, i, place + (uint32_t)shift);
        }
    }
    return CONUS_OK;
}

static void renumber_narrow(uint16_t *places, const uint32_t *numbers, size_t count)
{
    uint16_t last = 0;
    for (size_t i = 0, end; i < count; i = end) {
        end = count - i < TOGETHER ? count : i + TOGETHER;
        if (end == i + TOGETHER && all_are_place(places + i, last)) {
            if (numbers[last] != last) {
                set_places(places + i, (uint16_t)numbers[last]);
            }
            continue;
        }
        last = places[end - 1];
        for (size_t k = i; k < end; k++) {
            places[k] = (uint16_t)numbers[places[k]];
        }
    }
}

static void renumber_wide(uint32_t *places, const uint32_t *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        places[i] = numbers[places[i]];
    }
}

conus_status label_voxels_renumber(struct label_voxels *voxels, const uint32_t *numbers, bool narrow)
{
    conus_status status = narrow ? CONUS_OK : make_wide(voxels);
    if (status) {
        return status;
    }
    for (size_t from = 0; from < voxels->count; from += LABEL_BLOCK) {
        size_t count = voxels->count - from < LABEL_BLOCK ? voxels->count - from : LABEL_BLOCK;
        if (voxels->filled[from / LABEL_BLOCK] && voxels->narrow) { /* what was never written to stays so */
            renumber_narrow(voxels->narrow + from, numbers, count);
        } else if (voxels->filled[from / LABEL_BLOCK]) {
            renumber_wide(voxels->wide + from, numbers, count);
        }
    }
    if (narrow && voxels->wide) {
        uint8_t *memory = (uint8_t *)voxels->wide;
        for (size_t i = 0; i < voxels->count; i++) {
            uint32_t number;
            memcpy(&number, memory + i * WIDE, WIDE);
            uint16_t less = (uint16_t)number;
            memcpy(memory + i * NARROW, &less, NARROW);
        }
        uint8_t *shorter = memory_resize(memory, voxels->count, NARROW);
        voxels->narrow = (void *)(shorter ? shorter : memory);
        voxels->wide = NULL;
    }
    return CONUS_OK;
}

conus_status label_voxels_of(struct label_voxels *out, const uint32_t *labels, size_t count)
{
    struct label_coder coder;
    conus_status status = label_coder_init(&coder, count, 0, NULL, 0);
    status = status ? status : label_coder_add(&coder, labels, count);
    if (!status) {
        label_coder_end(out, &coder);
    }
    label_coder_finish(&coder);
    return status;
}

void label_coder_finish(struct label_coder *coder)
{
    memory_free(coder->memory);
    memory_free(coder->earlier);
    memory_free(coder->voxels.labels);
    memory_free(coder->voxels.counts);
    memory_free(coder->voxels.filled);
    label_map_finish(&coder->place_of);
    *coder = (struct label_coder){0};
}

/* The memory of all voxels, `each` bytes, and of `labels` different labels but 0. */
static conus_status check_limit(const struct label_coder *coder, size_t each, size_t labels)
{
    size_t size;
    unsigned long long limit = coder->limit;
    if (!memory_multiply(coder->voxels.count, each, &size) || (limit && size > limit)) {
        return fail(CONUS_ERROR_MEMORY,
                    "labels: found %zu voxels, which take %zu bytes each, allowed are %llu bytes (--max-memory)",
                    coder->voxels.count, each, limit);
    }
    return !limit || labels <= (limit - size) / LABEL_BYTES
               ? CONUS_OK
               : fail(
                     CONUS_ERROR_MEMORY,
                     "labels: found %zu different ones, which take %d bytes each, and %zu voxels with %zu, allowed are "
                     "%llu bytes (--max-memory)",
                     labels, LABEL_BYTES, coder->voxels.count, each, limit);
}

/* Appends to the list. */
static conus_status append_label(struct label_coder *coder, uint32_t label)
{
    struct label_voxels *voxels = &coder->voxels;
    if (voxels->label_count == LABEL_VOXELS_LIMIT) {
        return fail(CONUS_ERROR_DATA,
                    "labels: found more than %d different ones, as only images have; --context draws an image",
                    LABEL_VOXELS_LIMIT);
    }
    if (check_limit(coder, voxels->wide ? WIDE : NARROW, voxels->label_count)) {
        return CONUS_ERROR_MEMORY;
    }
    size_t count = voxels->label_count + 1;
    if (!memory_reserve(&voxels->labels, &coder->label_capacity, count, sizeof *voxels->labels) ||
        !memory_reserve(&voxels->counts, &coder->count_capacity, count, sizeof *voxels->counts)) {
        return CONUS_ERROR_MEMORY;
    }
    voxels->counts[voxels->label_count] = 0;
    voxels->labels[voxels->label_count++] = label;
    return CONUS_OK;
}

conus_status label_coder_init(struct label_coder *coder, size_t count, uint64_t limit, uint8_t *memory, size_t size)
{
    *coder =
        (struct label_coder){.voxels.count = count, .memory = memory, .size = size, .is_own = !memory, .limit = limit};
    conus_status status = check_limit(coder, NARROW, 0);
    if (!status && !memory) {
        coder->memory = memory_zeroed(count, NARROW);
        coder->size = count * NARROW;
    }
    coder->voxels.filled = status ? NULL : memory_zeroed(count / LABEL_BLOCK + 1, 1);
    status = status || (coder->memory && coder->voxels.filled) ? status : CONUS_ERROR_MEMORY;
    return status ? status : append_label(coder, 0);
}

/* Changes to wider places: 2 bytes are too few now. */
static conus_status widen_coder(struct label_coder *coder)
{
    bool in_place = coder->size / WIDE >= coder->voxels.count;
    conus_status status = check_limit(coder, WIDE, coder->voxels.label_count - 1);
    uint8_t *wide = status ? NULL : in_place ? coder->memory : memory_raw(coder->voxels.count, WIDE);
    if (!wide) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    widen_places(wide, coder->memory, coder->is_own ? coder->voxels.count : coder->done);
    coder->earlier = in_place ? NULL : coder->memory;
    coder->memory = wide;
    coder->size = in_place ? coder->size : coder->voxels.count * WIDE;
    coder->voxels.wide = (void *)wide;
    return CONUS_OK;
}

/* The place of a label, which is appended if it is new. */
static conus_status find_place(uint32_t *place, struct label_coder *coder, uint32_t label)
{
    uint64_t *found = label ? label_map_at(&coder->place_of, label) : NULL;
    conus_status status = found || !label ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (found && !*found) {
        *found = coder->voxels.label_count;
        status = append_label(coder, label);
    }
    *place = found ? (uint32_t)*found : 0;
    return status || *place <= UINT16_MAX || coder->voxels.wide ? status : widen_coder(coder);
}

static void write_run(struct label_coder *coder, uint32_t place, size_t count)
{
    size_t from = coder->done;
    coder->done += count;
    coder->voxels.counts[place] += count;
    if (!place && coder->is_own) {
        return; /* they are there */
    }
    for (size_t block = from / LABEL_BLOCK; place && block * LABEL_BLOCK < coder->done; block++) {
        coder->voxels.filled[block] = 1;
    }
    if (coder->voxels.wide) {
        for (size_t i = from; i < coder->done; i++) {
            coder->voxels.wide[i] = place;
        }
        return;
    }
    uint16_t *narrow = (void *)coder->memory;
    for (size_t i = from; i < coder->done; i++) {
        narrow[i] = (uint16_t)place;
    }
}

/* How many labels from the first on are like it: side by side first. */
static size_t count_run(const uint32_t *labels, size_t count)
{
    size_t run = 0;
    while (count - run >= TOGETHER && all_are_label(labels + run, labels[0])) {
        run += TOGETHER;
    }
    while (run < count && labels[run] == labels[0]) {
        run++;
    }
    return run;
}

conus_status label_coder_add(struct label_coder *coder, const uint32_t *labels, size_t count)
{
    conus_status status = CONUS_OK;
    for (size_t start = 0, run; !status && start < count; start += run) {
        run = count_run(labels + start, count - start);
        if (labels[start] != coder->last) {
            status = find_place(&coder->last_place, coder, labels[start]);
            coder->last = labels[start];
        }
        if (!status) {
            write_run(coder, coder->last_place, run);
        }
    }
    return status;
}

conus_status label_coder_put(struct label_coder *coder, size_t first, const uint32_t *labels, size_t count)
{
    coder->done = first;
    return label_coder_add(coder, labels, count);
}

/* Counts the voxels that never came, and finds the range of the labels. */
static void end_counts(struct label_coder *coder)
{
    struct label_voxels *voxels = &coder->voxels;
    uint64_t others = 0;
    coder->minimum = UINT32_MAX;
    for (size_t p = 1; p < voxels->label_count; p++) {
        uint32_t label = voxels->labels[p];
        others += voxels->counts[p];
        coder->minimum = label < coder->minimum ? label : coder->minimum;
        coder->maximum = label > coder->maximum ? label : coder->maximum;
    }
    voxels->counts[0] = voxels->count - others;
    coder->minimum = voxels->counts[0] ? 0 : coder->minimum;
}

void label_coder_end(struct label_voxels *out, struct label_coder *coder)
{
    end_counts(coder);
    size_t each = coder->voxels.wide ? WIDE : NARROW;
    uint8_t *less =
        coder->size > coder->voxels.count * each ? memory_resize(coder->memory, coder->voxels.count, each) : NULL;
    void *memory = less ? less : coder->memory;
    coder->memory = NULL;
    *out = coder->voxels;
    out->narrow = out->wide ? NULL : memory;
    out->wide = out->wide ? memory : NULL;
    coder->voxels = (struct label_voxels){0};
}
