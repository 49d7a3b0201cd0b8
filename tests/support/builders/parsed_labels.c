/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a literal and prints the table. */
#include "builders/parsed_labels.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

conus_status parsed_from_bytes(struct parsed *out, const struct bytes *bytes, const struct label_use *use)
{
    struct job job = {0};
    struct label_table *table = labels_new(&job);
    const char *format = NULL;
    label_bytes_parse(&job, table, &format, bytes->data, bytes->size, use);
    struct label_table parsed = *table;
    *table = (struct label_table){0};
    conus_status status = job_close(&job, &out->notes, NULL);
    if (status) {
        label_table_finish(&parsed);
        return status;
    }
    out->table = parsed;
    out->format = format;
    return CONUS_OK;
}

conus_status parsed_from(struct parsed *out, const char *text)
{
    static const struct label_use use;
    *out = (struct parsed){0};
    return parsed_from_bytes(out, &(const struct bytes){(uint8_t *)text, strlen(text)}, &use);
}

void parsed_finish(struct parsed *parsed)
{
    label_table_finish(&parsed->table);
    notes_finish(&parsed->notes);
}

bool notes_have(const struct notes *notes, const char *part)
{
    for (size_t i = 0; i < notes->count; i++) {
        if (strstr(notes->lines[i], part)) {
            return true;
        }
    }
    return false;
}

const char *parsed_text(const struct label_table *table)
{
    static char text[4096];
    struct buffer buffer = {0};
    for (size_t i = 0; i < table->count; i++) {
        const struct label *l = &table->entries[i];
        buffer_format(&buffer, "%s%u %s", i ? "; " : "", l->number, l->name ? l->name : "-");
        if (l->abbreviation) {
            buffer_format(&buffer, " (%s)", l->abbreviation);
        }
        if (l->has_rgb) {
            buffer_format(&buffer, " #%02x%02x%02x", l->rgb[0], l->rgb[1], l->rgb[2]);
        }
        if (l->hemisphere) {
            buffer_format(&buffer, " %c", l->hemisphere);
        }
        if (l->has_parent) {
            buffer_format(&buffer, " <%u", l->parent);
        }
    }
    snprintf(text, sizeof text, "%s", buffer.data ? buffer.data : "");
    buffer_finish(&buffer);
    return text;
}

void assert_refused(const char *text, const char *message)
{
    struct parsed parsed;
    assert_fails(parsed_from(&parsed, text), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), message)) {
        fail_msg("\"%s\" is not in \"%s\"", message, conus_message());
    }
    parsed_finish(&parsed);
}

static void read_or_refuse(const char *text, size_t size)
{
    uint8_t *exact = malloc(size ? size : 1); /* so that a sanitizer notices one byte too many */
    assert_non_null(exact);
    memcpy(exact, text, size);
    struct parsed parsed = {0};
    static const struct label_use use;
    conus_status status = parsed_from_bytes(&parsed, &(const struct bytes){exact, size}, &use);
    if (status) {
        assert_fails(status, CONUS_ERROR_DATA);
        assert_null(parsed.format);
        assert_int_equal(parsed.table.count, 0);
    }
    free(exact);
    parsed_finish(&parsed);
}

static conus_status parse_sample(void *data)
{
    struct parsed parsed;
    conus_status status = parsed_from(&parsed, data);
    parsed_finish(&parsed);
    return status;
}

static void assert_sample(const struct sample *sample)
{
    struct parsed parsed;
    assert_ok(parsed_from(&parsed, sample->text));
    assert_string_equal(parsed.format, sample->format);
    assert_string_equal(parsed_text(&parsed.table), sample->table);
    parsed_finish(&parsed);
}

void assert_samples(const struct sample *samples, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        assert_sample(&samples[i]);
        for (size_t size = 0; size < strlen(samples[i].text); size++) {
            read_or_refuse(samples[i].text, size);
        }
        test_every_allocation(parse_sample, (void *)samples[i].text);
        test_every_primitive(parse_sample, (void *)samples[i].text);
    }
}
