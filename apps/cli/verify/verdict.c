/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a result and its sidecar, finds the files, answers again, and says what is not as it was. */
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/answers/answers.h"
#include "cli/verify/verify.h"
#include "conus/version.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static const uint64_t DEFAULT_MEMORY = UINT64_C(4) << 30;

enum { LINES = 32, LISTED = 10, SHOWN = 80 /* bytes of a line without cells */ };

/* Texts; `more` counts those that did not fit. */
struct lines {
    char *items[LINES];
    size_t count, more;
};

/* A result on the way. */
struct checking {
    const char *result;
    char *ran; /* the folder in which conus ran */
    const struct verify_settings *settings;
    uint64_t limit; /* bytes of the result */
    char *sidecar;  /* its path; the result's own where the result has it inside */
    char *text;     /* of the result */
    size_t size;
    struct record record;
    struct found_file *found;           /* [record.input_count] */
    const struct recorded_file *output; /* what the result is among those recorded; NULL = not recorded */
    struct replay replay;
    bool compared; /* there are rows, or pixels, to compare, */
    bool same;     /* and they are the same */
    bool changed;  /* a source is another, */
    bool missing;  /* or not there */
    struct lines why, notes;
    json_t *differences; /* the first LISTED */
    size_t differing;
};

static void say(struct lines *lines, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(struct lines *lines, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *line = NULL;
    if (lines->count == LINES || vasprintf(&line, format, args) < 0) {
        lines->more++;
    } else {
        make_plain_line(line);
        lines->items[lines->count++] = line;
    }
    va_end(args);
}

static void lines_finish(struct lines *lines)
{
    for (size_t i = 0; i < lines->count; i++) {
        free(lines->items[i]);
    }
}

static bool read_sidecar(struct checking *checking)
{
    const struct verify_settings *settings = checking->settings;
    bool own = !settings->sidecar && provenance_json_rows(checking->text, checking->size);
    char *sidecar = settings->sidecar ? strdup(settings->sidecar)
                    : own             ? strdup(checking->result)
                                      : sidecar_find(checking->result);
    if (!sidecar) {
        say(&checking->why, "there is no .json beside it that says how it was made (pictures, pages and meshes have "
                            "none); --sidecar FILE.json names it");
        return false;
    }
    messages_hold(true);
    const char *bad = NULL;
    if (own) {
        bad = record_parse(&checking->record, checking->text, checking->size);
    } else if (record_read(&checking->record, sidecar)) {
        bad = error_line();
    }
    messages_hold(false);
    checking->sidecar = sidecar;
    if (bad) {
        say(&checking->why, "%s", bad);
    }
    return !bad;
}

/* The rows of a result in JSON, else all of it. */
static const char *rows_of(const char *text, size_t size, size_t *rows_size)
{
    const char *rows = provenance_json_rows(text, size);
    *rows_size = rows ? size - (size_t)(rows - text) : size;
    return rows ? rows : text;
}

static bool has_recorded_sum(const struct recorded_file *output, const char *rows, size_t size)
{
    char sum[SHA256_TEXT];
    if (output->crc32 >= 0) {
        return (uint64_t)output->bytes == size && output->crc32 == (uint32_t)crc32_z(0, (const Bytef *)rows, size);
    }
    provenance_hash(sum, rows, size);
    return output->sha256 && strcmp(output->sha256, sum) == 0;
}

/* Which of the recorded outputs the result is: by its name, or else by its checksum. */
static void find_output(struct checking *checking)
{
    const struct record *record = &checking->record;
    const struct recorded_file *named = NULL;
    const struct recorded_file *equal = NULL;
    size_t size;
    const char *rows = rows_of(checking->text, checking->size, &size);
    for (size_t i = 0; i < record->output_count; i++) {
        const struct recorded_file *output = &record->outputs[i];
        bool is_named = !output->path || strcmp(path_name(output->path), path_name(checking->result)) == 0;
        bool is_equal = has_recorded_sum(output, rows, size);
        named = is_named && (!named || is_equal) ? output : named;
        equal = is_equal && !equal ? output : equal;
    }
    checking->output = named                  ? named
                       : equal                ? equal
                       : record->output_count ? &record->outputs[record->output_count - 1]
                                              : NULL;
    if (!record->output_count) {
        say(&checking->notes, "%s has no SHA-256 of the result", checking->sidecar);
    } else if (!named && !equal) {
        say(&checking->why, "%s is the sidecar of %s, and neither name nor SHA-256 of %s are recorded there",
            checking->sidecar, checking->output->path ? checking->output->path : "standard output", checking->result);
    } else if (!has_recorded_sum(checking->output, rows, size)) {
        say(&checking->why, "%s was changed after conus wrote it: it has another %s than %s records", checking->result,
            checking->output->crc32 >= 0 ? "length or CRC-32" : "SHA-256", checking->sidecar);
    }
}

/* A folder, a store of Zarr, has no SHA-256 but that of what is read of it: its metadata must be recorded. */
static bool has_file_in(const struct record *record, const char *folder)
{
    const size_t length = path_plain_length(folder, strlen(folder));
    bool has = false;
    for (size_t i = 0; i < record->input_count; i++) {
        const struct recorded_file *file = &record->inputs[i];
        has = has || (file->bytes >= 0 && file->sha256 && strncmp(file->path, folder, length) == 0 &&
                      strchr(SYSTEM_SEPARATORS, file->path[length]) && file->path[length]);
    }
    return has;
}

static void say_file(struct checking *checking, const struct recorded_file *file, const struct found_file *found)
{
    if (found->is_folder && !has_file_in(&checking->record, file->path)) {
        checking->missing = true;
        say(&checking->why, "%s is a folder, and no file in it is recorded", file->path);
    }
    checking->changed = checking->changed || found->state == FILE_CHANGED;
    checking->missing = checking->missing || found->state == FILE_MISSING;
    if (found->state == FILE_MOVED) {
        say(&checking->notes, "%s is now %s", file->path, found->path);
    } else if (found->state == FILE_CHANGED && !file->sha256) {
        say(&checking->why, "%s has no recorded SHA-256", file->path);
    } else if (found->state == FILE_CHANGED) {
        say(&checking->why, "%s changed: its SHA-256 is not the recorded one", file->path);
    } else if (found->state == FILE_MISSING) {
        say(&checking->why, "%s is missing; --folder FOLDER says where it is", file->path);
    }
}

/* Says whether another file of the same command has changed since it wrote it, or cannot be compared. In JSON the
 * recorded sum is that of the rows. */
static void say_other_output(struct checking *checking, const struct recorded_file *output,
                             const struct found_file *found)
{
    char *text = NULL;
    size_t size = 0;
    bool has_rows = found->is_replaced && path_ends_in(output->path, ".json");
    messages_hold(true);
    int code = has_rows ? input_file_read(&text, &size, found->path, INPUT_FILE, checking->limit) : EXIT_DONE;
    messages_hold(false);
    const char *rows = text ? rows_of(text, size, &size) : NULL;
    if (code || found->state == FILE_MISSING) {
        say(&checking->notes, "%s, which the same command wrote, was not compared: %s", output->path,
            code ? error_line() : "it is missing");
    } else if (found->is_replaced && !(rows && has_recorded_sum(output, rows, size))) {
        say(&checking->notes, "%s, which the same command wrote, was changed; with --sidecar %s it is verified, too",
            output->path, checking->sidecar);
    }
    free(text);
}

/* False without memory. */
static bool say_other_outputs(struct checking *checking)
{
    const struct record *record = &checking->record;
    bool done = true;
    for (size_t i = 0; i < record->output_count && done; i++) {
        const struct recorded_file *output = &record->outputs[i];
        struct found_file found = {0};
        bool is_other = output != checking->output && output->path && output->sha256;
        done = !is_other || file_find(&found, output, checking->ran, checking->settings->folder);
        if (done && is_other) {
            say_other_output(checking, output, &found);
        }
        free(found.path);
    }
    return done;
}

/* The path that the result had, if the command line or the sidecar tells; NULL else. */
static const char *path_written(const struct checking *checking)
{
    const struct recorded_file *output = checking->output;
    return output && output->path ? output->path
                                  : option_text(&checking->replay.arguments, output ? output->option : "output");
}

static bool find_files(struct checking *checking)
{
    const struct record *record = &checking->record;
    checking->ran = recorded_folder(path_written(checking), checking->result);
    checking->found = calloc(record->input_count + 1, sizeof *checking->found);
    bool done = checking->ran && checking->found;
    for (size_t i = 0; i < record->input_count && done; i++) {
        done = file_find(&checking->found[i], &record->inputs[i], checking->ran, checking->settings->folder);
        say_file(checking, &record->inputs[i], &checking->found[i]);
    }
    return done && say_other_outputs(checking);
}

/* As a line of text: what stands there in the result, and what in the answer. */
static void list_difference(struct checking *checking, size_t line, const char *where, json_t *before, json_t *after)
{
    if (checking->differing++ < LISTED) {
        json_array_append_new(checking->differences,
                              json_pack("{s: I, s: o, s: o, s: o}", "line", (json_int_t)line, "where",
                                        json_from_text(where), "recorded", before ? before : json_null(), "again",
                                        after ? after : json_null()));
    } else {
        json_decref(before);
        json_decref(after);
    }
}

/* A row or column that only one of them has is "this row" there, and nothing in the other. */
static void take_difference(void *user, const struct difference *difference)
{
    struct checking *checking = user;
    char *where = NULL;
    const char *before = difference->before;
    const char *after = difference->after;
    const bool is_cell = before;
    const bool is_column = !is_cell && difference->column;
    if (!is_cell) {
        bool is_recorded =
            strcmp(is_column ? difference->where : difference->what, is_column ? "the first" : "removed") == 0;
        *(is_recorded ? &before : &after) = is_column ? "this column" : "this row";
    }
    if (asprintf(&where, "%s%s%s", is_column ? "" : difference->where, is_cell ? ": " : "",
                 difference->column ? difference->column : "") >= 0) {
        list_difference(checking, difference->line, where, before ? json_string(before) : NULL,
                        after ? json_string(after) : NULL);
        free(where);
    }
}

/* Compares tables by their rows. False where they are none, or no row tells what is different. */
static bool compare_tables(struct checking *checking, const char *again, size_t size)
{
    struct results a = {0};
    struct results b = {0};
    struct differences found;
    messages_hold(true);
    bool are_tables = !results_parse(&a, checking->result, checking->text, checking->size) &&
                      !results_parse(&b, "the new answer", again, size);
    messages_hold(false);
    if (are_tables) {
        tables_compare(&found, &a, &b, 0, take_difference, checking);
    }
    results_finish(&a);
    results_finish(&b);
    return checking->differing;
}

static json_t *json_from_line(const char *at, const char *end)
{
    size_t size = at < end ? strcspn(at, "\n") : 0;
    for (size = size < SHOWN ? size : SHOWN; size && ((unsigned char)at[size] & 0xc0) == 0x80;) { /* whole characters */
        size--;
    }
    char *text = at < end ? text_copy(at, size) : NULL;
    json_t *line = text ? json_string(text) : NULL;
    free(text);
    return line;
}

/* Compares texts, of which the first begins at line `line`: the first line that differs is shown, from a little before
 * that place on. */
static void compare_lines(struct checking *checking, size_t line, const char *a, size_t a_size, const char *b,
                          size_t b_size)
{
    size_t from = 0;
    size_t same = 0;
    for (; same < a_size && same < b_size && a[same] == b[same]; same++) {
        from = a[same] == '\n' ? same + 1 : from;
        line += a[same] == '\n';
    }
    from = same > from + SHOWN / 2 ? same - SHOWN / 2 : from;
    while (from < same && ((unsigned char)a[from] & 0xc0) == 0x80) {
        from++;
    }
    list_difference(checking, line, "", json_from_line(a + from, a + a_size), json_from_line(b + from, b + b_size));
}

/* Pictures have attributes that say when and where they were made: pixels count. */
static bool same_pixels(struct checking *checking, const char *again)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    messages_hold(true);
    int code = out ? pictures_compare(out, checking->result, again, 0) : EXIT_DATA;
    messages_hold(false);
    const char *said = system_text_close(&text);
    if (code > EXIT_DIFFERENT) {
        say(&checking->why, "its bytes differ from those of the new answer: %s", error_line());
    } else if (code) {
        say(&checking->why, "%s", said ? said : "pixels differ");
    }
    free(text.data);
    return !code;
}

static void compare_rows(struct checking *checking, const char *again, size_t again_size, const char *path)
{
    size_t size;
    size_t other_size;
    size_t line = 1;
    const char *rows = rows_of(checking->text, checking->size, &size);
    const char *other = rows_of(again, again_size, &other_size);
    checking->compared = true;
    checking->same = size == other_size && memcmp(rows, other, size) == 0;
    if (checking->same) {
        return;
    }
    if (path_is_picture(path)) {
        checking->same = same_pixels(checking, path);
    } else if (memchr(rows, '\0', size) || memchr(other, '\0', other_size)) {
        say(&checking->why, "its bytes differ from those of the new answer");
    } else if (rows != checking->text || !compare_tables(checking, again, again_size)) {
        for (const char *at = checking->text; (at = memchr(at, '\n', (size_t)(rows - at))); at++) {
            line++;
        }
        compare_lines(checking, line, rows, size, other, other_size);
    }
}

/* Compares every value of the sidecar, which stands beside the output that conus lists last. Says a difference only
 * where nothing else was said that it may follow from. */
static bool compare_sidecars(struct checking *checking)
{
    const struct record *record = &checking->record;
    const char *option = record->output_count ? record->outputs[record->output_count - 1].option : "output";
    char *path = stage_find_output(&checking->replay.stage, option);
    char *sidecar = path ? sidecar_find(path) : NULL;
    json_t *again = sidecar ? provenance_load(sidecar, checking->limit) : NULL;
    char *difference = NULL;
    bool done = !again || sidecars_differ(&difference, again, &checking->replay);
    if (!again) {
        say(&checking->why, "%s: no sidecar is written when it is answered again", checking->sidecar);
    } else if (difference && (!record->is_intact || !checking->why.count)) {
        say(&checking->why, "%s: %s", checking->sidecar, difference);
    }
    free(difference);
    json_decref(again);
    free(sidecar);
    free(path);
    return done;
}

/* Says that another version wrote the result, which explains other rows where nothing else does. */
static void say_versions(struct checking *checking)
{
    const struct record *record = &checking->record;
    const char *engine = json_string_value(json_object_get(json_object_get(record->root, "Settings"), "engine"));
    if (strcmp(record->version, conus_version()) != 0) {
        say(checking->same ? &checking->notes : &checking->why, "it was written by conus %s; this is %s",
            record->version, conus_version());
    }
    if (!checking->same && !checking->why.count) {
        say(&checking->why, "all files are as recorded, and so is the result: this conus answers another way%s%s",
            engine ? "; it was answered by the engine " : "", engine ? engine : "");
    }
}

/* False without memory. */
static bool compare_again(struct checking *checking)
{
    const char *option = checking->output ? checking->output->option : "output";
    char *path = stage_find_output(&checking->replay.stage, option);
    char *text = NULL;
    size_t size = 0;
    bool done = true;
    messages_hold(true);
    int code = path ? input_file_read(&text, &size, path, INPUT_FILE, checking->limit) : EXIT_DONE;
    messages_hold(false);
    if (!path) {
        say(&checking->why, "its command line writes nothing with --%.40s", option);
    } else if (code) {
        say(&checking->why, "%s", error_line());
    } else {
        compare_rows(checking, text, size, path);
        done = compare_sidecars(checking);
        say_versions(checking);
    }
    free(text);
    free(path);
    return done;
}

/* False without memory. */
static bool check_result(struct checking *checking, const struct command *const *commands)
{
    const struct record *record = &checking->record;
    struct replay *replay = &checking->replay;
    if (!read_sidecar(checking)) {
        return true;
    }
    if (!record->is_sealed) {
        say(&checking->why, "%s has no Checksum: it may have been changed", checking->sidecar);
    } else if (!record->is_intact) {
        say(&checking->why, "%s was changed after conus wrote it: its Checksum does not fit", checking->sidecar);
    }
    find_output(checking);
    replay->record = record;
    replay->max_memory = checking->limit;
    bool can_ask = replay_check(replay, commands);
    bool done = !can_ask || find_files(checking);
    replay->found = checking->found;
    if (can_ask && done && !checking->missing && !checking->changed) {
        can_ask = replay_run(replay);
        done = !can_ask || compare_again(checking);
    }
    if (!can_ask) {
        say(&checking->why, "%s", replay->why);
    }
    return done;
}

static enum verdict_kind kind_of(const struct checking *checking)
{
    return checking->missing || !(checking->compared || checking->changed) ? VERDICT_NONE
           : checking->same && !checking->why.count                        ? VERDICT_IDENTICAL
                                                                           : VERDICT_DIFFERENT;
}

static const char *const kinds[] = {"identical", "different", "not verified"};

static void put_lines(FILE *out, const char *before, const struct lines *lines)
{
    for (size_t i = 0; i < lines->count; i++) {
        fprintf(out, "  %s: %s\n", before, lines->items[i]);
    }
    if (lines->more) {
        fprintf(out, "  %s: and %zu more\n", before, lines->more);
    }
}

static const char *shown(const json_t *item, const char *key)
{
    const char *text = json_string_value(json_object_get(item, key));
    return text ? text + strspn(text, " ") : "nothing";
}

static void put_text(FILE *out, const struct checking *checking)
{
    size_t known = 0;
    size_t count = checking->record.input_count;
    size_t index;
    const json_t *item;
    bool rows_only = checking->compared && checking->same && checking->why.count;
    fprintf(out, "%s: %s%s\n", checking->result, kinds[kind_of(checking)],
            rows_only ? ": it is answered the same again, but not all else is as it was" : "");
    for (size_t i = 0; i < count; i++) {
        known += checking->found[i].state == FILE_SAME || checking->found[i].state == FILE_MOVED;
    }
    fprintf(out, "  %s from %zu file%s, %zu with the SHA-256 in %s\n",
            checking->compared ? "answered again" : "not answered again", count, count == 1 ? "" : "s", known,
            checking->sidecar);
    json_array_foreach(checking->differences, index, item)
    {
        const char *where = shown(item, "where");
        fprintf(out, "  line %" JSON_INTEGER_FORMAT "%s%s: %s, answered again: %s\n",
                json_integer_value(json_object_get(item, "line")), *where ? ", " : "", where, shown(item, "recorded"),
                shown(item, "again"));
    }
    if (checking->differing > LISTED) {
        fprintf(out, "  and %zu more\n", checking->differing - LISTED);
    }
    put_lines(out, "why", &checking->why);
    put_lines(out, "note", &checking->notes);
}

static void print_error(const struct checking *checking)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    for (size_t i = 0; out && i < checking->why.count; i++) {
        fprintf(out, "%s%s", i ? "; " : "", checking->why.items[i]);
    }
    const char *why = system_text_close(&text);
    print_error_line("%s: cannot be verified: %s", checking->result, why ? why : "not enough memory");
    free(text.data);
}

static json_t *json_from_lines(const struct lines *lines)
{
    json_t *list = json_array();
    for (size_t i = 0; i < lines->count; i++) {
        json_array_append_new(list, json_from_text(lines->items[i]));
    }
    return list;
}

static void put_json(FILE *out, const struct checking *checking)
{
    static const char *const states[] = {"same", "moved", "not compared", "changed", "missing"};
    json_t *files = json_array();
    for (size_t i = 0; checking->found && i < checking->record.input_count; i++) {
        const struct recorded_file *file = &checking->record.inputs[i];
        json_array_append_new(files,
                              json_pack("{s: s, s: o, s: o, s: s}", "path", file->path, "sha256",
                                        json_from_text(file->sha256), "found", json_from_text(checking->found[i].path),
                                        "state", states[checking->found[i].state]));
    }
    json_t *root =
        json_pack("{s: o, s: o, s: s, s: b, s: o, s: o, s: I, s: O, s: o}", "result", json_from_text(checking->result),
                  "sidecar", json_from_text(checking->sidecar), "verdict", kinds[kind_of(checking)], "same_rows",
                  checking->compared && checking->same, "why", json_from_lines(&checking->why), "notes",
                  json_from_lines(&checking->notes), "lines_that_differ", (json_int_t)checking->differing,
                  "differences", checking->differences, "files", files);
    if (!json_put(out, root, JSON_INDENT(1))) {
        fputs("null\n", out);
    }
}

static int write_verdict(const struct checking *checking, bool is_json)
{
    static const int codes[] = {
        [VERDICT_IDENTICAL] = EXIT_DONE, [VERDICT_DIFFERENT] = EXIT_DIFFERENT, [VERDICT_NONE] = EXIT_DATA};
    const enum verdict_kind kind = kind_of(checking);
    struct system_text text;
    if (kind == VERDICT_NONE && !is_json) {
        print_error(checking);
        return codes[kind];
    }
    if (system_text_open(&text)) {
        (is_json ? put_json : put_text)(text.stream, checking);
    }
    int code = output_end(&text);
    return code ? code : codes[kind];
}

int verify_result(const char *result, const struct verify_settings *settings, const struct command *const *commands,
                  bool is_json)
{
    struct checking checking = {.result = result,
                                .settings = settings,
                                .limit = settings->max_memory ? settings->max_memory : DEFAULT_MEMORY,
                                .differences = json_array()};
    int code = input_file_read(&checking.text, &checking.size, result, INPUT_FILE, checking.limit);
    code = code ? code : check_result(&checking, commands) ? write_verdict(&checking, is_json) : print_no_memory();
    replay_finish(&checking.replay);
    for (size_t i = 0; checking.found && i < checking.record.input_count; i++) {
        free(checking.found[i].path);
    }
    free(checking.found);
    free(checking.ran);
    free(checking.sidecar);
    free(checking.text);
    lines_finish(&checking.why);
    lines_finish(&checking.notes);
    json_decref(checking.differences);
    record_finish(&checking.record);
    return code;
}
