/* SPDX-License-Identifier: BSD-3-Clause */
/* Which format, by content; and MRIcron's colours, the one format that is not text. */
#include "loaders/labels/label_format.h"

#include "base/formats/encoding.h"
#include "base/memory.h"

#include <string.h>

#define KNOWN                                                                                                          \
    "MRIcron text, AAL text, ITK-SNAP, FreeSurfer, FSLeyes, MRtrix and Slicer colour tables, BIDS dseg.tsv and other " \
    "tables with a header, atlas XML of FSL and SPM, Workbench and AFNI label tables, BrainGlobe structures.json, "    \
    "NiiVue JSON, MRIcron .lut"

bool label_is_lut(const uint8_t *data, size_t size)
{
    struct text all = {(const char *)data, size};
    return size == LABEL_LUT_SIZE && !(text_is_readable(all) && (text_is_utf8(all) || label_format_of(all)));
}

/* The palettes that come with atlases leave the entries they do not use black. */
void label_lut_apply(struct label_table *table, const uint8_t *lut)
{
    for (size_t i = 0; i < table->count; i++) {
        struct label *label = &table->entries[i];
        const uint8_t *red = lut + label->number % 256;
        if (label->number < 256 && (red[0] || red[256] || red[512])) {
            for (size_t channel = 0; channel < 3; channel++) {
                label->rgb[channel] = red[256 * channel];
            }
            label->has_rgb = true;
        }
    }
}

const struct label_format *label_format_of(struct text text)
{
    /* An answer of conus, or its list of voxels, may lie beside the atlas under its name, and has rows like a table. So
     * have FreeSurfer's lists of vertices and FSL's matrices. */
    static const char *const others[] = {"query\tkind\tindex\t", "query\tpathway\ti\t", "#!ascii label", "/NumWaves",
                                         "/ContrastName"};
    struct text start = text_trim(text);
    bool is_other = !text_is_readable(text);
    for (size_t i = 0; !is_other && i < sizeof others / sizeof others[0]; i++) {
        is_other = text_starts(text, others[i]);
    }
    if (is_other) {
        return NULL;
    }
    if (start.data[0] == '<') {
        return label_format_of_markup(start);
    }
    if (start.data[0] == '{' || start.data[0] == '[') {
        return label_format_of_json(start);
    }
    const struct label_format *format = label_format_of_columns(text);
    return format ? format : label_format_of_rows(text);
}

conus_status label_text_parse(struct label_table *out, const struct label_format *format, struct text text,
                              const struct label_use *use, struct notes *notes)
{
    struct label_table table = {0};
    char *owned = NULL;
    conus_status status = encoding_decode(&owned, &text, notes);
    if (status) {
        return fail_in(status, format->name);
    }
    status = format->parse_for ? format->parse_for(&table, text, use, notes) : format->parse(&table, text, notes);
    memory_free(owned);
    status = status ? status : label_table_sort(&table, notes);
    if (status) {
        label_table_finish(&table);
        return fail_in(status, format->name);
    }
    *out = table;
    return CONUS_OK;
}

conus_status label_bytes_parse(struct label_table *out, const char **format, const uint8_t *data, size_t size,
                               const struct label_use *use, struct notes *notes)
{
    struct text text = text_from_bytes(data, size);
    struct label_table table = {0};
    conus_status status;
    if (label_is_lut(data, size)) {
        for (uint32_t number = 1; number < 256; number++) {
            if (!label_table_add(&table, number)) {
                label_table_finish(&table);
                return CONUS_ERROR_MEMORY;
            }
        }
        label_lut_apply(&table, data);
        *out = table;
        *format = "MRIcron colours";
        return CONUS_OK;
    }
    if (size >= 2 && (memcmp(data, "\xff\xfe", 2) == 0 || memcmp(data, "\xfe\xff", 2) == 0)) {
        return fail(CONUS_ERROR_DATA, "the text is UTF-16, UTF-8 or Windows-1252 is needed");
    }
    const bool chosen = use->columns[0].size || use->columns[1].size;
    const struct label_format *found = chosen ? &label_format_chosen : label_format_of(text);
    if (!found) {
        status = label_columns_refuse(text);
        return status ? status : fail(CONUS_ERROR_DATA, "not a label table of a known format (known: " KNOWN ")");
    }
    status = label_text_parse(&table, found, text, use, notes);
    if (!status && !table.count) {
        label_table_finish(&table);
        return fail(CONUS_ERROR_DATA, "%s: no label but 0", found->name);
    }
    if (!status) {
        *format = found->name;
        *out = table;
    }
    return status;
}
