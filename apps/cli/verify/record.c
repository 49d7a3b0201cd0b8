/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a sidecar, strictly, and cuts the command line in it into words. */
#include "cli/verify/verify.h"

#include "base/order.h"
#include "options/provenance.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Characters that stand bare in a word; all others are in quotes. */
static bool is_bare(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || (c && strchr("-_=+.,/:@%", c));
}

/* Copies one word from *from to *to. False where its quoting is not ours. */
static bool take_word(char **to, const char **from)
{
    const char *at = *from;
    bool bare = *at != '\'';
    for (; bare && is_bare(*at); at++) {
        *(*to)++ = *at;
    }
    while (!bare && *at == '\'') {
        size_t length = strcspn(at + 1, "'");
        memcpy(*to, at + 1, length);
        *to += length;
        at += 1 + length;
        if (*at != '\'') {
            return false;
        }
        at++;
        if (strncmp(at, "\\''", 3) == 0) { /* 'it'\''s' */
            *(*to)++ = '\'';
            at += 2;
        } else {
            break;
        }
    }
    bool is_word = at > *from && (!*at || *at == ' ');
    *(*to)++ = '\0';
    *from = at;
    return is_word;
}

static const char *cut_words(struct command_line *out, const char *text)
{
    char *to = out->text;
    for (const char *from = text; *from;) {
        if (out->count == COMMAND_WORDS) {
            return "has more than 4096 words";
        }
        out->words[out->count++] = to;
        if (!take_word(&to, &from)) {
            return "is not quoted as conus does it";
        }
        if (*from && !*++from) {
            return "ends with a space";
        }
    }
    return out->count ? NULL : "is empty";
}

const char *command_line_parse(struct command_line *out, const char *text)
{
    size_t size = strlen(text) + 1;
    *out = (struct command_line){.text = malloc(2 * size), .words = calloc(COMMAND_WORDS + 1, sizeof(char *))};
    const char *why = out->text && out->words ? cut_words(out, text) : "does not fit into memory";
    if (why) {
        command_line_finish(out);
    }
    return why;
}

void command_line_finish(struct command_line *line)
{
    free(line->text);
    free((void *)line->words);
    *line = (struct command_line){0};
}

enum { WHY_SIZE = 256, DEPTH = 16, VERSION_LENGTH = 31 };

static _Thread_local char why[WHY_SIZE];

static const char *refuse(const char *format, ...) __attribute__((format(printf, 1, 2)));

static const char *refuse(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(why, sizeof why, format, args);
    va_end(args);
    return why;
}

static bool is_sha256(const char *text)
{
    return strlen(text) == SHA256_TEXT - 1 && strspn(text, "0123456789abcdef") == SHA256_TEXT - 1;
}

static const char *read_file(struct recorded_file *out, const json_t *entry, const char *where)
{
    const json_t *path = json_object_get(entry, "path");
    const json_t *sum = json_object_get(entry, "sha256");
    const json_t *bytes = json_object_get(entry, "bytes");
    *out = (struct recorded_file){.path = json_string_value(path),
                                  .sha256 = json_string_value(sum),
                                  .option = json_string_value(json_object_get(entry, "option")),
                                  .bytes = bytes ? json_integer_value(bytes) : -1,
                                  .crc32 = -1};
    if ((path && !out->path && !json_is_null(path)) || (out->path && !*out->path)) {
        return refuse("%s: path: is no file's", where);
    }
    if (out->sha256 ? !is_sha256(out->sha256) : (sum && !json_is_null(sum))) {
        return refuse("%s: sha256: is not 64 digits of 0 to 9 and a to f", where);
    }
    return bytes && (!json_is_integer(bytes) || out->bytes < 0)
               ? refuse("%s: bytes: is not a whole number from 0", where)
               : NULL;
}

static const char *add_file(struct recorded_file **files, size_t *count, const struct recorded_file *file)
{
    if (*count == RECORD_FILES) {
        return refuse("more than %d files", RECORD_FILES);
    }
    if (!(*count & (*count - 1))) { /* a power of two is full */
        struct recorded_file *more = realloc(*files, (*count ? 2 * *count : 1) * sizeof *more);
        if (!more) {
            return "does not fit into memory";
        }
        *files = more;
    }
    (*files)[(*count)++] = *file;
    return NULL;
}

/* All objects with a path and its checksum, wherever they are. */
static const char *add_inputs(struct record *out, const json_t *value, const char *where, int depth)
{
    const char *key;
    size_t index;
    json_t *inner;
    struct recorded_file file;
    const char *bad = depth == DEPTH ? refuse("%s: too deep", where) : NULL;
    const json_t *pack = json_object_get(value, "pack");
    if (!bad && pack) { /* the files that it was packed from need not be there */
        return add_inputs(out, pack, where, depth + 1);
    }
    if (!bad && json_object_get(value, "path") && json_object_get(value, "sha256")) {
        bad = read_file(&file, value, where);
        bad = bad || !file.path ? bad : add_file(&out->inputs, &out->input_count, &file);
    }
    json_object_foreach((json_t *)value, key, inner)
    {
        bad = bad ? bad : add_inputs(out, inner, where, depth + 1);
    }
    json_array_foreach(value, index, inner)
    {
        bad = bad ? bad : add_inputs(out, inner, where, depth + 1);
    }
    return bad;
}

static int by_path(const void *a, const void *b)
{
    const struct recorded_file *one = a;
    const struct recorded_file *other = b;
    return strcmp(one->path, other->path);
}

static const char *join_equal(struct record *out)
{
    size_t kept = 0;
    order_sort(out->inputs, out->input_count, sizeof *out->inputs, by_path);
    for (size_t i = 0; i < out->input_count; i++) {
        const struct recorded_file *file = &out->inputs[i];
        struct recorded_file *last = kept ? &out->inputs[kept - 1] : NULL;
        if (!last || strcmp(last->path, file->path) != 0) {
            out->inputs[kept++] = *file;
        } else if (last->sha256 && file->sha256 && strcmp(last->sha256, file->sha256) != 0) {
            return refuse("%.100s has two different SHA-256", file->path);
        } else if (!last->sha256) {
            *last = *file;
        }
    }
    out->input_count = kept;
    return NULL;
}

static const char *read_outputs(struct record *out)
{
    const json_t *outputs = json_object_get(out->root, "Outputs");
    const char *bad = outputs && !json_is_array(outputs) ? refuse("Outputs: is no list") : NULL;
    size_t index;
    json_t *entry;
    json_array_foreach(outputs, index, entry)
    {
        struct recorded_file file = {0};
        bad = bad ? bad : read_file(&file, entry, "Outputs");
        bad = bad || file.option ? bad : refuse("Outputs: option: is missing");
        bad = bad ? bad : add_file(&out->outputs, &out->output_count, &file);
    }
    return bad;
}

static const char *add_named(struct record *out, const json_t *batch, const char *path_key, const char *sum_key)
{
    const char *path = json_string_value(json_object_get(batch, path_key));
    const char *sum = json_string_value(json_object_get(batch, sum_key));
    if (!path) {
        return NULL;
    }
    if (!*path || (sum && !is_sha256(sum))) {
        return refuse("Batch: %s or %s is none", path_key, sum_key);
    }
    return add_file(&out->inputs, &out->input_count,
                    &(struct recorded_file){.path = path, .sha256 = sum, .bytes = -1, .crc32 = -1});
}

/* Its rows are known by their length and CRC-32, which a stream has when it ends. */
static const char *read_batch(struct record *out)
{
    json_t *batch = json_object_get(out->root, "Batch");
    json_int_t bytes = 0;
    const char *crc = NULL;
    char *end = NULL;
    json_int_t shard[2] = {0, 1};
    if (!batch) {
        return NULL;
    }
    if (json_unpack(batch, "{s: [I, I], s: I, s: s}", "shard", &shard[0], &shard[1], "bytes", &bytes, "crc32", &crc) ||
        shard[0] < 0 || shard[1] <= shard[0] || bytes < 0 || strlen(crc) != 8 || strspn(crc, "0123456789abcdef") != 8) {
        return refuse("Batch: no shard, bytes and crc32 as conus batch writes them");
    }
    const char *option = json_object_get(out->root, "entry_x")        ? "segments" /* only they have these columns */
                         : json_object_get(out->root, "clearance_mm") ? "clearance"
                                                                      : "output";
    const struct recorded_file rows = {.option = option, .bytes = bytes, .crc32 = (int64_t)strtoul(crc, &end, 16)};
    const char *bad = add_file(&out->outputs, &out->output_count, &rows);
    bad = bad ? bad : add_named(out, batch, "pose_file", "pose_file_sha256");
    return bad ? bad : add_named(out, batch, "coordsystem_file", "coordsystem_file_sha256");
}

/* Digits and dots. */
static bool is_version(const char *text)
{
    size_t length = text ? strspn(text, "0123456789.") : 0;
    return length && length <= VERSION_LENGTH && !text[length];
}

static const char *read_command(struct record *out)
{
    const char *name = NULL;
    const char *command = NULL;
    const json_t *programs = json_object_get(out->root, "GeneratedBy");
    json_t *program = json_array_get(programs, 0);
    if (json_unpack(program, "{s: s, s: s}", "Name", &name, "Version", &out->version) || strcmp(name, "conus") != 0) {
        return refuse("GeneratedBy: does not name conus and its version: not a sidecar of conus");
    }
    if (!is_version(out->version)) {
        return refuse("GeneratedBy: Version: \"%.40s\" is none of conus's, which are digits and dots", out->version);
    }
    if (json_unpack(program, "{s: s}", "CommandLine", &command)) {
        return refuse("GeneratedBy: has no CommandLine: written by the library, its Python package or a page, not by "
                      "the program");
    }
    const char *bad = command_line_parse(&out->line, command);
    return bad ? refuse("GeneratedBy: CommandLine %s", bad) : NULL;
}

static const char *read_all(struct record *out)
{
    static const char *const parts[] = {"Atlas", "Atlases", "Queries", "Inputs"};
    const char *bad = read_command(out);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && !bad; i++) {
        const json_t *part = json_object_get(out->root, parts[i]);
        bad = part ? add_inputs(out, part, parts[i], 0) : NULL;
    }
    bad = bad ? bad : read_outputs(out);
    bad = bad ? bad : read_batch(out);
    bad = bad ? bad : join_equal(out);
    if (bad) {
        return bad;
    }
    char sum[SHA256_TEXT];
    const json_t *seal = json_object_get(out->root, "Checksum");
    const char *given = json_string_value(seal);
    if (!seal) {
        return NULL;
    }
    if (!provenance_checksum(sum, out->root)) {
        return "does not fit into memory";
    }
    out->is_sealed = true;
    out->is_intact = given && strcmp(given, sum) == 0;
    return NULL;
}

const char *record_parse(struct record *out, const char *text, size_t size)
{
    json_error_t error = {.text = "does not fit into memory"};
    *out = (struct record){.root = provenance_parse(text, size, &error)};
    if (!json_is_object(out->root)) {
        record_finish(out);
        return refuse("is no JSON object: %.120s", error.text);
    }
    const char *bad = read_all(out);
    if (bad) {
        record_finish(out);
    }
    return bad;
}

void record_finish(struct record *record)
{
    command_line_finish(&record->line);
    free(record->inputs);
    free(record->outputs);
    json_decref(record->root);
    *record = (struct record){0};
}

static const json_t *atlas_at(const struct record *record, size_t index)
{
    const json_t *several = json_object_get(record->root, "Atlases");
    return several ? json_array_get(several, index) : index ? NULL : json_object_get(record->root, "Atlas");
}

const char *record_atlas(const struct record *record, size_t index)
{
    return json_string_value(json_object_get(atlas_at(record, index), "path"));
}

const char *record_context(const struct record *record)
{
    size_t i;
    const json_t *volume;
    json_array_foreach(json_object_get(atlas_at(record, 0), "volumes"), i, volume)
    {
        const char *role = json_string_value(json_object_get(volume, "role"));
        if (role && strcmp(role, "context") == 0) {
            return json_string_value(json_object_get(volume, "path"));
        }
    }
    return NULL;
}
