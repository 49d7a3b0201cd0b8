/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file export.h
 * How the functions of the library are declared, and structs of options initialised.
 */
#ifndef CONUS_PUBLIC_EXPORT_H
#define CONUS_PUBLIC_EXPORT_H

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

#endif
