/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries one candidate for a volume's label table. */
#include "loaders/labels/label_search.h"

#include "base/files/file.h"
#include "base/files/folder.h"
#include "loaders/labels/label_bytes.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_rows.h"

#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* Failures that speak about one candidate are kept for later: another may do. */
static conus_status keep_error(struct label_search *search, conus_status status)
{
    if (status == CONUS_ERROR_MEMORY) {
        return status;
    }
    if (search->judge) {
        return notes_warn(search->notes, "%s: passed over", conus_message());
    }
    if (!search->first_error.size) {
        buffer_text(&search->first_error, conus_message());
    }
    return buffer_status(&search->first_error);
}

/* What is no table is worth a word only where a table would stand, and none has been found. */
static conus_status note_unknown(struct label_search *search, const char *name, bool inside)
{
    const char *dot = strrchr(name, '.');
    bool expected = !inside && !(dot && strcasecmp(dot, ".json") == 0); /* BIDS has a .json beside every image */
    return expected && !search->found
               ? notes_warn(search->notes, "%s is not a label table of a known format: passed over", name)
               : CONUS_OK;
}

conus_status label_search_bytes(struct label_search *search, const char *path, const struct bytes *file,
                                struct text text)
{
    struct label_offer offer = {.path = path, .file = file};
    struct label_use use = search->use;
    const char *name = path_base(path);
    const struct label_format *format = label_format_of(text);
    if (!format) {
        return search->judge ? CONUS_OK : note_unknown(search, name, !file);
    }
    if (format == &label_format_colours) { /* X.lut; label_file_colours() is about it */
        return CONUS_OK;
    }
    use.path = path;
    conus_status status = label_text_parse(&offer.table, format, text, &use, &offer.notes);
    if (status) {
        notes_finish(&offer.notes);
        return keep_error(search, fail_in(status, name));
    }
    bool taken = offer.table.count > 0;
    status = taken && search->judge ? search->judge(&taken, search, &offer.table, path) : CONUS_OK;
    if (status || !taken) {
        bool empty = !status && !offer.table.count && !search->found;
        notes_finish(&offer.notes);
        label_table_finish(&offer.table);
        return empty ? notes_warn(search->notes, "%s in %s has no label but 0: passed over", format->name, name)
                     : status;
    }
    buffer_format(&offer.source, "%s %s %s", format->name, file ? "in" : "inside", name);
    return label_search_offer(search, &offer);
}

conus_status label_search_file(struct label_search *search, const char *path)
{
    struct bytes bytes = {0};
    struct stat info;
    uint64_t limit = label_file_limit(search->use.max_memory);
    if (!file_exists(path)) {
        return CONUS_OK;
    }
    if (!stat(path, &info) && (uint64_t)info.st_size > limit) { /* tables of results may be called so */
        return notes_warn(search->notes, "%s: %lld bytes, a label table may have %llu: passed over", path_base(path),
                          (long long)info.st_size, (unsigned long long)limit);
    }
    conus_status status = label_file_bytes(&bytes, path, search->use.max_memory);
    if (status) {
        return keep_error(search, status);
    }
    if (!label_is_lut(bytes.data, bytes.size)) {
        status = label_search_bytes(search, path, &bytes, text_from_bytes(bytes.data, bytes.size));
    }
    bytes_finish(&bytes);
    return status;
}
