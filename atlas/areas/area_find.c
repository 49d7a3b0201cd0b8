/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds an area or pathway by name, abbreviation or label, and suggests the closest one. */
#include "atlas/areas/area_find.h"

#include "base/buffer.h"
#include "base/memory.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { SHOWN = 4, CONTAINED_FROM = 3, QUOTED_SIZE = 80 };

/** The areas that a text names. */
struct matches {
    uint32_t first;
    size_t count;
    uint32_t labels[SHOWN];
};

static bool is_called(const conus_object *object, struct text text)
{
    uint64_t label;
    return text_equal(text, object->name) || text_equal(text, object->abbreviation) ||
           (object->kind == CONUS_KIND_AREA && text_to_uint(text, UINT32_MAX, &label) && label == object->label);
}

static bool is_called_ignoring_case(const conus_object *object, struct text text)
{
    return text_equal_ignoring_case(text, object->name) || text_equal_ignoring_case(text, object->abbreviation);
}

static struct matches find_matches(const conus_atlas *atlas, struct text text,
                                   bool (*matches)(const conus_object *object, struct text text))
{
    struct matches found = {0};
    for (size_t i = 0; i < atlas->area_count; i++) {
        if (!atlas_is_paired(atlas, (uint32_t)i + 1) && matches(&atlas->objects[i], text)) {
            found.first = found.count ? found.first : (uint32_t)i + 1;
            if (found.count < SHOWN) {
                found.labels[found.count] = atlas->objects[i].label;
            }
            found.count++;
        }
    }
    return found;
}

/* Long texts are cut in messages. */
static int shown_size(struct text text)
{
    return (int)(text.size < QUOTED_SIZE ? text.size : QUOTED_SIZE);
}

/** How likely a name was meant: `near` is compared first, then `far`. */
struct likeness {
    const char *name; /* NULL = none is close */
    size_t near, far;
};

/* A name that contains the text counts as a third of its bytes mistyped. */
static void consider_name(struct likeness *best, const char *name, struct text text)
{
    size_t far = text_distance(text, text_from(name));
    size_t limit = (text.size + 1) / 3;
    bool contained = text.size >= CONTAINED_FROM && text_contains(text_from(name), text);
    size_t near = contained && far > limit ? limit : far;
    if (*name && near <= limit && (!best->name || near < best->near || (near == best->near && far < best->far))) {
        *best = (struct likeness){name, near, far};
    }
}

/* @p count: how many objects were searched, areas or all. */
static conus_status fail_unknown(const conus_atlas *atlas, size_t count, struct text text)
{
    struct likeness best = {0};
    const char *kind = count <= atlas->area_count ? "area"
                       : atlas->tractogram_count  ? "area, pathway or bundle"
                                                  : "area or pathway";
    for (size_t i = 0; i < count; i++) {
        if (atlas_is_paired(atlas, (uint32_t)i + 1)) {
            continue;
        }
        consider_name(&best, atlas->objects[i].name, text);
        consider_name(&best, atlas->objects[i].abbreviation, text);
    }
    if (!best.name) {
        return fail(CONUS_ERROR_ARGUMENT, "no %s has the name, abbreviation or label \"%.*s\"", kind, shown_size(text),
                    text.data);
    }
    return fail(CONUS_ERROR_ARGUMENT, "no %s has the name, abbreviation or label \"%.*s\"; did you mean \"%s\"?%s",
                kind, shown_size(text), text.data, best.name,
                strchr(best.name, ',') ? " Names with commas are put in double quotes" : "");
}

/* The number of the first pathway that the text names, 0 if there is none. */
static uint32_t find_pathway(const conus_atlas *atlas, struct text text,
                             bool (*matches)(const conus_object *object, struct text text))
{
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        if (matches(&atlas->objects[i], text)) {
            return (uint32_t)i + 1;
        }
    }
    return 0;
}

/* Whether `name` is `text` and then `side`. */
static bool is_half_name(const char *name, struct text text, const char *side, bool ignoring_case)
{
    size_t size = text.size;
    int (*compare)(const char *, const char *, size_t) = ignoring_case ? strncasecmp : strncmp;
    return strlen(name) > size && compare(name, text.data, size) == 0 && strcmp(name + size, side) == 0;
}

static bool is_half_of(const conus_atlas *atlas, const conus_object *half, struct text text, bool ignoring_case)
{
    bool left = half->hemisphere == 'L';
    uint32_t step = atlas->half_step * (left ? 1 : 2);
    uint64_t label;
    if (half->label < step) {
        return false;
    }
    return is_half_name(half->name, text, left ? " left" : " right", ignoring_case) ||
           is_half_name(half->abbreviation, text, left ? "_L" : "_R", ignoring_case) ||
           (!ignoring_case && text_to_uint(text, UINT32_MAX, &label) && half->label - step == label);
}

static size_t match_halves(uint32_t out[2], const conus_atlas *atlas, struct text text, bool ignoring_case)
{
    size_t count = 0;
    for (size_t i = 0; i < atlas->area_count; i++) {
        if (is_half_of(atlas, &atlas->objects[i], text, ignoring_case)) {
            if (count < 2) {
                out[count] = (uint32_t)i + 1;
            }
            count++;
        }
    }
    return count;
}

bool area_find_halves(uint32_t out[2], const conus_atlas *atlas, struct text text)
{
    if (!atlas->half_step || !text.size) {
        return false;
    }
    size_t count = match_halves(out, atlas, text, false);
    count = count ? count : match_halves(out, atlas, text, true);
    return count == 2;
}

/* The merged area of the one called `text`; NULL if none was merged. */
static const conus_object *find_pair(const conus_atlas *atlas, struct text text)
{
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        const conus_object *area = &atlas->objects[number - 1];
        if (atlas_is_paired(atlas, number) && is_called(area, text)) {
            return &atlas->objects[area->parent - 1];
        }
    }
    return NULL;
}

/* Explains, if `text` was an area before the hemispheres changed, what became of it; else CONUS_OK. */
static conus_status refuse_changed(const conus_atlas *atlas, struct text text)
{
    uint32_t halves[2];
    const conus_object *pair = find_pair(atlas, text);
    if (pair) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is merged with the other side into \"%s\", label %u",
                    shown_size(text), text.data, pair->name, pair->label);
    }
    if (area_find_halves(halves, atlas, text)) {
        const conus_object *left = &atlas->objects[halves[0] - 1];
        const conus_object *right = &atlas->objects[halves[1] - 1];
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is cut in two: \"%s\", label %u, and \"%s\", label %u",
                    shown_size(text), text.data, left->name, left->label, right->name, right->label);
    }
    return CONUS_OK;
}

/* Sets *out to 0 if no area has the name, and nothing explains why. */
static conus_status find_area(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    struct matches found = find_matches(atlas, text, is_called);
    if (!found.count) {
        found = find_matches(atlas, text, is_called_ignoring_case);
    }
    if (found.count > 1) {
        struct buffer list = {0};
        for (size_t i = 0; i < found.count && i < SHOWN; i++) {
            buffer_format(&list, "%s%u", i ? ", " : "", found.labels[i]);
        }
        conus_status status = buffer_status(&list);
        if (!status) {
            status = fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" may be any of %zu areas, whose labels are %s%s: give a label",
                          shown_size(text), text.data, found.count, list.data, found.count > SHOWN ? ", ..." : "");
        }
        buffer_finish(&list);
        return status;
    }
    conus_status status = found.count ? CONUS_OK : refuse_changed(atlas, text);
    if (!status) {
        *out = found.first;
    }
    return status;
}

conus_status area_find(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    uint32_t found = 0;
    conus_status status = find_area(&found, atlas, text);
    if (!status && !found && find_pathway(atlas, text, is_called)) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is a pathway, which is no part of the area tree", shown_size(text),
                    text.data);
    }
    if (!status && !found) {
        return fail_unknown(atlas, atlas->area_count, text);
    }
    if (!status) {
        *out = found;
    }
    return status;
}

conus_status object_find(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    uint32_t found = find_pathway(atlas, text, is_called);
    conus_status status = found ? CONUS_OK : find_area(&found, atlas, text);
    if (!status && !found) {
        found = find_pathway(atlas, text, is_called_ignoring_case);
    }
    if (!status && !found) {
        return fail_unknown(atlas, atlas->object_count, text);
    }
    if (!status) {
        *out = found;
    }
    return status;
}

/* Adds a name of object `number` to the index. */
static conus_status index_name(struct object_index *index, const char *name, size_t number)
{
    struct known_name *known = name_set_find(&index->names, name);
    if (!*name || !known) {
        return *name ? name_set_add(&index->names, name, number) : CONUS_OK;
    }
    known->value = known->value == number ? number : 0;
    return CONUS_OK;
}

conus_status object_index_init(struct object_index *out, const conus_atlas *atlas)
{
    size_t count = atlas->half_step ? 0 : atlas->object_count; /* an area that was cut is found as its halves */
    conus_status status = CONUS_OK;
    out->digits = memory_raw(count, LABEL_DIGITS);
    for (size_t i = 0; !status && out->digits && i < count; i++) {
        const conus_object *object = &atlas->objects[i];
        char *digits = out->digits + i * LABEL_DIGITS;
        if (!atlas_is_paired(atlas, (uint32_t)i + 1)) {
            snprintf(digits, LABEL_DIGITS, "%u", object->label);
            status = index_name(out, object->name, i + 1);
            status = status ? status : index_name(out, object->abbreviation, i + 1);
            status = status || object->kind != CONUS_KIND_AREA ? status : index_name(out, digits, i + 1);
        }
    }
    return out->digits ? status : CONUS_ERROR_MEMORY;
}

void object_index_finish(struct object_index *index)
{
    name_set_finish(&index->names);
    memory_free(index->digits);
}

uint32_t object_index_find(const struct object_index *index, struct text text)
{
    char name[256];
    if (text.size >= sizeof name || memchr(text.data, '\0', text.size)) {
        return 0;
    }
    snprintf(name, sizeof name, "%.*s", (int)text.size, text.data);
    const struct known_name *known = name_set_find(&index->names, name);
    return known ? (uint32_t)known->value : 0;
}

conus_status conus_atlas_find(uint32_t *out, const conus_atlas *atlas, const char *name)
{
    struct text text = text_from(name);
    return text.size ? object_find(out, atlas, text) : fail(CONUS_ERROR_ARGUMENT, "name: empty, one is needed");
}
