/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes to stdout or files, compares paths, and checks what is about to be written. */
#include "options/output.h"

#include "options/input_file.h"
#include "options/messages.h"
#include "options/provenance.h"
#include "options/table_fit.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

bool output_is_stdout(const char *path)
{
    return !path || strcmp(path, "-") == 0;
}

/* Whoever closed the pipe, `head` for example, has what it wants: only the exit code says so. */
static int print_stdout_error(int error)
{
    if (error != EPIPE) {
        print_error_line("standard output: cannot write: %s", strerror(error));
    }
    return EXIT_DATA;
}

int output_write(const char *path, const char *text, size_t size)
{
    if (!output_is_stdout(path)) {
        conus_status status = conus_write_file(path, text, size);
        return status ? print_status(status) : EXIT_DONE;
    }
    if (fwrite(text, 1, size, stdout) != size || fflush(stdout)) {
        int error = errno;
        clearerr(stdout);
        return print_stdout_error(error);
    }
    return EXIT_DONE;
}

static int write_fitted(const char *text, size_t size, const char *whole)
{
    if (!isatty(STDOUT_FILENO)) {
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

int output_put(bool put(FILE *out, const void *what), const void *what)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    bool whole = out && put(out, what);
    whole = out && fclose(out) == 0 && whole;
    int code = EXIT_DATA;
    if (whole) {
        conus_plain_text(text);
        code = write_fitted(text, strlen(text), "--format tsv has all");
    } else {
        print_error_line("not enough memory");
    }
    free(text);
    return code;
}

int output_finish(int code)
{
    if (code != EXIT_DONE && code != EXIT_DIFFERENT) {
        return code;
    }
    bool failed = ferror(stdout);
    if (fflush(stdout) || failed) {
        return print_stdout_error(failed ? EIO : errno);
    }
    return code;
}

int output_check_file(const char *path)
{
    struct stat info;
    if (lstat(path, &info) || S_ISREG(info.st_mode)) {
        return EXIT_DONE;
    }
    print_error_line("%s: cannot write: is a %s, which a file would replace", path,
                     S_ISDIR(info.st_mode)   ? "folder"
                     : S_ISLNK(info.st_mode) ? "link"
                                             : "device or pipe");
    return EXIT_DATA;
}

bool path_ends(const char *path, const char *ending)
{
    size_t length = strlen(path);
    size_t tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

bool output_is_no_file(const char *path)
{
    struct stat info;
    return output_is_stdout(path) || (stat(path, &info) == 0 && !S_ISREG(info.st_mode));
}

bool output_format(conus_format *out, const char *path)
{
    static const struct {
        const char *ending;
        conus_format format;
    } endings[] = {{".tsv", CONUS_FORMAT_TSV},       {".csv", CONUS_FORMAT_CSV},      {".json", CONUS_FORMAT_JSON},
                   {".ndjson", CONUS_FORMAT_NDJSON}, {".jsonl", CONUS_FORMAT_NDJSON}, {".txt", CONUS_FORMAT_TABLE}};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends(path, endings[i].ending)) {
            *out = endings[i].format;
            return true;
        }
    }
    return false;
}

/* The folder of the file at `path`, and its name there. */
static bool find_folder(struct stat *out, const char **name, const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash + 1 - path)) : strdup(".");
    bool found = folder && stat(folder, out) == 0;
    if (found) {
        *name = slash ? slash + 1 : path;
    }
    free(folder);
    return found;
}

bool path_find_place(struct path_place *out, const char *path)
{
    struct stat info;
    *out = (struct path_place){.name = path};
    if (stat(path, &info) == 0) {
        if (!S_ISREG(info.st_mode)) {
            return false;
        }
        out->name = "";
    } else if (!find_folder(&info, &out->name, path)) {
        return true;
    }
    out->device = info.st_dev;
    out->inode = info.st_ino;
    return true;
}

int path_place_order(const struct path_place *a, const struct path_place *b)
{
    int order = (a->device > b->device) - (a->device < b->device);
    order = order ? order : (a->inode > b->inode) - (a->inode < b->inode);
    return order ? order : strcmp(a->name, b->name);
}

bool paths_equal(const char *a, const char *b)
{
    struct path_place one;
    struct path_place other;
    return path_find_place(&one, a) && path_find_place(&other, b) && path_place_order(&one, &other) == 0;
}

enum { SIDECAR_LIMIT = 1 << 26 };

static void add_output(struct outputs *out, const char *form, const char *option, const char *path, bool is_sidecar)
{
    assert(out->count < OUTPUT_LIMIT);
    struct output *output = &out->items[out->count++];
    *output = (struct output){.path = path, .is_sidecar = is_sidecar};
    snprintf(output->what, sizeof output->what, form, option);
}

void outputs_collect(struct outputs *out, const struct arguments *arguments)
{
    const struct option *option;
    *out = (struct outputs){0};
    for (enum option_role role = OPTION_WRITES_ANSWER; role <= OPTION_WRITES_ROWS; role++) {
        for (size_t i = 0; (option = option_at(arguments->command, i)); i++) {
            const char *path = option->role == role ? option_text(arguments, option->name) : NULL;
            if (!output_is_stdout(path)) {
                add_output(out, "--%s", option->name, path, role == OPTION_WRITES_SIDECAR);
            }
        }
    }
}

void outputs_add_sidecar(struct outputs *out, const char *option, const char *path)
{
    if (path) {
        add_output(out, "the .json beside --%s", option, path, true);
    }
}

bool outputs_differ(const struct outputs *outputs)
{
    for (size_t i = 0; i < outputs->count; i++) {
        const struct output *output = &outputs->items[i];
        for (size_t j = 0; j < i; j++) {
            if (paths_equal(output->path, outputs->items[j].path)) {
                print_error_line("%s and %s are the same file %s", outputs->items[j].what, output->what, output->path);
                return false;
            }
        }
    }
    return true;
}

/* A file that is replaced, where it is written: what is open already is not. */
static bool is_there(const char *path)
{
    struct stat info;
    return strncmp(path, "/dev/", strlen("/dev/")) != 0 && strncmp(path, "/proc/", strlen("/proc/")) != 0 &&
           stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

/* Else the message would be of a temporary file, or of the sidecar, which is written first. */
static int check_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash + 1 - path)) : strdup(".");
    if (!folder) {
        return print_no_memory();
    }
    int code = access(folder, F_OK) ? print_system_error(path, "write") : EXIT_DONE;
    free(folder);
    return code;
}

int outputs_check_sidecar(const char *path)
{
    char *text = NULL;
    size_t size = 0;
    json_error_t error;
    if (!is_there(path)) {
        return EXIT_DONE;
    }
    messages_hold(true);
    int code = input_file_read(&text, &size, path, INPUT_FILE, SIDECAR_LIMIT);
    messages_hold(false);
    json_t *root = code || provenance_json_rows(text, size) ? NULL : provenance_parse(text, size, &error);
    const json_t *program = json_array_get(json_object_get(root, "GeneratedBy"), 0);
    const char *name = json_string_value(json_object_get(program, "Name"));
    bool is_sidecar = name && strcmp(name, "conus") == 0;
    json_decref(root);
    free(text);
    return is_sidecar
               ? EXIT_DONE
               : print_usage_error("%s: there is a file that is no sidecar, which a sidecar does not replace", path);
}

int outputs_check(const struct outputs *outputs, bool force)
{
    for (size_t i = 0; i < outputs->count; i++) {
        const struct output *output = &outputs->items[i];
        int code = check_folder(output->path);
        if (!code && is_there(output->path) && !force) {
            code =
                print_usage_error("%s: there is a file already (%s); --force replaces it", output->path, output->what);
        }
        code = !code && output->is_sidecar ? outputs_check_sidecar(output->path) : code;
        if (code) {
            return code;
        }
    }
    return force && !outputs->count ? print_usage_error("--force has no effect without a file that is written")
                                    : EXIT_DONE;
}

int outputs_check_name(const char *name)
{
    char *plain = strdup(name);
    json_t *text = json_string(name); /* NULL of what is no UTF-8 */
    if (plain) {
        make_plain_line(plain);
    }
    bool fits = plain && text && strcmp(plain, name) == 0;
    free(plain);
    json_decref(text);
    return fits
               ? EXIT_DONE
               : print_usage_error("\"%s\": a control character or bytes that are no UTF-8, which no sidecar can name; "
                                   "rename the file",
                                   name);
}
