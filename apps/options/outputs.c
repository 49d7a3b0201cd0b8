/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the files that are about to be written. */
#include "options/output.h"

#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/provenance.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDECAR_LIMIT = 1 << 26 };

static void add_output(struct outputs *out, const char *form, const char *option, const char *path, bool is_sidecar)
{
    assert(out->count < OUTPUT_LIMIT);
    struct output *output = &out->items[out->count++];
    *output = (struct output){.path = path, .is_sidecar = is_sidecar};
    snprintf(output->what, sizeof output->what, form, option);
}

/* Adds each @FILE in a list of names, which may be read late. */
static void add_lists(const char *value)
{
    for (const char *item = value; item && *item; item += *item == ',') {
        item += strspn(item, " ");
        size_t length = strcspn(item, ",");
        char *path = *item == '@' ? text_copy(item + 1, length - 1) : NULL;
        conus_inputs_add(path);
        free(path);
        item += length;
    }
}

int outputs_begin(const struct arguments *arguments)
{
    conus_status status = conus_inputs_keep();
    for (size_t i = 0; i < arguments->operand_count; i++) {
        conus_inputs_add(arguments->operands[i]);
    }
    for (size_t i = 0; i < arguments->more.count; i++) {
        conus_inputs_add(arguments->more.items[i]);
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        if (use->option->role >= OPTION_READS && use->option->role <= OPTION_READS_POSES) {
            conus_inputs_add(use->value);
        }
        add_lists(use->value);
    }
    return print_status(status);
}

bool sidecar_is_none(const char *given)
{
    return given && strcmp(given, "none") == 0;
}

void outputs_collect(struct outputs *out, const struct arguments *arguments)
{
    const struct option *option;
    *out = (struct outputs){0};
    for (enum option_role role = OPTION_WRITES_ANSWER; role <= OPTION_WRITES_ROWS; role++) {
        for (size_t i = 0; (option = option_at(arguments->command, i)); i++) {
            const char *path = option->role == role ? option_text(arguments, option->name) : NULL;
            if (!output_is_stdout(path) && !(role == OPTION_WRITES_SIDECAR && sidecar_is_none(path))) {
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
                return refuse("%s and %s are the same file %s", outputs->items[j].what, output->what, output->path);
            }
        }
    }
    return true;
}

bool output_spares_inputs(const char *what, const char *path)
{
    const char *input = output_is_stdout(path) ? NULL : conus_inputs_find(path);
    return !input || refuse("%s %s would overwrite the input %s", what, path, input);
}

bool outputs_spare_inputs(const struct outputs *outputs)
{
    bool spared = output_spares_inputs("standard output", "/dev/stdout"); /* of >> and <> */
    for (size_t i = 0; i < outputs->count && spared; i++) {
        spared = output_spares_inputs(outputs->items[i].what, outputs->items[i].path);
    }
    return spared;
}

/* Whether there is a regular file that would be replaced. One behind an open descriptor would not. */
static bool is_there(const char *path)
{
    struct system_stat info;
    return !system_is_open_name(path) && system_stat(&info, path) && info.kind == SYSTEM_FILE;
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
        /* Without this check, the message would name a temporary file or the sidecar, which is written first. */
        int code = output_check_folder(output->path, 0);
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
