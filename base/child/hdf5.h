/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Parts of an HDF5 file, read by the program conus-hdf5 (base/child/child.h). libhdf5 has open errors of memory, so it
 * runs in a process of its own. Its output is parsed as strictly as a stranger's file. */
#ifndef CONUS_BASE_CHILD_HDF5_H
#define CONUS_BASE_CHILD_HDF5_H

#include "base/child/hdf5_protocol.h"
#include "base/job/job.h"

/** A dataset, a group, or an attribute. */
struct hdf5_value {
    struct text name; /**< Path of an object, "/TransformGroup/0"; name of an attribute. */
    enum hdf5_class class;
    size_t size;                    /**< Bytes of a number or reference, else 0. */
    size_t rank;                    /**< 0 = one element. */
    uint64_t dims[HDF5_RANK_LIMIT]; /**< The last is the fastest. */
    size_t count;                   /**< Elements: the product of the dims. */
    const uint8_t *data;            /**< [count * size], little-endian, at a multiple of 8; NULL = there are none. */
};

struct hdf5_object {
    struct hdf5_value value;
    uint64_t address; /**< The value of references to it. */
    const struct hdf5_value *attributes;
    size_t attribute_count;
};

/** The objects that were read, in the order of their paths, in which names that are decimal numbers are in the order of
 * these: "/T/2" comes before "/T/10". */
struct hdf5;

/** Whether a file that begins with these bytes is HDF5: the mark is at 0, 512, 1024, 2048, … */
bool hdf5_is(const uint8_t *data, size_t size);

/** Reads those objects of @p file, and their attributes, that any of @p count patterns @p wanted names: absolute paths
 * in which a name may be "*" (any one), and the last "**" (the object before it, and all below, at any depth). No
 * object may be named twice. What the file lacks is not there. The job's max_memory: bytes of all that is read, and of
 * the program beside the file. Refused are links to other files, data that are stored in others, virtual datasets, all
 * filters but deflate, shuffle and fletcher32, groups within themselves. CONUS_ERROR_UNSUPPORTED where there is no
 * conus-hdf5. The path is a place, which the caller enters before. The objects are the job's; after a failure there are
 * none, here and below. */
const struct hdf5 *hdf5_open(struct job *job, const struct open_file *file, const char *const *wanted, size_t count);

/** The same of a file that is in memory, with @p max_memory in place of the job's. */
const struct hdf5 *hdf5_of_bytes(struct job *job, struct text file, const char *const *wanted, size_t count,
                                 uint64_t max_memory);

/** The objects in @p stream, which must live as long as the job, at a multiple of 8. */
const struct hdf5 *hdf5_of_stream(struct job *job, struct text stream);

size_t hdf5_count(const struct hdf5 *hdf5);
const struct hdf5_object *hdf5_object(const struct hdf5 *hdf5, size_t index);

/** The object at @p path, or NULL. */
const struct hdf5_object *hdf5_find(const struct hdf5 *hdf5, const char *path);
/** One that a reference leads to, or NULL. */
const struct hdf5_object *hdf5_find_address(const struct hdf5 *hdf5, uint64_t address);
/** The object @p name in @p group; NULL = not there, or not asked for. */
const struct hdf5_object *hdf5_find_in(const struct hdf5 *hdf5, struct text group, const char *name);
/** The next object that lies directly in @p group, in the order of names; start with *at = 0. NULL = no more. */
const struct hdf5_object *hdf5_next_in(const struct hdf5 *hdf5, size_t *at, struct text group);
/** The last name of a path. */
struct text hdf5_last_name(struct text path);

/** An attribute of @p object, or NULL. */
const struct hdf5_value *hdf5_attribute(const struct hdf5_object *object, const char *name);

bool hdf5_is_number(const struct hdf5_value *value);
/** Element @p index of numbers, as a double; of references, as the address. */
double hdf5_number(const struct hdf5_value *value, size_t index);
/** Element @p index of numbers or references as a whole number; of 8 unsigned bytes as the same bits. */
int64_t hdf5_whole(const struct hdf5_value *value, size_t index);
/** Element @p index of strings. */
struct text hdf5_string(const struct hdf5_value *value, size_t index);
/** The one string that @p value is; "" where it is anything else, or NULL. */
struct text hdf5_text(const struct hdf5_value *value);

#endif
