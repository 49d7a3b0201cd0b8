/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells contacts of electrodes by their names. */
#include "cli/contacts.h"

#include "base/order.h"
#include "base/text.h"

#include <stdlib.h>
#include <string.h>

/* The length of a name without the number at its end, and what is between them. */
static size_t electrode_length(const char *name)
{
    size_t length = strlen(name);
    while (length && name[length - 1] >= '0' && name[length - 1] <= '9') {
        length--;
    }
    while (length && strchr(" -_.", name[length - 1])) {
        length--;
    }
    return length;
}

struct electrode {
    const char *name;
    size_t length;
};

static int compare_electrodes(const void *a, const void *b)
{
    const struct electrode *one = a;
    const struct electrode *other = b;
    const int order = strncmp(one->name, other->name, one->length < other->length ? one->length : other->length);
    return order || one->length == other->length ? order : one->length < other->length ? -1 : 1;
}

bool contacts_are_all(bool *out, const conus_drawn_point *points, size_t count)
{
    enum { EACH = 3 };
    size_t electrodes = 0;
    bool have_numbers = count;
    struct electrode *all = calloc(count + 1, sizeof *all);
    for (size_t i = 0; all && i < count && have_numbers; i++) {
        all[i] = (struct electrode){points[i].name, electrode_length(points[i].name)};
        have_numbers = all[i].length && all[i].name[all[i].length];
    }
    if (all && have_numbers) {
        order_sort(all, count, sizeof *all, compare_electrodes);
        for (size_t i = 0; i < count; i++) {
            electrodes += !i || compare_electrodes(&all[i - 1], &all[i]);
        }
    }
    *out = have_numbers && EACH * electrodes <= count;
    free(all);
    return all;
}

bool contacts_group(conus_drawn_point *points, size_t count)
{
    bool whole = true;
    for (size_t i = 0; i < count; i++) {
        points[i].group = text_copy(points[i].name, electrode_length(points[i].name));
        whole = whole && points[i].group;
    }
    return whole;
}

void contacts_ungroup(conus_drawn_point *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        free((char *)points[i].group);
    }
}
