/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of keys behind a file, and the one way to cut them off. */
#include "sources/names.h"

#include "base/system/system.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum key_type { IS_TEXT, IS_NUMBERS, IS_WHOLE, IS_WORD, IS_FLAG };

struct source_key {
    enum source_key_id id;
    const char *name;
    unsigned kinds;
    enum key_type type;
    size_t least, most;  /* numbers, with ':' between them: so many, or any number of whole ones; of two
                            the second is larger, */
    bool any_order;      /* unless this is set */
    double low, high;    /* of each */
    bool is_above;       /* it is not `low` itself */
    const char *words;   /* '/' between them; of IS_TEXT: any other is an image, whose keys stand behind it */
    const char *allowed; /* in a message */
    const char *refusal; /* of a file that does not take it */
    bool goes_on;        /* the value may have commas, up to the next key */
    bool repeats;
};

#define FILES (KEYS_VOLUME | KEYS_SCENE | KEYS_ATLAS)
#define FIELDS "is for results of SimNIBS (.hdf5) as a region of interest, this file has none"
#define PLACED "is for TIFF stacks and OME-Zarr, this file says itself where it lies"
#define A_NAME "a name is needed"
#define AN_IMAGE "an image is needed"
#define A_COLUMN "the title of a column is needed"
#define A_PART "labels of vertices, a mask or a structure of the atlas is needed"
#define A_POINT "three numbers X:Y:Z are needed"
#define WHOLE "allowed are whole numbers from 0"
#define ABOVE_0 "allowed is a number above 0"
#define MOST (UINT32_MAX - 1.0) /* its successor is the number of a label */
#define TO(high) "allowed is a number from 0 to " high
#define A_GRID "three numbers of degrees FIRST:LAST:STEP are needed"
#define UP_TO_180 "allowed is a number of degrees above 0, up to 180"
#define ONE_TO_16 "allowed are whole numbers from 1 to 16"

/* So many numbers; any one above 0. */
#define NUMBERS(count) IS_NUMBERS, .least = (count), .most = (count)
#define POSITIVE NUMBERS(1), .high = INFINITY, .is_above = true, .allowed = ABOVE_0
#define POINT NUMBERS(3), .any_order = true, .low = -1e9, .high = 1e9, .allowed = A_POINT

static const struct source_key rows[] = {
    {KEY_VOLUME, "volume", FILES | KEYS_PATHWAY, IS_WHOLE, .least = 1, .most = 1, .high = MOST,
     .allowed = WHOLE " to 4294967294"},
    {KEY_RESOLUTION, "resolution", FILES | KEYS_PATHWAY, IS_NUMBERS, .least = 1, .most = 3, .high = INFINITY,
     .is_above = true, .allowed = "allowed are one or three (page:row:column) numbers above 0, in micrometres",
     .refusal = PLACED},
    {KEY_ORIENTATION, "orientation", FILES | KEYS_PATHWAY, .allowed = "three letters are needed, as in asr",
     .refusal = PLACED},
    {KEY_LEVEL, "level", FILES | KEYS_PATHWAY, IS_WHOLE, .least = 1, .most = 1, .high = INT32_MAX, .allowed = WHOLE,
     .refusal = "is for OME-Zarr, this file has none"},
    {KEY_FIELD, "field", FILES, .allowed = A_NAME, .refusal = FIELDS},
    {KEY_TISSUE, "tissue", FILES, IS_WHOLE, .least = 1, .most = KEY_NUMBERS, .high = UINT32_MAX,
     .allowed = "allowed are up to 16 whole numbers from 0, as in 1:2", .refusal = FIELDS},
    {KEY_MAP, "map", FILES | KEYS_VERTICES, .allowed = "a number from 0 or a name is needed",
     .refusal = "is for labels of CIFTI and GIFTI, this file has none", .goes_on = true},
    {KEY_TEMPLATE, "template", KEYS_ATLAS, IS_WORD, .words = "mni152/colin27/mni305/none",
     .allowed = "allowed are mni152, colin27, mni305, and none for one person's own brain"},
    {KEY_SPACE, "space", KEYS_SCENE | KEYS_ATLAS, .words = "ras/lps", .allowed = "allowed are ras, lps and an image",
     .refusal = "is for surfaces, and this is none", .goes_on = true},
    {KEY_SPACE, "space", KEYS_STREAMLINES | KEYS_TRANSFORM, IS_WORD, .words = "ras/lps",
     .allowed = "allowed are ras and lps"},
    {KEY_LABEL, "label", KEYS_LABELS, .allowed = A_COLUMN},
    {KEY_NAME, "name", KEYS_LABELS, .allowed = A_COLUMN},
    {KEY_NAME, "name", KEYS_PATHWAY | KEYS_STREAMLINES, .allowed = A_NAME},
    {KEY_THRESHOLD, "threshold", KEYS_PATHWAY, POSITIVE},
    {KEY_UNIT, "unit", KEYS_PATHWAY, .allowed = "a unit is needed"},
    {KEY_BAND, "band", KEYS_PATHWAY, .allowed = "LOW:HIGH:NAME is needed", .repeats = true},
    {KEY_RADIUS, "radius", KEYS_STREAMLINES, POSITIVE},
    {KEY_MOVES, "moves", KEYS_STREAMLINES, .type = IS_FLAG},
    {KEY_FROM, "from", KEYS_TRANSFORM, .allowed = AN_IMAGE, .goes_on = true},
    {KEY_TO, "to", KEYS_TRANSFORM, .allowed = AN_IMAGE, .goes_on = true},
    {KEY_INVERSE, "inverse", KEYS_TRANSFORM, .type = IS_FLAG},
    {KEY_RELATIVE, "relative", KEYS_TRANSFORM, .type = IS_FLAG},
    {KEY_ABSOLUTE, "absolute", KEYS_TRANSFORM, .type = IS_FLAG},
    {KEY_GRID, "grid", KEYS_TRANSFORM, .allowed = AN_IMAGE, .goes_on = true},
    {KEY_TRANSFORM, "transform", KEYS_TRANSFORM, IS_WHOLE, .least = 1, .most = 1, .high = UINT32_MAX, .allowed = WHOLE},
    {KEY_ARRAY, "array", KEYS_MAP, .allowed = A_NAME},
    {KEY_RANGE, "range", KEYS_MAP, NUMBERS(2), .low = -INFINITY, .high = INFINITY, .is_above = true,
     .allowed = "allowed are two numbers LOW:HIGH, the second larger"},
    {KEY_X, "x", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_Y, "y", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_Z, "z", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_NAME, "name", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_PLACE, "place", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_UNIT, "unit", KEYS_POSES, .allowed = "allowed are mm, um, cm and m", .goes_on = true},
    {KEY_SIDES, "sides", KEYS_POSES, IS_WORD, .words = "anyway", .allowed = "allowed is anyway", .goes_on = true},
    {KEY_TILT_ML, "tilt_ml", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_TILT_AP, "tilt_ap", KEYS_POSES, .allowed = A_COLUMN, .goes_on = true},
    {KEY_DEPTH, "depth", KEYS_POSES, .allowed = "allowed are mm, um, cm and m", .goes_on = true},
    {KEY_RADIUS, "radius", KEYS_POSES, .allowed = "allowed are mm, um, cm and m", .goes_on = true},
    {KEY_SPACING, "spacing", KEYS_ENTRIES | KEYS_TARGETS, NUMBERS(1), .low = 1e-3, .high = 1e6,
     .allowed = "allowed is a number from 0.001 to 1000000"},
    {KEY_WITHIN, "within", KEYS_ENTRIES, .allowed = A_PART, .goes_on = true},
    {KEY_WITHOUT, "without", KEYS_ENTRIES, .allowed = A_PART, .goes_on = true},
    {KEY_FLIP, "flip", KEYS_ENTRIES, .type = IS_FLAG},
    {KEY_OF, "of", KEYS_TARGETS, .allowed = "names of structures are needed", .goes_on = true},
    {KEY_WITHIN, "within", KEYS_CLEARANCE, NUMBERS(1), .high = 1000,
     .allowed = "allowed is a number of mm from 0 to 1000"},
    {KEY_STEP, "step", KEYS_PROFILE, POSITIVE},
    {KEY_FILL, "fill", KEYS_VERTEX_MAP, IS_WORD, .words = "nearest", .allowed = "allowed is nearest"},
    {KEY_LENGTH, "length", KEYS_REACH, NUMBERS(1), .high = 1e9, .allowed = TO("1e9")},
    {KEY_TIP, "tip", KEYS_REACH, .type = IS_FLAG},
    {KEY_CROSSED, "crossed", KEYS_REACH, .type = IS_FLAG},
    {KEY_PART, "part", KEYS_REACH, NUMBERS(2), .high = INFINITY,
     .allowed = "allowed is A:B with numbers from 0, the lower one first"},
    {KEY_CONTACTS, "contacts", KEYS_REACH, NUMBERS(1), .high = 65536, .allowed = TO("65536")},
    {KEY_CONTACTS, "contacts", KEYS_COVER, IS_WHOLE, .least = 1, .most = 1, .low = 1, .high = 1000000,
     .allowed = "allowed is a whole number from 1 to 1000000"},
    {KEY_PROBABILITY, "probability", KEYS_REACH, NUMBERS(1), .high = 1, .allowed = TO("1")},
    {KEY_SHARE, "share", KEYS_REACH | KEYS_AVOID, NUMBERS(1), .high = 1, .allowed = TO("1")},
    {KEY_PIERCED, "pierced", KEYS_REACH | KEYS_AVOID, NUMBERS(1), .high = 1, .allowed = TO("1")},
    {KEY_VOLUME, "volume", KEYS_REACH, NUMBERS(1), .high = 1e12, .allowed = TO("1e12")},
    {KEY_FRACTION, "fraction", KEYS_REACH, NUMBERS(1), .high = 1, .allowed = TO("1")},
    {KEY_STREAMLINES, "streamlines", KEYS_REACH, NUMBERS(1), .high = 1e12, .allowed = TO("1e12")},
    {KEY_MARGIN, "margin", KEYS_AVOID, NUMBERS(1), .high = 100, .allowed = TO("100")},
    {KEY_SHANK, "shank", KEYS_REACH | KEYS_AVOID | KEYS_APART | KEYS_FIRST,
     .allowed = "allowed are any, all and whole numbers above 0"},
    {KEY_BIAS, "bias", KEYS_WEIGHT, NUMBERS(2), .any_order = true, .low = -45, .high = 45,
     .allowed = "two numbers X:Y are needed, degrees to the right and up, from -45 to 45"},
    {KEY_NASION, "nasion", KEYS_SCALP, POINT},
    {KEY_INION, "inion", KEYS_SCALP, POINT},
    {KEY_LPA, "lpa", KEYS_SCALP, POINT},
    {KEY_RPA, "rpa", KEYS_SCALP, POINT},
    {KEY_NAME, "landmarks", KEYS_SCALP, .allowed = "a file is needed"},

    {KEY_ABOVE, "above", KEYS_WEIGHT, .allowed = "a weight is needed, or P% or P%area"},
    {KEY_POWER, "power", KEYS_PRIOR, NUMBERS(1), .low = 0.01, .high = 100,
     .allowed = "allowed is a number from 0.01 to 100"},

    {KEY_SLIDER, "slider", KEYS_ARCS, NUMBERS(1), .high = 180, .is_above = true, .allowed = UP_TO_180},
    {KEY_SAME, "same", KEYS_ARCS, NUMBERS(1), .high = 180, .is_above = true, .allowed = UP_TO_180},
    {KEY_TILT_AP, "pitch", KEYS_ARCS, NUMBERS(1), .any_order = true, .low = -180, .high = 180,
     .allowed = "allowed is a number of degrees from -180 to 180"},
    {KEY_MOST, "most", KEYS_ARCS, IS_WHOLE, .least = 1, .most = 1, .low = 1, .high = 16, .allowed = ONE_TO_16},
    /* By the ids of tilts and a depth, which angles have not: a set of keys has 64 bits. */
    {KEY_TILT_AP, "arc", KEYS_ANGLES, NUMBERS(3), .any_order = true, .low = -360, .high = 360, .allowed = A_GRID},
    {KEY_TILT_ML, "slider", KEYS_ANGLES, NUMBERS(3), .any_order = true, .low = -360, .high = 360, .allowed = A_GRID},
    {KEY_DEPTH, "back", KEYS_ANGLES, NUMBERS(1), .high = 500, .is_above = true, .allowed = ABOVE_0 ", up to 500 mm"},
    {KEY_EACH, "each", KEYS_ARCS, IS_WHOLE, .least = 1, .most = 1, .low = 1, .high = 16, .allowed = ONE_TO_16},
};

_Static_assert(KEY_EACH < 64, "KEY_BIT() has a bit for each");

enum { ROWS = sizeof rows / sizeof rows[0], LISTED = 256 };

/* The key that `text`, behind a comma, is; NULL if it is none. */
static const struct source_key *find_row(const char *text, enum key_kind kind)
{
    for (const struct source_key *row = rows; row < rows + ROWS; row++) {
        const size_t length = strlen(row->name);
        if ((row->kinds & kind) && strncmp(text, row->name, length) == 0 &&
            (row->type == IS_FLAG ? text[length] == '\0' || text[length] == ',' : text[length] == '=')) {
            return row;
        }
    }
    return NULL;
}

/* Where the next key stands, at its comma, or the end of the text. */
static const char *next_key(const char *at, enum key_kind kind)
{
    while ((at = strchr(at, ',')) && !find_row(at + 1, kind)) {
        at++;
    }
    return at;
}

/* The text of the value of `row`, which ends at `end`, or with the text. */
static struct text value_of(const struct source_key *row, const char *at, const char *end)
{
    const size_t length = strlen(row->name) + (row->type != IS_FLAG);
    return (struct text){at + length, (end ? (size_t)(end - at) : strlen(at)) - length};
}

bool keys_is_image(const struct key_value *value)
{
    const struct source_key *row = value->row;
    return row->type == IS_TEXT && row->words ? value->text.size && !text_is_one_of(value->text, row->words, true)
                                              : row->allowed && strcmp(row->allowed, AN_IMAGE) == 0;
}

/* Where the key at `at` ends: at the comma before the next one, but not before one of the image that is its value. */
static const char *end_of_key(const char *at, enum key_kind kind)
{
    const struct source_key *row = find_row(at, kind);
    const char *end = next_key(at, kind);
    const struct key_value value = {.row = row, .text = value_of(row, at, end)};
    while (row->words && keys_is_image(&value) && end && (find_row(end + 1, kind)->kinds & KEYS_VOLUME)) {
        end = next_key(end + 1, kind);
    }
    return end;
}

static bool find_part(struct system_stat *out, const char *text, size_t length)
{
    char path[SYSTEM_PATH];
    if (!length || length >= sizeof path) {
        return false;
    }
    memcpy(path, text, length);
    path[length] = '\0';
    return system_stat(out, path);
}

static bool is_there(const char *text, size_t length, enum key_kind kind)
{
    struct system_stat info;
    return kind < KEYS_CLEARANCE && find_part(&info, text, length);
}

/* Behind the folders that are there: they may be called anything, and keys begin behind them. A value may have a '/',
 * too, which ends no such folder. */
static const char *behind_folders(const char *text)
{
    struct system_stat info;
    const char *begin = text;
    const char *slash = strchr(text, ',');
    slash = slash ? strchr(slash, '/') : NULL;
    while (slash && find_part(&info, text, (size_t)(slash - text)) && info.kind == SYSTEM_FOLDER) {
        begin = slash + 1;
        slash = strchr(begin, '/');
    }
    return begin;
}

/* Length of the file: the longest that is there, and *other the next one; else all before the first key. */
static size_t find_file(size_t *other, const char *text, enum key_kind kind)
{
    size_t found = 0;
    const char *first = next_key(behind_folders(text), kind);
    *other = 0;
    for (const char *at = first; at; at = next_key(at + 1, kind)) {
        const size_t length = (size_t)(at - text);
        if (is_there(text, length, kind)) {
            *other = found;
            found = length;
        }
    }
    if (first && is_there(text, strlen(text), kind)) {
        *other = found;
        found = strlen(text);
    }
    return found ? found : first ? (size_t)(first - text) : strlen(text);
}

/* Of one number; any minus is one. */
static bool read_number(struct text text, double *out)
{
    const size_t minus = text_minus(text);
    const bool is_odd = minus > 1; /* not of ASCII */
    const struct text rest = {text.data + (is_odd ? minus : 0), text.size - (is_odd ? minus : 0)};
    const bool is_fine = (!is_odd || (rest.size && strchr("0123456789.", rest.data[0]))) && text_to_double(rest, out);
    *out = is_fine && is_odd ? -*out : *out;
    return is_fine && isfinite(*out);
}

static bool read_numbers(struct key_value *value)
{
    const struct source_key *row = value->row;
    struct text rest = value->text;
    struct text part;
    bool is_fine = true;
    for (bool more = true; is_fine && text_field(&rest, ':', &more, &part);) {
        double number = 0;
        uint64_t whole = 0;
        if (row->type == IS_WHOLE) {
            is_fine = text_to_uint(part, (uint64_t)row->high, &whole);
            number = (double)whole;
        } else {
            is_fine = read_number(part, &number);
        }
        is_fine = is_fine && value->count < row->most && number >= row->low && number <= row->high &&
                  !(row->is_above && number == row->low);
        value->numbers[is_fine ? value->count++ : 0] = number;
    }
    return is_fine && (row->type == IS_WHOLE || value->count == row->least || value->count == row->most) &&
           (row->least < 2 || row->any_order || value->numbers[0] < value->numbers[1]);
}

static bool has_value(struct key_value *value)
{
    switch (value->row->type) {
    case IS_NUMBERS:
    case IS_WHOLE:
        return read_numbers(value);
    case IS_WORD:
        return text_is_one_of(text_trim(value->text), value->row->words, true);
    default:
        return value->row->type == IS_FLAG || value->text.size;
    }
}

static void list_keys(char out[LISTED], enum key_kind kind)
{
    size_t used = 0;
    for (const struct source_key *row = rows; row < rows + ROWS; row++) {
        if ((row->kinds & kind) && used < LISTED) {
            used += (size_t)snprintf(out + used, LISTED - used, "%s%s", used ? ", " : "", row->name);
        }
    }
}

#define FAIL(out, ...) (snprintf((out)->why, sizeof(out)->why, __VA_ARGS__), false)

/* The key of the kind that was perhaps meant; "" if none is near. */
static const char *find_near(struct text found, enum key_kind kind)
{
    const struct text word = {found.data, strcspn(found.data, "=,")};
    const char *near = "";
    size_t least = (word.size + 2) / 3 + 1;
    for (const struct source_key *row = rows; row < rows + ROWS; row++) {
        const size_t far = row->kinds & kind ? text_distance(word, text_from(row->name)) : SIZE_MAX;
        near = far < least ? row->name : near;
        least = far < least ? far : least;
    }
    return near;
}

/* What is no key, behind one or behind a file. */
static bool refuse_unknown(struct source_keys *out, struct text found, struct text before, enum key_kind kind)
{
    char all[LISTED];
    if (before.size && !memchr(found.data, '=', found.size)) {
        return FAIL(out, "\"%.*s,%.*s\" has a comma in it; a number has a decimal point, and a name no comma",
                    TEXT_SHOW(before, 80U), TEXT_SHOW(found, 80U));
    }
    const char *near = find_near(found, kind);
    if (*near && text_equal((struct text){found.data, strcspn(found.data, "=,")}, near)) {
        return FAIL(out, "%s: %s", near,
                    memchr(found.data, '=', found.size) ? "no value is allowed" : "a value is needed");
    }
    list_keys(all, kind);
    return FAIL(out, "found \"%.*s\", allowed are %s%s%s%s", TEXT_SHOW(found, 80U), all, *near ? "; did you mean " : "",
                near, *near ? "?" : "");
}

static bool read_key(struct source_keys *out, const char *at, const char *end, enum key_kind kind)
{
    const struct source_key *row = find_row(at, kind);
    struct key_value value = {.row = row, .id = row->id, .text = value_of(row, at, end)};
    const char *comma = row->goes_on ? NULL : memchr(at, ',', (size_t)(end - at));
    if (comma) {
        return refuse_unknown(out, (struct text){comma + 1, strcspn(comma + 1, ",")},
                              (struct text){at, (size_t)(comma - at)}, kind);
    }
    if ((out->given & KEY_BIT(row->id)) && !row->repeats) {
        return FAIL(out, "%s is given twice", row->name);
    }
    if (out->count == KEYS_MOST) {
        return FAIL(out, "%s: there are %d keys, the most that are allowed", row->name, KEYS_MOST);
    }
    if (!has_value(&value)) {
        return FAIL(out, "%s: found \"%.*s\", %s", row->name, TEXT_SHOW(value.text, 80U), row->allowed);
    }
    out->given |= KEY_BIT(row->id);
    out->values[out->count++] = value;
    return true;
}

/* Whether the word of so many letters is the name of a key, which lacks its value. */
static bool is_name(const char *word, size_t length, enum key_kind kind)
{
    bool is = false;
    for (const struct source_key *row = rows; row < rows + ROWS && !is; row++) {
        is = (row->kinds & kind) && strlen(row->name) == length && strncmp(row->name, word, length) == 0;
    }
    return is && (word[length] == '\0' || word[length] == ',');
}

/* What stands behind a file that is there, where the whole is not: a key with another name, or without a value. Behind
 * a folder, and behind what is written, it looks like a key. Where the file of so many letters is not there, one with a
 * known key in its name may be. */
static struct text find_unknown(const char *text, size_t length, enum key_kind kind)
{
    struct system_stat info;
    length = kind < KEYS_CLEARANCE && !is_there(text, length, kind) ? strlen(text) : length;
    for (const char *at = behind_folders(text); (at = memchr(at, ',', (size_t)(text + length - at))); at++) {
        const size_t word = strspn(at + 1, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-");
        const bool is_key = at[1 + word] == '=' || is_name(at + 1, word, kind);
        const bool is_unknown = kind >= KEYS_CLEARANCE ? is_key
                                                       : find_part(&info, text, (size_t)(at - text)) &&
                                                             (is_key || info.kind != SYSTEM_FOLDER);
        if (is_unknown && kind != KEYS_APART && !is_there(text, length, kind)) { /* poses have their own */
            return (struct text){at + 1, (size_t)(text + length - at) - 1};
        }
    }
    return (struct text){0};
}

size_t keys_file_length(const char *text, enum key_kind kind)
{
    size_t other;
    const size_t length = find_file(&other, text, kind);
    const struct text unknown = find_unknown(text, length, kind);
    return unknown.size ? (size_t)(unknown.data - text) - 1 : length;
}

static bool read_all(struct source_keys *out, const char *at, enum key_kind kind)
{
    bool is_fine = true;
    while (is_fine && at) {
        const char *next = end_of_key(at, kind);
        is_fine = read_key(out, at, next ? next : at + strlen(at), kind);
        at = next ? next + 1 : NULL;
    }
    return is_fine;
}

bool keys_read(struct source_keys *out, const char *text, enum key_kind kind)
{
    size_t other;
    *out = (struct source_keys){.length = find_file(&other, text, kind)};
    struct source_keys part = {0};
    if (other && read_all(&part, text + other + 1, kind)) {
        return FAIL(out, "\"%.*s\" is there, and so is \"%.*s\", of which it would be a part: rename one of them",
                    (int)out->length, text, (int)other, text);
    }
    if (!out->length && *text) {
        const bool is_structure = kind & (KEYS_REACH | KEYS_AVOID | KEYS_APART | KEYS_FIRST);
        return FAIL(out, "\"%.80s\" names no %s", text,
                    is_structure        ? "structure"
                    : kind == KEYS_ARCS ? "degrees"
                                        : "file");
    }
    const struct text unknown = find_unknown(text, out->length, kind);
    if (unknown.size) {
        return refuse_unknown(out, unknown, (struct text){0}, kind);
    }
    return !text[out->length] || read_all(out, text + out->length + 1, kind);
}

bool keys_read_alone(struct source_keys *out, const char *words, enum key_kind kind)
{
    *out = (struct source_keys){0};
    return find_row(words, kind) ? read_all(out, words, kind)
                                 : refuse_unknown(out, text_from(words), (struct text){0}, kind);
}

const struct key_value *keys_value(const struct source_keys *keys, enum source_key_id id)
{
    static const struct key_value none;
    size_t i = 0;
    while (i < keys->count && keys->values[i].id != id) {
        i++;
    }
    return i < keys->count ? &keys->values[i] : &none;
}

const char *keys_name(const struct key_value *value)
{
    return value->row->name;
}

const char *keys_allowed(const struct key_value *value)
{
    return value->row->allowed;
}

void keys_keep(char *out, const char *text, const struct source_keys *keys, unsigned kinds)
{
    size_t used = keys->length;
    memcpy(out, text, used);
    for (size_t i = 0; i < keys->count; i++) {
        const struct key_value *value = &keys->values[i];
        if (value->row->kinds & kinds) {
            const size_t ahead = strlen(value->row->name) + 1; /* "name=" */
            out[used++] = ',';
            memcpy(out + used, value->text.data - ahead, ahead + value->text.size);
            used += ahead + value->text.size;
        }
    }
    out[used] = '\0';
}

bool keys_fit(char why[KEYS_WHY], const struct source_keys *keys, uint64_t allowed)
{
    const struct source_key *first = NULL;
    for (size_t i = 0; i < keys->count; i++) {
        const struct source_key *row = keys->values[i].row;
        first = !(allowed & KEY_BIT(row->id)) && (!first || row->id < first->id) ? row : first;
    }
    if (first) {
        snprintf(why, KEYS_WHY, "%s %s", first->name, first->refusal ? first->refusal : "is not for this file");
    }
    return !first;
}

bool keys_cut(struct source_keys *out, char *text, enum key_kind kind)
{
    const bool is_fine = keys_read(out, text, kind);
    for (size_t i = 0; is_fine && i < out->count; i++) {
        const struct text value = out->values[i].text;
        text[(size_t)(value.data - text) + value.size] = '\0';
    }
    text[is_fine ? out->length : strlen(text)] = '\0';
    return is_fine;
}

const char *keys_string(const struct source_keys *keys, enum source_key_id id)
{
    const struct text text = keys_value(keys, id)->text;
    return text.size ? text.data : NULL;
}
