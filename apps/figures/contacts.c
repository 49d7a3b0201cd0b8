/* SPDX-License-Identifier: BSD-3-Clause */
/* Rows of a list as points of a picture; contacts of electrodes are recognised by their names. */
#include "figures/figure.h"

#include "base/order.h"
#include "base/text.h"
#include "conus/study.h"

#include <math.h>
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

/* Whether all names are those of contacts; false without memory. */
static bool are_all(bool *out, const conus_drawn_point *points, size_t count)
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

bool contacts_group(bool *grouped, conus_drawn_point *points, size_t count)
{
    bool whole = are_all(grouped, points, count);
    for (size_t i = 0; i < count && whole && *grouped; i++) {
        points[i].group = text_copy(points[i].name, electrode_length(points[i].name));
        whole = points[i].group;
    }
    return whole;
}

void contacts_ungroup(conus_drawn_point *points, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        free((char *)points[i].group);
    }
}

conus_status contacts_place(conus_drawn_point *out, const conus_pose_row *row, double radius, conus_selector *selector)
{
    const double *m = row->pose.world_from_device;
    static const char *const entry[] = {"entry_x", "entry_y", "entry_z"};
    conus_table *segments = NULL;
    *out = (conus_drawn_point){.name = row->id,
                               .group = row->kept ? row->kept[0] : NULL,
                               .at = {m[12], m[13], m[14]},
                               .end = {NAN, NAN, NAN},
                               .radius = isnan(row->radius) ? radius : row->radius};
    for (int k = 0; k < 3 && isfinite(row->range[1]); k++) { /* an axis that ends: a needle, all of it */
        out->end[k] = m[12 + k] - row->range[1] * m[8 + k];
    }
    if (row->is_point || !isnan(out->end[0])) {
        return CONUS_OK;
    }
    conus_status status = conus_selector_set_range(selector, row->range);
    status = status ? status : conus_segments(&segments, selector, &row->pose);
    for (size_t i = 0; i < conus_table_rows(segments) && isnan(out->end[0]); i++) {
        for (int k = 0; k < 3 && conus_table_objects(segments)[i]; k++) {
            out->end[k] = conus_table_numbers(segments, entry[k])[i];
        }
    }
    out->hollow = isnan(out->end[0]);
    conus_table_destroy(segments);
    return status;
}
