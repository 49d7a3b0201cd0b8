/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a file, and asks the table of formats what reads it. */
#include "loaders/probe.h"

#include "base/formats/gzip.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/formats/map_choice.h"

#include <string.h>

void probe_close(struct probe *probe)
{
    if (probe->is_open) {
        file_close(&probe->file);
    }
    bytes_finish(&probe->stored);
    memory_free(probe->path);
    *probe = (struct probe){0};
}

/* XML and JSON are read unpacked only. All that begins with '{' goes to the parser of manifests, which says what is
 * wrong with it. */
static conus_status look_at_head(struct probe *probe)
{
    struct bytes unpacked = {0};
    struct text text = text_trim(text_from_bytes(probe->stored.data, probe->stored.size));
    bool packed = gzip_is(probe->stored.data, probe->stored.size);
    conus_status status =
        packed ? gzip_head(&unpacked, probe->stored.data, probe->stored.size, FILE_KIND_HEAD) : CONUS_OK;
    probe->packed = packed && !status;
    probe->first = text.size && !probe->packed ? text.data[0] : '\0';
    const struct file_kind *kind = format_find(probe->path, probe->packed ? &unpacked : &probe->stored);
    bool is_text = kind && (kind->reader == READER_ATLAS_XML || kind->reader == READER_MANIFEST);
    probe->reader = probe->first == '{'                   ? READER_MANIFEST
                    : kind && !(is_text && probe->packed) ? kind->reader
                                                          : READER_VOLUME;
    bytes_finish(&unpacked);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

conus_status probe_open(struct probe *out, const char *path)
{
    struct text map = {0};
    *out = (struct probe){0};
    if (map_choice_split(&out->path, &map, path) == CONUS_ERROR_MEMORY) {
        return CONUS_ERROR_MEMORY;
    }
    if (!out->path || !file_exists(out->path) || file_open(&out->file, out->path)) {
        return CONUS_OK;
    }
    out->is_open = true;
    conus_status status = file_read_open(&out->stored, &out->file, FILE_KIND_HEAD, UINT64_MAX, "");
    status = status ? status : look_at_head(out);
    if (status || (map.size && out->reader != READER_CIFTI)) {
        probe_close(out);
    }
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}

const struct open_file *probe_file(const struct probe *probe)
{
    return probe->is_open ? &probe->file : NULL;
}
