/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares sidecars value by value. */
#include "base/path.h"
#include "base/text.h"
#include "cli/verify/verify.h"
#include "conus/version.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 256, DEPTH = 16, DIGITS = 17 };

struct comparing {
    const struct replay *replay;
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

/* docs/commands.md lists them with the reasons. */
static bool is_free(const struct replay *replay, const char *name)
{
    return name_fits(name, "Checksum") || name_fits(name, "GeneratedBy[].Version") ||
           name_fits(name, "GeneratedBy[].CommandLine") ||
           (name_fits(name, "Batch.fingerprint") &&
            (replay->is_moved || strcmp(replay->record->version, conus_version()) != 0));
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
    if (out->said || is_free(out->replay, name) || numbers_equal(a, b) || engines_equal(name, a, b)) {
        return;
    }
    char *one = json_text(a);
    char *other = json_text(b);
    if (other && out->replay->is_moved) {
        stage_leave(other, out->replay->stage.folder);
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

/* The path that the recorded command line gives an output: its folder, with the name that the file got. */
static json_t *path_asked(const char *asked, const char *written)
{
    char *path = NULL;
    if (output_is_no_file(asked)) {
        return output_is_stdout(asked) ? json_null() : json_string(asked);
    }
    if (asprintf(&path, "%.*s%s", (int)path_folder_length(asked), asked, path_base(written)) < 0) {
        return NULL;
    }
    json_t *text = json_string(path);
    free(path);
    return text;
}

/* Whether a file, of standard output NULL, has the command line and the paths of inputs in it, so that only its option
 * and its path are known. */
static bool has_provenance(const struct option *option, const char *path)
{
    const char *format = "table";
    return option->flags & OPTION_IS_PICTURE ||
           (path && option->role == OPTION_WRITES_ROWS && output_format(&format, path) && format_is(format, "json"));
}

/* The files that were made again lie elsewhere: each path must be the one that was asked for. */
static void compare_outputs(struct comparing *out, json_t *given, const json_t *again)
{
    const struct arguments *arguments = &out->replay->arguments;
    json_t *outputs = json_deep_copy(again);
    size_t index;
    json_t *output;
    json_array_foreach(outputs, index, output)
    {
        const json_t *own = json_array_get(given, index);
        const char *name = json_string_value(json_object_get(output, "option"));
        const char *path = json_string_value(json_object_get(output, "path"));
        const struct option *option = name ? option_find(arguments->command, name) : NULL;
        if (option && has_provenance(option, path)) {
            json_object_set(output, "bytes", json_object_get(own, "bytes"));
            json_object_set(output, "sha256", json_object_get(own, "sha256"));
        }
        if (json_is_null(json_object_get(own, "sha256"))) { /* it went to no file */
            json_object_del(output, "bytes");
            json_object_set_new(output, "sha256", json_null());
        }
        json_t *asked = option ? path_asked(option_text(arguments, name), path ? path : "") : NULL;
        out->failed = !asked || json_object_set_new(output, "path", asked) || out->failed;
    }
    compare_json(out, "Outputs", given, outputs, 0);
    json_decref(outputs);
}

bool sidecars_differ(char **out, const json_t *again, const struct replay *replay)
{
    struct comparing comparing = {.replay = replay};
    const json_t *recorded = replay->record->root;
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)again, key, value)
    {
        (strcmp(key, "Outputs") == 0 && json_object_get(recorded, key)
             ? compare_outputs(&comparing, json_object_get(recorded, key), value)
             : compare_json(&comparing, key, json_object_get(recorded, key), value, 0));
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
