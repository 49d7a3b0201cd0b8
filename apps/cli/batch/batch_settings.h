/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The options of `conus batch`. */
#ifndef CONUS_CLI_BATCH_SETTINGS_H
#define CONUS_CLI_BATCH_SETTINGS_H

#include "cli/answers/ends.h"
#include "cli/batch/batch_shard.h"
#include "conus/report.h"
#include "settings/pose_settings.h"
#include "settings/settings.h"

struct batch_settings {
    struct atlas_settings atlas;
    struct aim_settings aim; /* angle, aperture and space only */
    struct pose_file_settings file;
    struct probe_settings probe;
    struct keep_settings keep;
    struct engine_settings engine;
    struct common_settings common;
    struct context_settings context;
    const char *poses;
    const char *output;
    size_t format; /* batch_format() */
    bool summary;
    struct axis_settings axis;
    const struct rows_kind *of_axis; /* no option: the rows of this run, whose file is the output; NULL = answers */
    bool is_again; /* no option: an earlier run over the same poses has said what there is to say about them */
    const char *shard;
    struct shard part; /* no option: what --shard means */
    uint32_t threads, block;
    bool force;
    size_t progress; /* enum progress_kind */
};

extern const struct option_group batch_groups[]; /**< For struct batch_settings. */

/** The format of the rows: --format (not that of rows about axes besides answers), else what the ending of --output
 * says, TSV where that is no file. False, after an error message, for a file whose ending says nothing. */
bool batch_format(conus_format *out, const struct batch_settings *settings, const struct arguments *arguments);

#endif
