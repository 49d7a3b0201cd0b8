/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * MATLAB's MAT-files of level 5 (MathWorks, "MAT-File Format"), which scipy and Octave write, too, and of level 7.3,
 * which are HDF5: numbers, characters, cells and structures, of either byte order, packed or not. Nothing is trusted:
 * each element lies inside the one around it, each array has as many values as its dimensions say, and memory has a
 * limit. */
#ifndef CONUS_BASE_FORMATS_MATLAB_H
#define CONUS_BASE_FORMATS_MATLAB_H

#include "base/child/hdf5.h"
#include "base/files/file.h"
#include "base/text.h"

/** The class of an array, by MATLAB's codes. */
enum matlab_class {
    MATLAB_EMPTY = 0, /**< [], written as nothing at all. */
    MATLAB_CELL = 1,
    MATLAB_STRUCT = 2,
    MATLAB_CHAR = 4,
    MATLAB_DOUBLE = 6, /**< And up to MATLAB_UINT64 the other kinds of number. */
    MATLAB_UINT64 = 15,
    MATLAB_OTHER /**< Objects, sparse arrays, functions: their values are not read. */
};

/** An array, a variable or a part of one; its bytes are the file's. */
struct matlab_array {
    enum matlab_class kind;
    bool is_complex;
    uint8_t type;  /**< Type of the values, by the file's code. */
    uint8_t depth; /**< 0 for a variable. */
    bool swapped;
    size_t rows, columns;
    size_t count;      /**< rows * columns * ... */
    struct text name;  /**< Name of the variable, or of the field. */
    struct text bytes; /**< Values; of an object its class, where that is known. */
    size_t fields;     /**< Fields of a structure. */
    size_t parts; /**< Index in matlab.arrays of the first part: [count] of a cell, [count][fields] of a structure. */
    const struct hdf5_object *object; /**< Level 7.3: where it is; NULL = an empty array. */
};

struct matlab {
    struct matlab_array *arrays; /**< Variables first, then their parts, those of one array side by side. */
    size_t count, capacity;
    size_t variables;
    const struct hdf5 *hdf5; /**< The file of level 7.3; else NULL. */
    size_t most;             /**< Level 7.3: the most arrays there may be, so that none contains itself. */
    uint64_t used, limit;    /**< Bytes of memory. */
};

/** True where @p text begins like such a file. */
bool matlab_is(struct text text);

/** Parses @p text, which must outlive the job, in at most @p limit bytes. CONUS_ERROR_DATA for one that is damaged;
 * CONUS_ERROR_MEMORY where more is needed; CONUS_ERROR_UNSUPPORTED for level 7.3 without conus-hdf5. After a failure
 * there are no arrays. */
const struct matlab *matlab_read(struct job *job, struct text text, uint64_t limit);

/** The same of level 7.3, from all objects of the file. */
const struct matlab *matlab_of_hdf5(struct job *job, const struct hdf5 *hdf5, uint64_t limit);

/** The variable @p name; NULL if there is none. */
const struct matlab_array *matlab_variable(const struct matlab *matlab, const char *name);

/** Field @p name of element @p index of a structure; NULL where @p array is no structure, has no such element or field,
 * or is NULL. */
const struct matlab_array *matlab_field(const struct matlab *matlab, const struct matlab_array *array, size_t index,
                                        const char *name);

/** Whether @p array has numbers that are not complex. */
bool matlab_is_real(const struct matlab_array *array);

/** Value @p index, column by column, of an array of which matlab_is_real() is true. */
double matlab_number(const struct matlab_array *array, size_t index);

/** The characters of a row, as UTF-8 in @p out (they end where it is full); "" for anything else. */
struct text matlab_text(char *out, size_t size, const struct matlab_array *array);

/** Words for a message. */
struct matlab_words {
    char text[64];
};

/** "a cell array", "a structure", "an object (table)" and so on. */
struct matlab_words matlab_class_name(const struct matlab_array *array);

#endif
