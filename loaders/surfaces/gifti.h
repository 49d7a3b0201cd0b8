/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * GIFTI 1.0: surfaces and values on them, in XML. Strict: an array has exactly the numbers that its Dim attributes ask
 * for, or the file is refused. docs/formats.md lists what is read, docs/spaces.md how vertices get their place. */
#ifndef CONUS_LOADERS_SURFACES_GIFTI_H
#define CONUS_LOADERS_SURFACES_GIFTI_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "base/job/job.h"

enum { GIFTI_RANK_LIMIT = 6 };

enum gifti_intent { GIFTI_OTHER, GIFTI_POINTSET, GIFTI_TRIANGLE, GIFTI_LABEL, GIFTI_NODE_INDEX };

/** A CoordinateSystemTransformMatrix. Spaces are NIfTI's xform codes. */
struct gifti_transform {
    bool is_foreign;       /**< A space has a name that is none of NIfTI's. */
    int data_space;        /**< Space of the stored numbers. */
    int transformed_space; /**< To which the matrix leads.               */
    double matrix[16];     /**< Column-major, as in base/geometry/math3.h.        */
};

/** FreeSurfer's VolGeom metadata: the volume from which a surface was made. */
struct gifti_geometry {
    double axes[9];   /**< World directions of i, j, k, one after the other. */
    double centre[3]; /**< c_ras                                             */
    unsigned given;   /**< Bit k: number k of the twelve was there.          */
};

struct gifti_array {
    enum gifti_intent intent;
    size_t rank;                  /**< 1 to GIFTI_RANK_LIMIT                                           */
    size_t dim[GIFTI_RANK_LIMIT]; /**< 1 or more; 1 beyond rank                                        */
    size_t count;                 /**< Their product.                                                  */
    bool is_single;               /**< The values were float32.                                        */
    double *values;               /**< [count], the last index fastest; exact for all but 64-bit types */
    char *name;                   /**< Its metadata's Name; NULL if none.                              */
    LIST(struct gifti_transform) transforms;
    struct gifti_geometry geometry;
};

/** What it points to is the job's. */
struct gifti {
    LIST(struct gifti_array) arrays;
    struct label_table labels; /**< Sorted; label 0 is nothing.                                  */
    char *name;                /**< The file's metadata's Name; NULL if none.                    */
    char hemisphere;           /**< 'L', 'R', 'B' by the first AnatomicalStructurePrimary, or 0. */
    char *structure;           /**< The first AnatomicalStructurePrimary, "CortexLeft"; NULL if none.        */
    char *layer;               /**< The first AnatomicalStructureSecondary, "Pial"; NULL if none.            */
    char *geometric_type;      /**< The first GeometricType, "Anatomical"; NULL if none.                     */
};

/** Parses @p document. Arrays may lie in files beside the document's path @p beside; where that is NULL they are
 * CONUS_ERROR_UNSUPPORTED, as types without real numbers are. CONUS_ERROR_DATA where it breaks the standard, with line
 * and array; CONUS_ERROR_MEMORY for an array above the job's max_memory. NULL after a failure. */
struct gifti *gifti_read(struct job *job, struct text document, const char *beside);

/** The same without the numbers of the arrays, which are NULL. */
struct gifti *gifti_outline(struct job *job, struct text document);

/** The surface of the first POINTSET and the first TRIANGLE array, in world mm, not yet checked by mesh_check(). @p
 * out, empty, is the caller's to finish, also after a failure. @p as_stored: coordinates are taken as they are; else
 * they are placed as docs/spaces.md says, with a note where the file leaves doubt. */
void gifti_surface(struct job *job, struct mesh *out, const struct gifti *gifti, bool as_stored);

/** Labels of the vertices in LABEL array @p map (of those, from 0): *count, 0 = no area. Negative ones become 0, with a
 * note. None (NULL, 0) where the file has no LABEL array and @p map is 0, and after a failure. */
uint32_t *gifti_vertices(struct job *job, size_t *count, const struct gifti *gifti, size_t map);

/** Where no array is called labels, and the file has no surface: the only array is, with a note, if all its numbers are
 * in the table; else CONUS_ERROR_DATA. */
void gifti_settle_labels(struct job *job, struct gifti *gifti);

/** The LABEL array of @p gifti that @p wanted, a number from 0 or a name, means. An empty @p wanted means the first; a
 * note then names the others. CONUS_ERROR_ARGUMENT for a name that no array or several have; a number is checked by
 * gifti_vertices(). */
size_t gifti_map(struct job *job, const struct gifti *gifti, struct text wanted);

#endif
