/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * GIFTI 1.0: surfaces and values on them, in XML. Strict: an array has exactly the numbers that its Dim attributes ask
 * for, or the file is refused. docs/formats.md lists what is read, docs/spaces.md how vertices get their place. */
#ifndef CONUS_LOADERS_SURFACES_GIFTI_H
#define CONUS_LOADERS_SURFACES_GIFTI_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"

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
    struct gifti_transform *transforms;
    size_t transform_count;
    struct gifti_geometry geometry;
};

struct gifti {
    struct gifti_array *arrays;
    size_t array_count;
    struct label_table labels; /**< Sorted; label 0 is nothing.                                  */
    char *name;                /**< The file's metadata's Name; NULL if none.                    */
    char hemisphere;           /**< 'L', 'R', 'B' by the first AnatomicalStructurePrimary, or 0. */
    char *structure;           /**< The first AnatomicalStructurePrimary, "CortexLeft"; NULL if none.        */
    char *layer;               /**< The first AnatomicalStructureSecondary, "Pial"; NULL if none.            */
    char *geometric_type;      /**< The first GeometricType, "Anatomical"; NULL if none.                     */
};

struct gifti_options {
    const char *path;    /**< Path of the file, to find external files beside it; NULL: they are refused. */
    bool external;       /**< Arrays may lie in files beside this one.                               */
    uint64_t max_memory; /**< For the numbers of one array; 0: 8 GiB.                                */
    bool outline;        /**< No Data are decoded: the values of all arrays are NULL.                */
};

void gifti_finish(struct gifti *gifti);

/** Parses the document @p data. @p options may be NULL. CONUS_ERROR_DATA where it breaks the standard, with line and
 * array; CONUS_ERROR_UNSUPPORTED for external files that are not allowed, and types without real numbers. */
conus_status gifti_parse(struct gifti *out, const uint8_t *data, size_t size, const struct gifti_options *options,
                         struct notes *notes);

/** The surface of the first POINTSET and the first TRIANGLE array, in world mm, not yet checked by mesh_check().
 * @p as_stored: coordinates are taken as they are; else they are placed as docs/spaces.md says, with a note where
 * the file leaves doubt. */
conus_status gifti_mesh(struct mesh *out, const struct gifti *gifti, bool as_stored, struct notes *notes);

/** Labels of the vertices in LABEL array @p map (of those, from 0): *labels has *count, 0 = no area; the caller's to
 * memory_free(). Negative ones become 0, with a note. None (NULL, 0) where the file has no LABEL array and @p map is 0.
 */
conus_status gifti_labels(uint32_t **labels, size_t *count, const struct gifti *gifti, size_t map, struct notes *notes);

/** Where no array is called labels, and the file has no surface: the only array is, with a note, if all its numbers are
 * in the table; else CONUS_ERROR_DATA. */
conus_status gifti_find_labels(struct gifti *gifti, struct notes *notes);

/** Finds the LABEL array of @p gifti that @p wanted, a number from 0 or a name, means. An empty @p wanted means the
 * first; a note then names the others. CONUS_ERROR_ARGUMENT for a name that no array or several have; a number is
 * checked by gifti_labels(). */
conus_status gifti_map_find(size_t *out, const struct gifti *gifti, struct text wanted, struct notes *notes);

#endif
