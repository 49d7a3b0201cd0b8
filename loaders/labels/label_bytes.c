/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats, and which one bytes are, by their content. */
#include "loaders/labels/label_format.h"

#include "base/formats/xml.h"

#include <stdio.h>
#include <string.h>

enum { PALETTE_SIZE = 768 };

/* A palette gives a number to each of its colours; those that come with atlases leave the entries they do not use
 * black. */
static void parse_palette(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    const uint8_t *red = (const uint8_t *)text.data;
    (void)use;
    for (uint32_t number = 1; number < 256; number++) {
        struct label *label = labels_add(job, out, number);
        for (size_t channel = 0; channel < 3; channel++) {
            label->rgb[channel] = red[256 * channel + number];
            label->has_rgb = label->has_rgb || label->rgb[channel];
        }
    }
}

#define ROWS(...)                                                                                                      \
    .kind = LABEL_ROWS, .rows = &(const struct label_rows)                                                             \
    {                                                                                                                  \
        __VA_ARGS__                                                                                                    \
    }

/* The first that knows a text is its own; files beside a volume are tried in the order of their endings here. */
static const struct label_format formats[] = {
    /* A line with the name, a line "KEY R G B A". */
    {"Workbench label list", ROWS(.shape = SHAPE_PAIRS, .everywhere = true, .lead = 4, .name_above = true)},
    /* "HIPL Hippocampus_L 4101", "Hippocampus_L 4101". */
    {"AAL text", ROWS(.shape = SHAPE_NUMBER_LAST, .everywhere = true, .number_last = true), .endings = ".nii.txt/.txt"},
    /* "1 0.5 0.25 0": text behind the colour is no name. */
    {"FSLeyes colours", ROWS(.shape = SHAPE_UNNAMED, .everywhere = true, .lead = 3, .fractions = true, .unnamed = true),
     .is_colours = true},
    {"BIDS label table", LABEL_COLUMNS, .separator = '\t', .parse = label_parse_table, .endings = ".tsv"},
    {"OME image-label", LABEL_JSON, .begins = "{", .mentions = "\"image-label\"/\"label-value\"",
     .parse = label_parse_ome, .endings = ".json"},
    {"BrainGlobe structures", LABEL_JSON, .mentions = "\"id\"", .is = label_is_structures,
     .parse = label_parse_structures},
    {"nnU-Net dataset.json", LABEL_JSON, .begins = "{", .is = label_is_data_set, .parse = label_parse_data_set},
    {"neuroglancer segment properties", LABEL_JSON, .begins = "{", .mentions = "\"neuroglancer_segment_properties\"",
     .parse = label_parse_segments},
    {"NiiVue labels", LABEL_JSON, .begins = "{", .mentions = "\"labels\"/\"R\"", .parse = label_parse_lists},
    {"JSON map of names", LABEL_JSON, .begins = "{", .is = label_is_map, .parse = label_parse_map},
    {"JSON list of labels", LABEL_JSON, .is = label_is_objects, .parse = label_parse_objects},
    /* `1 220 216 20 1.00 1 1 "Left hippocampus"`. */
    {"ITK-SNAP labels", ROWS(.shape = SHAPE_ITK_SNAP, .lead = 6, .quoted = true), .endings = ".label"},
    /* "1 L.HIPP Left-Hippocampus 220 216 20 255"; but where the second words repeat, they are a part of the name. */
    {"MRtrix or FreeSurfer colour table",
     ROWS(.shape = SHAPE_MRTRIX, .everywhere = true, .colours_last = true, .two_names = true)},
    /* "1 Left_hippocampus 220 216 20 255". */
    {"Slicer colour table",
     ROWS(.shape = SHAPE_COLOURED, .says = "Color table file", .colours_last = true, .underscores = true),
     .endings = ".ctbl"},
    /* "1 Left-Hippocampus 220 216 20 0". */
    {"FreeSurfer colour table", ROWS(.shape = SHAPE_COLOURED, .colours_last = true)},
    {"AFNI label table", LABEL_MARKUP, .roots = "AFNI_attributes/AFNI_atr/VALUE_LABEL_DTABLE/ATLAS_LABEL_TABLE",
     .parse = label_parse_afni, .endings = ".niml.lt"},
    {"Slicer colour table", LABEL_COLUMNS, .header = "LabelValue", .parse = label_parse_table},
    {"CSV label table", LABEL_COLUMNS, .parse = label_parse_table, .endings = ".csv"},
    {"CSV without a header", LABEL_BARE, .parse = label_parse_bare},
    /* "1 0.5 0.25 0 Frontal Pole". */
    {"FSLeyes colour table", ROWS(.shape = SHAPE_FSLEYES, .lead = 3, .fractions = true)},
    /* "1 Precentral_L", "1<tab>Frontal Pole", "1 Precentral_L 2001". */
    {"MRIcron text", ROWS(.shape = SHAPE_NAMED, .is_plain = true)},
    {"SPM atlas XML", LABEL_MARKUP, .roots = "atlas", .mentions = "<index>", .parse = label_parse_fsl},
    {"FSL atlas XML", LABEL_MARKUP, .roots = "atlas", .parse = label_parse_fsl},
    {"Workbench label table", LABEL_MARKUP, .roots = "CaretExtension/CaretVolumeExtension/LabelTable",
     .parse = label_parse_workbench},
    {"label table", LABEL_CHOSEN, .parse = label_parse_table},
    {"list of names", LABEL_LINES, .parse = label_parse_lines},
    {"MRIcron colours", LABEL_PALETTE, .is_colours = true, .parse = parse_palette, .endings = ".nii.lut/.lut"},
};
enum { FORMATS = sizeof formats / sizeof formats[0] };

static const char *list_formats(struct job *job)
{
    const char *list = "";
    for (size_t i = 0; i < FORMATS; i++) {
        const char *name = formats[i].name;
        if (formats[i].kind != LABEL_CHOSEN && !(list[0] && strstr(list, name))) {
            list = job_format(job, "%s%s%s", list, list[0] ? ", " : "", name);
        }
    }
    return list;
}

const char *label_endings(struct job *job, bool only_colours)
{
    const char *list = "";
    for (size_t i = 0; i < FORMATS; i++) {
        const char *endings = formats[i].is_colours || !only_colours ? formats[i].endings : NULL;
        list = endings ? job_format(job, "%s%s%s", list, list[0] ? "/" : "", endings) : list;
    }
    return list;
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

static bool mentions_all(struct text text, const char *words)
{
    char word[64];
    bool all = true;
    struct text one;
    struct text rest = text_from(words);
    for (bool more = true; all && text_field(&rest, '/', &more, &one);) {
        snprintf(word, sizeof word, "%.*s", TEXT_SHOW(one, 63));
        all = text_mentions(text, word);
    }
    return all;
}

static bool is_format(const struct label_format *row, const struct label_text *text)
{
    return row->kind == text->kind && (!row->begins || strchr(row->begins, text->text.data[0])) &&
           (!row->roots || text_is_one_of(text->root, row->roots, true)) &&
           (!row->mentions || mentions_all(text->text, row->mentions)) &&
           (!row->header || text_mentions(text->header, row->header)) &&
           (!row->separator || row->separator == text->separator) && (!row->is || row->is(text)) &&
           (!row->rows || label_rows_are(text, row->rows));
}

static const struct label_format *find_format(const struct label_text *text)
{
    size_t i = 0;
    while (i < FORMATS && !is_format(&formats[i], text)) {
        i++;
    }
    return i < FORMATS ? &formats[i] : NULL;
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
        label_columns_look(&about);
    }
    if (about.kind == LABEL_ROWS) {
        census = label_rows_count(text);
        about.census = &census;
    }
    return find_format(&about);
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
        lines = !(name.data[0] >= '0' && name.data[0] <= '9') && !text_has_only(name, "{}[]()<>,;:=+-*/#_. ");
    }
    return lines ? count : 0;
}

void label_parse_lines(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
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

static bool is_palette(const struct bytes *file)
{
    const struct text all = {(const char *)file->data, file->size};
    return all.size == PALETTE_SIZE && !(text_is_readable(all) && (text_is_utf8(all) || label_format_of(all)));
}

const struct label_format *label_format_for(struct text *text, const struct bytes *file, const struct label_use *use)
{
    const bool is_chosen = use->columns[0].size || use->columns[1].size;
    const struct text all = {(const char *)file->data, file->size};
    const struct label_text about = {.kind = is_palette(file) ? LABEL_PALETTE
                                             : is_chosen      ? LABEL_CHOSEN
                                                              : LABEL_LINES,
                                     .text = all};
    *text = about.kind == LABEL_PALETTE ? all : text_from_bytes(file->data, file->size);
    if (about.kind != LABEL_LINES) {
        return find_format(&about);
    }
    const struct label_format *format = label_format_of(*text);
    return format || !are_names_of(*text, use->voxels) ? format : find_format(&about);
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
    if (format->kind != LABEL_PALETTE) {
        labels_decode(job, &text);
    }
    if (job_ok(job) && format->rows) {
        label_rows_parse(job, table, text, format->rows);
    } else if (job_ok(job)) {
        format->parse(job, table, text, use);
    }
    labels_sort(job, table);
    job_out(job, place);
    labels_move(job, out, table);
}

void label_bytes_parse(struct job *job, struct label_table *out, const char **format, const struct bytes *file,
                       const struct label_use *use)
{
    struct text text;
    struct label_table *table = labels_new(job);
    const struct label_format *found = label_format_for(&text, file, use);
    if (!(found && found->kind == LABEL_PALETTE) && (text_starts(text, "\xff\xfe") || text_starts(text, "\xfe\xff"))) {
        job_bad(job, "the text is UTF-16, UTF-8 or Windows-1252 is needed");
    } else if (!found) {
        label_columns_refuse(job, text);
        job_bad(job, "not a label table of a known format (known: %s)", list_formats(job));
    }
    if (!job_ok(job)) {
        return;
    }
    label_text_parse(job, table, found, text, use);
    label_check_zero(job, table, found->kind == LABEL_CHOSEN ? NULL : use->voxels);
    if (job_ok(job) && !table->count) {
        job_bad(job, "%s: no label but 0", found->name);
    }
    if (job_ok(job)) {
        *format = found->name;
    }
    labels_move(job, out, table);
}
