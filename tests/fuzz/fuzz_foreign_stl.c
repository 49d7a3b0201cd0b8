/* SPDX-License-Identifier: BSD-3-Clause */
/* STL surfaces. */
#include "fuzz_foreign.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_foreign(stl_parse, data, size);
    return 0;
}
