/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Where the needles of a plan enter and where they lead: --from, --toward, --tilt, --roll, --depth; and files of
 * the poses that are listed. */
#ifndef CONUS_CLI_CANDIDATES_H
#define CONUS_CLI_CANDIDATES_H

#include "cli/request.h"
#include "conus/plan.h"
#include "settings/constraints.h"

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
    double apart; /**< mm, of "spacing"; 0 = none. */
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
};

/** Writes poses: a table (.tsv), lines for 3D Slicer, one for each shank (.mrk.json), polylines (.vtk), or the first
 * one as a 4 x 4 matrix (.txt). Likewise. */
int candidates_write(const char *path, const struct written_pose *poses, size_t count, const conus_frame *frame);

#endif
