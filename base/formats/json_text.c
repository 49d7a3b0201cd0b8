/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses JSON through jansson, after a count of the values bounds the memory. */
#include "base/formats/json_text.h"

#include "base/memory.h"

#include <string.h>

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

/* Python writes NaN, Infinity and -Infinity, which JSON does not have. A copy of the text with null or, in the three
 * letters of NaN, an empty text in their place, which are no numbers either; *out stays NULL if there are none. */
static conus_status replace_no_numbers(char **out, struct text text)
{
    static const char *const words[][2] = {{"NaN", "\"\" "}, {"-Infinity", "null     "}, {"Infinity", "null    "}};
    char *copy = NULL;
    bool quoted = false;
    for (size_t at = 0; at < text.size; at++) {
        const char c = text.data[at];
        at += quoted && c == '\\';
        quoted = quoted != (c == '"');
        const struct text rest = {text.data + at, at < text.size ? text.size - at : 0};
        for (size_t i = 0; !quoted && i < sizeof words / sizeof words[0]; i++) {
            if (text_starts(rest, words[i][0])) {
                copy = copy ? copy : memory_text(text.data, text.size);
                if (!copy) {
                    return CONUS_ERROR_MEMORY;
                }
                memcpy(copy + at, words[i][1], strlen(words[i][1]));
                at += strlen(words[i][0]) - 1;
                break;
            }
        }
    }
    *out = copy;
    return CONUS_OK;
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
    char *other = NULL;
    bool is_tried = root || json_error_code(&error) == json_error_out_of_memory;
    if (!is_tried && replace_no_numbers(&other, text)) {
        return fail(CONUS_ERROR_MEMORY, "no memory for the JSON text");
    }
    root = other ? json_loadb(other, text.size, JSON_REJECT_DUPLICATES, &error) : root;
    memory_free(other);
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

static void drop_root(void *root)
{
    json_decref(root);
}

json_t *json_text_read(struct job *job, struct text text)
{
    json_t *root = NULL;
    if (JOB_CALL(job, json_text_load(&root, text))) {
        job_own(job, drop_root, root);
    }
    return job_ok(job) ? root : NULL;
}

struct text json_text_of(const json_t *value)
{
    return json_is_string(value) ? (struct text){json_string_value(value), json_string_length(value)} : text_from("");
}

bool json_numbers(double *out, size_t count, const json_t *list)
{
    bool fine = json_array_size(list) == count;
    for (size_t i = 0; i < count && fine; i++) {
        fine = json_is_number(json_array_get(list, i));
        out[i] = json_number_value(json_array_get(list, i));
    }
    return fine;
}
