/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks what is about to be written, before anything is. */
#include "common/outputs.h"

#include "common/input_file.h"
#include "common/messages.h"
#include "common/output.h"
#include "common/provenance.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIDECAR_LIMIT = 1 << 26 };

bool outputs_differ(const struct output *outputs, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        for (size_t j = 0; outputs[i].path && j < i; j++) {
            if (outputs[j].path && paths_equal(outputs[i].path, outputs[j].path)) {
                print_error_line("%s and %s are the same file %s", outputs[j].what, outputs[i].what, outputs[i].path);
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
        print_error_line("not enough memory");
        return EXIT_DATA;
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

int outputs_check(const struct output *outputs, size_t count, bool force)
{
    bool any = false;
    int code = EXIT_DONE;
    for (size_t i = 0; i < count && !code; i++) {
        const struct output *output = &outputs[i];
        any = any || output->path;
        code = output->path ? check_folder(output->path) : EXIT_DONE;
        if (!code && output->path && is_there(output->path) && !force) {
            code =
                print_usage_error("%s: there is a file already (%s); --force replaces it", output->path, output->what);
        }
        code = !code && output->path && output->is_sidecar ? outputs_check_sidecar(output->path) : code;
    }
    return code            ? code
           : !any && force ? print_usage_error("--force has no effect without a file that is written")
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
