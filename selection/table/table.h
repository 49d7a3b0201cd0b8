/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Tables from inside: a cell, how a study makes one of its rows, and what a report reads. */
#ifndef CONUS_SELECTION_TABLE_TABLE_H
#define CONUS_SELECTION_TABLE_TABLE_H

#include "atlas/atlas.h"
#include "conus/space.h"
#include "conus/study.h"
#include "conus/table.h"
#include "selection/cone/cone.h"

/* A cell, and how it is read from where a value lies. */

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
    COLUMN_LARGE_RANK,  /**< A uint64_t, n/a if 0. */
    COLUMN_FLAG,        /**< A bool, 1 or 0. */
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
static inline struct cell cell_at(enum column_type type, const void *place, const conus_atlas *atlas,
                                  const conus_frame *frame)
{
    const uint32_t *count = place;
    const double *numbers = place;
    double point[3];
    switch (type) {
    case COLUMN_RANK:
        return *count ? integer_cell(*count) : no_cell();
    case COLUMN_COUNT:
        return integer_cell(*count);
    case COLUMN_LARGE_COUNT:
        return integer_cell(*(const uint64_t *)place);
    case COLUMN_LARGE_RANK:
        return *(const uint64_t *)place ? integer_cell(*(const uint64_t *)place) : no_cell();
    case COLUMN_FLAG:
        return integer_cell(*(const bool *)place);
    case COLUMN_TEXT:
        return text_cell(*(const char *const *)place);
    case COLUMN_TIME:
        return isfinite(*numbers) ? (struct cell){.type = CELL_TIME, .number = *numbers} : no_cell();
    case COLUMN_X:
    case COLUMN_Y:
    case COLUMN_Z:
    case COLUMN_OWN_X:
    case COLUMN_OWN_Y:
    case COLUMN_OWN_Z:
        cell_point(point, type, numbers, atlas, frame);
        return number_cell(point[(type - COLUMN_X) % 3]);
    default:
        return number_cell(*numbers);
    }
}

/* Tables from inside: how a study makes one of its rows, by a list of its columns, and what a report reads. */

/** The region of interest that a question is about. */
struct table_region {
    char *path; /**< Owned; NULL of another question. */
    char sha256[65];
    size_t volume;    /**< Index in a 4-D file, from 0. */
    double threshold; /**< 0 of a mask. */
    double volume_mm3;
    uint64_t tetrahedra; /**< 0 of voxels. */
};

/** What was asked: reports write it above the rows and into what goes with them. */
struct table_question {
    struct cone cone;
    double ball;                 /**< Radius of a ball around the cone's origin; 0 of a cone. */
    bool is_axis;                /**< The rows describe the cone's axis: segments, clearances. */
    conus_jitter_options jitter; /**< For chances. */
    struct table_region region;  /**< For coverages and clusters. */
    double within;               /**< For clearances, mm. */
    double end_radius;           /**< For connections, mm. */
    bool is_whole;               /**< These are of all streamlines, whatever the cone. */
};

/** What the functions of columns see besides a row. */
struct table_source {
    const conus_atlas *atlas;
    const conus_frame *frame; /**< Of positions. */
};

/** With what the rows of each study begin. */
struct table_object {
    conus_kind kind;
    uint32_t number; /**< In the atlas; 0 = none. */
};

/** A column of a study, and where its value lies in a row. */
struct table_field {
    const char *name;
    const char *unit; /**< NULL if it has none; of coordinates that of the source's frame is taken. */
    const char *help;
    enum column_type type; /**< With get(): COLUMN_NAME, _LABEL, _LARGE_COUNT or _NUMBER. */
    size_t offset;         /**< In the row. */
    struct cell (*get)(const struct table_source *source, const void *row, size_t index); /**< NULL: it lies there.
                              Texts live as long as the atlas. */
    bool unless_zeros; /**< Files have it only where some row is not 0. */
};

/** The columns of a study, in their order, but `query`. x, y and z of a point are side by side. */
struct table_fields {
    const struct table_field *at;
    size_t count;
};

/** The fields of an array. */
#define TABLE_FIELDS(array)                                                                                            \
    {                                                                                                                  \
        array, sizeof(array) / sizeof *(array)                                                                         \
    }

/** "kind", "index", "name" and "abbreviation" of rows that begin with a struct table_object. */
struct cell table_kind(const struct table_source *source, const void *row, size_t index);
struct cell table_index(const struct table_source *source, const void *row, size_t index);
struct cell table_object_name(const struct table_source *source, const void *row, size_t index);
struct cell table_abbreviation(const struct table_source *source, const void *row, size_t index);
/** The place of a row, from 1. */
struct cell table_place(const struct table_source *source, const void *row, size_t index);

/** The first columns of most studies. */
#define TABLE_IDENTITY                                                                                                 \
    {"kind", NULL,                                                                                                     \
     "area, pathway, bundle, unassigned: the part of the cone that hits nothing, or error: name says why",             \
     TABLE_NAME_BY(table_kind)},                                                                                       \
        {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway or bundle",                  \
         TABLE_LABEL_BY(table_index)},                                                                                 \
        {"name", NULL, "name of the area, pathway or bundle", TABLE_NAME_BY(table_object_name)},                       \
    {                                                                                                                  \
        "abbreviation", NULL, "abbreviation in the label table", TABLE_NAME_BY(table_abbreviation)                     \
    }

/** Entries of a list of fields: where a value lies, after its name, unit and help. */
#define TABLE_OF(kind, row, member) .type = COLUMN_##kind, .offset = offsetof(row, member)
/** The three columns of a point, PREFIXx and so on, by @p of: TABLE_OF, or another macro that takes a kind first. */
#define TABLE_XYZ(prefix, words, of, ...)                                                                              \
    {prefix "x", "mm", words ", x", of(X, __VA_ARGS__)}, {prefix "y", "mm", "the same, y", of(Y, __VA_ARGS__)},        \
    {                                                                                                                  \
        prefix "z", "mm", "the same, z", of(Z, __VA_ARGS__)                                                            \
    }
#define TABLE_NAME_BY(getter) .type = COLUMN_NAME, .get = getter
#define TABLE_LABEL_BY(getter) .type = COLUMN_LABEL, .get = getter
#define TABLE_COUNT_BY(getter) .type = COLUMN_LARGE_COUNT, .get = getter
#define TABLE_NUMBER_BY(getter) .type = COLUMN_NUMBER, .get = getter

/** Whether a table of this atlas has the field: the atlas's own coordinates are those of one that was moved. */
bool table_has_field(const conus_atlas *atlas, const struct table_field *field);

/**
 * Makes a table of rows, each of which begins with a struct table_object.
 * @param asked What they answer; its path is taken over, also after a failure.
 * @param rows [count] of @p size bytes; copied cell by cell.
 * @return CONUS_OK; CONUS_ERROR_MEMORY.
 */
conus_status table_create(conus_table **out, const struct table_source *source, const struct table_fields *fields,
                          const struct table_question *asked, const void *rows, size_t size, size_t count);

/** Makes a table of what there is: @p rows [count], which are ended; NULL is a failed allocation. Positions are in the
 * world. @p atlas is NULL where rows are about none. */
conus_status table_of_rows(conus_table **out, const conus_atlas *atlas, const struct table_fields *fields, void *rows,
                           size_t size, size_t count);

enum { TABLE_PART_LIMIT = 2 };

/** Adds a part, up to the limit. The hold on it is taken over; @p name is static. */
void table_add_part(conus_table *table, const char *name, conus_table *part);

/** Another hold on the table: it ends with the last conus_table_destroy(). */
conus_table *table_hold(conus_table *table);

/** Whether it has these columns. */
bool table_is_of(const conus_table *table, const struct table_fields *fields);

/** Whether its positions, if it has some, are in this frame. */
bool table_fits(const conus_table *table, const conus_frame *frame);

const struct table_question *table_question(const conus_table *table);

/** All columns, side by side. */
const conus_column *table_columns(const conus_table *table);

/** A cell. */
static inline struct cell table_cell(const conus_column *column, size_t row) /* called for each cell of a batch */
{
    if (column->texts) {
        return text_cell(column->texts[row]);
    }
    if (column->counts) {
        return column->missing && column->missing[row] ? no_cell() : integer_cell((uint64_t)column->counts[row]);
    }
    return number_cell(column->numbers[row]);
}

#endif
