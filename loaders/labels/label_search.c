/* SPDX-License-Identifier: BSD-3-Clause */
/* Several tables may name one volume's labels: the first is used, and none may contradict it silently. */
#include "loaders/labels/label_search.h"

#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/labels/label_file.h"
#include "loaders/labels/label_format.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* A name as tables may spell it differently: letters and digits only, small. */
struct key {
    char *text;
    const struct label *label;
};

/* Two tables side by side. */
struct comparison {
    size_t shared, clashes; /* names that are in both once, and those of them with two numbers           */
    size_t common, agreed;  /* numbers named in both tables, and those with equal names */
    const struct label *clash[2], *other[2]; /* the first such name, and number, in either; NULL if none */
};

static char *make_key(const char *name)
{
    char *key = memory_text(name, strlen(name));
    char *to = key;
    for (const char *from = key; from && *from; from++) {
        char small = *from >= 'A' && *from <= 'Z' ? (char)(*from - 'A' + 'a') : *from;
        bool kept = (small >= 'a' && small <= 'z') || (small >= '0' && small <= '9') || (small & 0x80);
        *to = small;
        to += kept;
    }
    if (to) {
        *to = '\0';
    }
    return key;
}

static int compare_keys(const void *a, const void *b)
{
    return strcmp(((const struct key *)a)->text, ((const struct key *)b)->text);
}

static void finish_keys(struct key *keys, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        memory_free(keys[i].text);
    }
    memory_free(keys);
}

/* Keys of all names that are there once, sorted. */
static conus_status list_keys(struct key **out, size_t *out_count, const struct label_table *table)
{
    struct key *keys = memory_raw(table->count, sizeof *keys);
    size_t count = 0;
    size_t kept = 0;
    bool complete = keys != NULL;
    for (size_t i = 0; complete && i < table->count; i++) {
        const struct label *label = &table->entries[i];
        if (label->name) {
            keys[count] = (struct key){make_key(label->name), label};
            complete = keys[count].text != NULL;
            count += complete;
        }
    }
    if (!complete) {
        finish_keys(keys, count);
        return CONUS_ERROR_MEMORY;
    }
    qsort(keys, count, sizeof *keys, compare_keys);
    for (size_t start = 0, end; start < count; start = end) {
        for (end = start + 1; end < count && !compare_keys(&keys[start], &keys[end]); end++) {
            memory_free(keys[end].text);
        }
        if (end == start + 1 && keys[start].text[0]) {
            keys[kept++] = keys[start];
        } else {
            memory_free(keys[start].text);
        }
    }
    *out = keys;
    *out_count = kept;
    return CONUS_OK;
}

static void compare_labels(struct comparison *comparison, const struct key *a, size_t a_count, const struct key *b,
                           size_t b_count)
{
    for (size_t i = 0, k = 0; i < a_count && k < b_count;) {
        int order = compare_keys(&a[i], &b[k]);
        if (order == 0) {
            bool clash = a[i].label->number != b[k].label->number;
            comparison->shared++;
            if (clash && !comparison->clashes++) {
                comparison->clash[0] = a[i].label;
                comparison->clash[1] = b[k].label;
            }
        }
        i += order <= 0;
        k += order >= 0;
    }
}

static conus_status same_name(bool *out, const struct label *a, const struct label *b)
{
    const char *names[4] = {a->name, a->abbreviation, b->name, b->abbreviation};
    char *keys[4] = {NULL};
    conus_status status = CONUS_OK;
    for (int i = 0; i < 4; i++) {
        keys[i] = names[i] ? make_key(names[i]) : NULL;
        status = names[i] && !keys[i] ? CONUS_ERROR_MEMORY : status;
    }
    *out = false;
    for (int i = 0; !status && i < 4; i++) {
        const char *mine = keys[i / 2];
        const char *other = keys[2 + i % 2];
        *out = *out || (mine && other && strcmp(mine, other) == 0);
    }
    for (int i = 0; i < 4; i++) {
        memory_free(keys[i]);
    }
    return status;
}

static conus_status compare_numbers(struct comparison *comparison, const struct label_table *a,
                                    const struct label_table *b)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < a->count; i++) {
        bool same = false;
        const struct label *mine = &a->entries[i];
        const struct label *other = mine->name ? label_table_find(b, mine->number) : NULL;
        if (!other || !other->name) {
            continue;
        }
        status = same_name(&same, mine, other);
        comparison->common++;
        comparison->agreed += same;
        if (!same && !comparison->other[0]) {
            comparison->other[0] = mine;
            comparison->other[1] = other;
        }
    }
    return status;
}

static conus_status compare_tables(struct comparison *out, const struct label_table *a, const struct label_table *b)
{
    struct key *keys[2] = {NULL, NULL};
    size_t counts[2] = {0, 0};
    *out = (struct comparison){0};
    conus_status status = list_keys(&keys[0], &counts[0], a);
    status = status ? status : list_keys(&keys[1], &counts[1], b);
    if (!status) {
        compare_labels(out, keys[0], counts[0], keys[1], counts[1]);
        status = compare_numbers(out, a, b);
    }
    finish_keys(keys[0], counts[0]);
    finish_keys(keys[1], counts[1]);
    return status;
}

static conus_status take_offer(struct label_search *search, struct label_offer *offer)
{
    label_table_finish(&search->table);
    search->table = offer->table;
    offer->table = (struct label_table){0};
    search->proved = offer->proved;
    search->found = true;
    file_sums_finish(&search->read);
    conus_status status = offer->file ? file_sums_add(&search->read, offer->path, offer->file) : CONUS_OK;
    buffer_clear(&search->source);
    buffer_text(&search->source, offer->source.data);
    return status ? status : buffer_status(&search->source);
}

/* Decides where most names have other numbers in the offer than in the table in use, or where only one is proved. */
static conus_status settle_contradiction(struct label_search *search, struct label_offer *offer,
                                         const struct comparison *comparison)
{
    const struct label *const *clash = comparison->clash;
    const char *first = search->source.data;
    const char *second = offer->source.data;
    if (search->proved == offer->proved) {
        return fail(CONUS_ERROR_DATA,
                    "%s: two label tables contradict each other: \"%s\" is label %u in %s, %u in %s; choose one with "
                    "--labels",
                    search->volume->info->path, clash[0]->name, clash[0]->number, first, clash[1]->number, second);
    }
    conus_status status = notes_warn(
        search->notes,
        "two label tables contradict each other: \"%s\" is label %u in %s, %u in %s; used is the XML, whose x y "
        "z agree with the volume",
        clash[0]->name, clash[0]->number, first, clash[1]->number, second);
    return status || search->proved ? status : take_offer(search, offer);
}

/* Notes what differs, if anything does. */
static conus_status note_difference(const struct comparison *comparison, const char *used, const char *other,
                                    struct notes *notes)
{
    const struct label *const *clash = comparison->clash;
    const struct label *const *named = comparison->other;
    if (comparison->clashes) {
        return notes_warn(notes, "\"%s\" is label %u in %s, which is used, but %u in %s (%zu of %zu such names)",
                          clash[0]->name, clash[0]->number, used, clash[1]->number, other, comparison->clashes,
                          comparison->shared);
    }
    return comparison->agreed == comparison->common
               ? CONUS_OK
               : notes_warn(notes, "label %u is \"%s\" in %s, which is used, but \"%s\" in %s (%zu of %zu such labels)",
                            named[0]->number, named[0]->name, used, named[1]->name, other,
                            comparison->common - comparison->agreed, comparison->common);
}

static conus_status reconcile_offer(struct label_search *search, struct label_offer *offer)
{
    struct comparison comparison;
    conus_status status = compare_tables(&comparison, &search->table, &offer->table);
    if (status) {
        return status;
    }
    bool one_is_proved = search->proved != offer->proved;
    return 2 * comparison.clashes > comparison.shared || (comparison.clashes && one_is_proved)
               ? settle_contradiction(search, offer, &comparison)
               : note_difference(&comparison, search->source.data, offer->source.data, search->notes);
}

conus_status label_tables_note(bool *differ, const struct label_table *used, const char *source,
                               const struct label_table *other, const char *other_source, struct notes *notes)
{
    struct comparison comparison;
    conus_status status = compare_tables(&comparison, used, other);
    *differ = !status && (comparison.clashes || comparison.agreed < comparison.common);
    return status ? status : note_difference(&comparison, source, other_source, notes);
}

void label_search_finish(struct label_search *search)
{
    label_table_finish(&search->table);
    file_sums_finish(&search->read);
    buffer_finish(&search->source);
    buffer_finish(&search->first_error);
}

conus_status label_search_offer(struct label_search *search, struct label_offer *offer)
{
    conus_status status = buffer_status(&offer->source);
    bool first = !search->found;
    bool proved = search->proved;
    status = status ? status : first ? take_offer(search, offer) : reconcile_offer(search, offer);
    if (!status && (first || proved != search->proved)) { /* this table is used from now on */
        status = notes_move(search->notes, &offer->notes);
    }
    label_table_finish(&offer->table);
    notes_finish(&offer->notes);
    buffer_finish(&offer->source);
    return status;
}

/* Failures that speak about one candidate are kept for later: another may do. */
static conus_status keep_error(struct label_search *search, conus_status status)
{
    if (status == CONUS_ERROR_MEMORY) {
        return status;
    }
    if (search->judge) {
        return notes_warn(search->notes, "%s: passed over", conus_message());
    }
    if (!search->first_error.size) {
        buffer_text(&search->first_error, conus_message());
    }
    return buffer_status(&search->first_error);
}

/* A file that is no table is noted only where a table would stand, and none has been found. */
static conus_status note_unknown(struct label_search *search, const char *name, bool inside)
{
    const char *dot = strrchr(name, '.');
    bool expected = !inside && !(dot && strcasecmp(dot, ".json") == 0); /* BIDS has a .json beside every image */
    return expected && !search->found
               ? notes_warn(search->notes, "%s is not a label table of a known format: passed over", name)
               : CONUS_OK;
}

conus_status label_search_bytes(struct label_search *search, const char *path, const struct bytes *file,
                                struct text text)
{
    struct label_offer offer = {.path = path, .file = file};
    struct label_use use = search->use;
    const char *name = path_base(path);
    const struct label_format *format = label_format_of(text);
    if (!format) {
        return search->judge ? CONUS_OK : note_unknown(search, name, !file);
    }
    if (format == &label_format_colours) { /* X.lut; label_file_colours() is about it */
        return CONUS_OK;
    }
    use.path = path;
    conus_status status = label_text_parse(&offer.table, format, text, &use, &offer.notes);
    if (status) {
        notes_finish(&offer.notes);
        return keep_error(search, fail_in(status, name));
    }
    bool taken = offer.table.count > 0;
    status = taken && search->judge ? search->judge(&taken, search, &offer.table, path) : CONUS_OK;
    if (status || !taken) {
        bool empty = !status && !offer.table.count && !search->found;
        notes_finish(&offer.notes);
        label_table_finish(&offer.table);
        return empty ? notes_warn(search->notes, "%s in %s has no label but 0: passed over", format->name, name)
                     : status;
    }
    buffer_format(&offer.source, "%s %s %s", format->name, file ? "in" : "inside", name);
    return label_search_offer(search, &offer);
}

conus_status label_search_file(struct label_search *search, const char *path)
{
    struct bytes bytes = {0};
    struct stat info;
    uint64_t limit = label_file_limit(search->use.max_memory);
    if (!file_exists(path)) {
        return CONUS_OK;
    }
    if (!stat(path, &info) && (uint64_t)info.st_size > limit) { /* tables of results may be called so */
        return notes_warn(search->notes, "%s: %lld bytes, a label table may have %llu: passed over", path_base(path),
                          (long long)info.st_size, (unsigned long long)limit);
    }
    conus_status status = label_file_bytes(&bytes, path, search->use.max_memory);
    if (status) {
        return keep_error(search, status);
    }
    if (!label_is_lut(bytes.data, bytes.size)) {
        status = label_search_bytes(search, path, &bytes, text_from_bytes(bytes.data, bytes.size));
    }
    bytes_finish(&bytes);
    return status;
}
