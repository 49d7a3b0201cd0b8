/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries other readings of odd poses: another space, another unit, the other end of the device. */
#include "base/status.h"
#include "conus/selection.h"
#include "selection/selection.h"

#include <math.h>

struct way {
    double place, axes; /* Factors of x and y of the position, and of the axes. */
    double scale;       /* Factor of the position. */
    bool reversed;      /* It looks the other way. */
    const char *words;
};

static const struct way ways[] = {
    {.place = -1, .axes = -1, .scale = 1, .words = "with x and y negated (LPS for RAS)"},
    {.place = 1, .axes = 1, .scale = 1, .reversed = true, .words = "looking the other way"},
    {.place = -1, .axes = 1, .scale = 1, .words = "with x and y of its position negated (LPS for RAS)"},
    {.place = 1, .axes = 1, .scale = 1000, .words = "with its position times 1000 (metres for mm)"},
    {.place = -1, .axes = -1, .scale = 1000, .words = "with x and y negated (LPS for RAS) and times 1000 (metres)"},
    {.place = 1, .axes = 1, .scale = 0.001, .words = "with its position divided by 1000 (micrometres for mm)"},
    {.place = -1, .axes = -1, .scale = 0.001, .words = "with x and y negated (LPS for RAS) and divided by 1000"},
};

enum { WAYS = sizeof ways / sizeof ways[0] };

/* No device is so many mm away, but some are so many micrometres. */
static const double micrometres = 5000;

/* Whether the pose's numbers may have been of that unit. */
static bool is_likely(const conus_pose *pose, double scale, bool tiny)
{
    double largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        largest = fmax(largest, fabs(pose->world_from_device[12 + axis]));
    }
    return scale == 1 ? !tiny : scale > 1 ? tiny : largest > micrometres;
}

static conus_pose read_as(const conus_pose *pose, const struct way *way)
{
    conus_pose out = *pose;
    double *m = out.world_from_device;
    for (int column = 0; column < 3; column++) {
        double back = way->reversed && column != 1 ? -1 : 1; /* half a turn about the device's y */
        m[4 * column] *= way->axes * back;
        m[4 * column + 1] *= way->axes * back;
        m[4 * column + 2] *= back;
    }
    m[12] *= way->place * way->scale;
    m[13] *= way->place * way->scale;
    m[14] *= way->scale;
    return out;
}

/* The object that the pose hits first, from outside of it; 0 = nothing, or no pose. */
static conus_status first_hit(uint32_t *object, conus_selector *selector, const conus_pose *pose, double angle)
{
    conus_selection *selection = NULL;
    conus_status status = conus_select(&selection, selector, pose, angle);
    const conus_result *first = status ? NULL : conus_selection_result(selection, 0);
    *object = first && first->pixels && first->distance > 0 ? first->object : 0;
    conus_selection_destroy(selection);
    return status == CONUS_ERROR_ARGUMENT ? CONUS_OK : status;
}

/* The first way by which the pose hits something. */
static conus_status find_way(conus_pose_suggestion *out, const conus_pose_finding *finding, bool tiny,
                             conus_selector *selector)
{
    conus_pose_suggestion found = {.of_tiny = tiny};
    conus_status status = CONUS_OK;
    for (int i = 0; finding->count && i < WAYS && !status && !found.object; i++) {
        if (is_likely(&finding->pose, ways[i].scale, tiny)) {
            found.is_reversed = ways[i].reversed;
            found.words = ways[i].words;
            found.pose = read_as(&finding->pose, &ways[i]);
            status = first_hit(&found.object, selector, &found.pose, finding->angle);
        }
    }
    if (!status) {
        *out = found.object ? found : (conus_pose_suggestion){0};
    }
    return status;
}

conus_status conus_pose_check_suggest(conus_pose_suggestion *out, const conus_pose_findings *found,
                                      conus_selector *selector)
{
    conus_pose_suggestion reading = {0};
    conus_status status = find_way(&reading, &found->tiny, true, selector);
    if (!status && !reading.object) {
        status = find_way(&reading, &found->away, false, selector);
    }
    if (!status) {
        *out = reading;
    }
    return status;
}
