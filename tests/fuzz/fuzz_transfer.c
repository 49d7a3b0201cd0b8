/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a transfer function: the points of an accepted one are in order and in range. */
#include "render/colour/colour.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct transfer transfer = {0};
    if (transfer_parse(&transfer, data, size)) {
        return 0;
    }
    float table[64 * 4];
    transfer_table(table, 64, &transfer);
    for (int i = 0; i < 64 * 4; i++) {
        float limit = i % 4 == 3 ? 24 : 1;
        if (!(table[i] >= 0 && table[i] <= limit)) {
            abort();
        }
    }
    transfer_finish(&transfer);
    return 0;
}
