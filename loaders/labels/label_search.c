/* SPDX-License-Identifier: BSD-3-Clause */
/* Several tables may name one volume's labels: the first is used, and none may contradict it silently. */
#include "loaders/labels/labels.h"

#include "base/files/file.h"
#include "base/order.h"
#include "base/system/system.h"
#include "loaders/labels/label_format.h"

#include <string.h>

/* Two tables side by side. */
struct comparison {
    size_t shared, clashes;                  /* names that are in both once, and those of them with two numbers */
    size_t common, agreed;                   /* numbers named in both tables, and those with equal names */
    const struct label *clash[2], *other[2]; /* the first such name, and number, in either; NULL if none */
};

/* The next letter or digit of a name, small: tables may spell it differently. 0 at its end. */
static unsigned char next_letter(const char **name)
{
    while (**name) {
        char c = *(*name)++;
        char small = c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
        if ((small >= 'a' && small <= 'z') || (small >= '0' && small <= '9') || (small & 0x80)) {
            return (unsigned char)small;
        }
    }
    return 0;
}

static int compare_spelling(const char *a, const char *b)
{
    unsigned char one;
    unsigned char other;
    do {
        one = next_letter(&a);
        other = next_letter(&b);
    } while (one && one == other);
    return one - other;
}

static int compare_names(const void *a, const void *b)
{
    return compare_spelling((*(const struct label *const *)a)->name, (*(const struct label *const *)b)->name);
}

/* The labels whose names are there once, sorted by them. */
static const struct label **list_names(struct job *job, size_t *count, const struct label_table *table)
{
    size_t named = table->count;
    size_t kept = 0;
    const struct label **list = job_array(job, &named, sizeof(struct label *));
    *count = 0;
    if (!list) {
        return NULL;
    }
    named = 0;
    for (size_t i = 0; i < table->count; i++) {
        list[named] = &table->entries[i];
        named += table->entries[i].name && compare_spelling(table->entries[i].name, "") != 0;
    }
    order_sort(list, named, sizeof(struct label *), compare_names);
    for (size_t start = 0, end; start < named; start = end) {
        for (end = start + 1; end < named && compare_names(&list[start], &list[end]) == 0;) {
            end++;
        }
        list[kept] = list[start];
        kept += end == start + 1;
    }
    *count = kept;
    return list;
}

static void compare_numbers_of_names(struct comparison *out, struct job *job, const struct label_table *a,
                                     const struct label_table *b)
{
    size_t counts[2];
    const struct job_mark mark = job_mark(job);
    const struct label **mine = list_names(job, &counts[0], a);
    const struct label **other = list_names(job, &counts[1], b);
    for (size_t i = 0, k = 0; i < counts[0] && k < counts[1];) {
        int order = compare_names(&mine[i], &other[k]);
        bool clash = order == 0 && mine[i]->number != other[k]->number;
        out->shared += order == 0;
        if (clash && !out->clashes++) {
            out->clash[0] = mine[i];
            out->clash[1] = other[k];
        }
        i += order <= 0;
        k += order >= 0;
    }
    job_release(job, mark);
}

static bool have_one_name(const struct label *a, const struct label *b)
{
    const char *const names[2][2] = {{a->name, a->abbreviation}, {b->name, b->abbreviation}};
    for (int i = 0; i < 4; i++) {
        const char *mine = names[0][i / 2];
        const char *other = names[1][i % 2];
        if (mine && other && compare_spelling(mine, other) == 0) {
            return true;
        }
    }
    return false;
}

static struct comparison compare_tables(struct job *job, const struct label_table *a, const struct label_table *b)
{
    struct comparison result = {0};
    compare_numbers_of_names(&result, job, a, b);
    for (size_t i = 0; i < a->count; i++) {
        const struct label *mine = &a->entries[i];
        const struct label *other = mine->name ? label_table_find(b, mine->number) : NULL;
        bool both = other && other->name;
        bool same = both && have_one_name(mine, other);
        result.common += both;
        result.agreed += same;
        if (both && !same && !result.other[0]) {
            result.other[0] = mine;
            result.other[1] = other;
        }
    }
    return result;
}

/* Notes what differs, if anything does; whether it does. */
static bool note_difference(struct job *job, const struct comparison *comparison, const char *used, const char *other)
{
    const struct label *const *clash = comparison->clash;
    const struct label *const *named = comparison->other;
    if (clash[0]) {
        job_warn(job, "\"%s\" is label %u in %s, which is used, but %u in %s (%zu of %zu such names)", clash[0]->name,
                 clash[0]->number, used, clash[1]->number, other, comparison->clashes, comparison->shared);
    } else if (named[0]) {
        job_warn(job, "label %u is \"%s\" in %s, which is used, but \"%s\" in %s (%zu of %zu such labels)",
                 named[0]->number, named[0]->name, used, named[1]->name, other, comparison->common - comparison->agreed,
                 comparison->common);
    }
    return clash[0] || named[0];
}

bool label_tables_note(struct job *job, const struct label_table *used, const char *source,
                       const struct label_table *other, const char *other_source)
{
    const struct comparison comparison = compare_tables(job, used, other);
    return note_difference(job, &comparison, source, other_source);
}

static void take_offer(struct job *job, struct label_search *search, struct label_offer *offer)
{
    search->table = offer->table;
    search->source = offer->source;
    search->proved = offer->proved;
    file_sums_cut(&job->files, search->files);
    if (offer->file) {
        job_made_of(job, offer->path, offer->file);
    }
    (void)JOB_CALL(job, notes_move(&job->notes, &offer->notes));
}

/* Decides where most names have other numbers in the offer than in the table in use, or where only one is proved. */
static void settle_contradiction(struct job *job, struct label_search *search, struct label_offer *offer,
                                 const struct comparison *comparison)
{
    const struct label *const *clash = comparison->clash;
    if (search->proved == offer->proved) {
        job_bad(job,
                "%s: two label tables contradict each other: \"%s\" is label %u in %s, %u in %s; choose one with "
                "--labels",
                search->volume->info->path, clash[0]->name, clash[0]->number, search->source, clash[1]->number,
                offer->source);
        return;
    }
    job_warn(job,
             "two label tables contradict each other: \"%s\" is label %u in %s, %u in %s; used is the XML, whose x y "
             "z agree with the volume",
             clash[0]->name, clash[0]->number, search->source, clash[1]->number, offer->source);
    if (!search->proved) {
        take_offer(job, search, offer);
    }
}

void label_search_offer(struct job *job, struct label_search *search, struct label_offer *offer)
{
    if (!search->source) {
        take_offer(job, search, offer);
    } else {
        const struct comparison comparison = compare_tables(job, search->table, offer->table);
        bool one_is_proved = search->proved != offer->proved;
        if (2 * comparison.clashes > comparison.shared || (comparison.clashes && one_is_proved)) {
            settle_contradiction(job, search, offer, &comparison);
        } else {
            note_difference(job, &comparison, search->source, offer->source);
        }
    }
    notes_finish(&offer->notes);
}

/* What is wrong with one candidate is kept for later: another may do. */
static void pass_over(struct job *job, struct label_search *search, const char *why)
{
    if (search->judge) {
        job_note(job, "%s: passed over", why);
    } else if (!search->why) {
        search->why = why;
    }
}

/* A file that is no table is noted only where a table would stand, and none has been found. */
static void note_unknown(struct job *job, const struct label_search *search, const char *name, bool inside)
{
    bool expected = !inside && !path_ends_in(name, ".json"); /* BIDS has a .json beside every image */
    if (expected && !search->source && !search->judge) {
        job_note(job, "%s is not a label table of a known format: passed over", name);
    }
}

void label_search_text(struct job *job, struct label_search *search, const char *path, const struct bytes *file,
                       struct text text)
{
    const char *name = path_base(path);
    const struct label_format *format = file ? label_format_for(&text, file, &search->use) : label_format_of(text);
    if (!format) {
        note_unknown(job, search, name, !file);
        return;
    }
    if (format->is_colours) { /* X.lut; label_file_colours() is about it */
        return;
    }
    struct label_use use = search->use;
    struct label_offer offer = {.table = labels_new(job), .path = path, .file = file};
    use.path = path;
    struct attempt attempt = job_try(job);
    struct notes outside = label_notes_swap(job, (struct notes){0});
    size_t place = job_in(job, name, JOB_ALONE);
    label_text_parse(job, offer.table, format, text, &use);
    label_check_zero(job, offer.table, search->judge || !file ? NULL : use.voxels);
    job_out(job, place);
    offer.notes = label_notes_swap(job, outside);
    const char *why = attempt_end(job, &attempt, ATTEMPT_TRY);
    if (why) {
        pass_over(job, search, why);
    } else if (!offer.table->count && !search->source) {
        job_note(job, "%s in %s has no label but 0: passed over", format->name, name);
    } else if (offer.table->count && (!search->judge || search->judge(job, search, offer.table, path))) {
        offer.source = job_format(job, "%s %s %s", format->name, file ? "in" : "inside", name);
        label_search_offer(job, search, &offer);
    }
    notes_finish(&offer.notes);
}

void label_search_file(struct job *job, struct label_search *search, const char *path)
{
    struct system_stat info;
    uint64_t limit = label_file_limit(job);
    if (!job_has_file(job, path)) {
        return;
    }
    if (system_stat(&info, path) && info.size > limit) { /* tables of results may be called so */
        job_note(job, "%s: %lld bytes, a label table may have %llu: passed over", path_base(path), (long long)info.size,
                 (unsigned long long)limit);
        return;
    }
    struct attempt attempt = job_try(job);
    struct bytes bytes = label_file_bytes(job, path);
    const char *why = attempt_end(job, &attempt, ATTEMPT_TRY);
    if (why) {
        pass_over(job, search, why);
    } else {
        label_search_text(job, search, path, &bytes, (struct text){0});
    }
}
