/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Batches: the options, which part of the poses is answered, and the way to each file of rows. */
#ifndef CONUS_CLI_BATCH_BATCH_H
#define CONUS_CLI_BATCH_BATCH_H

#include "cli/answers/answers.h"
#include "conus/report.h"
#include "options/options.h"
#include "settings/settings.h"

#include <stdbool.h>
#include <stdint.h>

/* Which part of the poses a process answers, and the files of parts (docs/batch.md, "More than one machine"). */

/** Part @p index, from 0, of @p count blocks of consecutive poses. */
struct shard {
    uint64_t index, count;
    bool all; /**< Every part that is not there, and then all of them joined; index is 0. */
};

enum { SHARD_LIMIT = 1000000 }; /**< Parts, at most. */

/** Reads --shard: "I/N", "all/N", or "auto", which asks the environment and says what it found; NULL is 0/1. Returns
 * the exit code and prints an error unless it is 0. */
int shard_read(struct shard *out, const char *text, bool quiet);

/** Where the part of @p total poses begins and how many it has. Parts differ by one at most; the first have more. */
void shard_range(uint64_t *first, uint64_t *count, struct shard shard, uint64_t total);

/** The file of the part: "rows.03-of-16.tsv" of "rows.tsv"; of 0/1 @p path. NULL without memory; the caller
 * frees it. */
char *shard_path(const char *path, struct shard shard);

/** Whether no part of the file @p path is there that is one of another number of parts than @p count: of these some may
 * be answered already. Returns the exit code and prints an error unless it is 0. */
int shard_check_others(const char *path, uint64_t count);

/** The command line, in which --shard names the part. Likewise. */
char *shard_words(const struct arguments *arguments, struct shard shard);

/* The options of `conus batch`. */

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
bool batch_format(const char **out, const struct batch_settings *settings, const struct arguments *arguments);

/* The way of every batch: from the command line to one run for each file of rows. */

/** Writes each file that the command line asks for, as long as all is well. Gives the most serious exit code, and
 * prints an error about files that exclude each other. */
int batch_dispatch(const struct batch_settings *settings, const struct arguments *arguments);

#endif
