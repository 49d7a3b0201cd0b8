/* SPDX-License-Identifier: BSD-3-Clause */
/* The hash map, with open addressing. */
#include "atlas/labels/label_map.h"

#include "base/memory.h"

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
