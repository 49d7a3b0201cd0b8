/* SPDX-License-Identifier: BSD-3-Clause */
/* Follows the axis of a device through all objects, and fills the gaps between them (Eq. 17). */
#include "selection/study/study.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"
#include "selection/selection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Any angle has the axis for the ray of its only pixel. */
static const struct cone AXIS = {.angle = 1, .resolution = 1};

enum { CONTACT_LIMIT = 65536 };

conus_status contacts_check(const conus_contacts *contacts)
{
    return !contacts->count || (contacts->count <= CONTACT_LIMIT && contacts->columns && contacts->pitch > 0 &&
                                isfinite(contacts->pitch) && contacts->tip >= 0 && isfinite(contacts->tip))
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT,
                      "contacts: %u in rows of %u, %g mm from row to row and %g mm from the tip on; allowed are up to "
                      "%d in rows of 1 or more, more than 0 mm, and 0 mm or more",
                      contacts->count, contacts->columns, contacts->pitch, contacts->tip, CONTACT_LIMIT);
}

bool axis_clip(conus_interval *interval, const conus_atlas *atlas, const double range[2])
{
    bool is_point = interval->exit - interval->entry <= AXIS_TOUCH;
    double far = range[1] > 0 ? range[1] : INFINITY;
    if (is_point) { /* a surface with holes is the one thing that a ray may cross without being in it */
        const struct mesh *mesh = atlas_object_mesh(atlas, interval->object);
        return mesh && !mesh->shape.closed && interval->entry >= range[0] && interval->entry < far;
    }
    interval->entry = fmax(interval->entry, range[0]);
    interval->exit = fmin(interval->exit, far);
    return interval->exit - interval->entry > AXIS_TOUCH;
}

/* A stretch of the axis, from its entry to before its exit (Eq. 17): a row of the table. */
struct row {
    struct table_object object; /* what it is in */
    double entry;               /* mm from the apex */
    double exit;        /* likewise; infinity where the axis has no end and meets nothing. Equal to entry where the axis
                           crosses a surface that is not closed, and nothing says how far it is inside */
    double length;      /* what lies between */
    double entry_at[3]; /* world */
    double exit_at[3];  /* world; NaN where there is none */
};

static const struct table_field columns[] = {
    {"order", NULL, "1 is nearest to the apex", TABLE_COUNT_BY(table_place)},
    {"kind", NULL, "what the axis is in: area, pathway, bundle, or unassigned: none; error: name says why",
     TABLE_NAME_BY(table_kind)},
    {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway or bundle",
     TABLE_LABEL_BY(table_index)},
    {"name", NULL, "name of the area, pathway or bundle", TABLE_NAME_BY(table_object_name)},
    {"abbreviation", NULL, "abbreviation in the label table", TABLE_NAME_BY(table_abbreviation)},
    {"entry_mm", "mm", "where the axis enters it, from the apex", TABLE_OF(NUMBER, struct row, entry)},
    {"exit_mm", "mm", "where the axis leaves it, from the apex", TABLE_OF(NUMBER, struct row, exit)},
    {"length_mm", "mm", "what lies between", TABLE_OF(NUMBER, struct row, length)},
    TABLE_XYZ("entry_", "where the axis enters it", TABLE_OF, struct row, entry_at),
    TABLE_XYZ("exit_", "where the axis leaves it", TABLE_OF, struct row, exit_at),
    {"atlas_entry_x", "mm", "where the entry is in the atlas's own space, x", TABLE_OF(OWN_X, struct row, entry_at)},
    {"atlas_entry_y", "mm", "the same, y", TABLE_OF(OWN_Y, struct row, entry_at)},
    {"atlas_entry_z", "mm", "the same, z", TABLE_OF(OWN_Z, struct row, entry_at)},
    {"atlas_exit_x", "mm", "where the exit is there, x", TABLE_OF(OWN_X, struct row, exit_at)},
    {"atlas_exit_y", "mm", "the same, y", TABLE_OF(OWN_Y, struct row, exit_at)},
    {"atlas_exit_z", "mm", "the same, z", TABLE_OF(OWN_Z, struct row, exit_at)},
};

const struct table_fields segment_fields = {columns, sizeof columns / sizeof *columns};

/* The rows of an axis while they are found. */
struct segments {
    const struct cone *cone; /* one ray, along the axis; with the selector's range */
    struct row *rows;
    size_t count;
};

/* The last row of an object; NULL = none. */
static struct row *last_of(const struct segments *segments, uint32_t object)
{
    for (size_t i = segments->count; i > 0; i--) {
        if (segments->rows[i - 1].object.number == object) {
            return &segments->rows[i - 1];
        }
    }
    return NULL;
}

static void add_row(struct segments *segments, conus_kind kind, uint32_t object, double entry, double exit)
{
    segments->rows[segments->count++] = (struct row){.object = {kind, object}, .entry = entry, .exit = exit};
}

/* The union of each object's intervals, which are sorted by their entries. */
static void join_intervals(struct segments *segments, const struct layers *layers, const conus_selector *selector)
{
    const uint32_t *group = level_group(selector->level);
    for (size_t i = 0; i < layers->count; i++) {
        const conus_interval *interval = &layers->intervals[i];
        uint32_t object = group ? group[interval->object] : interval->object;
        struct row *last = last_of(segments, object);
        if (last && interval->entry <= last->exit + AXIS_TOUCH) {
            last->exit = fmax(last->exit, interval->exit);
        } else {
            add_row(segments, conus_atlas_object(selector->atlas, object)->kind, object, interval->entry,
                    interval->exit);
        }
    }
}

static int compare(const void *a, const void *b)
{
    const struct row *x = a;
    const struct row *y = b;
    int order = compare_double(x->entry, y->entry);
    order = order ? order : compare_double(x->exit, y->exit);
    return order ? order : compare_unsigned(x->object.number, y->object.number);
}

/* Adds what is in no object, up to the far end of the range; without one up to the last exit, or to infinity where
 * there is nothing. Needs sorted rows. */
static void add_gaps(struct segments *segments)
{
    size_t count = segments->count;
    double reached = segments->cone->range[0];
    for (size_t i = 0; i < count; i++) {
        if (segments->rows[i].entry > reached + AXIS_TOUCH) {
            add_row(segments, CONUS_KIND_UNASSIGNED, 0, reached, segments->rows[i].entry);
        }
        reached = fmax(reached, segments->rows[i].exit);
    }
    double end = segments->cone->range[1] > 0 ? segments->cone->range[1] : count ? reached : INFINITY;
    if (end > reached + AXIS_TOUCH) {
        add_row(segments, CONUS_KIND_UNASSIGNED, 0, reached, end);
    }
}

static void place(double out[3], const struct cone *axis, double depth)
{
    double direction[3];
    cone_ray(direction, axis, 0, 0);
    for (int a = 0; a < 3; a++) {
        out[a] = isfinite(depth) ? axis->pose.world_from_device[12 + a] + depth * direction[a] : NAN;
    }
}

conus_status axis_follow(struct layers *out, conus_selector *selector, const conus_pose *pose, double far)
{
    struct cone axis = AXIS;
    axis.pose = *pose;
    axis.range[1] = far;
    conus_status status = selector_prepare_axis(selector);
    status = status ? status : selector->axis->functions->pierce(selector->axis, out, &axis);
    if (status) {
        return status;
    }
    layers_drop_blockers(out);
    return layers_sort(out, 1);
}

static conus_status find_segments(struct segments *segments, conus_selector *selector)
{
    struct layers layers = {0};
    conus_status status = axis_follow(&layers, selector, &segments->cone->pose, segments->cone->range[1]);
    size_t kept = 0;
    for (size_t i = 0; i < layers.count && !status; i++) {
        conus_interval interval = layers.intervals[i];
        if (axis_clip(&interval, selector->atlas, segments->cone->range)) {
            layers.intervals[kept++] = interval;
        }
    }
    layers.count = kept;
    segments->rows = status ? NULL : memory_raw(2 * layers.count + 1, sizeof *segments->rows); /* each with a gap */
    if (segments->rows) {
        join_intervals(segments, &layers, selector);
        order_sort(segments->rows, segments->count, sizeof *segments->rows, compare);
        add_gaps(segments);
        order_sort(segments->rows, segments->count, sizeof *segments->rows, compare);
        for (size_t i = 0; i < segments->count; i++) {
            struct row *row = &segments->rows[i];
            row->length = row->exit - row->entry;
            place(row->entry_at, segments->cone, row->entry);
            place(row->exit_at, segments->cone, row->exit);
        }
    }
    layers_finish(&layers);
    return status || segments->rows ? status : CONUS_ERROR_MEMORY;
}

conus_status conus_segments(conus_table **out, conus_selector *selector, const conus_pose *pose)
{
    struct table_question asked = {.cone = AXIS, .is_axis = true};
    struct segments segments = {.cone = &asked.cone};
    conus_status status = pose_settle(&asked.cone.pose, pose->world_from_device);
    weight_turn(&asked.cone.pose, selector->options.weight);
    if (status) {
        return status;
    }
    memcpy(asked.cone.range, selector->range, sizeof asked.cone.range);
    status = find_segments(&segments, selector);
    status = status ? status
                    : table_create(out, &(struct table_source){selector->atlas, &selector->frame}, &segment_fields,
                                   &asked, segments.rows, sizeof *segments.rows, segments.count);
    memory_free(segments.rows);
    return status;
}
