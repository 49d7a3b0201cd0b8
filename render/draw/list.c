/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of what is drawn in 2-D. */
#include "render/draw/draw.h"

#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <string.h>

conus_status draw_list_create(struct draw_list **out, uint32_t width, uint32_t height)
{
    struct draw_list *list = memory_zeroed(1, sizeof *list);
    if (!list) {
        return CONUS_ERROR_MEMORY;
    }
    list->width = width;
    list->height = height;
    *out = list;
    return CONUS_OK;
}

static void item_finish(struct draw_item *item)
{
    memory_free(item->text);
    memory_free(item->points);
}

void draw_list_destroy(struct draw_list *list)
{
    for (size_t i = 0; list && i < list->count; i++) {
        item_finish(&list->items[i]);
    }
    if (list) {
        memory_free(list->items);
    }
    memory_free(list);
}

void draw_colour(float rgba[4], const uint8_t rgb[3], float opacity)
{
    for (int c = 0; c < 3; c++) {
        rgba[c] = (float)linear_from_srgb(rgb[c] / 255.0);
    }
    rgba[3] = opacity;
}

void draw_item(struct draw_list *list, const struct draw_item *item)
{
    struct draw_item copy = *item;
    for (size_t k = 0; k < item->count; k++) {
        if (!isfinite(item->points[k][0]) || !isfinite(item->points[k][1])) {
            return;
        }
    }
    copy.text = item->text ? text_to_utf8(text_from(item->text)) : NULL;
    copy.points = memory_copy(item->points, item->count, sizeof *item->points);
    if ((item->text && !copy.text) || !copy.points ||
        !memory_reserve(&list->items, &list->capacity, list->count + 1, sizeof *list->items)) {
        item_finish(&copy);
        list->failed = true;
        return;
    }
    list->items[list->count++] = copy;
}

void draw_line(struct draw_list *list, const double from[2], const double to[2], double width, const float rgba[4])
{
    double points[2][2] = {{from[0], from[1]}, {to[0], to[1]}};
    struct draw_item item = {.kind = DRAW_LINES, .width = width, .points = points, .count = 2};
    memcpy(item.rgba, rgba, sizeof item.rgba);
    draw_item(list, &item);
}

void draw_box(struct draw_list *list, const struct draw_box *box, double rounding, const float rgba[4])
{
    draw_frame(list, box, rounding, 0, rgba);
}

void draw_frame(struct draw_list *list, const struct draw_box *box, double rounding, double width, const float rgba[4])
{
    double points[2][2] = {{box->left, box->top}, {box->right, box->bottom}};
    struct draw_item item = {.kind = DRAW_BOX, .width = width, .rounding = rounding, .points = points, .count = 2};
    memcpy(item.rgba, rgba, sizeof item.rgba);
    draw_item(list, &item);
}

void draw_take(struct draw_list *to, struct draw_list *from, const double by[2])
{
    to->failed = to->failed || from->failed;
    if (!memory_reserve(&to->items, &to->capacity, to->count + from->count, sizeof *to->items)) {
        to->failed = true;
        return;
    }
    for (size_t i = 0; i < from->count; i++) {
        struct draw_item *item = &to->items[to->count++];
        *item = from->items[i];
        for (size_t k = 0; k < item->count; k++) {
            item->points[k][0] += by[0];
            item->points[k][1] += by[1];
        }
    }
    from->count = 0;
}
