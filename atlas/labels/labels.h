/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A label table: what a file says about the numbers in a labelled volume. */
#ifndef CONUS_ATLAS_LABELS_H
#define CONUS_ATLAS_LABELS_H

#include "base/notes.h"
#include "base/text.h"
#include "conus/atlas.h"

#include <stddef.h>
#include <stdint.h>

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

#endif
