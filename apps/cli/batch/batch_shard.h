/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which part of the poses a process answers, and the files of parts (docs/batch.md, "More than one machine"). */
#ifndef CONUS_CLI_BATCH_SHARD_H
#define CONUS_CLI_BATCH_SHARD_H

#include "options/options.h"

#include <stdbool.h>
#include <stdint.h>

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

#endif
