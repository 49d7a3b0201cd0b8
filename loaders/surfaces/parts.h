/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The readers of surfaces: GIFTI and FreeSurfer's. */
#ifndef CONUS_LOADERS_SURFACES_PARTS_H
#define CONUS_LOADERS_SURFACES_PARTS_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "base/job/job.h"
#include "loaders/labels/labels.h"

/* GIFTI 1.0: surfaces and values on them, in XML. Strict: an array has exactly the numbers that its Dim attributes
 * ask for, or the file is refused. docs/formats.md lists what is read, docs/spaces.md how vertices get their place. */

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

/* FreeSurfer's surfaces (lh.pial), big-endian. docs/formats.md lists the fields, docs/spaces.md says how their
 * coordinates get into the world. */

/** Reads a surface of triangles into world mm, not yet checked by mesh_check(). @p out, empty, is the caller's to
 * finish, also after a failure. @p as_stored: coordinates are taken as they are. Surfaces of quadrangles are
 * CONUS_ERROR_UNSUPPORTED. */
void freesurfer_surface_read(struct reader *r, struct mesh *out, bool as_stored);

/** world_from_surface for the volume with the axes' world directions @p axes (i, j, k, one after the other) and
 * c_ras @p centre: Norig inv(Torig), in which the volume's size cancels out. False (out untouched) where the axes are
 * no rotation, with or without a mirror. */
bool freesurfer_world_from_surface(double out[16], const double axes[9], const double centre[3]);

/* FreeSurfer's annotations (lh.aparc.annot), big-endian, and labels (lh.V1_exvivo.label), a list of the vertices of
 * one area as text. docs/formats.md lists the fields. */

/** Reads an annotation: one label per vertex, *count of them (0 = none); the empty @p table is sorted. A label is its
 * entry's number in the file's colour table; vertices name it by its packed colour. Entry 0 is no area if it is called
 * so ("unknown"), else the label behind the last, with a note. NULL after a failure. */
uint32_t *freesurfer_annot_read(struct reader *r, struct label_table *table, size_t *count);

/** Reads a label: 1 for each vertex of the list and 0 for the others up to the last of it, *count in all.
 * CONUS_ERROR_DATA where the file is cut off, or lists voxels. NULL after a failure. */
uint32_t *freesurfer_label_read(struct job *job, struct text text, size_t *count);

#endif
