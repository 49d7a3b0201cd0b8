/* SPDX-License-Identifier: BSD-3-Clause */
/** @file One run of a batch, from its options to its file, as conus batch and conus-mpi batch share it. The functions
 * are in the order in which they are called. */
#ifndef CONUS_BATCH_BATCH_TASK_H
#define CONUS_BATCH_BATCH_TASK_H

#include "batch/batch_file.h"
#include "batch/batch_record.h"
#include "options/progress.h"
#include "settings/named_places.h"
#include "settings/notes.h"

/** The first pose that has no answer. */
struct first_error {
    uint64_t line; /**< In the file of poses; 0 = there is none. */
    char why[512];
};

struct batch_task {
    char point_error[256], understood[96]; /* about poses that are points */
    const struct batch_settings *settings;
    const struct arguments *arguments;
    const char *output; /**< NULL = stdout */
    char *sidecar;      /**< Path; NULL without output. */
    char *command_line;
    conus_format format;
    conus_contacts contacts; /**< From --contacts. */
    double within;           /**< From --clearance, mm. */
    size_t notes_said;       /**< Of the poses. */
    struct shard shard;
    uint64_t first, count; /**< Poses to answer; count UINT64_MAX = all from there on. */
    conus_pose_stream *poses;
    bool piped; /**< The poses can be read only once: from standard input or a named pipe. */
    struct atlases atlases;
    conus_frame frame;          /**< The space of positions. */
    struct named_places places; /**< How the question was understood. */
    conus_row_marks marks;      /**< What tells rows apart. */
    struct kept_names kept;     /**< From --keep. */
    conus_probe *probe;         /**< From --probe; NULL = none. */
    struct aimed *aimed; /**< [atlases.count] With what is found about the poses, after batch_task_find_astray(). */
    conus_batch *batch;
    struct batch_file file; /**< The output, and how many poses are answered. With MPI only rank 0 opens it. */
    struct progress progress;
    struct first_error first_error; /**< Among the poses answered since the run began. */
    char fingerprint[65], pose_hash[65];
};

/* Functions that return an int return the exit code, and print an error unless it is 0. */

/** Checks the options and names the files and the atlases. @p out is the caller's to batch_task_finish() in any case.
 */
int batch_task_init(struct batch_task *out, const struct batch_settings *settings, const struct arguments *arguments);

/** Opens the poses, and loads the atlases except those that the run already has. */
int batch_task_open(struct batch_task *task);

/** Creates the batch, and prints the notes about the atlases. */
int batch_task_build(struct batch_task *task);

/** Opens the output as --force and --resume say; task->file then knows how many poses are answered. Where an earlier
 * run has written all of them, which only --resume accepts, task->file.is_finished. */
int batch_task_open_output(struct batch_task *task);

/** Skips the next @p poses poses. */
int batch_task_skip(struct batch_task *task, uint64_t poses);

void batch_task_start_progress(struct batch_task *task);

/** Keeps the first pose of the block that has no answer, unless an earlier one is kept. */
void batch_task_keep_error(struct batch_task *task, const conus_batch_block *block);

/** Prints how many poses have no answer, with the first of this run; nothing where all have. */
void batch_task_say_errors(const struct batch_task *task);

/** Sets what is found in task->aimed from the poses that the batch answered. */
void batch_task_find_astray(struct batch_task *task);
/** Prints it. */
void batch_task_say_astray(const struct batch_task *task);

/** The command line that resumes what @p arguments began, for the caller to free; NULL without memory. */
char *batch_resuming(const struct arguments *arguments);

/** Prints that @p signal ended the run, and which command resumes it. */
int batch_task_interrupted(const struct batch_task *task, int signal);

/** Fails if the file of poses has changed since the fingerprint was taken. Reads the rest of it. */
int batch_task_check_poses(struct batch_task *task);

/** Writes the sidecar and gives the file its name. */
int batch_task_finish_output(struct batch_task *task);

void batch_task_finish(struct batch_task *task);

#endif
