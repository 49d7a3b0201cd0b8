/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries places around a point, the nearest first. */
#include "viewer/window/window.h"

#include <math.h>

static const float gap = 18;   /* pixels between the point and a name beside it */
static const float margin = 4; /* around names: of their shade */

enum { STEPS = 24 };

static bool overlap(const struct ui_box *a, const struct ui_box *b)
{
    return a->x < b->x + b->width + margin && b->x < a->x + a->width + margin && a->y < b->y + b->height + margin &&
           b->y < a->y + a->height + margin;
}

bool labels_leave_free(const struct labels *labels, const struct ui_box *box)
{
    bool is = true;
    for (size_t i = 0; i < labels->count && is; i++) {
        is = !overlap(box, &labels->items[i].box);
    }
    return is;
}

static bool is_free(const struct labels *labels, const struct ui_box *pane, const struct ui_box *box)
{
    return box->x >= pane->x + margin && box->x + box->width <= pane->x + pane->width - margin &&
           box->y >= pane->y + margin && box->y + box->height <= pane->y + pane->height - margin &&
           labels_leave_free(labels, box);
}

static bool add(struct labels *labels, struct ui_box box, uint32_t object)
{
    bool fits = labels->count < LABELS_LIMIT;
    if (fits) {
        labels->items[labels->count++] = (struct placed_name){box, object};
    }
    return fits;
}

void labels_reserve(struct labels *labels, struct ui_box box)
{
    add(labels, box, 0);
}

bool labels_has(const struct labels *labels, uint32_t object)
{
    bool has = false;
    for (size_t i = 0; i < labels->count; i++) {
        has = has || (object && labels->items[i].object == object);
    }
    return has;
}

bool labels_place(struct ui_box *out, struct labels *labels, const struct ui_box *pane, const float at[2],
                  const float size[2], bool above, uint32_t object)
{
    float least = pane->x + margin;
    float most = pane->x + pane->width - margin - size[0];
    const float beside[2] = {at[0] + gap, at[0] - gap - size[0]};
    float middle = fmaxf(fminf(at[0] - size[0] / 2, most), least);
    if (labels_has(labels, object)) {
        return false;
    }
    for (int step = 0; step < STEPS; step++) {
        int rows = (step + 1) / 2; /* below and above by turns */
        float down = (step % 2 ? 0.6F : -0.6F) * (float)rows * size[1];
        for (int column = 0; column < 3; column++) {
            bool centred = column == (above ? 0 : 2);
            float x = centred ? middle : beside[above ? column - 1 : column];
            float y = at[1] + down - (centred ? 1.3F : 0.5F) * size[1];
            struct ui_box box = {x, y, size[0], size[1]};
            bool covers = at[0] > x - margin && at[0] < x + size[0] + margin && at[1] > y - margin &&
                          at[1] < y + size[1] + margin;
            if (!covers && is_free(labels, pane, &box) &&
                (!labels->allows || labels->allows(labels->user, &box, object)) && add(labels, box, object)) {
                *out = box;
                return true;
            }
        }
    }
    return false;
}
