/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for the build's identity where programs are not ELF, as in a web page: nothing is cached there. */
#include "base/system/build_id.h"

bool build_id_find(char out[BUILD_ID_SIZE])
{
    out[0] = '\0';
    return false;
}
