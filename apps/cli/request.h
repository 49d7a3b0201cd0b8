/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The scaffold of query, sweep, track, plan, overlap and connect: the settings that they share, and the steps from the
 * command line to a report and its files. The question that a command asks, and its own options, are in its cmd_*.c.
 * The last two ask about no pose, and use no settings of aims, files of poses and contexts. */
#ifndef CONUS_CLI_REQUEST_H
#define CONUS_CLI_REQUEST_H

#include "cli/answers/answers.h"
#include "conus/selection.h"
#include "options/output.h"
#include "options/progress.h"
#include "settings/settings.h"

struct request_settings {
    struct atlas_settings atlas;
    struct aim_settings aim; /* of track: only pose, angle and space */
    struct pose_file_settings file;
    struct engine_settings engine;
    struct context_settings context;
    struct common_settings common;
    struct answer_settings answer;
};

/* Groups of options, for commands whose settings begin with those of the request. */
#define REQUEST_FIELD(member) offsetof(struct request_settings, member)
#define REQUEST_AIM_GROUPS                                                                                             \
    {"Where the cone is", aim_options, REQUEST_FIELD(aim)}, {"", stance_options, REQUEST_FIELD(aim)},                  \
        {"", scalp_options, REQUEST_FIELD(aim)}, {"", pose_file_options, REQUEST_FIELD(file)},                         \
        {"", angle_options, REQUEST_FIELD(aim)}, {"", space_options, REQUEST_FIELD(aim.space)},                        \
    {                                                                                                                  \
        "", shape_options, REQUEST_FIELD(engine)                                                                       \
    }
#define REQUEST_ENGINE_GROUPS                                                                                          \
    {"How rays are traced", ray_options, REQUEST_FIELD(engine.numbers)}, {"", pixel_options, REQUEST_FIELD(engine)},   \
        {"", engine_options, REQUEST_FIELD(engine)},                                                                   \
    {                                                                                                                  \
        "", slices_options, REQUEST_FIELD(engine)                                                                      \
    }
#define REQUEST_ATLAS_GROUPS                                                                                           \
    {"What can be hit", atlas_options, REQUEST_FIELD(atlas)}, {"", side_options, REQUEST_FIELD(atlas)},                \
        {"", shown_options, REQUEST_FIELD(atlas)},                                                                     \
    {                                                                                                                  \
        "", context_options, REQUEST_FIELD(context)                                                                    \
    }
#define REQUEST_MORE_ATLASES                                                                                           \
    {                                                                                                                  \
        "", more_atlas_options, REQUEST_FIELD(atlas)                                                                   \
    }

/** --level, of overlap and connect. */
extern const struct option request_level_options[];
/** The groups of options of overlap and connect, behind their own first one. */
#define REQUEST_NO_POSE_ATLAS_GROUPS                                                                                   \
    {"", shown_options, REQUEST_FIELD(atlas)}, {"", request_level_options, 0}, REQUEST_MORE_ATLASES
#define REQUEST_OUTPUT_GROUPS                                                                                          \
    {"What is written", format_options, REQUEST_FIELD(answer)},                                                        \
    {                                                                                                                  \
        "", answer_output_options, REQUEST_FIELD(answer)                                                               \
    }

/** The selector and the report of one atlas. */
struct answerer {
    conus_selector *selector;
    conus_pose_check *aims;
    conus_report *report;     /**< That of the first atlas has the answers of all. */
    conus_pose_finding empty; /**< Cones that hit nothing. */
};

/** One run of a command that answers. */
struct request {
    const struct request_settings *settings;
    const struct arguments *arguments;
    const char *format;
    char *command_line;
    char *sidecar;          /**< Path; NULL if there is none to write. */
    struct outputs outputs; /**< All files that are written, */
    struct rows_files rows; /**< and those of them beside the answer that have rows. */
    struct atlases atlases;
    conus_frame frame;             /**< The space of positions, once the atlases are loaded. */
    struct named_places places;    /**< Those that were given as words. */
    char *scalp[2];                /**< The files of --scalp and its landmarks; owned. */
    conus_pose aim;                /**< That of --origin or --focus, by request_find_aim(), */
    double aim_target;             /**< and how far its target is, mm; NaN = it has none. */
    struct answerer *answerers;    /**< [atlases.count] */
    const char *rows_of;           /**< The file of the rows that are answered; NULL = that of the poses. */
    conus_pose_list *poses;        /**< All poses of a file that is read whole, else NULL. */
    conus_pose_stream *stream;     /**< A file whose poses are read one after the other, else NULL, */
    size_t notes_said;             /**< and how many of its notes were said. */
    conus_row_marks marks;         /**< What tells the rows of answers to a list apart. */
    const struct kept_names *kept; /**< Columns of the file of poses that are kept; NULL = none. */
    bool failed;                   /**< Some poses had no answer. */
    struct progress progress;      /**< Counts poses of a file, or their steps. */
    size_t steps;                  /**< Steps of a pose; 0 = 1. */
    size_t row;                    /**< The pose that is being answered, from 0. */
};

/** Whether --slices, --score, --context, --angle and --radius fit together; prints an error if not. */
bool request_check(const struct request_settings *settings, const struct arguments *arguments, bool has_history);

/** Finds formats and sidecars of the answer and of files of rows. Returns the exit code and prints an error unless it
 * is 0; @p out is the caller's to request_finish() in any case. So do all functions below that return an int. */
int request_init(struct request *out, const struct request_settings *settings, const struct arguments *arguments);
void request_finish(struct request *request);

/** Checks that all outputs are different files, none is a file that was read, and none is there already, unless --force
 * is given. To be called once all is read. */
int request_check_outputs(const struct request *request);

/** Adds the question (answers about a cone or cylinder) and the inputs besides the atlases: the poses, their coordinate
 * system, the areas of --level. */
void request_list_inputs(struct provenance *out, const struct request *request);

/** The options of the library for the file of poses. */
conus_pose_options request_pose_options(const struct request *request);
/** Loads --pose, where it was given. */
int request_load_poses(struct request *request);
/** Loads the atlas with its pathways, those of --atlas, and the context of each; and the poses by @p load_poses, NULL =
 * request_load_poses(), before that where they do not need an atlas. */
int request_load(struct request *request, int (*load_poses)(void *user), void *user);
/** Loads the atlas and those of --atlas, each with the context. request_load() does. */
int request_load_atlases(struct request *request);
/** Whether the poses' space can be that of each atlas. */
int request_match(struct request *request);

/** Finds the places of --origin and --toward in the first atlas, and the pose. Without --origin there is none. */
int request_find_aim(struct request *request);

/** Makes the selectors; the device has @p options. */
conus_status request_start(struct request *request, const conus_selector_options *options);
/** The options of the reports that every command sets alike. */
conus_report_options request_report_options(const struct request *request);
/** Makes the reports of atlas @p index, of the answer and of files of rows, and joins them with the first ones. */
conus_status request_report(struct request *request, size_t index, const conus_report_options *options);
/** Makes all reports with the same options. */
conus_status request_reports(struct request *request, const conus_report_options *options);
/** Makes selectors that trace no ray, and the reports with @p options. */
int request_start_without_rays(struct request *request, const conus_report_options *options);

/** Counts a pose for each atlas, among those whose notes request_say_aims() prints. */
void request_count_pose(struct request *request, size_t line, const conus_pose *pose, double angle);

/** Counts a point for each atlas, likewise. */
void request_count_point(struct request *request, size_t line, const double point[3], double radius);

/** The row's angle, degrees; without one that of --angle. */
double request_angle(const struct request *request, const conus_pose_row *row);
/** Begins to show how many of the steps of @p rows rows are done; request_each_row() does. */
void request_start_progress(struct request *request, size_t rows);
/** Shows how many steps of the row that is being answered are done. */
void request_show_step(struct request *request, size_t done);
/** Says of which row of the file, from 0, the answers are that are added next; request_each_row() does. */
void request_mark(struct request *request, size_t index, const conus_pose_row *row);
/** Answers each row of the list by @p answer, and shows how far that is. */
int request_each_row(struct request *request, int (*answer)(void *user, const conus_pose_row *row), void *user);
/** Prints why a row has no answer. */
int request_skip_row(struct request *request, const conus_pose_row *row, const char *why);
/** The same, and all reports have a row that says it. */
int request_refuse_row(struct request *request, const conus_pose_row *row, const char *why);

/** Prints the notes about the atlases, unless --quiet. */
void request_say_notes(const struct request *request);
/** Prints notes about cones that lie or point where they hardly should, unless --quiet. */
void request_say_aims(const struct request *request);

/** Writes the answer, with the names of all outputs, unless rows are in its place. */
int request_write_answer(const struct request *request, struct provenance *provenance);

/** @p code; EXIT_DIFFERENT in place of EXIT_DONE where some poses had no answer. */
int request_code(const struct request *request, int code);

#endif
