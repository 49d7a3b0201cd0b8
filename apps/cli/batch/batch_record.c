/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the record of a batch into its sidecar, with the hashes that identify its inputs. */
#include "cli/batch/parts.h"

#include "base/system/system.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>

enum { DIGITS = 9 };

/* With its final NUL, so that two texts do not run into each other. */
static void hash_text(struct sha256_ctx *context, const char *text)
{
    sha256_update(context, strlen(text) + 1, (const uint8_t *)text);
}

/* Leaves out what differs between the machines of a cluster and changes no row: where files lie, and which vector
 * instructions the rays engine uses. */
static void forget_machine(json_t *value)
{
    const char *key;
    size_t index;
    json_t *inner;
    json_object_del(value, "path");
    json_object_foreach(value, key, inner)
    {
        forget_machine(inner);
    }
    json_array_foreach(value, index, inner)
    {
        forget_machine(inner);
    }
    if (json_is_string(json_object_get(value, "engine")) &&
        strncmp(json_string_value(json_object_get(value, "engine")), "rays", strlen("rays")) == 0) {
        json_object_set_new(value, "engine", json_string("rays"));
    }
}

static bool hash_settings(struct sha256_ctx *context, const char *sidecar)
{
    json_t *root = json_loads(sidecar, 0, NULL);
    forget_machine(root);
    char *text = root ? json_dumps(root, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(17)) : NULL;
    if (text) {
        hash_text(context, text);
    }
    free(text);
    json_decref(root);
    return text;
}

int batch_fingerprint(char out[65], const char *sidecar, const struct atlases *atlases, const char *const *sources)
{
    struct sha256_ctx context;
    char line[64];
    sha256_init(&context);
    if (!hash_settings(&context, sidecar)) {
        return print_no_memory();
    }
    for (; *sources; sources++) {
        hash_text(&context, *sources);
    }
    for (size_t i = 0; i < atlases->count; i++) {
        const conus_object *object;
        for (size_t number = 1; (object = conus_atlas_object(atlases->items[i].atlas, number)); number++) {
            snprintf(line, sizeof line, "%d %" PRIu32 " %" PRIu32 " %.17g", (int)object->kind, object->label,
                     object->parent, object->volume_mm3);
            hash_text(&context, line);
            hash_text(&context, object->name);
            hash_text(&context, object->abbreviation);
        }
    }
    provenance_hash_finish(out, &context);
    return EXIT_DONE;
}

enum { ODDITIES = 5, ODDITY_NUMBERS = 20, FOUND_NUMBERS = 2 + ODDITIES * ODDITY_NUMBERS };
static const double COUNT_LIMIT = 9e15; /* up to which each whole number is a double */

static conus_pose_finding *finding_at(conus_pose_findings *found, size_t index)
{
    conus_pose_finding *const all[ODDITIES] = {&found->inside, &found->away, &found->tiny, &found->far, &found->apart};
    return all[index];
}

/* What was found as a line of numbers with all their digits. */
static json_t *json_from_found(conus_pose_findings found)
{
    double numbers[FOUND_NUMBERS] = {(double)found.poses, (double)found.points};
    char line[FOUND_NUMBERS * 26];
    int length = 0;
    for (size_t i = 0; i < ODDITIES; i++) {
        const conus_pose_finding *finding = finding_at(&found, i);
        double *out = numbers + 2 + i * ODDITY_NUMBERS;
        out[0] = (double)finding->count;
        out[1] = (double)finding->first;
        out[2] = finding->object;
        out[3] = finding->angle;
        memcpy(out + 4, finding->pose.world_from_device, sizeof finding->pose.world_from_device);
    }
    for (size_t i = 0; i < FOUND_NUMBERS; i++) {
        length += snprintf(line + length, sizeof line - (size_t)length, "%s%.17g", i ? " " : "", numbers[i]);
    }
    return json_string(line);
}

static bool found_from_json(conus_pose_findings *out, const json_t *value)
{
    double numbers[FOUND_NUMBERS];
    const char *text = json_string_value(value);
    for (size_t i = 0; i < FOUND_NUMBERS; i++) {
        char *end = NULL;
        numbers[i] = text ? system_to_double(text, &end) : NAN;
        bool is_count = i < 2 || (i - 2) % ODDITY_NUMBERS < 3;
        bool fits = isfinite(numbers[i]) &&
                    (!is_count || (numbers[i] >= 0 && numbers[i] <= COUNT_LIMIT && floor(numbers[i]) == numbers[i]));
        if (!fits || *end != (i + 1 < FOUND_NUMBERS ? ' ' : '\0')) {
            return false;
        }
        text = end + 1;
    }
    *out = (conus_pose_findings){.poses = (uint64_t)numbers[0], .points = (uint64_t)numbers[1]};
    for (size_t i = 0; i < ODDITIES; i++) {
        conus_pose_finding *finding = finding_at(out, i);
        const double *in = numbers + 2 + i * ODDITY_NUMBERS;
        *finding = (conus_pose_finding){(uint64_t)in[0], (uint64_t)in[1], in[2] <= UINT32_MAX ? (uint32_t)in[2] : 0,
                                        .angle = in[3]};
        memcpy(finding->pose.world_from_device, in + 4, sizeof finding->pose.world_from_device);
    }
    return true;
}

static json_t *json_from_record(const struct batch_record *record)
{
    char crc[16];
    snprintf(crc, sizeof crc, "%08" PRIx32, record->crc);
    json_t *batch =
        json_pack("{s: s, s: [I, I], s: I, s: I, s: I, s: I, s: I, s: s}", "fingerprint", record->fingerprint, "shard",
                  (json_int_t)record->shard.index, (json_int_t)record->shard.count, "first", (json_int_t)record->first,
                  "poses", (json_int_t)record->poses, "errors", (json_int_t)record->errors, "bytes",
                  (json_int_t)record->bytes, "heading", (json_int_t)record->header_size, "crc32", crc);
    size_t length = conus_pose_path_length(record->pose_file);
    const char *words = record->pose_file + length;
    json_t *path = json_stringn(record->pose_file, length);
    json_object_set_new(batch, "pose_file", path ? path : json_null());
    if (*words) {
        json_t *text = json_string(words + 1);
        json_object_set_new(batch, "pose_words", text ? text : json_null());
    }
    json_object_set_new(batch, "pose_file_sha256", *record->pose_hash ? json_string(record->pose_hash) : json_null());
    json_object_set_new(batch, "angle_deg", json_real(record->angle));
    json_object_set_new(batch, "own_angles", json_boolean(record->has_angles));
    json_object_set_new(batch, "points", json_boolean(record->has_points));
    if (record->aimed) {
        json_t *found = json_array();
        for (size_t i = 0; i < record->atlases; i++) {
            json_array_append_new(found, json_from_found(record->aimed[i].found));
        }
        json_object_set_new(batch, "found", found);
    }
    if (record->contacts) {
        json_object_set_new(batch, "contacts", json_integer((json_int_t)record->contacts));
    }
    if (record->has_ranges) {
        json_object_set_new(batch, "own_ranges", json_true());
    }
    if (*record->coordsystem) {
        json_t *system = json_string(record->coordsystem);
        json_object_set_new(batch, "coordsystem_file", system ? system : json_null());
        json_object_set_new(batch, "coordsystem_file_sha256", json_string(record->coordsystem_hash));
    }
    if (record->scalp[0]) {
        json_object_set_new(batch, "head", json_string("own"));
    }
    return batch;
}

int batch_record_write(const char *path, const char *text, const struct batch_record *record, const char *command,
                       const struct question *question)
{
    json_t *root = json_loads(text, 0, NULL);
    json_t *program = json_array_get(json_object_get(root, "GeneratedBy"), 0);
    json_t *words = json_string(command);
    char *whole = NULL;
    json_object_del(root, "Queries");
    if (root && json_object_set_new(root, "Batch", json_from_record(record)) == 0 &&
        json_object_set_new(program, "CommandLine", words ? words : json_null()) == 0 &&
        provenance_put_input(root, record->level_file) && provenance_put_input(root, record->weight_files[0]) &&
        provenance_put_input(root, record->weight_files[1]) && provenance_put_input(root, record->scalp[0]) &&
        provenance_put_input(root, record->scalp[1]) && provenance_put_input(root, record->probe_file) &&
        json_object_set_new(root, "Question", question_json(question)) == 0 && provenance_put_warnings(root) &&
        provenance_seal(root)) {
        char *dumped = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(DIGITS));
        whole = dumped && asprintf(&whole, "%s\n", dumped) >= 0 ? whole : NULL;
        free(dumped);
    }
    json_decref(root);
    if (!whole) {
        return print_data_error("%s: not enough memory", path);
    }
    int code = output_write(path, whole, strlen(whole));
    free(whole);
    return code;
}

static bool read_record(struct batch_record *out, json_t *root)
{
    const char *fingerprint = NULL;
    const char *crc = NULL;
    json_int_t index = 0, count = 0, first = 0, poses = 0, errors = 0, bytes = 0, header_size = 0;
    int failed = json_unpack(root, "{s: {s: s, s: [I, I], s: I, s: I, s: I, s: I, s: I, s: s}}", "Batch", "fingerprint",
                             &fingerprint, "shard", &index, &count, "first", &first, "poses", &poses, "errors", &errors,
                             "bytes", &bytes, "heading", &header_size, "crc32", &crc);
    char *end = NULL;
    unsigned long long checksum = failed ? 0 : strtoull(crc, &end, 16);
    if (failed || strlen(fingerprint) != 64 || *end || checksum > UINT32_MAX || index < 0 || count <= index ||
        first < 0 || poses < 0 || errors < 0 || errors > poses || header_size < 0 || bytes < header_size) {
        return false;
    }
    *out = (struct batch_record){.shard = {(uint64_t)index, (uint64_t)count, false},
                                 .first = (uint64_t)first,
                                 .poses = (uint64_t)poses,
                                 .errors = (uint64_t)errors,
                                 .bytes = (uint64_t)bytes,
                                 .header_size = (uint64_t)header_size,
                                 .crc = (uint32_t)checksum};
    memcpy(out->fingerprint, fingerprint, sizeof out->fingerprint);
    return true;
}

/* Whether nothing was changed since it was written. */
static bool is_sealed(json_t *root)
{
    char sum[SHA256_TEXT];
    const char *given = json_string_value(json_object_get(root, "Checksum"));
    return given && provenance_checksum(sum, root) && strcmp(given, sum) == 0;
}

int batch_record_read(struct batch_record *out, conus_pose_findings *found, size_t atlases, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    int code = input_file_read(&text, &size, path, INPUT_FILE, BATCH_RECORD_LIMIT);
    code = code ? code : batch_record_parse(out, found, atlases, path, text, size);
    free(text);
    return code;
}

int batch_record_parse(struct batch_record *out, conus_pose_findings *found, size_t atlases, const char *path,
                       const char *text, size_t size)
{
    json_error_t error;
    json_t *root = json_loadb(text, size, 0, &error);
    if (!root) {
        return print_data_error("%s: %s", path, error.text);
    }
    const json_t *lines = json_object_get(json_object_get(root, "Batch"), "found");
    bool is_whole = read_record(out, root) && (!found || json_array_size(lines) == atlases);
    for (size_t i = 0; found && i < atlases && is_whole; i++) {
        is_whole = found_from_json(&found[i], json_array_get(lines, i));
    }
    bool is_intact = is_whole && is_sealed(root);
    json_decref(root);
    if (!is_whole) {
        return print_data_error("%s: its \"Batch\" is not that of a part, as conus batch writes it", path);
    }
    return is_intact ? EXIT_DONE : print_data_error("%s: was changed since conus wrote it (Checksum)", path);
}
