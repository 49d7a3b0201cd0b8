/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The formats of files that conus meets: a row each, with what a file may be given as, by its first bytes or by
 * the ending of its name. */
#ifndef CONUS_SOURCES_FORMAT_H
#define CONUS_SOURCES_FORMAT_H

#include "base/files/file.h"
#include "base/text.h"
#include "sources/endings.h"

enum { HEAD_SIZE = 1 << 16 }; /**< Bytes that format_find() wants to see, if there are as many. */

/** Formats that readers are chosen by. */
enum format_id {
    FORMAT_OTHER, /**< Of which no reader asks. */
    FORMAT_NIFTI,
    FORMAT_MGH,
    FORMAT_NRRD,
    FORMAT_METAIMAGE,
    FORMAT_AFNI, /**< The .HEAD, */
    FORMAT_BRIK, /**< and the voxels, which were named instead. */
    FORMAT_IMG,  /**< The voxels of a pair of NIfTI. */
    FORMAT_TIFF,
    FORMAT_ZARR,
    FORMAT_HDF5, /**< MINC 2, transforms of ITK and X5, SimNIBS, NWB. */
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
    FORMAT_MANIFEST,  /**< JSON with the key "conus_atlas". */
    FORMAT_BRAINSIGHT,
    FORMAT_LOCALITE,
    FORMAT_MARKUPS, /**< Slicer's, or another program's JSON of poses. */
    FORMAT_INVESALIUS
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
    bool is_hidden;    /**< It counts only for who asks for one of its roles: others would take anything for it. */
    const char *words; /**< "a TrackVis tractogram". */
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

#endif
