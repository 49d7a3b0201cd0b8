/* SPDX-License-Identifier: BSD-3-Clause */
/* Guesses from its values what a volume is good for, and from names whether surfaces have labels. */
#include "loaders/manifest/manifest_scan.h"

#include "atlas/areas/sides.h"
#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/volumes/grey.h"
#include "loaders/volumes/volume_table.h"
#include "loaders/volumes/volume_values.h"

#include <string.h>

static const double sparse_share = 0.2; /* of voxels that are not zero: a pathway */
static const double half = 0.5;         /* of neighbours equal, where there are too few to tell: labels */

static conus_status judge_labels(struct volume_guess *out, const struct volume_file *file,
                                 const struct label_voxels *labels)
{
    struct label_table table = {0};
    struct grey_result result = {0};
    struct notes notes = {0};
    char *source = NULL;
    bool named = false;
    conus_status status = volume_label_table(&table, &source, file, labels, NULL, &notes);
    for (size_t i = 0; !status && i < table.count; i++) {
        named = named || table.entries[i].name;
    }
    notes_finish(&notes);
    memory_free(source);
    status = status ? status : grey_judge_file(&result, file, labels, &table, false);
    bool several = labels->label_count > 2; /* besides 0: a mask is no parcellation */
    bool pieces = several && (result.telling || result.equal > half);
    if (!status && !result.grey && (named || pieces)) {
        *out =
            (struct volume_guess){VOLUME_LABELS, 1, named ? "named by a label table" : "areas of equal whole numbers"};
    }
    label_table_finish(&table);
    return status;
}

/* Guesses between pathway and context, by how many voxels are not 0. */
static conus_status judge_filled(struct volume_guess *out, const struct volume_file *file, struct notes *notes)
{
    float *values = NULL;
    struct volume_file copy = *file; /* whose range is set */
    size_t voxels = file->info.dim[0] * file->info.dim[1] * file->info.dim[2];
    size_t filled = 0;
    conus_status status = volume_file_values(&values, &copy, notes);
    for (size_t i = 0; !status && i < voxels; i++) {
        filled += values[i] != 0;
    }
    memory_free(values);
    if (!status && !filled) {
        return fail(CONUS_ERROR_DATA, "%s: all of its values are 0", file->path);
    }
    bool sparse = (double)filled < sparse_share * (double)voxels;
    *out = (struct volume_guess){sparse ? VOLUME_PATHWAY : VOLUME_CONTEXT, 1,
                                 sparse ? "mostly zero" : "values almost everywhere"};
    return status;
}

static conus_status judge_volume(struct volume_guess *out, struct volume_file *file, struct notes *notes)
{
    struct label_voxels labels = {0};
    conus_status status = judge_filled(out, file, notes);
    if (status) {
        return status;
    }
    status = volume_file_labels(&labels, file);
    status = status ? status : judge_labels(out, file, &labels);
    label_voxels_finish(&labels);
    return status == CONUS_ERROR_DATA ? CONUS_OK : status; /* fractions, or a damaged table */
}

conus_status volume_guess_make(struct volume_guess *out, const char *path, uint64_t max_memory)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    struct buffer first = {0};
    buffer_format(&first, "%s,volume=0", path); /* a 4-D file is refused without a choice: 0 stands for all */
    conus_status status = buffer_status(&first);
    status = status ? status : volume_file_open(&file, first.data, max_memory, &notes);
    buffer_finish(&first);
    if (!status && file.info.volume_count > 1) {
        *out = (struct volume_guess){VOLUME_SERIES, file.info.volume_count, "several volumes"};
    } else if (!status) {
        status = judge_volume(out, &file, &notes);
    }
    notes_finish(&notes);
    volume_file_finish(&file);
    return status;
}

conus_status volume_names_are_halves(bool *out, const char *left, const char *right)
{
    const struct text stem = {left, volume_stem_length(left)};
    const size_t length = volume_stem_length(right);
    struct side_word word;
    conus_status status = CONUS_OK;
    bool found = false;
    for (size_t from = 0; !status && !found && side_word_find(&word, stem, from); from = word.start + word.size) {
        struct buffer swapped = {0};
        side_word_swap(&swapped, stem, &word);
        status = buffer_status(&swapped);
        found = !status && word.side == 'L' && swapped.size == length && memcmp(swapped.data, right, length) == 0;
        buffer_finish(&swapped);
    }
    *out = found && strcmp(left + stem.size, right + length) == 0;
    return status;
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
            struct text other = first_number(names->names[k]);
            if (other.size == number.size && memcmp(other.data, number.data, number.size) == 0) {
                return false;
            }
        }
    }
    return numbered == 0 || numbered == names->count;
}
