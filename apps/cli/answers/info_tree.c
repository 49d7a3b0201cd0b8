/* SPDX-License-Identifier: BSD-3-Clause */
/* The tree of areas of conus info. */
#include "cli/answers/info_tree.h"

#include <stdlib.h>

/** An area in the tree; number 0 is above all roots. */
struct node {
    size_t first, last, next; /* children from first to last by next; 0 = none */
    size_t below;
    double volume_mm3; /* with what is below */
    bool has_surface;  /* whose volume may be part of another, or none */
};

size_t info_tree_depth(const conus_atlas *atlas)
{
    size_t deepest = 0;
    for (size_t number = 1; number <= conus_atlas_object_count(atlas); number++) {
        size_t depth = conus_atlas_depth(atlas, number);
        deepest = depth > deepest ? depth : deepest;
    }
    return deepest;
}

/* Adds the area's volume to its own node and all above it. */
static void add_volume(struct node *nodes, const conus_atlas *atlas, size_t number)
{
    const conus_object *area = conus_atlas_object(atlas, number);
    for (size_t at = number; at; at = conus_atlas_object(atlas, at)->parent) {
        nodes[at].volume_mm3 += area->volume_mm3;
        nodes[at].has_surface = nodes[at].has_surface || area->triangles;
        nodes[at].below += at != number;
    }
}

static void link_areas(struct node *nodes, const conus_atlas *atlas)
{
    const conus_object *object;
    for (size_t number = 1; (object = conus_atlas_object(atlas, number)) && object->kind == CONUS_KIND_AREA; number++) {
        struct node *parent = &nodes[object->parent];
        if (parent->last) {
            nodes[parent->last].next = number;
        } else {
            parent->first = number;
        }
        parent->last = number;
        add_volume(nodes, atlas, number);
    }
}

/* `inset` is how many areas are above it. */
static void put_area(FILE *out, const conus_atlas *atlas, const struct node *node, size_t number, size_t inset)
{
    const conus_object *area = conus_atlas_object(atlas, number);
    char volume[32] = "n/a";
    if (!node->has_surface) {
        snprintf(volume, sizeof volume, "%.9g", node->volume_mm3);
    }
    fprintf(out, "%5u  %10u  %5zu  %12s  %*s%s%s%s%s\n", conus_atlas_depth(atlas, number), area->label, node->below,
            volume, (int)(2 * inset), "", area->name, *area->abbreviation ? " (" : "", area->abbreviation,
            *area->abbreviation ? ")" : "");
}

/* The area after `number` in the tree, as it is read from top to bottom; 0 after the last. */
static size_t next_area(const struct node *nodes, const conus_atlas *atlas, size_t number, size_t *inset)
{
    if (nodes[number].first) {
        ++*inset;
        return nodes[number].first;
    }
    while (number && !nodes[number].next) {
        number = conus_atlas_object(atlas, number)->parent;
        --*inset;
    }
    return number ? nodes[number].next : 0;
}

bool info_tree(FILE *out, const conus_atlas *atlas)
{
    struct node *nodes = calloc(conus_atlas_object_count(atlas) + 1, sizeof *nodes);
    size_t inset = 0;
    if (!nodes) {
        return false;
    }
    link_areas(nodes, atlas);
    fprintf(out, "%5s  %10s  %5s  %12s  %s\n", "depth", "label", "below", "volume_mm3", "name (abbreviation)");
    for (size_t number = nodes[0].first; number; number = next_area(nodes, atlas, number, &inset)) {
        put_area(out, atlas, &nodes[number], number, inset);
    }
    free(nodes);
    return true;
}
