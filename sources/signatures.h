/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The marks by which readers know their formats: each function looks at the first bytes of a file, unpacked. */
#ifndef CONUS_SOURCES_SIGNATURES_H
#define CONUS_SOURCES_SIGNATURES_H

#include "base/files/file.h"
#include "base/text.h"

/** Bytes that the functions of NIfTI want to see, if there are as many: the header, and where CIFTI's XML begins. */
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

#endif
