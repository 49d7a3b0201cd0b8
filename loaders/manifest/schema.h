/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Reading JSON strictly: a table of the keys that an object may have, and a function for each type of value. What is
 * read is the job's. Every failure but that of memory is CONUS_ERROR_DATA and names the key by its path
 * ("pathways[2].threshold"). */
#ifndef CONUS_LOADERS_MANIFEST_SCHEMA_H
#define CONUS_LOADERS_MANIFEST_SCHEMA_H

#include "base/job/job.h"

#include <jansson.h>

enum { SCHEMA_KEY_SIZE = 160 };

/** Where the reader is, and what holds for the whole file. */
struct schema_place {
    struct job *job;
    const struct schema_field *field; /**< What the table says of the key. */
    char key[SCHEMA_KEY_SIZE];        /**< "" at the top. */
    bool allow_outside;               /**< Paths may be absolute or climb out of the file's folder. */
};

/** Reads @p value into @p out. */
typedef void schema_read(const struct schema_place *place, void *out, const json_t *value);

/** How many entries a list has. */
enum schema_many {
    SCHEMA_LIST,
    SCHEMA_ONE_OR_LIST, /**< One may stand in place of the list. */
    SCHEMA_ONE          /**< One always does. */
};

/** A key that an object may have; a table of them ends with a NULL key. The other members are those of some readers. */
struct schema_field {
    const char *key;
    schema_read *read;
    size_t offset; /**< Offset of the field in what the object is read into. */
    bool required;
    const char *const *words; /**< schema_index(): NULL at the end. */
    unsigned first;           /**< schema_word(): the enum's value for the first word; schema_uint(): the least. */
    const struct schema_field *keys; /**< schema_object(), schema_path_or_object(). */
    schema_read *each;               /**< schema_list(): reads an entry, */
    size_t size;                     /**< which has this size. */
    size_t most;                     /**< schema_list(): the most entries, schema_positive(): the largest; 0 = any. */
    enum schema_many many;
    const char *wanted; /**< What a message calls a number, or a list that may not be empty, if not as usual. */
};

/** The members for the LIST() @p entries of a struct @p type. */
#define SCHEMA_ENTRIES(type, entries)                                                                                  \
    .offset = offsetof(struct type, entries), .size = sizeof *((struct type *)NULL)->entries.at

/** "KEY: found ..., WANTED is needed". */
void schema_fail(const struct schema_place *place, const json_t *value, const char *wanted);

/** The place of entry @p index of the list at @p place. */
struct schema_place schema_element(const struct schema_place *place, size_t index);

/** @name Readers @{ */
schema_read schema_object;         /**< Of the table `keys`: others, and required ones that are missing, are errors. */
schema_read schema_path_or_object; /**< The same, or a text, which is the value of the first of the keys. */
schema_read schema_list;           /**< LIST(). */
schema_read schema_text;           /**< char *: one line that is not empty. */
schema_read schema_path;           /**< The same. */
schema_read schema_comment;        /**< Nothing. */
schema_read schema_flag;           /**< bool. */
schema_read schema_positive;       /**< double. */
schema_read schema_uint;           /**< uint32_t, from 0 or 1. */
schema_read schema_word;           /**< An enum. */
/** @} */

/** The index of a word in `words`. */
unsigned schema_index(const struct schema_place *place, const json_t *value);

#endif
