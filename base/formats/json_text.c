/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses JSON through jansson, after a count of the values bounds the memory. */
#include "base/formats/json_text.h"

/* At most what jansson takes for the text: an empty object 256 bytes, an array 128, an entry of either 64. */
static uint64_t memory_of(struct text text)
{
    uint64_t memory = 2 * (uint64_t)text.size;
    for (size_t i = 0; i < text.size; i++) {
        char c = text.data[i];
        memory += c == '{' ? 256 : c == '[' ? 128 : c == ',' || c == ':' ? 64 : 0;
    }
    return memory;
}

conus_status json_text_load(json_t **out, struct text text)
{
    json_error_t error;
    text = text_from_bytes((const uint8_t *)text.data, text.size); /* without a byte order mark */
    if (memory_of(text) > JSON_TEXT_MEMORY) {
        return fail(CONUS_ERROR_MEMORY, "JSON text of %zu bytes that would take %llu in memory, allowed are %d",
                    text.size, (unsigned long long)memory_of(text), JSON_TEXT_MEMORY);
    }
    json_t *root = json_loadb(text.data, text.size, JSON_REJECT_DUPLICATES, &error);
    if (root) {
        *out = root;
        return CONUS_OK;
    }
    if (json_error_code(&error) == json_error_out_of_memory) {
        return fail(CONUS_ERROR_MEMORY, "no memory for the JSON text");
    }
    for (char *c = error.text; *c; c++) {
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    }
    return fail(CONUS_ERROR_DATA, "line %d, column %d: %s", error.line, error.column, error.text);
}

struct text json_text_of(const json_t *value)
{
    return json_is_string(value) ? (struct text){json_string_value(value), json_string_length(value)} : text_from("");
}
