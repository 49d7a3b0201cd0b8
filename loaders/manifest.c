/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of the keys that each kind of JSON object may have drive the parser; one function per type of value. */
#include "loaders/manifest.h"

#include "base/buffer.h"
#include "base/memory.h"

#include <ctype.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { KEY_SIZE = 160 };

/* Where the parser is: the key's path for messages, and what holds for the whole file. */
struct place {
    char key[KEY_SIZE];
    bool allow_outside;
};

/* A key that an object may have. `field` is the place that receives the value. */
struct field {
    const char *key;
    conus_status (*read)(void *field, const json_t *value, const struct place *place);
    size_t offset;
    bool required;
};

/* ---- Messages ---------------------------------------------------------------------------------------------- */

/* `text` as part of one line: at most 40 bytes, control characters as '?'. */
static const char *shown(char out[48], const char *text)
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

static conus_status fail_value(const struct place *place, const json_t *value, const char *wanted)
{
    static const char *const types[] = {
        [JSON_OBJECT] = "an object", [JSON_ARRAY] = "a list", [JSON_STRING] = "a text", [JSON_INTEGER] = "a number",
        [JSON_REAL] = "a number",    [JSON_TRUE] = "true",    [JSON_FALSE] = "false",   [JSON_NULL] = "null"};
    char text[48];
    char found[72];
    if (json_is_string(value)) {
        snprintf(found, sizeof found, "\"%s\"", shown(text, json_string_value(value)));
    } else if (json_is_number(value)) {
        snprintf(found, sizeof found, "%.9g", json_number_value(value));
    } else {
        snprintf(found, sizeof found, "%s", types[json_typeof(value)]);
    }
    return fail(CONUS_ERROR_DATA, "%s: found %s, %s is needed", place->key[0] ? place->key : "content", found, wanted);
}

static struct place below(const struct place *place, const char *key)
{
    char text[48];
    struct place inner = {.allow_outside = place->allow_outside};
    snprintf(inner.key, sizeof inner.key, "%.100s%s%s", place->key, place->key[0] ? "." : "", shown(text, key));
    return inner;
}

static struct place element(const struct place *place, size_t index)
{
    struct place inner = {.allow_outside = place->allow_outside};
    snprintf(inner.key, sizeof inner.key, "%.130s[%zu]", place->key, index);
    return inner;
}

static conus_status fail_unknown(const struct place *place, const struct field *fields)
{
    struct buffer known = {0};
    for (const struct field *field = fields; field->key; field++) {
        buffer_format(&known, "%s%s", field == fields ? "" : ", ", field->key);
    }
    conus_status status = buffer_status(&known);
    status = status ? status : fail(CONUS_ERROR_DATA, "%s: unknown key, allowed are %s", place->key, known.data);
    buffer_finish(&known);
    return status;
}

/* ---- Objects ----------------------------------------------------------------------------------------------- */

static const struct field *find_field(const struct field *fields, const char *key)
{
    while (fields->key && strcmp(fields->key, key) != 0) {
        fields++;
    }
    return fields->key ? fields : NULL;
}

static conus_status read_object(void *out, const json_t *object, const struct field *fields, const struct place *place)
{
    const char *key;
    json_t *value;
    if (!json_is_object(object)) {
        return fail_value(place, object, "an object");
    }
    json_object_foreach((json_t *)object, key, value)
    {
        const struct field *field = find_field(fields, key);
        struct place inner = below(place, key);
        conus_status status =
            field ? field->read((char *)out + field->offset, value, &inner) : fail_unknown(&inner, fields);
        if (status) {
            return status;
        }
    }
    for (const struct field *field = fields; field->key; field++) {
        if (field->required && !json_object_get(object, field->key)) {
            return fail(CONUS_ERROR_DATA, "%s is missing", below(place, field->key).key);
        }
    }
    return CONUS_OK;
}

/* ---- Values ------------------------------------------------------------------------------------------------ */

static bool is_one_line(const char *text)
{
    while ((unsigned char)*text >= 0x20 && *text != 0x7f) {
        text++;
    }
    return !*text;
}

static conus_status read_text(void *field, const json_t *value, const struct place *place)
{
    char **out = field;
    const char *text = json_string_value(value);
    if (!text || !text[0] || !is_one_line(text)) {
        return fail_value(place, value, "a text of one line that is not empty");
    }
    *out = memory_text(text, json_string_length(value));
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status read_comment(void *field, const json_t *value, const struct place *place)
{
    (void)field;
    return json_is_string(value) ? CONUS_OK : fail_value(place, value, "a text");
}

static conus_status read_flag(void *field, const json_t *value, const struct place *place)
{
    bool *out = field;
    if (!json_is_boolean(value)) {
        return fail_value(place, value, "true or false");
    }
    *out = json_is_true(value);
    return CONUS_OK;
}

static conus_status read_positive(void *field, const json_t *value, const struct place *place)
{
    double *out = field;
    double number = json_number_value(value);
    if (!(number > 0) || !isfinite(number)) {
        return fail_value(place, value, "a number above 0");
    }
    *out = number;
    return CONUS_OK;
}

static conus_status read_version(void *field, const json_t *value, const struct place *place)
{
    (void)field;
    return json_is_integer(value) && json_integer_value(value) == MANIFEST_VERSION
               ? CONUS_OK
               : fail_value(place, value, "1, the version of this format,");
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

static conus_status read_path(void *field, const json_t *value, const struct place *place)
{
    const char *path = json_string_value(value);
    if (path && !place->allow_outside && !stays_inside(path)) {
        return fail_value(place, value, "a path inside the manifest's folder (or \"allow_outside\": true)");
    }
    return read_text(field, value, place);
}

static conus_status read_volume_number(void *field, const json_t *value, const struct place *place)
{
    struct manifest_volume *out = field;
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || number > UINT32_MAX) {
        return fail_value(place, value, "a whole number from 0");
    }
    out->chosen = true;
    out->volume = (uint32_t)number;
    return CONUS_OK;
}

static conus_status read_names(void *field, const json_t *value, const struct place *place)
{
    struct manifest_pathway *pathway = field;
    size_t count = json_array_size(value);
    if (!count) {
        return fail_value(place, value, "a list of names, one per volume,");
    }
    pathway->names = memory_zeroed(count, sizeof *pathway->names);
    pathway->name_count = pathway->names ? count : 0;
    conus_status status = pathway->names ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        struct place inner = element(place, i);
        status = read_text(&pathway->names[i], json_array_get(value, i), &inner);
    }
    return status;
}

/* ---- The schema -------------------------------------------------------------------------------------------- */

#define AT(type, member) offsetof(struct type, member)

static conus_status read_transfer_file(void *field, const json_t *value, const struct place *place)
{
    struct manifest_context *context = field;
    context->transfer_is_file = true;
    return read_path(&context->transfer, value, place);
}

static conus_status read_transfer(void *field, const json_t *value, const struct place *place)
{
    struct manifest_context *context = field;
    static const struct field keys[] = {{"file", read_transfer_file, 0, true}, {0}};
    return json_is_object(value) ? read_object(context, value, keys, place)
                                 : read_text(&context->transfer, value, place);
}

static conus_status read_parcellation(void *field, const json_t *value, const struct place *place)
{
    static const struct field keys[] = {
        {"file", read_path, AT(manifest_parcellation, source.file), true},
        {"volume", read_volume_number, AT(manifest_parcellation, source), false},
        {"labels", read_path, AT(manifest_parcellation, labels), false},
        {0},
    };
    struct manifest_parcellation *out = field;
    return json_is_string(value) ? read_path(&out->source.file, value, place) : read_object(out, value, keys, place);
}

static conus_status read_context(void *field, const json_t *value, const struct place *place)
{
    static const struct field keys[] = {
        {"file", read_path, AT(manifest_context, source.file), true},
        {"volume", read_volume_number, AT(manifest_context, source), false},
        {"transfer", read_transfer, 0, false},
        {0},
    };
    struct manifest_context *out = field;
    return json_is_string(value) ? read_path(&out->source.file, value, place) : read_object(out, value, keys, place);
}

static conus_status check_pathway(const struct manifest_pathway *pathway, const struct place *place)
{
    const char *one = pathway->name ? "name" : pathway->source.chosen ? "volume" : NULL;
    const char *many = pathway->fsl ? "fsl" : pathway->names ? "names" : NULL;
    if (pathway->fsl && pathway->names) {
        return fail(CONUS_ERROR_DATA, "%s: has fsl and names, one of them is allowed", place->key);
    }
    if (one && many) {
        return fail(CONUS_ERROR_DATA, "%s: has %s for one pathway and %s for several, one of them is allowed",
                    place->key, one, many);
    }
    return pathway->source.file || pathway->fsl ? CONUS_OK
                                                : fail(CONUS_ERROR_DATA, "%s: file or fsl is missing", place->key);
}

static conus_status read_pathway(void *field, const json_t *value, const struct place *place)
{
    static const struct field keys[] = {
        {"file", read_path, AT(manifest_pathway, source.file), false},
        {"volume", read_volume_number, AT(manifest_pathway, source), false},
        {"fsl", read_path, AT(manifest_pathway, fsl), false},
        {"name", read_text, AT(manifest_pathway, name), false},
        {"names", read_names, 0, false},
        {"threshold", read_positive, AT(manifest_pathway, threshold), false},
        {"comment", read_comment, 0, false},
        {0},
    };
    struct manifest_pathway *out = field;
    if (json_is_string(value)) {
        return read_path(&out->source.file, value, place);
    }
    conus_status status = read_object(out, value, keys, place);
    return status ? status : check_pathway(out, place);
}

/* Reads a list of `size` bytes per entry into *entries and *count. */
static conus_status read_list(void **entries, size_t *count, size_t size, const json_t *list,
                              conus_status (*read)(void *, const json_t *, const struct place *),
                              const struct place *place)
{
    size_t length = json_array_size(list);
    if (!json_is_array(list)) {
        return fail_value(place, list, "a list");
    }
    *entries = memory_zeroed(length, size);
    if (!*entries) {
        return CONUS_ERROR_MEMORY;
    }
    *count = length;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < length; i++) {
        struct place inner = element(place, i);
        status = read((char *)*entries + i * size, json_array_get(list, i), &inner);
    }
    return status;
}

static conus_status read_pathways(void *field, const json_t *value, const struct place *place)
{
    struct manifest *out = field;
    return read_list((void **)&out->pathways, &out->pathway_count, sizeof *out->pathways, value, read_pathway, place);
}

static const struct field manifest_keys[] = {
    {"conus_atlas", read_version, 0, true},
    {"comment", read_comment, 0, false},
    {"allow_outside", read_flag, AT(manifest, allow_outside), false},
    {"parcellation", read_parcellation, AT(manifest, parcellation), false},
    {"pathways", read_pathways, 0, false},
    {"threshold", read_positive, AT(manifest, threshold), false},
    {"context", read_context, AT(manifest, context), false},
    {0},
};

static conus_status check(const struct manifest *manifest)
{
    if (!manifest->parcellation.source.file && !manifest->pathway_count) {
        return fail(CONUS_ERROR_DATA, "nothing to select: parcellation or pathways is needed");
    }
    return CONUS_OK;
}

/* ---- The file ---------------------------------------------------------------------------------------------- */

static conus_status fail_syntax(const json_error_t *error)
{
    char text[JSON_ERROR_TEXT_LENGTH];
    if (json_error_code(error) == json_error_out_of_memory) {
        return fail(CONUS_ERROR_MEMORY, "no memory for the JSON text");
    }
    snprintf(text, sizeof text, "%s", error->text);
    for (char *c = text; *c; c++) {
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    }
    return fail(CONUS_ERROR_DATA, "line %d, column %d: %s", error->line, error->column, text);
}

bool manifest_is(struct text text)
{
    static const char key[] = "\"conus_atlas\"";
    struct text start = text_trim(text);
    return start.size && start.data[0] == '{' && memmem(start.data, start.size, key, sizeof key - 1);
}

conus_status manifest_parse(struct manifest *out, struct text text)
{
    json_error_t error;
    struct manifest manifest = {0};
    json_t *root = json_loadb(text.data, text.size, JSON_REJECT_DUPLICATES, &error);
    if (!root) {
        return fail_syntax(&error);
    }
    struct place place = {.allow_outside = json_is_true(json_object_get(root, "allow_outside"))};
    conus_status status = read_object(&manifest, root, manifest_keys, &place);
    status = status ? status : check(&manifest);
    json_decref(root);
    if (status) {
        manifest_finish(&manifest);
        return status;
    }
    *out = manifest;
    return CONUS_OK;
}

static void pathway_finish(struct manifest_pathway *pathway)
{
    for (size_t i = 0; i < pathway->name_count; i++) {
        memory_free(pathway->names[i]);
    }
    memory_free(pathway->names);
    memory_free(pathway->name);
    memory_free(pathway->fsl);
    memory_free(pathway->source.file);
}

void manifest_finish(struct manifest *manifest)
{
    for (size_t i = 0; i < manifest->pathway_count; i++) {
        pathway_finish(&manifest->pathways[i]);
    }
    memory_free(manifest->pathways);
    memory_free(manifest->parcellation.source.file);
    memory_free(manifest->parcellation.labels);
    memory_free(manifest->context.source.file);
    memory_free(manifest->context.transfer);
    *manifest = (struct manifest){0};
}
