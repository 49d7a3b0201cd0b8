/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Mesh files of other programs: the way in, the sink that takes their content, and the parsers. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_H
#define CONUS_LOADERS_SURFACES_FOREIGN_FOREIGN_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "atlas/surface/mesh_space.h"
#include "base/job/job.h"

#include <string.h>

/* Mesh files of other programs: OBJ, PLY, STL, OFF, MZ3, legacy VTK and VTP, each plain or gzip. They are at most
 * job->max_memory bytes large, packed and unpacked, as is each array in them. An error names the file. */

/** Reads @p count files into @p out[count], in world mm, checked by mesh_check(), path set: all of them, which are the
 * caller's to finish, or none. Polygons and strips become triangles; LPS coordinates, RAS. Notes say what mesh_check()
 * finds; one says how many files do not state their space, which is then RAS; @p space overrides what they state. */
void mesh_foreign_files(struct job *job, struct mesh *out, const char *const *paths, size_t count,
                        enum mesh_space space);

/** Reads the file @p path into @p parts: one per object ("o NAME") of an OBJ that has several, numbered from 1 in the
 * order in which they come first, else the whole surface as part 1. @p names, which is empty, gets an entry per part,
 * without a name where the file gives none. Otherwise like mesh_foreign_files(). */
void mesh_foreign_objects(struct job *job, struct mesh_parts *parts, struct label_table *names, const char *path,
                          enum mesh_space space);

/* What a parser of surfaces gives the content of a file to: vertices in the file's order, cells of them, and of
 * VTK's files numbers of points and cells. parts.h makes triangles of the cells, loaders/tracts/vtk_lines.c
 * makes streamlines of those that are lines. All of it lies in the job's memory, and all functions are primitives. */

enum { SINK_ARRAY_LIMIT = 4096, SINK_COMPONENT_LIMIT = 65536 };

enum cell { CELL_POINTS, CELL_LINE, CELL_POLYGON, CELL_STRIP, CELL_KINDS };

struct mesh_point {
    float at[3]; /**< As stored. */
};

/** A named array of numbers, for all points or all lines. */
struct sink_array {
    char *name; /**< UTF-8. */
    bool per_point;
    uint32_t components;
    float *values; /**< [count], rounded once. */
    size_t count, capacity;
};

/** An empty one has a job, and what makes something of the corners of a cell. */
struct mesh_sink {
    struct job *job;
    void (*end)(struct mesh_sink *sink, enum cell cell);
    bool takes_lines; /**< And numbers of points and lines. */
    LIST(struct mesh_point) vertices;
    LIST(uint32_t) corners;         /**< Indices of vertices: of cells that are kept, and then */
    size_t first;                   /**< from here on those of the cell that is being read. */
    size_t cells[CELL_KINDS];       /**< So far. */
    LIST(struct sink_array) arrays; /**< None unless takes_lines. */
    uint64_t max_memory;            /**< Bytes that their values may still take. */
    enum mesh_space space;          /**< The space that the file states. */
    LIST(struct text) objects;      /**< Those that an OBJ has begun: its cells are of the last one. In its bytes. */
};

/** Makes place for @p count vertices. A failure for more than 4294967295 of them. */
void sink_expect(struct mesh_sink *sink, size_t count);

void sink_vertex_more(struct mesh_sink *sink, const float position[3]); /**< Where there is no place, or no job. */
static inline void sink_vertex(struct mesh_sink *sink, const float position[3])
{
    if (sink->vertices.count < sink->vertices.capacity && job_ok(sink->job)) {
        memcpy(sink->vertices.at[sink->vertices.count++].at, position, sizeof sink->vertices.at->at);
    } else {
        sink_vertex_more(sink, position);
    }
}

/** The number of the cell that is being read, and the word for it in messages. Lines come first where they are wanted,
 * cells of single points are not counted. */
size_t sink_cell(const struct mesh_sink *sink);
static inline const char *sink_cell_word(const struct mesh_sink *sink)
{
    return sink->takes_lines ? "line or face" : "face";
}

/** Appends a corner to the cell that is being read. A failure where @p index is no vertex yet. */
void sink_corner_more(struct mesh_sink *sink, int64_t index);
static inline void sink_corner(struct mesh_sink *sink, int64_t index)
{
    if (index >= 0 && (uint64_t)index < sink->vertices.count && sink->corners.count < sink->corners.capacity &&
        job_ok(sink->job)) {
        sink->corners.at[sink->corners.count++] = (uint32_t)index;
    } else {
        sink_corner_more(sink, index);
    }
}

/** Ends the cell, of whatever corners it has. */
void sink_end(struct mesh_sink *sink, enum cell cell);

/** The array @p name, which is added where there is none; good until the next call. NULL and a failure for one with
 * other components, for too many of them, and for more than SINK_ARRAY_LIMIT arrays. */
struct sink_array *sink_array(struct mesh_sink *sink, struct text name, bool per_point, uint64_t components);

/** Makes @p array longer by @p more values, which are the caller's to write: the first of them. NULL and a failure also
 * above max_memory. */
float *sink_array_grow(struct mesh_sink *sink, struct sink_array *array, size_t more);

/** Reads what the comment @p text says of the space: 3D Slicer writes "SPACE=RAS" or "SPACE=LPS", others "coordinate
 * system: LPS"; and of the unit: "units: mm". A failure for another unit, and where the space contradicts what the file
 * has said before. */
void sink_said(struct mesh_sink *sink, struct text text);

/* The parsers of mesh files of other programs. Each takes the whole file, unpacked, which must outlive the sink, and
 * is a primitive of the sink's job. CONUS_ERROR_DATA for a file that contradicts itself or is cut off,
 * CONUS_ERROR_UNSUPPORTED for a valid one that is not read. All vertices come in the file's order, then cells in
 * theirs; positions as stored. What was passed over is noted. */

typedef void mesh_parser(struct mesh_sink *sink, struct text file);

/** Wavefront OBJ, with its objects. */
mesh_parser obj_parse;

/** PLY, ASCII or binary of either byte order. */
mesh_parser ply_parse;

/** STL, ASCII or binary. Corners at equal positions are one vertex, the first of them. */
mesh_parser stl_parse;

/** OFF, COFF, NOFF, STOFF and their mixtures, as text. */
mesh_parser off_parse;

/** MZ3 (Surf Ice, NiiVue), unpacked. */
mesh_parser mz3_parse;

/** Legacy VTK, POLYDATA, to version 5.1. */
mesh_parser vtk_parse;

/** VTP. An array may have the job's max_memory bytes, unpacked. */
mesh_parser vtp_parse;

#endif
