/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_matlab FILE: writes the contents of a file of MATLAB to stdout as JSON, for tests/oracles/compare_matlab.py: a
 * number array as its dimensions and values, characters as a text, cells as a list, structures as a list of objects,
 * and types that are not read as null. */
#include "base/formats/matlab.h"

#include <stdio.h>
#include <string.h>

enum { LIMIT = 1 << 26, TEXT_SIZE = 4096 };

static void print_text(struct text text)
{
    putchar('"');
    for (size_t i = 0; i < text.size; i++) {
        unsigned char c = (unsigned char)text.data[i];
        printf(c == '"' || c == '\\' || c < ' ' ? "\\u%04x" : "%c", c);
    }
    putchar('"');
}

static void print_numbers(const struct matlab_array *array)
{
    printf("{\"rows\": %zu, \"columns\": %zu, \"values\": [", array->rows, array->columns);
    for (size_t i = 0; i < array->count; i++) {
        printf("%s%.17g", i ? ", " : "", matlab_number(array, i));
    }
    printf("]}");
}

static void print_array(const struct matlab *matlab, const struct matlab_array *array);

static void print_structures(const struct matlab *matlab, const struct matlab_array *array)
{
    for (size_t i = 0; i < array->count; i++) {
        printf("%s{", i ? ", " : "");
        for (size_t k = 0; k < array->fields; k++) {
            char name[TEXT_SIZE];
            snprintf(name, sizeof name, "%.*s", TEXT_SHOW(matlab->arrays[array->parts + k].name, sizeof name));
            printf("%s\"%s\": ", k ? ", " : "", name);
            print_array(matlab, matlab_field(matlab, array, i, name));
        }
        printf("}");
    }
}

static void print_parts(const struct matlab *matlab, const struct matlab_array *array)
{
    printf("[");
    if (array->kind == MATLAB_STRUCT) {
        print_structures(matlab, array);
    }
    for (size_t i = 0; array->kind == MATLAB_CELL && i < array->count; i++) {
        printf("%s", i ? ", " : "");
        print_array(matlab, &matlab->arrays[array->parts + i]);
    }
    printf("]");
}

static void print_array(const struct matlab *matlab, const struct matlab_array *array)
{
    char text[TEXT_SIZE];
    if (matlab_is_real(array)) {
        print_numbers(array);
    } else if (array->kind == MATLAB_CHAR && (array->rows == 1 || !array->bytes.size)) {
        print_text(matlab_text(text, sizeof text, array));
    } else if (array->kind == MATLAB_CELL || array->kind == MATLAB_STRUCT) {
        print_parts(matlab, array);
    } else {
        printf(array->kind == MATLAB_EMPTY ? "{\"rows\": 0, \"columns\": 0, \"values\": []}" : "null");
    }
}

int main(int argc, char **argv)
{
    struct bytes bytes = {0};
    conus_status status = argc == 2 ? file_read(&bytes, argv[1], LIMIT) : CONUS_ERROR_ARGUMENT;
    struct job job = {0};
    const struct matlab *matlab = NULL;
    if (JOB_CALL(&job, status)) {
        matlab = matlab_read(&job, (struct text){(const char *)bytes.data, bytes.size}, LIMIT);
    }
    if (!job_ok(&job)) {
        fprintf(stderr, "%s\n", job.message);
        return 1;
    }
    printf("{");
    for (size_t i = 0; i < matlab->variables; i++) {
        printf("%s", i ? ", " : "");
        print_text(matlab->arrays[i].name);
        printf(": ");
        print_array(matlab, &matlab->arrays[i]);
    }
    printf("}\n");
    job_end(&job);
    bytes_finish(&bytes);
    return 0;
}
