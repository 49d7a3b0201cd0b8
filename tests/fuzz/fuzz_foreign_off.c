/* SPDX-License-Identifier: BSD-3-Clause */
/* OFF surfaces. */
#include "fuzz_foreign.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct foreign_mesh mesh = {0};
    conus_status status = off_parse(&mesh, data, size);
    check_foreign(&mesh, status);
    return 0;
}
