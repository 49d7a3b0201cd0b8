/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures how far the axis of a device stays from each object (Eq. 21). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "poses/rows/pose_row.h"
#include "selection/selection.h"
#include "selection/study/study.h"

#include <string.h>

/* Without a far end the needle ends where no object can be nearest farther on; without a limit, that is the distance of
 * the box's farthest corner. */
static void end_needle(struct needle *needle, double *limit, const struct clearance_index *index, const double range[2])
{
    double farthest = 0;
    needle->near = range[0];
    needle->far = range[1] > 0 ? range[1] : range[0];
    for (int corner = 0; corner < 8; corner++) {
        double offset[3];
        for (int a = 0; a < 3; a++) {
            offset[a] = corner >> a & 1 ? index->high[a] : index->low[a];
            offset[a] -= needle->origin[a] + needle->near * needle->direction[a];
        }
        if (range[1] == 0) {
            needle->far = fmax(needle->far, needle->near + vec3_dot(offset, needle->direction));
        }
        farthest = fmax(farthest, vec3_length(offset));
    }
    *limit = fmin(*limit, farthest);
}

/* How far an object is from a needle (Eq. 21): a row of the table. */
struct row {
    struct table_object object;
    double distance;  /* mm from the needle's axis to the object, 0 where they meet */
    double clearance; /* the distance less the needle's radius, mm; negative where the needle's body meets it */
    double depth;     /* mm from the apex to the point of the axis that is nearest; of several the least */
    double at[3];     /* that point of the axis, world */
    double near[3];   /* the object's nearest point, world */
};

static const struct table_field columns[] = {
    {"kind", NULL, "area, pathway or bundle; error: name says why", TABLE_NAME_BY(table_kind)},
    {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway or bundle",
     TABLE_LABEL_BY(table_index)},
    {"name", NULL, "name of the area, pathway or bundle", TABLE_NAME_BY(table_object_name)},
    {"distance_mm", "mm", "from the needle's axis to it, 0 where the axis meets it",
     TABLE_OF(NUMBER, struct row, distance)},
    {"clearance_mm", "mm", "the same from the needle's surface: less its radius; 0 or less where the needle touches it",
     TABLE_OF(NUMBER, struct row, clearance)},
    {"depth_mm", "mm", "where the axis is nearest to it, from the apex", TABLE_OF(NUMBER, struct row, depth)},
    TABLE_XYZ("", "that point of the axis", TABLE_OF, struct row, at),
    TABLE_XYZ("near_", "its nearest point to that", TABLE_OF, struct row, near),
};

const struct table_fields clearance_fields = {columns, sizeof columns / sizeof *columns};

static int compare(const void *a, const void *b)
{
    const struct row *x = a;
    const struct row *y = b;
    int order = compare_double(x->clearance, y->clearance);
    order = order ? order : compare_double(x->depth, y->depth);
    return order ? order : compare_unsigned(x->object.number, y->object.number);
}

/* Makes *rows, which the caller frees; NULL and 0 of them where there is no object at all. */
static conus_status find_clearances(struct row **rows, size_t *count, conus_selector *selector,
                                    const struct table_question *asked)
{
    struct needle needle;
    const conus_pose *pose = &asked->cone.pose;
    double radius = selector->options.radius;
    struct clearance_question question = {
        .atlas = selector->atlas, .groups = level_group(selector->level), .limit = asked->within + radius};
    conus_status status = selector_prepare_clearance(selector);
    question.index = selector->clearance_index;
    if (status || !(question.index->low[0] <= question.index->high[0])) {
        return status; /* without an object there is no clearance */
    }
    memcpy(needle.origin, pose->world_from_device + 12, sizeof needle.origin);
    vec3_scale(needle.direction, pose->world_from_device + 8, -1);
    end_needle(&needle, &question.limit, question.index, selector->range);
    question.tracts = selector->tract_index;
    clearance_take(&selector->clearance, &question, &needle);
    const struct clearance *taken = &selector->clearance;
    *count = taken->touched_count;
    *rows = memory_raw(*count, sizeof **rows);
    if (!*rows) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < *count; i++) {
        uint32_t object = taken->touched[i];
        const struct clearance_found *found = &taken->found[object];
        struct row *row = &(*rows)[i];
        *row = (struct row){.object = {conus_atlas_object(selector->atlas, object)->kind, object},
                            .distance = found->distance,
                            .clearance = found->distance - radius,
                            .depth = found->depth};
        needle_point(row->at, &needle, found->depth);
        memcpy(row->near, found->distance > 0 ? found->point : row->at, sizeof row->near);
    }
    order_sort(*rows, *count, sizeof **rows, compare);
    return CONUS_OK;
}

conus_status conus_clearance(conus_table **out, conus_selector *selector, const conus_pose *pose, double within)
{
    struct table_question asked = {.cone = {.angle = 1, .resolution = 1}, .is_axis = true, .within = within};
    struct row *rows = NULL;
    size_t count = 0;
    char text[TEXT_NUMBER_SIZE];
    if (!(within >= 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "within: %s mm, allowed are 0 and more", text_number(text, within));
    }
    conus_status status = pose_settle(&asked.cone.pose, pose->world_from_device);
    weight_turn(&asked.cone.pose, selector->options.weight);
    if (status) {
        return status;
    }
    memcpy(asked.cone.range, selector->range, sizeof asked.cone.range);
    status = find_clearances(&rows, &count, selector, &asked);
    status = status ? status
                    : table_create(out, &(struct table_source){selector->atlas, &selector->frame}, &clearance_fields,
                                   &asked, rows, sizeof *rows, count);
    memory_free(rows);
    return status;
}
