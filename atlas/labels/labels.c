/* SPDX-License-Identifier: BSD-3-Clause */
/* Label tables: adding, sorting, finding, and the area that a label describes. */
#include "atlas/labels/labels.h"

#include "base/memory.h"
#include "base/order.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CONFLICTS_SHOWN = 8 };

void label_finish(struct label *label)
{
    memory_free(label->name);
    memory_free(label->abbreviation);
    *label = (struct label){0};
}

conus_status label_copy(struct label *out, const struct label *label)
{
    *out = *label;
    out->name = label->name ? memory_text(label->name, strlen(label->name)) : NULL;
    out->abbreviation = label->abbreviation ? memory_text(label->abbreviation, strlen(label->abbreviation)) : NULL;
    return !out->name == !label->name && !out->abbreviation == !label->abbreviation ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_object label_object(const struct label *label, size_t index, char digits[LABEL_DIGITS])
{
    conus_object object = {
        .kind = CONUS_KIND_AREA, .label = label->number, .named = label->name != NULL, .hemisphere = label->hemisphere};
    snprintf(digits, LABEL_DIGITS, "%u", label->number);
    object.name = label->name ? label->name : digits;
    object.abbreviation = label->abbreviation ? label->abbreviation : "";
    palette_colour(object.rgb, index);
    memcpy(object.rgb, label->has_rgb ? label->rgb : object.rgb, sizeof object.rgb);
    return object;
}

void label_table_finish(struct label_table *table)
{
    for (size_t i = 0; i < table->count; i++) {
        label_finish(&table->entries[i]);
    }
    memory_free(table->entries);
    memory_free(table->zero);
    *table = (struct label_table){0};
}

struct label *label_table_add(struct label_table *table, uint32_t number)
{
    if (table->count == LABEL_LIMIT) {
        fail(CONUS_ERROR_MEMORY, "more than %d labels", LABEL_LIMIT);
        return NULL;
    }
    if (!memory_reserve(&table->entries, &table->capacity, table->count + 1, sizeof *table->entries)) {
        return NULL;
    }
    struct label *label = &table->entries[table->count++];
    *label = (struct label){.number = number};
    return label;
}

conus_status label_set_text(char **field, struct text text)
{
    text = text_trim(text);
    if (!text.size) {
        return CONUS_OK;
    }
    char *copy = text_to_utf8(text);
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    memory_free(*field);
    *field = copy;
    return CONUS_OK;
}

static int compare_labels(const void *a, const void *b)
{
    return compare_unsigned(((const struct label *)a)->number, ((const struct label *)b)->number);
}

conus_status label_table_sort(struct label_table *table, struct notes *notes)
{
    conus_status status = CONUS_OK;
    size_t kept = 0;
    size_t conflicts = 0;
    size_t several = 0; /* labels with two names or more */
    uint32_t latest = 0;
    size_t colourless = 0;
    order_sort(table->entries, table->count, sizeof *table->entries, compare_labels);
    for (size_t i = 0; !status && i < table->count; i++) {
        struct label *label = &table->entries[i];
        struct label *last = kept ? &table->entries[kept - 1] : NULL; /* of equal ones the first that appeared */
        colourless += label->bad_rgb;
        label->bad_rgb = false;
        if (last && last->number == label->number) {
            bool differ = last->name && label->name && strcmp(last->name, label->name) != 0;
            several += differ && latest != label->number;
            latest = differ ? label->number : latest;
            if (differ && ++conflicts <= CONFLICTS_SHOWN) {
                status = notes_warn(notes, "label %u is named twice in the label table: \"%s\" is used, \"%s\" is not",
                                    last->number, last->name, label->name);
            }
            label_finish(label);
        } else {
            struct label moved = *label;
            *label = (struct label){0};
            table->entries[kept++] = moved;
        }
    }
    table->count = status ? table->count : kept;
    if (!status && several > 1 && several == kept) {
        status = fail(CONUS_ERROR_DATA,
                      "each of the %zu labels has several names in the label table, as of levels: one row for each "
                      "label is needed",
                      kept);
    }
    if (!status && colourless) {
        status = notes_add(notes, "label table: %zu of its colours cannot be read: left out", colourless);
    }
    if (!status && conflicts > CONFLICTS_SHOWN) {
        status = notes_warn(notes, "%zu more labels are named twice in the label table", conflicts - CONFLICTS_SHOWN);
    }
    return status;
}

struct label *label_table_find(const struct label_table *table, uint32_t number)
{
    struct label key = {.number = number};
    return table->count ? bsearch(&key, table->entries, table->count, sizeof key, compare_labels) : NULL;
}

/* The first entry that is another number, and the same float32. */
static const struct label *find_twin(const struct label_table *table, uint32_t number)
{
    enum { REACH = 128 }; /* half a step of a float32 below 2^32 */
    size_t first = 0;     /* of those that may be */
    for (size_t end = table->count; first < end;) {
        size_t middle = first + (end - first) / 2;
        bool below = (uint64_t)table->entries[middle].number + REACH < number;
        first = below ? middle + 1 : first;
        end = below ? end : middle;
    }
    for (; first < table->count && table->entries[first].number <= (uint64_t)number + REACH; first++) {
        if (table->entries[first].number != number && (float)table->entries[first].number == (float)number) {
            return &table->entries[first];
        }
    }
    return NULL;
}

conus_status label_table_check_singles(const struct label_table *table, const uint32_t *labels, size_t count,
                                       double end, const char *path, struct notes *notes)
{
    uint32_t largest = 0;
    for (size_t i = 0; i < count; i++) {
        const struct label *twin = (double)labels[i] >= end ? find_twin(table, labels[i]) : NULL;
        if (twin) {
            return fail(CONUS_ERROR_DATA,
                        "%s: the label %u, \"%s\", is %u as float32, as which the file keeps labels: whose voxels are "
                        "of which is lost; make the file again with whole numbers",
                        path, twin->number, twin->name ? twin->name : "", labels[i]);
        }
        largest = labels[i] > largest ? labels[i] : largest;
    }
    return largest < end ? CONUS_OK
                         : notes_warn(notes,
                                      "%s: labels up to %u as float32, which from %.0f on does not hold every whole "
                                      "number: areas may have become one, or have another number; make the file again "
                                      "with whole numbers",
                                      path, largest, end);
}

void palette_colour(uint8_t rgb[3], size_t index)
{
    static const double offsets[3] = {5, 3, 1};
    static const double values[3] = {0.95, 0.75, 0.85};
    const double golden = 0.61803398874989485;
    double hue = fmod(0.08 + golden * (double)index, 1);
    double saturation = 0.45 + 0.25 * (double)(index / 3 % 2);
    for (int i = 0; i < 3; i++) {
        /* HSV to RGB after A. R. Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978, in its closed form. */
        double k = fmod(offsets[i] + hue * 6, 6);
        double slope = fmax(0, fmin(1, fmin(k, 4 - k)));
        rgb[i] = (uint8_t)lround(255 * values[index % 3] * (1 - saturation * slope));
    }
}
