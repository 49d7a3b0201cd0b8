/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Surfaces in files: read, written, and found in a folder. */
#ifndef CONUS_LOADERS_SURFACES_SURFACES_H
#define CONUS_LOADERS_SURFACES_SURFACES_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "atlas/surface/mesh_space.h"
#include "base/job/job.h"
#include "base/memory.h"
#include "conus/own.h"
#include "sources/source.h"

/* Surfaces and labels of their vertices in files. The format is detected from the content. */

/** Zero is the default of each. */
struct mesh_file_options {
    enum mesh_space space;
    bool external;       /**< GIFTI arrays may lie in other files in the same folder. */
    bool is_made_of;     /**< The file that is read is one of the job's. */
    const char *surface; /**< For labels: the surface whose vertices they label; NULL if not known. */
    char hemisphere;     /**< For labels: 'L' or 'R', used if the surface does not name its structure. */
};

/** The name in the file name of @p path: "lh.pial" of "lh.pial.surf.gii.gz". The caller's to memory_free(); NULL
 * without memory. */
char *mesh_file_name(const char *path);

/** CONUS_ERROR_DATA where a surface is of another side than the labels of its vertices. */
void mesh_file_match_sides(struct job *job, char surface_side, const char *surface, char labels_side,
                           const char *labels);

/** Reads the surface @p path: GIFTI or FreeSurfer, each plain or gzip, by content; else, by its name, that of another
 * program (loaders/surfaces/foreign/foreign.h). Checked by mesh_check(), path set; @p out is the caller's to
 * finish, and untouched by a failure. @p about, if not NULL, gets name and hemisphere as far as the file says them; its
 * strings are the caller's to memory_free(). Notes and errors carry the path. */
void surface_read(struct job *job, struct mesh *out, struct label *about, const char *path,
                  const struct mesh_file_options *options);

/** Labels of the vertices of a surface that lies elsewhere. */
struct vertex_labels {
    uint32_t *labels; /**< [count] 0 = no area; owned. */
    size_t count;
    struct label_table table; /**< Sorted. */
    char hemisphere;          /**< 'L', 'R', 'B' where the file says so, else 0. */
    bool is_list; /**< The file lists vertices. Those after the last one listed are missing and have label 0. */
};

/** Extends a list of at most @p count labels to @p count, the vertices of its surface. */
void vertex_labels_extend(struct job *job, struct vertex_labels *labels, size_t count);

void vertex_labels_finish(struct vertex_labels *labels);

/** Reads GIFTI labels (.label.gii, the first LABEL array, or that of ",map=K" or ",map=NAME" behind @p path; also those
 * of a surface file itself), a FreeSurfer annotation (.annot) or label (lh.V1.label), or, likewise with maps, those of
 * one surface in a CIFTI file (.dlabel.nii), each plain or gzip. A surface without labels has none: count 0. Notes and
 * errors carry the path. @p out is untouched by a failure. */
void surface_labels_read(struct job *job, struct vertex_labels *out, const char *path,
                         const struct mesh_file_options *options);

/** Whether foreign.h reads a surface of @p format, of ROLE_SURFACE: GIFTI and FreeSurfer are others. NULL is
 * none. */
bool mesh_format_is_foreign(const struct format *format);

/** Whether surface_read() keeps the vertices of such a file in their order, so that labels can be matched with them:
 * all but STL, which does not number its vertices. */
bool mesh_format_keeps_vertices(const struct format *format);

/* A mesh as the bytes of a file: GIFTI, VTP, OBJ, PLY, STL (docs/formats.md). All state that they are in RAS. */

/** Facts about a mesh that its file states. */
struct mesh_title {
    uint32_t label;
    const char *name; /**< UTF-8. */
    uint8_t rgb[3];
    const char *space; /**< A NIFTI_XFORM_ word, for GIFTI. */
};

/** A format's ending, without the dot; NULL for none that there is. */
const char *mesh_format_ending(conus_mesh_format format);

/** Appends the file of @p mesh, checked by mesh_check(). */
conus_status mesh_format(struct buffer *out, const struct mesh *mesh, const struct mesh_title *title,
                         conus_mesh_format format);

/** Appends a pair of GIFTI's MetaData, escaped. */
void gifti_append_pair(struct buffer *out, const char *name, const char *value);

/* The surface of a structure among the GIFTI files of a folder (docs/formats.md, "CIFTI"). */

/** Facts that a GIFTI surface states about itself; its arrays are not read. The texts are the job's. */
struct surface_about {
    char *structure;      /**< AnatomicalStructurePrimary: "CortexLeft"; NULL if none.           */
    char *layer;          /**< AnatomicalStructureSecondary: "MidThickness".                     */
    char *geometric_type; /**< GeometricType: "Anatomical".                                      */
    size_t vertices;      /**< Vertices of its first POINTSET; 0 = none, so it is no surface.    */
};

/** Those of the file @p path, plain or gzip. All 0 for one that is no GIFTI, and after a failure. */
struct surface_about surface_about_of(struct job *job, const char *path);

struct surface_item {
    const char *name; /**< In the folder. */
    struct surface_about about;
    unsigned rank; /**< Rank of its kind; 0 is the best. */
};

/** GIFTI surfaces, sorted by name: those called *.surf.gii, or else *.gii, each plain or packed (.gz). */
struct surface_list {
    LIST(struct surface_item) items;
};

/** Lists those in @p folder, which ends in '/'. A file that cannot be read is none. */
struct surface_list surface_list_make(struct job *job, const char *folder);

/** The surface of @p structure ("CortexLeft") with @p vertices vertices, of the best kind that is there:
 * midthickness, pial, white, smoothwm, then any other that is not inflated, spherical or flat. *kind says which, in
 * words (static). CONUS_ERROR_DATA, with what is there instead, where there is none, or several are as good. NULL after
 * a failure. */
const struct surface_item *surface_list_find(struct job *job, const char **kind, const struct surface_list *list,
                                             const char *structure, size_t vertices);

/* Numbers of the vertices of a surface in GIFTI files (.func.gii, .shape.gii), one array each. */

struct vertex_map {
    float *values; /**< [count] NaN where there is none, also where the file has an infinity; owned. */
    size_t count;
    char *name;      /**< The array's name, else the one that was asked for; owned. */
    char hemisphere; /**< 'L', 'R', 'B' where the file says so, else 0. */
};

void vertex_map_finish(struct vertex_map *map);

/** Reads the array called @p name, or number @p name from 0, of those with one number for each vertex. Errors carry the
 * path. CONUS_ERROR_ARGUMENT, with the names that there are, where none or several are called so. All 0 after a
 * failure.
 */
struct vertex_map vertex_map_read(struct job *job, const char *path, const char *name);

#endif
