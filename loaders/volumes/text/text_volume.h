/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A volume as its header of text describes it, in any of the formats of this folder. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_TEXT_VOLUME_H
#define CONUS_LOADERS_VOLUMES_TEXT_TEXT_VOLUME_H

#include "atlas/labels/labels.h"
#include "base/job/reader.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** How the voxels are stored. */
enum text_encoding {
    TEXT_RAW,
    TEXT_GZIP,
    TEXT_ZLIB,
    TEXT_NUMBERS, /**< Decimal numbers with white space between them. */
    TEXT_HEX,     /**< Two hexadecimal digits a byte.                 */
};

/** The type of a voxel: 'u' unsigned, 'i' signed, 'f' floating point; its bytes: 1, 2, 4, 8. */
struct text_type {
    char kind;
    size_t size;
};

/** A label that the header names, in one of the volumes. */
struct text_segment {
    struct label label;
    size_t volume;
};

/** Texts and arrays are those of the job that has read it. */
struct text_volume {
    const char *format; /**< "NRRD"; static.                                                                   */
    struct text_type type;
    bool big_endian;
    int64_t dim[3];
    int64_t count;               /**< Volumes. Sizes are 1 or more, but not yet multiplied. */
    bool interleaved;            /**< All volumes' values of a voxel lie together.                              */
    double world_from_voxel[16]; /**< To RAS mm; column-major.                                                  */
    char transform[64];          /**< Where that comes from.                                                    */
    bool has_unit;               /**< The header states the unit of these. */
    int space_code;              /**< NIfTI's code of the space; 0 if unknown.                                  */
    enum text_encoding encoding;
    uint64_t header_size; /**< Bytes of the header in its file.                                                 */
    char *file;           /**< File of the voxels, beside the header; NULL: they follow the header. */
    bool brik;            /**< ... in AFNI's .BRIK beside it, perhaps packed.                                   */
    uint64_t line_skip;   /**< Lines before the voxels, as stored.                                              */
    uint64_t byte_skip;   /**< Bytes before them, unpacked.                                                     */
    bool at_end;          /**< They are the last bytes of their file; nothing is skipped.                       */
    uint64_t packed_size; /**< Packed bytes; 0: up to the end of the file.                                      */
    struct text_segment *segments;
    size_t segment_count;
    double *slopes; /**< [count], or NULL: unscaled.                                                            */
    char **titles;  /**< [count] names of the volumes, each NULL where it has none; or NULL.                    */
    char *labels;   /**< A label table as text; NULL if none.                                                   */
};

/** Adds the labels that the header gives to volume @p index to the empty @p table, sorted. */
void text_volume_labels(struct job *job, struct label_table *table, const struct text_volume *volume, size_t index);

/* The parsers of the formats, which sources/signatures.h tells apart. Errors name the field. */

/** NRRD, attached (.nrrd) and detached (.nhdr), versions 1 to 5 (teem, "Definition of NRRD File Format"), with the
 * segments that 3D Slicer writes into them (.seg.nrrd). */
void nrrd_parse(struct job *job, struct text_volume *out, struct reader r);

/** MetaImage, with the voxels behind the header (.mha) or in another file (.mhd): "key = value" lines of ITK's MetaIO,
 * of which the first but comments is ObjectType or NDims. ITK places them in LPS. */
void metaimage_parse(struct job *job, struct text_volume *out, struct reader r);

/** AFNI's headers (.HEAD), whose voxels lie in a .BRIK (AFNI, "README.attributes"): they begin with "type = ". AFNI's
 * DICOM order is LPS. */
void afni_parse(struct job *job, struct text_volume *out, struct reader r);

#endif
