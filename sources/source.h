/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What a file is: the table of formats, a file that is opened once and known by its first bytes, the marks by
 * which readers know theirs, and one map of several. */
#ifndef CONUS_SOURCES_SOURCE_H
#define CONUS_SOURCES_SOURCE_H

#include "base/files/file.h"
#include "base/job/job.h"
#include "base/status.h"
#include "base/text.h"
#include "base/threads.h"
#include "sources/names.h"

/* The formats of files that conus meets: a row each, with what a file may be given as, by its first bytes or by the
 * ending of its name. */

enum { HEAD_SIZE = 1 << 16 }; /**< Bytes that format_find() looks at, if there are as many. */

#define FORMAT_OF_VOLUME(id, name, endings) FORMAT_##id,
/** Formats that readers are chosen by. */
enum format_id {
    FORMAT_OTHER,                      /**< Of which no reader asks. */
    VOLUME_FORMATS(FORMAT_OF_VOLUME, ) /**< FORMAT_NIFTI, ...; FORMAT_HDF5 is also that of other things. */
    FORMAT_MATLAB,
    FORMAT_CIFTI,
    FORMAT_GIFTI,
    FORMAT_FREESURFER, /**< A surface, or values of its vertices. */
    FORMAT_FREESURFER_LABEL,
    FORMAT_OBJ,
    FORMAT_PLY,
    FORMAT_STL,
    FORMAT_OFF,
    FORMAT_MZ3,
    FORMAT_VTK, /**< Surfaces or lines, in the legacy format, */
    FORMAT_VTP, /**< and in XML. */
    FORMAT_TRK,
    FORMAT_TCK,
    FORMAT_TT,
    FORMAT_TRX,
    FORMAT_MATRIX,     /**< 4 x 4 numbers, of RAS or FSL's. */
    FORMAT_ITK,        /**< Transforms as text, */
    FORMAT_ITK_MATLAB, /**< and in MATLAB's level 4. */
    FORMAT_XFM,
    FORMAT_LTA,
    FORMAT_REGISTER,  /**< FreeSurfer's register.dat. */
    FORMAT_ATLAS_XML, /**< FSL's or SPM's. */
    FORMAT_MANIFEST   /**< JSON with the key "conus_atlas". */
};

/** The first bytes of a file, unpacked, and what the rows ask of them. */
struct file_head {
    struct text bytes;
    const char *path;  /**< NULL where its name does not count. */
    bool is_folder;    /**< It has no bytes. */
    bool readable;     /**< They are text. */
    struct text start; /**< Without white space at their ends. */
    struct text root;  /**< Name of the outermost element of XML, else empty. */
    int intent;        /**< Of a CIFTI-2 matrix, else 0. */
};
/** Of the first HEAD_SIZE of @p bytes, which must outlive it. */
struct file_head head_of(const char *path, const struct bytes *bytes);

enum certainty {
    KIND_CERTAIN,
    KIND_BY_NAME, /**< The ending of the name says so, not the bytes. */
    KIND_VAGUE    /**< Text in a format that the table lacks. */
};

/** A row. The marks that it has must all hold. */
struct format {
    enum format_id id;
    unsigned roles;    /**< 0 = a file that conus has no use for, or whose reader asks otherwise. */
    bool is_folder;    /**< A folder, not a file. */
    bool is_hidden;    /**< It counts only where one of its roles is asked for: others would take anything for it. */
    const char *words; /**< "a TrackVis tractogram". */
    const char *poses; /**< The word of the format of poses (poses/rows/pose_row.h) that it is; NULL: of none. */
    const char *way;   /**< Advice, or NULL: "give it as --labels". */
    enum certainty certainty;
    struct {
        const char *data;
        size_t size;
    } magic;              /**< With which the file begins. */
    int intent;           /**< Of a CIFTI-2 matrix. */
    const char *root;     /**< The outermost element of XML. */
    const char *begins;   /**< The text begins with one of these. */
    const char *mentions; /**< Words in it. */
    const char *lines;    /**< A line begins with one of these, '/' between them: a comment, or the first other one. */
    bool (*has)(const uint8_t *data, size_t size);
    bool (*is)(const struct file_head *head);
    const char *named; /**< The name ends in one of these, '/' between them, perhaps with .gz behind. */
};

/** The first row that has one of @p roles and whose marks hold; NULL if there is none. @p roles 0: of all rows but
 * hidden ones, which says what the file is. Label tables are KIND_VAGUE there, but for an atlas XML: format_nearest()
 * of the loaders knows them. */
const struct format *format_find(const struct file_head *head, unsigned roles);

/** The id of that row for a file that begins with @p bytes, whatever its name. */
enum format_id format_id_of(const struct bytes *bytes, unsigned roles);

/** Whether @p bytes, a whole file, are lines (a tractogram) in one of VTK's formats and no surface. */
bool format_is_lines(const struct bytes *bytes);

/** Fails with CONUS_ERROR_DATA and one line without the path: that the file is of @p format (NULL = not known), what is
 * needed, the way on. @p stored has its first bytes. */
conus_status format_refuse(const struct format *format, const struct bytes *stored, const char *needed);

/* A file that is opened once and known by its first bytes. */

struct source {
    char *path; /**< Owned, of source_open_atlas(); else NULL. */
    struct open_file file;
    bool is_open;
    bool is_packed;        /**< By gzip, as a whole. */
    struct bytes stored;   /**< Its first bytes, HEAD_SIZE or all. */
    struct bytes unpacked; /**< Of one that is packed: what these give; none where they are damaged. */
    struct bytes whole;    /**< source_whole() */
    struct file_head head; /**< Of `unpacked` or else `stored`. */
    char sha256[65];       /**< Of all stored bytes, once they were summed up. */
    struct thread_piece summing;
    _Atomic bool stops; /**< Nobody will ask for the sum. */
};

/** Takes "FILE,key=value" apart: keys.path is FILE, "" without memory. CONUS_ERROR_ARGUMENT where keys are refused. */
void source_keys_read(struct job *job, struct source_keys *out, const char *text, enum key_kind kind);
/** CONUS_ERROR_ARGUMENT where a key is given that is not among @p allowed (KEY_BIT()). */
void source_keys_refuse(struct job *job, const struct source_keys *keys, uint64_t allowed);

/** Opens the regular file @p path, which must live as long as the job, and looks how it begins. The path is a place,
 * which the caller enters before. NULL after a failure. The job closes it. */
struct source *source_open(struct job *job, const char *path);

/** The same of @p bytes, a file in memory called @p path or NULL; both must live as long as the job. */
struct source *source_of_memory(struct job *job, const char *path, struct text bytes);

/** Reads it unpacked, from the beginning; any number of readers may take turns. @p source may be NULL after a failure.
 */
struct reader source_reader(struct job *job, const struct source *source);

/** All its bytes, unpacked, at most the job's max_memory; what gzip packs is verified to its end. They are there until
 * source_close(), which may come before the job's end. None after a failure. */
struct bytes source_whole(struct job *job, struct source *source);

/** All of its bytes, as they are stored, at most @p limit, which --max-memory raises; they are summed up. */
struct bytes source_bytes(struct job *job, struct source *source, uint64_t limit);

/** Begins to read its bytes for its sum, beside whoever reads it meanwhile. @p source may be NULL. */
void source_sum_ahead(struct source *source);

/** The SHA-256 of its bytes as they are stored, in hexadecimal; "" after a failure. */
const char *source_sum(struct job *job, struct source *source);

/** The result is made of the file. */
void source_made_of(struct job *job, struct source *source);

void source_close(struct source *source); /**< NULL is fine. */

/** For callers without a job: looks at the whole file @p stored, or at its first bytes, which is borrowed, as the file
 * @p path. CONUS_ERROR_MEMORY. @p out is the caller's to close, also on failure. */
conus_status source_of(struct source *out, const char *path, const struct bytes *stored);

/** Likewise opens a file that is given as an atlas, which may end in ",map=K" if it is one of CIFTI labels. One that
 * cannot be read is no error: reading it says why. CONUS_ERROR_MEMORY. */
conus_status source_open_atlas(struct source *out, const char *path);

/** FORMAT_MANIFEST, FORMAT_ATLAS_XML or FORMAT_CIFTI, which name other files or have several parts; else FORMAT_OTHER.
 * All that begins with '{' is FORMAT_MANIFEST, whose parser says what is wrong with it. */
enum format_id source_scene(const struct source *source);

/** Its first character that is not white space, unless it is packed; else 0. XML and JSON are read unpacked only. */
char source_first(const struct source *source);

/** The row of the file or folder @p path, as of format_find(); NULL if it has none or cannot be read.
 * CONUS_ERROR_MEMORY. */
conus_status source_find(const struct format **out, const char *path, unsigned roles);
const struct format *source_format(struct job *job, const char *path, unsigned roles); /**< Likewise, on a job. */

/* The marks by which readers know their formats: each function looks at the first bytes of a file, unpacked. */

/** Bytes that the functions of NIfTI look at, if there are as many: the header, and where CIFTI's XML begins. */
enum { NIFTI_HEAD_SIZE = 1024 };
enum { NIFTI1_SIZE = 348, NIFTI2_SIZE = 540, MGH_HEADER_SIZE = 284 };

/** True where @p data begins with the size of a NIfTI (or ANALYZE) header in either byte order. */
bool nifti_is(const uint8_t *data, size_t size);

/** Whether a header for which nifti_is() is true is NIfTI-1. */
bool nifti_is_version_1(const uint8_t *data);

/** Whether a header for which nifti_is() is true has the magic bytes @p name, "n+" or "ni", of its version. */
bool nifti_magic_is(const uint8_t *data, size_t size, const char *name);

/** True where @p data is a NIfTI header with its magic bytes. */
bool nifti_has_magic(const uint8_t *data, size_t size);

enum { NIFTI_DENSE_LABELS = 3007 };  /**< Intent code of a .dlabel.nii. */
enum { NIFTI_CIFTI_XML = 32 };       /**< Code of the extension that holds CIFTI's XML. */
enum { NIFTI_EXTENSION_LEAST = 16 }; /**< Bytes of the smallest extension. */

/** Intent code of the CIFTI-2 file, a NIfTI-2 file without a grid, that begins with @p data; 0 if it is none. Where its
 * XML says what it holds, the code is that of this: programs write 3000 for everything. */
int nifti_matrix_intent(const uint8_t *data, size_t size);

/** True where @p data begins like an MGH header: version 1, then a width below 2^24. */
bool mgh_is(const uint8_t *data, size_t size);

/** True where @p data is the header of values of a surface's vertices: N x 1 x 1. */
bool mgh_is_of_vertices(const uint8_t *data, size_t size);

bool nrrd_is(const uint8_t *data, size_t size);
bool metaimage_is(const uint8_t *data, size_t size);
/** An AFNI data set's .HEAD. */
bool afni_is(const uint8_t *data, size_t size);

/** True where @p data begins like TIFF or BigTIFF of either byte order. */
bool tiff_is(const uint8_t *data, size_t size);

/** Streamlines of MRtrix: the words of its first line, with white space behind them. */
bool tck_is(const uint8_t *data, size_t size);

/** Streamlines of DSI Studio: a MAT-file of level 4 whose first variable is the dimension. */
bool tt_is(const uint8_t *data, size_t size);

/** True where @p data begins like a surface of FreeSurfer's, of triangles or of quadrangles. */
bool freesurfer_is_surface(const uint8_t *data, size_t size);

/** True where @p data begins like values of vertices (lh.curv, lh.thickness), which share a mark with quadrangles. */
bool freesurfer_is_curvature(const uint8_t *data, size_t size);

/** @name Transforms as text. @{ */
/** The next line that is no comment ("#"), without white space around it; false at the end. */
bool transform_line(struct text *rest, struct text *line);
/** True where the first word is a number. */
bool matrix_is(const uint8_t *data, size_t size);
/** ITK's, */
bool itk_is(const uint8_t *data, size_t size);
/** and the MNI's. */
bool xfm_is(const uint8_t *data, size_t size);
/** FreeSurfer's .lta: the first line is "type = …". */
bool lta_is(const uint8_t *data, size_t size);
/** FreeSurfer's register.dat, */
bool register_is(const uint8_t *data, size_t size);
/** of which this takes what is before its matrix: a name, voxels' edges of the movable volume in its planes and between
 * them, and an intensity. */
bool register_take_head(struct text *rest, double edges[2]);
/** @} */

/** Transforms of ITK in MATLAB's level 4, */
bool itk_matlab_is(const uint8_t *data, size_t size);
enum { ITK_MATLAB_HEAD = 20, ITK_MATLAB_NAME_LIMIT = 64 }; /**< Bytes of a matrix' header, and of its name. */
/** and the type with which each matrix begins; false where it is another. */
bool itk_matlab_type(bool *swapped, bool *single, const uint8_t *data);

/* One map of a file with several: FILE,map=K and FILE,map=NAME. */

/** Which of @p count maps called @p names (NULL entries have no name) @p wanted is: a number from 0, which is not
 * compared with the count, or a name. The first if it is empty; where there are others, a note names them. @p kind is
 * what the maps are, in words. CONUS_ERROR_ARGUMENT for a name that none or several have. */
conus_status map_choice_make(size_t *out, const char *const *names, size_t count, struct text wanted, const char *kind,
                             struct notes *notes);

#endif
