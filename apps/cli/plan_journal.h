/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * How far a plan has come, in FILE.journal beside its list FILE: for --resume, --shard and --merge. It has numbers of
 * candidates, which are tried again. */
#ifndef CONUS_CLI_PLAN_JOURNAL_H
#define CONUS_CLI_PLAN_JOURNAL_H

#include "batch/batch_settings.h"
#include "cli/request.h"

struct journal_settings {
    const char *shard;
    bool resume;
    struct option_list merge;
};

extern const struct option journal_options[]; /**< For struct journal_settings. */

struct plan_journal {
    const struct journal_settings *settings;
    char *path; /**< NULL = there is none. */
    int lock;   /**< Descriptor of its file, which no other conus can lock meanwhile; 0 = there is none yet. */
    const char *command;
    char fingerprint[65]; /**< SHA-256 of all that the list depends on but the shard. */
    struct shard shard;
    uint64_t rows, count; /**< All shards' number of rows, and this one's. */
    double next;          /**< When it is written again, by clock_ms(). */
    int code;             /**< Exit code of writing. */
};

/* Functions that return an int return the exit code, and print an error unless it is 0. */

/** Checks the options, and whether there is a journal already. @p replaces: whether what is there may be replaced,
 * since it is to be, or is this plan's. @p out is the caller's to plan_journal_finish() in any case. */
int plan_journal_init(struct plan_journal *out, bool *replaces, const struct journal_settings *settings,
                      const struct request *request);

/** Turns the poses of the request to the rows of the shard, and has @p plan take over what journals know of them. The
 * list depends on the files of @p inputs. */
int plan_journal_open(struct plan_journal *journal, conus_plan *plan, const struct request *request,
                      const struct provenance *inputs);

/** Writes it, if it is time or @p now. */
int plan_journal_write(struct plan_journal *journal, conus_plan *plan, bool now);

/** To be called after the list is written, or where there is none since the journal knows of no pose. Removes the
 * journal, unless a shard or a later --resume needs it. */
void plan_journal_end(const struct plan_journal *journal, bool knows_poses);
void plan_journal_finish(struct plan_journal *journal);

/** Whether the file @p list has the journal of a plan beside it. */
bool plan_journal_is_of(const char *list);

#endif
