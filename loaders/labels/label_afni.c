/* SPDX-License-Identifier: BSD-3-Clause */
/* AFNI's label tables. They are NIML, which looks like XML: elements hold strings in quotation marks, and marks
 * inside a string are written as entities, so that the strings must be cut out before the entities are resolved.
 * In a NIfTI extension (code 4) the table is itself such a string, cut into pieces of 1000 characters. */
#include "loaders/labels/label_format.h"

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

/* The string with its entities resolved, which make it no longer. */
static struct text resolve(struct job *job, struct text string)
{
    struct text text = {job_copy(job, string), 0};
    for (char *to = (char *)text.data; job_ok(job) && string.size; text.size++) {
        size_t length;
        char c = read_entity(string, &length);
        to[text.size] = length ? c : string.data[0];
        length = length ? length : 1;
        string = (struct text){string.data + length, string.size - length};
    }
    return text;
}

/* <VALUE_LABEL_DTABLE ni_type="2*String" ni_dimen="N"> "1" "Left-..." ... : pairs in no order. */
static void parse_dtable(struct job *job, struct label_table *out, struct text *rest, const struct tag *tag)
{
    struct text number;
    struct text name;
    size_t entries = 0;
    for (; job_ok(job) && next_string(rest, &number); entries++) {
        size_t place = job_in(job, "entry ", entries + 1);
        if (!next_string(rest, &name)) {
            job_bad(job, "no name after the number");
            return;
        }
        const struct label_row row = {.label = {.number = label_cell_number(job, text_trim(number))},
                                      .name = resolve(job, name)};
        job_out(job, place);
        labels_keep(job, out, &row);
    }
    uint64_t wanted;
    if (text_to_uint(find_attribute(tag, "ni_dimen"), UINT32_MAX, &wanted) && wanted != entries) {
        job_note(job, "the AFNI label table has %zu entries, though its ni_dimen says %llu", entries,
                 (unsigned long long)wanted); /* people write these by hand */
    }
}

/* <ATLAS_POINT STRUCT="R_CA1" VAL="17" LONGNAME="..." ... />. */
static void parse_point(struct job *job, struct label_table *out, const struct tag *tag)
{
    struct text name = resolve(job, find_attribute(tag, "STRUCT"));
    struct text longer = find_attribute(tag, "LONGNAME");
    bool has_longer = longer.size && !text_equal(longer, "None");
    size_t place = job_in(job, "ATLAS_POINT", JOB_ALONE);
    struct label_row row = {.label = {.number = label_cell_number(job, text_trim(find_attribute(tag, "VAL")))}};
    job_out(job, place);
    row.name = has_longer ? resolve(job, longer) : name;
    row.abbreviation = has_longer ? name : row.abbreviation;
    labels_keep(job, out, &row);
}

/* Reads the tables themselves: in an element of their own, or one after the other. */
static void parse_tables(struct job *job, struct label_table *out, struct text text)
{
    static const char known[] = "AFNI_attributes/AFNI_atr/ATLAS_LABEL_TABLE/?xml/!--";
    struct tag tag;
    bool is_strange = false;
    while (job_ok(job) && next_tag(&text, &tag)) {
        if (text_equal(tag.name, "VALUE_LABEL_DTABLE")) {
            parse_dtable(job, out, &text, &tag);
        } else if (text_equal(tag.name, "ATLAS_POINT")) {
            parse_point(job, out, &tag);
        } else if (!is_strange && !text_starts(tag.name, "/") && !text_is_one_of(tag.name, known, true)) {
            is_strange = true;
            job_note(job, "label table: <%.*s> is not known, and was passed over", TEXT_SHOW(tag.name, 40));
        }
    }
}

/* Joins the pieces of the attribute `name` of an AFNI_attributes group; empty if it is not there. */
static struct text join_attribute(struct job *job, struct text text, const char *name)
{
    char *joined = job_raw(job, text.size, 1); /* pieces are shorter than the text */
    size_t size = 0;
    struct tag tag;
    while (joined && next_tag(&text, &tag)) {
        struct text key = find_attribute(&tag, "atr_name");
        key = key.size ? key : find_attribute(&tag, "AFNI_name");
        struct text piece;
        while (text_equal(tag.name, "AFNI_atr") && text_equal(key, name) && next_string(&text, &piece)) {
            piece = resolve(job, piece);
            memcpy(joined + size, piece.data, piece.size);
            size += piece.size;
        }
    }
    return (struct text){joined, size};
}

/* The atlas table is the richer one where both are there. */
void label_parse_afni(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    static const char *const attributes[] = {"ATLAS_LABEL_TABLE", "VALUE_LABEL_DTABLE"};
    (void)use;
    parse_tables(job, out, text);
    for (size_t i = 0; !out->count && i < 2; i++) {
        parse_tables(job, out, join_attribute(job, text, attributes[i]));
    }
}
