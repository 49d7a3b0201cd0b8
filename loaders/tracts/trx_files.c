/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists and reads the files of a TRX. */
#include "loaders/tracts/trx_files.h"

#include "base/buffer.h"
#include "base/memory.h"

#include <string.h>

conus_status trx_files_spend(struct trx_files *files, uint64_t size, const char *what)
{
    if (size > files->left) {
        return fail(CONUS_ERROR_MEMORY, "%s: %llu bytes, allowed are %llu more (--max-memory)", what,
                    (unsigned long long)size, (unsigned long long)files->left);
    }
    files->left -= size;
    return CONUS_OK;
}

conus_status trx_files_of_archive(struct trx_files *out, struct bytes *archive, uint64_t max_memory)
{
    *out = (struct trx_files){.archive = archive, .left = max_memory};
    conus_status status = trx_files_spend(out, archive->size, "archive");
    return status ? status : zip_parse(&out->zip, archive->data, archive->size);
}

static conus_status add_name(struct names *out, const char *in, const char *name)
{
    struct buffer path = {0};
    buffer_format(&path, "%s%s", in, name);
    conus_status status = buffer_status(&path);
    status = status ? status : names_add(out, path.data);
    buffer_finish(&path);
    return status;
}

/* The folders of a TRX's files, behind the one around them. */
static const char *const folders[] = {"", "dps/", "dpv/", "groups/"};

static bool is_folder_or_hidden(const char *name)
{
    bool found = name[0] == '.';
    for (size_t i = 1; i < sizeof folders / sizeof folders[0]; i++) {
        found = found || (strncmp(name, folders[i], strlen(name)) == 0 && strlen(name) + 1 == strlen(folders[i]));
    }
    return found;
}

/* The names in folder/in, which is "" or ends in '/'. */
static conus_status list_in(struct trx_files *out, const char *in)
{
    struct buffer path = {0};
    struct names names = {0};
    buffer_format(&path, "%s/%s", out->folder, in);
    conus_status status = buffer_status(&path);
    status = status ? status : names_list(&names, path.data, "");
    if (!status && names.count >= NAMES_LIMIT) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "%s: %d files or more, a TRX of so many is read as a zip archive only",
                      path.data, NAMES_LIMIT);
    }
    for (size_t i = 0; !status && i < names.count; i++) {
        status = is_folder_or_hidden(names.names[i]) ? CONUS_OK : add_name(&out->names, in, names.names[i]);
    }
    names_finish(&names);
    buffer_finish(&path);
    return status;
}

conus_status trx_files_of_folder(struct trx_files *out, const char *folder, uint64_t max_memory)
{
    *out = (struct trx_files){.folder = folder, .left = max_memory};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < sizeof folders / sizeof folders[0]; i++) {
        status = list_in(out, folders[i]);
    }
    return status;
}

void trx_files_finish(struct trx_files *files)
{
    zip_finish(&files->zip);
    names_finish(&files->names);
    file_sums_finish(&files->read);
    *files = (struct trx_files){0};
}

size_t trx_files_count(const struct trx_files *files)
{
    return files->folder ? files->names.count : files->zip.count;
}

struct text trx_files_name(const struct trx_files *files, size_t index)
{
    return files->folder ? text_from(files->names.names[index]) : files->zip.entries[index].name;
}

static conus_status read_file(struct bytes *out, struct trx_files *files, size_t index)
{
    struct buffer path = {0};
    buffer_format(&path, "%s/%s", files->folder, files->names.names[index]);
    conus_status status = buffer_status(&path);
    status = status ? status : file_read_allowed(out, path.data, files->left);
    status = status ? status : file_sums_add(&files->read, path.data, out);
    buffer_finish(&path);
    return status;
}

conus_status trx_files_open(struct trx_view *out, struct trx_files *files, size_t index)
{
    const struct zip_entry *entry = files->folder ? NULL : &files->zip.entries[index];
    struct bytes owned = {0};
    if (entry && !entry->is_packed) {
        *out = (struct trx_view){.data = files->zip.data + entry->at, .size = entry->stored};
        return zip_verify(&files->zip, entry);
    }
    conus_status status = entry ? zip_unpack(&owned, &files->zip, entry, files->left) : read_file(&owned, files, index);
    files->left -= owned.size;
    *out = (struct trx_view){owned.data, owned.size, owned};
    return status;
}

void trx_files_close(struct trx_view *view, struct trx_files *files)
{
    files->left += view->owned.size;
    bytes_finish(&view->owned);
    *view = (struct trx_view){0};
}

void trx_files_keep(struct bytes *out, size_t *at, struct trx_view *view, struct trx_files *files)
{
    bool is_own = view->owned.data != NULL;
    *at = is_own ? 0 : (size_t)(view->data - files->archive->data);
    *out = is_own ? view->owned : *files->archive;
    if (!is_own) {
        *files->archive = (struct bytes){0};
        zip_finish(&files->zip);
    }
    *view = (struct trx_view){0};
}
