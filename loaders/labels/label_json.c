/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables in JSON: BrainGlobe's structures.json, a list of structures with their paths in the tree; NiiVue's
 * colour maps, an object of parallel lists; OME's image-label, a list of colours and one of properties; a map from
 * numbers to names; and objects with a number and a name, in a list or below each other. */
#include "loaders/labels/label_format.h"

#include "base/formats/json_text.h"
#include "base/memory.h"
#include "loaders/labels/label_cells.h"

#include <stdio.h>
#include <string.h>

static conus_status read_number(uint32_t *out, const json_t *value, const char *field, const char *where)
{
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || number > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "%s: %s must be a whole number from 0 to 4294967295", where, field);
    }
    *out = (uint32_t)number;
    return CONUS_OK;
}

static conus_status read_channel(uint8_t *out, const json_t *value, const char *where)
{
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || number > 255) {
        return fail(CONUS_ERROR_DATA, "%s: a colour must be three whole numbers from 0 to 255", where);
    }
    *out = (uint8_t)number;
    return CONUS_OK;
}

static conus_status set_rgb(struct label *label, const json_t *triplet, const char *where)
{
    if (!triplet || json_is_null(triplet)) {
        return CONUS_OK;
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 3; i++) {
        status = read_channel(&label->rgb[i], json_array_get(triplet, i), where);
    }
    label->has_rgb = true;
    return status;
}

static conus_status set_hex(struct label *label, const json_t *colour, const char *where)
{
    if (!json_is_string(colour)) {
        return CONUS_OK;
    }
    label->has_rgb = true;
    return label_cell_colour(label->rgb, text_from(json_string_value(colour)), where);
}

/* The path runs from the root to the structure itself: the last but one is the parent. */
static conus_status set_parent(struct label *label, const json_t *path, const char *where)
{
    size_t length = json_array_size(path);
    if (!length) {
        return CONUS_OK;
    }
    uint32_t last = 0;
    conus_status status = read_number(&last, json_array_get(path, length - 1), "the end of structure_id_path", where);
    if (!status && last != label->number) {
        return fail(CONUS_ERROR_DATA, "%s: structure_id_path ends in %u, its own id %u is needed", where, last,
                    label->number);
    }
    if (!status && length > 1) {
        label->has_parent = true;
        status = read_number(&label->parent, json_array_get(path, length - 2), "structure_id_path", where);
    }
    return status;
}

static conus_status fill_structure(struct label *label, const json_t *structure, const char *where, void *data,
                                   struct notes *notes)
{
    (void)data;
    (void)notes;
    conus_status status = read_number(&label->number, json_object_get(structure, "id"), "id", where);
    status = status ? status : set_rgb(label, json_object_get(structure, "rgb_triplet"), where);
    status = status ? status : set_parent(label, json_object_get(structure, "structure_id_path"), where);
    status = status ? status : set_hex(label, json_object_get(structure, "color_hex_triplet"), where);
    status =
        status ? status : label_set_text(&label->abbreviation, json_text_of(json_object_get(structure, "acronym")));
    status = status ? status : label_set_text(&label->name, json_text_of(json_object_get(structure, "name")));
    if (!status && !label->name && label->abbreviation) {
        status = label_set_text(&label->name, text_from(label->abbreviation));
    }
    return status;
}

/* Objects in a list, and below each other in "children". */

struct node {
    const json_t *object;
    uint32_t parent; /* its label; 0 = none */
};

/* In the order in which they are read: breadth first. */
struct nodes {
    struct node *nodes;
    size_t count, capacity;
};

static conus_status add_nodes(struct nodes *nodes, const json_t *list, uint32_t parent)
{
    size_t count = json_array_size(list);
    if (!memory_reserve(&nodes->nodes, &nodes->capacity, nodes->count + count, sizeof *nodes->nodes)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        nodes->nodes[nodes->count++] = (struct node){json_array_get(list, i), parent};
    }
    return CONUS_OK;
}

/* The list of objects: the text itself, Allen's "msg", or one object with "children". */
static conus_status add_root(struct nodes *nodes, json_t *root)
{
    const json_t *answer = json_object_get(root, "msg");
    if (!json_is_object(root) || answer) {
        return add_nodes(nodes, answer ? answer : root, 0);
    }
    json_t *list = json_pack("[O]", root);
    conus_status status = list ? add_nodes(nodes, list, 0) : CONUS_ERROR_MEMORY;
    json_decref(list); /* the root keeps its own reference */
    return status;
}

typedef conus_status fill_node(struct label *label, const json_t *object, const char *where, void *data,
                               struct notes *notes);

/* Fills a label for each object, with the one that it is below as its parent unless it says another. */
static conus_status parse_nodes(struct label_table *out, json_t *root, const char *what, fill_node *fill, void *data,
                                struct notes *notes)
{
    struct nodes nodes = {0};
    conus_status status = add_root(&nodes, root);
    for (size_t i = 0; !status && i < nodes.count; i++) {
        char where[32];
        struct label label = {0};
        const struct node node = nodes.nodes[i];
        snprintf(where, sizeof where, "%s %zu", what, i + 1);
        status = fill(&label, node.object, where, data, notes);
        if (node.parent && !label.has_parent) {
            label.has_parent = true;
            label.parent = node.parent;
        }
        const json_t *children = json_object_get(node.object, "children");
        status = status || !json_array_size(children) ? status : add_nodes(&nodes, children, label.number);
        status = label_keep(out, &label, status, notes);
    }
    memory_free(nodes.nodes);
    return status;
}

static conus_status parse_structures(struct label_table *out, struct text text, struct notes *notes)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    status = status ? status : parse_nodes(out, root, "structure", fill_structure, NULL, notes);
    json_decref(root);
    return status;
}

struct lists {
    const json_t *channels[3]; /* R, G, B */
    const json_t *numbers;     /* I, or NULL: entry i is label i */
    const json_t *names;
};

static conus_status check_lists(const struct lists *lists)
{
    static const char *const fields[] = {"R", "G", "B", "I"};
    size_t count = json_array_size(lists->names);
    for (int i = 0; i < 4; i++) {
        const json_t *list = i < 3 ? lists->channels[i] : lists->numbers;
        if (list && json_array_size(list) != count) {
            return fail(CONUS_ERROR_DATA, "%s has %zu entries, labels has %zu: they must be as many", fields[i],
                        json_array_size(list), count);
        }
    }
    return CONUS_OK;
}

static conus_status fill_from_lists(struct label *label, const struct lists *lists, size_t i, const char *where)
{
    conus_status status = CONUS_OK;
    label->number = (uint32_t)i;
    if (lists->numbers) {
        status = read_number(&label->number, json_array_get(lists->numbers, i), "I", where);
    }
    for (int channel = 0; !status && channel < 3; channel++) {
        const json_t *list = lists->channels[channel];
        status = list ? read_channel(&label->rgb[channel], json_array_get(list, i), where) : CONUS_OK;
    }
    label->has_rgb = lists->channels[0] && lists->channels[1] && lists->channels[2];
    return status ? status : label_set_text(&label->name, json_text_of(json_array_get(lists->names, i)));
}

static conus_status parse_lists(struct label_table *out, struct text text, struct notes *notes)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    struct lists lists = {0};
    if (!status) {
        lists = (struct lists){
            {json_object_get(root, "R"), json_object_get(root, "G"), json_object_get(root, "B")},
            json_object_get(root, "I"),
            json_object_get(root, "labels"),
        };
        status = check_lists(&lists);
    }
    for (size_t i = 0; !status && i < json_array_size(lists.names); i++) {
        char where[32];
        struct label label = {0};
        const json_t *number = json_array_get(lists.numbers, i);
        if (json_is_integer(number) && json_integer_value(number) < 0) { /* NiiVue lists entries without voxels */
            continue;
        }
        snprintf(where, sizeof where, "labels[%zu]", i);
        status = fill_from_lists(&label, &lists, i, where);
        status = label_keep(out, &label, status, notes);
    }
    json_decref(root);
    return status;
}

static conus_status parse_map(struct label_table *out, struct text text, struct notes *notes)
{
    json_t *root = NULL;
    const char *key;
    json_t *name;
    conus_status status = json_text_load(&root, text);
    json_object_foreach(root, key, name)
    {
        struct label label = {0};
        if (status) {
            break;
        }
        status = label_cell_number(&label.number, text_from(key), "a key");
        if (!status && !json_is_string(name)) {
            status = fail(CONUS_ERROR_DATA, "key %s: the name of the label must be a text", key);
        }
        status = status ? status : label_set_text(&label.name, json_text_of(name));
        status = label_keep(out, &label, status, notes);
    }
    json_decref(root);
    return status;
}

/* Fields of the objects in a list, those that count more first. */
enum { NUMBER_FIELDS = 5, NAME_FIELDS = 4 };
static const char *const number_fields[NUMBER_FIELDS] = {"index", "LabelValue", "id", "key", "label"};
static const char *const name_fields[NAME_FIELDS] = {"name", "region", "structure", "label"};

/* Which fields of the objects in a list are number and name. */
struct fields {
    const char *number, *rival, *name; /* rival: another that could be the number, or NULL */
    bool disputed;
};

static struct fields find_fields(const json_t *object)
{
    struct fields fields = {0};
    for (size_t i = NUMBER_FIELDS; i-- > 0;) {
        if (json_is_integer(json_object_get(object, number_fields[i]))) {
            fields.rival = fields.number;
            fields.number = number_fields[i];
        }
    }
    for (size_t i = NAME_FIELDS; i-- > 0;) {
        fields.name = json_is_string(json_object_get(object, name_fields[i])) ? name_fields[i] : fields.name;
    }
    return fields;
}

static conus_status note_rival_field(struct fields *fields, const json_t *object, const char *where,
                                     struct notes *notes)
{
    json_int_t number = json_integer_value(json_object_get(object, fields->number));
    const json_t *rival = fields->rival ? json_object_get(object, fields->rival) : NULL;
    if (fields->disputed || !json_is_integer(rival) || json_integer_value(rival) == number) {
        return CONUS_OK;
    }
    fields->disputed = true;
    return notes_warn(notes, "label table, %s: two fields could be the label's number, %s and %s: %s is used", where,
                      fields->number, fields->rival, fields->number);
}

static conus_status fill_object(struct label *label, const json_t *object, const char *where, void *data,
                                struct notes *notes)
{
    struct fields *fields = data;
    const json_t *name = json_object_get(object, fields->name);
    if (!json_is_string(name)) {
        return fail(CONUS_ERROR_DATA, "%s: %s must be a text as in the first", where, fields->name);
    }
    conus_status status = read_number(&label->number, json_object_get(object, fields->number), fields->number, where);
    status = status ? status : note_rival_field(fields, object, where, notes);
    status = status ? status : label_set_text(&label->name, json_text_of(name));
    status =
        status ? status : label_set_text(&label->abbreviation, json_text_of(json_object_get(object, "abbreviation")));
    return status ? status : set_hex(label, json_object_get(object, "color"), where);
}

struct trial {
    const struct fields *fields;
    json_t *root;
    const json_t *first;
};

static conus_status try_field(struct label_table *out, struct text *called, void *user, size_t candidate,
                              struct notes *notes)
{
    const struct trial *trial = user;
    *called = text_from(number_fields[candidate]);
    struct fields tried = {.number = number_fields[candidate], .name = trial->fields->name};
    return json_is_integer(json_object_get(trial->first, tried.number))
               ? parse_nodes(out, trial->root, "object", fill_object, &tried, notes)
               : CONUS_OK;
}

static conus_status parse_objects(struct label_table *out, struct text text, const struct label_use *use,
                                  struct notes *notes)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    const json_t *first = json_is_object(root) ? root : json_array_get(root, 0);
    struct fields fields = find_fields(first);
    if (!status && !(fields.number && fields.name)) {
        status =
            fail(CONUS_ERROR_DATA, "the first object has no whole number (index, LabelValue, id, key, label) and name");
    }
    if (!status && use->voxels) { /* of several fields that could be the number the one that fits the volume */
        size_t best = 0;
        while (number_fields[best] != fields.number) {
            best++;
        }
        status =
            label_choose(&best, try_field, &(struct trial){&fields, root, first}, NUMBER_FIELDS, use->voxels, notes);
        fields.rival = number_fields[best] == fields.number ? fields.rival : NULL;
        fields.number = number_fields[best];
    }
    status = status ? status : parse_nodes(out, root, "object", fill_object, &fields, notes);
    json_decref(root);
    return status;
}

/* A colour of OME's, or properties, one of which may be the name. */
static conus_status fill_ome(struct label *label, const json_t *object, const char *where)
{
    static const char *const names[] = {"name", "class", "label"};
    conus_status status = read_number(&label->number, json_object_get(object, "label-value"), "label-value", where);
    status = status ? status : set_rgb(label, json_object_get(object, "rgba"), where);
    for (size_t i = 0; !status && !label->name && i < sizeof names / sizeof names[0]; i++) {
        status = label_set_text(&label->name, json_text_of(json_object_get(object, names[i])));
    }
    return status;
}

static conus_status parse_ome_list(struct label_table *out, const json_t *list, const char *what, struct notes *notes)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < json_array_size(list); i++) {
        char where[32];
        struct label label = {0};
        snprintf(where, sizeof where, "%s[%zu]", what, i);
        status = fill_ome(&label, json_array_get(list, i), where);
        status = label_keep(out, &label, status, notes);
    }
    return status ? status : label_table_sort(out, notes);
}

/* Colours and properties lie in two lists; a label may be in one of them. */
static conus_status parse_ome(struct label_table *out, struct text text, struct notes *notes)
{
    json_t *root = NULL;
    struct label_table colours = {0};
    conus_status status = json_text_load(&root, text);
    const json_t *attributes = json_object_get(json_object_get(root, "attributes"), "ome");
    const json_t *about = json_object_get(attributes ? attributes : root, "image-label");
    status = status ? status : parse_ome_list(out, json_object_get(about, "properties"), "properties", notes);
    status = status ? status : parse_ome_list(&colours, json_object_get(about, "colors"), "colors", notes);
    size_t named = out->count;
    for (size_t i = 0; !status && i < colours.count; i++) {
        const struct label_table first = {.entries = out->entries, .count = named};
        struct label colour = colours.entries[i]; /* a name in it is not taken */
        struct label *label = label_table_find(&first, colour.number);
        label = label ? label : label_table_add(out, colour.number);
        status = label ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (!status) {
            label->has_rgb = colour.has_rgb;
            memcpy(label->rgb, colour.rgb, sizeof colour.rgb);
        }
    }
    label_table_finish(&colours);
    json_decref(root);
    return status;
}

static struct text after(struct text text, size_t count)
{
    return text_trim((struct text){text.data + count, text.size - count});
}

static bool starts_with(struct text text, char c)
{
    return text.size && text.data[0] == c;
}

/* { "17": "Hippocampus": the first key is a number, and its value a text. */
static bool is_map(struct text text)
{
    size_t digits = 0;
    struct text rest = after(text, 1);
    if (!starts_with(text, '{') || !starts_with(rest, '"')) {
        return false;
    }
    rest = after(rest, 1);
    while (digits < rest.size && rest.data[digits] >= '0' && rest.data[digits] <= '9') {
        digits++;
    }
    if (!digits || digits == rest.size || rest.data[digits] != '"') {
        return false;
    }
    rest = after(rest, digits + 1);
    return starts_with(rest, ':') && starts_with(after(rest, 1), '"');
}

/* Whether the field `name` stands at `at` of `object`, behind its mark, with a value that begins like one of `starts`.
 */
static bool is_field(struct text object, size_t at, const char *name, const char *starts)
{
    size_t length = strlen(name);
    const char *start = object.data + at;
    if (at + length >= object.size || start[-1] != '"' || memcmp(start, name, length) != 0 || start[length] != '"') {
        return false;
    }
    struct text rest = after(object, at + length + 1);
    struct text value = starts_with(rest, ':') ? after(rest, 1) : (struct text){0};
    return value.size && memchr(starts, value.data[0], strlen(starts));
}

/* Whether `object`, text of JSON, has one of the fields `names` with a value that begins like one of `starts`. */
static bool has_field(struct text object, const char *const *names, size_t count, const char *starts)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t at = 1; at < object.size; at++) {
            if (is_field(object, at, names[i], starts)) {
                return true;
            }
        }
    }
    return false;
}

/* [ { "label": 1, "name": "Hippocampus": the first object decides. */
static bool is_objects(struct text text)
{
    bool tree = starts_with(text, '{') && text_mentions(text, "\"children\"");
    if (!tree && (!starts_with(text, '[') || !starts_with(after(text, 1), '{'))) {
        return false;
    }
    const char *end = memchr(text.data, '}', text.size);
    struct text first = {text.data, end ? (size_t)(end - text.data) : text.size};
    return has_field(first, number_fields, NUMBER_FIELDS, "0123456789") &&
           has_field(first, name_fields, NAME_FIELDS, "\"");
}

const struct label_format *label_format_of_json(struct text text)
{
    static const struct label_format map = {"JSON map of names", parse_map, NULL};
    static const struct label_format objects = {"JSON list of labels", NULL, parse_objects};
    static const struct label_format structures = {"BrainGlobe structures", parse_structures, NULL};
    static const struct label_format lists = {"NiiVue labels", parse_lists, NULL};
    static const struct label_format ome = {"OME image-label", parse_ome, NULL};
    if (text.data[0] == '{' && text_mentions(text, "\"image-label\"") && text_mentions(text, "\"label-value\"")) {
        return &ome;
    }
    bool tree = text_mentions(text, "\"children\"");
    if ((text.data[0] == '[' || tree) && text_mentions(text, "\"id\"") &&
        (text_mentions(text, "\"acronym\"") || text_mentions(text, "\"structure_id_path\""))) {
        return &structures;
    }
    if (text.data[0] == '{' && text_mentions(text, "\"labels\"") && text_mentions(text, "\"R\"")) {
        return &lists;
    }
    return is_map(text) ? &map : is_objects(text) ? &objects : NULL;
}
