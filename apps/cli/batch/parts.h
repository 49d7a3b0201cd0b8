/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A run of a batch, and the files that it writes. */
#ifndef CONUS_CLI_BATCH_PARTS_H
#define CONUS_CLI_BATCH_PARTS_H

#include "base/writer.h"
#include "cli/batch/batch.h"
#include "options/provenance.h"
#include "settings/settings.h"

/* A long file of rows that appears whole or not at all (base/writer.h), and its sum. */

struct batch_file {
    const char *path; /**< NULL = standard output. */
    struct writer rows;
    uint64_t size; /**< Bytes so far, */
    uint32_t crc;  /**< and their CRC-32 (as in zlib, PNG and zip). */
};

/* Functions that return an int return the exit code, and print an error unless it is 0. */

/** Begins it; NULL is standard output. @p out is the caller's to batch_file_close() in any case. */
int batch_file_begin(struct batch_file *out, const char *path);

int batch_file_append(struct batch_file *file, const char *text, size_t size);

/** Gives the file its name, in the place of what is there. */
int batch_file_finish(struct batch_file *file);

/** Closes it; without a name it is gone. */
void batch_file_close(struct batch_file *file);

/** CRC-32 and number of all bytes of the file at @p path; those from byte @p from on are appended to @p to, unless that
 * is NULL. */
int batch_file_read(uint32_t *crc, uint64_t *size, const char *path, struct batch_file *to, uint64_t from);

/* The sidecar of a batch: what a report's says, and under "Batch" which poses the file answers (docs/batch.md). */

enum { BATCH_RECORD_LIMIT = 1 << 26 }; /**< Largest sidecar that is read, bytes. */

struct batch_record {
    char fingerprint[65]; /**< SHA-256 of all that the rows depend on but the shard. */
    struct shard shard;
    uint64_t first, poses, errors; /**< First pose (from 0), how many, and those without an answer. */
    uint64_t bytes, header_size;   /**< Size of the file, and of the header row in it. */
    uint32_t crc;                  /**< CRC-32 of the file's bytes. */
    const char *pose_file;         /**< As given, with the words behind it, */
    const char *pose_hash;         /**< its SHA-256, "" of standard input, */
    const char *coordsystem;       /**< The file that gives units and space of its positions; "" = none, */
    const char *coordsystem_hash;  /**< its SHA-256, */
    const char *level_file;        /**< The list of areas, "--level @FILE"; NULL = none. */
    char *const *weight_files;     /**< [2] Tables of --weight and --prior; NULL = none. */
    char *const *scalp;            /**< [2] The files of --scalp and its landmarks; NULL = none. */
    const char *probe_file;        /**< The probe that was put at each pose; NULL = none; */
    size_t contacts;               /**< and how many contacts it has. */
    double angle;                  /**< and the angle of poses without one, degrees; */
    bool has_angles, has_points;   /**< poses may have angles of their own, or be points, */
    bool has_ranges;               /**< or have ranges of their own; */
    const struct aimed *aimed;     /**< [atlases] of a part, with what was found about its poses; NULL = is not kept. */
    size_t atlases;                /**< As many as were asked. */
};

/** Fingerprint of rows: of their sidecar, which is a JSON object, without what differs between machines; the texts of
 * @p sources up to NULL; and the atlases' objects. */
int batch_fingerprint(char out[65], const char *sidecar, const struct atlases *atlases, const char *const *sources);

/** Writes the sidecar: @p text, a JSON object, with the record in it, and with @p command as the command line. */
int batch_record_write(const char *path, const char *text, const struct batch_record *record, const char *command,
                       const struct question *question);

/** Reads it back: fingerprint, shard and counts; and, unless @p found is NULL, what was found by each of @p atlases,
 * whose objects the caller checks. */
int batch_record_read(struct batch_record *out, conus_pose_findings *found, size_t atlases, const char *path);
/** The same from bytes; @p path is for messages. */
int batch_record_parse(struct batch_record *out, conus_pose_findings *found, size_t atlases, const char *path,
                       const char *text, size_t size);

/* One run of a batch, from its options to its file. */

/** Answers the poses, those of settings->part, and writes settings->output. Returns the exit code and prints an error
 * unless it is 0; 128 and more is that of a signal. */
int batch_answer(const struct batch_settings *settings, const struct arguments *arguments);

#endif
