/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the record of a batch into its sidecar, with the hashes that identify its inputs. */
#include "batch/batch_record.h"

#include "conus/pose_file.h"
#include "conus/version.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <inttypes.h>
#include <jansson.h>
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

static json_t *json_from_record(const struct batch_record *record)
{
    char crc[16];
    snprintf(crc, sizeof crc, "%08" PRIx32, record->crc);
    json_t *batch =
        json_pack("{s: s, s: [I, I], s: I, s: I, s: I, s: I, s: I, s: s}", "fingerprint", record->fingerprint, "shard",
                  (json_int_t)record->shard.index, (json_int_t)record->shard.count, "first", (json_int_t)record->first,
                  "poses", (json_int_t)record->poses, "errors", (json_int_t)record->errors, "bytes",
                  (json_int_t)record->bytes, "heading", (json_int_t)record->header_size, "crc32", crc);
    if (record->pose_file) {
        size_t length = conus_pose_path_length(record->pose_file);
        const char *words = record->pose_file + length;
        json_t *path = json_stringn(record->pose_file, length);
        json_object_set_new(batch, "pose_file", path ? path : json_null());
        if (*words) {
            json_t *text = json_string(words + 1);
            json_object_set_new(batch, "pose_words", text ? text : json_null());
        }
        json_object_set_new(batch, "pose_file_sha256",
                            *record->pose_hash ? json_string(record->pose_hash) : json_null());
        json_object_set_new(batch, "angle_deg", json_real(record->angle));
        json_object_set_new(batch, "own_angles", json_boolean(record->has_angles));
        json_object_set_new(batch, "points", json_boolean(record->has_points));
    }
    if (record->contacts) {
        json_object_set_new(batch, "contacts", json_integer((json_int_t)record->contacts));
    }
    if (record->pose_file && record->has_ranges) {
        json_object_set_new(batch, "own_ranges", json_true());
    }
    if (record->pose_file && *record->coordsystem) {
        json_t *path = json_string(record->coordsystem);
        json_object_set_new(batch, "coordsystem_file", path ? path : json_null());
        json_object_set_new(batch, "coordsystem_file_sha256", json_string(record->coordsystem_hash));
    }
    return batch;
}

/* Puts the record where a record is already, if there is one, and keeps what it does not say. */
static bool set_record(json_t *root, json_t *record)
{
    json_t *batch = json_object_get(root, "Batch");
    bool set = batch ? json_object_update(batch, record) == 0 : json_object_set(root, "Batch", record) == 0;
    json_decref(record);
    return set;
}

/* The program whose command line is given: an entry that has none yet, or a new one. */
static bool set_command(json_t *root, const char *command)
{
    json_t *programs = json_object_get(root, "GeneratedBy");
    json_t *program = json_array_get(programs, json_array_size(programs) - 1);
    if (json_object_get(program, "CommandLine")) {
        program = json_pack("{s: s, s: s}", "Name", "conus", "Version", conus_version());
        json_array_append_new(programs, program);
    }
    json_t *text = json_string(command);
    return json_object_set_new(program, "CommandLine", text ? text : json_null()) == 0;
}

int batch_record_write(const char *path, const char *text, const struct batch_record *record, const char *command,
                       const struct question *question)
{
    json_t *root = json_loads(text, 0, NULL);
    char *whole = NULL;
    json_object_del(root, "Queries");
    json_object_del(root, "Checksum"); /* of a shard */
    if (root && set_record(root, json_from_record(record)) && set_command(root, command) &&
        provenance_put_input(root, record->level_file) && provenance_put_input(root, record->probe_file) &&
        (!question || json_object_set_new(root, "Question", question_json(question)) == 0) &&
        provenance_put_warnings(root) && provenance_seal(root)) {
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
    size_t atlases = json_array_size(json_object_get(root, "Atlases")); /* 0: it has "Atlas", which is one */
    unsigned long checksum = failed ? 0 : strtoul(crc, &end, 16);
    if (failed || strlen(fingerprint) != 64 || *end || index < 0 || count <= index || first < 0 || poses < 0 ||
        errors < 0 || header_size < 0 || bytes < header_size) {
        return false;
    }
    *out = (struct batch_record){.shard = {(uint64_t)index, (uint64_t)count},
                                 .first = (uint64_t)first,
                                 .poses = (uint64_t)poses,
                                 .errors = (uint64_t)errors,
                                 .bytes = (uint64_t)bytes,
                                 .header_size = (uint64_t)header_size,
                                 .atlases = atlases ? atlases : 1,
                                 .crc = (uint32_t)checksum};
    memcpy(out->fingerprint, fingerprint, sizeof out->fingerprint);
    return true;
}

int batch_record_read(struct batch_record *out, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    int code = input_file_read(&text, &size, path, INPUT_FILE, BATCH_RECORD_LIMIT);
    code = code ? code : batch_record_parse(out, path, text, size);
    free(text);
    return code;
}

int batch_record_parse(struct batch_record *out, const char *path, const char *text, size_t size)
{
    json_error_t error;
    json_t *root = json_loadb(text, size, 0, &error);
    if (!root) {
        return print_data_error("%s: %s", path, error.text);
    }
    bool read = read_record(out, root);
    json_decref(root);
    if (!read) {
        print_error_line(
            "%s: has no \"Batch\" with fingerprint, shard, first, poses, errors, bytes, heading and crc32, as "
            "conus batch "
            "writes it",
            path);
    }
    return read ? EXIT_DONE : EXIT_DATA;
}
