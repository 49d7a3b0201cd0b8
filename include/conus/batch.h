/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file batch.h
 * Poses by the million, answered by threads in blocks: of a stream as text, of arrays as arrays.
 */
#ifndef CONUS_PUBLIC_BATCH_H
#define CONUS_PUBLIC_BATCH_H

#include <conus/pose_check.h>
#include <conus/report.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Streams and text
 * @{ */

typedef struct conus_batch conus_batch; /**< Threads made ready to answer poses by the million. */

/** How a batch answers. */
typedef struct conus_batch_options {
    size_t struct_size; /**< Its size, as #CONUS_BATCH_OPTIONS_INIT sets it; 0 = that of this version. */
    uint32_t threads;   /**< Threads that answer poses, up to 1024; 0 = as many as processors that the process may use.
                           With the gl engine one of them has the device at a time. */
    uint32_t block;     /**< Poses per block, up to 65536; 0 = 256. Memory grows with threads times block. */
    double angle;       /**< For poses that have none of their own, radians; 0 = 10 degrees, or a cylinder's 0. */
    conus_report_options report; /**< Its format is neither #CONUS_FORMAT_TABLE nor #CONUS_FORMAT_JSON. A probe,
                                    #CONUS_FORMAT_SPIKEGLX or #CONUS_FORMAT_OPEN_EPHYS, is one block of up to 65535
                                    contacts, whatever block says, and must be all that is in the stream. With a
                                    probe, one of a file, it is put at each pose of the stream: its contacts are asked,
                                    within the selector's radius, and called as the pose, a colon and the contact;
                                    poses are still counted as they are in the stream, and blocks have so many contacts.
                                    Formats of other programs have no place for that. */
    const char *point_error; /**< Why a pose that is a point has no answer, for its row of kind "error"; NULL = it is
                                asked what is at it, or within the selector's radius of it: conus_select_ball(). */
} conus_batch_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_BATCH_OPTIONS_INIT CONUS_INIT_(conus_batch_options)

/** A block of poses, answered. */
typedef struct conus_batch_block {
    const char *text; /**< Their rows, without the header row. */
    size_t size;      /**< Bytes of text. */
    uint64_t poses;   /**< How many poses. */
    uint64_t errors;  /**< Poses among them that have no answer but a row of kind "error". */
    uint64_t line;    /**< Line of the first of these in its file, counted from 1, */
    const char *why;  /**< and why it has no answer; NULL where errors is 0. */
} conus_batch_block;

/**
 * Receives whole blocks in the order of the poses, on the thread that called conus_batch_run().
 * @param user The pointer that conus_batch_run() got.
 * @param block The block. Valid until the callback returns.
 * @return False ends the run with #CONUS_ERROR_CANCELLED.
 */
typedef bool (*conus_batch_sink)(void *user, const conus_batch_block *block);

/**
 * Prepares to answer with a selector.
 * @param[out] out The batch; end it with conus_batch_destroy().
 * @param selector Must outlive the batch and is not to be used during a run.
 * @param options Its report names the format, which must be given. Its strings must outlive the batch.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_batch_create(conus_batch **out, conus_selector *selector,
                                              const conus_batch_options *options);

/**
 * Adds another atlas: for each pose its rows come behind those of the atlases before it. Before the first run.
 * @param batch Its options have a name in report.atlas.
 * @param selector Of the atlas, with the options of the batch's but level. Must outlive the batch and is not to be used
 * during a run.
 * @param atlas Its name for the column `atlas`. Copied.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a name that is missing or another's, and for a selector with other
 * options. The batch is unchanged then.
 * @threads One at a time for each @p batch and @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_batch_add(conus_batch *batch, conus_selector *selector, const char *atlas);

/**
 * Ends a batch.
 * @param batch NULL is allowed.
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_API void conus_batch_destroy(conus_batch *batch);

/**
 * Gives the number of threads that will be used.
 * @param batch The batch.
 * @return At least 1.
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_API uint32_t conus_batch_threads(const conus_batch *batch);

/**
 * Answers poses, in memory that does not grow with them. The text is the same, byte for byte, for any number of threads
 * and any size of blocks. A pose that cannot be answered gives a row of kind "error". Another failure ends the run;
 * what comes before it has been delivered then. It may be called again, but a live stream ends with a run that the sink
 * or a failure ended.
 * @param batch The batch.
 * @param poses The stream.
 * @param limit Poses to answer at most.
 * @param sink Receives the blocks.
 * @param user Passed to @p sink.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where @p poses keeps another number of columns than the marks of the report
 * have; #CONUS_ERROR_CANCELLED where @p sink ends the run; the errors of conus_pose_stream_read() and conus_select().
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_batch_run(conus_batch *batch, conus_pose_stream *poses, uint64_t limit,
                                           conus_batch_sink sink, void *user);

/**
 * Gives the findings about the poses answered so far, by their lines in their file, for the first atlas.
 * @param batch The batch.
 * @return A copy.
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_API conus_pose_findings conus_batch_findings(const conus_batch *batch);

/**
 * Gives the findings for one of several atlases.
 * @param batch The batch.
 * @param index 0 is the atlas of conus_batch_create(), then those of conus_batch_add() in their order.
 * @return A copy; zero for an index that there is not.
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_API conus_pose_findings conus_batch_findings_at(const conus_batch *batch, size_t index);

/**
 * Gives the header row that belongs above the rows, with its end of line.
 * @param batch The batch.
 * @return "" where there is none. Borrowed from the batch.
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_API const char *conus_batch_header(const conus_batch *batch);

/**
 * Writes the sidecar as of conus_report_sidecar(), without the queries.
 * @param[out] text UTF-8 with a final NUL. Borrowed until the next call on the batch.
 * @param[out] size Bytes, without the NUL.
 * @param batch The batch.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected.
 * @threads One at a time for each @p batch.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_batch_sidecar(const char **text, size_t *size, conus_batch *batch);
/** @} */

/** @name Arrays
 * @{ */

/** Poses in memory: either matrices, or origins with directions, or without: points. */
typedef struct conus_pose_array {
    size_t struct_size;      /**< Its size, as #CONUS_POSE_ARRAY_INIT sets it; 0 = that of this version. */
    size_t count;            /**< How many. */
    const double *matrix;    /**< [count 16] As for conus_pose_from_matrix(); NULL = the next three. */
    const double *origin;    /**< [count 3] World mm. */
    const double *direction; /**< [count 3] Any length but 0; NULL = points, for conus_select_many() only. */
    const double *up;        /**< [count 3] As for conus_pose_along(); NULL = the default of Eq. 2. */
    const double *angle;     /**< [count] Full opening, radians; where it is 0, and where this is NULL, the options'. */
    const double *range;     /**< [count 2] As for conus_selector_set_range(), mm; NULL = the selector's options'. */
    const conus_frame *frame; /**< Devices without matrices are turned as its space has it, as by
                                 conus_frame_turn_pose(); left-handed matrices are read where that makes them. NULL =
                                 #CONUS_SPACE_RAS. */
} conus_pose_array;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_POSE_ARRAY_INIT CONUS_INIT_(conus_pose_array)

/**
 * Gives the pose that conus_select_many() answers.
 * @param[out] out The pose.
 * @param poses The arrays.
 * @param index Below its count.
 * @return #CONUS_OK; as conus_pose_from_matrix() or conus_pose_along().
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_array_at(conus_pose *out, const conus_pose_array *poses, size_t index);

/** How conus_select_many() answers. */
typedef struct conus_many_options {
    size_t struct_size; /**< Its size, as #CONUS_MANY_OPTIONS_INIT sets it; 0 = that of this version. */
    uint32_t threads;   /**< As conus_batch_options.threads. */
    uint32_t block;     /**< As conus_batch_options.block. */
    double angle;       /**< As conus_batch_options.angle. */
    double radius;      /**< Of points, mm, as for conus_select_ball(). */
} conus_many_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_MANY_OPTIONS_INIT CONUS_INIT_(conus_many_options)

/** Answers to poses that follow each other. */
typedef struct conus_answers {
    size_t first;                /**< Index of the first pose. */
    size_t poses;                /**< How many. */
    const size_t *starts;        /**< [poses + 1] The results of pose first + i are starts[i] to starts[i + 1] - 1. */
    const conus_result *results; /**< [starts[poses]] In the order of conus_selection_result(). */
    const conus_status *status;  /**< [poses] #CONUS_ERROR_ARGUMENT for a pose without an answer: a number that is not
                                    finite, say. conus_pose_array_at() or conus_select() with that pose says why. */
} conus_answers;

/**
 * Receives answers in the order of the poses, on the thread that called conus_select_many().
 * @param user The pointer that conus_select_many() got.
 * @param answers Valid until the callback returns.
 * @return False ends the run with #CONUS_ERROR_CANCELLED.
 */
typedef bool (*conus_answer_sink)(void *user, const conus_answers *answers);

/**
 * Answers poses that are in memory, with threads. The answers are the same, bit for bit, for any number of threads and
 * any size of blocks, and those of conus_select(). A pose that cannot be answered has a status and no results. After a
 * failure, @p sink has received what comes before it.
 * @param[out] findings Findings about the poses, with their indices as numbers, once all are answered; NULL = not
 * wanted.
 * @param selector Its score needs no history.
 * @param poses The arrays are only read, and not copied.
 * @param options NULL = defaults.
 * @param sink Receives the answers.
 * @param user Passed to @p sink.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range, and for arrays that are missing;
 * #CONUS_ERROR_CANCELLED where @p sink ends the run; the errors of conus_select() but those of a pose.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_select_many(conus_pose_findings *findings, conus_selector *selector,
                                             const conus_pose_array *poses, const conus_many_options *options,
                                             conus_answer_sink sink, void *user);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
