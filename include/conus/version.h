/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file version.h
 * Which version of conus this is, for the preprocessor and at run time.
 */
#ifndef CONUS_PUBLIC_VERSION_H
#define CONUS_PUBLIC_VERSION_H

#include <conus/status.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CONUS_VERSION_MAJOR 0 /**< Rises with changes that break callers; while it is 0, the minor number does. */
#define CONUS_VERSION_MINOR 1 /**< Rises with new functions and members. */
#define CONUS_VERSION_PATCH 0 /**< Rises with corrections. */

/** A version as one number that grows with it: `#if CONUS_VERSION_NUMBER >= CONUS_MAKE_VERSION(0, 2, 0)`. */
#define CONUS_MAKE_VERSION(major, minor, patch) ((major)*1000000L + (minor)*1000L + (patch))
/** The version of these headers as one number. */
#define CONUS_VERSION_NUMBER CONUS_MAKE_VERSION(CONUS_VERSION_MAJOR, CONUS_VERSION_MINOR, CONUS_VERSION_PATCH)

/** @cond The text of a number that is a macro. */
#define CONUS_TEXT_OF_(number) #number
#define CONUS_VERSION_OF_(major, minor, patch) CONUS_TEXT_OF_(major) "." CONUS_TEXT_OF_(minor) "." CONUS_TEXT_OF_(patch)
/** @endcond */
/** The version of these headers as text: "0.1.0". */
#define CONUS_VERSION CONUS_VERSION_OF_(CONUS_VERSION_MAJOR, CONUS_VERSION_MINOR, CONUS_VERSION_PATCH)

/** Gives the version of the library that runs. It may be newer than #CONUS_VERSION, which the caller was compiled with.
 * @return "0.1.0". Static. */
CONUS_API const char *conus_version(void);

#ifdef __cplusplus
}
#endif

#endif
