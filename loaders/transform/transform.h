/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Transforms of other programs: chains of them, fields, whatever a file holds, and names of files. */
#ifndef CONUS_LOADERS_TRANSFORM_TRANSFORM_H
#define CONUS_LOADERS_TRANSFORM_TRANSFORM_H

#include "atlas/deformation/deformation.h"
#include "base/child/hdf5.h"
#include "base/text.h"
#include "conus/atlas.h"
#include "sources/source.h"

/* Several transforms that points go through in turn, and the formats that have them: composites of ITK (ANTs,
 * fMRIPrep) and X5. */

/** The result of all steps: one affine, or fields of which all affines are parts. Points are RAS mm. */
struct transform_chain {
    double matrix[16];          /**< The affine. One before the fields becomes a part of them at the end. */
    struct deformation *fields; /**< [count] Points go through the last one first. Measured when it is whole. */
    size_t count;
};

void transform_chain_finish(struct transform_chain *chain);

/** @name Steps. A chain begins with chain_begin(); each step is one that points go through *before* those that are
 * there; chain_end() makes it whole. Finish it also after a failure.
 * @{ */
void chain_begin(struct transform_chain *chain);
/** CONUS_ERROR_DATA for a matrix that cannot be inverted. */
void chain_add_matrix(struct job *job, struct transform_chain *chain, const double m[16]);
/** A field on @p dim nodes at @p world_from_voxel, whose vectors are still to be set: the chain's; NULL after a
 * failure. Vectors are added to the place of a node if they are displacements; else they are positions. */
struct deformation *chain_add_field(struct job *job, struct transform_chain *chain, const size_t dim[3],
                                    const double world_from_voxel[16], bool displacements);
/** Sets number @p place of the vectors, as a whole double; false where it is not finite. */
bool chain_set_number(struct job *job, struct deformation *field, size_t place, double number);
/** Takes over a field whose places, base and linear are set: the affines that are there become a part of it. */
void chain_push(struct job *job, struct transform_chain *chain, struct deformation *field);
void chain_end(struct job *job, struct transform_chain *chain);
/** @} */

/** @name Formats of several steps. They fill a chain that was begun. @{ */

/** One transform in a file of ITK, as stored: points are LPS. */
struct itk_entry {
    struct text type; /**< "AffineTransform_double_3_3". */
    LIST(double) parameters, fixed;
    bool has_parameters, has_fixed; /**< A composite has neither. */
};

/** Adds an affine or a B-spline as a step before those of @p chain. CONUS_ERROR_DATA for numbers that do not fit the
 * type, CONUS_ERROR_UNSUPPORTED for other types. */
void itk_chain_add(struct job *job, struct transform_chain *chain, const struct itk_entry *entry);

/** ITK (ANTs, 3D Slicer, elastix) as text: the only entry, the entries of a composite, where points go through the last
 * one first, or entry @p chosen - 1; 0 = none is chosen. Errors as itk_chain_add(), CONUS_ERROR_UNSUPPORTED for several
 * entries where none is chosen, and CONUS_ERROR_ARGUMENT. */
void itk_text_parse(struct job *job, struct transform_chain *chain, struct text text, size_t chosen);
/** The same as MATLAB's level 4, which has one entry. */
void itk_matlab_parse(struct job *job, struct transform_chain *chain, const uint8_t *data, size_t size);

/** Whether the type of a transform, "AffineTransform_double_3_3", is @p type, "AffineTransform", in 3-D. */
bool itk_is_type(struct text name, const char *type);
bool itk_is_composite(struct text name);

/** Composites in HDF5. They give one line: what the file is, and the steps as points go through them. */
const char *itk_hdf5_parse(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5);
bool x5_is(const struct hdf5 *hdf5);
const char *x5_parse(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5);

/** The groups of /TransformGroup, which must be called 0, 1, 2, …, in this order; 0 of them after a failure. */
const struct hdf5_object **chain_groups(struct job *job, size_t *count, const struct hdf5 *hdf5);
/** @} */

/** FLIRT's coordinates of a voxel: mm along the axes from the first one, x turned around where the axes are
 * right-handed in RAS ("neurological"). */
void flirt_from_voxel(double out[16], const conus_volume_info *info);

/** From these to the world. */
void world_from_flirt(struct job *job, double out[16], const conus_volume_info *info);

/* A file that moves points from one space to another, by whatever program. */

/** Reads the transform in @p source, for points of where poses are: an affine, a field, a B-spline or a chain. Of
 * @p options, from and to are the images that an FSL matrix, a register.dat or FSL's field is between, and transform is
 * which of several. What was read, but these images, goes into the job's files; what a careful user should know into
 * its notes, with the path. Errors name path, field, value and what is allowed; CONUS_ERROR_UNSUPPORTED for kinds of
 * transforms that are not read. End @p out with transform_chain_finish(), also after a failure. */
void transform_read(struct job *job, struct transform_chain *out, struct source *source,
                    const conus_transform_options *options);

/* A file of a deformation field, as NIfTI: ITK's (ANTs), SPM's, NiftyReg's, FSL's, or one in RAS or LPS. */

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

enum { FIELD_HEADER_SIZE = 540 }; /**< Bytes that field_header_parse() looks at, if there are as many. */

/** Takes the fields from @p head, the first bytes of a NIfTI file (nifti_has_magic()), unpacked. */
void field_header_parse(struct job *job, struct field_header *out, struct text head);

/** Finds what the vectors are, by the header and by what is stated: @p has_images, FSL's two. The shape alone does not
 * say whose field one of 4 dimensions is. CONUS_ERROR_DATA for a file that is no field, CONUS_ERROR_UNSUPPORTED for
 * coefficients of splines, CONUS_ERROR_ARGUMENT where header and statement contradict each other. */
enum field_kind field_header_kind(struct job *job, const struct field_header *header, bool has_images,
                                  conus_vectors vectors, conus_file_space space);

/* The names that BIDS derivatives have for transforms: "sub-01_from-T1w_to-MNI152NLin2009cAsym_mode-image_xfm.h5" of
 * fMRIPrep moves images of the first space to the second, and so points of the second to the first. */

/** Finds from the name @p path between which spaces it moves points; false where the name does not say. */
bool transform_name_points(struct text *from, struct text *to, const char *path);

/** What ANTs calls its files. */
enum ants_kind { ANTS_NONE, ANTS_AFFINE, ANTS_WARP, ANTS_INVERSE_WARP, ANTS_COMPOSITE };

/** The kind of file by its name @p path ("out_1InverseWarp.nii.gz"), and what of the path all files of a registration
 * share ("out_"). */
enum ants_kind transform_name_ants(struct text *prefix, const char *path);

/** Whether the name of a space is one of the MNI's. */
bool transform_name_is_mni(struct text space);

#endif
