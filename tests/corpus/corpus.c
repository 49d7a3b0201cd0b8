/* SPDX-License-Identifier: BSD-3-Clause */
/* corpus FOLDER: asks each file of a folder of the corpus what `conus info --format json` says of it, and compares with
 * the folder's facts.json (README.md). Then it asks the same of every prefix of the file, with every allocation
 * failing, and with every primitive of a job failing (base/job/job.h). */
#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/path.h"
#include "base/text.h"
#include "cli/answers/answers.h"
#include "options/messages.h"
#include "options/options.h"
#include "settings/settings.h"
#include "test.h"

#include <assert.h>
#include <ctype.h>
#include <fcntl.h>
#include <ftw.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* PREFIXES, FEW, FAILURES: as many of a file are tried one by one; of more, some. FEW are tried of a file that is
 * refused, or of one beside the file of the entry: their like is read in other entries. CHILD_PREFIXES, CHILD_FAILURES:
 * of one that another process reads, which takes longer. */
enum { PREFIXES = 4096, FEW = 512, FAILURES = 2000, CHILD_PREFIXES = 4, CHILD_FAILURES = 2 };
enum { PATH_SIZE = 1024, WORD_LIMIT = 64, LARGEST = 1 << 26 };

/* The options of `conus info` that say what is loaded. */
struct posed {
    struct atlas_settings atlas;
    struct context_choice context;
    struct common_settings common;
};

static const struct option_group groups[] = {
    {"", atlas_options, offsetof(struct posed, atlas)},
    {"", context_choice_options, offsetof(struct posed, context)},
    {"", plain_options, offsetof(struct posed, common)},
    {0},
};
static const struct command command = {
    .name = "info", .operands = {"ATLAS"}, .groups = groups, .settings_size = sizeof(struct posed)};

struct answer {
    int code;      /* The exit code. */
    json_t *json;  /* NULL of a refusal. */
    char *line;    /* That says why; NULL of an answer. */
    bool unharmed; /* No allocation failed. */
    bool memory;   /* A refusal that says that memory is missing. */
};

/* A file of the corpus with one of its questions. */
struct entry {
    const char *folder, *file;
    json_t *facts;
    char *words[WORD_LIMIT]; /* `conus info`, the file and what its facts say under "with". */
    int word_count;
};

/* How many of what could be tried are; `child` of a file that another process reads. */
static size_t trials(const struct entry *entry, size_t child, size_t all)
{
    return json_is_true(json_object_get(entry->facts, "child")) ? child : test_cases(all);
}

static struct {
    size_t entries, strange, prefixes, failures, primitives, faults;
    json_t *cut; /* Names and sums of files in folders whose prefixes were asked. */
} total;

static void report(const struct entry *entry, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void report(const struct entry *entry, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fprintf(stderr, "%s: ", entry->file);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    total.faults++;
}

/* The status of the newest message: exit codes do not tell missing memory from bad data. */
static conus_status said;

int __real_print_status(conus_status status);
int __wrap_print_status(conus_status status);

int __wrap_print_status(conus_status status)
{
    said = status;
    return __real_print_status(status);
}

/* The label of a voxel, 0 for none; its value where the volume has values. */
static json_t *voxel_of(const conus_atlas *atlas, const struct volume *volume, size_t v)
{
    if (volume_has_values(volume)) {
        float value = volume_value(volume, v);
        return isfinite(value) ? json_real(value) : json_null();
    }
    const conus_object *object = conus_atlas_object(atlas, volume_object(volume, v));
    return json_integer(object ? object->label : 0);
}

/* Adds to each small volume of the JSON its "voxels", the first index fastest. */
static void add_voxels(json_t *json, const conus_atlas *atlas)
{
    enum { MOST = 1000 };
    json_t *volume;
    size_t i;
    json_array_foreach(json_object_get(json, "volumes"), i, volume)
    {
        const struct volume *from = &atlas->volumes[i];
        const size_t count = from->info.dim[0] * from->info.dim[1] * from->info.dim[2];
        json_t *voxels = json_array();
        for (size_t v = 0; v < count && count <= MOST; v++) {
            json_array_append_new(voxels, voxel_of(atlas, from, v));
        }
        json_object_set_new(volume, "voxels", voxels);
    }
}

/* Loads what the settings say; the allocation number `failing` and all later ones fail, none if it is -1. */
static void load(struct answer *out, const struct entry *entry, const struct posed *question, const char *path,
                 long failing)
{
    conus_atlas *atlas = NULL;
    said = CONUS_OK;
    test_fail_allocation(failing);
    out->code = atlas_input_load(&atlas, path, &question->atlas);
    if (out->code && atlas) {
        report(entry, "failed, and gave an atlas");
    }
    out->code = out->code ? out->code : context_choice_load(atlas, &question->context, &question->atlas);
    out->unharmed = !test_allocation_failed();
    test_fail_allocation(-1);
    out->memory = said == CONUS_ERROR_MEMORY || strstr(error_line(), "memory");
    json_t *json = out->code ? NULL : info_json(atlas, NULL);
    char *text = json ? json_dumps(json, JSON_REAL_PRECISION(9)) : NULL; /* the digits of the program's */
    out->json = text ? json_loads(text, 0, NULL) : NULL;
    json_decref(json);
    free(text);
    add_voxels(out->json, atlas);
    conus_atlas_destroy(atlas);
    out->line = out->code ? strdup(error_line()) : NULL;
    if (out->code && (!*error_line() || (said && strpbrk(conus_message(), "\n\r")))) {
        report(entry, "the message is not one line: %s", conus_message());
    }
    if (out->code ? out->code != EXIT_USAGE && out->code != EXIT_DATA : !out->json) {
        report(entry, "exit code %d", out->code);
    }
}

static void ask(struct answer *out, const struct entry *entry, long failing)
{
    struct posed question = {0};
    struct arguments arguments;
    *out = (struct answer){.unharmed = true};
    out->code = options_parse(&arguments, &question, &command, NULL, entry->word_count, (char **)entry->words, 2);
    if (out->code < 0) {
        load(out, entry, &question, arguments.operands[0], failing);
    } else {
        out->line = strdup(error_line());
    }
    options_finish(&question, &arguments);
}

static void answer_finish(struct answer *answer)
{
    json_decref(answer->json);
    free(answer->line);
    *answer = (struct answer){0};
}

/* Reports where `found` lacks what `facts` say; `where` is its place, "volumes[0].dim". */
static void compare(const struct entry *entry, const char *where, json_t *found, json_t *facts)
{
    char place[PATH_SIZE];
    const char *key;
    json_t *fact;
    size_t i;
    bool same = found && json_typeof(found) == json_typeof(facts);
    if (found && json_is_number(found) && json_is_number(facts)) {
        double wanted = json_number_value(facts);
        same = fabs(json_number_value(found) - wanted) <= 1e-6 * fabs(wanted) + 1e-9;
    } else if (same && json_is_array(facts)) {
        same = json_array_size(found) == json_array_size(facts);
    } else if (same && !json_is_object(facts)) {
        same = json_equal(found, facts);
    }
    if (!same) {
        char *is = found ? json_dumps(found, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
        char *wanted = json_dumps(facts, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(9));
        report(entry, "%s is %s, its facts say %s", where, is ? is : "missing", wanted);
        free(is);
        free(wanted);
    } else if (json_is_object(facts)) {
        json_object_foreach(facts, key, fact)
        {
            snprintf(place, sizeof place, "%s%s%s", where, *where ? "." : "", key);
            compare(entry, place, json_object_get(found, key), fact);
        }
    } else if (json_is_array(facts)) {
        json_array_foreach(facts, i, fact)
        {
            snprintf(place, sizeof place, "%s[%zu]", where, i);
            compare(entry, place, json_array_get(found, i), fact);
        }
    }
}

/* Compares a refusal with the facts: the line behind the name of the file, and the exit code. */
static void compare_refusal(const struct entry *entry, const struct answer *answer)
{
    const char *wanted = json_string_value(json_object_get(entry->facts, "refused"));
    const char *line = answer->line;
    size_t length = strlen(entry->file);
    if (line && strncmp(line, entry->file, length) == 0 && strncmp(line + length, ": ", 2) == 0) {
        line += length + 2;
    }
    if (!wanted) {
        report(entry, "is refused: %s", line);
    } else if (!answer->code) {
        report(entry, "is read, its facts say that it is refused: %s", wanted);
    } else if (strcmp(line, wanted) != 0) {
        report(entry, "is refused: %s\n    its facts say: %s", line, wanted);
    } else if (answer->code != json_integer_value(json_object_get(entry->facts, "code"))) {
        report(entry, "ends with exit code %d", answer->code);
    }
}

static bool is_search(json_t *note)
{
    static const char start[] = "no label table found: ";
    return strncmp(json_string_value(note), start, strlen(start)) == 0;
}

/* Compares all notes; the long one that says where a label table was looked for only if the facts have it. */
static void compare_notes(const struct entry *entry, json_t *notes, json_t *facts)
{
    json_t *found = json_array();
    json_t *wanted = facts ? json_incref(facts) : json_array();
    json_t *note;
    size_t i;
    bool is_stated = false;
    json_array_foreach(wanted, i, note)
    {
        is_stated = is_stated || is_search(note);
    }
    json_array_foreach(notes, i, note)
    {
        if (is_stated || !is_search(note)) {
            json_array_append(found, note);
        }
    }
    compare(entry, "notes", found, wanted);
    json_decref(found);
    json_decref(wanted);
}

/* The objects that `names` means, {"1": "Area 17", "2": null}: these areas in this order, a number without a name for
 * null, and nothing else said of any. */
static json_t *objects_of(json_t *names)
{
    json_t *objects = json_array();
    const char *number;
    json_t *name;
    json_object_foreach(names, number, name)
    {
        json_array_append_new(objects, json_pack("{s:I, s:b, s:s, s:n, s:n, s:n}", "index",
                                                 (json_int_t)strtoull(number, NULL, 10), "named", json_is_string(name),
                                                 "name", json_is_string(name) ? json_string_value(name) : number,
                                                 "abbreviation", "parent", "hemisphere"));
    }
    return objects;
}

static void check_facts(const struct entry *entry, const struct answer *answer)
{
    static const char *const keys[] = {"like", "is", "with", "child", "facts", "notes", "enough", "refused", "code"};
    const char *key;
    json_t *value;
    json_object_foreach(entry->facts, key, value)
    {
        bool known = false;
        for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
            known = known || strcmp(key, keys[i]) == 0;
        }
        if (!known) {
            report(entry, "unknown key \"%s\" in facts.json", key);
        }
    }
    if (!json_is_string(json_object_get(entry->facts, "is"))) {
        report(entry, "its facts do not say what it \"is\"");
    }
    if (answer->code || json_object_get(entry->facts, "refused")) {
        compare_refusal(entry, answer);
        return;
    }
    json_t *facts = json_object_get(entry->facts, "facts");
    compare_notes(entry, json_object_get(answer->json, "notes"), json_object_get(entry->facts, "notes"));
    if (json_object_size(facts)) {
        json_t *names = json_object_get(facts, "names");
        if (names) {
            json_object_set_new(facts, "objects", objects_of(names));
            json_object_del(facts, "names");
        }
        compare(entry, "", answer->json, facts);
    } else {
        report(entry, "has no facts");
    }
}

/* Takes away what differs between a file and its prefix even if all that is said of them is the same. */
static void drop_sums(json_t *answer)
{
    static const char *const lists[] = {"volumes", "tractograms", "context_surfaces"};
    for (size_t l = 0; l < sizeof lists / sizeof lists[0]; l++) {
        json_t *item;
        size_t i;
        json_array_foreach(json_object_get(answer, lists[l]), i, item)
        {
            json_object_del(item, "sha256");
        }
    }
}

/* How many bytes of a file that is read say all that it says: those that its facts name; else all, but white space at
 * its end. */
static size_t enough(const struct entry *entry, const char *path)
{
    struct bytes bytes = {0};
    json_t *stated = json_object_get(entry->facts, "enough");
    if (stated) {
        return (size_t)json_integer_value(stated);
    }
    if (file_read(&bytes, path, LARGEST)) {
        report(entry, "%s", conus_message());
        return 0;
    }
    size_t size = bytes.size;
    while (size && memchr(" \n\r\t", bytes.data[size - 1], 4)) {
        size--;
    }
    bytes_finish(&bytes);
    return size;
}

/* Writes a new file without waiting for the disk, as conus_write_file() does, and ext4 where one is emptied. */
static bool write_file(const char *path, const struct bytes *bytes)
{
    unlink(path);
    FILE *file = fopen(path, "wb");
    bool whole = file && fwrite(bytes->data, 1, bytes->size, file) == bytes->size;
    return file && !fclose(file) && whole;
}

/* Whether a file of this name with these bytes was cut before, as the volume beside many tables. */
static bool was_cut(const char *path, const struct bytes *bytes)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    for (size_t i = 0; i < bytes->size; i++) {
        hash = (hash ^ bytes->data[i]) * UINT64_C(0x100000001b3);
    }
    char key[PATH_SIZE];
    const char *slash = strrchr(path, '/');
    snprintf(key, sizeof key, "%s %zu %" PRIx64, slash ? slash + 1 : path, bytes->size, hash);
    bool was = json_object_get(total.cut, key);
    json_object_set_new(total.cut, key, json_true());
    return was;
}

/* Asks about every prefix of the file `path`, from long to short: it is read or refused. If the file is `main`, one
 * that is too short must not give the whole one's answer. */
static void check_prefixes(const struct entry *entry, const struct answer *whole, const char *path, bool main)
{
    struct bytes bytes = {0};
    size_t needed = main && !whole->code ? enough(entry, path) : 0;
    size_t least = SIZE_MAX;
    if (file_read(&bytes, path, LARGEST)) {
        report(entry, "%s", conus_message());
        return;
    }
    size_t step = bytes.size / trials(entry, CHILD_PREFIXES, main && !whole->code ? PREFIXES : FEW) + 1;
    size_t end = strchr(path, '/') && was_cut(path, &bytes) ? 0 : bytes.size;
    for (size_t cut = 1; cut <= end; cut += step, total.prefixes++) {
        struct answer answer;
        if (truncate(path, (off_t)(bytes.size - cut))) {
            report(entry, "%s: cannot be cut", path);
            break;
        }
        ask(&answer, entry, -1);
        drop_sums(answer.json);
        if (answer.json && json_equal(answer.json, whole->json)) {
            least = bytes.size - cut;
        }
        answer_finish(&answer);
    }
    if (least < needed) {
        report(entry, "%zu of its %zu bytes give the same answer", least, bytes.size);
    }
    if (!write_file(path, &bytes)) {
        report(entry, "%s: cannot be written", path);
    }
    bytes_finish(&bytes);
}

/* Parts that no reader knows, of each kind of text file: they are refused, or a note names them. Each goes behind the
 * character that is there so many times; 0: in front. A column goes behind each line. */
#define UNKNOWN "unheard"
/* Files in which anybody may put more (docs/formats.md#what-is-passed-over). */
#define PASSED_OVER ".zattrs/.zarray/zarr.json/manifest.json/-04.json/-05.json"
static const struct strange {
    const char *begins, *endings; /* How such a file begins, and how its name ends, '/' between them; NULL: any. */
    char behind;
    int times;
    const char *text; /* NULL: a column. */
} stranges[] = {
    {"NRRD000", NULL, '\n', 1, UNKNOWN ": 5\n"},
    {NULL, ".mha/.mhd", '\n', 1, UNKNOWN " = 5\n"},
    {"#Insight Transform", NULL, '\n', 2, UNKNOWN ": 5\n"},
    {"MNI Transform", NULL, '\n', 1, UNKNOWN " = 5;\n"},
    {"type", ".lta", '\n', 1, UNKNOWN " = 5\n"},
    {"ply\n", NULL, '\n', 2, UNKNOWN " 5\n"},
    {"# vtk DataFile", NULL, '\n', 4, UNKNOWN " 5\n"},
    {NULL, ".obj", 0, 0, UNKNOWN " 5\n"},
    {NULL, ".niml.lt", 0, 0, "<" UNKNOWN " a=\"5\" />\n"},
    {"<", NULL, '>', 1, "<" UNKNOWN ">5</" UNKNOWN ">"},
    {"{", NULL, '{', 1, "\"" UNKNOWN "\": 5, "},
    {"[", NULL, '{', 1, "\"" UNKNOWN "\": 5, "},
    {NULL, ".tsv/.csv", 0, 0, NULL},
    {NULL, ".txt/.lut/.label/.ctbl", '\n', 2, UNKNOWN " x\n"},
};

/* Where the part goes in a file that begins so; SIZE_MAX if it is another, or no text up to there. */
static size_t find_strange_place(const struct strange *strange, const char *file, const struct bytes *bytes)
{
    const char *data = (const char *)bytes->data;
    const size_t length = strange->begins ? strlen(strange->begins) : 0;
    size_t at = 0;
    if (bytes->size <= length || memcmp(data, strange->begins ? strange->begins : "", length) != 0 ||
        (strange->endings && !path_ending_length(file, strange->endings))) {
        return SIZE_MAX;
    }
    while (strange->behind == '>' && at + 1 < bytes->size &&
           !(data[at] == '<' && isalpha((unsigned char)data[at + 1]))) {
        at++;
    }
    for (int i = 0; i < strange->times; i++) {
        const char *end = memchr(data + at, strange->behind, bytes->size - at);
        if (!end || memchr(data + at, 0, (size_t)(end - data) - at) || (end > data && end[-1] == '/')) {
            return SIZE_MAX;
        }
        at = (size_t)(end - data) + 1;
    }
    return at;
}

/* A table without a header stays as it is. */
static void add_column(struct buffer *out, const struct bytes *bytes)
{
    struct text rest = text_from_bytes(bytes->data, bytes->size);
    struct text line;
    const char *cell = UNKNOWN;
    while (text_line(&rest, &line)) {
        char separator = text_mentions(line, "\t") ? '\t' : text_mentions(line, ";") ? ';' : ',';
        bool is_first = strcmp(cell, UNKNOWN) == 0;
        bool is_comment = text_starts(line, "#") && is_first;
        if (is_first && line.size && isdigit((unsigned char)line.data[0])) {
            buffer_clear(out);
            return;
        }
        buffer_format(out, is_comment ? "%.*s\n" : "%.*s%c%s\n", (int)line.size, line.data, separator, cell);
        cell = is_comment ? cell : "5";
    }
}

static bool has_unknown(const json_t *answer)
{
    json_t *note;
    size_t i;
    bool has = false;
    json_array_foreach(json_object_get(answer, "notes"), i, note)
    {
        has = has || strstr(json_string_value(note), UNKNOWN);
    }
    return has;
}

/* Asks of the file with a part that is not known: the answer is a refusal or has a note, either of which names it. */
static void check_strange(const struct entry *entry)
{
    struct bytes bytes = {0};
    size_t place = SIZE_MAX;
    size_t i = 0;
    if (file_read(&bytes, entry->file, LARGEST)) {
        return; /* a folder */
    }
    for (; i < sizeof stranges / sizeof stranges[0] && place == SIZE_MAX; i++) {
        place = find_strange_place(&stranges[i], entry->file, &bytes);
    }
    if (place != SIZE_MAX && !path_ending_length(entry->file, PASSED_OVER)) {
        struct buffer text = {0};
        struct answer answer;
        if (stranges[i - 1].text) {
            buffer_append(&text, bytes.data, place);
            buffer_format(&text, "%s", stranges[i - 1].text);
            buffer_append(&text, bytes.data + place, bytes.size - place);
        } else {
            add_column(&text, &bytes);
        }
        if (text.size) {
            write_file(entry->file, &(struct bytes){(uint8_t *)text.data, text.size});
        }
        ask(&answer, entry, -1);
        if (text.size && !answer.code && !has_unknown(answer.json)) {
            report(entry, "a part that is not known is passed over: %s",
                   stranges[i - 1].text ? stranges[i - 1].text : "a column");
        }
        answer_finish(&answer);
        write_file(entry->file, &bytes);
        buffer_finish(&text);
        total.strange++;
    }
    bytes_finish(&bytes);
}

/* Whether the answer is that of a program without faults. */
static bool is_whole(const struct answer *answer, const struct answer *whole)
{
    drop_sums(answer->json);
    return answer->code == whole->code &&
           (answer->code ? strcmp(answer->line, whole->line) == 0 : json_equal(answer->json, whole->json));
}

/* Asks with every allocation failing: the answer is that of all memory, or that memory is missing. */
static void check_allocations(const struct entry *entry, const struct answer *whole)
{
    const long most = (long)trials(entry, CHILD_FAILURES, FAILURES);
    bool unharmed = false;
    for (long n = 0; !unharmed; n += 1 + n / most, total.failures++) {
        struct answer answer;
        ask(&answer, entry, n);
        unharmed = answer.unharmed;
        if (!is_whole(&answer, whole) && (!answer.code || !answer.memory)) {
            report(entry, "without memory (allocation %ld): %s", n, answer.code ? answer.line : "another answer");
        }
        answer_finish(&answer);
    }
}

/* Asks with each primitive of a job failing: for want of memory the answer is that of all memory, or says that memory
 * is missing; by bad data there is none, or that of what is done instead. */
static void check_primitives(const struct entry *entry, const struct answer *whole)
{
    const size_t most = trials(entry, CHILD_FAILURES, whole->code ? FEW : FAILURES);
    bool reached = true;
    for (size_t k = 1; reached; k += 1 + k / most, total.primitives += 2) {
        for (int data = 0; data < 2; data++) {
            struct answer answer;
            test_fail_primitive(k, data ? CONUS_ERROR_DATA : CONUS_ERROR_MEMORY);
            ask(&answer, entry, -1);
            reached = test_primitives() >= k;
            if (!data && said != CONUS_ERROR_MEMORY && !is_whole(&answer, whole)) {
                report(entry, "primitive %zu without memory: %s", k, answer.code ? answer.line : "another answer");
            }
            answer_finish(&answer);
        }
    }
    test_fail_primitive(0, CONUS_OK);
}

/* The folder that nftw() copies, to the folder of the process. */
static size_t root_length;

static int copy_entry(const char *path, const struct stat *info, int type, struct FTW *walk)
{
    struct bytes bytes = {0};
    (void)info;
    (void)walk;
    if (type == FTW_D) {
        return mkdir(path + root_length, 0777);
    }
    bool is_copied = !file_read(&bytes, path, LARGEST) && write_file(path + root_length, &bytes);
    bytes_finish(&bytes);
    return is_copied ? 0 : -1;
}

/* Copies the file or folder of the corpus that a word names, unless it has been, or there is none. */
static void copy(const struct entry *entry, const char *name)
{
    enum { OPEN_FOLDERS = 8 };
    char path[PATH_SIZE];
    snprintf(path, sizeof path, "%s/%.*s", entry->folder, (int)strcspn(name, "/"), name);
    root_length = strlen(entry->folder) + 1;
    if (access(path, F_OK)) { /* keys stand behind the file's name */
        path[root_length + strcspn(path + root_length, ",")] = '\0';
    }
    if (path[root_length] && access(path + root_length, F_OK) && !access(path, F_OK) &&
        nftw(path, copy_entry, OPEN_FOLDERS, FTW_PHYS)) {
        report(entry, "%s: cannot be copied", path);
    }
}

/* The file or folder that nftw() walks through. Of a folder with several entries, the files that are no entry are cut
 * by the first one alone. */
static struct {
    const struct entry *entry;
    const struct answer *whole;
    json_t *all; /* The entries of facts.json. */
    char top[PATH_SIZE];
    bool is_cut;
} walked;

static int check_part(const char *path, const struct stat *info, int type, struct FTW *walk)
{
    (void)info;
    (void)walk;
    bool main = strcmp(path, walked.entry->file) == 0;
    if (type == FTW_F && (main || !(walked.is_cut || json_object_get(walked.all, path)))) {
        check_prefixes(walked.entry, walked.whole, path, main);
    }
    return 0;
}

static void check_entry(struct entry *entry)
{
    enum { OPEN_FOLDERS = 8 };
    struct answer whole;
    size_t faults = total.faults;
    char top[PATH_SIZE];
    copy(entry, entry->file);
    for (int i = 2; i < entry->word_count; i++) { /* behind `conus info` */
        copy(entry, entry->words[i]);
    }
    ask(&whole, entry, -1);
    check_facts(entry, &whole);
    if (total.faults == faults && !whole.code) {
        check_strange(entry);
    }
    if (total.faults == faults && test_takes(total.entries)) {
        drop_sums(whole.json);
        walked.entry = entry;
        walked.whole = &whole;
        snprintf(top, sizeof top, "%.*s", (int)strcspn(entry->file, "/"), entry->file);
        walked.is_cut = strcmp(top, walked.top) == 0;
        snprintf(walked.top, sizeof walked.top, "%s", top);
        nftw(top, check_part, OPEN_FOLDERS, FTW_PHYS);
        check_allocations(entry, &whole);
        check_primitives(entry, &whole);
    }
    answer_finish(&whole);
    total.entries++;
}

/* The place of {}, which stands for the file, or of {/}, its folder, in a word; NULL without. */
static const char *find_place(const char *word)
{
    const char *file = strstr(word, "{}");
    return file ? file : strstr(word, "{/}");
}

/* Puts the words of the command line together; the file is the first if it has no place in another. */
static void take_words(struct entry *entry)
{
    json_t *with = json_object_get(entry->facts, "with");
    json_t *word;
    size_t i;
    bool is_placed = false;
    json_array_foreach(with, i, word)
    {
        is_placed = is_placed || find_place(json_string_value(word));
    }
    entry->words[entry->word_count++] = strdup("conus");
    entry->words[entry->word_count++] = strdup("info");
    if (!is_placed) {
        entry->words[entry->word_count++] = strdup(entry->file);
    }
    json_array_foreach(with, i, word)
    {
        char text[PATH_SIZE];
        const char *given = json_string_value(word);
        const char *place = find_place(given);
        const size_t before = place ? (size_t)(place - given) : strlen(given);
        const char *slash = strrchr(entry->file, '/');
        const size_t length = !place                     ? 0
                              : place[1] == '/' && slash ? (size_t)(slash - entry->file)
                                                         : strlen(entry->file);
        snprintf(text, sizeof text, "%.*s%.*s%s", (int)before, given, (int)length, entry->file,
                 place ? strchr(place, '}') + 1 : "");
        entry->words[entry->word_count++] = strdup(text);
        assert(entry->word_count < WORD_LIMIT);
    }
}

/* Puts `change` into a copy of `base`: members and, in lists of one length, elements that it does not have stay. */
static json_t *merged(json_t *base, json_t *change)
{
    const char *key;
    json_t *value;
    size_t i;
    const bool are_objects = json_is_object(base) && json_is_object(change);
    const bool are_lists =
        json_is_array(base) && json_is_array(change) && json_array_size(base) == json_array_size(change);
    json_t *out = are_objects || are_lists ? json_copy(base) : json_incref(change);
    json_object_foreach(are_objects ? change : NULL, key, value)
    {
        json_t *old = json_object_get(base, key);
        json_object_set_new(out, key, old ? merged(old, value) : json_incref(value));
    }
    json_array_foreach(are_lists ? change : NULL, i, value)
    {
        json_array_set_new(out, i, merged(json_array_get(base, i), value));
    }
    return out;
}

/* A row "like" another one has what that one has, but for what it says itself. */
static void take_likes(json_t *rows)
{
    const char *file;
    json_t *row;
    void *next;
    json_object_foreach_safe(rows, next, file, row)
    {
        json_t *like =
            json_object_get(rows, json_is_object(row) ? json_string_value(json_object_get(row, "like")) : NULL);
        if (like) {
            json_object_set_new(rows, file, merged(like, row));
        }
    }
}

/* Runs an entry in a fresh folder, where nothing else lies. */
static void run_entry(const char *folder, const char *file, json_t *facts)
{
    struct entry entry = {.folder = folder, .file = file, .facts = facts};
    char name[32];
    int here = open(".", O_RDONLY | O_DIRECTORY);
    snprintf(name, sizeof name, "%zu", total.entries);
    test_folder(name);
    take_words(&entry);
    if (here < 0 || chdir(test_in(""))) {
        report(&entry, "no folder to work in");
    } else {
        check_entry(&entry);
        assert(fchdir(here) == 0);
    }
    close(here);
    for (int i = 0; i < entry.word_count; i++) {
        free(entry.words[i]);
    }
}

int main(int argc, char **argv)
{
    static const char *const elsewhere[] = {"FREESURFER_HOME", "FSLDIR", "SUBJECTS_DIR"};
    char path[PATH_SIZE];
    json_error_t error;
    const char *file;
    json_t *facts;
    char *folder = argc == 2 || argc == 3 ? realpath(argv[1], NULL) : NULL;
    snprintf(path, sizeof path, "%s/facts.json", folder ? folder : "");
    json_t *all = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!json_is_object(all)) {
        fprintf(stderr, "usage: corpus FOLDER [FILE]\n%s: line %d: %s\n", path, error.line, error.text);
        return 2;
    }
    for (size_t i = 0; i < sizeof elsewhere / sizeof elsewhere[0]; i++) {
        unsetenv(elsewhere[i]);
    }
    take_likes(all);
    total.cut = json_object();
    messages_hold(true);
    walked.all = all;
    json_object_foreach(all, file, facts)
    {
        json_t *each;
        size_t i;
        if (argc == 3 && strcmp(argv[2], file) != 0) {
            continue;
        }
        if (json_is_object(facts)) {
            run_entry(folder, file, facts);
        }
        json_array_foreach(facts, i, each)
        {
            run_entry(folder, file, each);
        }
    }
    json_decref(all);
    json_decref(total.cut);
    free(folder);
    printf("%zu entries, %zu with unknown parts, %zu prefixes, %zu failing allocations, %zu failing primitives, %.1f "
           "s; %zu faults\n",
           total.entries, total.strange, total.prefixes, total.failures, total.primitives,
           (double)clock() / CLOCKS_PER_SEC, total.faults);
    return total.entries && !total.faults ? EXIT_SUCCESS : EXIT_FAILURE;
}
