/* SPDX-License-Identifier: BSD-3-Clause */
/* AFNI's label tables. They are NIML, which looks like XML: elements hold strings in quotation marks, and marks
 * inside a string are written as entities, so that the strings must be cut out before the entities are resolved.
 * In a NIfTI extension (code 4) the table is itself such a string, cut into pieces of 1000 characters. */
#include "loaders/labels/label_format.h"

#include "base/buffer.h"
#include "loaders/labels/label_cells.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct tag {
    struct text name; /* with the '/' of an end tag */
    struct text attributes;
};

/* Takes everything up to and with the next tag off `rest`. */
static bool next_tag(struct text *rest, struct tag *tag)
{
    const char *open = rest->size ? memchr(rest->data, '<', rest->size) : NULL;
    if (!open) {
        return false;
    }
    struct text inner = {open + 1, rest->size - (size_t)(open - rest->data) - 1};
    size_t length = 0;
    for (char quote = 0; length < inner.size && (quote || inner.data[length] != '>'); length++) {
        char c = inner.data[length];
        quote = quote ? (c == quote ? 0 : quote) : c == '"' || c == '\'' ? c : 0;
    }
    if (length == inner.size) {
        return false;
    }
    *rest = (struct text){inner.data + length + 1, inner.size - length - 1};
    tag->attributes = (struct text){inner.data, length};
    if (length && inner.data[length - 1] == '/') {
        tag->attributes.size--;
    }
    text_word(&tag->attributes, &tag->name);
    return true;
}

/* Takes the next string before the next tag off `rest`, in quotation marks or else a word, its entities unresolved. */
static bool next_string(struct text *rest, struct text *string)
{
    struct text inner = text_trim(*rest);
    if (!inner.size || inner.data[0] == '<') {
        return false;
    }
    bool quoted = inner.data[0] == '"' || inner.data[0] == '\'';
    size_t start = quoted;
    size_t end = start;
    while (end < inner.size &&
           (quoted ? inner.data[end] != inner.data[0] : !memchr(" \t\r\n\v\f<", inner.data[end], 7))) {
        end++;
    }
    if (quoted && end == inner.size) {
        return false;
    }
    *string = (struct text){inner.data + start, end - start};
    end += quoted;
    *rest = (struct text){inner.data + end, inner.size - end};
    return true;
}

/* Value of attribute `name`: a string, or a word without marks. Empty if absent. */
static struct text find_attribute(const struct tag *tag, const char *name)
{
    struct text rest = tag->attributes;
    while (rest.size) {
        const char *equals = memchr(rest.data, '=', rest.size);
        if (!equals) {
            break;
        }
        struct text key = text_trim((struct text){rest.data, (size_t)(equals - rest.data)});
        rest = text_trim((struct text){equals + 1, rest.size - (size_t)(equals - rest.data) - 1});
        struct text value = {0};
        bool quoted = rest.size && (rest.data[0] == '"' || rest.data[0] == '\'');
        if (quoted ? !next_string(&rest, &value) : !text_word(&rest, &value)) {
            break;
        }
        if (text_equal(key, name)) {
            return value;
        }
    }
    return (struct text){0};
}

/* The character that the entity at the start of `text` ("&lt;", "&#x22;", "&#34;") means; *length = 0 if it is none. */
static char read_entity(struct text text, size_t *length)
{
    static const struct {
        const char *name;
        char character;
    } known[] = {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}};
    *length = 0;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (text_starts(text, known[i].name)) {
            *length = strlen(known[i].name);
            return known[i].character;
        }
    }
    const char *end = text_starts(text, "&#") ? memchr(text.data, ';', text.size) : NULL;
    char digits[8] = {0};
    if (!end || end - text.data > (ptrdiff_t)sizeof digits) {
        return 0;
    }
    memcpy(digits, text.data + 2, (size_t)(end - text.data) - 2);
    char *rest = digits;
    long code = digits[0] == 'x' ? strtol(digits + 1, &rest, 16) : strtol(digits, &rest, 10);
    *length = !*rest && code > 0 && code < 256 ? (size_t)(end - text.data) + 1 : 0;
    return (char)code;
}

static void append_resolved(struct buffer *buffer, struct text string)
{
    while (string.size) {
        size_t length;
        char c = read_entity(string, &length);
        buffer_append(buffer, length ? &c : string.data, 1);
        length = length ? length : 1;
        string = (struct text){string.data + length, string.size - length};
    }
}

static conus_status set_resolved(char **field, struct text string)
{
    struct buffer buffer = {0};
    append_resolved(&buffer, string);
    conus_status status = buffer_status(&buffer);
    status = status || !buffer.size ? status : label_set_text(field, (struct text){buffer.data, buffer.size});
    buffer_finish(&buffer);
    return status;
}

/* <VALUE_LABEL_DTABLE ni_type="2*String" ni_dimen="N"> "1" "Left-..." ... : pairs in no order. */
static conus_status parse_dtable(struct label_table *out, struct text *rest, const struct tag *tag, struct notes *notes)
{
    struct text number;
    struct text name;
    size_t entries = 0;
    conus_status status = CONUS_OK;
    for (; !status && next_string(rest, &number); entries++) {
        char where[32];
        struct label label = {0};
        snprintf(where, sizeof where, "entry %zu", entries + 1);
        if (!next_string(rest, &name)) {
            return fail(CONUS_ERROR_DATA, "%s: no name after the number", where);
        }
        status = label_cell_number(&label.number, text_trim(number), where);
        status = status ? status : set_resolved(&label.name, name);
        status = label_keep(out, &label, status, notes);
    }
    uint64_t wanted;
    if (!status && text_to_uint(find_attribute(tag, "ni_dimen"), UINT32_MAX, &wanted) && wanted != entries) {
        status = notes_warn(notes, "the AFNI label table has %zu entries, though its ni_dimen says %llu", entries,
                            (unsigned long long)wanted); /* people write these by hand */
    }
    return status;
}

/* <ATLAS_POINT STRUCT="R_CA1" VAL="17" LONGNAME="..." ... />. */
static conus_status parse_point(struct label_table *out, const struct tag *tag, struct notes *notes)
{
    struct label label = {0};
    struct text name = find_attribute(tag, "STRUCT");
    struct text longer = find_attribute(tag, "LONGNAME");
    bool has_longer = longer.size && !text_equal(longer, "None");
    conus_status status = label_cell_number(&label.number, text_trim(find_attribute(tag, "VAL")), "ATLAS_POINT");
    status = status ? status : set_resolved(&label.name, has_longer ? longer : name);
    if (!status && has_longer) {
        status = set_resolved(&label.abbreviation, name);
    }
    return label_keep(out, &label, status, notes);
}

/* Reads the tables themselves: in an element of their own, or one after the other. */
static conus_status parse_tables(struct label_table *out, struct text text, struct notes *notes)
{
    struct tag tag;
    conus_status status = CONUS_OK;
    while (!status && next_tag(&text, &tag)) {
        if (text_equal(tag.name, "VALUE_LABEL_DTABLE")) {
            status = parse_dtable(out, &text, &tag, notes);
        } else if (text_equal(tag.name, "ATLAS_POINT")) {
            status = parse_point(out, &tag, notes);
        }
    }
    return status;
}

/* Joins the pieces of the attribute `name` of an AFNI_attributes group; empty if it is not there. */
static conus_status join_attribute(struct buffer *joined, struct text text, const char *name)
{
    struct tag tag;
    while (next_tag(&text, &tag)) {
        struct text key = find_attribute(&tag, "atr_name");
        key = key.size ? key : find_attribute(&tag, "AFNI_name");
        struct text piece;
        while (text_equal(tag.name, "AFNI_atr") && text_equal(key, name) && next_string(&text, &piece)) {
            append_resolved(joined, piece);
        }
    }
    return buffer_status(joined);
}

/* The atlas table is the richer one where both are there. */
static conus_status parse_afni(struct label_table *out, struct text text, struct notes *notes)
{
    static const char *const attributes[] = {"ATLAS_LABEL_TABLE", "VALUE_LABEL_DTABLE"};
    conus_status status = parse_tables(out, text, notes);
    for (size_t i = 0; !status && !out->count && i < 2; i++) {
        struct buffer joined = {0};
        status = join_attribute(&joined, text, attributes[i]);
        if (!status && joined.size) {
            status = parse_tables(out, (struct text){joined.data, joined.size}, notes);
        }
        buffer_finish(&joined);
    }
    return status;
}

const struct label_format label_format_afni = {"AFNI label table", parse_afni, NULL};
