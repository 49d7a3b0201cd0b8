/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The shafts and parts of needles, and how far those of two candidates are from each other (Eq. 25, 26). */
#ifndef CONUS_SELECTION_PLAN_TOGETHER_BODIES_H
#define CONUS_SELECTION_PLAN_TOGETHER_BODIES_H

#include "conus/plan.h"

enum { SHAFT_LIMIT = 64, PART_LIMIT = 64, BODY_LIMIT = SHAFT_LIMIT + PART_LIMIT };

/** What all candidates of a needle have: first its shafts, then its parts. */
struct bodies {
    size_t shaft_count, count;
    double radius[BODY_LIMIT];
    double shanks[SHAFT_LIMIT][2]; /**< Beside the axis, along the device's x and y, mm. */
    conus_part parts[PART_LIMIT];
};

/** CONUS_ERROR_ARGUMENT for too many, and for parts out of their range. @p shanks NULL = one shaft on the axis. */
conus_status bodies_init(struct bodies *out, double radius, const double *shanks, size_t shank_count,
                         const conus_part *parts, size_t part_count);

/** Where the bodies of candidates are: arrays of coordinates, as loops over candidates want them. */
struct body_list {
    const struct bodies *bodies;
    size_t count;
    double *numbers; /**< [3 + 7 bodies->count][count] The device's position; of each body one end, the way to the
                        other one, and the square of that way's length. */
};

conus_status body_list_init(struct body_list *out, const struct bodies *bodies, size_t count);
void body_list_finish(struct body_list *list);
void body_list_set(struct body_list *list, size_t index, const conus_planned *pose);

/** The margins of pairs, mm. */
struct margins {
    double between, parts, entries;
};

/** Two bodies, and where they are nearest. */
struct nearest {
    double distance; /**< Between their surfaces, mm; below 0 where they overlap. */
    size_t body, other;
    double at[3], other_at[3]; /**< On their axes. */
};

/** What is measured of a pair. */
struct pair {
    double slack;           /**< mm */
    struct nearest nearest; /**< The bodies with that slack, the first of equal ones. */
    double shafts;          /**< Least distance of shafts, mm. */
    double parts;           /**< Slack of the bodies of which one or both are parts; infinite without any. */
    double entries;         /**< Distance of the devices' positions, mm. */
};

void pair_measure(struct pair *out, const struct body_list *list, size_t index, const struct body_list *other,
                  size_t other_index, const struct margins *margins);

/** What is to be at least a number of nanometres. */
enum pair_quantity {
    PAIR_LEEWAY,  /**< The leeway of the pair. */
    PAIR_BETWEEN, /**< The distance of the shafts, whatever its margin; all else holds. */
    PAIR_ENTRIES  /**< That of the entries, likewise. */
};

struct pair_test {
    struct margins margins;
    enum pair_quantity quantity;
    int64_t least; /**< nm */
};

/** Whole nanometres: floor(10^6 mm + 1/2). */
int64_t nanometres(double mm);

/** The quantity of a pair, nm. */
int64_t pair_value(const struct pair *pair, enum pair_quantity quantity);

/** Whether the pair goes together. */
bool pair_goes(const struct pair *pair, const struct pair_test *test);

/** Sets the bits of the first @p count candidates of another list that go with candidate @p index. @p scratch has room
 * for @p count numbers. */
void pair_row(uint64_t *bits, double *scratch, const struct body_list *list, size_t index,
              const struct body_list *other, size_t count, const struct pair_test *test);

#endif
