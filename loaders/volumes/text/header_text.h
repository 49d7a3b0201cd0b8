/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What headers of text share: lines, fields that stand once, numbers, the file of the voxels. */
#ifndef CONUS_LOADERS_VOLUMES_TEXT_HEADER_TEXT_H
#define CONUS_LOADERS_VOLUMES_TEXT_HEADER_TEXT_H

#include "base/status.h"
#include "base/text.h"

enum {
    HEADER_TEXT_LIMIT = 1 << 24, /**< Bytes of a header of text. */
    HEADER_LINE_LIMIT = 1 << 16, /**< Lines of it.               */
    HEADER_SHOWN = 60,           /**< Bytes of a value in a message. */
};

/** Arguments for "%.*s": the beginning of the text @p t. */
#define HEADER_SHOW(t) (int)((t).size < HEADER_SHOWN ? (t).size : HEADER_SHOWN), (t).data

/** A way to write a field. */
struct header_key {
    const char *name;
    int field;
};

/** Takes the next line off @p rest, without its LF and a CR before that. False at the end. @p count counts the lines;
 * more than HEADER_LINE_LIMIT make @p status an error. */
bool header_line(struct text *rest, struct text *line, size_t *count, conus_status *status);

/** The field that @p keys, [count], call @p name, whatever the case; -1 if none. */
int header_find(const struct header_key *keys, size_t count, struct text name);

/** Puts @p value into @p slot, which must be empty (data NULL): a field may stand only once. */
conus_status header_keep(struct text *slot, struct text value, struct text name);

/** CONUS_ERROR_DATA if @p value has no data: "type: missing, ALLOWED". */
conus_status header_need(struct text value, const char *name, const char *allowed);

/** Exactly @p count numbers with white space between them. */
conus_status header_numbers(double *out, size_t count, struct text value, const char *name);

/** Whole numbers from @p least to 2^62, at most @p most of them; *count says how many there are. */
conus_status header_integers(int64_t *out, size_t most, size_t *count, struct text value, int64_t least,
                             const char *name);

/** One of them. */
conus_status header_integer(int64_t *out, struct text value, int64_t least, const char *name);

/** Copies the name of the voxels' file, which must lie in the header's folder or below it. */
conus_status header_file(char **out, struct text value, const char *name);

/** Millimetres in a unit ("mm", "um", "micron"), 0 if it is not known. */
double header_unit(struct text unit);

/** Turns the signs of x and y of @p m, a matrix of points: LPS becomes RAS. */
void header_turn_lps(double m[16]);

#endif
