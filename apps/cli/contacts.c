/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells contacts of electrodes by their names. */
#include "cli/contacts.h"

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

bool contacts_are_all(const conus_drawn_point *points, size_t count)
{
    enum { EACH = 3 };
    size_t electrodes = 0;
    bool have_numbers = count;
    for (size_t i = 0; i < count && have_numbers; i++) {
        const size_t length = electrode_length(points[i].name);
        bool is_new = true;
        for (size_t k = i; k-- > 0 && is_new;) { /* mostly that of the one before */
            is_new = electrode_length(points[k].name) != length || strncmp(points[k].name, points[i].name, length) != 0;
        }
        have_numbers = length && points[i].name[length];
        electrodes += is_new;
    }
    return have_numbers && EACH * electrodes <= count;
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
