/* SPDX-License-Identifier: BSD-3-Clause */
#include "loaders/manifest_scan.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/label_files.h"

#include <math.h>
#include <string.h>

static const double equal_share = 0.9;  /* of neighbours that are not both zero: labels */
static const double sparse_share = 0.2; /* of voxels that are not zero: a pathway */

/* What the values of a volume look like. */
struct look {
    size_t filled;  /* voxels that are not 0 */
    size_t edges;   /* neighbours along i, at least one of them not 0 */
    size_t equal;   /* of them with one value */
    bool fractions; /* some value is not whole, or negative */
    double maximum;
};

static struct look look_at(const float *values, const size_t dim[3])
{
    struct look look = {0};
    size_t count = dim[0] * dim[1] * dim[2];
    for (size_t i = 0; i < count; i++) {
        double value = (double)values[i];
        bool edge = i % dim[0] && (values[i] != 0 || values[i - 1] != 0);
        look.filled += values[i] != 0;
        look.edges += edge;
        look.equal += edge && values[i] == values[i - 1];
        look.fractions = look.fractions || value != floor(value) || value < 0;
        look.maximum = fmax(look.maximum, value);
    }
    return look;
}

static conus_status has_table(bool *out, const struct volume_file *file)
{
    struct label_table table = {0};
    struct notes notes = {0};
    char *source = NULL;
    *out = false;
    conus_status status = label_table_of_volume(&table, &source, file, NULL, &notes);
    for (size_t i = 0; !status && i < table.count; i++) {
        *out = *out || table.entries[i].name;
    }
    label_table_finish(&table);
    notes_finish(&notes);
    memory_free(source);
    return status;
}

static conus_status judge(struct volume_guess *out, const struct volume_file *file, const struct look *look)
{
    bool named = false;
    conus_status status = look->fractions ? CONUS_OK : has_table(&named, file);
    size_t voxels = file->info.dim[0] * file->info.dim[1] * file->info.dim[2];
    bool pieces = !look->fractions && look->maximum > 1 && (double)look->equal > equal_share * (double)look->edges;
    if (named || pieces) {
        *out =
            (struct volume_guess){VOLUME_LABELS, 1, named ? "named by a label table" : "areas of equal whole numbers"};
    } else if ((double)look->filled < sparse_share * (double)voxels) {
        *out = (struct volume_guess){VOLUME_PATHWAY, 1, "mostly zero"};
    } else {
        *out = (struct volume_guess){VOLUME_CONTEXT, 1, "values almost everywhere"};
    }
    return status;
}

/* A 4-D file is refused without a choice: then volume 0 stands for all. */
static conus_status open_any(struct volume_file *file, const char *path, uint64_t max_memory)
{
    struct buffer first = {0};
    struct notes notes = {0};
    buffer_format(&first, "%s,volume=0", path);
    conus_status status = buffer_status(&first);
    status = status ? status : volume_file_open(file, first.data, max_memory, &notes);
    buffer_finish(&first);
    notes_finish(&notes);
    return status;
}

conus_status volume_guess_make(struct volume_guess *out, const char *path, uint64_t max_memory)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    float *values = NULL;
    conus_status status = open_any(&file, path, max_memory);
    if (!status && file.info.volume_count > 1) {
        *out = (struct volume_guess){VOLUME_SERIES, file.info.volume_count, "several volumes"};
    } else if (!status) {
        status = volume_file_values(&values, &file, &notes);
        struct look look = status ? (struct look){0} : look_at(values, file.info.dim);
        status = status ? status : judge(out, &file, &look);
    }
    memory_free(values);
    notes_finish(&notes);
    volume_file_finish(&file);
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
