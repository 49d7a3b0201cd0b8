/* SPDX-License-Identifier: BSD-3-Clause */
/* The public ways from files to an atlas. */
#include "atlas/atlas.h"
#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/label_files.h"

/* What a parcellation is made of, until atlas_create() has it. */
struct parts {
    struct volume_file file;
    uint32_t *labels;
    struct label_table table;
    char *source;
    struct notes notes;
};

static void parts_finish(struct parts *parts)
{
    volume_file_finish(&parts->file);
    memory_free(parts->labels);
    label_table_finish(&parts->table);
    memory_free(parts->source);
    notes_finish(&parts->notes);
}

static conus_status read_override(struct parts *parts, const char *path)
{
    const char *format = NULL;
    struct buffer source = {0};
    conus_status status = label_file_read(&parts->table, &format, path, &parts->notes);
    if (!status) {
        buffer_format(&source, "%s in %s", format, path);
        status = buffer_status(&source);
    }
    if (status) {
        buffer_finish(&source);
        return status;
    }
    parts->source = source.data;
    return CONUS_OK;
}

static conus_status load_parts(struct parts *parts, const char *path, const char *labels, uint64_t max_memory)
{
    conus_status status = volume_file_open(&parts->file, path, max_memory, &parts->notes);
    status = status ? status : volume_file_labels(&parts->labels, &parts->file);
    if (status) {
        return status;
    }
    parts->file.info.role = CONUS_PARCELLATION;
    return labels ? read_override(parts, labels)
                  : label_table_of_volume(&parts->table, &parts->source, &parts->file, &parts->notes);
}

conus_status conus_atlas_load(conus_atlas **out, const char *path, const conus_load_options *options)
{
    if (!out || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_load: a result and a path are needed");
    }
    static const conus_load_options defaults;
    options = options ? options : &defaults;
    struct parts parts = {0};
    conus_status status = load_parts(&parts, path, options->labels, options->max_memory);
    if (!status) {
        status = atlas_create(out, &parts.file.info, parts.labels, &parts.table, parts.source, &parts.notes);
    }
    parts_finish(&parts);
    return status;
}
