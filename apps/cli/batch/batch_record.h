/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The sidecar of a batch: what a report's says, and under "Batch" which poses the file answers (docs/batch.md). */
#ifndef CONUS_CLI_BATCH_RECORD_H
#define CONUS_CLI_BATCH_RECORD_H

#include "cli/batch/batch_shard.h"
#include "options/provenance.h"
#include "settings/notes.h"

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

#endif
