/* SPDX-License-Identifier: BSD-3-Clause */
/* The rows' file and its journal: beginning, appending whole blocks, resuming, finishing. */
#include "batch/batch_file.h"

#include "base/system/system.h"
#include "base/text.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { LINE_SIZE = 256, CHUNK = 1 << 13 };

static uint32_t crc_of(const void *data, size_t size)
{
    return (uint32_t)crc32_z(0, data, size);
}

bool batch_file_checksum(const char *path, uint32_t *crc, uint64_t *size)
{
    char chunk[CHUNK];
    FILE *file = input_file_open(path);
    if (!file) {
        return false;
    }
    *crc = 0;
    *size = 0;
    for (size_t n; (n = fread(chunk, 1, sizeof chunk, file)) > 0;) {
        *crc = (uint32_t)crc32_z(*crc, (const unsigned char *)chunk, n);
        *size += n;
    }
    bool whole = !ferror(file) || !print_system_error(path, "read");
    fclose(file);
    return whole;
}

/* The journal: lines of words, the last of which is the CRC-32 of the line before it. */

static bool write_line(const struct batch_file *file, const char *line)
{
    char whole[LINE_SIZE + 16];
    int length = snprintf(whole, sizeof whole, "%s %08" PRIx32 "\n", line, crc_of(line, strlen(line)));
    return system_write(file->log, whole, (size_t)length);
}

/* Reads a line without its CRC; false at the end, and where the line is not what was written. */
static bool read_line(char out[LINE_SIZE], FILE *in)
{
    char *newline = fgets(out, LINE_SIZE, in) ? strchr(out, '\n') : NULL;
    char *space = newline ? strrchr(out, ' ') : NULL;
    char wanted[16];
    if (!space) {
        return false;
    }
    *newline = '\0';
    *space = '\0';
    snprintf(wanted, sizeof wanted, "%08" PRIx32, crc_of(out, strlen(out)));
    return strcmp(space + 1, wanted) == 0;
}

static void write_first_line(char out[LINE_SIZE], const char *fingerprint)
{
    snprintf(out, LINE_SIZE, "conus-batch 1 %s", fingerprint);
}

/* Takes the next word of a line that is cut up on the way; "" if there is none. */
static const char *take_word(char **line)
{
    char *word = text_next(line, " ");
    return word ? word : "";
}

static bool parse_entry(struct batch_entry *out, char *line)
{
    char *end = NULL;
    bool numbers = count_parse(take_word(&line), INT64_MAX, &out->poses) &&
                   count_parse(take_word(&line), INT64_MAX, &out->errors) &&
                   count_parse(take_word(&line), INT64_MAX, &out->size);
    const char *crc = take_word(&line);
    out->crc = (uint32_t)strtoul(crc, &end, 16);
    return numbers && out->errors <= out->poses && end != crc && *end == '\0' && !line;
}

/* Whether the next bytes of the part are those of the entry. */
static bool has_block(FILE *part, const struct batch_entry *entry)
{
    char chunk[CHUNK];
    uint32_t crc = 0;
    uint64_t left = entry->size;
    while (left) {
        size_t n = fread(chunk, 1, left < CHUNK ? (size_t)left : CHUNK, part);
        if (n == 0) {
            return false;
        }
        crc = (uint32_t)crc32_z(crc, (const unsigned char *)chunk, n);
        left -= n;
    }
    return crc == entry->crc;
}

static void count_entry(struct batch_file *file, const struct batch_entry *entry)
{
    file->crc = (uint32_t)crc32_combine(file->crc, entry->crc, (z_off_t)entry->size);
    file->size += entry->size;
    file->poses += entry->poses;
    file->errors += entry->errors;
}

/* Counts the blocks that both files have; gives the journal's length up to there. */
static long count_blocks(struct batch_file *file, FILE *journal, FILE *part)
{
    char line[LINE_SIZE];
    struct batch_entry entry;
    long length = ftell(journal);
    while (read_line(line, journal) && parse_entry(&entry, line) && has_block(part, &entry)) {
        count_entry(file, &entry);
        length = ftell(journal);
    }
    return length;
}

static bool append_entry(struct batch_file *file, const struct batch_entry *entry)
{
    char line[LINE_SIZE];
    snprintf(line, sizeof line, "%" PRIu64 " %" PRIu64 " %" PRIu64 " %08" PRIx32, entry->poses, entry->errors,
             entry->size, entry->crc);
    return write_line(file, line);
}

static void close_files(struct batch_file *file)
{
    if (file->rows >= 0) {
        close(file->rows);
    }
    if (file->log >= 0) {
        close(file->log);
    }
    file->rows = file->log = -1;
}

static int open_own(int *out, const char *path, unsigned how)
{
    struct system_stat info;
    *out = system_open(path, SYSTEM_READ | SYSTEM_WRITE | SYSTEM_MAKE | SYSTEM_AT_ONCE | how);
    if (*out < 0 || !system_stat_open(&info, *out)) {
        return print_system_error(path, "write");
    }
    if (info.kind != SYSTEM_FILE) {
        close(*out);
        *out = -1;
        return print_data_error("%s: cannot write: is a device or pipe, which is no file of a batch", path);
    }
    return EXIT_DONE;
}

static int open_files(struct batch_file *file, unsigned how)
{
    int code = open_own(&file->log, file->journal, 0);
    if (code) {
        return code;
    }
    struct system_stat info; /* without a link where who held the lock before has finished the file since the open() */
    if (!system_lock(file->log) || !system_stat_open(&info, file->log) || !info.links) {
        return print_data_error("%s: another conus is writing this file", file->path);
    }
    return open_own(&file->rows, file->part, how);
}

static int begin_file(struct batch_file *file, const char *fingerprint, const char *header_row)
{
    char line[LINE_SIZE];
    const struct batch_entry entry = {0, 0, strlen(header_row), crc_of(header_row, strlen(header_row))};
    int code = open_files(file, SYSTEM_EMPTY);
    if (code) {
        return code;
    }
    write_first_line(line, fingerprint);
    if (ftruncate(file->log, 0) || !write_line(file, line) ||
        !system_write(file->rows, header_row, strlen(header_row)) || !append_entry(file, &entry)) {
        return print_system_error(file->path, "write");
    }
    count_entry(file, &entry);
    return EXIT_DONE;
}

static int resume_file(struct batch_file *file, const char *fingerprint, const char *header_row)
{
    char line[LINE_SIZE];
    char wanted[LINE_SIZE];
    int code = open_files(file, 0);
    if (code) {
        return code;
    }
    FILE *journal = system_stream(file->journal, "r");
    FILE *part = system_stream(file->part, "r");
    bool whole = journal && part && read_line(line, journal);
    long length = whole ? count_blocks(file, journal, part) : 0;
    if (journal) {
        fclose(journal);
    }
    if (part) {
        fclose(part);
    }
    write_first_line(wanted, fingerprint);
    if (whole && strcmp(line, wanted) != 0) {
        return print_usage_error(
            "%s: its partial file was written with other settings, poses, atlas or version; --force begins anew",
            file->path);
    }
    if (file->size < strlen(header_row) || length == 0) { /* it was killed before its first block */
        close_files(file);
        file->size = 0;
        file->crc = 0;
        return begin_file(file, fingerprint, header_row);
    }
    /* Both files are as they were after the last block that both have. */
    if (ftruncate(file->log, length) || ftruncate(file->rows, (off_t)file->size) || lseek(file->log, 0, SEEK_END) < 0 ||
        lseek(file->rows, 0, SEEK_END) < 0) {
        return print_system_error(file->path, "continue writing");
    }
    return EXIT_DONE;
}

static bool exists(const char *path)
{
    struct system_stat info;
    return system_stat_link(&info, SYSTEM_HERE, path);
}

static bool is_begun(const struct batch_file *file)
{
    return exists(file->journal) && exists(file->part);
}

static bool name_files(struct batch_file *file)
{
    if (asprintf(&file->part, "%s.part", file->path) < 0) {
        file->part = NULL;
    }
    if (asprintf(&file->journal, "%s.journal", file->path) < 0) {
        file->journal = NULL;
    }
    return file->part && file->journal;
}

int batch_file_open(struct batch_file *out, const char *path, const char *fingerprint, const char *header_row,
                    enum batch_start how)
{
    *out = (struct batch_file){.path = path, .rows = -1, .log = -1};
    if (!name_files(out)) {
        return print_no_memory();
    }
    bool begun = is_begun(out);
    if (how == BATCH_RESUME && begun) { /* a file of that name was there before, and was to be replaced */
        return resume_file(out, fingerprint, header_row);
    }
    if (how != BATCH_FORCE && exists(path)) {
        return print_usage_error("%s: there is a file already; --force replaces it", path);
    }
    if (how == BATCH_ANEW && begun) {
        return print_usage_error("%s: an unfinished batch is there; --resume continues it, --force begins anew", path);
    }
    return begin_file(out, fingerprint, header_row);
}

bool batch_file_is_begun(const char *path)
{
    struct batch_file file = {.path = path};
    bool begun = name_files(&file) && is_begun(&file);
    free(file.part);
    free(file.journal);
    return begun;
}

struct batch_entry batch_entry_of(const conus_batch_block *block)
{
    return (struct batch_entry){block->poses, block->errors, block->size, crc_of(block->text, block->size)};
}

int batch_file_append(struct batch_file *file, const conus_batch_block *block)
{
    if (!file->path) {
        int code = output_write(NULL, block->text, block->size);
        file->poses += code ? 0 : block->poses;
        file->errors += code ? 0 : block->errors;
        return code;
    }
    const struct batch_entry entry = batch_entry_of(block);
    if (!system_write(file->rows, block->text, block->size)) {
        return print_system_error(file->path, "write");
    }
    return batch_file_note(file, &entry);
}

int batch_file_note(struct batch_file *file, const struct batch_entry *entry)
{
    if (!append_entry(file, entry)) {
        return print_system_error(file->path, "write");
    }
    count_entry(file, entry);
    return EXIT_DONE;
}

void batch_file_disown(struct batch_file *file)
{
    if (file->log >= 0 && ftruncate(file->log, 0)) {
        print_system_error(file->journal, "write");
    }
}

int batch_file_finish(struct batch_file *file)
{
    if (!system_to_disk(file->rows) || !system_rename(file->part, file->path, true)) {
        return print_system_error(file->path, "write");
    }
    system_remove(file->journal);
    file->is_finished = true;
    return EXIT_DONE;
}

void batch_file_close(struct batch_file *file)
{
    if (file->rows >= 0 && !file->is_finished && !file->poses) { /* nothing to resume */
        system_remove(file->part);
        system_remove(file->journal);
    }
    close_files(file);
    free(file->part);
    free(file->journal);
    *file = (struct batch_file){.rows = -1, .log = -1};
}
