/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures how far the axis of a device stays from each object (Eq. 21). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "poses/rows/pose_row.h"
#include "selection/selector.h"
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

static int compare(const void *a, const void *b)
{
    const conus_clearance *x = a;
    const conus_clearance *y = b;
    int order = compare_double(x->clearance, y->clearance);
    order = order ? order : compare_double(x->depth, y->depth);
    return order ? order : compare_unsigned(x->object, y->object);
}

static conus_status build(struct conus_clearances *clearances, conus_selector *selector, const conus_pose *pose,
                          double within)
{
    struct needle needle;
    double radius = selector->options.radius;
    struct clearance_question question = {
        .atlas = selector->atlas, .groups = level_group(selector->level), .limit = within + radius};
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
    clearances->rows = memory_raw(taken->touched_count, sizeof *clearances->rows);
    if (!clearances->rows) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < taken->touched_count; i++) {
        uint32_t object = taken->touched[i];
        const struct clearance_found *found = &taken->found[object];
        conus_clearance *row = &clearances->rows[clearances->count++];
        *row = (conus_clearance){.kind = conus_atlas_object(selector->atlas, object)->kind,
                                 .object = object,
                                 .distance = found->distance,
                                 .clearance = found->distance - radius,
                                 .depth = found->depth};
        needle_point(row->at, &needle, found->depth);
        memcpy(row->near, found->distance > 0 ? found->point : row->at, sizeof row->near);
    }
    order_sort(clearances->rows, clearances->count, sizeof *clearances->rows, compare);
    return CONUS_OK;
}

conus_status conus_clearances_create(conus_clearances **out, conus_selector *selector, const conus_pose *pose,
                                     double within)
{
    conus_pose rigid;
    char text[TEXT_NUMBER_SIZE];
    if (!(within >= 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "within: %s mm, allowed are 0 and more", text_number(text, within));
    }
    conus_status status = pose_settle(&rigid, pose->world_from_device);
    if (status) {
        return status;
    }
    conus_clearances *clearances = memory_zeroed(1, sizeof *clearances);
    status = clearances ? build(clearances, selector, &rigid, within) : CONUS_ERROR_MEMORY;
    if (status) {
        conus_clearances_destroy(clearances);
        return status;
    }
    clearances->cone = (struct cone){.pose = rigid, .angle = 1, .resolution = 1};
    memcpy(clearances->cone.range, selector->range, sizeof clearances->cone.range);
    clearances->within = within;
    *out = clearances;
    return CONUS_OK;
}

void conus_clearances_destroy(conus_clearances *clearances)
{
    if (clearances) {
        memory_free(clearances->rows);
        memory_free(clearances);
    }
}

size_t conus_clearances_count(const conus_clearances *clearances)
{
    return clearances ? clearances->count : 0;
}

const conus_clearance *conus_clearances_clearance(const conus_clearances *clearances, size_t index)
{
    return clearances && index < clearances->count ? &clearances->rows[index] : NULL;
}
