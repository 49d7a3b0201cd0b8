/* SPDX-License-Identifier: BSD-3-Clause */
/* Which areas are left and right of one, by their names, and the labels and names of what is made of them. */
#include "atlas/areas/pairs.h"

#include "atlas/areas/sides.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { LARGEST_LABEL = 999999999 };

/** Areas by name. */
struct name_index {
    const conus_object **areas; /* [count], sorted by name */
    size_t count;
};

struct pairing {
    const conus_atlas *atlas;
    struct name_index index;
    uint32_t *right_of; /* [area_count + 1] of left areas */
    uint32_t *claims;   /* [area_count + 1] how many left areas take it as their right one */
};

static int by_name(const void *a, const void *b)
{
    const conus_object *x = *(const conus_object *const *)a;
    const conus_object *y = *(const conus_object *const *)b;
    return strcmp(x->name, y->name);
}

static conus_status index_names(struct name_index *out, const conus_atlas *atlas)
{
    out->areas = memory_raw(atlas->area_count, sizeof(void *));
    if (!out->areas) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->area_count; i++) {
        out->areas[i] = &atlas->objects[i];
    }
    out->count = atlas->area_count;
    qsort(out->areas, out->count, sizeof(void *), by_name);
    return CONUS_OK;
}

/* The first of the areas called `name`, and how many there are. */
static size_t find_name(size_t *first, const struct name_index *index, const char *name)
{
    size_t low = 0;
    size_t high = index->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strcmp(index->areas[middle]->name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    *first = low;
    while (high < index->count && strcmp(index->areas[high]->name, name) == 0) {
        high++;
    }
    return high - low;
}

static uint32_t number_of(const conus_atlas *atlas, const conus_object *area)
{
    return (uint32_t)(area - atlas->objects) + 1;
}

static bool may_be(const conus_object *area, char side)
{
    return !area->hemisphere || area->hemisphere == side;
}

/* By a word for the side in the name. Where several words would do there is no knowing. */
static conus_status pair_by_word(struct pairing *pairing, uint32_t left)
{
    struct text name = text_from(pairing->atlas->objects[left - 1].name);
    struct side_word word;
    size_t found = 0;
    conus_status status = CONUS_OK;
    for (size_t from = 0; !status && side_word_find(&word, name, from); from = word.start + word.size) {
        struct buffer swapped = {0};
        if (word.side == 'L') {
            side_word_swap(&swapped, name, &word);
            status = buffer_status(&swapped);
        }
        if (!status && word.side == 'L') {
            size_t first = 0;
            if (find_name(&first, &pairing->index, swapped.data) == 1 && may_be(pairing->index.areas[first], 'R')) {
                pairing->right_of[left] = number_of(pairing->atlas, pairing->index.areas[first]);
                ++found;
            }
        }
        buffer_finish(&swapped);
    }
    pairing->right_of[left] = found == 1 ? pairing->right_of[left] : 0;
    return status;
}

static conus_status propose_pairs(struct pairing *pairing)
{
    conus_status status = CONUS_OK;
    const struct name_index *index = &pairing->index;
    for (size_t first = 0, count; !status && first < index->count; first += count) {
        size_t same;
        const conus_object *area = index->areas[first];
        count = find_name(&same, index, area->name);
        if (count == 2) {
            const conus_object *a = pairing->index.areas[first];
            const conus_object *b = pairing->index.areas[first + 1];
            const conus_object *left = a->hemisphere == 'L' ? a : b;
            const conus_object *right = a->hemisphere == 'L' ? b : a;
            if (left->hemisphere == 'L' && right->hemisphere == 'R') {
                pairing->right_of[number_of(pairing->atlas, left)] = number_of(pairing->atlas, right);
            }
        } else if (count == 1 && may_be(area, 'L')) {
            status = pair_by_word(pairing, number_of(pairing->atlas, area));
        }
    }
    return status;
}

/* Keeps proposals in which neither has a part in another. */
static void settle_claims(struct pairing *pairing)
{
    size_t count = pairing->atlas->area_count;
    uint32_t *right_of = pairing->right_of;
    for (uint32_t left = 1; left <= count; left++) {
        pairing->claims[right_of[left]]++;
        pairing->claims[left] += right_of[left] != 0;
    }
    for (uint32_t left = 1; left <= count; left++) {
        uint32_t right = right_of[left];
        if (right && (pairing->claims[right] > 1 || pairing->claims[left] > 1)) {
            right_of[left] = 0;
        }
    }
}

/* Whether their parents are the same area, or a pair whose parents are, and so on. */
static bool have_same_place(const struct pairing *pairing, uint32_t left, uint32_t right)
{
    const conus_object *objects = pairing->atlas->objects;
    do {
        left = objects[left - 1].parent;
        right = objects[right - 1].parent;
    } while (left != right && left && right && pairing->right_of[left] == right);
    return left == right;
}

static conus_status check_places(struct pairing *pairing)
{
    size_t count = pairing->atlas->area_count;
    bool *kept = memory_zeroed(count + 1, sizeof *kept);
    if (!kept) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t left = 1; left <= count; left++) {
        uint32_t right = pairing->right_of[left];
        kept[left] = right && have_same_place(pairing, left, right);
    }
    for (uint32_t left = 1; left <= count; left++) {
        pairing->right_of[left] = kept[left] ? pairing->right_of[left] : 0;
    }
    memory_free(kept);
    return CONUS_OK;
}

conus_status hemispheres_pair(uint32_t **out, const conus_atlas *atlas)
{
    struct pairing pairing = {.atlas = atlas};
    pairing.right_of = memory_zeroed(atlas->area_count + 1, sizeof *pairing.right_of);
    pairing.claims = memory_zeroed(atlas->area_count + 1, sizeof *pairing.claims);
    conus_status status = pairing.right_of && pairing.claims ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : index_names(&pairing.index, atlas);
    status = status ? status : propose_pairs(&pairing);
    if (!status) {
        settle_claims(&pairing);
        status = check_places(&pairing);
    }
    memory_free(pairing.index.areas);
    memory_free(pairing.claims);
    if (status) {
        memory_free(pairing.right_of);
        return status;
    }
    *out = pairing.right_of;
    return CONUS_OK;
}

conus_status hemispheres_label_step(uint32_t *out, const conus_atlas *atlas)
{
    uint32_t largest = 0;
    uint32_t step = 1;
    for (size_t i = 0; i < atlas->area_count; i++) {
        largest = atlas->objects[i].label > largest ? atlas->objects[i].label : largest;
    }
    if (largest > LARGEST_LABEL) {
        return fail(CONUS_ERROR_UNSUPPORTED, "label %u is too large to number new areas, allowed are labels up to %d",
                    largest, LARGEST_LABEL);
    }
    while (step <= largest) {
        step *= 10;
    }
    *out = step;
    return CONUS_OK;
}

void hemispheres_common_name(struct buffer *out, const char *left, const char *right)
{
    struct text name = text_from(left);
    struct side_word word;
    if (strcmp(left, right) == 0) {
        buffer_text(out, left);
        return;
    }
    for (size_t from = 0; side_word_find(&word, name, from); from = word.start + word.size) {
        struct buffer swapped = {0};
        side_word_swap(&swapped, name, &word);
        bool found = swapped.data && strcmp(swapped.data, right) == 0;
        out->failed = out->failed || swapped.failed;
        buffer_finish(&swapped);
        if (found) {
            side_word_drop(out, name, &word);
            return;
        }
    }
}
