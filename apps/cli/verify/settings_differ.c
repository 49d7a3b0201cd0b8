/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares sidecars value by value. */
#include "cli/verify/settings_differ.h"

#include "options/output.h"
#include "options/provenance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_SIZE = 256, DEPTH = 16, DIGITS = 17 };

struct comparing {
    const struct sidecar_terms *terms;
    char *said;
    bool failed; /* no memory */
};

/* A name of a value, "Outputs[3].bytes", against a pattern, "Outputs[].bytes". A "*" stands for what comes before. */
static bool name_fits(const char *name, const char *pattern)
{
    size_t length = strlen(name);
    size_t tail = strlen(pattern + 1);
    if (*pattern == '*') {
        return length >= tail && strcmp(name + length - tail, pattern + 1) == 0;
    }
    for (; *name && *pattern; name++, pattern++) {
        if (*name != *pattern) {
            return false;
        }
        name += *name == '[' ? strspn(name + 1, "0123456789") : 0;
    }
    return *name == *pattern;
}

enum freedom {
    FREE,         /* it may say anything */
    FREE_OLDER,   /* of another version of conus, */
    FREE_MISSING, /* where it may be missing, too */
    FREE_ENGINE,  /* of another engine */
    FREE_MOVED,   /* of absolute paths that were found elsewhere */
    FREE_ABSENT,  /* where it is missing: the command line says it, too */
};

/* docs/commands.md lists them with the reasons. */
static const struct {
    const char *name;
    enum freedom freedom;
} free_values[] = {
    {"Checksum", FREE},
    {"GeneratedBy[].Version", FREE}, /* the verdict has a line about it */
    {"GeneratedBy[].CommandLine", FREE},
    {"*.Description", FREE_OLDER},
    {"Batch.fingerprint", FREE_OLDER},
    {"Batch.fingerprint", FREE_ENGINE},
    {"Batch.fingerprint", FREE_MOVED},
    {"Settings.engine", FREE_ENGINE},
    {"Question.options.engine", FREE_ENGINE},
    {"Question", FREE_ABSENT},
    {"Inputs", FREE_MISSING},
    {"Outputs", FREE_MISSING},
    {"*.bytes", FREE_MISSING},
};

static bool is_free(const struct comparing *comparing, const char *name, const json_t *recorded)
{
    const struct sidecar_terms *terms = comparing->terms;
    const bool holds[] = {[FREE] = true,
                          [FREE_OLDER] = terms->older,
                          [FREE_MISSING] = terms->older && !recorded,
                          [FREE_ENGINE] = terms->other_engine,
                          [FREE_MOVED] = terms->root != NULL,
                          [FREE_ABSENT] = !recorded};
    for (size_t i = 0; i < sizeof free_values / sizeof free_values[0]; i++) {
        if (holds[free_values[i].freedom] && name_fits(name, free_values[i].name)) {
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

static char *text_of(const json_t *value)
{
    return value ? json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(DIGITS)) : strdup("missing");
}

/* Takes `root` out of the text wherever it stands. */
static void take_out(char *text, const char *root)
{
    size_t length = strlen(root);
    for (char *at = text; length && (at = strstr(at, root));) {
        memmove(at, at + length, strlen(at + length) + 1);
    }
}

static bool numbers_equal(const json_t *a, const json_t *b)
{
    return json_is_number(a) && json_is_number(b) && !(json_is_integer(a) && json_is_integer(b)) &&
           json_number_value(a) == json_number_value(b);
}

/* "rays, avx512" and "rays, sse2" are one engine, which gives the same rows by the instructions that there are. */
static bool engines_equal(const char *name, const json_t *a, const json_t *b)
{
    const char *one = json_string_value(a);
    const char *other = json_string_value(b);
    size_t length = one ? strcspn(one, ",") : 0;
    return strcmp(name, "Settings.engine") == 0 && length && other && strcspn(other, ",") == length &&
           memcmp(one, other, length) == 0;
}

/* Values that are no objects or lists, or of which one is. */
static void compare_values(struct comparing *out, const char *name, const json_t *a, const json_t *b)
{
    if (out->said || is_free(out, name, a) || numbers_equal(a, b) || engines_equal(name, a, b)) {
        return;
    }
    char *one = text_of(a);
    char *other = text_of(b);
    if (other && out->terms->root) {
        take_out(other, out->terms->root);
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

static void compare(struct comparing *out, const char *name, json_t *a, json_t *b, int depth)
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
        compare(out, own, json_object_get(a, key), value, depth + 1);
    }
    json_object_foreach(a, key, value)
    {
        snprintf(own, sizeof own, "%s.%s", name, key);
        if (!open && !json_object_get(b, key)) {
            compare_values(out, own, value, NULL);
        }
    }
    for (size_t i = 0; json_is_array(a) && (i < json_array_size(a) || i < json_array_size(b)); i++) {
        snprintf(own, sizeof own, "%s[%zu]", name, i);
        compare(out, own, json_array_get(a, i), json_array_get(b, i), depth + 1);
    }
}

/* Of what was merged, the command that joined it comes behind the one that is asked again. */
static void compare_programs(struct comparing *out, const json_t *recorded, const json_t *again)
{
    static const char merge[] = "conus merge ";
    json_t *programs = json_deep_copy(json_object_get(recorded, "GeneratedBy"));
    json_t *last = json_array_get(programs, 1);
    const char *line = json_string_value(json_object_get(last, "CommandLine"));
    const char *name = json_string_value(json_object_get(last, "Name"));
    out->failed = out->failed || !programs;
    if (line && strncmp(line, merge, sizeof merge - 1) == 0 && name && strcmp(name, "conus") == 0 &&
        json_is_string(json_object_get(last, "Version")) && json_object_size(last) == 3 &&
        json_object_get(recorded, "Batch")) {
        json_array_remove(programs, 1);
    }
    compare(out, "GeneratedBy", programs, json_object_get(again, "GeneratedBy"), 0);
    json_decref(programs);
}

/* The path that the recorded command line gives for the output of `option`; null of standard output. */
static json_t *path_of(const struct arguments *arguments, const char *option)
{
    const char *path = option_text(arguments, option);
    return output_is_stdout(path) ? json_null() : json_string(path);
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
        json_t *path = option && out->terms->arguments ? path_of(out->terms->arguments, option) : NULL;
        out->failed = (path && json_object_set_new(output, "path", path)) || out->failed;
        if (is_picture(out, output) && is_picture(out, own)) {
            json_object_set(output, "bytes", json_object_get(own, "bytes"));
            json_object_set(output, "sha256", json_object_get(own, "sha256"));
        }
    }
    compare(out, "Outputs", given, outputs, 0);
    json_decref(outputs);
}

bool sidecars_differ(char **out, const json_t *recorded, const json_t *again, const struct sidecar_terms *terms)
{
    struct comparing comparing = {.terms = terms};
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)again, key, value)
    {
        if (strcmp(key, "GeneratedBy") == 0) {
            compare_programs(&comparing, recorded, again);
        } else if (strcmp(key, "Outputs") == 0) {
            compare_outputs(&comparing, recorded, again);
        } else {
            compare(&comparing, key, json_object_get(recorded, key), value, 0);
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
