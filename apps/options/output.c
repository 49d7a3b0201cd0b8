/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes to stdout or files, and compares paths. */
#include "options/output.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/options.h"

#include <errno.h>
#include <nettle/base64.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool output_is_stdout(const char *path)
{
    return !path || strcmp(path, "-") == 0;
}

/* Whoever closed the pipe, `head` for example, has read enough: only the exit code says so. */
static int print_stdout_error(int error)
{
    if (error != EPIPE) {
        print_error_line("standard output: cannot write: %s", text_error(error));
    }
    return EXIT_DATA;
}

int output_write(const char *path, const char *text, size_t size)
{
    if (!output_is_stdout(path)) {
        return print_status(conus_write_file(path, text, size));
    }
    if (fwrite(text, 1, size, stdout) != size || fflush(stdout)) {
        int error = system_stream_error();
        clearerr(stdout);
        return print_stdout_error(error);
    }
    return EXIT_DONE;
}

static int write_fitted(const char *text, size_t size, const char *whole)
{
    if (!system_is_terminal(STDOUT_FILENO)) {
        return output_write(NULL, text, size);
    }
    char *fitted = table_fit(text, terminal_width(STDOUT_FILENO), terminal_has_colour(STDOUT_FILENO), whole);
    if (!fitted) {
        return print_no_memory();
    }
    int code = output_write(NULL, fitted, strlen(fitted));
    free(fitted);
    return code;
}

int output_write_table(const char *path, const char *text, size_t size)
{
    return output_is_stdout(path) ? write_fitted(text, size, "-o FILE or --format tsv has all")
                                  : output_write(path, text, size);
}

/* Closes and frees a text, which goes to stdout if it is whole. */
static int end_text(struct system_text *text, bool whole, bool is_table)
{
    int code = EXIT_DATA;
    if (system_text_close(text) && whole) {
        conus_plain_text(text->data);
        size_t size = strlen(text->data);
        code = is_table ? write_fitted(text->data, size, "--format tsv has all") : output_write(NULL, text->data, size);
    } else {
        print_error_line("not enough memory");
    }
    free(text->data);
    return code;
}

int output_put(bool put(FILE *out, const void *what), const void *what)
{
    struct system_text text;
    bool whole = system_text_open(&text) && put(text.stream, what);
    return end_text(&text, whole, true);
}

int output_end(struct system_text *text)
{
    return end_text(text, true, false);
}

void html_put(FILE *out, const char *text, size_t size)
{
    for (const char *end = text + size; text < end; text++) {
        const char *mark = *text == '<' ? "&lt;" : *text == '&' ? "&amp;" : *text == '"' ? "&quot;" : NULL;
        if (mark) {
            fputs(mark, out);
        } else {
            fputc(*text, out);
        }
    }
}

int base64_put(FILE *out, const char *path)
{
    unsigned char piece[3 << 14]; /* of a multiple of 3 bytes, so that only the last is padded */
    char digits[BASE64_ENCODE_RAW_LENGTH(sizeof piece)];
    FILE *in = system_stream(path, "r");
    if (!in) {
        return print_data_error("%s: %s", path, text_error(errno));
    }
    for (size_t size; (size = fread(piece, 1, sizeof piece, in));) {
        base64_encode_raw(digits, size, piece);
        fwrite(digits, 1, BASE64_ENCODE_RAW_LENGTH(size), out);
    }
    bool failed = ferror(in);
    fclose(in);
    return failed ? print_data_error("%s: cannot be read", path) : EXIT_DONE;
}

int output_finish(int code)
{
    if (code != EXIT_DONE && code != EXIT_DIFFERENT) {
        return code;
    }
    bool failed = ferror(stdout);
    if (fflush(stdout) || failed) {
        return print_stdout_error(failed ? EIO : system_stream_error());
    }
    return code;
}

int output_check_file(const char *path)
{
    struct system_stat info;
    if (!system_stat_link(&info, path) || info.kind == SYSTEM_FILE) {
        return EXIT_DONE;
    }
    return print_data_error("%s: cannot write: is a %s, which a file would replace", path,
                            info.kind == SYSTEM_FOLDER ? "folder"
                            : info.kind == SYSTEM_LINK ? "link"
                                                       : "device or pipe");
}

const char *path_name(const char *path)
{
    const char *name = path_base(path);
    return *name ? name : path;
}

bool path_is_picture(const char *path)
{
    return path_ends_in(path, ".exr") || path_ends_in(path, ".png");
}

bool output_is_no_file(const char *path)
{
    struct system_stat info;
    return output_is_stdout(path) || (system_stat(&info, path) && info.kind != SYSTEM_FILE);
}

bool output_format(const char **out, const char *path)
{
    static const struct {
        const char *ending;
        const char *format;
    } endings[] = {{".tsv", "tsv"},       {".csv", "csv"},      {".json", "json"},
                   {".ndjson", "ndjson"}, {".jsonl", "ndjson"}, {".txt", "table"}};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends_in(path, endings[i].ending)) {
            *out = endings[i].format;
            return true;
        }
    }
    return false;
}

bool format_is(const char *format, const char *name)
{
    return strcmp(format ? format : "table", name) == 0;
}

const conus_format_info *format_of(const char *name)
{
    size_t place = 0;
    while (!format_is(name, conus_format_at(place)->name)) {
        place++;
    }
    return conus_format_at(place);
}

static char *folder_of(const char *path)
{
    size_t length = path_folder_length(path);
    return length ? text_copy(path, length) : text_copy(".", 1);
}

/* Where a path leads. Equal ones are one regular file, be it there already or not yet. */
struct place {
    uint64_t device, inode; /* the file's, else those of the folder that it would be in, else 0 */
    const char *name;       /* "" of a file, else its name in that folder, else all of the path; within the path */
};

/* False where the path leads to a device, a pipe or a folder. */
static bool find_place(struct place *out, const char *path)
{
    struct system_stat info;
    *out = (struct place){.name = path};
    if (system_stat(&info, path)) {
        out->name = "";
        out->device = info.device;
        out->inode = info.inode;
        return info.kind == SYSTEM_FILE;
    }
    char *folder = folder_of(path); /* a new file: its folder, and its name there */
    if (folder && system_stat(&info, folder)) {
        *out = (struct place){info.device, info.inode, path_base(path)};
    }
    free(folder);
    return true;
}

bool paths_equal(const char *a, const char *b)
{
    struct place one;
    struct place other;
    return find_place(&one, a) && find_place(&other, b) && one.device == other.device && one.inode == other.inode &&
           system_name_order(one.name, other.name) == 0;
}

int output_check_folder(const char *path, unsigned how)
{
    char *folder = folder_of(path);
    if (!folder) {
        return print_no_memory();
    }
    int code = !system_allows(folder, how) ? print_system_error(path, "write") : EXIT_DONE;
    free(folder);
    return code;
}
