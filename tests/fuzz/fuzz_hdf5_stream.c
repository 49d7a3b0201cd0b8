/* SPDX-License-Identifier: BSD-3-Clause */
/* Arbitrary bytes in the place of conus-hdf5's stream. */
#include "base/child/hdf5.h"
#include "base/memory.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Reads every element; ends at an object that breaks a promise. */
static void use(const struct hdf5_value *value)
{
    size_t used = 0;
    for (size_t i = 0; i < value->count && value->size; i++) {
        used += hdf5_number(value, i) != 0;
    }
    for (size_t i = 0; i < value->count && value->class == HDF5_STRING; i++) {
        struct text text = hdf5_string(value, i);
        used += text.size && text.data[text.size - 1];
    }
    if (used > value->count) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    const struct text stream = {job_adopt(&job, memory_copy(data, size, 1)), size};
    const struct hdf5 *hdf5 = stream.data ? hdf5_of_stream(&job, stream) : NULL;
    for (size_t i = 0; hdf5 && i < hdf5_count(hdf5); i++) {
        const struct hdf5_object *object = hdf5_object(hdf5, i);
        use(&object->value);
        for (size_t k = 0; k < object->attribute_count; k++) {
            use(&object->attributes[k]);
        }
        const struct hdf5_object *found = hdf5_find_address(hdf5, object->address);
        if (!found || found->address != object->address) {
            abort();
        }
    }
    const bool says_why = job_ok(&job) || *job.message;
    job_end(&job);
    return says_why ? 0 : -1;
}
