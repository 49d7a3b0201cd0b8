/* SPDX-License-Identifier: BSD-3-Clause */
/* Which format, by content; and MRIcron's colours, the one format that is not text. */
#include "loaders/labels/label_format.h"

#include "base/formats/xml.h"
#include "loaders/labels/label_cells.h"
#include "loaders/labels/label_rows.h"

#include <string.h>

#define KNOWN                                                                                                          \
    "MRIcron text, AAL text, ITK-SNAP, FreeSurfer, FSLeyes, MRtrix and Slicer colour tables, BIDS dseg.tsv and other " \
    "tables with a header, atlas XML of FSL and SPM, Workbench and AFNI label tables, BrainGlobe structures.json, "    \
    "NiiVue JSON, nnU-Net dataset.json, neuroglancer segment properties, MRIcron .lut"

#define ADDRESS(format) &(format),
static const struct label_format *const formats[] = {LABEL_FORMATS(ADDRESS) NULL};
#undef ADDRESS

const char *label_endings(struct job *job)
{
    const char *list = "";
    for (const struct label_format *const *format = formats; *format; format++) {
        if ((*format)->endings) {
            list = job_format(job, "%s%s%s", list, list[0] ? "/" : "", (*format)->endings);
        }
    }
    return list;
}

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

/* Whether the text is something else whose rows are like those of a table: an answer of conus, or its list of voxels,
 * which may lie beside the atlas under its name, FreeSurfer's lists of vertices, FSL's matrices. */
static bool is_foreign(struct text text)
{
    static const char *const starts[] = {"query\tkind\tindex\t", "query\tpathway\ti\t", "#!ascii label", "/NumWaves",
                                         "/ContrastName"};
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        if (text_starts(text, starts[i])) {
            return true;
        }
    }
    return false;
}

static bool is_format(const struct label_format *format, const struct label_text *text)
{
    return format->kind == text->kind && (format->rows ? label_rows_are(text, format->rows) : format->is(text));
}

const struct label_format *label_format_of(struct text text)
{
    struct label_census census;
    struct label_text about = {.text = text_trim(text)};
    if (!text_is_readable(text) || is_foreign(text) || !about.text.size) {
        return NULL;
    }
    if (about.text.data[0] == '<') {
        about.kind = LABEL_MARKUP;
        about.root = xml_root(about.text);
    } else if (about.text.data[0] == '{' || about.text.data[0] == '[') {
        about.kind = LABEL_JSON;
    } else {
        about.text = text;
        about.kind = label_columns_look(&about) ? LABEL_COLUMNS : LABEL_ROWS;
    }
    if (about.kind == LABEL_ROWS) {
        census = label_rows_count(text);
        about.census = &census;
    }
    const struct label_format *const *format = formats;
    while (*format && !is_format(*format, &about)) {
        format++;
    }
    return *format;
}

static bool next_name(struct text *rest, struct text *name)
{
    struct text line;
    while (text_line(rest, &line)) {
        *name = text_trim(line);
        if (name->size && name->data[0] != '#') {
            return true;
        }
    }
    return false;
}

size_t label_lines_count(struct text text)
{
    bool lines = text.size && text_is_readable(text) && !strchr("<{[|", text.data[0]);
    size_t count = 0;
    for (struct text name; lines && next_name(&text, &name); count++) {
        lines = !(name.data[0] >= '0' && name.data[0] <= '9');
    }
    return lines ? count : 0;
}

void label_lines_parse(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    for (struct text name; job_ok(job) && next_name(&text, &name);) {
        struct label *label = labels_add(job, out, (uint32_t)out->count + 1);
        labels_set(job, &label->name, name);
    }
}

/* Whether the lines are the names of the labels 1, 2, 3, ..., each of which has a voxel; lines of columns are not. */
static bool are_names_of(struct text text, const struct label_voxels *voxels)
{
    size_t count = voxels && voxels->label_count ? voxels->label_count - 1 : 0; /* the first is 0 */
    bool all = count > 1 && label_lines_count(text) == count && !text_mentions(text, "\t") && !is_foreign(text);
    for (size_t i = 1; all && i <= count; i++) {
        all = voxels->labels[i] <= count;
    }
    size_t commas = 0;
    for (struct text name; all && next_name(&text, &name);) {
        commas += text_mentions(name, ",") || text_mentions(name, ";");
    }
    return all && commas < count;
}

static const struct label_format label_format_lines = {.name = "list of names", .parse = label_lines_parse};

const struct label_format *label_format_for(struct text text, const struct label_use *use)
{
    const struct label_format *format = label_format_of(text);
    return format || !are_names_of(text, use->voxels) ? format : &label_format_lines;
}

void label_check_zero(struct job *job, const struct label_table *table, const struct label_voxels *voxels)
{
    const char *zero = table->zero;
    uint32_t unnamed = 0;
    bool would = job_ok(job) && zero && table->count && !label_is_background(text_from(zero)) && voxels &&
                 voxels->label_count > 1;
    for (size_t i = 1; would && i < voxels->label_count; i++) { /* the first is 0 */
        const uint32_t number = voxels->labels[i];
        const struct label *own = label_table_find(table, number);
        const struct label *before = number > 1 ? label_table_find(table, number - 1) : NULL;
        unnamed = own && own->name ? unnamed : number;
        would = number == 1 || (before && before->name);
    }
    if (would && unnamed) {
        const struct label *first = label_table_find(table, 1);
        job_bad(job,
                "0 is called \"%s\", and label %u of the volume has no name: is label 1 \"%s\", or \"%s\", because the "
                "table counts from 0? Leave out the row of 0, or add 1 to all numbers",
                zero, unnamed, first && first->name ? first->name : "1", zero);
    }
}

void label_text_parse(struct job *job, struct label_table *out, const struct label_format *format, struct text text,
                      const struct label_use *use)
{
    struct label_table *table = labels_new(job);
    size_t place = job_in(job, format->name, JOB_ALONE);
    labels_decode(job, &text);
    if (job_ok(job) && format->rows) {
        label_rows_parse(job, table, text, format->rows);
    } else if (job_ok(job)) {
        format->parse(job, table, text, use);
    }
    labels_sort(job, table);
    job_out(job, place);
    labels_move(job, out, table);
}

/* The format of @p text for @p use; NULL, and a failure that says what is needed, if it is none. */
static const struct label_format *find_format(struct job *job, struct text text, const struct label_use *use)
{
    if (text_starts(text, "\xff\xfe") || text_starts(text, "\xfe\xff")) {
        job_bad(job, "the text is UTF-16, UTF-8 or Windows-1252 is needed");
        return NULL;
    }
    const struct label_format *format =
        use->columns[0].size || use->columns[1].size ? &label_format_chosen : label_format_for(text, use);
    if (!format) {
        label_columns_refuse(job, text);
        job_bad(job, "not a label table of a known format (known: " KNOWN ")");
    }
    return format;
}

void label_bytes_parse(struct job *job, struct label_table *out, const char **format, const uint8_t *data, size_t size,
                       const struct label_use *use)
{
    struct label_table *table = labels_new(job);
    const bool is_lut = label_is_lut(data, size);
    const struct text text = text_from_bytes(data, size);
    const struct label_format *found = is_lut ? NULL : find_format(job, text, use);
    for (uint32_t number = 1; is_lut && number < 256; number++) {
        labels_add(job, table, number);
    }
    if (is_lut) {
        label_lut_apply(table, data);
    } else if (found) {
        label_text_parse(job, table, found, text, use);
        label_check_zero(job, table, found == &label_format_chosen || found->kind == LABEL_MARKUP ? NULL : use->voxels);
    }
    if (job_ok(job) && !table->count) {
        job_bad(job, "%s: no label but 0", found->name);
    }
    if (job_ok(job)) {
        *format = is_lut ? "MRIcron colours" : found->name;
    }
    labels_move(job, out, table);
}
