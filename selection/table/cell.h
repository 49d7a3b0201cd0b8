/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A cell, and how it is read from where a value lies. */
#ifndef CONUS_SELECTION_TABLE_CELL_H
#define CONUS_SELECTION_TABLE_CELL_H

#include "atlas/atlas.h"
#include "conus/space.h"

enum cell_type { CELL_NONE, CELL_TEXT, CELL_INTEGER, CELL_NUMBER, CELL_TIME };

struct cell {
    enum cell_type type;
    const char *text;
    uint64_t integer;
    double number;
};

static inline struct cell no_cell(void)
{
    return (struct cell){.type = CELL_NONE};
}

/** n/a of NULL and "". */
static inline struct cell text_cell(const char *value)
{
    return value && value[0] ? (struct cell){.type = CELL_TEXT, .text = value} : no_cell();
}

static inline struct cell integer_cell(uint64_t value)
{
    return (struct cell){.type = CELL_INTEGER, .integer = value};
}

/** n/a unless finite. */
static inline struct cell number_cell(double value)
{
    return isfinite(value) ? (struct cell){.type = CELL_NUMBER, .number = value} : no_cell();
}

enum column_type {
    COLUMN_COMPUTED,    /**< The result of get().                                              */
    COLUMN_NAME,        /**< The same: a name, a kind or a label, no quantity. */
    COLUMN_LABEL,       /**< The same: a whole number, no quantity. */
    COLUMN_TEXT,        /**< Such a name that lies there, a const char *. */
    COLUMN_COUNT,       /**< A uint32_t.                                                    */
    COLUMN_LARGE_COUNT, /**< A uint64_t. */
    COLUMN_RANK,        /**< A uint32_t, n/a if 0.                                          */
    COLUMN_NUMBER,      /**< A double, n/a unless finite.                                   */
    COLUMN_TIME,        /**< A double, seconds.                                             */
    COLUMN_X,           /**< A coordinate of a double[3], world, written in the frame's space. */
    COLUMN_Y,
    COLUMN_Z,
    COLUMN_OWN_X, /**< The same, where the atlas's files have the point. */
    COLUMN_OWN_Y,
    COLUMN_OWN_Z
};

/** Whether a column has coordinates, whose unit is that of the space. */
static inline bool column_is_place(enum column_type type)
{
    return type >= COLUMN_X;
}

/** The point at @p world in the frame's space; of a column with OWN in its type that in the atlas's files. */
void cell_point(double out[3], enum column_type type, const double world[3], const conus_atlas *atlas,
                const conus_frame *frame);

/** The value at @p place, which is of the type. */
struct cell cell_at(enum column_type type, const void *place, const conus_atlas *atlas, const conus_frame *frame);

#endif
