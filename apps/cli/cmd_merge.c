/* SPDX-License-Identifier: BSD-3-Clause */
/* conus merge: checks the shards of a batch and joins them into one file. */
#include "base/order.h"
#include "base/system/system.h"
#include "base/text.h"
#include "batch/batch_file.h"
#include "batch/batch_record.h"
#include "cli/commands.h"
#include "conus/file.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/outputs.h"
#include "options/progress.h"
#include "options/provenance.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

struct merge_settings {
    struct common_settings common;
    const char *output;
    bool force;
};

static const struct option merge_options[] = {
    {.name = "output",
     .letter = 'o',
     OPTION_AT(struct merge_settings, output),
     .value = "FILE",
     .help = "write the rows of all shards to FILE, and a .json beside it",
     .required = true,
     .words = "save, export",
     .common = true},
    {.name = "force",
     OPTION_AT(struct merge_settings, force),
     .help = "replace FILE if it exists",
     .words = "overwrite",
     .common = true},
    {0},
};

static const struct option_group groups[] = {
    {"What is written", merge_options, 0},
    {"", plain_options, offsetof(struct merge_settings, common)},
    {0},
};

/* A shard's file and what its sidecar says. */
struct part {
    const char *path;
    char *sidecar;
    struct batch_record record;
};

struct merge {
    const struct merge_settings *settings;
    struct part *parts;
    size_t count;
    char *sidecar, *temporary, *command_line;
    struct batch_record record; /* of the whole */
    struct progress progress;
};

static int read_part(struct part *part)
{
    uint32_t crc;
    uint64_t size;
    int code = batch_record_read(&part->record, part->sidecar);
    if (code) {
        return code;
    }
    if (!batch_file_checksum(part->path, &crc, &size)) {
        return EXIT_DATA;
    }
    if (crc != part->record.crc || size != part->record.bytes) {
        return print_data_error("%s: is not the file that %s describes: %" PRIu64 " bytes with CRC-32 %08" PRIx32
                                ", not %" PRIu64 " with %08" PRIx32,
                                part->path, part->sidecar, size, crc, part->record.bytes, part->record.crc);
    }
    return EXIT_DONE;
}

/* The cell behind the first one of `line`, which may be quoted where commas separate. */
static const char *next_cell(const char *line, char separator)
{
    bool quoted = separator == ',' && *line == '"';
    for (line += quoted; *line && (quoted || *line != separator); line++) {
        quoted = quoted != (*line == '"' && separator == ','); /* doubled ones close it and open it again */
    }
    return *line ? line + 1 : line;
}

/* How a file says that a pose has no answer. */
struct form {
    bool (*is_error)(const struct form *form, const char *line);
    char separator; /* of a table, */
    size_t kind;    /* and the number of its column of that name, from 0 */
};

static bool in_table(const struct form *form, const char *line)
{
    for (size_t i = 0; i < form->kind; i++) {
        line = next_cell(line, form->separator);
    }
    return strncmp(line, "error", 5) == 0 && line[5] == form->separator;
}

static bool in_ndjson(const struct form *form, const char *line)
{
    (void)form;
    return strstr(line, "\"kind\":\"error\""); /* marks inside of texts have a backslash before them */
}

static bool in_afni(const struct form *form, const char *line)
{
    (void)form;
    return strncmp(line, "***** ", 6) == 0 && strncmp(line, "***** Not near any region", 25) != 0;
}

/* The last column is area_error. */
static bool in_bids(const struct form *form, const char *line)
{
    (void)form;
    const char *tab = strrchr(line, '\t');
    return tab && strcmp(tab, "\tarea_error\n") != 0 && strcmp(tab, "\tn/a\n") != 0;
}

/* The form of a file with this first line. */
static struct form form_after(const char *first)
{
    bool is_table = strncmp(first, "query\t", 6) == 0 || strncmp(first, "query,", 6) == 0;
    if (!is_table) {
        return (struct form){.is_error = *first == '{'                        ? in_ndjson
                                         : strncmp(first, "+++++++ ", 8) == 0 ? in_afni
                                                                              : in_bids};
    }
    struct form form = {.is_error = in_table, .separator = first[strlen("query")]};
    const char name[] = {'k', 'i', 'n', 'd', form.separator, '\0'};
    for (const char *cell = first; *cell && strncmp(cell, name, sizeof name - 1) != 0; form.kind++) {
        cell = next_cell(cell, form.separator);
    }
    return form;
}

/* Compares the number of rows that say that a pose has no answer, one for each atlas, with the record. */
static int check_errors(const struct part *part)
{
    char *line = NULL;
    size_t capacity = 0;
    struct form form = {0};
    uint64_t errors = 0;
    FILE *file = input_file_open(part->path);
    if (!file) {
        return EXIT_DATA;
    }
    while (text_read_line(&line, &capacity, '\n', file) > 0) {
        form = form.is_error ? form : form_after(line);
        errors += form.is_error(&form, line);
    }
    int code = feof(file) && !ferror(file) ? EXIT_DONE : print_system_error(part->path, "read");
    free(line);
    fclose(file);
    if (code) {
        return code;
    }
    if (errors != part->record.errors * part->record.atlases) { /* each atlas has a row that says it */
        return print_data_error("%s: %" PRIu64 " poses without an answer, %s says %" PRIu64, part->path,
                                errors / part->record.atlases, part->sidecar, part->record.errors);
    }
    return EXIT_DONE;
}

static int by_index(const void *a, const void *b)
{
    const struct part *x = a;
    const struct part *y = b;
    return (x->record.shard.index > y->record.shard.index) - (x->record.shard.index < y->record.shard.index);
}

static int print_missing_shard(uint64_t index, const struct part *first)
{
    return print_data_error("shard %" PRIu64 " of %" PRIu64 " is missing (%s is one of them)", index,
                            first->record.shard.count, first->path);
}

/* Checks that every shard is there once, and all are of one batch. The parts are sorted. */
static int check_set(const struct merge *merge)
{
    const struct part *first = &merge->parts[0];
    for (size_t i = 0; i < merge->count; i++) {
        const struct part *part = &merge->parts[i];
        if (strcmp(part->record.fingerprint, first->record.fingerprint) != 0 ||
            part->record.shard.count != first->record.shard.count ||
            part->record.header_size != first->record.header_size) {
            return print_data_error(
                "%s and %s are not shards of one batch: settings, poses, atlas, version or the number of shards "
                "differ",
                first->path, part->path);
        }
        if (i > 0 && part->record.shard.index == part[-1].record.shard.index) {
            return print_data_error("%s and %s are both shard %" PRIu64 " of %" PRIu64, part[-1].path, part->path,
                                    part->record.shard.index, part->record.shard.count);
        }
        if (part->record.shard.index != i) {
            return print_missing_shard(i, first);
        }
    }
    return merge->count == first->record.shard.count ? EXIT_DONE : print_missing_shard(merge->count, first);
}

/* Checks that each shard has its own poses. */
static int check_poses(struct merge *merge)
{
    for (size_t i = 0; i < merge->count; i++) {
        merge->record.poses += merge->parts[i].record.poses;
        merge->record.errors += merge->parts[i].record.errors;
    }
    for (size_t i = 0; i < merge->count; i++) {
        const struct batch_record *record = &merge->parts[i].record;
        uint64_t first, count;
        shard_range(&first, &count, record->shard, merge->record.poses);
        if (record->first != first || record->poses != count) {
            return print_data_error("%s: has poses %" PRIu64 " to %" PRIu64 " of %" PRIu64 ", not its own",
                                    merge->parts[i].path, record->first, record->first + record->poses,
                                    merge->record.poses);
        }
    }
    return EXIT_DONE;
}

/* The rest of `in`. */
static bool copy_rest(FILE *out, FILE *in)
{
    char chunk[1 << 13];
    for (size_t n; (n = fread(chunk, 1, sizeof chunk, in)) > 0;) {
        if (fwrite(chunk, 1, n, out) != n) {
            return false;
        }
    }
    return !ferror(in);
}

/* A new file beside the output; its name is nobody else's. */
static FILE *open_temporary(char *path)
{
    int descriptor = system_open_temporary(path, strlen(".part"), false);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (!file && descriptor >= 0) {
        close(descriptor);
        system_remove(path);
    }
    return file;
}

static int copy_all(struct merge *merge)
{
    FILE *out = open_temporary(merge->temporary);
    if (!out) {
        return print_system_error(merge->settings->output, "write");
    }
    bool copied = true;
    for (size_t i = 0; i < merge->count && copied; i++) {
        const char *path = merge->parts[i].path;
        FILE *in = system_stream(path, "r");
        copied =
            in && !fseeko(in, i > 0 ? (off_t)merge->parts[i].record.header_size : 0, SEEK_SET) && copy_rest(out, in);
        if (in) {
            fclose(in);
        }
        progress_update(&merge->progress, merge->count + i + 1, 0);
    }
    copied = copied && !fflush(out) && system_to_disk(fileno(out));
    copied = !fclose(out) && copied;
    if (!copied) {
        return print_system_error(merge->settings->output, "write");
    }
    return batch_file_checksum(merge->temporary, &merge->record.crc, &merge->record.bytes) ? EXIT_DONE : EXIT_DATA;
}

/* Those of all parts are the whole's. */
static void say_warnings(const struct merge *merge)
{
    for (size_t i = 0; i < merge->count; i++) {
        json_t *root = provenance_load(merge->parts[i].sidecar, BATCH_RECORD_LIMIT);
        const json_t *warnings = json_object_get(root, "Warnings");
        for (size_t k = 0; k < json_array_size(warnings); k++) {
            const char *line = json_string_value(json_array_get(warnings, k));
            say_warning("%s", line ? line : "");
        }
        json_decref(root);
    }
}

static int write_whole(struct merge *merge)
{
    say_warnings(merge);
    char *text = NULL;
    size_t size = 0;
    int code = copy_all(merge);
    code = code ? code : input_file_read(&text, &size, merge->parts[0].sidecar, INPUT_FILE, BATCH_RECORD_LIMIT);
    code = code ? code : batch_record_write(merge->sidecar, text, &merge->record, merge->command_line, NULL);
    free(text);
    if (!code && !system_rename(merge->temporary, merge->settings->output, true)) {
        code = print_system_error(merge->settings->output, "write");
    }
    if (code) {
        system_remove(merge->temporary);
    }
    return code;
}

static int check_paths(const struct merge *merge)
{
    const char *output = merge->settings->output;
    if (output_is_stdout(output)) {
        return print_usage_error("--output: a file is needed, not \"-\"");
    }
    int code = output_check_file(output);
    code = code ? code : output_check_file(merge->sidecar);
    code = code ? code : outputs_check_sidecar(merge->sidecar);
    for (size_t i = 0; i < merge->count; i++) {
        conus_inputs_add(merge->parts[i].sidecar);
    }
    if (!code && !(output_spares_inputs("--output", output) &&
                   output_spares_inputs("the .json beside --output", merge->sidecar))) {
        code = EXIT_USAGE;
    }
    for (size_t i = 0; i < merge->count && !code; i++) {
        /* Rows are joined, not written anew: where both endings say a format, it must be one. */
        conus_format wanted;
        conus_format given;
        if (output_format(&wanted, output) && output_format(&given, merge->parts[i].path) && wanted != given) {
            return print_usage_error("--output: %s is of another format than the shard %s", output,
                                     merge->parts[i].path);
        }
    }
    if (!code && !merge->settings->force && (system_allows(output, 0) || system_allows(merge->sidecar, 0))) {
        return print_usage_error("%s: there is a file already; --force replaces it",
                                 system_allows(output, 0) ? output : merge->sidecar);
    }
    return code;
}

static int merge_shards(struct merge *merge)
{
    int code = check_paths(merge);
    progress_start(&merge->progress, PROGRESS_AUTO, false, "files", 2 * (uint64_t)merge->count); /* read, then joined */
    for (size_t i = 0; i < merge->count && !code; i++) {
        code = read_part(&merge->parts[i]);
        code = code ? code : check_errors(&merge->parts[i]);
        progress_update(&merge->progress, i + 1, 0);
    }
    if (code) {
        return code;
    }
    order_sort(merge->parts, merge->count, sizeof *merge->parts, by_index);
    code = check_set(merge);
    code = code ? code : check_poses(merge);
    memcpy(merge->record.fingerprint, merge->parts[0].record.fingerprint, sizeof merge->record.fingerprint);
    merge->record.shard = (struct shard){0, 1};
    merge->record.header_size = merge->parts[0].record.header_size;
    return code ? code : write_whole(merge);
}

static bool init_merge(struct merge *merge, const struct arguments *arguments)
{
    merge->count = arguments->operand_count + arguments->more.count;
    merge->parts = calloc(merge->count, sizeof *merge->parts);
    merge->command_line = arguments_text(arguments);
    merge->sidecar = provenance_path(merge->settings->output);
    if (asprintf(&merge->temporary, "%s.XXXXXX.part", merge->settings->output) < 0) {
        merge->temporary = NULL;
    }
    bool whole = merge->parts && merge->command_line && merge->sidecar && merge->temporary;
    for (size_t i = 0; i < merge->count && whole; i++) {
        merge->parts[i].path = i ? arguments->more.items[i - 1] : arguments->operands[0];
        merge->parts[i].sidecar = provenance_path(merge->parts[i].path);
        whole = merge->parts[i].sidecar;
    }
    return whole || refuse("not enough memory");
}

static int run_merge(const void *given, const struct arguments *arguments)
{
    struct merge merge = {.settings = given};
    int code = init_merge(&merge, arguments) ? merge_shards(&merge) : EXIT_DATA;
    progress_finish(&merge.progress, 0, 0);
    for (size_t i = 0; merge.parts && i < merge.count; i++) {
        free(merge.parts[i].sidecar);
    }
    free(merge.parts);
    free(merge.sidecar);
    free(merge.temporary);
    free(merge.command_line);
    return code;
}

const struct command cmd_merge = {
    .name = "merge",
    .summary = "join the shards of a batch into the file that one run would have written",
    .operands = {"SHARD"},
    .repeats = true,
    .form = "-o FILE",
    .description =
        "Reads the outputs of conus batch --shard I/N and the .json beside each, checks that they are whole, of\n"
        "one batch, and that none is missing or repeated. Writes their rows in order, with one header.",
    .examples = "  conus merge rows.0.tsv rows.1.tsv rows.2.tsv rows.3.tsv -o rows.tsv\n",
    .groups = groups,
    .settings_size = sizeof(struct merge_settings),
    .run = run_merge,
};
