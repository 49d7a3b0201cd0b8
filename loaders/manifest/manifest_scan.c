/* SPDX-License-Identifier: BSD-3-Clause */
/* Guesses from its values what a volume is good for, and from names whether surfaces have labels. */
#include "loaders/manifest/manifest.h"

#include "atlas/areas/areas.h"
#include "base/memory.h"
#include "loaders/volumes/volumes.h"
#include "sources/names.h"

#include <string.h>

static const double sparse_share = 0.2; /* of voxels that are not zero: a pathway */
static const double half = 0.5;         /* of neighbours equal, where there are too few to tell: labels */

static void judge_labels(struct job *job, struct volume_guess *out, const struct volume_file *file,
                         const struct label_voxels *labels)
{
    struct label_table *table = labels_new(job);
    bool named = false;
    volume_label_table(job, table, file, labels);
    for (size_t i = 0; i < table->count; i++) {
        named = named || table->entries[i].name;
    }
    const struct grey_result result = grey_judge_file(job, file, labels, table, false);
    bool several = labels->label_count > 2; /* besides 0: a mask is no parcellation */
    bool pieces = several && (result.telling || result.equal > half);
    if (job_ok(job) && !result.grey && (named || pieces)) {
        *out =
            (struct volume_guess){VOLUME_LABELS, 1, named ? "named by a label table" : "areas of equal whole numbers"};
    }
}

/* Guesses between pathway and context, by how many voxels are not 0. */
static void judge_filled(struct job *job, struct volume_guess *out, const struct volume_file *file)
{
    struct volume_file copy = *file; /* whose range is set */
    size_t voxels = file->info.dim[0] * file->info.dim[1] * file->info.dim[2];
    size_t filled = 0;
    float *values = volume_values(job, &copy);
    for (size_t i = 0; values && i < voxels; i++) {
        filled += values[i] != 0;
    }
    memory_free(values); /* before the labels need memory */
    if (!filled) {
        job_bad(job, "%s: all of its values are 0", file->path);
    }
    bool sparse = (double)filled < sparse_share * (double)voxels;
    *out = (struct volume_guess){sparse ? VOLUME_PATHWAY : VOLUME_CONTEXT, 1,
                                 sparse ? "mostly zero" : "values almost everywhere"};
}

static void judge_volume(struct job *job, struct volume_guess *out, struct volume_file *file)
{
    struct label_voxels labels = {0};
    judge_filled(job, out, file);
    struct attempt attempt = job_try(job);
    volume_labels(job, &labels, file);
    if (job_ok(job)) {
        judge_labels(job, out, file, &labels);
    }
    label_voxels_finish(&labels);
    if (job->status == CONUS_ERROR_DATA) {
        (void)attempt_end(job, &attempt, ATTEMPT_DROP); /* fractions, or a damaged table */
    } else {
        attempt_end(job, &attempt, ATTEMPT_KEEP);
    }
}

static void finish_file(void *file)
{
    volume_file_finish(file);
}

void volume_guess_make(struct job *job, struct volume_guess *out, const char *path)
{
    const struct job_mark mark = job_mark(job); /* a folder has many volumes */
    struct volume_file *file = job_new(job, struct volume_file);
    if (!file) {
        return;
    }
    job_own(job, finish_file, file);
    path = job_format(job, "%s,volume=0", path); /* a 4-D file is refused without a choice: 0 stands for all */
    volume_load(job, file, path, job->max_memory);
    if (job_ok(job) && file->info.volume_count > 1) {
        *out = (struct volume_guess){VOLUME_SERIES, file->info.volume_count, "several volumes"};
    } else if (job_ok(job)) {
        judge_volume(job, out, file);
    }
    job_release(job, mark);
}

bool volume_names_are_halves(struct job *job, const char *left, const char *right)
{
    const struct text stem = {left, volume_stem_length(left)};
    const struct text other = {right, volume_stem_length(right)};
    struct side_word word;
    bool found = false;
    for (size_t from = 0; !found && side_word_find(&word, stem, from); from = word.start + word.size) {
        struct buffer swapped = {0};
        side_word_swap(&swapped, stem, &word);
        found = JOB_CALL(job, buffer_status(&swapped)) && word.side == 'L' &&
                text_compare((struct text){swapped.data, swapped.size}, other) == 0;
        buffer_finish(&swapped);
    }
    return found && strcmp(left + stem.size, right + other.size) == 0;
}

/* The first number in a name as text, without zeros in front; empty if there is none. */
static struct text first_number(const char *name)
{
    size_t start = strcspn(name, "0123456789");
    size_t length = strspn(name + start, "0123456789");
    while (length > 1 && name[start] == '0') {
        start++;
        length--;
    }
    return (struct text){name + start, length};
}

bool surface_names_give_labels(const struct names *names)
{
    size_t numbered = 0;
    for (size_t i = 0; i < names->count; i++) {
        struct text number = first_number(names->names[i]);
        numbered += number.size > 0;
        if (number.size > 9 || text_equal(number, "0")) {
            return false;
        }
        for (size_t k = 0; k < i && number.size; k++) {
            if (text_compare(first_number(names->names[k]), number) == 0) {
                return false;
            }
        }
    }
    return numbered == 0 || numbered == names->count;
}
