/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Reading JSON strictly: a table of the keys that an object may have, and a function for each type of value. Every
 * failure is CONUS_ERROR_DATA and names the key by its path ("pathways[2].threshold"). */
#ifndef CONUS_LOADERS_MANIFEST_SCHEMA_H
#define CONUS_LOADERS_MANIFEST_SCHEMA_H

#include "base/formats/json_text.h"

#include <jansson.h>

enum { SCHEMA_KEY_SIZE = 160 };

/** Where the reader is, and what holds for the whole file. */
struct schema_place {
    char key[SCHEMA_KEY_SIZE]; /**< "" at the top. */
    bool allow_outside;        /**< Paths may be absolute or climb out of the file's folder. */
};

/** Reads @p value into @p field. */
typedef conus_status (*schema_read)(void *field, const json_t *value, const struct schema_place *place);

/** A key that an object may have; a table of them ends with a NULL key. */
struct schema_field {
    const char *key;
    schema_read read;
    size_t offset; /**< Offset of the field in what the object is read into. */
    bool required;
    const char *const *words; /**< Instead of read: one of these, NULL at the end. The field, an enum, becomes */
    unsigned first;           /**< this and the word's index. */
};

/** "KEY: found ..., WANTED is needed". */
conus_status schema_fail(const struct schema_place *place, const json_t *value, const char *wanted);

/** The place of entry @p index of the list at @p place. */
struct schema_place schema_element(const struct schema_place *place, size_t index);

/** Reads an object by its table; keys that are not in it, and required ones that are missing, are errors. */
conus_status schema_object(void *out, const json_t *object, const struct schema_field *fields,
                           const struct schema_place *place);

/** Reads a path into *path, or an object into @p out by its table. */
conus_status schema_path_or_object(char **path, void *out, const json_t *value, const struct schema_field *fields,
                                   const struct schema_place *place);

/** Reads a list of at most @p most entries into *entries, zeroed, of @p size bytes each; set with *count as soon as it
 * is there, and the caller's to memory_free() with what is in it, also on failure. */
conus_status schema_list(void **entries, size_t *count, size_t size, size_t most, const json_t *list, schema_read read,
                         const struct schema_place *place);

/* Values. */
conus_status schema_text(void *field, const json_t *value, const struct schema_place *place); /**< char *, owned    */
conus_status schema_path(void *field, const json_t *value, const struct schema_place *place); /**< the same         */
conus_status schema_comment(void *field, const json_t *value, const struct schema_place *place); /**< nothing */
conus_status schema_flag(void *field, const json_t *value, const struct schema_place *place); /**< bool             */
conus_status schema_positive(void *field, const json_t *value,
                             const struct schema_place *place); /**< double, above 0  */

/** A whole number from @p least, 0 or 1. */
conus_status schema_uint(uint32_t *out, const json_t *value, const struct schema_place *place, json_int_t least);

/** Frees the texts (schema_text, schema_path) of @p count objects of @p size bytes that were read by the table. */
void schema_finish(void *objects, size_t count, size_t size, const struct schema_field *fields);

/** One of @p words (NULL at the end); *out becomes its index. */
conus_status schema_word(unsigned *out, const json_t *value, const struct schema_place *place,
                         const char *const *words);

#endif
