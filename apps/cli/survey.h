/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The scaffold of overlap and connect, which ask atlases about something else than a pose: the settings that the two
 * share, and the steps from the command line to a report and its files. */
#ifndef CONUS_CLI_SURVEY_H
#define CONUS_CLI_SURVEY_H

#include "cli/answers/answer_format.h"
#include "options/output.h"
#include "settings/atlases.h"

/** The settings of overlap and connect begin with these. */
struct survey_settings {
    struct atlas_settings atlas;
    struct common_settings common;
    struct answer_settings answer;
    struct engine_settings engine; /**< level only */
};

/** --level, of settings that begin so. */
extern const struct option survey_level_options[];

#define SURVEY_FIELD(member) offsetof(struct survey_settings, member)
/** Groups of what is asked, after their own first one. */
#define SURVEY_ATLAS_GROUPS                                                                                            \
    {"", shown_options, SURVEY_FIELD(atlas)}, {"", survey_level_options, 0},                                           \
    {                                                                                                                  \
        "", more_atlas_options, SURVEY_FIELD(atlas)                                                                    \
    }
#define SURVEY_OUTPUT_GROUPS                                                                                           \
    {"What is written", format_options, SURVEY_FIELD(answer)},                                                         \
    {                                                                                                                  \
        "", answer_output_options, SURVEY_FIELD(answer)                                                                \
    }

/** The selector and the report of one atlas. */
struct surveyor {
    conus_selector *selector;
    conus_report *report; /**< The first one's has the others' joined. */
};

/** An answer under way. */
struct survey {
    const struct survey_settings *settings;
    const struct arguments *arguments;
    conus_format format;
    char *command_line;
    char *sidecar; /**< Path; NULL = none. */
    struct atlases atlases;
    struct surveyor *surveyors; /**< [atlases.count] */
};

/** Finds format, command line and sidecar. Returns the exit code and prints an error unless it is 0, as those below do.
 * End it with survey_finish() even then. */
int survey_init(struct survey *out, const struct survey_settings *settings, const struct arguments *arguments);
void survey_finish(struct survey *survey);

/** Loads ATLAS and those of --atlas. */
int survey_load(struct survey *survey);

/** The options of the report about atlas @p index: @p rows with its format, command and name. */
conus_report_options survey_report_options(const struct survey *survey, const conus_report_options *rows, size_t index);

/** Makes selectors and reports; --level is of the first atlas. */
int survey_start(struct survey *survey, const conus_report_options *rows);

/** Checks that the outputs are different files, that none is a file that is read of all atlases and settings, and none
 * is there already, unless --force is given. */
int survey_check_outputs(const struct survey *survey);

/** Says what there is to note about the atlases, and adds what was asked and what settings read to @p provenance. */
void survey_describe(const struct survey *survey, struct provenance *provenance, const char *rows, const char *region);

/** Writes the answer and its sidecar. */
int survey_write(const struct survey *survey, const struct provenance *provenance);

#endif
