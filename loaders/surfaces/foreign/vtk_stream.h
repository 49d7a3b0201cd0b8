/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Numbers of a file in VTK's legacy format, as text or big-endian, one after the other. */
#ifndef CONUS_LOADERS_SURFACES_FOREIGN_VTK_STREAM_H
#define CONUS_LOADERS_SURFACES_FOREIGN_VTK_STREAM_H

#include "loaders/surfaces/foreign/foreign_lines.h"
#include "loaders/surfaces/foreign/words.h"

struct vtk {
    struct words words;
    struct foreign_mesh *mesh;
    bool is_text;
    bool has_offsets; /**< Version 5: cells are offsets and corners. */
    bool has_points;
    enum { VTK_OF_NOTHING, VTK_OF_POINTS, VTK_OF_CELLS } place; /**< What the numbers are of that are read. */
};

struct vtk_type {
    const char *name;
    size_t bits;
    enum { VTK_INTEGER, VTK_UNSIGNED, VTK_REAL } kind;
};

/** Takes the name of a type. */
conus_status vtk_need_type(const struct vtk_type **out, struct vtk *vtk);

/** Binary numbers begin behind the line, those of text behind white space. */
conus_status vtk_end_line(struct vtk *vtk);

conus_status vtk_fail_cut_off(const char *what);

/** The next whole number, of @p what. */
conus_status vtk_next_whole(int64_t *out, struct vtk *vtk, const struct vtk_type *type, const char *what);

/** The next number, rounded once. A coordinate (VTK_OF_NOTHING) is finite where it is text. */
conus_status vtk_next_number(float *out, struct vtk *vtk, const struct vtk_type *type, const char *what);

/** Reads a field, behind its word: its arrays are kept where they are of points or cells, else passed over. */
conus_status vtk_take_field(struct vtk *vtk);

conus_status vtk_skip_metadata(struct vtk *vtk);

/** Reads numbers of points and cells, from the count behind POINT_DATA or CELL_DATA to the end of the file. */
conus_status vtk_read_numbers(struct vtk *vtk);

#endif
