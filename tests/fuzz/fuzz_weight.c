/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a table of weights: one that is read is 0 or more and finite up to its end, 0 beyond, and nowhere more
 * than its largest. */
#include "conus/own.h"
#include "fuzz_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    conus_weight *weight = NULL;
    const char *path = fuzz_path(data, size);
    if (!path || conus_weight_create(&weight, path)) {
        return 0;
    }
    double range[2];
    const bool has_depth = conus_weight_range(range, weight);
    const bool is_angle = !isnan(conus_weight_angle(weight));
    const double end = is_angle ? conus_weight_angle(weight) / 2 : conus_weight_radius(weight);
    const double largest = conus_weight_largest(weight, end, range);
    bool is_fine =
        end > 0 && (!is_angle || end < 90) && conus_weight_at(weight, nextafter(end, INFINITY), range[0]) == 0;
    is_fine = is_fine && (!has_depth || conus_weight_at(weight, 0, nextafter(range[1], INFINITY)) == 0);
    for (int i = 0; i <= 256 && is_fine; i++) {
        const int row = i / 16;
        const double z = range[0] + (range[1] - range[0]) * row / 16;
        const double value = conus_weight_at(weight, end * (i % 16) / 16, z);
        is_fine = value >= 0 && value <= largest * (1 + 1e-15) && isfinite(largest);
    }
    if (!is_fine) {
        abort();
    }
    conus_weight_destroy(weight);
    return 0;
}
