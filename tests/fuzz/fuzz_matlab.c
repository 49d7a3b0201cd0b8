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

static const struct matlab *parse(struct job *job, const uint8_t *data, size_t size)
{
    struct text text = {(const char *)data, size};
    if (!text_starts(text, HDF5_STREAM_MAGIC)) {
        return text_starts(text, "MATLAB 7") ? NULL : matlab_read(job, text, LIMIT);
    }
    text.data = job_adopt(job, memory_copy(data, size, 1)); /* at a multiple of 8 */
    return text.data ? matlab_of_hdf5(job, hdf5_of_stream(job, text), LIMIT) : NULL;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    const struct matlab *matlab = parse(&job, data, size);
    for (size_t i = 0; matlab && i < matlab->count; i++) {
        check(matlab, &matlab->arrays[i]);
    }
    job_end(&job);
    return 0;
}
