/* SPDX-License-Identifier: BSD-3-Clause */
/* The segments of 3D Slicer in an NRRD header. */
#include "loaders/volumes/text/nrrd_segments.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "loaders/volumes/text/header_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SEGMENT_LIMIT = 1 << 12 };

void nrrd_segments_finish(struct nrrd_segments *segments)
{
    memory_free(segments->segments);
    *segments = (struct nrrd_segments){0};
}

/* Splits "Segment12_Name". False for any other key. */
static bool split_key(struct text key, uint64_t *number, struct text *field)
{
    static const char prefix[] = "Segment";
    size_t start = sizeof prefix - 1;
    const char *line = text_starts(key, prefix) ? memchr(key.data, '_', key.size) : NULL;
    size_t end = line ? (size_t)(line - key.data) : 0;
    if (end <= start || !text_to_uint((struct text){key.data + start, end - start}, UINT32_MAX, number)) {
        return false;
    }
    *field = (struct text){line + 1, key.size - end - 1};
    return true;
}

conus_status nrrd_segments_read(struct nrrd_segments *segments, struct text key, struct text value)
{
    static const struct header_key known[] = {{"Name", NRRD_SEGMENT_NAME},
                                              {"ID", NRRD_SEGMENT_ID},
                                              {"LabelValue", NRRD_SEGMENT_VALUE},
                                              {"Layer", NRRD_SEGMENT_LAYER},
                                              {"Color", NRRD_SEGMENT_COLOUR}};
    uint64_t number;
    struct text name;
    if (!split_key(key, &number, &name)) {
        return CONUS_OK;
    }
    if (number >= SEGMENT_LIMIT) {
        return fail(CONUS_ERROR_DATA, "%.*s: allowed are segments 0 to %d", HEADER_SHOW(key), SEGMENT_LIMIT - 1);
    }
    int field = header_find(known, sizeof known / sizeof known[0], name);
    if (field < 0) {
        return CONUS_OK;
    }
    if (!memory_reserve(&segments->segments, &segments->capacity, (size_t)number + 1, sizeof *segments->segments)) {
        return CONUS_ERROR_MEMORY;
    }
    for (; segments->count <= number; segments->count++) {
        segments->segments[segments->count] = (struct nrrd_segment){0};
    }
    return header_keep(&segments->segments[number].fields[field], value, key);
}

/* "\n" and "\\" stand for what no line can hold. */
static conus_status set_name(char **out, struct text value)
{
    struct buffer plain = {0};
    for (size_t i = 0; i < value.size; i++) {
        bool escaped =
            value.data[i] == '\\' && i + 1 < value.size && (value.data[i + 1] == 'n' || value.data[i + 1] == '\\');
        i += escaped;
        char c = escaped && value.data[i] == 'n' ? ' ' : value.data[i];
        buffer_append(&plain, &c, 1);
    }
    conus_status status = buffer_status(&plain);
    status = status || !plain.size ? status : label_set_text(out, (struct text){plain.data, plain.size});
    buffer_finish(&plain);
    return status;
}

static conus_status set_colour(struct label *label, struct text value, const char *name)
{
    double rgb[3];
    conus_status status = header_numbers(rgb, 3, value, name);
    for (int i = 0; !status && i < 3; i++) {
        if (!(rgb[i] >= 0 && rgb[i] <= 1)) {
            return fail(CONUS_ERROR_DATA, "%s: found %g, allowed are 0 to 1", name, rgb[i]);
        }
        label->rgb[i] = (uint8_t)(rgb[i] * 255 + 0.5);
    }
    label->has_rgb = !status;
    return status;
}

/* One segment. `legacy`: it is label 1 of a volume of its own. */
static conus_status take_segment(struct text_segment *out, const struct text fields[NRRD_SEGMENT_FIELDS], size_t number,
                                 int64_t volumes, bool legacy)
{
    char name[40];
    int64_t value = 1;
    int64_t layer = legacy ? (int64_t)number : 0;
    struct text title = fields[NRRD_SEGMENT_NAME].size ? fields[NRRD_SEGMENT_NAME] : fields[NRRD_SEGMENT_ID];
    snprintf(name, sizeof name, "Segment%zu_LabelValue", number);
    conus_status status = legacy ? CONUS_OK : header_need(fields[NRRD_SEGMENT_VALUE], name, "a label is needed");
    status = status || legacy ? status : header_integer(&value, fields[NRRD_SEGMENT_VALUE], 1, name);
    if (!status && value > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "%s: found %lld, allowed are 1 to 4294967295", name, (long long)value);
    }
    snprintf(name, sizeof name, "Segment%zu_Layer", number);
    bool told = fields[NRRD_SEGMENT_LAYER].data;
    status =
        status || told || legacy || volumes == 1 ? status : header_need((struct text){0}, name, "a layer is needed");
    status = status || !told ? status : header_integer(&layer, fields[NRRD_SEGMENT_LAYER], 0, name);
    if (!status && layer >= volumes) {
        return fail(CONUS_ERROR_DATA, "%s: found %lld, allowed are 0 to %lld", name, (long long)layer,
                    (long long)volumes - 1);
    }
    snprintf(name, sizeof name, "Segment%zu_Color", number);
    status = status ? status : set_name(&out->label.name, title);
    status = status || !fields[NRRD_SEGMENT_COLOUR].data ? status
                                                         : set_colour(&out->label, fields[NRRD_SEGMENT_COLOUR], name);
    out->label.number = (uint32_t)value;
    out->volume = (size_t)layer;
    return status;
}

static int compare_segments(const void *a, const void *b)
{
    const struct text_segment *left = a;
    const struct text_segment *right = b;
    int order = (left->volume > right->volume) - (left->volume < right->volume);
    return order ? order : (left->label.number > right->label.number) - (left->label.number < right->label.number);
}

static conus_status refuse_twins(struct text_volume *out)
{
    qsort(out->segments, out->segment_count, sizeof *out->segments, compare_segments);
    for (size_t i = 1; i < out->segment_count; i++) {
        const struct label *label = &out->segments[i].label;
        if (compare_segments(&out->segments[i - 1], &out->segments[i]) == 0) {
            return fail(CONUS_ERROR_DATA, "segments: label %u of layer %zu is both \"%s\" and \"%s\"", label->number,
                        out->segments[i].volume, out->segments[i - 1].label.name ? out->segments[i - 1].label.name : "",
                        label->name ? label->name : "");
        }
    }
    return CONUS_OK;
}

/* Whether no segment has a value or a layer, and each has a volume, as before Slicer had layers. */
static bool is_legacy(const struct nrrd_segments *segments, int64_t volumes)
{
    bool bare = (int64_t)segments->count == volumes;
    for (size_t i = 0; i < segments->count; i++) {
        const struct text *fields = segments->segments[i].fields;
        bare = bare && !fields[NRRD_SEGMENT_VALUE].data && !fields[NRRD_SEGMENT_LAYER].data;
    }
    return bare;
}

conus_status nrrd_segments_take(struct text_volume *out, const struct nrrd_segments *segments)
{
    bool legacy = is_legacy(segments, out->count);
    if (!segments->count) {
        return CONUS_OK;
    }
    out->segments = memory_zeroed(segments->count, sizeof *out->segments);
    conus_status status = out->segments ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < segments->count; i++) {
        const struct text *fields = segments->segments[i].fields;
        bool there = false;
        for (int k = 0; k < NRRD_SEGMENT_FIELDS; k++) {
            there = there || fields[k].data;
        }
        if (there) {
            struct text_segment *segment = &out->segments[out->segment_count++];
            status = take_segment(segment, fields, i, out->count, legacy);
        }
    }
    return status ? status : refuse_twins(out);
}
