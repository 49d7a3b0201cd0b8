/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the record of a batch back from its sidecar. */
#include "batch/batch_record.h"
#include "options/input_file.h"
#include "options/messages.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

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
        print_error_line("%s: %s", path, error.text);
        return EXIT_DATA;
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
