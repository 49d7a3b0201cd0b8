/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes JSON values by tables of keys. */
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

static void fail_unknown(const struct schema_place *place, const struct schema_field *fields, unsigned kind,
                         const char *key)
{
    const char *known = "";
    for (const struct schema_field *field = fields; field->key; field++) {
        if (field->kinds & kind) {
            known = job_format(place->job, "%s%s%s", known, known[0] ? ", " : "", field->key);
        }
    }
    job_bad(place->job, "%s: unknown key, allowed are %s", place_of_key(place, quote_text(place->job, key)).key, known);
}

void schema_read(const struct schema_place *place, void *out, const json_t *value, const struct schema_field *fields,
                 unsigned kind)
{
    const char *key;
    json_t *inner;
    if (!json_is_object(value)) {
        schema_fail(place, value, "an object");
    }
    json_object_foreach((json_t *)value, key, inner)
    {
        const struct schema_field *field = fields;
        while (field->key && !(field->kinds & kind && strcmp(field->key, key) == 0)) {
            field++;
        }
        if (field->key) {
            struct schema_place at = place_of_key(place, key);
            at.field = field;
            field->type->read(&at, (char *)out + field->offset, inner);
        } else {
            fail_unknown(place, fields, kind, key);
        }
    }
    for (const struct schema_field *field = fields; field->key; field++) {
        if (field->needed & kind && !json_object_get(value, field->key)) {
            job_bad(place->job, "%s is missing", place_of_key(place, field->key).key);
        }
    }
}

void schema_put(struct job *job, json_t *object, const char *key, json_t *value)
{
    if (value && (key ? json_object_set_new(object, key, value) : json_array_append_new(object, value))) {
        schema_need(job, NULL);
    }
}

json_t *schema_need(struct job *job, json_t *value)
{
    if (!value) {
        job_fail(job, CONUS_ERROR_MEMORY, "no memory for the manifest");
    }
    return value;
}

json_t *schema_write(struct job *job, const void *in, const struct schema_field *fields, unsigned kind)
{
    json_t *object = schema_need(job, json_object());
    for (const struct schema_field *field = fields; field->key && job_ok(job); field++) {
        if (field->kinds & kind && field->type->write) {
            schema_put(job, object, field->key, field->type->write(job, field, (const char *)in + field->offset));
        }
    }
    return object;
}

static void read_list(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *list = place->field;
    const size_t count = json_array_size(value);
    LIST(char) entries = {.at = job_zeroed(place->job, count, list->size)};
    entries.count = entries.capacity = entries.at ? count : 0;
    if (!count) {
        schema_fail(place, value, list->wanted);
    }
    memcpy(out, &entries, sizeof entries); /* a pointer of another type is not written as one of this */
    for (size_t i = 0; i < entries.count && job_ok(place->job); i++) {
        struct schema_place inner = schema_element(place, i);
        list->each->read(&inner, entries.at + i * list->size, json_array_get(value, i));
    }
}

static json_t *write_list(struct job *job, const struct schema_field *field, const void *in)
{
    LIST(char) entries;
    memcpy(&entries, in, sizeof entries);
    json_t *list = entries.count ? schema_need(job, json_array()) : NULL;
    for (size_t i = 0; i < entries.count && job_ok(job); i++) {
        schema_put(job, list, NULL, field->each->write(job, field, entries.at + i * field->size));
    }
    return list;
}

static void read_text(const struct schema_place *place, void *out, const json_t *value)
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

static json_t *write_text(struct job *job, const struct schema_field *field, const void *in)
{
    const char *text = *(char *const *)in;
    if (text && !text_is_utf8(text_from(text))) {
        job_bad(job, "%s: %s is no UTF-8, as all texts of a manifest are", field->key, quote_text(job, text));
    }
    return text && job_ok(job) ? schema_need(job, json_string(text)) : NULL;
}

static void read_comment(const struct schema_place *place, void *out, const json_t *value)
{
    (void)out;
    if (!json_is_string(value)) {
        schema_fail(place, value, "a text");
    }
}

static void read_flag(const struct schema_place *place, void *out, const json_t *value)
{
    *(bool *)out = json_is_true(value);
    if (!json_is_boolean(value)) {
        schema_fail(place, value, "true or false");
    }
}

static json_t *write_flag(struct job *job, const struct schema_field *field, const void *in)
{
    (void)field;
    return *(const bool *)in ? schema_need(job, json_true()) : NULL;
}

static void read_number(const struct schema_place *place, void *out, const json_t *value)
{
    *(double *)out = json_number_value(value);
    if (!json_is_number(value)) {
        schema_fail(place, value, "a number");
    }
}

static void read_positive(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *field = place->field;
    double number = json_number_value(value);
    *(double *)out = number;
    if (!(number > 0) || !isfinite(number) || (field->most && number > (double)field->most)) {
        schema_fail(place, value, field->wanted ? field->wanted : "a number above 0");
    }
}

static json_t *write_number(struct job *job, const struct schema_field *field, const void *in)
{
    const double number = *(const double *)in;
    const bool is_default = field->type == &schema_positive ? number == 0 : isinf(number);
    return is_default ? NULL : schema_need(job, json_real(number));
}

static void read_triple(const struct schema_place *place, void *out, const json_t *value)
{
    const bool is_triple = json_array_size(value) == 3;
    if (!is_triple) {
        schema_fail(place, value, place->field->wanted);
    }
    for (size_t i = 0; is_triple && i < 3; i++) {
        struct schema_place inner = schema_element(place, i);
        inner.field = &(struct schema_field){0};
        read_positive(&inner, (double *)out + i, json_array_get(value, i));
    }
}

static json_t *write_triple(struct job *job, const struct schema_field *field, const void *in)
{
    const double *numbers = in;
    (void)field;
    return numbers[0] > 0 ? schema_need(job, json_pack("[f,f,f]", numbers[0], numbers[1], numbers[2])) : NULL;
}

/* True when following `path` never climbs above where it begins. */
static bool stays_inside(const char *path)
{
    bool inside = !path_is_whole(path);
    struct text part;
    long depth = 0;
    while (inside && path_part(&path, &part.data, &part.size)) {
        depth += text_equal(part, "..") ? -1 : part.size && !text_equal(part, ".");
        inside = depth >= 0;
    }
    return inside;
}

static void read_path(const struct schema_place *place, void *out, const json_t *value)
{
    const char *path = json_string_value(value);
    if (path && !place->allow_outside && !stays_inside(path)) {
        schema_fail(place, value, "a path inside the manifest's folder (or \"allow_outside\": true)");
    }
    read_text(place, out, value);
}

static void read_uint(const struct schema_place *place, void *out, const json_t *value)
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

static json_t *write_uint(struct job *job, const struct schema_field *field, const void *in)
{
    const uint32_t number = *(const uint32_t *)in;
    (void)field;
    return number ? schema_need(job, json_integer(number)) : NULL;
}

static void read_choice(const struct schema_place *place, void *out, const json_t *value)
{
    uint32_t number;
    read_uint(place, &number, value);
    *(size_t *)out = (size_t)number + 1;
}

static json_t *write_choice(struct job *job, const struct schema_field *field, const void *in)
{
    const size_t choice = *(const size_t *)in;
    (void)field;
    return choice ? schema_need(job, json_integer((json_int_t)choice - 1)) : NULL;
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

static void read_word(const struct schema_place *place, void *out, const json_t *value)
{
    *(unsigned *)out = place->field->first + schema_index(place, value);
}

static json_t *write_word(struct job *job, const struct schema_field *field, const void *in)
{
    const unsigned value = *(const unsigned *)in;
    return value ? schema_need(job, json_string(field->words[value - field->first])) : NULL;
}

const struct schema_type schema_text = {read_text, write_text};
const struct schema_type schema_path = {read_path, write_text};
const struct schema_type schema_comment = {.read = read_comment};
const struct schema_type schema_flag = {read_flag, write_flag};
const struct schema_type schema_number = {read_number, write_number};
const struct schema_type schema_positive = {read_positive, write_number};
const struct schema_type schema_triple = {read_triple, write_triple};
const struct schema_type schema_uint = {read_uint, write_uint};
const struct schema_type schema_choice = {read_choice, write_choice};
const struct schema_type schema_word = {read_word, write_word};
const struct schema_type schema_list = {read_list, write_list};
