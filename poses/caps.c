/* SPDX-License-Identifier: BSD-3-Clause */
/* Caps of electrodes, which name no space. They are taken as MNI only where their names lie on the head of MNI 152
 * (Okamoto's published cap: at most 14.7 mm off, half of it within 9.2). */
#include "poses/pose_stream.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <string.h>

static const double FARTHEST = 25, MEDIAN = 12;       /* mm, of names from their positions */
static const double HEAD_OF_CM = 30, HEAD_OF_M = 1.3; /* half of a head in mm lies farther from its middle */
enum { LEAST = 3 };                                   /* names that say something */

/* An electrode, and where its name is on the head of MNI 152. */
struct pair {
    const char *name;
    double point[3], place[3];
    double apart;
};

static const struct position *known_position(struct text name)
{
    static const char *const landmarks[][2] = {{"FidNz", "Nz"}, {"FidT9", "LPA"}, {"FidT10", "RPA"}, {"Nasion", "Nz"}};
    for (size_t i = 0; i < sizeof landmarks / sizeof landmarks[0]; i++) {
        name = text_equal_ignoring_case(name, landmarks[i][0]) ? text_from(landmarks[i][1]) : name;
    }
    return position_find(name);
}

static int compare_apart(const void *a, const void *b)
{
    return compare_double(((const struct pair *)a)->apart, ((const struct pair *)b)->apart);
}

/* Ways to hold the axes: a cap's point, so held, is RAS. */
static const struct way {
    const char *words;
    double m[9]; /* row by row */
} ways[] = {
    {"another head, or one that lies elsewhere", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
    {"a head with x to the nose and y to the left (CTF, EEGLAB, Brainstorm)", {0, -1, 0, 1, 0, 0, 0, 0, 1}},
    {"a head in LPS (x to the left, y to the back)", {-1, 0, 0, 0, -1, 0, 0, 0, 1}},
    {"a head with left and right exchanged", {-1, 0, 0, 0, 1, 0, 0, 0, 1}},
};

enum { WAYS = sizeof ways / sizeof ways[0] };

/* Sorts the pairs by how far they are apart when the cap is held so, and returns the distance of the middle one; the
 * last one is farthest. */
static double median_of(struct pair *pairs, size_t count, const struct way *way)
{
    for (size_t i = 0; i < count; i++) {
        double p[3];
        for (size_t k = 0; k < 3; k++) {
            p[k] = vec3_dot(way->m + 3 * k, pairs[i].point);
        }
        vec3_sub(p, p, pairs[i].place);
        pairs[i].apart = vec3_length(p);
    }
    order_sort(pairs, count, sizeof *pairs, compare_apart);
    return pairs[count / 2].apart;
}

static bool fits(struct pair *pairs, size_t count, const struct way *way)
{
    return median_of(pairs, count, way) <= MEDIAN && pairs[count - 1].apart <= FARTHEST;
}

/* Lets points or places have their middle at 0, and half of them lie nearer than 1. */
static double centre(struct pair *pairs, size_t count, size_t offset)
{
    double middle[3] = {0};
    for (size_t i = 0; i < count; i++) {
        vec3_add_scaled(middle, middle, 1 / (double)count, (const double *)((const char *)&pairs[i] + offset));
    }
    for (size_t i = 0; i < count; i++) {
        double *p = (double *)((char *)&pairs[i] + offset);
        vec3_sub(p, p, middle);
        pairs[i].apart = vec3_length(p);
    }
    order_sort(pairs, count, sizeof *pairs, compare_apart);
    double radius = pairs[count / 2].apart;
    for (size_t i = 0; radius > 0 && i < count; i++) {
        double *p = (double *)((char *)&pairs[i] + offset);
        vec3_scale(p, p, 1 / radius);
    }
    return radius;
}

static conus_status refuse(struct pair *pairs, size_t count)
{
    double median = median_of(pairs, count, &ways[0]);
    const struct pair worst = pairs[count - 1];
    (void)centre(pairs, count, offsetof(struct pair, point));
    (void)centre(pairs, count, offsetof(struct pair, place));
    size_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < WAYS; i++) {
        double own = median_of(pairs, count, &ways[i]);
        best = own < least ? i : best;
        least = fmin(least, own);
    }
    return fail(CONUS_ERROR_DATA,
                "a cap that names no space, and does not lie on the head of MNI 152, but looks like %s: export it in "
                "MNI, in mm (%.20s is %.0f mm off, allowed are %g, and half of %zu names more than %.0f, allowed are "
                "%g)",
                ways[best].words, worst.name, worst.apart, FARTHEST, count, median, MEDIAN);
}

static conus_status check_pairs(struct notes *notes, struct pair *pairs, size_t count)
{
    if (fits(pairs, count, &ways[WAYS - 1]) && fits(pairs, count, &ways[0])) {
        return fail(CONUS_ERROR_DATA,
                    "a cap that names no space: all %zu names of the 10-10 system lie near the "
                    "midline, so that left and right cannot be told apart",
                    count);
    }
    return fits(pairs, count, &ways[0])
               ? notes_add(notes,
                           "a cap that names no space; taken as MNI 152, for its %zu names of the 10-10 system lie "
                           "within %.0f mm of their positions on that head, half of them within %.0f mm",
                           count, pairs[count - 1].apart, pairs[count / 2].apart)
               : refuse(pairs, count);
}

/* The names that are known, with room for all in @p pairs. */
static size_t find_pairs(struct pair *pairs, const conus_pose_list *list, bool all)
{
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        const conus_pose_row *row = &list->rows[i];
        const struct position *known = row->error ? NULL : known_position(text_from(row->id));
        if (known || (all && !row->error)) {
            struct pair *pair = &pairs[count++];
            *pair = (struct pair){.name = row->id};
            memcpy(pair->point, row->pose.world_from_device + 12, sizeof pair->point);
            memcpy(pair->place, known ? known->point : pair->place, sizeof pair->place);
        }
    }
    return count;
}

conus_status cap_check(conus_pose_list *list, const char *file, struct notes *notes)
{
    const double scale = list->space.scale;
    struct pair *pairs = memory_raw(list->count + 1, sizeof *pairs);
    if (!pairs) {
        return CONUS_ERROR_MEMORY;
    }
    size_t count = find_pairs(pairs, list, true);
    double radius = count && scale == 0 ? centre(pairs, count, offsetof(struct pair, point)) : INFINITY;
    conus_status status =
        radius > HEAD_OF_CM ? CONUS_OK
                            : fail(CONUS_ERROR_DATA,
                                   "a cap without a unit; by its size (half lies within %.3g of the middle) these are "
                                   "%s: type %s,unit=%s",
                                   radius, radius > HEAD_OF_M ? "centimetres" : "metres, or a sphere of radius 1", file,
                                   radius > HEAD_OF_M ? "cm" : "m");
    for (size_t i = 0; scale > 0 && i < list->count; i++) {
        double *p = list->rows[i].pose.world_from_device + 12;
        vec3_scale(p, p, scale);
    }
    count = find_pairs(pairs, list, false);
    if (!status && count < LEAST) {
        status = fail(CONUS_ERROR_DATA,
                      "a cap that names no space: %zu of its %zu names are landmarks or positions of the 10-10 system; "
                      "%d are needed to see whether it lies on the head of MNI 152; a table name,x,y,z is read "
                      "as it is",
                      count, list->count, LEAST);
    }
    status = status ? status : check_pairs(notes, pairs, count);
    list->space = pose_space_named(text_from("a cap on the head of MNI 152"), POSE_BRAIN_MNI152);
    memory_free(pairs);
    return status;
}
