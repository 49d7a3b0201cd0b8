/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads JSON values by tables of keys. */
#include "loaders/manifest/schema.h"

#include "base/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* `text` as part of one line: at most 40 bytes, control characters as '?'. */
static const char *quote_text(struct job *job, const char *text)
{
    enum { SHOWN = 40 };
    size_t size = strnlen(text, SHOWN);
    while (size && ((unsigned char)text[size] & 0xc0) == 0x80) { /* never half a character */
        size--;
    }
    char *out = job_format(job, "%.*s%s", (int)size, text, text[size] ? "..." : "");
    for (char *c = out; *c; c++) {
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    }
    return out;
}

void schema_fail(const struct schema_place *place, const json_t *value, const char *wanted)
{
    static const char *const types[] = {
        [JSON_OBJECT] = "an object", [JSON_ARRAY] = "a list", [JSON_STRING] = "a text", [JSON_INTEGER] = "a number",
        [JSON_REAL] = "a number",    [JSON_TRUE] = "true",    [JSON_FALSE] = "false",   [JSON_NULL] = "null"};
    struct job *job = place->job;
    const char *found = json_is_string(value)   ? job_format(job, "\"%s\"", quote_text(job, json_string_value(value)))
                        : json_is_number(value) ? job_format(job, "%.9g", json_number_value(value))
                                                : types[json_typeof(value)];
    job_bad(job, "%s: found %s, %s is needed", place->key[0] ? place->key : "content", found, wanted);
}

static struct schema_place place_of_key(const struct schema_place *place, const char *key)
{
    struct schema_place inner = *place;
    snprintf(inner.key, sizeof inner.key, "%.100s%s%s", place->key, place->key[0] ? "." : "", key);
    return inner;
}

struct schema_place schema_element(const struct schema_place *place, size_t index)
{
    struct schema_place inner = *place;
    snprintf(inner.key, sizeof inner.key, "%.130s[%zu]", place->key, index);
    return inner;
}

static void fail_unknown(const struct schema_place *place, const char *key)
{
    const struct schema_field *field = place->field->keys;
    const char *known = field->key;
    while ((++field)->key) {
        known = job_format(place->job, "%s, %s", known, field->key);
    }
    job_bad(place->job, "%s: unknown key, allowed are %s", place_of_key(place, quote_text(place->job, key)).key, known);
}

void schema_object(const struct schema_place *place, void *out, const json_t *object)
{
    const char *key;
    json_t *value;
    if (!json_is_object(object)) {
        schema_fail(place, object, "an object");
    }
    json_object_foreach((json_t *)object, key, value)
    {
        const struct schema_field *field = place->field->keys;
        while (field->key && strcmp(field->key, key) != 0) {
            field++;
        }
        if (field->key) {
            struct schema_place inner = place_of_key(place, key);
            inner.field = field;
            field->read(&inner, (char *)out + field->offset, value);
        } else {
            fail_unknown(place, key);
        }
    }
    for (const struct schema_field *field = place->field->keys; field->key; field++) {
        if (field->required && !json_object_get(object, field->key)) {
            job_bad(place->job, "%s is missing", place_of_key(place, field->key).key);
        }
    }
}

void schema_path_or_object(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *first = place->field->keys;
    if (json_is_string(value)) {
        first->read(place, (char *)out + first->offset, value);
    } else if (json_is_object(value)) {
        schema_object(place, out, value);
    } else {
        schema_fail(place, value, "a path or an object");
    }
}

void schema_list(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *list = place->field;
    bool may_be_one = list->many == SCHEMA_ONE_OR_LIST;
    bool is_one = list->many == SCHEMA_ONE || (may_be_one && (json_is_string(value) || json_is_object(value)));
    size_t count = is_one ? 1 : json_array_size(value);
    if (!is_one && (!json_is_array(value) || (list->wanted && !count))) {
        schema_fail(place, value,
                    may_be_one     ? "a path, an object or a list of these"
                    : list->wanted ? list->wanted
                                   : "a list");
    } else if (list->most && count > list->most) {
        job_bad(place->job, "%s: %zu entries, allowed are %zu", place->key, count, list->most);
    }
    LIST(char) entries = {.at = job_zeroed(place->job, count + 1, list->size)}; /* one more: not NULL without entries */
    entries.count = entries.at ? count : 0;
    entries.capacity = entries.count;
    memcpy(out, &entries, sizeof entries); /* a pointer of another type is not written as one of this */
    for (size_t i = 0; i < entries.count && job_ok(place->job); i++) {
        struct schema_place inner = is_one ? *place : schema_element(place, i);
        list->each(&inner, entries.at + i * list->size, is_one ? value : json_array_get(value, i));
    }
}

void schema_text(const struct schema_place *place, void *out, const json_t *value)
{
    const char *text = json_string_value(value);
    const char *end = text; /* of the first line */
    while (end && (unsigned char)*end >= 0x20 && *end != 0x7f) {
        end++;
    }
    if (!text || !text[0] || *end) {
        schema_fail(place, value, "a text of one line that is not empty");
    }
    *(char **)out = job_copy(place->job, text_from(text ? text : ""));
}

void schema_comment(const struct schema_place *place, void *out, const json_t *value)
{
    (void)out;
    if (!json_is_string(value)) {
        schema_fail(place, value, "a text");
    }
}

void schema_flag(const struct schema_place *place, void *out, const json_t *value)
{
    *(bool *)out = json_is_true(value);
    if (!json_is_boolean(value)) {
        schema_fail(place, value, "true or false");
    }
}

void schema_positive(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *field = place->field;
    double number = json_number_value(value);
    *(double *)out = number;
    if (!(number > 0) || !isfinite(number) || (field->most && number > (double)field->most)) {
        schema_fail(place, value, field->wanted ? field->wanted : "a number above 0");
    }
}

/* True when following `path` never climbs above where it begins. */
static bool stays_inside(const char *path)
{
    bool inside = !path_is_whole(path);
    const char *part;
    size_t size;
    long depth = 0;
    while (inside && path_part(&path, &part, &size)) {
        const bool here = size == 0 || (size == 1 && part[0] == '.');
        depth += size == 2 && strncmp(part, "..", 2) == 0 ? -1 : !here;
        inside = depth >= 0;
    }
    return inside;
}

void schema_path(const struct schema_place *place, void *out, const json_t *value)
{
    const char *path = json_string_value(value);
    if (path && !place->allow_outside && !stays_inside(path)) {
        schema_fail(place, value, "a path inside the manifest's folder (or \"allow_outside\": true)");
    }
    schema_text(place, out, value);
}

void schema_uint(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *field = place->field;
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    *(uint32_t *)out = (uint32_t)number;
    if (number < field->first || number > UINT32_MAX) {
        schema_fail(place, value,
                    field->wanted  ? field->wanted
                    : field->first ? "a whole number from 1 to 4294967295"
                                   : "a whole number from 0 to 4294967295");
    }
}

unsigned schema_index(const struct schema_place *place, const json_t *value)
{
    const char *const *words = place->field->words;
    const char *text = json_string_value(value);
    const char *wanted = "";
    for (unsigned i = 0; words[i]; i++) {
        if (text && strcmp(text, words[i]) == 0) {
            return i;
        }
        wanted = job_format(place->job, "%s%s\"%s\"", wanted, i ? " or " : "", words[i]);
    }
    schema_fail(place, value, wanted);
    return 0;
}

void schema_word(const struct schema_place *place, void *out, const json_t *value)
{
    *(unsigned *)out = place->field->first + schema_index(place, value);
}
