/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Several needles together: their bodies, pairs, and the best combination (Eq. 25, 26). */
#ifndef CONUS_SELECTION_PLAN_TOGETHER_TOGETHER_H
#define CONUS_SELECTION_PLAN_TOGETHER_TOGETHER_H

#include "conus/plan.h"
#include "selection/table/table.h"

/* The shafts and parts of needles, and how far those of two candidates are from each other (Eq. 25, 26). */

enum { SHAFT_LIMIT = 64, PART_LIMIT = 64, BODY_LIMIT = SHAFT_LIMIT + PART_LIMIT };

/** What all candidates of a needle have: first its shafts, then its parts. */
struct bodies {
    size_t shaft_count, count;
    double radius[BODY_LIMIT];
    double shanks[SHAFT_LIMIT][2]; /**< Beside the axis, along the device's x and y, mm. */
    conus_part parts[PART_LIMIT];
    const conus_frame *frame; /**< In whose axes the angles of arcs are. */
    size_t arc;               /**< Needles of one number share an arc, those of others do not; 0 = of any. */
};

/** CONUS_ERROR_ARGUMENT for too many, and for parts out of their range. @p shanks NULL = one shaft on the axis. */
conus_status bodies_init(struct bodies *out, double radius, const double *shanks, size_t shank_count,
                         const conus_part *parts, size_t part_count);

/** Where the bodies of candidates are: arrays of coordinates, as loops over candidates read them. */
struct body_list {
    const struct bodies *bodies;
    size_t count;
    double *numbers; /**< [8 + 7 bodies->count][count] The device's position, the far end, arc and slider angle
                        (degrees); of each body one end, the way to the other one, and the square of that way's
                        length. */
};

conus_status body_list_init(struct body_list *out, const struct bodies *bodies, size_t count);
void body_list_finish(struct body_list *list);
void body_list_set(struct body_list *list, size_t index, const conus_planned *pose);

/** The angles of a rig with arcs, degrees (Eq. 26), of a way out along a needle: an arc is a plane through the
 * right-left axis of the frame. Along that axis itself the arc angle is 0. */
void arc_angles(double *arc, double *slider, const conus_frame *frame, const double out[3]);

/** Whether two candidates are the same, or neither their positions nor their far ends are @p apart mm or more from each
 * other. */
bool bodies_are_near(const struct body_list *list, size_t index, const struct body_list *other, size_t other_index,
                     double apart);

/** How needles are carried on arcs, degrees. 2 same is less than the spacing: so where each two needles fit, being on
 * one arc is an equivalence. */
struct arcs {
    double spacing; /**< Of two arcs; 0 = there are no arcs. */
    double slider;  /**< Of two needles on one arc. */
    double same;    /**< Needles on one arc differ by no more. */
    size_t most;    /**< Arcs; 0 = any number. */
    size_t each;    /**< Needles on one arc, likewise. */
};

/** The margins of pairs, mm. */
struct margins {
    double between, parts, entries;
    struct arcs arcs;
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
    double arc, slider;     /**< Differences of the angles, degrees. */
    bool fits_arcs;         /**< On one arc or on two; true without arcs. */
};

void pair_measure(struct pair *out, const struct body_list *list, size_t index, const struct body_list *other,
                  size_t other_index, const struct margins *margins);

/** Whether two candidates are on one arc, of needles that fit. */
bool bodies_share_arc(const struct body_list *list, size_t index, const struct body_list *other, size_t other_index,
                      const struct arcs *arcs);

/** What is to be at least a number of nanometres. */
enum pair_quantity {
    PAIR_LEEWAY,  /**< The leeway of the pair. */
    PAIR_BETWEEN, /**< The distance of the shafts, whatever its margin; all else holds. */
    PAIR_ENTRIES  /**< That of the entries, likewise. */
};

enum { COVER_LIMIT = 16 };

/** What all needles together have to have: so many contacts in each cover, at least. */
struct covers {
    size_t count;
    uint64_t least[COVER_LIMIT];
};

struct pair_test {
    struct margins margins;
    enum pair_quantity quantity;
    int64_t least; /**< nm */
    struct covers covers;
};

/** Whole nanometres: floor(10^6 mm + 1/2). */
int64_t nanometres(double mm);

/** The quantity of a pair, nm. */
int64_t pair_value(const struct pair *pair, enum pair_quantity quantity);

/** Sets the bits of the first @p count bodies of another list that go with body @p index. @p scratch has room
 * for @p count numbers. */
void pair_row(uint64_t *bits, double *scratch, const struct body_list *list, size_t index,
              const struct body_list *other, size_t count, const struct pair_test *test);

/* The table of pairs (Eq. 26). */

enum { BODY_WORD = 16 };

/** A row: two needles of a combination. */
struct pair_row {
    struct table_object none;
    uint64_t combination;      /**< 0 of one that does not hold. */
    const char *names[2];      /**< Of the needles. */
    const char *words[2];      /**< Of the bodies: bodies[0] and [1]. */
    char bodies[2][BODY_WORD]; /**< "shaft", "shank 2", "part 1" */
    double leeway;
    struct pair pair;
};

extern const struct table_fields pair_fields;

/** Fills what is about the bodies. */
void pair_row_name(struct pair_row *row, const struct bodies *bodies, const struct bodies *other);

/* The best combination of one candidate of each list: depth first, with bits for what goes together, and with bounds
 * that prove it. */

enum { NEEDLE_LIMIT = 16, QUESTION_LIMIT = 64 };

/** A candidate, in whole nanometres. */
struct search_item {
    int64_t leeway; /**< 0 without one. */
    int64_t depth;
    uint64_t number;
    size_t index; /**< Of its bodies in those of its part. */
    uint32_t part;
    const uint32_t *covered; /**< Contacts in each cover. */
};

/** The candidates of a needle that answer one question. */
struct search_part {
    const struct body_list *bodies;
    size_t question;
    bool once;       /**< No other needle answers it. */
    bool has_leeway; /**< Else they do not count for the least one. */
};

/** The candidates of a needle: the largest leeway first, of equal ones the least depth, then the least number. */
struct search_list {
    const struct search_item *items; /**< [count] Those of a part are in the order of its bodies. */
    size_t count;
    struct search_part parts[QUESTION_LIMIT];
    size_t part_count;
    size_t kin; /**< Needles with the same one are alike: their numbers rise strictly. */
};

/** Compares items in that order, for order_sort(). */
int search_item_compare(const void *a, const void *b);

struct search;

/** Combinations that are listed: from each of them the next one differs in so many needles. */
struct search_variety {
    const size_t (*chosen)[NEEDLE_LIMIT]; /**< [count] Indices into the lists. */
    size_t count;
    double apart;  /**< By another candidate whose position or far end is so far off, mm. */
    size_t differ; /**< At least 1. */
};

/** @p lists must outlive it. Ends with joint_destroy(). @p progress false ends the search. */
conus_status joint_create(struct search **out, const struct search_list *lists, size_t count,
                          const struct search_variety *variety, uint64_t effort, conus_progress progress,
                          void *progress_user);
void joint_destroy(struct search *search);

/** What was found of some lists. */
struct search_answer {
    bool found;
    size_t chosen[NEEDLE_LIMIT]; /**< Indices into the lists. */
    int64_t least;               /**< Of the quantity: of a leeway that of the candidates, too. */
    int64_t most; /**< Proven: none has more than that. Below the least that was asked for: there is none. */
};

/** Finds some combination with test->least or more. Neither found nor out->most below that: the effort did not do. */
conus_status joint_any(struct search_answer *out, struct search *search, uint32_t among, const struct pair_test *test);

/** Finds the largest least quantity of the lists in @p among, a bit for each, and a combination that has it. The least
 * of test->least or more; no one has more than @p most. CONUS_ERROR_CANCELLED, with what was found so far. */
conus_status joint_least(struct search_answer *out, struct search *search, uint32_t among, const struct pair_test *test,
                         int64_t most);

/** Of all combinations whose least leeway is @p found->least the best by sum, depth and numbers (Eq. 27), from that of
 * @p found on. *is_proven: that it is the best. Likewise. */
conus_status joint_best(struct search_answer *found, bool *is_proven, struct search *search,
                        const struct pair_test *test);

/** Nodes so far. */
uint64_t joint_nodes(const struct search *search);

#endif
