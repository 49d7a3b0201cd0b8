/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_hdf5 FILE BYTES PATTERN...: writes everything that conus-hdf5 reads of an HDF5 file to stdout as JSON, for
 * tests/oracles/compare_hdf5.py: objects in their order, numbers as values, references as the paths that they lead
 * to. */
#include "base/child/hdf5.h"

#include <stdio.h>
#include <stdlib.h>

static void print_text(struct text text)
{
    putchar('"');
    for (size_t i = 0; i < text.size; i++) {
        unsigned char c = (unsigned char)text.data[i];
        printf(c == '"' || c == '\\' || c < ' ' ? "\\u%04x" : "%c", c);
    }
    putchar('"');
}

static void print_element(const struct hdf5 *hdf5, const struct hdf5_value *value, size_t i)
{
    if (value->class == HDF5_STRING) {
        print_text(hdf5_string(value, i));
    } else if (value->class == HDF5_REFERENCE) {
        const struct hdf5_object *object = hdf5_find_address(hdf5, (uint64_t)hdf5_whole(value, i));
        print_text(object ? object->value.name : text_from(""));
    } else if (value->class == HDF5_FLOAT) {
        printf("%.17g", hdf5_number(value, i));
    } else if (value->class == HDF5_SIGNED) {
        printf("%lld", (long long)hdf5_whole(value, i));
    } else {
        printf("%llu", (unsigned long long)hdf5_whole(value, i));
    }
}

static void print_value(const struct hdf5 *hdf5, const struct hdf5_value *value)
{
    static const char *const classes[] = {"", "group", "float", "signed", "unsigned", "string", "reference", "other"};
    printf("{\"class\": \"%s\", \"size\": %zu, \"dims\": [", classes[value->class], value->size);
    for (size_t i = 0; i < value->rank; i++) {
        printf("%s%llu", i ? ", " : "", (unsigned long long)value->dims[i]);
    }
    printf("], \"values\": [");
    for (size_t i = 0; i < value->count && value->data; i++) {
        printf(i ? ", " : "");
        print_element(hdf5, value, i);
    }
    printf("]}");
}

static void print_object(const struct hdf5 *hdf5, const struct hdf5_object *object)
{
    printf("{\"path\": ");
    print_text(object->value.name);
    printf(", \"value\": ");
    print_value(hdf5, &object->value);
    printf(", \"attributes\": {");
    for (size_t i = 0; i < object->attribute_count; i++) {
        printf(i ? ", " : "");
        print_text(object->attributes[i].name);
        printf(": ");
        print_value(hdf5, &object->attributes[i]);
    }
    printf("}}");
}

int main(int argc, char **argv)
{
    struct open_file file;
    struct job job = {.max_memory = argc > 3 ? strtoull(argv[2], NULL, 10) : 0};
    conus_status status = argc > 3 ? file_open(&file, argv[1]) : CONUS_ERROR_ARGUMENT;
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
        return (int)status;
    }
    job_in(&job, argv[1], JOB_ALONE);
    const struct hdf5 *hdf5 = hdf5_open(&job, &file, (const char *const *)argv + 3, (size_t)argc - 3);
    file_close(&file);
    if (!job_ok(&job)) {
        status = job_close(&job, NULL, NULL);
        fprintf(stderr, "%s\n", conus_message());
        return (int)status;
    }
    printf("[");
    for (size_t i = 0; i < hdf5_count(hdf5); i++) {
        printf(i ? ",\n " : "");
        print_object(hdf5, hdf5_object(hdf5, i));
    }
    printf("]\n");
    job_end(&job);
    return 0;
}
