/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Labels: a table of what a file says about numbers, and the labels of voxels. */
#ifndef CONUS_ATLAS_LABELS_LABELS_H
#define CONUS_ATLAS_LABELS_LABELS_H

#include "base/status.h"
#include "base/text.h"
#include "conus/atlas.h"

#include <stddef.h>
#include <stdint.h>

/* A label table: what a file says about the numbers in a labelled volume. */

struct label {
    uint32_t number;    /**< The atlas's own label; never 0 (background is not an area).   */
    char *name;         /**< UTF-8, owned; NULL where the table has only a colour.         */
    char *abbreviation; /**< UTF-8, owned; NULL if none.                                   */
    char hemisphere;    /**< 'L', 'R', 'B' or 0.                                           */
    bool has_rgb;
    bool bad_rgb;   /**< The table has something else in its place; label_table_sort() notes that. */
    uint8_t rgb[3]; /**< sRGB.                                                         */
    bool has_parent;
    uint32_t parent; /**< Label number of the parent in the area tree.                  */
};

/** Frees its strings; it becomes all 0. */
void label_finish(struct label *label);

enum { LABEL_DIGITS = 16 }; /**< Bytes of a number as text. */

/** Copies @p label with its strings. @p out is the caller's to finish, also on failure. */
conus_status label_copy(struct label *out, const struct label *label);

/** The area that @p label describes, the atlas's @p index-th object: without a name it is called by its number, which
 * goes to @p digits; without a colour it has one of the palette. The strings are borrowed. */
conus_object label_object(const struct label *label, size_t index, char digits[LABEL_DIGITS]);

/** Sorted by number, without duplicates, once label_table_sort() has run. */
struct label_table {
    struct label *entries;
    size_t count;
    size_t capacity;
    char *zero; /**< The table's name of label 0, which has no entry: UTF-8, owned; NULL if none. */
};

void label_table_finish(struct label_table *table);

enum { LABEL_LIMIT = 1 << 20 }; /**< Entries of a table. */

/** Appends an entry for @p number and returns it for filling in; NULL without memory, or where there are LABEL_LIMIT.
 * Valid until the next call. */
struct label *label_table_add(struct label_table *table, uint32_t number);

/** Copies @p text into *@p field (name or abbreviation), trimmed. Bytes that are not UTF-8 are taken as ISO-8859-1;
 * control characters become spaces. Empty text leaves NULL. */
conus_status label_set_text(char **field, struct text text);

/** Sorts by number. Of entries with one number the first is kept; where a later one has another name, a note in
 * @p notes says so (for the first eight; one note counts the others). */
conus_status label_table_sort(struct label_table *table, struct notes *notes);

/** The entry of @p number in a sorted table, or NULL. */
struct label *label_table_find(const struct label_table *table, uint32_t number);

/** Looks at @p labels that came as float32, which from @p end on does not hold every whole number. One that an entry of
 * the sorted @p table with another number becomes is CONUS_ERROR_DATA; else a warning names the largest beyond. @p path
 * is the file's, for messages. */
conus_status label_table_check_singles(const struct label_table *table, const uint32_t *labels, size_t count,
                                       double end, const char *path, struct notes *notes);

/** Colour number @p index of an endless series of sRGB colours in which neighbours differ: hues a golden angle apart,
 * with three lightnesses in turn. */
void palette_colour(uint8_t rgb[3], size_t index);

/* The labels of voxels, any 32-bit numbers, in 2 bytes a voxel: each voxel has the place of its label in a list.
 * More than 65,535 different labels take 4 bytes a voxel. */

struct label_map_slot {
    uint32_t label;
    bool used;
    uint64_t value;
};

struct label_map {
    struct label_map_slot *slots; /**< [mask + 1], open addressing.                                              */
    size_t mask;
    size_t count;
};

void label_map_finish(struct label_map *map);

/** The value of @p label, put in as 0 if it is new; NULL without memory. Valid until the next call. */
uint64_t *label_map_at(struct label_map *map, uint32_t label);

struct label_voxels {
    size_t count;     /**< How many voxels.                                                             */
    uint16_t *narrow; /**< [count] places in `labels`, owned: one of the two,                           */
    uint32_t *wide;   /**< by the number of different labels.                                           */
    uint32_t *labels; /**< [label_count], owned: 0, then in the order in which they were first read. They may be
                           changed: all voxels of a label change with it. */
    uint64_t *counts; /**< [label_count], owned: how many voxels have each place. */
    size_t label_count;
    uint8_t *filled; /**< [count / LABEL_BLOCK + 1], owned: 0 = no voxel of the block has a place but 0. */
};

enum {
    LABEL_VOXELS_LIMIT = 1 << 24, /**< Different labels.                                                    */
    LABEL_BLOCK = 2048,           /**< Voxels in a row, 2 bytes of which are a page.                        */
    LABEL_BYTES = 512 /**< Memory of a label beside its voxels, once it is an area: object, name and maps. */
};

void label_voxels_finish(struct label_voxels *voxels);

static inline uint32_t label_voxels_at(const struct label_voxels *voxels, size_t voxel)
{
    return voxels->labels[voxels->narrow ? voxels->narrow[voxel] : voxels->wide[voxel]];
}

/** The labels of @p count voxels from @p first on. */
void label_voxels_get(uint32_t *out, const struct label_voxels *voxels, size_t first, size_t count);

/** Gives the voxel label 0. */
void label_voxels_clear(struct label_voxels *voxels, size_t voxel);

/** Adds to @p out how many voxels each label but 0 has. */
conus_status label_voxels_tally(struct label_map *out, const struct label_voxels *voxels);

/** Gives voxels of @p to with label 0 the labels that they have in @p from. Both have as many voxels. On failure @p to
 * is unchanged. */
conus_status label_voxels_merge(struct label_voxels *to, const struct label_voxels *from);

/** Replaces each place p by numbers[p], in the same memory; 2 bytes each if @p narrow, else 4. numbers[0] is 0. The
 * voxels no longer refer to `labels` then. */
conus_status label_voxels_renumber(struct label_voxels *voxels, const uint32_t *numbers, bool narrow);

/** The labels of an array. */
conus_status label_voxels_of(struct label_voxels *out, const uint32_t *labels, size_t count);

/** Makes label voxels from labels that come block by block. */
struct label_coder {
    struct label_voxels voxels;
    uint8_t *memory;  /* of the places */
    size_t size;      /* its bytes */
    uint8_t *earlier; /* what `memory` was before the places became wide, if that was not in place */
    size_t done;      /* voxels before the next one */
    bool is_own;      /* the memory was zeros, and voxels may come in any order */
    uint64_t limit;
    size_t label_capacity, count_capacity;
    struct label_map place_of; /* label -> place */
    uint32_t last, last_place;
    uint32_t minimum, maximum; /* of the labels, at the end */
};

/** For @p count voxels, whose places and labels may take @p limit bytes (0 = any), LABEL_BYTES for each label;
 * CONUS_ERROR_MEMORY if that is too little. They are written to @p memory, of @p size bytes, if it is not NULL, which
 * is taken over also on failure. The caller may keep the labels that are still to come in it, @p size / @p count bytes
 * each, 2 or more. */
conus_status label_coder_init(struct label_coder *coder, size_t count, uint64_t limit, uint8_t *memory, size_t size);

/** Appends the labels of the next @p count voxels. More than LABEL_VOXELS_LIMIT different ones are CONUS_ERROR_DATA,
 * more than fit CONUS_ERROR_MEMORY. */
conus_status label_coder_add(struct label_coder *coder, const uint32_t *labels, size_t count);

/** The same of voxels from @p first on, in any order, each once, where label_coder_init() was given no memory. */
conus_status label_coder_put(struct label_coder *coder, size_t first, const uint32_t *labels, size_t count);

/** Moves the result to @p out when all voxels are there; of memory of its own, those that never came have label 0. */
void label_coder_end(struct label_voxels *out, struct label_coder *coder);
void label_coder_finish(struct label_coder *coder);

#endif
