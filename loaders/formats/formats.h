/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of files that conus meets, by their first bytes or by the ending of their name. */
#ifndef CONUS_LOADERS_FORMATS_FORMATS_H
#define CONUS_LOADERS_FORMATS_FORMATS_H

#include "base/files/file.h"

enum { FILE_KIND_HEAD = 1 << 16 }; /**< Bytes that format_find() wants to see, if there are as many. */

/** The reader of a file that is given as ATLAS. */
enum format_reader {
    READER_VOLUME,    /**< Also the reader of files that no atlas can be: its message says so. */
    READER_MANIFEST,  /**< JSON with the key "conus_atlas". */
    READER_ATLAS_XML, /**< FSL's or SPM's. */
    READER_CIFTI,     /**< A .dlabel.nii. */
    READER_SURFACE    /**< GIFTI or FreeSurfer; the surfaces of other programs go by their names. */
};

enum kind_certainty {
    KIND_CERTAIN,
    KIND_BY_NAME, /**< The ending of the name says so, not the bytes. */
    KIND_VAGUE    /**< Text in a format that the table lacks. */
};

struct file_kind {
    const char *words; /**< "a TrackVis tractogram".                                    */
    const char *way;   /**< Advice, or NULL: "give it as --labels". */
    enum format_reader reader;
    enum kind_certainty certainty;
};

/** The format of a file with the first bytes @p head, unpacked; NULL if it is not known. The ending of @p path decides
 * where the bytes do not; it may be NULL. Label tables are KIND_VAGUE here, but for an atlas XML: file_kind_of() knows
 * them. */
const struct file_kind *format_find(const char *path, const struct bytes *head);

/** The kind of the CIFTI-2 file with @p intent_code, 3000 to 3099; @p head are its first bytes. */
const struct file_kind *format_find_matrix(int intent_code, const struct bytes *head);

/** Whether @p bytes, a whole file, are lines (a tractogram) in one of VTK's formats and no surface. */
bool format_is_lines(const struct bytes *bytes);

/** The first bytes of @p stored, unpacked if they are packed: all of them, or FILE_KIND_HEAD. False where they are not
 * packed, or damaged; else @p head is the caller's to finish. */
bool format_unpack_head(struct bytes *head, const struct bytes *stored);

/** Fails with CONUS_ERROR_DATA and one line without the path: that the file is a @p kind (NULL = not known), what is
 * needed, the way on. @p stored has its first bytes. */
conus_status format_fail(const struct file_kind *kind, const struct bytes *stored, const char *needed);

#endif
