/* SPDX-License-Identifier: BSD-3-Clause */
/* points FOLDER [FILE]: reads each file of the folder as points or poses, and compares with what facts.json says of it
 * (README.md): how many rows, the first and the last one, whose brain, or a part of the refusal. Then it reads every
 * prefix, the file with every bit flipped, and with every allocation failing. */
#include "base/files/file.h"
#include "builders/nifti_builder.h"
#include "builders/place_atlas.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "test.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { PREFIXES = 4096, FEW = 512, FLIPS = 8192, FAILURES = 4000, PATH_SIZE = 1024, LARGEST = 1 << 20, LONGEST = 230 };

/* Spaces that need an atlas have the frame of one whose world is right, anterior, superior from the space's origin. */
static const conus_frame frames[] = {
    {.space = CONUS_SPACE_CCF, .world_from_space = {0, -1e-3, 0, 0, 0, 0, -1e-3, 0, 1e-3, 0, 0, 0, 0, 0, 0, 1}},
    {.space = CONUS_SPACE_BREGMA,
     .world_from_space = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
     .bregma = {5400, 332, 5739}},
};

/* A file of the corpus. */
struct entry {
    const char *file;
    json_t *facts;
    conus_pose_options options;
};

/* What is said of it. */
struct answer {
    conus_status status;
    conus_pose_list *list; /* NULL of a refusal. */
    char *line;            /* Why it is refused; NULL of an answer. */
};

static struct {
    size_t entries, refused, pending, prefixes, flips, unseen, failures, faults;
    bool is_quiet;      /* A pending entry is asked: faults are counted, not shown. */
    conus_atlas *atlas; /* Of MNI 152. */
    conus_atlas *named; /* Whose areas files name. */
} total;

static void report(const struct entry *entry, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void report(const struct entry *entry, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (!total.is_quiet) {
        fprintf(stderr, "%s: ", entry->file);
        vfprintf(stderr, format, args);
        fputc('\n', stderr);
    }
    va_end(args);
    total.faults++;
}

static const char *fact_text(const struct entry *entry, const char *key)
{
    return json_string_value(json_object_get(entry->facts, key));
}

/* Reads the file, and asks whether its brain is the atlas's where the facts do not say that it is another. */
static struct answer ask(const struct entry *entry, const char *path)
{
    struct answer answer = {0};
    answer.status = conus_pose_list_load(&answer.list, path, &entry->options);
    if (!answer.status && entry->options.space < CONUS_SPACE_CCF && !fact_text(entry, "brain")) {
        answer.status = conus_pose_list_match(answer.list, total.atlas);
    }
    if (answer.status) {
        const char *line = conus_message();
        size_t length = strlen(path);
        bool is_named = strncmp(line, path, length) == 0 && line[length] == ':';
        answer.line = strdup(line + (is_named ? length + 1 + (line[length + 1] == ' ') : 0));
        conus_pose_list_destroy(answer.list);
        answer.list = NULL;
        if (!*answer.line || strpbrk(answer.line, "\n\r")) {
            report(entry, "the message is not one line: %s", answer.line);
        }
    }
    return answer;
}

static void answer_finish(struct answer *answer)
{
    conus_pose_list_destroy(answer->list);
    free(answer->line);
    *answer = (struct answer){0};
}

/* Compares a row with [id, x, y, z] or [id, x, y, z, dx, dy, dz]; without a direction it is a point. */
static void compare_row(const struct entry *entry, const char *which, const conus_pose_row *row, json_t *fact)
{
    const char *id = json_string_value(json_array_get(fact, 0));
    size_t count = json_array_size(fact);
    if (!id || (count != 4 && count != 7)) {
        report(entry, "%s: [id, x, y, z] or [id, x, y, z, dx, dy, dz] is needed in facts.json", which);
        return;
    }
    if (row->error) {
        report(entry, "%s row has an error: %s", which, row->error);
        return;
    }
    if (strcmp(id, "*") != 0 && strcmp(row->id, id) != 0) { /* "*": any */
        report(entry, "%s row is called \"%s\", its facts say \"%s\"", which, row->id, id);
    }
    if (row->is_point != (count == 4)) {
        report(entry, "%s row is a %s", which, row->is_point ? "point" : "pose");
    }
    for (size_t i = 1; i < count; i++) {
        const double *m = row->pose.world_from_device;
        double found = i < 4 ? m[11 + i] : -m[4 + i]; /* a device points along its -z */
        double wanted = json_number_value(json_array_get(fact, i));
        if (!(fabs(found - wanted) <= 1e-4)) {
            report(entry, "%s row: number %zu is %.6g, its facts say %.6g", which, i, found, wanted);
        }
    }
}

/* How many rows have an error. */
static size_t count_bad(const conus_pose_list *list)
{
    size_t bad = 0;
    for (size_t i = 0; i < conus_pose_list_count(list); i++) {
        bad += conus_pose_list_row(list, i)->error != NULL;
    }
    return bad;
}

static bool has_note(const conus_pose_list *list, const char *part)
{
    bool found = false;
    const char *note;
    for (size_t i = 0; (note = conus_pose_list_note(list, i)); i++) {
        found = found || strstr(note, part);
    }
    return found;
}

static void compare_list(const struct entry *entry, const conus_pose_list *list)
{
    static const char *const brains[] = {
        [POSE_BRAIN_UNKNOWN] = "unknown",     [POSE_BRAIN_SUBJECT] = "subject",   [POSE_BRAIN_MNI152] = "MNI 152",
        [POSE_BRAIN_TALAIRACH] = "Talairach", [POSE_BRAIN_TEMPLATE] = "template", [POSE_BRAIN_OTHER] = "other"};
    size_t count = conus_pose_list_count(list);
    size_t bad = count_bad(list);
    size_t rows = (size_t)json_integer_value(json_object_get(entry->facts, "rows"));
    size_t bad_rows = (size_t)json_integer_value(json_object_get(entry->facts, "bad"));
    const char *brain = fact_text(entry, "brain");
    const char *note = fact_text(entry, "note");
    if (count != rows || bad != bad_rows) {
        report(entry, "%zu rows, %zu with an error; its facts say %zu and %zu", count, bad, rows, bad_rows);
    }
    if (count && count == rows) {
        compare_row(entry, "first", conus_pose_list_row(list, 0), json_object_get(entry->facts, "first"));
        compare_row(entry, "last", conus_pose_list_row(list, count - 1), json_object_get(entry->facts, "last"));
    }
    json_t *radius = json_object_get(entry->facts, "radius");
    if (radius && count && !(fabs(conus_pose_list_row(list, 0)->radius - json_number_value(radius)) < 1e-9)) {
        report(entry, "its first radius is %g", conus_pose_list_row(list, 0)->radius);
    }
    if (brain && (!brains[list->space.brain] || strcmp(brain, brains[list->space.brain]) != 0)) {
        report(entry, "its brain is %s (\"%s\"), its facts say %s",
               brains[list->space.brain] ? brains[list->space.brain] : "another", list->space.name, brain);
    }
    if (note && !has_note(list, note)) {
        report(entry, "no note says \"%s\"", note);
    }
}

static void compare(const struct entry *entry, const struct answer *answer)
{
    const char *refused = fact_text(entry, "refused");
    if (!answer->list && !refused) {
        report(entry, "is refused: %s", answer->line);
    } else if (answer->list && refused) {
        report(entry, "is read, its facts say that it is refused: %s", refused);
    } else if (refused && !strstr(answer->line, refused)) {
        report(entry, "is refused: %s\n    its facts say: %s", answer->line, refused);
    } else if (answer->list) {
        compare_list(entry, answer->list);
    } else if (getenv("CONUS_TEST_SHOW")) { /* to be read aloud */
        printf("%s: %s\n", entry->file, answer->line);
    }
}

static void write_file(const struct entry *entry, const char *path, const void *data, size_t size)
{
    unlink(path); /* ext4 waits for the disk where a file is emptied */
    FILE *file = fopen(path, "wb");
    bool whole = file && fwrite(data, 1, size, file) == size;
    if (!file || fclose(file) || !whole) {
        report(entry, "%s: cannot be written", path);
    }
}

static bool same_text(const char *a, const char *b)
{
    return a == b || (a && b && strcmp(a, b) == 0);
}

static bool same_numbers(const double *a, const double *b, size_t count)
{
    bool same = true;
    for (size_t i = 0; i < count; i++) {
        same = same && (a[i] == b[i] || (isnan(a[i]) && isnan(b[i])));
    }
    return same;
}

/* Whether the answers are one: the same refusal, or the same rows and notes. */
static bool same_answer(const struct answer *a, const struct answer *b)
{
    const size_t count = conus_pose_list_count(a->list);
    bool same = a->status == b->status && same_text(a->line, b->line) && count == conus_pose_list_count(b->list);
    for (size_t i = 0; same && i < count; i++) {
        const conus_pose_row *r = conus_pose_list_row(a->list, i), *s = conus_pose_list_row(b->list, i);
        same = same_numbers(r->pose.world_from_device, s->pose.world_from_device, 16) && same_text(r->id, s->id) &&
               same_text(r->error, s->error) && same_numbers(&r->radius, &s->radius, 1) && r->angle == s->angle &&
               same_numbers(r->range, s->range, 2);
    }
    for (size_t i = 0; same && (conus_pose_list_note(a->list, i) || conus_pose_list_note(b->list, i)); i++) {
        same = same_text(conus_pose_list_note(a->list, i), conus_pose_list_note(b->list, i));
    }
    return same;
}

/* A file with a bit flipped is read or refused. Of digits that become others those are counted that nobody sees in the
 * answer: of comments, of columns that are passed over, of rows that were refused; CONUS_TEST_SHOW lists them. */
static void check_flips(const struct entry *entry, const char *path, const struct answer *whole, struct bytes bytes)
{
    const size_t step = 8 * bytes.size / test_cases(FLIPS) + 1;
    for (size_t bit = 0; bit < 8 * bytes.size; bit += step, total.flips++) {
        uint8_t *byte = (uint8_t *)bytes.data + bit / 8;
        const uint8_t before = *byte;
        *byte ^= (uint8_t)(1U << bit % 8);
        write_file(entry, path, bytes.data, bytes.size);
        struct answer answer = ask(entry, path);
        const bool is_digit = before >= '0' && before <= '9' && *byte >= '0' && *byte <= '9';
        if (is_digit && whole->list && same_answer(&answer, whole)) {
            total.unseen++;
            if (getenv("CONUS_TEST_SHOW")) {
                printf("unseen in %s, byte %zu\n", entry->file, bit / 8);
            }
        }
        answer_finish(&answer);
        *byte = before;
    }
}

/* Every prefix is read or refused; without memory the answer is the same, or says that memory is missing. */
static void check_harm(const struct entry *entry, const char *path, const struct answer *whole)
{
    struct bytes bytes = {0};
    if (file_read(&bytes, path, LARGEST)) {
        report(entry, "%s", conus_message());
        return;
    }
    size_t step = bytes.size / test_cases(whole->list ? PREFIXES : FEW) + 1;
    for (size_t size = 0; size < bytes.size; size += step, total.prefixes++) {
        write_file(entry, path, bytes.data, size);
        struct answer answer = ask(entry, path);
        answer_finish(&answer);
    }
    check_flips(entry, path, whole, bytes);
    write_file(entry, path, bytes.data, bytes.size);
    bytes_finish(&bytes);
    const long most = (long)test_cases(FAILURES);
    bool harmed = true;
    for (long n = 0; harmed; n += 1 + n / most, total.failures++) {
        test_fail_allocation(n);
        struct answer answer = ask(entry, path);
        harmed = test_allocation_failed();
        test_fail_allocation(-1);
        bool same = answer.status == whole->status &&
                    conus_pose_list_count(answer.list) == conus_pose_list_count(whole->list) &&
                    (!answer.list || count_bad(answer.list) == count_bad(whole->list));
        if (answer.status != CONUS_ERROR_MEMORY && !same) {
            report(entry, "allocation %ld fails: %s", n, answer.line ? answer.line : "another answer");
        }
        answer_finish(&answer);
    }
}

static void copy_file(const struct entry *entry, const char *folder, const char *name)
{
    char path[PATH_SIZE];
    struct bytes bytes = {0};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (file_read(&bytes, path, LARGEST)) {
        report(entry, "%s", conus_message());
    } else {
        write_file(entry, test_in(strrchr(name, '/') ? strrchr(name, '/') + 1 : name), bytes.data, bytes.size);
    }
    bytes_finish(&bytes);
}

static void take_options(struct entry *entry)
{
    const char *space = fact_text(entry, "space");
    for (size_t i = 0; space && conus_space_name(i); i++) {
        entry->options.space = strcmp(space, conus_space_name(i)) == 0 ? (conus_space)i : entry->options.space;
    }
    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
        entry->options.frame =
            space && strcmp(space, conus_space_name((size_t)frames[i].space)) == 0 ? &frames[i] : entry->options.frame;
    }
    if (json_is_true(json_object_get(entry->facts, "named"))) {
        entry->options.atlas = total.named;
        entry->options.find_place = conus_place_find;
    }
    entry->options.format = fact_text(entry, "format");
}

static void check_keys(const struct entry *entry)
{
    static const char *const keys[] = {"is",    "source", "space", "format", "word",    "beside",  "rows",  "bad",
                                       "first", "last",   "brain", "note",   "refused", "pending", "named", "radius"};
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
    if (!fact_text(entry, "is") || !fact_text(entry, "source")) {
        report(entry, "its facts do not say what it \"is\", or its \"source\"");
    }
}

static void run_entry(const char *folder, const char *file, json_t *facts)
{
    struct entry entry = {.file = file, .facts = facts, .options = CONUS_POSE_OPTIONS_INIT};
    char name[32];
    char path[PATH_SIZE];
    json_t *beside;
    size_t i;
    snprintf(name, sizeof name, "%zu", total.entries++);
    test_folder(name);
    check_keys(&entry);
    take_options(&entry);
    entry.options.longest = LONGEST;
    copy_file(&entry, folder, file);
    json_array_foreach(json_object_get(facts, "beside"), i, beside)
    {
        copy_file(&entry, folder, json_string_value(beside));
    }
    const char *base = strrchr(file, '/') ? strrchr(file, '/') + 1 : file;
    const char *word = fact_text(&entry, "word");
    snprintf(path, sizeof path, "%s%s", test_in(base), word ? word : "");
    struct answer answer = ask(&entry, path);
    bool is_pending = json_is_true(json_object_get(facts, "pending"));
    size_t before = total.faults;
    total.is_quiet = is_pending;
    compare(&entry, &answer);
    total.is_quiet = false;
    if (is_pending) {
        bool passes = total.faults == before;
        total.faults = before;
        total.pending++;
        if (passes) {
            report(&entry, "is no longer pending: take the word out of its facts");
        }
    }
    total.refused += answer.list == NULL;
    if (!word && test_takes(total.entries)) {
        check_harm(&entry, path, &answer);
    }
    answer_finish(&answer);
}

/* 19 x 23 x 19 voxels of 10 mm around the brain of MNI 152, all of them one area. */
static bool load_atlas(void)
{
    static const int64_t dim[3] = {19, 23, 19};
    static const double srow[12] = {10, 0, 0, -90, 0, 10, 0, -126, 0, 0, 10, -72};
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, 2, dim);
    for (size_t i = 0; i < 12; i++) {
        nifti_set(&builder, "srow", i, srow[i]);
    }
    for (size_t i = 0; i < 3; i++) {
        nifti_set(&builder, "pixdim", i + 1, 10);
    }
    for (int64_t i = 0; i < dim[0] * dim[1] * dim[2]; i++) {
        nifti_voxel(&builder, 1);
    }
    const char *path = test_scratch("atlas.nii");
    FILE *file = fopen(path, "wb");
    bool whole = file && fwrite(builder.bytes.data, 1, builder.bytes.size, file) == builder.bytes.size;
    whole = file && !fclose(file) && whole;
    buffer_finish(&builder.bytes);
    return whole && !conus_atlas_load(&total.atlas, path, NULL);
}

int main(int argc, char **argv)
{
    char path[PATH_SIZE];
    json_error_t error;
    const char *file;
    json_t *facts;
    snprintf(path, sizeof path, "%s/facts.json", argc > 1 ? argv[1] : "");
    json_t *all = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!json_is_object(all)) {
        fprintf(stderr, "usage: points FOLDER [FILE]\n%s: line %d: %s\n", path, error.line, error.text);
        return 2;
    }
    total.named = place_atlas();
    if (!load_atlas()) {
        fprintf(stderr, "%s\n", conus_message());
        return 2;
    }
    json_object_foreach(all, file, facts)
    {
        if (argc < 3 || strcmp(argv[2], file) == 0) {
            run_entry(argv[1], file, facts);
        }
    }
    json_decref(all);
    conus_atlas_destroy(total.atlas);
    conus_atlas_destroy(total.named);
    printf("%zu files, %zu of them refused, %zu pending; %zu prefixes, %zu flips of a bit (%zu of digits unseen), %zu "
           "failing allocations, "
           "%.1f s; %zu faults\n",
           total.entries, total.refused, total.pending, total.prefixes, total.flips, total.unseen, total.failures,
           (double)clock() / CLOCKS_PER_SEC, total.faults);
    return total.entries && !total.faults ? EXIT_SUCCESS : EXIT_FAILURE;
}
