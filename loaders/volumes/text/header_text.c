/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines, fields and numbers of headers of text. */
#include "loaders/volumes/text/header_text.h"

#include "base/memory.h"

#include <string.h>

bool header_line(struct text *rest, struct text *line, size_t *count, conus_status *status)
{
    if (*status || !rest->size) {
        return false;
    }
    if (++*count > HEADER_LINE_LIMIT) {
        *status = fail(CONUS_ERROR_DATA, "header: found more than %d lines, allowed are %d", HEADER_LINE_LIMIT,
                       HEADER_LINE_LIMIT);
        return false;
    }
    const char *end = memchr(rest->data, '\n', rest->size);
    size_t length = end ? (size_t)(end - rest->data) : rest->size;
    *line = (struct text){rest->data, length && rest->data[length - 1] == '\r' ? length - 1 : length};
    length += end != NULL;
    *rest = (struct text){rest->data + length, rest->size - length};
    return true;
}

int header_find(const struct header_key *keys, size_t count, struct text name)
{
    for (size_t i = 0; i < count; i++) {
        if (text_equal_ignoring_case(name, keys[i].name)) {
            return keys[i].field;
        }
    }
    return -1;
}

conus_status header_keep(struct text *slot, struct text value, struct text name)
{
    if (slot->data) {
        return fail(CONUS_ERROR_DATA, "%.*s: found twice, allowed is once", HEADER_SHOW(name));
    }
    *slot = value;
    return CONUS_OK;
}

conus_status header_need(struct text value, const char *name, const char *allowed)
{
    return value.data ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: missing, %s", name, allowed);
}

conus_status header_numbers(double *out, size_t count, struct text value, const char *name)
{
    struct text rest = value;
    struct text word;
    size_t found = 0;
    for (; text_word(&rest, &word); found++) {
        if (found == count || !text_to_double(word, &out[found])) {
            found = count + 1;
            break;
        }
    }
    return found == count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s: found \"%.*s\", %zu numbers are needed", name, HEADER_SHOW(value), count);
}

conus_status header_integers(int64_t *out, size_t most, size_t *count, struct text value, int64_t least,
                             const char *name)
{
    struct text rest = value;
    struct text word;
    *count = 0;
    while (text_word(&rest, &word)) {
        int64_t number = 0;
        if (!text_to_int(word, &number) || number < least || number > INT64_MAX / 2) {
            return fail(CONUS_ERROR_DATA, "%s: found \"%.*s\", allowed are whole numbers from %lld", name,
                        HEADER_SHOW(word), (long long)least);
        }
        if (*count == most) {
            return fail(CONUS_ERROR_DATA, "%s: found more than %zu numbers", name, most);
        }
        out[(*count)++] = number;
    }
    return CONUS_OK;
}

conus_status header_integer(int64_t *out, struct text value, int64_t least, const char *name)
{
    size_t count;
    conus_status status = header_integers(out, 1, &count, value, least, name);
    return status || count ? status : fail(CONUS_ERROR_DATA, "%s: empty, a whole number is needed", name);
}

/* Whether some part between two '/' is "..". */
static bool climbs(struct text path)
{
    struct text part;
    bool more = true;
    bool found = false;
    while (text_field(&path, '/', &more, &part)) {
        found = found || text_equal(part, "..");
    }
    return found;
}

conus_status header_file(char **out, struct text value, const char *name)
{
    bool whole = value.size && !memchr(value.data, '\0', value.size);
    if (!whole || value.data[0] == '/' || climbs(value)) {
        return fail(CONUS_ERROR_DATA,
                    "%s: found \"%.*s\", allowed is the name of a file in the header's folder or below it", name,
                    HEADER_SHOW(value));
    }
    *out = memory_text(value.data, value.size);
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

double header_unit(struct text unit)
{
    static const struct {
        const char *name;
        double mm;
    } units[] = {
        {"mm", 1},           {"millimeter", 1}, {"millimeters", 1}, {"millimetre", 1},    {"millimetres", 1},
        {"um", 1e-3},        {"micron", 1e-3},  {"microns", 1e-3},  {"micrometer", 1e-3}, {"micrometers", 1e-3},
        {"\xc2\xb5m", 1e-3}, {"cm", 10},        {"m", 1e3},         {"nm", 1e-6}};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        if (text_equal(unit, units[i].name)) {
            return units[i].mm;
        }
    }
    return 0;
}

void header_turn_lps(double m[16])
{
    for (int column = 0; column < 4; column++) {
        m[4 * column] = -m[4 * column];
        m[4 * column + 1] = -m[4 * column + 1];
    }
}
