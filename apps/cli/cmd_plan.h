/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What conus plan of one needle and that of several together share. */
#ifndef CONUS_CLI_CMD_PLAN_H
#define CONUS_CLI_CMD_PLAN_H

#include "cli/candidates.h"
#include "cli/request.h"
#include "settings/constraints.h"

/** Only of several needles together; parts are read row by row. */
struct needles_settings {
    const char *file; /**< NULL = one needle is planned. */
    const char *given, *between, *pairs;
    struct option_list parts;
    double entry_distance;
    uint32_t effort;
};

struct plan_settings {
    struct request_settings request; /* first */
    struct constraint_settings constraints;
    struct candidate_settings candidates;
    struct needles_settings needles;
    const char *poses_out;
    const char *top;
    bool infeasible;
    const char *rank, *score;
    const char *constraint_rows, *profile, *tolerance, *pivot;
    const char *jitter, *contacts;
    uint32_t threads, samples;
    const char *map, *target_map, *structure;
    size_t progress; /* enum progress_kind */
};

/** The question of one needle, as far as its options are read: as for constraints_parse() and candidates_parse(). */
int plan_parse(struct constraints *constraints, struct candidates *candidates, const struct plan_settings *settings,
               const struct arguments *arguments);

/** The selector that such a question needs. */
conus_selector_options plan_engine(const struct plan_settings *settings, const struct constraints *constraints);

/** The far end of poses that have none of their own, mm; 0 = none. */
double plan_far(const struct plan_settings *settings, const struct candidates *candidates);

/** Says rows of the candidates at @p path that are none. EXIT_USAGE where none is one; *failed of a file that has some.
 */
int plan_check_candidates(bool *failed, const conus_plan *plan, const struct plan_settings *settings,
                          const struct candidates *candidates);

/** Says how many candidates each constraint leaves, and where none are left which break one alone. Returns the exit
 * code and prints an error unless it is 0. */
int plan_say_funnel(const conus_plan *plan, double radius);

/** The options of a question. */
extern const struct option plan_pose_options[], plan_needle_options[], plan_contact_options[];
extern const struct option part_options[]; /**< struct needles_settings */

/** The option tables whose options may be columns of a table of needles, up to NULL. */
extern const struct option *const plan_question_options[];

/** --needles and what goes with it. */
extern const struct option needles_options[];

/** Runs conus plan --needles. */
int plan_needles(const struct plan_settings *settings, const struct arguments *arguments);

#endif
