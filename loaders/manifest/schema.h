/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * JSON by tables: rows say which keys an object may have and what they become, and both directions follow them. What is
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

/** A type of value. */
struct schema_type {
    void (*read)(const struct schema_place *place, void *out, const json_t *value);
    /** A new value, the caller's; NULL = none, where it is the default, or after a failure. No function: never. */
    json_t *(*write)(struct job *job, const struct schema_field *field, const void *in);
};

/** A key that objects may have; a table of them ends with a NULL key. The last members are those of some types. */
struct schema_field {
    const char *key;
    const struct schema_type *type;
    size_t offset;                  /**< Offset of the field in what the object is read into. */
    unsigned kinds;                 /**< Of the objects that may have the key, a bit each. */
    unsigned needed;                /**< Of those that must. */
    const char *const *words;       /**< schema_index(): NULL at the end. */
    unsigned first;                 /**< schema_word: the enum's value for the first word; schema_uint: the least. */
    size_t most;                    /**< Lists: the most entries, schema_positive: the largest; 0 = any. */
    const char *wanted;             /**< What a message calls the value that it needs, if not as usual. */
    const struct schema_type *each; /**< schema_list: its entries, */
    size_t size;                    /**< which have this size. */
    unsigned items;                 /**< Lists of a scene's items: their kinds. */
};

/** "KEY: found ..., WANTED is needed". */
void schema_fail(const struct schema_place *place, const json_t *value, const char *wanted);

/** The place of entry @p index of the list at @p place. */
struct schema_place schema_element(const struct schema_place *place, size_t index);

/** Reads the object @p value of the @p kind into @p out by the table @p fields: keys that are not of the kind, and
 * needed ones that are missing, are errors. */
void schema_read(const struct schema_place *place, void *out, const json_t *value, const struct schema_field *fields,
                 unsigned kind);

/** The object of the @p kind that would be read into @p in: a new value, NULL after a failure. */
json_t *schema_write(struct job *job, const void *in, const struct schema_field *fields, unsigned kind);

/** @p value, whose lack is an error of memory. */
json_t *schema_need(struct job *job, json_t *value);

/** Puts @p value, unless NULL, which is taken over, into @p object, or at the end of the list @p object. */
void schema_put(struct job *job, json_t *object, const char *key, json_t *value);

/** The index of a word in `words`. */
unsigned schema_index(const struct schema_place *place, const json_t *value);

/** @name Types @{ */
extern const struct schema_type schema_text; /**< char *: one line that is not empty. */
extern const struct schema_type schema_path;
extern const struct schema_type schema_comment;  /**< For people: nothing. */
extern const struct schema_type schema_flag;     /**< bool. */
extern const struct schema_type schema_number;   /**< double; infinite where it is not there. */
extern const struct schema_type schema_positive; /**< double. */
extern const struct schema_type schema_triple;   /**< double[3], above 0. */
extern const struct schema_type schema_uint;     /**< uint32_t, from 0 or 1. */
extern const struct schema_type schema_choice;   /**< size_t: 1 + the number, from 0. */
extern const struct schema_type schema_word;     /**< An enum. */
extern const struct schema_type schema_list;     /**< LIST(), not empty. */
/** @} */

#endif
