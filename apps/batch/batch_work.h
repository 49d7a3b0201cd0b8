/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A batch under way, as far as conus batch and conus-mpi batch do the same. */
#ifndef CONUS_BATCH_BATCH_WORK_H
#define CONUS_BATCH_BATCH_WORK_H

#include "batch/batch_record.h"

/** The first pose that has no answer. */
struct first_error {
    uint64_t line; /**< In the file of poses; 0 = there is none. */
    char why[512];
};

struct work {
    const struct batch_settings *settings;
    const struct arguments *arguments;
    const char *output; /**< NULL = stdout */
    char *sidecar;      /**< Path; NULL without output. */
    char *command_line;
    conus_format format;
    conus_contacts contacts; /**< Of --contacts. */
    struct shard shard;
    uint64_t first, count; /**< Poses to answer; count UINT64_MAX = all from there on. */
    conus_pose_stream *poses;
    bool piped; /**< They can be read only once: from standard input or a pipe that has a name. */
    struct atlases atlases;
    conus_frame frame;          /**< Of positions. */
    conus_selector **selectors; /**< [atlases.count] */
    conus_astray *astray;       /**< [atlases.count] Where the poses lie and point, once work_find_aims() was called. */
    conus_batch *batch;
    struct first_error first_error; /**< Of this run. */
    char fingerprint[65], pose_hash[65];
};

/** Whether poses at @p path can be read only once: "-", a pipe or a device. */
bool work_is_pipe(const char *path);

/* All others return the exit code and print an error unless it is 0. */

/** Checks the options and names the files and the atlases. @p out is the caller's to work_finish() in any case. */
int work_init(struct work *out, const struct batch_settings *settings, const struct arguments *arguments);
void work_finish(struct work *work);

/** Opens the poses and loads the atlases, but those that the work has already. */
int work_open(struct work *work);

/** Makes the batch, and says what there is to say about the atlases. */
int work_build(struct work *work);

/** Goes on to the pose that is @p poses farther. */
int work_pass_over(struct work *work, uint64_t poses);

/** Finds the fingerprint. */
int work_identify(struct work *work);

/** Prints an error unless the poses that were read are those that the fingerprint is of. The rest is read, too. */
int work_check_poses(struct work *work);

/** Prints an error where something stands in the way of a new output. */
int work_check_output(const struct work *work);

/** Keeps the first pose of the block that has no answer, unless there was one before. */
void work_keep_error(struct work *work, const conus_batch_block *block);

/** Prints how many of @p poses poses, @p errors, have no answer, with the first of this run; nothing where all have. */
void work_say_errors(const struct work *work, uint64_t poses, uint64_t errors);

/** Takes from the batch where the poses that it answered lie and point, */
void work_find_aims(struct work *work);
/** and says it. */
void work_say_aims(const struct work *work);

/** Writes the sidecar; of @p record, what the work knows itself is filled in. */
int work_write_sidecar(struct work *work, struct batch_record *record);

#endif
