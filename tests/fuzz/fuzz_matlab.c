/* SPDX-License-Identifier: BSD-3-Clause */
/* MATLAB's files: the parts of what is parsed lie inside it, and every value can be read. */
#include "base/formats/matlab.h"

#include <stdlib.h>

enum { LIMIT = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const struct matlab *matlab, const struct matlab_array *array)
{
    char text[64];
    volatile double sum = 0;
    size_t parts = array->kind == MATLAB_CELL     ? array->count
                   : array->kind == MATLAB_STRUCT ? array->count * array->fields
                                                  : 0;
    if (parts && array->parts + parts > matlab->count) {
        abort();
    }
    for (size_t i = 0; matlab_is_real(array) && i < array->count; i++) {
        sum = sum + matlab_number(array, i);
    }
    (void)matlab_text(text, sizeof text, array);
    (void)matlab_field(matlab, array, 0, "name");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct matlab matlab;
    if (matlab_parse(&matlab, (struct text){(const char *)data, size}, LIMIT) == CONUS_OK) {
        for (size_t i = 0; i < matlab.count; i++) {
            check(&matlab, &matlab.arrays[i]);
        }
        matlab_finish(&matlab);
    }
    return 0;
}
