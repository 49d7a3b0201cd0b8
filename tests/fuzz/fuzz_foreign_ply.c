/* SPDX-License-Identifier: BSD-3-Clause */
/* PLY surfaces. */
#include "fuzz_foreign.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_foreign(ply_parse, data, size);
    return 0;
}
