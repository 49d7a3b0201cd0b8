/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes whose header is text: the tables of their keys, and what they describe. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_TEXT_VOLUME_H
#define CONUS_LOADERS_VOLUMES_TEXT_TEXT_VOLUME_H

#include "atlas/labels/labels.h"
#include "base/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Headers of text, by tables: a row says how a key is written, how its value is, and where in the format's own
 * struct that goes. */

enum {
    HEADER_TEXT_LIMIT = 1 << 24, /**< Bytes of a header of text. */
    HEADER_LINE_LIMIT = 1 << 16, /**< Lines of it.               */
    HEADER_SHOWN = 60,           /**< Bytes of a value in a message. */
    HEADER_ROW_LIMIT = 40,       /**< Rows of a table. */
    HEADER_LIST_LIMIT = 4        /**< Numbers of a list. */
};

/** Arguments for "%.*s": the beginning of the text @p t. */
#define HEADER_SHOW(t) TEXT_SHOW(t, HEADER_SHOWN)

/** How a value is written, and the member that it becomes. */
enum header_kind {
    HEADER_TEXT,     /**< struct text, the job's. */
    HEADER_WORD,     /**< int: the value of one of row.words. */
    HEADER_INTEGER,  /**< int64_t, row.least or more. */
    HEADER_INTEGERS, /**< struct header_list of such. */
    HEADER_NUMBER,   /**< double */
    HEADER_UNUSED    /**< Not looked at. */
};

struct header_word {
    const char *names; /**< With '/' between them; NULL ends the list. */
    int value;
};

struct header_list {
    int64_t values[HEADER_LIST_LIMIT];
    size_t count;
};

/** A key, which may stand only once. What a header does not say stays as it is in the struct. */
struct header_row {
    const char *names; /**< With '/' between them; messages use the first. */
    enum header_kind kind;
    size_t place;        /**< Offset in the struct. */
    const char *missing; /**< The message where the key is missing; NULL: it may be missing. */
    const struct header_word *words;
    const char *allowed;  /**< "allowed are ...": of words. */
    conus_status refused; /**< The status for a word that is not in the table; 0 = CONUS_ERROR_DATA. */
    bool exact;           /**< Upper and lower case of words differ. */
    int64_t least;
    /** Called after the value is taken, also where the key is missing (value.data NULL); NULL = nothing to do. */
    void (*check)(struct job *job, void *header, struct text value);
};

struct header_table {
    const struct header_row *rows;
    size_t count;
    bool exact; /**< Upper and lower case of keys differ. */
};

/** The value of each row, the job's; data is NULL where it is missing. */
struct header_values {
    struct text of[HEADER_ROW_LIMIT];
};

/** The next line, as of reader_line(); false at the end. @p count counts the lines, at most HEADER_LINE_LIMIT. */
bool header_line(struct reader *r, struct text *line, size_t *count);

/** Puts a copy of @p value into the row of the key @p name; false where there is none. */
bool header_keep(struct job *job, struct header_values *values, const struct header_table *table, struct text name,
                 struct text value);

/** Whether there is a value of the row whose first name is @p name. */
bool header_has(const struct header_values *values, const struct header_table *table, const char *name);

/** Reads the values into the format's struct @p header, row by row. */
void header_take(struct job *job, void *header, const struct header_table *table, const struct header_values *values);

/** The value of the word that is @p text; -1 if none is. */
int header_word(const struct header_word *words, struct text text, bool exact);

/** Puts a copy of @p value into @p slot, which must be empty (data NULL): a key may stand only once. */
void header_once(struct job *job, struct text *slot, struct text value, struct text name);

/** An error if @p value has no data: "type: missing, ALLOWED". */
void header_need(struct job *job, struct text value, const char *name, const char *allowed);

/** Exactly @p count numbers with white space between them. */
void header_numbers(struct job *job, double *out, size_t count, struct text value, const char *name);

/** A whole number from @p least to 2^62. */
int64_t header_integer(struct job *job, struct text value, int64_t least, const char *name);

/** The name of the voxels' file, which must lie in the header's folder or below it. A list or pattern of files, as
 * "LIST" (with @p exact in capitals only) and "%03d.raw 1 9 1" are, is CONUS_ERROR_UNSUPPORTED: "@p name: found ...,
 * @p allowed". */
char *header_file(struct job *job, struct text value, const char *name, const char *allowed, bool exact);

/** Millimetres in a unit ("mm", "um", "micron"), 0 if it is not known. */
double header_unit(struct text unit);

/** Turns the signs of x and y of @p m, a matrix of points: LPS becomes RAS. */
void header_turn_lps(double m[16]);

/* A volume as its header of text describes it, in any of the formats of this folder. */

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

/* The parsers of the formats, which sources/source.h tells apart. Errors name the field. */

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
