/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file file.h
 * Small helpers for programs that print names from files and write files of their own.
 */
#ifndef CONUS_PUBLIC_FILE_H
#define CONUS_PUBLIC_FILE_H

#include <conus/status.h>

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Makes a text that came from outside, a name or a path, harmless for a terminal, in place. A space replaces each
 * character that would steer the terminal, except line feeds and tabs. '?' replaces each byte that is not UTF-8.
 * Messages and notes of this library are plain already.
 * @param[in,out] text Ends with a NUL.
 * @threads Any.
 * @since 0.1
 */
CONUS_API void conus_plain_text(char *text);

/**
 * Has this process remember each file that this library reads from now on, on any thread, until it ends. From then on
 * no function of this library that writes files replaces one of these, by whatever name or link:
 * #CONUS_ERROR_ARGUMENT. What it has written itself and then reads may be written again.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_inputs_keep(void);

/**
 * Adds a file that the program has read by itself, or is going to read.
 * @param path What is no regular file is not added.
 * @threads Any.
 * @since 0.1
 */
CONUS_API void conus_inputs_add(const char *path);

/**
 * Finds out whether a new file @p path would take the place of a file that was read.
 * @param path The file, also by a link to it.
 * @return The name by which it was read, borrowed until the process ends; NULL where it was not.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const char *conus_inputs_find(const char *path);

/**
 * Gives the name of the file that was read, in the order of reading; a file that was read twice is there twice.
 * @param index From 0.
 * @return NULL past the last. Borrowed until the process ends.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const char *conus_inputs_at(size_t index);

/**
 * Writes a file that appears whole or not at all.
 * @param path The file; replaced if it exists.
 * @param data The bytes.
 * @param size How many bytes.
 * @return #CONUS_OK; #CONUS_ERROR_IO where the system refuses.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_write_file(const char *path, const void *data, size_t size);

#ifdef __cplusplus
}
#endif

#endif
