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
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool output_is_stdout(const char *path)
{
    return !path || strcmp(path, "-") == 0;
}

/* Whoever closed the pipe, `head` for example, has what it wants: only the exit code says so. */
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

bool output_format(conus_format *out, const char *path)
{
    static const struct {
        const char *ending;
        conus_format format;
    } endings[] = {{".tsv", CONUS_FORMAT_TSV},       {".csv", CONUS_FORMAT_CSV},      {".json", CONUS_FORMAT_JSON},
                   {".ndjson", CONUS_FORMAT_NDJSON}, {".jsonl", CONUS_FORMAT_NDJSON}, {".txt", CONUS_FORMAT_TABLE}};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends_in(path, endings[i].ending)) {
            *out = endings[i].format;
            return true;
        }
    }
    return false;
}

bool format_is_foreign(conus_format format)
{
    return conus_format_at(format)->is_foreign;
}

bool format_is_of_probe(conus_format format)
{
    return conus_format_at(format)->is_of_probe;
}

static char *folder_of(const char *path)
{
    size_t length = path_folder_length(path);
    return length ? text_copy(path, length) : text_copy(".", 1);
}

bool path_find_place(struct path_place *out, const char *path)
{
    struct system_stat info;
    *out = (struct path_place){.name = path};
    if (system_stat(&info, path)) {
        if (info.kind != SYSTEM_FILE) {
            return false;
        }
        out->name = "";
    } else { /* a new file: its folder, and its name there */
        char *folder = folder_of(path);
        bool found = folder && system_stat(&info, folder);
        free(folder);
        if (!found) {
            return true;
        }
        out->name = path_base(path);
    }
    out->device = info.device;
    out->inode = info.inode;
    return true;
}

int path_place_order(const struct path_place *a, const struct path_place *b)
{
    int order = (a->device > b->device) - (a->device < b->device);
    order = order ? order : (a->inode > b->inode) - (a->inode < b->inode);
    return order ? order : system_name_order(a->name, b->name);
}

bool paths_equal(const char *a, const char *b)
{
    struct path_place one;
    struct path_place other;
    return path_find_place(&one, a) && path_find_place(&other, b) && path_place_order(&one, &other) == 0;
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
