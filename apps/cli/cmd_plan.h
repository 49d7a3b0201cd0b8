/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What conus plan of one needle and of several together share: the settings, and where needles enter and
 * lead. */
#ifndef CONUS_CLI_CMD_PLAN_H
#define CONUS_CLI_CMD_PLAN_H

#include "cli/request.h"
#include "conus/plan.h"
#include "settings/settings.h"

/* Where the needles of a plan enter and where they lead: --from, --toward, --tilt, --roll, --depth; and files of the
 * poses that are listed. */

struct candidate_settings {
    const char *from, *toward, *tilt, *depth;
    double roll; /* degrees; 0 = none */
};

/** --from, --toward, --tilt, --roll and --depth. */
extern const struct option candidate_options[];

/** Points, with what is asked of them behind commas. */
struct place {
    char *path; /**< A file, or a word; owned, with the others behind it. */
    const char *within, *without, *of;
    bool flip;
    double apart;         /**< mm, of "spacing"; 0 = none. */
    double *angles, back; /**< [angle_count][2] Of "angles": arc and slider, degrees; and mm. NULL = none. */
    size_t angle_count;
    conus_sites *sites;
    conus_pose_list *list; /**< Of which they are, if of a file of points. */
    const char **names;    /**< Of the sites, as the file has them; NULL = it has none, or equal ones. */
};

/** The candidates of --from and --toward. */
struct candidates {
    struct place from, toward; /**< from.path is NULL where poses come from a file. */
    double tilt[2];            /**< Degrees, */
    double roll;               /**< and of --roll. */
    double far;                /**< mm, of --depth MM; else 0. */
    bool to_target;            /**< --depth target, */
    double beyond;             /**< and so many mm. */
};

/** Reads the options; @p out is the caller's to candidates_finish() in any case. Returns the exit code and prints an
 * error unless it is 0. */
int candidates_parse(struct candidates *out, const struct candidate_settings *settings,
                     const struct arguments *arguments);
void candidates_finish(struct candidates *candidates);

/** Opens request->stream, once there is a selector; a second time without reading anything again. Targets lie in the
 * structure of the first --reach, if they name no other one. Returns the exit code likewise. */
int candidates_open(struct candidates *candidates, struct request *request, const struct constraints *constraints);

/** The files that the candidates come from, as inputs of the answer. */
void candidates_list_inputs(struct provenance *out, const struct candidates *candidates);

/** A pose that is written. */
struct written_pose {
    const char *id;
    const conus_planned *pose;
    const double *shanks; /**< [shank_count][2] Beside its axis, mm; NULL = one on it. */
    size_t shank_count;
    const char *needle;   /**< Whose candidate it is: then tables say that, and the next two; NULL = nobody's. */
    size_t row;           /**< Of the table of needles, from 1. */
    uint64_t number;      /**< Of the needle's candidates. */
    bool counts_contacts; /**< There are covers: */
    uint64_t contacts;    /**< so many are in any of them. */
};

/** Writes poses: a table (.tsv), lines for 3D Slicer, one for each shank (.mrk.json), polylines (.vtk), or the first
 * one as a 4 x 4 matrix (.txt). Likewise. */
int candidates_write(const char *path, const struct written_pose *poses, size_t count, const conus_frame *frame);

/* What conus plan of one needle and that of several together share. */

/** Only of several needles together; parts are read row by row. */
struct needles_settings {
    const char *file; /**< NULL = one needle is planned. */
    const char *given, *between, *pairs, *diverse, *candidates, *arcs;
    struct option_list parts, covers;
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
