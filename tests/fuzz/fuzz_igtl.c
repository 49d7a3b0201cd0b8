/* SPDX-License-Identifier: BSD-3-Clause */
/* Bytes from a network: whole and in pieces they mean the same, and every pose that is heard is rigid. */
#include "link/station.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void hear(void *user, const struct igtl_poses *poses)
{
    *(unsigned *)user += 1;
    for (size_t i = 0; i < poses->count; i++) {
        const double *m = poses->tools[i].matrix;
        double turned = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
                        m[8] * (m[1] * m[6] - m[2] * m[5]);
        if (!(fabs(turned - 1) < 0.01) || !isfinite(m[12] + m[13] + m[14]) ||
            strlen(poses->tools[i].name) >= IGTL_NAME) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct igtl_reader whole;
    static struct igtl_reader pieces;
    unsigned heard[2] = {0};
    bool fine = true;
    size_t step = size ? 1 + data[0] % 61 : 1;
    memset(&whole, 0, sizeof whole);
    memset(&pieces, 0, sizeof pieces);
    bool all = igtl_read(&whole, data, size, hear, &heard[0]);
    for (size_t at = 0; at < size && fine; at += step) {
        fine = igtl_read(&pieces, data + at, step < size - at ? step : size - at, hear, &heard[1]);
    }
    if (all != fine || heard[0] != heard[1] || memcmp(&whole.counts, &pieces.counts, sizeof whole.counts) != 0) {
        abort();
    }
    return 0;
}
