/* SPDX-License-Identifier: BSD-3-Clause */
/* A journal and a partial file, as a crash left them: the rows with which a run resumes are in both, whole, and the
 * same the next time. The input is the journal, a zero byte, and the partial file; a line of the journal that ends in "
 * *" gets its CRC. */
#include "batch/batch_file.h"
#include "quiet.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char fingerprint[] = "f 0/1";
static const char header[] = "query\tkind\n";

static char *path_of(const char *ending)
{
    static char folder[] = "/tmp/conus-fuzz-XXXXXX";
    static char path[2][64];
    static int next;
    static bool made;
    if (!made && !mkdtemp(folder)) {
        abort();
    }
    made = true;
    next = !next;
    snprintf(path[next], sizeof path[next], "%s/rows%s", folder, ending);
    return path[next];
}

static void write_line(FILE *out, const char *line, size_t size)
{
    bool open = size > 2 && memcmp(line + size - 2, " *", 2) == 0;
    size -= open ? 2 : 0;
    fwrite(line, 1, size, out);
    if (open) {
        fprintf(out, " %08x", (unsigned)crc32(0, (const unsigned char *)line, (uInt)size));
    }
    fputc('\n', out);
}

static void write_journal(const char *text, size_t size)
{
    FILE *out = fopen(path_of(".journal"), "we");
    while (out && size) {
        const char *end = memchr(text, '\n', size);
        size_t length = end ? (size_t)(end - text) : size;
        write_line(out, text, length);
        length += end != NULL;
        text += length;
        size -= length;
    }
    if (!out || fclose(out)) {
        abort();
    }
}

static void write_part(const void *bytes, size_t size)
{
    FILE *out = fopen(path_of(".part"), "we");
    if (!out || fwrite(bytes, 1, size, out) != size || fclose(out)) {
        abort();
    }
}

/* Resumes the batch. */
static int resume(struct batch_file *out)
{
    static char path[64];
    snprintf(path, sizeof path, "%s", path_of(""));
    FILE *kept = be_quiet();
    int code = batch_file_open(out, path, fingerprint, header, BATCH_RESUME);
    stderr = kept;
    return code;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *zero = size ? memchr(data, 0, size) : NULL;
    size_t journal = zero ? (size_t)(zero - data) : size;
    struct batch_file first;
    struct batch_file again;
    uint32_t crc;
    uint64_t bytes;
    write_journal((const char *)data, journal);
    write_part(zero ? zero + 1 : data, zero ? size - journal - 1 : 0);
    if (resume(&first) == 0) {
        if (!batch_file_checksum(first.part, &crc, &bytes) || crc != first.crc || bytes != first.size ||
            first.size < strlen(header)) {
            abort();
        }
        uint64_t poses = first.poses;
        uint64_t errors = first.errors;
        batch_file_close(&first); /* it removes both if no pose is answered */
        if (poses && (resume(&again) || again.poses != poses || again.errors != errors || again.crc != crc ||
                      again.size != bytes)) {
            abort();
        }
        if (poses) {
            batch_file_close(&again);
        }
    } else {
        batch_file_close(&first);
    }
    unlink(path_of(".journal"));
    unlink(path_of(".part"));
    return 0;
}
