/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a list of areas, from the command line or from a file. */
#include "atlas/areas/areas.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

enum { FILE_LIMIT = 64 << 20 };

/** The caller's functions for entries and files. */
struct reading {
    area_list_take take;
    area_list_file file; /* may be NULL */
    void *user;
};

static conus_status take_entry(const struct reading *reading, struct text name)
{
    return name.size
               ? reading->take(reading->user, name)
               : fail(CONUS_ERROR_ARGUMENT, "an area is missing: names, abbreviations or labels, separated by commas");
}

static conus_status list_lines(const struct reading *reading, const char *path)
{
    struct bytes bytes = {0};
    struct text line;
    conus_status status = file_read(&bytes, path, FILE_LIMIT);
    status = !status && reading->file ? reading->file(reading->user, path, &bytes) : status;
    struct text rest = {(const char *)bytes.data, bytes.size};
    if (!status && text_starts(rest, "\xef\xbb\xbf")) {
        rest = (struct text){rest.data + 3, rest.size - 3};
    }
    for (size_t number = 1; !status && text_line(&rest, &line); number++) {
        char where[32];
        line = text_trim(line);
        if (!line.size || line.data[0] == '#') {
            continue;
        }
        status = take_entry(reading, line);
        if (status == CONUS_ERROR_ARGUMENT) {
            snprintf(where, sizeof where, "line %zu", number);
            status = fail_in(fail_in(status, where), path);
        }
    }
    bytes_finish(&bytes);
    return status;
}

static conus_status list_file(const struct reading *reading, struct text path)
{
    if (!path.size) {
        return fail(CONUS_ERROR_ARGUMENT, "@ without a file; @FILE has one area per line");
    }
    char *copy = memory_text(path.data, path.size);
    conus_status status = copy ? list_lines(reading, copy) : CONUS_ERROR_MEMORY;
    memory_free(copy);
    return status;
}

/* Takes "..." off @p rest, which begins with the quote, and the rest of the entry up to the comma or the end. */
static conus_status take_quoted(struct text *rest, bool *more, struct text *out)
{
    struct text after;
    const char *end = memchr(rest->data + 1, '"', rest->size - 1);
    if (!end) {
        return fail(CONUS_ERROR_ARGUMENT, "%.*s: the closing quote is missing", TEXT_SHOW(*rest, 40));
    }
    *out = (struct text){rest->data + 1, (size_t)(end - rest->data) - 1};
    *rest = (struct text){end + 1, rest->size - out->size - 2};
    text_field(rest, ',', more, &after);
    after = text_trim(after);
    return !after.size ? CONUS_OK
                       : fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is followed by \"%.*s\", a comma is needed between areas",
                              TEXT_SHOW(*out, 40), TEXT_SHOW(after, 40));
}

static conus_status list_item(const struct reading *reading, struct text *rest, bool *more)
{
    struct text item;
    struct text start = text_trim(*rest);
    if (text_starts(start, "\"")) {
        *rest = start;
        conus_status status = take_quoted(rest, more, &item);
        return status ? status : take_entry(reading, item);
    }
    text_field(rest, ',', more, &item);
    item = text_trim(item);
    return text_starts(item, "@") ? list_file(reading, (struct text){item.data + 1, item.size - 1})
                                  : take_entry(reading, item);
}

conus_status area_list_read(struct text list, area_list_take take, area_list_file file, void *user)
{
    const struct reading reading = {take, file, user};
    bool more = true;
    conus_status status = CONUS_OK;
    while (!status && more) {
        status = list_item(&reading, &list, &more);
    }
    return status;
}
