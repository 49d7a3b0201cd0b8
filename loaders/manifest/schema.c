/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads JSON values by tables of keys. */
#include "loaders/manifest/schema.h"

#include "base/buffer.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* `text` as part of one line: at most 40 bytes, control characters as '?'. */
static const char *quote_text(char out[48], const char *text)
{
    size_t i = 0;
    for (; text[i] && i < 40; i++) {
        out[i] = (unsigned char)text[i] < 0x20 || text[i] == 0x7f ? '?' : text[i];
    }
    while (i && ((unsigned char)text[i] & 0xc0) == 0x80) { /* never half a character */
        i--;
    }
    snprintf(out + i, 4, "%s", text[i] ? "..." : "");
    return out;
}

conus_status schema_fail(const struct schema_place *place, const json_t *value, const char *wanted)
{
    static const char *const types[] = {
        [JSON_OBJECT] = "an object", [JSON_ARRAY] = "a list", [JSON_STRING] = "a text", [JSON_INTEGER] = "a number",
        [JSON_REAL] = "a number",    [JSON_TRUE] = "true",    [JSON_FALSE] = "false",   [JSON_NULL] = "null"};
    char text[48];
    char found[72];
    if (json_is_string(value)) {
        snprintf(found, sizeof found, "\"%s\"", quote_text(text, json_string_value(value)));
    } else if (json_is_number(value)) {
        snprintf(found, sizeof found, "%.9g", json_number_value(value));
    } else {
        snprintf(found, sizeof found, "%s", types[json_typeof(value)]);
    }
    return fail(CONUS_ERROR_DATA, "%s: found %s, %s is needed", place->key[0] ? place->key : "content", found, wanted);
}

static struct schema_place place_of_key(const struct schema_place *place, const char *key)
{
    char text[48];
    struct schema_place inner = {.allow_outside = place->allow_outside};
    snprintf(inner.key, sizeof inner.key, "%.100s%s%s", place->key, place->key[0] ? "." : "", quote_text(text, key));
    return inner;
}

struct schema_place schema_element(const struct schema_place *place, size_t index)
{
    struct schema_place inner = {.allow_outside = place->allow_outside};
    snprintf(inner.key, sizeof inner.key, "%.130s[%zu]", place->key, index);
    return inner;
}

static conus_status fail_unknown(const struct schema_place *place, const struct schema_field *fields)
{
    struct buffer known = {0};
    for (const struct schema_field *field = fields; field->key; field++) {
        buffer_format(&known, "%s%s", field == fields ? "" : ", ", field->key);
    }
    conus_status status = buffer_status(&known);
    status = status ? status : fail(CONUS_ERROR_DATA, "%s: unknown key, allowed are %s", place->key, known.data);
    buffer_finish(&known);
    return status;
}

conus_status schema_object(void *out, const json_t *object, const struct schema_field *fields,
                           const struct schema_place *place)
{
    const char *key;
    json_t *value;
    if (!json_is_object(object)) {
        return schema_fail(place, object, "an object");
    }
    json_object_foreach((json_t *)object, key, value)
    {
        struct schema_place inner = place_of_key(place, key);
        const struct schema_field *field = fields;
        while (field->key && strcmp(field->key, key) != 0) {
            field++;
        }
        void *at = (char *)out + field->offset;
        unsigned word = 0;
        conus_status status = !field->key    ? fail_unknown(&inner, fields)
                              : field->words ? schema_word(&word, value, &inner, field->words)
                                             : field->read(at, value, &inner);
        if (!status && field->words) {
            *(unsigned *)at = field->first + word;
        }
        if (status) {
            return status;
        }
    }
    for (const struct schema_field *field = fields; field->key; field++) {
        if (field->required && !json_object_get(object, field->key)) {
            return fail(CONUS_ERROR_DATA, "%s is missing", place_of_key(place, field->key).key);
        }
    }
    return CONUS_OK;
}

conus_status schema_text(void *field, const json_t *value, const struct schema_place *place)
{
    char **out = field;
    const char *text = json_string_value(value);
    const char *end = text; /* of the first line */
    while (end && (unsigned char)*end >= 0x20 && *end != 0x7f) {
        end++;
    }
    if (!text || !text[0] || *end) {
        return schema_fail(place, value, "a text of one line that is not empty");
    }
    *out = memory_text(text, json_string_length(value));
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status schema_comment(void *field, const json_t *value, const struct schema_place *place)
{
    (void)field;
    return json_is_string(value) ? CONUS_OK : schema_fail(place, value, "a text");
}

conus_status schema_flag(void *field, const json_t *value, const struct schema_place *place)
{
    bool *out = field;
    if (!json_is_boolean(value)) {
        return schema_fail(place, value, "true or false");
    }
    *out = json_is_true(value);
    return CONUS_OK;
}

conus_status schema_positive(void *field, const json_t *value, const struct schema_place *place)
{
    double *out = field;
    double number = json_number_value(value);
    if (!(number > 0) || !isfinite(number)) {
        return schema_fail(place, value, "a number above 0");
    }
    *out = number;
    return CONUS_OK;
}

/* True when following `path` never climbs above where it begins. */
static bool stays_inside(const char *path)
{
    long depth = 0;
    for (const char *part = path; *part && depth >= 0;) {
        size_t length = strcspn(part, "/");
        bool up = length == 2 && memcmp(part, "..", 2) == 0;
        bool here = length == 0 || (length == 1 && part[0] == '.');
        depth += up ? -1 : here ? 0 : 1;
        part += length + (part[length] == '/');
    }
    return depth >= 0 && path[0] != '/';
}

conus_status schema_path(void *field, const json_t *value, const struct schema_place *place)
{
    const char *path = json_string_value(value);
    if (path && !place->allow_outside && !stays_inside(path)) {
        return schema_fail(place, value, "a path inside the manifest's folder (or \"allow_outside\": true)");
    }
    return schema_text(field, value, place);
}

conus_status schema_path_or_object(char **path, void *out, const json_t *value, const struct schema_field *fields,
                                   const struct schema_place *place)
{
    return json_is_string(value)   ? schema_path(path, value, place)
           : json_is_object(value) ? schema_object(out, value, fields, place)
                                   : schema_fail(place, value, "a path or an object");
}

conus_status schema_uint(uint32_t *out, const json_t *value, const struct schema_place *place, json_int_t least)
{
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < least || number > UINT32_MAX) {
        return schema_fail(place, value,
                           least ? "a whole number from 1 to 4294967295" : "a whole number from 0 to 4294967295");
    }
    *out = (uint32_t)number;
    return CONUS_OK;
}

conus_status schema_word(unsigned *out, const json_t *value, const struct schema_place *place, const char *const *words)
{
    struct buffer wanted = {0};
    const char *text = json_string_value(value);
    for (unsigned i = 0; words[i]; i++) {
        if (text && strcmp(text, words[i]) == 0) {
            buffer_finish(&wanted);
            *out = i;
            return CONUS_OK;
        }
        buffer_format(&wanted, "%s\"%s\"", i ? " or " : "", words[i]);
    }
    conus_status status = buffer_status(&wanted);
    status = status ? status : schema_fail(place, value, wanted.data);
    buffer_finish(&wanted);
    return status;
}

conus_status schema_list(void **entries, size_t *count, size_t size, size_t most, const json_t *list,
                         conus_status (*read)(void *, const json_t *, const struct schema_place *),
                         const struct schema_place *place)
{
    size_t length = json_array_size(list);
    if (!json_is_array(list)) {
        return schema_fail(place, list, "a list");
    }
    if (length > most) {
        return fail(CONUS_ERROR_DATA, "%s: %zu entries, allowed are %zu", place->key, length, most);
    }
    *entries = memory_zeroed(length, size);
    if (!*entries) {
        return CONUS_ERROR_MEMORY;
    }
    *count = length;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < length; i++) {
        struct schema_place inner = schema_element(place, i);
        status = read((char *)*entries + i * size, json_array_get(list, i), &inner);
    }
    return status;
}

void schema_finish(void *objects, size_t count, size_t size, const struct schema_field *fields)
{
    for (const struct schema_field *field = fields; field->key; field++) {
        for (size_t i = 0; i < count && (field->read == schema_text || field->read == schema_path); i++) {
            memory_free(*(char **)(void *)((char *)objects + i * size + field->offset));
        }
    }
}
