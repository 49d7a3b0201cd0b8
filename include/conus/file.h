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
