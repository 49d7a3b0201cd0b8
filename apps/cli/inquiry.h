/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The scaffold of query, sweep, track, overlap and connect: the settings that they share, and the steps from the
 * command line to a report and its files. The question that a command asks, and its own options, are in its cmd_*.c.
 * The last two ask about no pose, and use no settings of aims, files of poses and contexts. */
#ifndef CONUS_CLI_INQUIRY_H
#define CONUS_CLI_INQUIRY_H

#include "cli/answers/answer_format.h"
#include "options/output.h"
#include "options/progress.h"
#include "settings/pose_settings.h"

struct inquiry_settings {
    struct atlas_settings atlas;
    struct aim_settings aim; /* of track: only pose, angle and space */
    struct pose_file_settings file;
    struct engine_settings engine;
    struct context_settings context;
    struct common_settings common;
    struct answer_settings answer;
};

/* Groups of options, for commands whose settings begin with those of the inquiry. */
#define INQUIRY_FIELD(member) offsetof(struct inquiry_settings, member)
#define INQUIRY_AIM_GROUPS                                                                                             \
    {"Where the cone is", aim_options, INQUIRY_FIELD(aim)}, {"", pose_file_options, INQUIRY_FIELD(file)},              \
        {"", angle_options, INQUIRY_FIELD(aim)}, {"", space_options, INQUIRY_FIELD(aim.space)},                        \
    {                                                                                                                  \
        "", shape_options, INQUIRY_FIELD(engine)                                                                       \
    }
#define INQUIRY_ENGINE_GROUPS                                                                                          \
    {"How rays are traced", engine_options, INQUIRY_FIELD(engine)},                                                    \
    {                                                                                                                  \
        "", slices_options, INQUIRY_FIELD(engine)                                                                      \
    }
#define INQUIRY_ATLAS_GROUPS                                                                                           \
    {"What can be hit", atlas_options, INQUIRY_FIELD(atlas)}, {"", shown_options, INQUIRY_FIELD(atlas)},               \
    {                                                                                                                  \
        "", context_options, INQUIRY_FIELD(context)                                                                    \
    }
#define INQUIRY_MORE_ATLASES                                                                                           \
    {                                                                                                                  \
        "", more_atlas_options, INQUIRY_FIELD(atlas)                                                                   \
    }

/** --level, of overlap and connect. */
extern const struct option inquiry_level_options[];
/** The groups of options of overlap and connect, behind their own first one. */
#define INQUIRY_NO_POSE_ATLAS_GROUPS                                                                                   \
    {"", shown_options, INQUIRY_FIELD(atlas)}, {"", inquiry_level_options, 0}, INQUIRY_MORE_ATLASES
#define INQUIRY_OUTPUT_GROUPS                                                                                          \
    {"What is written", format_options, INQUIRY_FIELD(answer)},                                                        \
    {                                                                                                                  \
        "", answer_output_options, INQUIRY_FIELD(answer)                                                               \
    }

/** The selector and the report of one atlas. */
struct answerer {
    conus_selector *selector;
    conus_aims *aims;
    conus_report *report; /**< That of the first atlas has the answers of all. */
};

/** A query, sweep or track under way. */
struct inquiry {
    const struct inquiry_settings *settings;
    const struct arguments *arguments;
    conus_format format;
    char *command_line;
    char *sidecar;          /**< Path; NULL if there is none to write. */
    struct outputs outputs; /**< All files that are written. */
    struct atlases atlases;
    conus_frame frame;          /**< The space of positions, once the atlases are loaded. */
    struct answerer *answerers; /**< [atlases.count] */
    conus_pose_list *poses;     /**< All of a file; or */
    conus_pose_stream *stream;  /**< one after the other; or both NULL. */
    bool failed;                /**< Some poses had no answer. */
    struct progress progress;   /**< The poses of a file, or the steps of each, */
    size_t steps;               /**< how many each has; 0 = 1, */
    size_t row;                 /**< and which one is being answered, from 0. */
};

/** Whether --slices, --score, --context, --angle and --radius fit together; prints an error if not. */
bool inquiry_check(const struct inquiry_settings *settings, const struct arguments *arguments, bool has_history);

/** Finds format and sidecar. Returns the exit code and prints an error unless it is 0; @p out is the caller's to
 * inquiry_finish() in any case. So do all functions below that return an int. */
int inquiry_init(struct inquiry *out, const struct inquiry_settings *settings, const struct arguments *arguments);
void inquiry_finish(struct inquiry *inquiry);

/** Checks that all outputs are different files, none is a file that is read, @p matrix (NULL = none) or the atlas's
 * among them, and none is there already, unless --force is given. */
int inquiry_check_outputs(const struct inquiry *inquiry, const char *matrix);

/** Adds what was asked, answers about a cone or cylinder, and what was read besides the atlases: the poses, their
 * coordinate system, the areas of --level. */
void inquiry_list_inputs(struct provenance *out, const struct inquiry *inquiry);

/** The options of the library for the file of poses. */
conus_pose_options inquiry_pose_options(const struct inquiry *inquiry);
/** Loads --pose, where it was given. */
int inquiry_load_poses(struct inquiry *inquiry);
/** Loads the atlas with its pathways, those of --atlas, and the context of each; and the poses by @p load_poses, before
 * that where they do not need an atlas. */
int inquiry_load(struct inquiry *inquiry, int (*load_poses)(void *user), void *user);
/** Loads the atlas and those of --atlas, each with the context. inquiry_load() does. */
int inquiry_load_atlases(struct inquiry *inquiry);
/** Whether the poses' space can be that of each atlas. */
int inquiry_match(struct inquiry *inquiry);

/** Makes the selectors; the device has @p options. */
conus_status inquiry_start(struct inquiry *inquiry, const conus_selector_options *options);
/** The options of the reports that every command sets alike. */
conus_report_options inquiry_report_options(const struct inquiry *inquiry);
/** Makes the report of atlas @p index, after those before it, and joins it with the first. */
conus_status inquiry_report(struct inquiry *inquiry, size_t index, const conus_report_options *options);
/** Makes all reports with the same options. */
conus_status inquiry_reports(struct inquiry *inquiry, const conus_report_options *options);
/** Makes selectors that trace no ray, and the reports with @p options. */
int inquiry_start_without_rays(struct inquiry *inquiry, const conus_report_options *options);

/** Counts a pose for each atlas, among those whose notes inquiry_say_aims() prints. */
void inquiry_count_pose(struct inquiry *inquiry, size_t line, const conus_pose *pose, double angle);

/** Counts a point for each atlas, among the same. */
void inquiry_count_point(struct inquiry *inquiry, size_t line, const double point[3], double radius);

/** The row's angle, radians; without one that of --angle. */
double inquiry_angle(const struct inquiry *inquiry, const conus_pose_row *row);
/** Begins to show how many of the steps of @p rows rows are done; inquiry_each_row() does. */
void inquiry_start_progress(struct inquiry *inquiry, size_t rows);
/** Shows how many steps of the row that is being answered are done. */
void inquiry_show_step(struct inquiry *inquiry, size_t done);
/** Answers each row of the list by @p answer, and shows how far that is. */
int inquiry_each_row(struct inquiry *inquiry, int (*answer)(void *user, const conus_pose_row *row), void *user);
/** Prints why a row has no answer. */
int inquiry_skip_row(struct inquiry *inquiry, const conus_pose_row *row, const char *why);
/** The same, and the reports have a row that says it. */
int inquiry_refuse_row(struct inquiry *inquiry, const conus_pose_row *row, const char *why);

/** Prints the notes about the atlases, unless --quiet. */
void inquiry_say_notes(const struct inquiry *inquiry);
/** Prints, likewise, that cones lie or point where they hardly should. */
void inquiry_say_aims(const struct inquiry *inquiry);

/** The exit code after @p code: EXIT_DIFFERENT where all went well but for some poses. */
int inquiry_code(const struct inquiry *inquiry, int code);

#endif
