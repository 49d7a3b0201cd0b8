/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a result and its sidecar, finds the files, answers again, and gathers what is not as it was. */
#include "cli/verify/verdict.h"

#include "base/path.h"
#include "base/system/system.h"
#include "cli/verify/differ.h"
#include "conus/file.h"
#include "conus/image.h"
#include "conus/version.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

static const uint64_t DEFAULT_MEMORY = UINT64_C(4) << 30;

/* A result on the way. */
struct checking {
    struct verdict *verdict;
    const struct verdict_settings *settings;
    char *text; /* of the result */
    size_t size;
    const struct recorded_file *output; /* what the result is among those recorded; NULL = not recorded */
};

static void say(struct lines *lines, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(struct lines *lines, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    char *line = NULL;
    if (lines->count == VERDICT_LINES || vasprintf(&line, format, args) < 0) {
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

void verdict_finish(struct verdict *verdict)
{
    for (size_t i = 0; verdict->found && i < verdict->record.input_count; i++) {
        free(verdict->found[i].path);
    }
    free(verdict->found);
    free(verdict->sidecar);
    lines_finish(&verdict->why);
    lines_finish(&verdict->notes);
    differences_finish(&verdict->differences);
    record_finish(&verdict->record);
}

/* "a.json" of "a.tsv", "a.nii.gz", "a.png" and "a". */
static char *path_without_ending(const char *result)
{
    static const char *const endings[] = {".nii.gz", ".tsv", ".csv", ".nii", ".png", ".exr"};
    size_t length = strlen(result);
    char *path = NULL;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends_in(result, endings[i])) {
            length -= strlen(endings[i]);
            break;
        }
    }
    return asprintf(&path, "%.*s.json", (int)length, result) < 0 ? NULL : path;
}

char *sidecar_find(const char *result)
{
    char *beside = NULL;
    if (path_ends_in(result, ".json") && system_allows(result, 0)) {
        return strdup(result);
    }
    if (asprintf(&beside, "%s.json", result) < 0) {
        return NULL;
    }
    if (!system_allows(beside, 0)) {
        free(beside);
        beside = path_without_ending(result);
    }
    if (beside && !system_allows(beside, 0)) {
        free(beside);
        beside = NULL;
    }
    return beside;
}

static bool read_sidecar(struct checking *checking)
{
    struct verdict *verdict = checking->verdict;
    bool own = provenance_json_rows(checking->text, checking->size);
    char *text = NULL;
    size_t size = 0;
    verdict->sidecar = checking->settings->sidecar ? strdup(checking->settings->sidecar)
                       : own                       ? strdup(verdict->result)
                                                   : sidecar_find(verdict->result);
    if (!verdict->sidecar) {
        say(&verdict->why, "there is no .json beside it that says how it was made; --sidecar FILE.json names it");
        return false;
    }
    if (own && !checking->settings->sidecar) {
        const char *bad = record_parse(&verdict->record, checking->text, checking->size);
        return !bad || (say(&verdict->why, "%s", bad), false);
    }
    messages_hold(true);
    int code = input_file_read(&text, &size, verdict->sidecar, INPUT_FILE, RECORD_LIMIT);
    messages_hold(false);
    if (code) {
        say(&verdict->why, "%s", error_line());
        return false;
    }
    const char *bad = record_parse(&verdict->record, text, size);
    free(text);
    return !bad || (say(&verdict->why, "%s: %s", verdict->sidecar, bad), false);
}

/* The rows of a result in JSON, else all of it. */
static const char *rows_of(const char *text, size_t size, size_t *rows_size)
{
    const char *rows = provenance_json_rows(text, size);
    *rows_size = rows ? size - (size_t)(rows - text) : size;
    return rows ? rows : text;
}

static bool is_recorded(const struct recorded_file *output, const char *rows, size_t size)
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
    struct verdict *verdict = checking->verdict;
    const struct record *record = &verdict->record;
    const struct recorded_file *named = NULL;
    size_t size;
    const char *rows = rows_of(checking->text, checking->size, &size);
    const struct recorded_file *equal = NULL;
    for (size_t i = 0; i < record->output_count; i++) {
        const struct recorded_file *output = &record->outputs[i];
        bool is_named = !output->path || strcmp(path_name(output->path), path_name(verdict->result)) == 0;
        bool is_equal = is_recorded(output, rows, size);
        named = is_named && (!named || is_equal) ? output : named;
        equal = is_equal && !equal ? output : equal;
    }
    checking->output = named && is_recorded(named, rows, size) ? named : named ? NULL : equal;
    if (checking->output) {
        return;
    }
    if (!record->output_count) {
        say(&verdict->notes, "%s has no SHA-256 of the result", verdict->sidecar);
    } else if (named) {
        say(&verdict->why, "%s was changed after conus wrote it: it has another %s than %s records", verdict->result,
            named->crc32 >= 0 ? "length or CRC-32" : "SHA-256", verdict->sidecar);
    } else {
        say(&verdict->why, "%s is the sidecar of %s, and neither name nor SHA-256 of %s are recorded there",
            verdict->sidecar, record->outputs[record->output_count - 1].path, verdict->result);
    }
    checking->output = named;
}

static void say_file(struct verdict *verdict, const struct recorded_file *file, const struct found_file *found)
{
    switch (found->state) {
    case FILE_SAME:
    case FILE_UNSUMMED:
        break;
    case FILE_MOVED:
        say(&verdict->notes, "%s is now %s", file->path, found->path);
        break;
    case FILE_UNKNOWN:
        say(&verdict->notes, "%s has no recorded SHA-256: taken as it is", file->path);
        break;
    case FILE_CHANGED:
        say(&verdict->why, "%s changed: its SHA-256 is not the recorded one", file->path);
        break;
    case FILE_MISSING:
        say(&verdict->why, "%s is missing; --search FOLDER looks for it by its SHA-256", file->path);
        break;
    }
}

/* Lists the other files of the same command that have changed since it wrote them. In JSON the recorded sum is that of
 * the rows. False without memory. */
static bool say_other_outputs(struct checking *checking, const struct places *places)
{
    struct verdict *verdict = checking->verdict;
    const struct record *record = &verdict->record;
    bool done = true;
    for (size_t i = 0; i < record->output_count && done; i++) {
        const struct recorded_file *output = &record->outputs[i];
        struct found_file found = {0};
        bool is_other =
            output != checking->output && output->path && output->sha256 && !path_ends_in(output->path, ".json");
        done = !is_other || file_find(&found, output, places);
        if (done && is_other && found.state == FILE_CHANGED) {
            say(&verdict->notes, "%s, which the same command wrote, was changed; with --sidecar %s it is verified, too",
                output->path, verdict->sidecar);
        }
        free(found.path);
    }
    return done;
}

/* Whether all files are there, changed or not. */
static int find_files(struct checking *checking, const char *written, bool *there)
{
    struct verdict *verdict = checking->verdict;
    const struct record *record = &verdict->record;
    struct places places = {.beside = {verdict->result, verdict->sidecar}};
    int code = EXIT_DONE;
    *there = true;
    for (size_t i = 0; i < checking->settings->folders.count && !code; i++) {
        code = places_add(&places, checking->settings->folders.items[i]);
    }
    if (places.is_cut) {
        say(&verdict->notes, "--search stopped after %d files and folders", SEARCH_ENTRIES);
    }
    for (size_t i = 0; i < record->output_count && !written; i++) {
        written = record->outputs[i].path;
    }
    places.base = base_folder(written, verdict->result);
    verdict->found = calloc(record->input_count + 1, sizeof *verdict->found);
    for (size_t i = 0; i < record->input_count && !code; i++) {
        bool done = verdict->found && file_find(&verdict->found[i], &record->inputs[i], &places);
        code = done ? EXIT_DONE : EXIT_DATA;
    }
    if (!code) {
        files_find_folders(verdict->found, record->inputs, record->input_count);
    }
    for (size_t i = 0; i < record->input_count && !code; i++) {
        say_file(verdict, &record->inputs[i], &verdict->found[i]);
        *there = *there && verdict->found[i].state != FILE_MISSING;
    }
    code = code || say_other_outputs(checking, &places) ? code : EXIT_DATA;
    places_finish(&places);
    return code;
}

/* Pictures have attributes that say when and where they were made: pixels count. */
static bool same_pixels(struct verdict *verdict, const char *again)
{
    conus_image *a = NULL;
    conus_image *b = NULL;
    conus_image_difference found = {0};
    conus_status status = conus_image_load(&a, verdict->result);
    status = status ? status : conus_image_load(&b, again);
    status = status ? status : conus_image_compare(&found, a, b, 0);
    if (status) {
        say(&verdict->why, "its bytes differ from those of the new answer: %s", conus_message());
    } else if (found.differing) {
        say(&verdict->why, "%llu of %llu pixels differ, the largest difference is %.9g, of channel %s at (%u, %u)",
            (unsigned long long)found.differing, (unsigned long long)found.pixels, found.max_difference, found.channel,
            found.x, found.y);
    }
    conus_image_destroy(a);
    conus_image_destroy(b);
    return !status && !found.differing;
}

static int compare_texts(struct checking *checking, const char *again, size_t again_size, const char *path)
{
    struct verdict *verdict = checking->verdict;
    size_t size;
    size_t other_size;
    const char *rows = rows_of(checking->text, checking->size, &size);
    const char *other = rows_of(again, again_size, &other_size);
    verdict->compared = true;
    verdict->same = size == other_size && memcmp(rows, other, size) == 0;
    if (verdict->same) {
        return EXIT_DONE;
    }
    if (path_is_picture(path)) {
        verdict->same = same_pixels(verdict, path);
        return EXIT_DONE;
    }
    if (memchr(rows, '\0', size) || memchr(other, '\0', other_size)) {
        say(&verdict->why, "its bytes differ from those of the new answer");
        return EXIT_DONE;
    }
    size_t first_line = 1;
    for (const char *at = checking->text; (at = memchr(at, '\n', (size_t)(rows - at))); at++) {
        first_line++;
    }
    bool found = differences_find(&verdict->differences, rows, size, other, other_size, first_line);
    return found ? EXIT_DONE : print_no_memory();
}

static bool is_other_version(const struct record *record)
{
    return strcmp(record->version, conus_version()) != 0;
}

/* The sidecar of the new answer, beside the output that conus lists last; NULL where there is none. */
static json_t *load_again(const struct checking *checking, const struct replay *replay)
{
    const struct record *record = &checking->verdict->record;
    char *path = stage_find_output(replay->folder,
                                   record->output_count ? record->outputs[record->output_count - 1].option : "output");
    char *sidecar = path ? sidecar_find(path) : NULL;
    json_t *again = sidecar ? provenance_load(sidecar, checking->settings->max_memory) : NULL;
    free(sidecar);
    free(path);
    return again;
}

/* Compares every value of the sidecar. Says a difference only where nothing else was said that it may follow from. */
static int compare_sidecars(struct checking *checking, const struct replay *replay)
{
    struct verdict *verdict = checking->verdict;
    const struct record *record = &verdict->record;
    const struct sidecar_terms terms = {.arguments = &replay->arguments,
                                        .folder = replay->is_moved ? replay->folder : NULL,
                                        .other_engine = replay->engine != NULL,
                                        .older = is_other_version(record)};
    char *difference = NULL;
    json_t *again = load_again(checking, replay);
    bool compared = again && sidecars_differ(&difference, record->root, again, &terms);
    if (!again) {
        say(&verdict->why, "%s: no sidecar is written when it is answered again", verdict->sidecar);
    } else if (difference && (!record->is_intact || !verdict->why.count)) {
        say(&verdict->why, "%s: %s", verdict->sidecar, difference);
    }
    free(difference);
    json_decref(again);
    if (again && !compared) {
        return print_no_memory();
    }
    return EXIT_DONE;
}

/* Says that another version wrote the result, which explains other rows where nothing else does. */
static void say_versions(struct checking *checking)
{
    struct verdict *verdict = checking->verdict;
    const struct record *record = &verdict->record;
    const char *engine = json_string_value(json_object_get(json_object_get(record->root, "Settings"), "engine"));
    if (is_other_version(record)) {
        say(verdict->same ? &verdict->notes : &verdict->why, "it was written by conus %s; this is %s", record->version,
            conus_version());
    }
    if (!verdict->same && !verdict->why.count) {
        say(&verdict->why, "all files are as recorded, and so is the result: this conus answers another way%s%s",
            engine ? "; it was answered by the engine " : "", engine ? engine : "");
    }
}

static bool endings_equal(const char *a, const char *b)
{
    const char *one = strrchr(path_name(a), '.');
    const char *other = strrchr(path_name(b), '.');
    return strcmp(one ? one : "", other ? other : "") == 0;
}

static int compare_again(struct checking *checking, struct replay *replay)
{
    struct verdict *verdict = checking->verdict;
    const char *option = checking->output ? checking->output->option : "output";
    char *path = stage_find_output(replay->folder, option);
    char *text = NULL;
    size_t size = 0;
    int code = EXIT_DONE;
    if (path && !checking->output && verdict->record.output_count && !endings_equal(path, verdict->result)) {
        free(path); /* another result's: of another kind, there is nothing to compare */
        return EXIT_DONE;
    }
    if (!path) {
        say(&verdict->why, "its command line writes nothing with --%.40s", option);
    } else if (input_file_read(&text, &size, path, INPUT_FILE, checking->settings->max_memory)) {
        say(&verdict->why, "%s", error_line());
    } else {
        code = compare_texts(checking, text, size, path);
        code = code ? code : compare_sidecars(checking, replay);
    }
    free(text);
    free(path);
    return code;
}

/* Adds the poses, whose checksum older sidecars do not record. */
static bool add_poses(struct replay *replay, struct record *record)
{
    const struct arguments *arguments = &replay->arguments;
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        if (use->option->role == OPTION_READS_POSES && !record_add_input(record, use->value)) {
            return false;
        }
    }
    return true;
}

/* Whether `word`, which may have keys behind it or an "@" before it, is a file that is as it was recorded. */
static bool is_known_file(const struct verdict *verdict, const char *word)
{
    bool known = false;
    word += *word == '@';
    for (size_t i = 0; i < verdict->record.input_count && !known; i++) {
        const char *path = verdict->record.inputs[i].path;
        size_t length = strlen(path);
        known = strncmp(word, path, length) == 0 && (!word[length] || word[length] == ',');
    }
    return known;
}

/* Whether the one who wrote the sidecar had all files that the command reads, so that its message may be shown. */
static bool knows_files(const struct verdict *verdict, const struct arguments *arguments)
{
    bool known = true;
    for (size_t i = 0; i < verdict->record.input_count; i++) {
        known = known && (verdict->found[i].state == FILE_SAME || verdict->found[i].state == FILE_MOVED);
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        enum option_role role = use->option->role;
        bool reads = (role >= OPTION_READS && role <= OPTION_READS_POSES) || (use->value && *use->value == '@');
        known = known && (!reads || is_known_file(verdict, use->value));
    }
    for (size_t i = 0; i < arguments->operand_count; i++) {
        known = known && is_known_file(verdict, arguments->operands[i]);
    }
    for (size_t i = 0; i < arguments->more.count; i++) {
        known = known && is_known_file(verdict, arguments->more.items[i]);
    }
    return known;
}

static int answer_again(struct checking *checking, struct replay *replay)
{
    struct verdict *verdict = checking->verdict;
    bool there = false;
    int code = find_files(checking,
                          checking->output && checking->output->path ? checking->output->path
                                                                     : option_text(&replay->arguments, "output"),
                          &there);
    if (code || !there) {
        return code;
    }
    replay->found = verdict->found;
    if (!replay_run(replay)) {
        bool is_shown = !replay->is_said || knows_files(verdict, &replay->arguments);
        say(&verdict->why, "%s",
            is_shown ? replay->why
                     : "it cannot be answered again; what its command says is not shown, since it may quote a file "
                       "whose SHA-256 is not recorded so: run the command yourself");
        return EXIT_DONE;
    }
    code = compare_again(checking, replay);
    if (verdict->compared) {
        say_versions(checking);
    }
    return code;
}

static int check_result(struct checking *checking, const struct command *const *commands)
{
    struct verdict *verdict = checking->verdict;
    struct record *record = &verdict->record;
    struct replay replay = {.record = record, .engine = checking->settings->engine_name};
    if (!read_sidecar(checking)) {
        return EXIT_DONE;
    }
    if (record->is_sealed && !record->is_intact) {
        say(&verdict->why, "%s was changed after conus wrote it: its Checksum does not fit", verdict->sidecar);
    } else if (!record->is_sealed) { /* which all versions write but those before the first release */
        say(&verdict->why, "%s has no Checksum: it may have been changed", verdict->sidecar);
    }
    find_output(checking);
    int code = EXIT_DONE;
    if (!replay_check(&replay, commands)) {
        say(&verdict->why, "%s", replay.why);
    } else if (!add_poses(&replay, record)) {
        code = print_no_memory();
    } else {
        code = answer_again(checking, &replay);
    }
    replay_finish(&replay);
    return code;
}

int verdict_find(struct verdict *out, const char *result, const struct verdict_settings *settings,
                 const struct command *const *commands)
{
    struct verdict_settings own = *settings;
    struct checking checking = {.verdict = out, .settings = &own};
    *out = (struct verdict){.kind = VERDICT_NONE, .result = result};
    own.max_memory = own.max_memory ? own.max_memory : DEFAULT_MEMORY;
    int code = input_file_read(&checking.text, &checking.size, result, INPUT_FILE, own.max_memory);
    code = code ? code : check_result(&checking, commands);
    free(checking.text);
    out->kind = !out->compared ? VERDICT_NONE : out->same && !out->why.count ? VERDICT_IDENTICAL : VERDICT_DIFFERENT;
    for (size_t i = 0; out->found && i < out->record.input_count && out->kind != VERDICT_IDENTICAL; i++) {
        struct found_file *found = &out->found[i];
        found->state = found->is_folder && found->state != FILE_MISSING ? FILE_UNSUMMED : found->state;
    }
    return code;
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

static const char *shown(const char *text)
{
    return text ? text + strspn(text, " ") : "nothing";
}

char *verdict_text(const struct verdict *verdict)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return NULL;
    }
    bool rows_only = verdict->kind == VERDICT_DIFFERENT && verdict->same;
    fprintf(out, "%s: %s%s\n", verdict->result, kinds[verdict->kind],
            rows_only ? ": it is answered the same again, but not all else is as it was" : "");
    size_t known = 0;
    size_t count = verdict->record.input_count;
    for (size_t i = 0; i < count; i++) {
        known += verdict->found[i].state == FILE_SAME || verdict->found[i].state == FILE_MOVED;
    }
    fprintf(out, "  answered again from %zu file%s, %zu with the SHA-256 in %s\n", count, count == 1 ? "" : "s", known,
            verdict->sidecar);
    const struct differences *found = &verdict->differences;
    for (size_t i = 0; i < found->listed; i++) {
        const struct difference *item = &found->items[i];
        fprintf(out, "  line %zu%s%s: %s, answered again: %s\n", item->line, *item->where ? ", " : "", item->where,
                shown(item->before), shown(item->after));
    }
    if (found->count) {
        fprintf(out, "  %zu of %zu lines differ\n", found->count, found->lines);
    }
    put_lines(out, "why", &verdict->why);
    put_lines(out, "note", &verdict->notes);
    if (system_text_close(&text)) {
        conus_plain_text(text.data);
    }
    return text.data;
}

void verdict_print_error(const struct verdict *verdict)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    for (size_t i = 0; out && i < verdict->why.count; i++) {
        fprintf(out, "%s%s", i ? "; " : "", verdict->why.items[i]);
    }
    const char *why = system_text_close(&text);
    print_error_line("%s: cannot be verified: %s", verdict->result, why ? why : "not enough memory");
    free(text.data);
}

/* Bytes that are no UTF-8 become null. */
static json_t *json_from_text(const char *text)
{
    json_t *string = text ? json_string(text) : NULL;
    return string ? string : json_null();
}

static json_t *json_from_lines(const struct lines *lines)
{
    json_t *list = json_array();
    for (size_t i = 0; i < lines->count; i++) {
        json_array_append_new(list, json_from_text(lines->items[i]));
    }
    return list;
}

char *verdict_json(const struct verdict *verdict)
{
    json_t *differences = json_array();
    json_t *files = json_array();
    for (size_t i = 0; i < verdict->differences.listed; i++) {
        const struct difference *item = &verdict->differences.items[i];
        json_array_append_new(differences,
                              json_pack("{s: I, s: o, s: o, s: o}", "line", (json_int_t)item->line, "where",
                                        json_from_text(item->where), "recorded", json_from_text(item->before), "again",
                                        json_from_text(item->after)));
    }
    for (size_t i = 0; verdict->found && i < verdict->record.input_count; i++) {
        const struct recorded_file *file = &verdict->record.inputs[i];
        json_array_append_new(files,
                              json_pack("{s: s, s: o, s: o, s: s}", "path", file->path, "sha256",
                                        json_from_text(file->sha256), "found", json_from_text(verdict->found[i].path),
                                        "state", file_state_names[verdict->found[i].state]));
    }
    json_t *root =
        json_pack("{s: o, s: o, s: s, s: b, s: o, s: o, s: I, s: o, s: o}", "result", json_from_text(verdict->result),
                  "sidecar", json_from_text(verdict->sidecar), "verdict", kinds[verdict->kind], "same_rows",
                  verdict->compared && verdict->same, "why", json_from_lines(&verdict->why), "notes",
                  json_from_lines(&verdict->notes), "lines_that_differ", (json_int_t)verdict->differences.count,
                  "differences", differences, "files", files);
    char *dumped = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    char *text = NULL;
    if (dumped && asprintf(&text, "%s\n", dumped) < 0) {
        text = NULL;
    }
    free(dumped);
    json_decref(root);
    return text;
}
