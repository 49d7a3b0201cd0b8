/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file status.h
 * How functions are declared and report failure, and the callbacks for notes and progress.
 */
#ifndef CONUS_PUBLIC_STATUS_H
#define CONUS_PUBLIC_STATUS_H

#include <stdbool.h>
#include <stddef.h>

/** @def CONUS_API
 * A function of the library. On Windows CONUS_STATIC says that it is linked statically: who uses conus.dll does not
 * define it. */
/** @def CONUS_CHECKED
 * A function of the library whose result must be used. */
#if defined(_WIN32) && !defined(CONUS_STATIC)
#define CONUS_API __declspec(dllimport)
#define CONUS_CHECKED __declspec(dllimport)
#elif defined(__GNUC__)
#define CONUS_API __attribute__((visibility("default")))
#define CONUS_CHECKED __attribute__((visibility("default"), warn_unused_result))
#else
#define CONUS_API
#define CONUS_CHECKED
#endif

/** @cond The initialiser of a struct whose first member is struct_size. */
#ifdef __cplusplus
#define CONUS_INIT_(type)                                                                                              \
    ([] {                                                                                                              \
        type all = type();                                                                                             \
        all.struct_size = sizeof(type);                                                                                \
        return all;                                                                                                    \
    }())
#else
/* clang-format off */
#define CONUS_INIT_(type) {.struct_size = sizeof(type)}
/* clang-format on */
#endif
/** @endcond */

#ifdef __cplusplus
extern "C" {
#endif

/** The result of each function that can fail. */
typedef enum conus_status {
    CONUS_OK = 0,            /**< Done. */
    CONUS_ERROR_ARGUMENT,    /**< An argument breaks its documented range. */
    CONUS_ERROR_MEMORY,      /**< An allocation failed, or the input asks for more than the allowed memory. */
    CONUS_ERROR_IO,          /**< The system refused to read or write. */
    CONUS_ERROR_DATA,        /**< The file is damaged, contradicts itself or is not of its format. */
    CONUS_ERROR_UNSUPPORTED, /**< Valid, but beyond this library. */
    CONUS_ERROR_GL,          /**< No usable OpenGL 4.5 context, or the driver failed. */
    CONUS_ERROR_CANCELLED    /**< A callback asked for the end. */
} conus_status;

/** Names a status.
 * @param code A status; any number is allowed.
 * @return "CONUS_ERROR_DATA", or "CONUS_ERROR_UNKNOWN" for a number that is no status. Static. */
CONUS_API const char *conus_status_name(conus_status code);

/** Describes the last failure on the calling thread: one line with what was found and what is allowed.
 * @return "" if no function failed. Borrowed until the next failure on this thread. */
CONUS_API const char *conus_message(void);

/** How much a note matters. */
typedef enum conus_severity {
    CONUS_SEVERITY_NOTE = 1, /**< Something was chosen, assumed, left out, or is odd. */
    CONUS_SEVERITY_WARNING   /**< An answer may name another place or another area than the data mean. */
} conus_severity;

/** One thing that a careful user should know; no error. */
typedef struct conus_note {
    conus_severity severity; /**< How much it matters. */
    const char *path;        /**< The file that was being read, as it was named; NULL = it is about no file. */
    const char *line;        /**< One line without its end, UTF-8. */
} conus_note;

/** Receives a note of a driver, an engine or a reader when it is made, on the thread that called into the library; what
 * the gl engine says of a batch may come on another, which ends with the call, one note at a time. Each note comes
 * once, also of a call that fails afterwards.
 * @param user The pointer that the options gave.
 * @param note Valid until the callback returns. */
typedef void (*conus_log)(void *user, const conus_note *note);

/** Receives how far a task is, on the thread that called into the library.
 * @param user The pointer that the options gave.
 * @param done Steps that are done.
 * @param total Steps in all.
 * @return False cancels the task, which then fails with #CONUS_ERROR_CANCELLED. */
typedef bool (*conus_progress)(void *user, size_t done, size_t total);

#ifdef __cplusplus
}
#endif

#endif
