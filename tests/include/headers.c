/* SPDX-License-Identifier: BSD-3-Clause */
/* The public header stands alone, in plain C99. */
#include <conus/conus.h>

extern int conus_headers_compile;
int conus_headers_compile = CONUS_OK;
