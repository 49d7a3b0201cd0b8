/* SPDX-License-Identifier: BSD-3-Clause */
/* The file of rows: beginning, appending, naming. */
#include "cli/batch/batch_file.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { CHUNK = 1 << 16 };

int batch_file_begin(struct batch_file *out, const char *path)
{
    uint32_t number = 0;
    *out = (struct batch_file){.path = path, .rows = -1};
    if (!path) {
        return EXIT_DONE;
    }
    size_t folder = path_folder_length(path);
    char *here = folder ? text_copy(path, folder) : text_copy(".", 1);
    bool is_random = system_random(&number, sizeof number);
    if (asprintf(&out->temporary, "%s.%08" PRIx32 ".part", path, number) < 0) {
        out->temporary = NULL;
    }
    if (!here || !out->temporary) {
        free(here);
        return print_no_memory();
    }
    out->rows = is_random ? system_open_nameless(here) : -1;
    free(here);
    if (is_random && out->rows < 0) {
        out->rows = system_open(out->temporary, SYSTEM_WRITE | SYSTEM_NEW);
        out->is_named = out->rows >= 0;
    }
    return out->rows >= 0 ? EXIT_DONE : print_system_error(path, "write");
}

int batch_file_append(struct batch_file *file, const char *text, size_t size)
{
    if (!file->path) {
        return output_write(NULL, text, size);
    }
    if (!system_write(file->rows, text, size)) {
        return print_system_error(file->path, "write");
    }
    file->crc = (uint32_t)crc32_z(file->crc, (const unsigned char *)text, size);
    file->size += size;
    return EXIT_DONE;
}

int batch_file_read(uint32_t *crc, uint64_t *size, const char *path, struct batch_file *to, uint64_t from)
{
    char chunk[CHUNK];
    FILE *file = input_file_open(path);
    int code = file ? EXIT_DONE : EXIT_DATA;
    *crc = 0;
    *size = 0;
    for (size_t n; !code && (n = fread(chunk, 1, sizeof chunk, file)) > 0; *size += n) {
        size_t before = *size < from ? (size_t)(from - *size < n ? from - *size : n) : 0;
        *crc = (uint32_t)crc32_z(*crc, (const unsigned char *)chunk, n);
        code = to ? batch_file_append(to, chunk + before, n - before) : EXIT_DONE;
    }
    code = !code && ferror(file) ? print_system_error(path, "read") : code;
    if (file) {
        fclose(file);
    }
    return code;
}

int batch_file_finish(struct batch_file *file)
{
    bool is_done = system_to_disk(file->rows);
    bool is_new = is_done && !file->is_named && system_name(file->rows, file->path);
    if (is_done && !is_new && !file->is_named) { /* by way of another name, in the place of what is there */
        is_done = file->is_named = system_name(file->rows, file->temporary);
    }
    is_done = is_done && (is_new || system_rename(file->temporary, file->path, true));
    if (!is_done) {
        return print_system_error(file->path, "write");
    }
    file->is_named = false;
    return EXIT_DONE;
}

void batch_file_close(struct batch_file *file)
{
    if (file->rows >= 0) {
        close(file->rows);
    }
    if (file->is_named) {
        system_remove(file->temporary);
    }
    free(file->temporary);
    *file = (struct batch_file){.rows = -1};
}
