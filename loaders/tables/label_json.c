/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables in JSON: BrainGlobe's structures.json, a list of structures with their paths in the tree, and NiiVue's
 * colour maps, an object of parallel lists. */
#include "loaders/tables/label_json.h"

#include "base/formats/json_text.h"
#include "loaders/tables/label_cells.h"

#include <stdio.h>
#include <string.h>

static conus_status set_text(char **field, const json_t *value)
{
    return json_is_string(value)
               ? label_set_text(field, (struct text){json_string_value(value), json_string_length(value)})
               : CONUS_OK;
}

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

static conus_status fill_structure(struct label *label, const json_t *structure, const char *where)
{
    conus_status status = read_number(&label->number, json_object_get(structure, "id"), "id", where);
    status = status ? status : set_rgb(label, json_object_get(structure, "rgb_triplet"), where);
    status = status ? status : set_parent(label, json_object_get(structure, "structure_id_path"), where);
    status = status ? status : set_text(&label->abbreviation, json_object_get(structure, "acronym"));
    status = status ? status : set_text(&label->name, json_object_get(structure, "name"));
    if (!status && !label->name && label->abbreviation) {
        status = label_set_text(&label->name, text_from(label->abbreviation));
    }
    return status;
}

static conus_status parse_structures(struct label_table *out, struct text text, struct notes *notes)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    for (size_t i = 0; !status && i < json_array_size(root); i++) {
        char where[32];
        struct label label = {0};
        snprintf(where, sizeof where, "structure %zu", i + 1);
        status = fill_structure(&label, json_array_get(root, i), where);
        status = label_keep(out, &label, status, notes);
    }
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
    return status ? status : set_text(&label->name, json_array_get(lists->names, i));
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
        snprintf(where, sizeof where, "labels[%zu]", i);
        status = fill_from_lists(&label, &lists, i, where);
        status = label_keep(out, &label, status, notes);
    }
    json_decref(root);
    return status;
}

const struct label_format *label_format_of_json(struct text text)
{
    static const struct label_format structures = {"BrainGlobe structures", parse_structures};
    static const struct label_format lists = {"NiiVue labels", parse_lists};
    if (text.data[0] == '[' && text_mentions(text, "\"id\"") &&
        (text_mentions(text, "\"acronym\"") || text_mentions(text, "\"structure_id_path\""))) {
        return &structures;
    }
    return text.data[0] == '{' && text_mentions(text, "\"labels\"") && text_mentions(text, "\"R\"") ? &lists : NULL;
}
