/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds an area or pathway by name, abbreviation or label, and suggests the closest one. */
#include "atlas/areas/areas.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { SHOWN = 12, CONTAINED_FROM = 3, QUOTED_SIZE = 80, NEAREST = 3 };

/** The objects that a text names. */
struct matches {
    size_t count;
    uint32_t numbers[SHOWN]; /* the first of them */
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

/* Bytes of the blank, _, -, dot, comma or bracket that a text begins with; 0 = none. */
static size_t between(struct text text)
{
    size_t blank = text_blank(text);
    return blank ? blank : text.size && text.data[0] && strchr("_-.,()[]{}", text.data[0]);
}

static struct text behind(struct text text, size_t size)
{
    return (struct text){text.data + size, text.size - size};
}

/* Takes the next word of a name, of what is not between words, off *rest. A minus is a part of its number. */
static bool take_word(struct text *rest, struct text *word)
{
    while (between(*rest) && !(rest->data[0] == '-' && text_digits(*rest, 1))) {
        *rest = behind(*rest, between(*rest));
    }
    size_t size = rest->size > 0;
    while (size < rest->size && !between(behind(*rest, size))) {
        size++;
    }
    *word = (struct text){rest->data, size};
    *rest = behind(*rest, size);
    *rest = behind(*rest, between(*rest)); /* so that a dash behind a word is no minus of the next */
    return size;
}

static bool is_same_word(struct text a, struct text b)
{
    return a.size == b.size && strncasecmp(a.data, b.data, a.size) == 0;
}

static char side_of_word(struct text word)
{
    return text_is_one_of(word, "left/l/lh", false) ? 'L' : text_is_one_of(word, "right/r/rh", false) ? 'R' : 0;
}

/** The word of a name that is left out, from 0. */
enum { NO_WORD = -1 };

/* Whether two names have the same words, but for word `left_out` of each, and one at least. */
static bool have_same_words(struct text a, int left_out_a, struct text b, int left_out_b)
{
    struct text x;
    struct text y;
    size_t same = 0;
    for (int i = 0, k = 0;; i++, k++) {
        bool has_x = take_word(&a, &x) && (i != left_out_a || take_word(&a, &x));
        bool has_y = take_word(&b, &y) && (k != left_out_b || take_word(&b, &y));
        i += i == left_out_a;
        k += k == left_out_b;
        if (!has_x || !has_y || !is_same_word(x, y)) {
            return !has_x && !has_y && same;
        }
        same++;
    }
}

/* The side that a text says by its first or last word, the number of which is *at; 0 if it says none, or both do. */
static char find_side(int *at, struct text text)
{
    struct text word;
    char first = 0;
    char last = 0;
    int count = 0;
    for (; take_word(&text, &word); count++) {
        last = side_of_word(word);
        first = count ? first : last;
    }
    *at = first ? 0 : count - 1;
    return count < 2 || (first && last) ? 0 : first ? first : last;
}

/* Whether a name is `text`, whose word `left_out` says the side, where some word of the name or the object itself does.
 * Without a side (0) the name's side is left out. */
static bool is_sided_name(const conus_object *object, const char *name, struct text text, char side, int left_out)
{
    struct text rest = text_from(name);
    struct text word;
    if (side && object->hemisphere == side && have_same_words(text, left_out, text_from(name), NO_WORD)) {
        return true;
    }
    for (int i = 0; take_word(&rest, &word); i++) {
        char own = side_of_word(word);
        if (own && (!side || own == side) && have_same_words(text, left_out, text_from(name), i)) {
            return true;
        }
    }
    return false;
}

static bool has_its_words(const conus_object *object, struct text text)
{
    return have_same_words(text, NO_WORD, text_from(object->name), NO_WORD) ||
           have_same_words(text, NO_WORD, text_from(object->abbreviation), NO_WORD);
}

static bool has_its_words_and_side(const conus_object *object, struct text text)
{
    int at = NO_WORD;
    char side = find_side(&at, text);
    return side && (is_sided_name(object, object->name, text, side, at) ||
                    is_sided_name(object, object->abbreviation, text, side, at));
}

static bool has_its_words_on_a_side(const conus_object *object, struct text text)
{
    return is_sided_name(object, object->name, text, 0, NO_WORD) ||
           is_sided_name(object, object->abbreviation, text, 0, NO_WORD);
}

/* Of objects behind the first `from`, up to number `count`. */
static struct matches find_matches(const conus_atlas *atlas, size_t from, size_t count, struct text text,
                                   bool (*matches)(const conus_object *object, struct text text))
{
    struct matches found = {0};
    for (uint32_t number = (uint32_t)from + 1; number <= count; number++) {
        if (!atlas_is_paired(atlas, number) && matches(&atlas->objects[number - 1], text)) {
            if (found.count < SHOWN) {
                found.numbers[found.count] = number;
            }
            found.count++;
        }
    }
    return found;
}

/** How likely a name was meant: `near` is compared first, then `far`. */
struct likeness {
    const char *name; /* NULL = it is not close */
    size_t near, far;
};

static bool is_likelier(const struct likeness *a, const struct likeness *b)
{
    return !b->name || a->near < b->near || (a->near == b->near && a->far < b->far);
}

/* A name that contains the text counts as a third of its bytes mistyped; no name if it is not close. */
static struct likeness judge_name(const char *name, struct text text)
{
    size_t far = text_distance(text, text_from(name));
    size_t limit = (text.size + 1) / 3;
    bool contained = text.size >= CONTAINED_FROM && text_contains(text_from(name), text);
    size_t near = contained && far > limit ? limit : far;
    return (struct likeness){*name && near <= limit ? name : NULL, near, far};
}

/* Puts the object in its place among the likeliest, by its likelier name. */
static void consider_object(struct likeness best[NEAREST], const conus_object *object, struct text text)
{
    struct likeness found = judge_name(object->name, text);
    struct likeness other = judge_name(object->abbreviation, text);
    found = other.name && is_likelier(&other, &found) ? other : found;
    for (size_t i = 0; i < NEAREST && found.name; i++) {
        if (best[i].name && strcmp(best[i].name, found.name) == 0) {
            return;
        }
        if (is_likelier(&found, &best[i])) {
            struct likeness next = best[i];
            best[i] = found;
            found = next;
        }
    }
}

/* @p count: how many objects were searched, areas or all. */
static conus_status fail_unknown(const conus_atlas *atlas, size_t count, struct text text)
{
    struct likeness best[NEAREST] = {{0}};
    const char *kind = count <= atlas->area_count ? "area"
                       : atlas->tractogram_count  ? "area, pathway or bundle"
                                                  : "area or pathway";
    for (size_t i = 0; i < count; i++) {
        if (!atlas_is_paired(atlas, (uint32_t)i + 1)) {
            consider_object(best, &atlas->objects[i], text);
        }
    }
    struct buffer list = {0};
    bool has_comma = false;
    for (size_t i = 0; i < NEAREST && best[i].name; i++) {
        bool is_last = i + 1 == NEAREST || !best[i + 1].name;
        buffer_format(&list, "%s\"%s\"%s",
                      !i        ? "; did you mean "
                      : is_last ? " or "
                                : ", ",
                      best[i].name, is_last ? "?" : "");
        has_comma = has_comma || strchr(best[i].name, ',');
    }
    conus_status status = buffer_status(&list);
    if (!status) {
        status = fail(CONUS_ERROR_ARGUMENT, "no %s has the name, abbreviation or label \"%.*s\"%s%s", kind,
                      TEXT_SHOW(text, QUOTED_SIZE), list.data ? list.data : "",
                      has_comma ? " Names with commas are put in double quotes" : "");
    }
    buffer_finish(&list);
    return status;
}

/* Lists the objects that a text may mean; those with a side that their names do not say with it. */
static conus_status fail_several(const conus_atlas *atlas, const struct matches *found, struct text text)
{
    struct buffer list = {0};
    for (size_t i = 0; i < found->count && i < SHOWN; i++) {
        const conus_object *object = &atlas->objects[found->numbers[i] - 1];
        struct side_word word;
        const char *side = side_word_find(&word, text_from(object->name), 0) ? ""
                           : object->hemisphere == 'L'                       ? "left "
                           : object->hemisphere == 'R'                       ? "right "
                                                                             : "";
        buffer_format(&list, "%s\"%s%s\"", i ? ", " : "", side, object->name);
        if (object->kind == CONUS_KIND_AREA) {
            buffer_format(&list, " (%u)", object->label);
        }
    }
    conus_status status = buffer_status(&list);
    if (!status) {
        status = fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" may be any of %zu: %s%s; give a name or a label",
                      TEXT_SHOW(text, QUOTED_SIZE), found->count, list.data, found->count > SHOWN ? ", ..." : "");
    }
    buffer_finish(&list);
    return status;
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
                    TEXT_SHOW(text, QUOTED_SIZE), pair->name, pair->label);
    }
    if (area_find_halves(halves, atlas, text)) {
        const conus_object *left = &atlas->objects[halves[0] - 1];
        const conus_object *right = &atlas->objects[halves[1] - 1];
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is cut in two: \"%s\", label %u, and \"%s\", label %u",
                    TEXT_SHOW(text, QUOTED_SIZE), left->name, left->label, right->name, right->label);
    }
    return CONUS_OK;
}

/* Sets *out to 0 if no area has the name, and nothing explains why. */
static conus_status find_area(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    struct matches found = find_matches(atlas, 0, atlas->area_count, text, is_called);
    if (!found.count) {
        found = find_matches(atlas, 0, atlas->area_count, text, is_called_ignoring_case);
    }
    if (found.count > 1) {
        return fail_several(atlas, &found, text);
    }
    conus_status status = found.count ? CONUS_OK : refuse_changed(atlas, text);
    return GIVE(status, out, found.numbers[0], 0);
}

/* Finds one of the first `count` objects by its words, in which blanks, _, -, dots, commas and brackets are one, and a
 * word for the side may stand on either end. Sets *out to 0 if none is meant. */
static conus_status find_by_words(uint32_t *out, const conus_atlas *atlas, size_t count, struct text text)
{
    struct matches found = find_matches(atlas, 0, count, text, has_its_words);
    if (!found.count) {
        found = find_matches(atlas, 0, count, text, has_its_words_and_side);
    }
    if (!found.count) {
        found = find_matches(atlas, 0, count, text, has_its_words_on_a_side);
        found.count = found.count > 1 ? found.count : 0; /* a side is never chosen for somebody */
    }
    *out = found.count == 1 ? found.numbers[0] : 0;
    return found.count > 1 ? fail_several(atlas, &found, text) : CONUS_OK;
}

/* Of an area without a side that was asked for with one; else CONUS_OK. */
static conus_status refuse_side(const conus_atlas *atlas, struct text text)
{
    int at = NO_WORD;
    int own_at = NO_WORD;
    char side = find_side(&at, text);
    for (uint32_t number = 1; side && number <= atlas->area_count; number++) {
        const conus_object *area = &atlas->objects[number - 1];
        if (!atlas_is_paired(atlas, number) && !area->hemisphere &&
            (have_same_words(text, at, text_from(area->name), NO_WORD) ||
             have_same_words(text, at, text_from(area->abbreviation), NO_WORD))) {
            const char own = find_side(&own_at, text_from(area->name));
            return own ? fail(CONUS_ERROR_ARGUMENT, "\"%.*s\": \"%s\" is on the %s by its name: which side is meant?",
                              TEXT_SHOW(text, QUOTED_SIZE), area->name, own == 'L' ? "left" : "right")
                       : fail(CONUS_ERROR_ARGUMENT,
                              "\"%.*s\": \"%s\" has no sides here; --hemispheres split makes \"%s %s\" of it",
                              TEXT_SHOW(text, QUOTED_SIZE), area->name, area->name, side == 'L' ? "left" : "right");
        }
    }
    return CONUS_OK;
}

conus_status area_find(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    uint32_t found = 0;
    conus_status status = find_area(&found, atlas, text);
    status = status || found ? status : find_by_words(&found, atlas, atlas->area_count, text);
    if (!status && !found && find_matches(atlas, atlas->area_count, atlas->object_count, text, is_called).numbers[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is a pathway, which is no part of the area tree",
                    TEXT_SHOW(text, QUOTED_SIZE));
    }
    status = status || found ? status : refuse_side(atlas, text);
    if (!status && !found) {
        return fail_unknown(atlas, atlas->area_count, text);
    }
    return GIVE(status, out, found, 0);
}

conus_status object_find(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    uint32_t found = find_matches(atlas, atlas->area_count, atlas->object_count, text, is_called).numbers[0];
    conus_status status = found ? CONUS_OK : find_area(&found, atlas, text);
    if (!status && !found) {
        found = find_matches(atlas, atlas->area_count, atlas->object_count, text, is_called_ignoring_case).numbers[0];
    }
    status = status || found ? status : find_by_words(&found, atlas, atlas->object_count, text);
    status = status || found ? status : refuse_side(atlas, text);
    if (!status && !found) {
        return fail_unknown(atlas, atlas->object_count, text);
    }
    return GIVE(status, out, found, 0);
}

static bool has_the_word(const conus_object *object, struct text text)
{
    struct text rest = text_from(object->name);
    struct text word;
    while (take_word(&rest, &word)) {
        if (is_same_word(word, text)) {
            return true;
        }
    }
    return false;
}

conus_status object_find_word(uint32_t *out, const conus_atlas *atlas, struct text text)
{
    struct matches found = find_matches(atlas, 0, atlas->object_count, text, has_the_word);
    if (found.count > 1) {
        return fail_several(atlas, &found, text);
    }
    *out = found.count ? found.numbers[0] : 0;
    return CONUS_OK;
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
