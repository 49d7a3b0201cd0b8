/* SPDX-License-Identifier: BSD-3-Clause */
/* VTK's XML format. */
#include "fuzz_foreign.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_foreign(vtp_parse, data, size);
    return 0;
}
