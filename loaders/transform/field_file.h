/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A file of a deformation field, as NIfTI: ITK's (ANTs), SPM's, NiftyReg's, FSL's, or one in RAS or LPS. */
#ifndef CONUS_LOADERS_TRANSFORM_FIELD_FILE_H
#define CONUS_LOADERS_TRANSFORM_FIELD_FILE_H

#include "conus/atlas.h"
#include "loaders/transform/transform_chain.h"
#include "sources/source.h"

/** Whether @p source, of a format of fields, is one and so no affine: NIfTI is in any case. Its path is the innermost
 * place. */
bool field_is(struct job *job, const struct source *source);

/** The words of field_header_words() for @p source; NULL also for what is no NIfTI file, or damaged. */
const char *field_words(bool *usable, const struct source *source);

/** Reads the field in @p source, whose path is the innermost place, for points of where poses are, as a chain of one.
 * Of @p options, from and to are FSL's images; inverse is refused. */
void field_read(struct job *job, struct transform_chain *out, struct source *source,
                const conus_transform_options *options);

/** How vectors are to be read. */
enum field_kind {
    FIELD_VECTORS, /**< ITK's or SPM's: the header does not say which. */
    FIELD_ITK,     /**< Displacements in mm, LPS.                                                          */
    FIELD_SPM,     /**< Positions in mm, RAS; also MRtrix's and NiftyReg's.                                */
    FIELD_RAS,     /**< Displacements in mm, RAS.                                                          */
    FIELD_LPS,     /**< Positions in mm, LPS.                                                              */
    FIELD_FSL,     /**< In FSL's mm of two images; positions or displacements.                             */
    FIELD_FNIRT    /**< The same, displacements.                                                           */
};

struct field_header {
    int64_t dim[8];
    int intent_code;
    char intent_name[17];
    double parameter; /**< intent_p1, by which NiftyReg tells its kinds apart. */
};

enum { FIELD_HEADER_SIZE = 540 }; /**< Bytes that field_header_parse() wants to see, if there are as many. */

/** Takes the fields from @p head, the first bytes of a NIfTI file (nifti_has_magic()), unpacked. */
void field_header_parse(struct job *job, struct field_header *out, struct text head);

/** Words for a file with this header ("a deformation field of SPM", static): a field that
 * conus_atlas_transform() may take, *usable, or what a program of registration writes besides. NULL where it says
 * nothing of the kind, as 4-D fields do that FSL's tools but fnirt's write. */
const char *field_header_words(bool *usable, const struct field_header *header);

/** Finds what the vectors are, by the header and by what is stated: @p has_images, FSL's two. The shape alone does not
 * say whose field one of 4 dimensions is. CONUS_ERROR_DATA for a file that is no field, CONUS_ERROR_UNSUPPORTED for
 * coefficients of splines, CONUS_ERROR_ARGUMENT where header and statement contradict each other. */
enum field_kind field_header_kind(struct job *job, const struct field_header *header, bool has_images,
                                  conus_vectors vectors, conus_file_space space);

#endif
