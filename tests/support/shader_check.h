/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What glslang, the reference compiler of GLSL, says to the text that drivers get. */
#ifndef CONUS_TESTS_SUPPORT_SHADER_CHECK_H
#define CONUS_TESTS_SUPPORT_SHADER_CHECK_H

#include <stdbool.h>
#include <stddef.h>

/** From now on each program that is linked is compiled and linked by glslang, too; one that it finds an error or a
 * warning in is a failure. Skips the running test where there is no OpenGL 4.5 or no glslang. */
void shader_check_begin(void);

/** Ends that, and fails unless glslang took all. Returns how many programs there were. */
size_t shader_check_end(void);

/** Whether glslang takes a program. Skips as shader_check_begin() does. */
bool shader_check_takes(const char *vertex, const char *fragment);

/** Whether a shader was linked since shader_check_begin() that holds both texts; @p define may be "". */
bool shader_check_saw(const char *define, const char *text);

#endif
