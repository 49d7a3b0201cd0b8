/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables in JSON: BrainGlobe's structures.json, a list of structures with their paths in the tree; NiiVue's
 * colour maps, an object of parallel lists; OME's image-label, a list of colours and one of properties; neuroglancer's
 * segment properties; nnU-Net's dataset.json; a map from numbers to names; and objects with a number and a name, in a
 * list or below each other. */
#include "loaders/labels/label_format.h"

#include "base/formats/json_text.h"

#include <string.h>

/* Notes the keys of the object that are not known, unless some were noted before. */
static void note_unused(struct job *job, bool *noted, const json_t *object, const char *known)
{
    const char *list = "";
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value)
    {
        if (!*noted && !text_is_one_of(text_from(key), known, true)) {
            list = job_format(job, "%s%s\"%.40s\"", list, list[0] ? ", " : "", key);
        }
    }
    if (list[0]) {
        *noted = true;
        job_note(job, "label table: keys passed over: %s", list);
    }
}

static uint32_t read_number(struct job *job, const json_t *value, const char *field)
{
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || number > UINT32_MAX) {
        job_bad(job, "%s must be a whole number from 0 to 4294967295", field);
        return 0;
    }
    return (uint32_t)number;
}

static void set_channel(struct label *label, int channel, const json_t *value)
{
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    bool is_good = number >= 0 && number <= 255;
    label->rgb[channel] = is_good ? (uint8_t)number : 0;
    label->bad_rgb = label->bad_rgb || !is_good;
    label->has_rgb = !label->bad_rgb;
}

static void set_rgb(struct label *label, const json_t *triplet)
{
    for (int i = 0; triplet && !json_is_null(triplet) && i < 3; i++) {
        set_channel(label, i, json_array_get(triplet, (size_t)i));
    }
}

static void set_hex(struct job *job, struct label *label, const json_t *colour)
{
    if (json_is_string(colour)) {
        label_colour(job, label, &(struct text){json_string_value(colour), json_string_length(colour)}, NULL);
    }
}

/* The path runs from the root to the structure itself: the last but one is the parent. */
static void set_parent(struct job *job, struct label *label, const json_t *path)
{
    size_t length = json_array_size(path);
    if (!length) {
        return;
    }
    uint32_t last = read_number(job, json_array_get(path, length - 1), "the end of structure_id_path");
    if (last != label->number) {
        job_bad(job, "structure_id_path ends in %u, its own id %u is needed", last, label->number);
    }
    if (length > 1) {
        label->has_parent = true;
        label->parent = read_number(job, json_array_get(path, length - 2), "structure_id_path");
    }
}

/* Objects in a list, and below each other in "children". */

struct node {
    const json_t *object;
    uint32_t parent; /* its label; 0 = none */
};

/* In the order in which they are read: breadth first. */
struct nodes {
    struct node *at;
    size_t count, capacity;
};

static void add_nodes(struct job *job, struct nodes *nodes, const json_t *list, uint32_t parent)
{
    for (size_t i = 0; job_ok(job) && i < json_array_size(list); i++) {
        *LIST_ADD(job, nodes) = (struct node){json_array_get(list, i), parent};
    }
}

/* Fills `row` from the object number `count`, from 1. */
typedef void fill_row(struct job *job, struct label_row *row, const json_t *object, size_t count, void *data);

/* Fills a row for each object, with the one that it is below as its parent unless it says another. The list is the text
 * itself, Allen's "msg", or one object with "children". */
static void parse_nodes(struct job *job, struct label_table *out, const json_t *root, const char *what, fill_row *fill,
                        void *data, const char *known)
{
    struct nodes nodes = {0};
    bool noted = false;
    const json_t *answer = json_object_get(root, "msg");
    if (answer) {
        note_unused(job, &noted, root, "msg/success/id/start_row/num_rows/total_rows");
    }
    if (json_is_object(root) && !answer) {
        *LIST_ADD(job, &nodes) = (struct node){.object = root};
    } else {
        add_nodes(job, &nodes, answer ? answer : root, 0);
    }
    for (size_t i = 0; job_ok(job) && i < nodes.count; i++) {
        struct label_row row = {0};
        const struct node node = nodes.at[i];
        size_t place = job_in(job, what, i + 1);
        fill(job, &row, node.object, i + 1, data);
        job_out(job, place);
        note_unused(job, &noted, node.object, known);
        if (node.parent && !row.label.has_parent) {
            row.label.has_parent = true;
            row.label.parent = node.parent;
        }
        add_nodes(job, &nodes, json_object_get(node.object, "children"), row.label.number);
        labels_keep(job, out, &row);
    }
}

static void fill_structure(struct job *job, struct label_row *row, const json_t *structure, size_t count, void *data)
{
    (void)count;
    (void)data;
    row->label.number = read_number(job, json_object_get(structure, "id"), "id");
    set_rgb(&row->label, json_object_get(structure, "rgb_triplet"));
    set_parent(job, &row->label, json_object_get(structure, "structure_id_path"));
    set_hex(job, &row->label, json_object_get(structure, "color_hex_triplet"));
    row->abbreviation = json_text_of(json_object_get(structure, "acronym"));
    row->name = json_text_of(json_object_get(structure, "name"));
    row->name = text_trim(row->name).size ? row->name : row->abbreviation;
}

void label_parse_structures(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    (void)use;
    parse_nodes(job, out, json_text_read(job, text), "structure ", fill_structure, NULL,
                "id/name/acronym/rgb_triplet/color_hex_triplet/structure_id_path/parent_structure_id/children");
}

/* Entry i has R, G, B, and perhaps I, its number, which is i else. */
void label_parse_lists(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    static const char *const fields[] = {"R", "G", "B", "I"};
    const json_t *root = json_text_read(job, text);
    const json_t *names = json_object_get(root, "labels");
    const json_t *lists[4];
    bool noted = false;
    (void)use;
    note_unused(job, &noted, root, "R/G/B/A/I/labels/min/max");
    for (int i = 0; i < 4; i++) {
        lists[i] = json_object_get(root, fields[i]);
        if (lists[i] && json_array_size(lists[i]) != json_array_size(names)) {
            job_bad(job, "%s has %zu entries, labels has %zu: they must be as many", fields[i],
                    json_array_size(lists[i]), json_array_size(names));
        }
    }
    for (size_t i = 0; job_ok(job) && i < json_array_size(names); i++) {
        const json_t *number = json_array_get(lists[3], i);
        if (json_is_integer(number) && json_integer_value(number) < 0) { /* NiiVue lists entries without voxels */
            continue;
        }
        struct label_row row = {.name = json_text_of(json_array_get(names, i))};
        size_t place = job_in(job, "labels", i);
        row.label.number = lists[3] ? read_number(job, number, "I") : (uint32_t)i;
        for (int channel = 0; lists[0] && lists[1] && lists[2] && channel < 3; channel++) {
            set_channel(&row.label, channel, json_array_get(lists[channel], i));
        }
        job_out(job, place);
        labels_keep(job, out, &row);
    }
}

void label_parse_map(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    json_t *root = json_text_read(job, text);
    const char *key;
    json_t *name;
    (void)use;
    json_object_foreach(root, key, name)
    {
        size_t place = job_in(job, "a key", JOB_ALONE);
        const struct label_row row = {.label = {.number = label_cell_number(job, text_from(key))},
                                      .name = json_text_of(name)};
        job_out(job, place);
        if (!json_is_string(name)) {
            job_bad(job, "key %s: the name of the label must be a text", key);
        }
        if (!job_ok(job)) {
            return;
        }
        labels_keep(job, out, &row);
    }
}

/* Fields of the objects in a list, those that count more first. */
enum { NUMBER_FIELDS = 5, NAME_FIELDS = 4 };
static const char *const number_fields[NUMBER_FIELDS] = {"index", "LabelValue", "id", "key", "label"};
static const char *const name_fields[NAME_FIELDS] = {"name", "region", "structure", "label"};

static const char object_keys[] = "index/LabelValue/id/key/label/name/region/structure/abbreviation/color/children";

/* Which fields of the objects in a list are number and name. */
struct fields {
    const char *number, *rival, *name; /* rival: another that could be the number, or NULL */
    bool disputed;
    const json_t *root, *first; /* the list, and its first object */
};

static struct fields find_fields(const json_t *root)
{
    struct fields fields = {.root = root, .first = json_is_object(root) ? root : json_array_get(root, 0)};
    for (size_t i = NUMBER_FIELDS; i-- > 0;) {
        if (json_is_integer(json_object_get(fields.first, number_fields[i]))) {
            fields.rival = fields.number;
            fields.number = number_fields[i];
        }
    }
    for (size_t i = NAME_FIELDS; i-- > 0;) {
        fields.name = json_is_string(json_object_get(fields.first, name_fields[i])) ? name_fields[i] : fields.name;
    }
    return fields;
}

static void fill_object(struct job *job, struct label_row *row, const json_t *object, size_t count, void *data)
{
    struct fields *fields = data;
    const json_t *name = json_object_get(object, fields->name);
    const json_t *rival = fields->rival ? json_object_get(object, fields->rival) : NULL;
    if (!json_is_string(name)) {
        job_bad(job, "%s must be a text as in the first", fields->name);
    }
    row->label.number = read_number(job, json_object_get(object, fields->number), fields->number);
    if (!fields->disputed && json_is_integer(rival) && json_integer_value(rival) != row->label.number) {
        fields->disputed = true;
        job_warn(job, "label table, object %zu: two fields could be the label's number, %s and %s: %s is used", count,
                 fields->number, fields->rival, fields->number);
    }
    row->name = json_text_of(name);
    row->abbreviation = json_text_of(json_object_get(object, "abbreviation"));
    set_hex(job, &row->label, json_object_get(object, "color"));
}

static struct text try_field(struct job *job, struct label_table *out, void *user, size_t candidate)
{
    const struct fields *fields = user;
    struct fields tried = {.number = number_fields[candidate], .name = fields->name};
    if (json_is_integer(json_object_get(fields->first, tried.number))) {
        parse_nodes(job, out, fields->root, "object ", fill_object, &tried, object_keys);
    }
    return text_from(tried.number);
}

void label_parse_objects(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    struct fields fields = find_fields(json_text_read(job, text));
    if (!(fields.number && fields.name)) {
        job_bad(job, "the first object has no whole number (index, LabelValue, id, key, label) and name");
        return;
    }
    if (use->voxels) { /* of several fields that could be the number the one that fits the volume */
        size_t usual = 0;
        while (number_fields[usual] != fields.number) {
            usual++;
        }
        size_t best = label_choose(job, usual, try_field, &fields, NUMBER_FIELDS, use->voxels);
        fields.rival = best == usual ? fields.rival : NULL;
        fields.number = number_fields[best];
    }
    parse_nodes(job, out, fields.root, "object ", fill_object, &fields, object_keys);
}

/* OME's lists of colours and of properties, one of which may be the name. */
static void parse_ome_list(struct job *job, struct label_table *out, const json_t *about, const char *what)
{
    static const char *const names[] = {"name", "class", "label"};
    const json_t *list = json_object_get(about, what);
    bool noted = false;
    for (size_t i = 0; job_ok(job) && i < json_array_size(list); i++) {
        const json_t *object = json_array_get(list, i);
        struct label_row row = {0};
        note_unused(job, &noted, object, "label-value/rgba/name/class/label");
        size_t place = job_in(job, what, i);
        row.label.number = read_number(job, json_object_get(object, "label-value"), "label-value");
        set_rgb(&row.label, json_object_get(object, "rgba"));
        job_out(job, place);
        for (size_t k = 0; !text_trim(row.name).size && k < sizeof names / sizeof names[0]; k++) {
            row.name = json_text_of(json_object_get(object, names[k]));
        }
        labels_keep(job, out, &row);
    }
    labels_sort(job, out);
}

/* Colours and properties lie in two lists; a label may be in one of them. */
void label_parse_ome(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    const json_t *root = json_text_read(job, text);
    const json_t *attributes = json_object_get(json_object_get(root, "attributes"), "ome");
    const json_t *about = json_object_get(attributes ? attributes : root, "image-label");
    struct label_table *colours = labels_new(job);
    bool noted = false;
    (void)use;
    note_unused(job, &noted, about, "version/colors/properties/source");
    parse_ome_list(job, out, about, "properties");
    parse_ome_list(job, colours, about, "colors");
    size_t named = out->count;
    for (size_t i = 0; job_ok(job) && i < colours->count; i++) {
        const struct label_table first = {.entries = out->entries, .count = named};
        const struct label *colour = &colours->entries[i]; /* a name in it is not taken */
        struct label *label = label_table_find(&first, colour->number);
        label = label ? label : labels_add(job, out, colour->number);
        label->has_rgb = colour->has_rgb;
        memcpy(label->rgb, colour->rgb, sizeof colour->rgb);
    }
}

/* nnU-Net's labels: of version 2 names with their numbers, of version 1 numbers with their names. */
void label_parse_data_set(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    json_t *root = json_text_read(job, text);
    const char *key;
    json_t *value;
    bool noted = false;
    (void)use;
    note_unused(job, &noted, root,
                "labels/channel_names/modality/numTraining/numTest/file_ending/name/dataset_name/description/reference/"
                "licence/license/release/converted_by/citation/tensorImageSize/training/test/"
                "overwrite_image_reader_writer");
    json_object_foreach(json_object_get(root, "labels"), key, value)
    {
        const bool is_name = json_is_integer(value);
        size_t place = job_in(job, "labels", JOB_ALONE);
        uint64_t number = 0;
        struct label_row row = {.name = is_name ? text_from(key) : json_text_of(value)};
        if (is_name && label_cell_whole(text_from(key), &number)) {
            job_bad(job, "\"%.40s\": %lld: which of both is the number?", key, (long long)json_integer_value(value));
        } else if (!is_name && !json_is_string(value)) {
            job_bad(job, "\"%.40s\": a number or a name is needed; regions of several labels are not read", key);
        }
        row.label.number = is_name ? read_number(job, value, key) : label_cell_number(job, text_from(key));
        job_out(job, place);
        if (!job_ok(job)) {
            return;
        }
        labels_keep(job, out, &row);
    }
}

/* neuroglancer's segment properties: ids, and a property of the type label with as many values. */
void label_parse_segments(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    const json_t *root = json_text_read(job, text);
    const json_t *ids = json_object_get(json_object_get(root, "inline"), "ids");
    const json_t *properties = json_object_get(json_object_get(root, "inline"), "properties");
    const json_t *values = NULL;
    bool noted = false;
    (void)use;
    note_unused(job, &noted, root, "@type/inline");
    note_unused(job, &noted, json_object_get(root, "inline"), "ids/properties");
    for (size_t i = 0; i < json_array_size(properties); i++) {
        const json_t *property = json_array_get(properties, i);
        struct text type = json_text_of(json_object_get(property, "type"));
        struct text id = json_text_of(json_object_get(property, "id"));
        if (text_equal(type, "label")) {
            values = json_object_get(property, "values");
        } else {
            job_note(job, "label table: the property \"%.*s\" is passed over", TEXT_SHOW(id, 40));
        }
    }
    if (!json_array_size(ids) || json_array_size(values) != json_array_size(ids)) {
        job_bad(job, "found %zu ids, and %zu values of a property of the type label: they must be as many",
                json_array_size(ids), json_array_size(values));
    }
    for (size_t i = 0; job_ok(job) && i < json_array_size(ids); i++) {
        size_t place = job_in(job, "ids", i);
        const struct label_row row = {.label = {.number = label_cell_number(job, json_text_of(json_array_get(ids, i)))},
                                      .name = json_text_of(json_array_get(values, i))};
        job_out(job, place);
        labels_keep(job, out, &row);
    }
}

/* Takes `c`, and the white space behind it, off `rest`; false if something else is there. */
static bool skip(struct text *rest, char c)
{
    bool is = rest->size && rest->data[0] == c;
    *rest = is ? text_trim((struct text){rest->data + 1, rest->size - 1}) : *rest;
    return is;
}

/* { "17": "Hippocampus": the first key is a number, and its value a text. */
bool label_is_map(const struct label_text *text)
{
    struct text rest = text->text;
    size_t digits = 0;
    bool begins = skip(&rest, '{') && skip(&rest, '"');
    while (digits < rest.size && rest.data[digits] >= '0' && rest.data[digits] <= '9') {
        digits++;
    }
    rest = (struct text){rest.data + digits, rest.size - digits};
    while (rest.size && (rest.data[0] == '.' || rest.data[0] == '0')) { /* "17.0" */
        rest = (struct text){rest.data + 1, rest.size - 1};
    }
    return begins && digits && skip(&rest, '"') && skip(&rest, ':') && skip(&rest, '"');
}

/* Whether `object`, text of JSON, has one of the fields `names` with a value that begins like one of `starts`. */
static bool has_field(struct text object, const char *const *names, size_t count, const char *starts)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t at = 0; at < object.size; at++) {
            struct text rest = {object.data + at, object.size - at};
            struct text key = {rest.data + 1, strlen(names[i])};
            if (rest.data[0] == '"' && rest.size > key.size + 1 && text_equal(key, names[i])) {
                rest = (struct text){key.data + key.size, rest.size - 1 - key.size};
                if (skip(&rest, '"') && skip(&rest, ':') && rest.size && memchr(starts, rest.data[0], strlen(starts))) {
                    return true;
                }
            }
        }
    }
    return false;
}

/* [ { "label": 1, "name": "Hippocampus": the first object decides. */
bool label_is_objects(const struct label_text *about)
{
    const struct text text = about->text;
    struct text rest = text;
    bool is_tree = text.data[0] == '{' && text_mentions(text, "\"children\"");
    const char *end = memchr(text.data, '}', text.size);
    struct text first = {text.data, end ? (size_t)(end - text.data) : text.size};
    return (is_tree || (skip(&rest, '[') && skip(&rest, '{'))) &&
           has_field(first, number_fields, NUMBER_FIELDS, "0123456789") &&
           has_field(first, name_fields, NAME_FIELDS, "\"");
}

bool label_is_structures(const struct label_text *text)
{
    return (text->text.data[0] == '[' || text_mentions(text->text, "\"children\"")) &&
           (text_mentions(text->text, "\"acronym\"") || text_mentions(text->text, "\"structure_id_path\""));
}

bool label_is_data_set(const struct label_text *text)
{
    static const char *const names[] = {"labels"};
    return has_field(text->text, names, 1, "{") &&
           (text_mentions(text->text, "\"channel_names\"") || text_mentions(text->text, "\"modality\""));
}
