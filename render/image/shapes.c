/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of shapes. */
#include "render/image/shapes.h"

#include "base/memory.h"
#include "base/text.h"

#include <string.h>

void shapes_add(struct shapes *shapes, const struct image_shape *shape)
{
    struct image_shape copy = *shape;
    copy.text = shape->text ? text_to_utf8(text_from(shape->text)) : NULL;
    copy.points = shape->points ? memory_copy(shape->points, shape->point_count, sizeof *shape->points) : NULL;
    bool has_all = (!shape->text || copy.text) && (!shape->points || copy.points);
    if (!has_all || !memory_reserve(&shapes->items, &shapes->capacity, shapes->count + 1, sizeof *shapes->items)) {
        memory_free(copy.text);
        memory_free(copy.points);
        shapes->failed = true;
        return;
    }
    shapes->items[shapes->count++] = copy;
}

void shapes_take(struct shapes *to, struct shapes *from, const double by[2])
{
    to->failed = to->failed || from->failed;
    memcpy(to->family, from->family, sizeof to->family);
    if (!memory_reserve(&to->items, &to->capacity, to->count + from->count, sizeof *to->items)) {
        to->failed = true;
        return;
    }
    for (size_t i = 0; i < from->count; i++) {
        struct image_shape *shape = &to->items[to->count++];
        *shape = from->items[i];
        for (int a = 0; a < 2; a++) {
            shape->from[a] += by[a];
            shape->to[a] += by[a];
            for (size_t k = 0; k < shape->point_count; k++) {
                shape->points[k][a] += by[a];
            }
        }
    }
    from->count = 0;
}

void shapes_destroy(struct shapes *shapes)
{
    for (size_t i = 0; shapes && i < shapes->count; i++) {
        memory_free(shapes->items[i].text);
        memory_free(shapes->items[i].points);
    }
    if (shapes) {
        memory_free(shapes->items);
    }
    memory_free(shapes);
}
