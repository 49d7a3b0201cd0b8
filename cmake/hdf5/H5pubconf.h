/* SPDX-License-Identifier: BSD-3-Clause */
/* What libhdf5's configure script would find out on the systems that scripts/libraries builds for, and what it would be
 * asked for: deflate, and no other library. */
#define H5_DEFAULT_PLUGINDIR "" /* conus-hdf5 has it load nothing */

#define H5_HAVE_FILTER_DEFLATE 1
#define H5_HAVE_ZLIB_H 1

#define H5_SIZEOF_BOOL 1
#define H5_SIZEOF_CHAR 1
#define H5_SIZEOF_SHORT 2
#define H5_SIZEOF_INT 4
#define H5_SIZEOF_UNSIGNED 4
#define H5_SIZEOF_LONG __SIZEOF_LONG__
#define H5_SIZEOF_LONG_LONG 8
#define H5_SIZEOF_FLOAT 4
#define H5_SIZEOF_DOUBLE 8
#define H5_SIZEOF_LONG_DOUBLE __SIZEOF_LONG_DOUBLE__
#define H5_SIZEOF_INT8_T 1
#define H5_SIZEOF_UINT8_T 1
#define H5_SIZEOF_INT16_T 2
#define H5_SIZEOF_UINT16_T 2
#define H5_SIZEOF_INT32_T 4
#define H5_SIZEOF_UINT32_T 4
#define H5_SIZEOF_INT64_T 8
#define H5_SIZEOF_UINT64_T 8
#define H5_SIZEOF_SIZE_T 8
#define H5_SIZEOF_SSIZE_T 8
#define H5_SIZEOF_PTRDIFF_T 8
#define H5_SIZEOF_OFF_T 8
#define H5_SIZEOF_TIME_T 8
#define H5_PRINTF_LL_WIDTH "ll"
#define H5_LDOUBLE_TO_LLONG_ACCURATE 1
#define H5_LLONG_TO_LDOUBLE_CORRECT 1
#define H5_WANT_DATA_ACCURACY 1
#define H5_WANT_DCONV_EXCEPTION 1

#define H5_STDC_HEADERS 1
#define H5_HAVE_ATTRIBUTE 1
#define H5_HAVE_C99_DESIGNATED_INITIALIZER 1
#define H5_HAVE_C99_FUNC 1
#define H5_HAVE_INLINE 1
#define H5_HAVE_INTTYPES_H 1
#define H5_HAVE_SETJMP_H 1
#define H5_HAVE_STDBOOL_H 1
#define H5_HAVE_STDDEF_H 1
#define H5_HAVE_STDINT_H 1
#define H5_HAVE_SYS_STAT_H 1
#define H5_HAVE_SYS_TIME_H 1
#define H5_HAVE_SYS_TYPES_H 1
#define H5_TIME_WITH_SYS_TIME 1
#define H5_HAVE_DIFFTIME 1
#define H5_HAVE_FREXPF 1
#define H5_HAVE_GETTIMEOFDAY 1
#define H5_HAVE_STRTOLL 1
#define H5_HAVE_VASPRINTF 1
#ifdef _WIN32
#define H5_HAVE_MINGW 1
#define H5_HAVE_WIN32_API 1
#else
#define H5_DEV_T_IS_SCALAR 1
#define H5_HAVE_DIRENT_H 1
#define H5_HAVE_DLFCN_H 1
#define H5_HAVE_FCNTL 1
#define H5_HAVE_PREADWRITE 1
#define H5_HAVE_RANDOM 1
#define H5_HAVE_RAND_R 1
#define H5_HAVE_SYMLINK 1
#define H5_HAVE_TM_GMTOFF 1
#define H5_HAVE_UNISTD_H 1
#endif
#ifdef __APPLE__
#define H5_HAVE_DARWIN 1
#endif
