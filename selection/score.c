/* SPDX-License-Identifier: BSD-3-Clause */
#include "selection/score.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double by_share(const conus_result *result, const struct cone *cone)
{
    (void)cone;
    return result->share;
}

static double by_center(const conus_result *result, const struct cone *cone)
{
    return 1 - (cone->radius > 0 ? 2 * result->center_px / cone->resolution : result->offset / (cone->angle / 2));
}

static double by_distance(const conus_result *result, const struct cone *cone)
{
    (void)cone;
    return -result->distance;
}

static const struct score scores[] = {
    {{"share", "part of the cone's solid angle, 0 to 1"}, by_share},
    {{"centre", "closeness to the axis: 1 on it, 0 on the cone's surface, linear in the angle"}, by_center},
    {{"distance", "nearness to the apex: minus the distance in mm"}, by_distance},
};

enum { SCORE_COUNT = sizeof scores / sizeof scores[0] };

const conus_score_info *conus_score(size_t index)
{
    return index < SCORE_COUNT ? &scores[index].info : NULL;
}

conus_status score_find(const struct score **out, const char *name)
{
    char known[256] = "";
    for (size_t i = 0; i < SCORE_COUNT; i++) {
        if (!name || !strcmp(name, scores[i].info.name)) {
            *out = &scores[i];
            return CONUS_OK;
        }
        strncat(known, i ? ", " : "", sizeof known - strlen(known) - 1);
        strncat(known, scores[i].info.name, sizeof known - strlen(known) - 1);
    }
    return fail(CONUS_ERROR_ARGUMENT, "score: \"%s\", allowed are %s", name, known);
}

/* The larger first; what is no number, last. */
static int falling(double x, double y)
{
    if (isnan(x) || isnan(y)) {
        return isnan(x) - isnan(y);
    }
    return (x < y) - (x > y);
}

static int compare(const void *a, const void *b)
{
    const conus_result *x = a;
    const conus_result *y = b;
    int order = falling(x->score, y->score);
    order = order ? order : falling(x->share, y->share);
    order = order ? order : falling(-x->distance, -y->distance);
    order = order ? order : falling(-x->entry, -y->entry);
    return order ? order : (x->object > y->object) - (x->object < y->object);
}

void score_rank(struct statistics *statistics, const struct score *score, const struct cone *cone)
{
    size_t ranked = statistics->count - 1; /* the last is CONUS_UNASSIGNED */
    for (size_t i = 0; i < ranked; i++) {
        statistics->results[i].score = score->function(&statistics->results[i], cone);
    }
    qsort(statistics->results, ranked, sizeof *statistics->results, compare);
    for (size_t i = 0; i < ranked; i++) {
        statistics->results[i].rank = (uint32_t)i + 1;
    }
}
