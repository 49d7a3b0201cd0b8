/* SPDX-License-Identifier: BSD-3-Clause */
/* How a file of gzip begins. */
#include "base/byte_order.h"

bool gzip_is(const uint8_t *data, size_t size)
{
    return size >= 3 && data[0] == 0x1f && data[1] == 0x8b && data[2] == 8; /* 8: deflate, the only method there is */
}
