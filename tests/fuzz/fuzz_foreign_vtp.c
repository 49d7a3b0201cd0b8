/* SPDX-License-Identifier: BSD-3-Clause */
/* VTK's XML format. */
#include "fuzz_foreign.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct foreign_mesh mesh = {0};
    conus_status status = vtp_parse(&mesh, data, size, 1 << 24);
    check_foreign(&mesh, status);
    return 0;
}
