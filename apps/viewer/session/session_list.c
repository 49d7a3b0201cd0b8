/* SPDX-License-Identifier: BSD-3-Clause */
/* Columns of the lists of hits as JSON, and back. */
#include "viewer/session/session_list.h"

#include "viewer/model/columns.h"

#include <string.h>

static json_t *columns_of(const struct result_list *list)
{
    json_t *names = list->columns ? json_array() : json_null();
    for (size_t i = 0; list->columns && i < RESULT_COLUMNS; i++) {
        if (list->columns >> i & 1) {
            json_array_append_new(names, json_string(result_key(i)));
        }
    }
    return names;
}

json_t *session_list(const struct result_list *list)
{
    return json_pack("{s: o, s: s, s: b, s: s}", "columns", columns_of(list), "order", result_key(list->order),
                     "reversed", list->reversed, "export", result_formats[list->format]);
}

static size_t find_column(const json_t *name)
{
    const char *key = json_string_value(name);
    return key ? result_find(key) : RESULT_COLUMNS;
}

static bool read_columns(struct result_list *out, const json_t *names, char why[SESSION_REASON])
{
    bool fine = json_is_null(names) || json_array_size(names) > 0;
    out->columns = 0;
    for (size_t i = 0; fine && i < json_array_size(names); i++) {
        size_t column = find_column(json_array_get(names, i));
        fine = column < RESULT_COLUMNS;
        out->columns |= fine ? UINT32_C(1) << column : 0;
    }
    return fine || session_refuse(why, "session: results: columns: names of columns are needed, or null");
}

static size_t find_format(const json_t *name)
{
    const char *text = json_string_value(name);
    size_t format = 0;
    while (format < RESULT_FORMATS && !(text && strcmp(text, result_formats[format]) == 0)) {
        format++;
    }
    return format;
}

bool session_list_read(struct result_list *out, const json_t *root, char why[SESSION_REASON])
{
    const json_t *of = json_object_get(root, "results");
    struct result_list list = *out;
    if (!of) {
        return true;
    }
    if (!read_columns(&list, json_object_get(of, "columns"), why)) {
        return false;
    }
    const json_t *reversed = json_object_get(of, "reversed");
    list.order = find_column(json_object_get(of, "order"));
    list.reversed = json_is_true(reversed);
    list.format = find_format(json_object_get(of, "export"));
    if (list.order == RESULT_COLUMNS || !json_is_boolean(reversed) || list.format == RESULT_FORMATS) {
        return session_refuse(why, "session: results: order, the name of a column, reversed, true or false, and "
                                   "export, TSV, CSV or JSON, are needed");
    }
    *out = list;
    return true;
}
