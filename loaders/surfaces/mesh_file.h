/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Surfaces and labels of their vertices in files. The format is detected from the content. */
#ifndef CONUS_LOADERS_SURFACES_MESH_FILE_H
#define CONUS_LOADERS_SURFACES_MESH_FILE_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "atlas/surface/mesh_space.h"
#include "base/job/job.h"
#include "sources/format.h"

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

/** The side of a file of a surface: @p stated ('L', 'R') or else that of its name: "lh." or "rh.", "hemi-L", ".L.". 0 =
 * neither says. */
char mesh_file_side(char stated, const char *path);

/** CONUS_ERROR_DATA where a surface is of another side than the labels of its vertices. */
void mesh_file_match_sides(struct job *job, char surface_side, const char *surface, char labels_side,
                           const char *labels);

/** Reads the surface @p path: GIFTI or FreeSurfer, each plain or gzip, by content; else, by its name, that of another
 * program (loaders/surfaces/foreign/mesh_foreign.h). Checked by mesh_check(), path set; @p out is the caller's to
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

/** Whether mesh_foreign.h reads a surface of @p format, of ROLE_SURFACE: GIFTI and FreeSurfer are others. NULL is
 * none. */
bool mesh_format_is_foreign(const struct format *format);

/** Whether surface_read() keeps the vertices of such a file in their order, so that labels can be matched with them:
 * all but STL, which does not number its vertices. */
bool mesh_format_keeps_vertices(const struct format *format);

#endif
