/* SPDX-License-Identifier: BSD-3-Clause */
/* MATLAB's files, of level 5 or as conus-hdf5 gives level 7.3: the parts of an accepted array lie inside it, and every
 * value can be read. */
#include "base/formats/matlab.h"
#include "base/memory.h"

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

static conus_status parse(struct matlab *out, const uint8_t *data, size_t size)
{
    struct text text = {(const char *)data, size};
    struct hdf5 *hdf5 = NULL;
    if (!text_starts(text, HDF5_STREAM_MAGIC)) {
        return text_starts(text, "MATLAB 7") ? CONUS_ERROR_DATA : matlab_parse(out, text, LIMIT);
    }
    struct bytes stream = {memory_copy(data, size, 1), size};
    conus_status status = stream.data ? hdf5_parse(&hdf5, &stream) : CONUS_ERROR_MEMORY;
    return status ? status : matlab_from_hdf5(out, hdf5, LIMIT);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct matlab matlab;
    if (parse(&matlab, data, size) == CONUS_OK) {
        for (size_t i = 0; i < matlab.count; i++) {
            check(&matlab, &matlab.arrays[i]);
        }
        matlab_finish(&matlab);
    }
    return 0;
}
