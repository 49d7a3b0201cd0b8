/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares texts line by line, and lines of tables cell by cell. */
#include "cli/verify/differ.h"

#include "base/system/system.h"
#include "base/text.h"
#include "cli/verify/record.h"
#include "cli/verify/replay.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN = 80 /* bytes of a line without cells */ };

/* A part of a text; NULL behind its end. */
struct piece {
    const char *at;
    size_t size;
};

static struct piece next_line(const char **at, const char *end)
{
    const char *from = *at;
    if (from == end) {
        return (struct piece){0};
    }
    const char *stop = memchr(from, '\n', (size_t)(end - from));
    *at = stop ? stop + 1 : end;
    return (struct piece){from, (size_t)((stop ? stop : end) - from)};
}

/* The line ends count: a last line without one is another line. */
static bool pieces_equal(struct piece a, struct piece b)
{
    return a.at && b.at && a.size == b.size && memcmp(a.at, b.at, a.size) == 0;
}

/* The separator behind the cell; one of a CSV may have commas in quotation marks. NULL at the line's end. */
static const char *cell_end(const char *at, const char *end, char separator)
{
    bool quoted = false;
    for (; at < end && (quoted || *at != separator); at++) {
        quoted = quoted != (separator == ',' && *at == '"');
    }
    return at < end ? at : NULL;
}

static struct piece cell_at(struct piece line, char separator, size_t index)
{
    const char *end = line.at + line.size;
    const char *at = line.at;
    for (;; index--) {
        const char *stop = cell_end(at, end, separator);
        if (!index) {
            return (struct piece){at, (size_t)((stop ? stop : end) - at)};
        }
        if (!stop) {
            return (struct piece){0};
        }
        at = stop + 1;
    }
}

static char *text_of(struct piece piece, size_t limit)
{
    return piece.at ? text_copy(piece.at, piece.size < limit ? piece.size : limit) : NULL;
}

/* Appends the cell of the column `name`, if there is one that says something. */
static void put_cell(FILE *out, struct piece header, struct piece line, char separator, const char *name,
                     const char *before)
{
    struct piece column;
    for (size_t i = 0; (column = cell_at(header, separator, i)).at; i++) {
        struct piece found = cell_at(line, separator, i);
        if (column.size == strlen(name) && memcmp(column.at, name, column.size) == 0 && found.at) {
            fprintf(out, "%s%.*s", before, (int)found.size, found.at);
        }
    }
}

/* Names the row and the first cell that differs. False where no cell of this table does. */
static bool find_cell(struct difference *out, struct piece header, struct piece a, struct piece b, char separator)
{
    size_t i = 0;
    struct piece column;
    struct piece one = {0};
    struct piece other = {0};
    for (; (column = cell_at(header, separator, i)).at; i++) {
        one = cell_at(a, separator, i);
        other = cell_at(b, separator, i);
        if (!pieces_equal(one, other)) {
            break;
        }
    }
    if (!column.at || !one.at || !other.at) {
        return false;
    }
    struct system_text text;
    FILE *where = system_text_open(&text);
    if (where) {
        put_cell(where, header, a, separator, "query", "query ");
        put_cell(where, header, a, separator, "row", ", row ");
        put_cell(where, header, a, separator, "atlas", ", ");
        put_cell(where, header, a, separator, "name", ", ");
        fprintf(where, ": %.*s", (int)column.size, column.at);
    }
    out->where = system_text_close(&text);
    out->before = text_of(one, one.size);
    out->after = text_of(other, other.size);
    return out->where && out->before && out->after;
}

static bool list_difference(struct differences *out, struct piece header, struct piece a, struct piece b, size_t line)
{
    char separator = header.at && memchr(header.at, '\t', header.size) ? '\t' : ',';
    bool is_table = header.at && memchr(header.at, separator, header.size) && header.at[0] != '{';
    struct difference *item = &out->items[out->listed++];
    item->line = line;
    if (is_table && a.at && b.at && find_cell(item, header, a, b, separator)) {
        return true;
    }
    free(item->where);
    free(item->before);
    free(item->after);
    item->where = strdup("");
    item->before = text_of(a, SHOWN);
    item->after = text_of(b, SHOWN);
    return item->where && (!a.at || item->before) && (!b.at || item->after);
}

static size_t count_of(struct piece line, char wanted)
{
    size_t count = 0;
    for (size_t i = 0; i < line.size; i++) {
        count += line.at[i] == wanted;
    }
    return count;
}

bool differences_find(struct differences *out, const char *before, size_t before_size, const char *after,
                      size_t after_size, size_t first_line)
{
    const char *a_at = before;
    const char *b_at = after;
    struct piece header = {0};
    bool whole = true;
    *out = (struct differences){0};
    for (size_t line = first_line; whole; line++) {
        struct piece a = next_line(&a_at, before + before_size);
        struct piece b = next_line(&b_at, after + after_size);
        if (!a.at && !b.at) {
            break;
        }
        if (out->lines++ == 0) {
            // Lines of as many cells can both be headers of one table.
            header = (count_of(a, '\t') == count_of(b, '\t') && count_of(a, ',') == count_of(b, ',')) ? b : header;
        }
        if (!pieces_equal(a, b)) {
            out->count++;
            whole = out->listed == DIFFERENCES || list_difference(out, header, a, b, line);
        }
    }
    bool same = before_size == after_size && memcmp(before, after, before_size) == 0;
    if (whole && !same && !out->count) { /* the last line has no end in one of them */
        static const char *const ends[] = {"no line end", "a line end"};
        out->count = 1;
        out->listed = 1;
        out->items[0] = (struct difference){.line = first_line + out->lines - 1,
                                            .where = strdup(""),
                                            .before = strdup(ends[before_size > after_size]),
                                            .after = strdup(ends[after_size > before_size])};
        whole = out->items[0].where && out->items[0].before && out->items[0].after;
    }
    return whole;
}

void differences_finish(struct differences *differences)
{
    for (size_t i = 0; i < differences->listed; i++) {
        free(differences->items[i].where);
        free(differences->items[i].before);
        free(differences->items[i].after);
    }
    *differences = (struct differences){0};
}

enum { NAME_SIZE = 256, DEPTH = 16, DIGITS = 17 };

struct comparing {
    const struct sidecar_terms *terms;
    char *said;
    bool failed; /* no memory */
};

/* A name of a value, "Outputs[3].bytes", against a pattern, "Outputs[].bytes". */
static bool name_fits(const char *name, const char *pattern)
{
    for (; *name && *pattern; name++, pattern++) {
        if (*name != *pattern) {
            return false;
        }
        name += *name == '[' ? strspn(name + 1, "0123456789") : 0;
    }
    return *name == *pattern;
}

/* When a value may differ. */
enum freedom {
    FREE = 1 << 0,        /* always */
    FREE_OLDER = 1 << 1,  /* in a record of another version of conus */
    FREE_ENGINE = 1 << 2, /* of another engine */
    FREE_MOVED = 1 << 3,  /* of absolute paths that were found elsewhere */
    FREE_ABSENT = 1 << 4, /* where it is missing: the command line says it, too */
};

/* docs/commands.md lists them with the reasons. */
static const struct {
    const char *name;
    unsigned freedom; /* enum freedom */
} free_values[] = {
    {"Checksum", FREE},
    {"Warnings", FREE}, /* words of this version; what they are about is in the rows */
    {"Warnings[]", FREE},
    {"GeneratedBy[].Version", FREE}, /* the verdict has a line about it */
    {"GeneratedBy[].CommandLine", FREE},
    {"Batch.fingerprint", FREE_OLDER | FREE_ENGINE | FREE_MOVED},
    {"Settings.engine", FREE_ENGINE},
    {"Question.options.engine", FREE_ENGINE},
    {"Question", FREE_ABSENT},
};

static bool is_free(const struct comparing *comparing, const char *name, const json_t *recorded)
{
    const struct sidecar_terms *terms = comparing->terms;
    const unsigned holds = FREE | (terms->older ? FREE_OLDER : 0) | (terms->other_engine ? FREE_ENGINE : 0) |
                           (terms->folder ? FREE_MOVED : 0) | (!recorded ? FREE_ABSENT : 0);
    for (size_t i = 0; i < sizeof free_values / sizeof free_values[0]; i++) {
        if (holds & free_values[i].freedom && name_fits(name, free_values[i].name)) {
            return true;
        }
    }
    return false;
}

/* Pictures have the command line in them, so that only the option and the path of one are known. */
static bool is_picture(const struct comparing *comparing, const json_t *output)
{
    const char *name = json_string_value(json_object_get(output, "option"));
    const struct arguments *arguments = comparing->terms->arguments;
    const struct option *option = name && arguments ? option_find(arguments->command, name) : NULL;
    return option && option->flags & OPTION_IS_PICTURE;
}

static char *json_text(const json_t *value)
{
    return value ? json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(DIGITS)) : strdup("missing");
}

static bool numbers_equal(const json_t *a, const json_t *b)
{
    return json_is_number(a) && json_is_number(b) && !(json_is_integer(a) && json_is_integer(b)) &&
           json_number_value(a) == json_number_value(b);
}

/* Whether instructions of a processor, "avx512", stand behind "rays"; a driver may call itself anything. */
static bool are_instructions(const char *engine, const char *behind)
{
    static const char *const known[] = {", avx512", ", avx2", ", sse2", ", vector", ", scalar"};
    bool found = strncmp(engine, "rays,", 5) != 0;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        found = found || strcmp(behind, known[i]) == 0;
    }
    return found;
}

/* "rays, avx512" and "rays, sse2" are one engine, which gives the same rows by the instructions that there are. */
static bool engines_equal(const char *name, const json_t *a, const json_t *b)
{
    const char *one = json_string_value(a);
    const char *other = json_string_value(b);
    size_t length = one ? strcspn(one, ",") : 0;
    return strcmp(name, "Settings.engine") == 0 && length && other && strcspn(other, ",") == length &&
           memcmp(one, other, length) == 0 && are_instructions(one, one + length);
}

/* Compares values where at least one is neither an object nor a list. */
static void compare_values(struct comparing *out, const char *name, const json_t *a, const json_t *b)
{
    if (out->said || is_free(out, name, a) || numbers_equal(a, b) || engines_equal(name, a, b)) {
        return;
    }
    char *one = json_text(a);
    char *other = json_text(b);
    if (other && out->terms->folder) {
        stage_leave(other, out->terms->folder);
    }
    if (one && other && strcmp(one, other) != 0 &&
        asprintf(&out->said, "%s is %.60s there, and %.60s when it is answered again", name, one, other) < 0) {
        out->said = NULL;
        out->failed = true;
    }
    out->failed = out->failed || !one || !other;
    free(one);
    free(other);
}

static void compare_json(struct comparing *out, const char *name, json_t *a, json_t *b, int depth)
{
    char own[NAME_SIZE];
    const char *key;
    json_t *value;
    bool open = json_is_string(json_object_get(b, "Description")); /* a column, to which others may add */
    if (out->said || !a || !b || depth == DEPTH || json_typeof(a) != json_typeof(b) ||
        !(json_is_object(a) || json_is_array(a))) {
        compare_values(out, name, a, b);
        return;
    }
    json_object_foreach(b, key, value)
    {
        snprintf(own, sizeof own, "%s.%s", name, key);
        compare_json(out, own, json_object_get(a, key), value, depth + 1);
    }
    json_object_foreach(a, key, value)
    {
        snprintf(own, sizeof own, "%s.%s", name, key);
        bool is_own = strcmp(key, "Units") == 0 || strcmp(key, "Levels") == 0; /* BIDS's words, which conus uses */
        if ((!open || is_own) && !json_object_get(b, key)) {
            compare_values(out, own, value, NULL);
        }
    }
    for (size_t i = 0; json_is_array(a) && (i < json_array_size(a) || i < json_array_size(b)); i++) {
        snprintf(own, sizeof own, "%s[%zu]", name, i);
        compare_json(out, own, json_array_get(a, i), json_array_get(b, i), depth + 1);
    }
}

/* The files that were made again lie elsewhere: each path must be the one that was asked for. */
static void compare_outputs(struct comparing *out, const json_t *recorded, const json_t *again)
{
    json_t *outputs = json_deep_copy(json_object_get(again, "Outputs"));
    json_t *given = json_object_get(recorded, "Outputs");
    size_t index;
    json_t *output;
    json_array_foreach(outputs, index, output)
    {
        const json_t *own = json_array_get(given, index);
        const char *option = json_string_value(json_object_get(output, "option"));
        json_t *path = NULL; /* that the recorded command line gives; null of standard output */
        if (option && out->terms->arguments) {
            const char *asked = option_text(out->terms->arguments, option);
            path = output_is_stdout(asked) ? json_null() : json_string(asked);
        }
        out->failed = (path && json_object_set_new(output, "path", path)) || out->failed;
        if (is_picture(out, output) && is_picture(out, own)) {
            json_object_set(output, "bytes", json_object_get(own, "bytes"));
            json_object_set(output, "sha256", json_object_get(own, "sha256"));
        }
    }
    compare_json(out, "Outputs", given, outputs, 0);
    json_decref(outputs);
}

bool sidecars_differ(char **out, const json_t *recorded, const json_t *again, const struct sidecar_terms *terms)
{
    struct comparing comparing = {.terms = terms};
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)again, key, value)
    {
        if (strcmp(key, "Outputs") == 0) {
            compare_outputs(&comparing, recorded, again);
        } else {
            compare_json(&comparing, key, json_object_get(recorded, key), value, 0);
        }
    }
    json_object_foreach((json_t *)recorded, key, value)
    {
        if (provenance_is_sealed(key) && !json_object_get(again, key)) {
            compare_values(&comparing, key, value, NULL);
        }
    }
    if (comparing.failed) {
        free(comparing.said);
        return false;
    }
    *out = comparing.said;
    return true;
}
