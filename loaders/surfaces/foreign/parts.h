/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the parsers read text with, and the sink that makes triangles. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_PARTS_H
#define CONUS_LOADERS_SURFACES_FOREIGN_PARTS_H

#include "atlas/surface/mesh.h"
#include "base/job/job.h"
#include "loaders/surfaces/foreign/foreign.h"

/* Words, lines and numbers of a file that is text, at least in part. Primitives of a job: after a failure there is
 * no further word, and numbers are 0. Errors say the line. */

struct scan {
    struct reader r; /**< Of the whole file, in memory: a copy of the scan reads on from where it was made. */
    size_t line;     /**< Line of the next byte, from 1; lines end in LF, CRLF or CR. */
    char comment;    /**< Begins a remark, to the end of the line; 0 = none does. */
};

static inline struct scan scan_of(struct job *job, struct text file)
{
    return (struct scan){.r = reader_of(job, file), .line = 1};
}

/** Bytes that are left. */
static inline size_t scan_left(const struct scan *scan)
{
    return (size_t)(scan->r.end - scan->r.at);
}

/** The next word; false where there is none. */
bool scan_word(struct scan *scan, struct text *word);

/** The next word without taking it. */
bool scan_peek(const struct scan *scan, struct text *word);

/** The rest of the line, without its ending; false at the end of the file. */
bool scan_line(struct scan *scan, struct text *line);

/** True where the next word is @p wanted, whatever its case; it is taken then. */
bool scan_take(struct scan *scan, const char *wanted);

/** The next word is @p wanted, whatever its case, or a failure that says @p what was to be. */
void scan_need(struct scan *scan, const char *wanted, const char *what);

/** A finite number, rounded once; @p what it was to be. */
float scan_float(struct scan *scan, const char *what);

/** The same, or "nan" or "inf". */
float scan_any_float(struct scan *scan, const char *what);

/** A whole number that is not below @p least. */
int64_t scan_whole(struct scan *scan, int64_t least, const char *what);

/** A count of things that take @p least bytes or more each: never more than fit in the bytes left. */
size_t scan_count(struct scan *scan, size_t least, const char *what);

/** Takes @p size bytes; NULL where fewer are left. */
static inline const uint8_t *scan_bytes(struct scan *scan, size_t size)
{
    if (size > scan_left(scan) || !job_ok(scan->r.job)) {
        return NULL;
    }
    scan->r.at += size;
    return scan->r.at - size;
}

/** A failure where more than white space (and remarks) is left behind @p what. */
void scan_end(struct scan *scan, const char *what);

/** Fails with the line: "line 3: "abc", needed is @p what". */
void scan_refuse(struct scan *scan, struct text found, const char *what);

/* A sink that makes triangles of polygons and strips, and passes over lines and points. */

enum { POLYGON_LIMIT = 1024 }; /**< Corners: cutting a polygon takes time that grows with their square. */

struct mesh_triangle {
    uint32_t corners[3];
};

struct mesh_build {
    struct mesh_sink sink; /**< The first member. */
    LIST(struct mesh_triangle) triangles;
    LIST(uint32_t) owners; /**< For each triangle its place in sink.objects, if there are any. */
    struct polygon *polygon;
};

/** An empty one, which the parsers get as mesh_build.sink. A polygon of two corners or one becomes a triangle without
 * area, so that it is counted; of none there is nothing. One of more than POLYGON_LIMIT corners is
 * CONUS_ERROR_UNSUPPORTED. Every second triangle of a strip is turned around. */
struct mesh_build mesh_build_of(struct job *job);

/** Gives vertices and triangles to @p out, which is empty and the caller's to finish; not yet checked (mesh_check()).
 * A failure where there are no triangles. */
void mesh_build_give(struct mesh *out, struct mesh_build *build);

/** The objects that have triangles, in the order in which they come first. */
struct mesh_objects {
    struct text *names; /**< [count] "" for what is in none. In the file's bytes. */
    size_t count;
};

/** Finds them, and makes @p build's owners their numbers. Objects of one name are one. */
struct mesh_objects mesh_build_objects(struct mesh_build *build);

#endif
