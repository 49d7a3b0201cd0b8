/* SPDX-License-Identifier: BSD-3-Clause */
/* Completes sidecars with what was read and written, seals them, and writes reports with them. */
#include "options/provenance.h"

#include "conus/own.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "options/messages.h"
#include "options/output.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { CHUNK = 1 << 13, DIGITS = 9, PACK_HEAD = 4096 };
static const char pack_mark[] = "conus pack";

/* All that conus writes but descriptions of columns, rows, and what was added by others. */
static const char *const sealed[] = {"Space",    "GeneratedBy", "Atlas",      "Atlases", "Settings", "Queries",
                                     "Batch",    "Inputs",      "Outputs",    "Sources", "Question", "Plan",
                                     "Warnings", "Places",      "Understood", "Kept"};

void provenance_hash_finish(char out[SHA256_TEXT], struct sha256_ctx *context)
{
    uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_digest(context, sizeof digest, digest);
    for (size_t i = 0; i < sizeof digest; i++) {
        snprintf(out + 2 * i, 3, "%02x", digest[i]);
    }
}

void provenance_hash(char out[SHA256_TEXT], const char *text, size_t size)
{
    struct sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, size, (const uint8_t *)text);
    provenance_hash_finish(out, &context);
}

int provenance_hash_file(char out[SHA256_TEXT], const char *path)
{
    uint8_t chunk[CHUNK];
    struct sha256_ctx context;
    char plain[4096];
    snprintf(plain, sizeof plain, "%.*s", (int)conus_pose_path_length(path), path);
    FILE *file = input_file_open(plain);
    if (!file) {
        return EXIT_DATA;
    }
    sha256_init(&context);
    size_t head = fread(chunk, 1, PACK_HEAD, file);
    bool is_pack =
        path_ends_in(plain, CONUS_PACK_ENDING) && head == PACK_HEAD && memcmp(chunk, pack_mark, sizeof pack_mark) == 0;
    sha256_update(&context, is_pack ? 0 : head, chunk); /* a pack's head has the sum of all behind it */
    for (size_t n; (n = fread(chunk, 1, sizeof chunk, file)) > 0;) {
        sha256_update(&context, n, chunk);
    }
    bool failed = ferror(file);
    fclose(file);
    if (failed) {
        return print_system_error(path, "read");
    }
    provenance_hash_finish(out, &context);
    return EXIT_DONE;
}

bool provenance_checksum(char out[SHA256_TEXT], const json_t *root)
{
    json_t *part = json_object();
    bool whole = part;
    for (size_t i = 0; i < sizeof sealed / sizeof sealed[0]; i++) {
        json_t *value = json_object_get(root, sealed[i]);
        whole = whole && (!value || json_object_set(part, sealed[i], value) == 0);
    }
    char *text = whole ? json_dumps(part, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(DIGITS)) : NULL;
    if (text) {
        provenance_hash(out, text, strlen(text));
    }
    json_decref(part);
    free(text);
    return text;
}

bool json_put(FILE *out, json_t *root, size_t flags)
{
    bool whole = root && !json_dumpf(root, out, flags) && fputc('\n', out) >= 0;
    json_decref(root);
    return whole;
}

char *provenance_path(const char *output)
{
    bool is_table = path_ends_in(output, ".tsv") || path_ends_in(output, ".csv");
    size_t length = strlen(output) - (is_table ? strlen(".tsv") : 0);
    char *path = NULL;
    return asprintf(&path, "%.*s.json", (int)length, output) < 0 ? NULL : path;
}

void provenance_add_input(struct provenance *provenance, const char *path)
{
    bool is_known = !path || !*path;
    for (size_t i = 0; i < provenance->input_count && !is_known; i++) {
        is_known = strcmp(provenance->inputs[i], path) == 0;
    }
    if (!is_known) {
        assert(provenance->input_count < PROVENANCE_INPUTS);
        provenance->inputs[provenance->input_count++] = path;
    }
}

void provenance_add_output(struct provenance *provenance, const char *option, const char *path, const char *text,
                           size_t size)
{
    if (path || text) {
        assert(provenance->output_count < PROVENANCE_FILES);
        provenance->outputs[provenance->output_count++] = (struct provenance_output){option, path, text, size};
    }
}

void provenance_add_outputs(struct provenance *provenance, const struct arguments *arguments)
{
    const struct option *option;
    for (enum option_role role = OPTION_WRITES; role <= OPTION_WRITES_ROWS; role++) {
        for (size_t i = 0; (option = option_at(arguments->command, i)); i++) {
            if (option->role == role) {
                provenance_add_output(provenance, option->name, option_text(arguments, option->name), NULL, 0);
            }
        }
    }
}

bool provenance_is_sealed(const char *key)
{
    bool is = false;
    for (size_t i = 0; i < sizeof sealed / sizeof sealed[0]; i++) {
        is = is || strcmp(key, sealed[i]) == 0;
    }
    return is;
}

static bool is_file(const char *path, size_t *size)
{
    struct system_stat info;
    bool is = path && !output_is_stdout(path) && system_stat(&info, path) && info.kind == SYSTEM_FILE;
    *size = is ? (size_t)info.size : 0;
    return is;
}

/* Adds "bytes" to every object with a path and its SHA-256. */
static bool add_sizes(json_t *value)
{
    const char *key;
    size_t index;
    size_t size;
    json_t *inner;
    bool whole = true;
    const char *path = json_string_value(json_object_get(value, "path"));
    json_t *pack = json_object_get(value, "pack");
    if (pack) { /* the other files are as they were when it was packed */
        return add_sizes(pack);
    }
    if (path && json_is_string(json_object_get(value, "sha256")) && !json_object_get(value, "bytes") &&
        is_file(path, &size)) {
        whole = json_object_set_new(value, "bytes", json_integer((json_int_t)size)) == 0;
    }
    json_object_foreach(value, key, inner)
    {
        whole = add_sizes(inner) && whole;
    }
    json_array_foreach(value, index, inner)
    {
        whole = add_sizes(inner) && whole;
    }
    return whole;
}

bool provenance_seal(json_t *root)
{
    char checksum[SHA256_TEXT];
    return root && add_sizes(root) && provenance_checksum(checksum, root) &&
           json_object_set_new(root, "Checksum", json_string(checksum)) == 0;
}

json_t *json_from_text(const char *text)
{
    json_t *string = text ? json_string(text) : NULL;
    return string ? string : json_null();
}

static json_t *json_from_output(const struct provenance_output *output)
{
    char sum[SHA256_TEXT] = "";
    size_t size = output->size;
    json_t *path = output_is_stdout(output->path) ? json_null() : json_from_text(output->path);
    if (output->text) {
        provenance_hash(sum, output->text, size);
    } else if (!is_file(output->path, &size) || provenance_hash_file(sum, output->path)) {
        return json_pack("{s: s, s: o, s: n}", "option", output->option, "path", path, "sha256");
    }
    return json_pack("{s: s, s: o, s: I, s: s}", "option", output->option, "path", path, "bytes", (json_int_t)size,
                     "sha256", sum);
}

bool provenance_put_input(json_t *root, const char *path)
{
    json_t *inputs = json_object_get(root, "Inputs");
    if (!inputs) {
        inputs = json_array();
        json_object_set_new(root, "Inputs", inputs);
    }
    if (!path) {
        return true;
    }
    size_t size;
    char sum[SHA256_TEXT];
    bool known = is_file(path, &size) && !provenance_hash_file(sum, path);
    json_t *input =
        known ? json_pack("{s: o, s: I, s: s}", "path", json_from_text(path), "bytes", (json_int_t)size, "sha256", sum)
              : json_pack("{s: o, s: n}", "path", json_from_text(path), "sha256");
    return json_array_append_new(inputs, input) == 0;
}

json_t *question_json(const struct question *question)
{
    json_t *options = json_object();
    for (size_t i = 0; i < question->arguments->use_count; i++) {
        const struct option_use *use = &question->arguments->uses[i];
        bool is_asked = use->option->role == OPTION_PLAIN || use->option->role == OPTION_ASKS;
        json_t *value = use->value ? json_from_text(use->value) : json_true();
        json_t *list = is_asked ? json_object_get(options, use->option->name) : NULL;
        if (is_asked && use->option->type == OPTION_LIST && !list) {
            list = json_array();
            json_object_set_new(options, use->option->name, list);
        }
        if (list) {
            json_array_append(list, value);
        } else if (is_asked) {
            json_object_set(options, use->option->name, value);
        }
        json_decref(value);
    }
    return json_pack("{s: s, s: s, s: s, s: o}", "command", question->arguments->command->name, "rows", question->rows,
                     "region", question->region, "options", options);
}

bool provenance_put_warnings(json_t *root)
{
    json_t *list = json_object_get(root, "Warnings");
    const char *line;
    bool whole = true;
    for (size_t i = 0; (line = warning_line(i)); i++) {
        json_t *text = json_from_text(line);
        bool known = false;
        if (!list) {
            list = json_array();
            whole = json_object_set_new(root, "Warnings", list) == 0;
        }
        for (size_t k = 0; k < json_array_size(list) && !known; k++) {
            known = json_equal(json_array_get(list, k), text);
        }
        whole = (known || json_array_append(list, text) == 0) && whole;
        json_decref(text);
    }
    return whole;
}

/* Standard deviations that are 0 are left out. */
static json_t *json_from_error(const conus_pose_error *error)
{
    const struct {
        const char *key;
        double value;
    } numbers[] = {{"tilt_deg", error->tilt_deg},
                   {"shift_mm", error->shift},
                   {"entry_mm", error->entry},
                   {"target_mm", error->target},
                   {"depth_mm", error->depth}};
    json_t *out =
        json_pack("{s: s, s: s, s: s}", "name", error->name, "measured", error->measured, "source", error->source);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (numbers[i].value > 0) {
            json_object_set_new(out, numbers[i].key, json_real(numbers[i].value));
        }
    }
    return out;
}

static bool add_files(json_t *root, const struct provenance *provenance)
{
    json_t *outputs = json_array();
    bool whole = outputs && provenance_put_input(root, NULL);
    if (provenance->question.arguments) {
        whole = json_object_set_new(root, "Question", question_json(&provenance->question)) == 0 && whole;
    }
    if (provenance->poses) {
        json_t *settings = json_object_get(root, "Settings");
        const conus_pose_facts facts = conus_pose_stream_facts(provenance->poses);
        json_object_set_new(settings, "own_angles", json_boolean(facts.has_angles));
        if (facts.has_ranges) {
            json_object_set_new(settings, "own_ranges", json_true());
        }
    }
    if (provenance->error) {
        whole =
            json_object_set_new(json_object_get(root, "Settings"), "error", json_from_error(provenance->error)) == 0 &&
            whole;
    }
    for (size_t i = 0; i < provenance->input_count; i++) {
        char *plain = text_copy(provenance->inputs[i], conus_pose_path_length(provenance->inputs[i]));
        whole = plain && provenance_put_input(root, plain) && whole;
        free(plain);
    }
    for (size_t i = 0; i < provenance->output_count; i++) {
        whole = json_array_append_new(outputs, json_from_output(&provenance->outputs[i])) == 0 && whole;
    }
    return json_object_set_new(root, "Outputs", outputs) == 0 && provenance_put_warnings(root) && whole;
}

const char *provenance_json_rows(const char *text, size_t size)
{
    static const char mark[] = "\n \"Rows\": [";
    bool is_object = size > 1 && text[0] == '{' && text[1] == '\n'; /* no table begins so, and no NDJSON */
    return is_object ? text_find((struct text){text, size}, mark) : NULL;
}

json_t *provenance_parse(const char *text, size_t size, json_error_t *error)
{
    const char *rows = provenance_json_rows(text, size);
    size_t length = rows ? (size_t)(rows - text) : size;
    char *head = malloc(length + 1);
    json_t *root = NULL;
    if (head) {
        memcpy(head, text, length);
        if (rows) {
            head[length - 1] = '}'; /* in place of the comma before the rows */
        }
        root = json_loadb(head, length, JSON_REJECT_DUPLICATES, error);
    }
    free(head);
    return root;
}

/* An object and what follows it; rows stand in it, in place of its last line. */
static char *join(const char *object, const char *rest, size_t size, bool are_rows)
{
    size_t length = strlen(object) - (are_rows ? 2 : 0);
    char *joined = malloc(length + size + 2);
    if (joined) {
        memcpy(joined, object, length);
        joined[length] = ',';
        memcpy(joined + length + are_rows, rest, size);
        joined[length + are_rows + size] = '\0';
    }
    return joined;
}

json_t *provenance_load(const char *path, uint64_t limit)
{
    char *text = NULL;
    size_t size = 0;
    json_error_t error;
    messages_hold(true);
    int code = input_file_read(&text, &size, path, INPUT_FILE, limit);
    messages_hold(false);
    json_t *root = code ? NULL : provenance_parse(text, size, &error);
    free(text);
    return root;
}

int provenance_write(const char *path, const char *text, size_t size, const struct provenance *provenance)
{
    const char *rows = provenance_json_rows(text, size);
    json_error_t error;
    json_t *root = provenance_parse(text, size, &error);
    bool whole = root && add_files(root, provenance) && provenance_seal(root);
    char *dumped = whole ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(DIGITS)) : NULL;
    json_decref(root);
    char *out = dumped ? join(dumped, rows ? rows : "\n", rows ? size - (size_t)(rows - text) : 1, rows != NULL) : NULL;
    int code = out ? output_write(path, out, strlen(out)) : print_no_memory();
    free(dumped);
    free(out);
    return code;
}

static void add_answer(struct provenance *provenance, const char *path, const char *text, size_t size)
{
    provenance_add_output(provenance, provenance->option ? provenance->option : "output",
                          output_is_stdout(path) ? NULL : path, text, size);
}

int answer_write_sidecar(conus_report *report, const char *path, const char *sidecar,
                         const struct provenance *provenance, const char *text, size_t size)
{
    struct provenance own = *provenance;
    const char *head = NULL;
    size_t length = 0;
    if (!sidecar) {
        return EXIT_DONE;
    }
    add_answer(&own, path, text, size);
    conus_status status = conus_report_sidecar(&head, &length, report);
    return status ? print_status(status) : provenance_write(sidecar, head, length, &own);
}

/* The checksum is of its rows. */
int answer_write_json(const char *path, const struct provenance *provenance, const char *text, size_t size)
{
    struct provenance own = *provenance;
    const char *rows = provenance_json_rows(text, size);
    add_answer(&own, path, rows, size - (size_t)(rows - text));
    return provenance_write(path, text, size, &own);
}

/* The warnings, a line each, and then the text; NULL without memory. */
static char *put_warnings_before(const char *text)
{
    struct system_text joined;
    FILE *out = system_text_open(&joined);
    for (size_t i = 0; out && warning_line(i); i++) {
        fprintf(out, "warning: %s\n%s", warning_line(i), warning_line(i + 1) ? "" : "\n");
    }
    if (out) {
        fputs(text, out);
    }
    return system_text_close(&joined);
}

int answer_write(conus_report *report, const char *path, const char *sidecar, const struct provenance *provenance)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_report_text(&text, &size, report);
    if (status) {
        return print_status(status);
    }
    if (provenance_json_rows(text, size)) {
        return answer_write_json(path, provenance, text, size);
    }
    bool is_seen = output_is_stdout(path) && system_is_terminal(STDOUT_FILENO) && system_is_terminal(STDERR_FILENO);
    char *kept = provenance->is_table && !is_seen ? put_warnings_before(text) : text_copy(text, size);
    if (!kept) { /* the sidecar takes the text's place in the report */
        return print_no_memory();
    }
    size = provenance->is_table ? strlen(kept) : size;
    /* The sidecar is written first, but it is the answer that was asked for, and that a message names. */
    int code = output_is_stdout(path) || system_allows(path, 0) ? EXIT_DONE : output_check_folder(path, SYSTEM_WRITE);
    code = code ? code : answer_write_sidecar(report, path, sidecar, provenance, kept, size);
    code = code ? code : output_write_table(path, kept, size);
    free(kept);
    return code;
}
