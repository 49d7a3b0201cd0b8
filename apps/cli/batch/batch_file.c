/* SPDX-License-Identifier: BSD-3-Clause */
/* The file of rows: beginning, appending, naming. */
#include "cli/batch/parts.h"

#include "options/messages.h"
#include "options/output.h"

#include <stdio.h>
#include <zlib.h>

enum { CHUNK = 1 << 16 };

int batch_file_begin(struct batch_file *out, const char *path)
{
    *out = (struct batch_file){.path = path, .rows.file = -1};
    return !path || writer_begin(&out->rows, path, 0) ? EXIT_DONE : print_system_error(path, "write");
}

int batch_file_append(struct batch_file *file, const char *text, size_t size)
{
    if (!file->path) {
        return output_write(NULL, text, size);
    }
    if (!writer_append(&file->rows, text, size)) {
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
    return writer_end(&file->rows) ? EXIT_DONE : print_system_error(file->path, "write");
}

void batch_file_close(struct batch_file *file)
{
    writer_drop(&file->rows);
}
