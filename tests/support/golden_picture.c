/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares a picture with a kept one, block by block. */
#include "golden_picture.h"

#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { COLUMNS = 8, ROWS = 6 };

static double mean(const conus_image *image, int channel, uint32_t column, uint32_t row)
{
    const float *plane = image_rgba(image).plane[channel];
    double sum = 0;
    size_t count = 0;
    for (uint32_t y = row * image->height / ROWS; y < (row + 1) * image->height / ROWS; y++) {
        for (uint32_t x = column * image->width / COLUMNS; x < (column + 1) * image->width / COLUMNS; x++, count++) {
            sum += (double)plane[(size_t)y * image->width + x];
        }
    }
    return sum / (double)count;
}

double golden_brightness(const conus_image *got, const conus_image *wanted)
{
    double largest = 0;
    for (uint32_t block = 0; block < COLUMNS * ROWS; block++) {
        for (int channel = 0; channel < 3; channel++) {
            double radiance = mean(wanted, channel, block % COLUMNS, block / COLUMNS);
            double change = mean(got, channel, block % COLUMNS, block / COLUMNS) - radiance;
            largest = fmax(largest, fabs(change) / fmax(radiance, 0.05));
        }
    }
    return largest;
}

void golden_check(const conus_image *got, const char *name)
{
    char path[512];
    const char *scratch = test_scratch(name); /* 8 bits, as the golden picture has */
    conus_image *rounded = NULL;
    conus_image *wanted = NULL;
    conus_image_difference difference;
    snprintf(path, sizeof path, "%s/tests/golden/%s", CONUS_SOURCE_DIR, name);
    if (getenv("CONUS_WRITE_GOLDEN")) {
        assert_ok(conus_image_write(got, path));
    }
    assert_ok(conus_image_write(got, scratch));
    assert_ok(conus_image_load(&rounded, scratch));
    assert_ok(conus_image_load(&wanted, path));
    assert_ok(conus_image_compare(&difference, rounded, wanted, 0));
    double brightness = golden_brightness(rounded, wanted);
    if (difference.rms > 0.015 || brightness > 0.01) {
        test_keep_scratch();
        fail_msg("%s differs from %s by %g rms of white and %.2f %% of brightness, allowed are 0.015 and 1 %%", scratch,
                 path, difference.rms, 100 * brightness);
    }
    conus_image_destroy(rounded);
    conus_image_destroy(wanted);
}
