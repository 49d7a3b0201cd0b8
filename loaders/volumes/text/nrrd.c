/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks NRRD headers: a table of their keys, the axes (which are space, which one is the list of volumes,
 * and where they lie), and 3D Slicer's segments (Segment0_Name:=..., _LabelValue, _Layer, _Color). */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/order.h"
#include "loaders/volumes/text/text_volume.h"

#include <stdio.h>
#include <string.h>

enum { AXES = 4, SEGMENT_LIMIT = 1 << 12 };

enum segment_field { SEGMENT_NAME, SEGMENT_ID, SEGMENT_VALUE, SEGMENT_LAYER, SEGMENT_COLOUR, SEGMENT_FIELDS };

struct segment {
    struct text fields[SEGMENT_FIELDS];
};

/* The values of a header. */
struct nrrd {
    struct text_volume *out;
    int type, encoding; /* type: kind << 8 | bytes */
    int big_endian;     /* -1 = not said */
    int space;          /* RAS, LAS, LPS */
    struct text space_word, space_dimension;
    int64_t line_skip, byte_skip, dimension;
    struct header_list sizes;
    double directions[AXES][3];
    bool is_space[AXES]; /* it has a direction, not "none" */
    size_t list;         /* the axis of the volumes; AXES if there is none */
    double origin[3];
    double mm; /* of a unit */
    bool has_units;
    LIST(struct segment) segments;
};

/* "none" or "(x,y,z)", which `rest` begins with. */
static bool read_vector(double out[3], bool *none, struct text *rest)
{
    *rest = text_trim(*rest);
    *none = text_starts(*rest, "none");
    if (*none) {
        *rest = (struct text){rest->data + 4, rest->size - 4};
        return true;
    }
    const char *end = rest->size && rest->data[0] == '(' ? memchr(rest->data, ')', rest->size) : NULL;
    if (!end) {
        return false;
    }
    struct text inner = {rest->data + 1, (size_t)(end - rest->data) - 1};
    struct text field;
    bool more = true;
    int count = 0;
    while (text_field(&inner, ',', &more, &field)) {
        if (count == 3 || !text_to_double(text_trim(field), &out[count])) {
            return false;
        }
        count++;
    }
    *rest = (struct text){end + 1, rest->size - (size_t)(end + 1 - rest->data)};
    return count == 3;
}

static void check_dimension(struct job *job, void *header, struct text value)
{
    int64_t dimension = ((const struct nrrd *)header)->dimension;
    (void)value;
    if (dimension != 3 && dimension != AXES) {
        job_refuse(job, "dimension: found %lld, allowed are 3 and 4", (long long)dimension);
    }
}

static void nrrd_check_sizes(struct job *job, void *header, struct text value)
{
    const struct nrrd *nrrd = header;
    (void)value;
    if (nrrd->sizes.count != (size_t)nrrd->dimension) {
        job_bad(job, "sizes: found %zu numbers, the dimension is %lld", nrrd->sizes.count, (long long)nrrd->dimension);
    }
}

static void keep_space_word(struct job *job, void *header, struct text value)
{
    (void)job;
    ((struct nrrd *)header)->space_word = value;
}

static void read_directions(struct job *job, void *header, struct text value)
{
    struct nrrd *nrrd = header;
    struct text rest = value;
    size_t axes = (size_t)nrrd->dimension;
    size_t spaces = 0;
    nrrd->list = AXES;
    for (size_t i = 0; i < axes; i++) {
        bool none = false;
        if (!read_vector(nrrd->directions[i], &none, &rest)) {
            job_bad(job, "space directions: found \"%.*s\", for each axis (x,y,z) or none is needed",
                    HEADER_SHOW(value));
            return;
        }
        const double *v = nrrd->directions[i];
        none = none || (isnan(v[0]) && isnan(v[1]) && isnan(v[2])); /* as pynrrd once wrote it */
        nrrd->is_space[i] = !none;
        nrrd->list = none ? i : nrrd->list;
        spaces += !none;
    }
    if (text_trim(rest).size) {
        job_bad(job, "space directions: found more than the %zu axes have", axes);
    }
    bool middle = axes == AXES && nrrd->list != 0 && nrrd->list != AXES - 1;
    if (spaces != 3 || middle) {
        job_refuse(job,
                   "space directions: found \"%.*s\", needed are three directions, and none of the first or the last "
                   "axis where there are four",
                   HEADER_SHOW(value));
    }
}

/* Kinds of one number per voxel and volume; colours and matrices are read as no values. */
static void check_kinds(struct job *job, void *header, struct text value)
{
    static const struct header_word known[] = {
        {"domain/space/none/???", 1},
        {"list/time/vector/point/stub/scalar/2-vector/3-vector/4-vector/covariant-vector/normal/3-normal/3-gradient",
         0},
        {NULL, 0}};
    const struct nrrd *nrrd = header;
    size_t axes = (size_t)nrrd->dimension;
    struct text word;
    size_t count = 0;
    for (struct text rest = value; value.data && text_word(&rest, &word); count++) {
        int kind = header_word(known, word, false);
        if (kind < 0 || (kind == 0 && count < axes && nrrd->is_space[count])) {
            job_refuse(job,
                       "kinds: found \"%.*s\", allowed are domain and space of an axis with a direction, list, time "
                       "and vectors of another",
                       HEADER_SHOW(word));
        }
    }
    if (value.data && count != axes) {
        job_bad(job, "kinds: found %zu, the dimension is %zu", count, axes);
    }
}

/* Spacings beside directions say the same twice, or are nan. */
static void check_spacings(struct job *job, void *header, struct text value)
{
    const struct nrrd *nrrd = header;
    double spacings[AXES] = {0};
    size_t axes = value.data ? (size_t)nrrd->dimension : 0;
    if (value.data) {
        header_numbers(job, spacings, axes, value, "spacings");
    }
    for (size_t i = 0; job_ok(job) && i < axes; i++) {
        double length = vec3_length(nrrd->directions[i]);
        bool same = isnan(spacings[i]) || !nrrd->is_space[i] || fabs(spacings[i] - length) <= 1e-3 * length;
        if (!same) {
            job_bad(job, "spacings: found %g of axis %zu, whose space direction has length %g", spacings[i], i, length);
        }
    }
}

/* "mm" "mm" "mm": one unit. */
static void read_units(struct job *job, void *header, struct text value)
{
    struct nrrd *nrrd = header;
    nrrd->has_units = value.data;
    nrrd->mm = 1;
    for (int i = 0; value.data && i < 3 && job_ok(job); i++) {
        struct text unit;
        struct text before;
        bool more = true;
        bool found = text_field(&value, '"', &more, &before) && more && text_field(&value, '"', &more, &unit) && more;
        bool unknown = found && (!unit.size || text_equal(unit, "???"));
        double factor = unknown ? 1 : found ? header_unit(unit) : 0;
        if (factor == 0 || text_trim(before).size || (i && factor != nrrd->mm)) {
            job_refuse(job, "space units: needed are three times the same, of \"mm\", \"um\", \"cm\" and \"m\"");
        }
        nrrd->mm = factor;
    }
}

static void read_origin(struct job *job, void *header, struct text value)
{
    bool none = false;
    struct text rest = value;
    if (!read_vector(((struct nrrd *)header)->origin, &none, &rest) || none || text_trim(rest).size) {
        job_bad(job, "space origin: found \"%.*s\", a point (x,y,z) is needed", HEADER_SHOW(value));
    }
}

/* One file; lists and patterns of files are for slices. */
static void nrrd_read_file(struct job *job, void *header, struct text value)
{
    if (value.data) {
        ((struct nrrd *)header)->out->file = header_file(job, value, "data file", "allowed is one file", true);
    }
}

#define TYPE(kind, size) ((kind) << 8 | (size))
#define ALLOWED_TYPES "allowed are int8 to uint64, float and double"
#define ALLOWED_ENCODINGS "allowed are raw, gzip, text and hex"
#define ALLOWED_SPACES "allowed are RAS, LAS and LPS"

static const struct header_word types[] = {
    {"signed char/int8/int8_t", TYPE('i', 1)},
    {"uchar/unsigned char/uint8/uint8_t", TYPE('u', 1)},
    {"short/short int/signed short/signed short int/int16/int16_t", TYPE('i', 2)},
    {"ushort/unsigned short/unsigned short int/uint16/uint16_t", TYPE('u', 2)},
    {"int/signed int/int32/int32_t", TYPE('i', 4)},
    {"uint/unsigned int/uint32/uint32_t", TYPE('u', 4)},
    {"longlong/long long/long long int/signed long long/int64/int64_t/signed long long int", TYPE('i', 8)},
    {"ulonglong/unsigned long long/uint64/uint64_t/unsigned long long int", TYPE('u', 8)},
    {"float", TYPE('f', 4)},
    {"double", TYPE('f', 8)},
    {NULL, 0}};
static const struct header_word encodings[] = {
    {"raw", TEXT_RAW}, {"gzip/gz", TEXT_GZIP}, {"text/txt/ascii", TEXT_NUMBERS}, {"hex", TEXT_HEX}, {NULL, 0}};
static const struct header_word endians[] = {{"little", 0}, {"big", 1}, {NULL, 0}};
static const struct header_word spaces[] = {{"RAS/right-anterior-superior", 0},
                                            {"LAS/left-anterior-superior", 1},
                                            {"LPS/left-posterior-superior", 2},
                                            {NULL, 0}};

/* In the order in which they are read: a check may look at what stands above it. */
#define AT(member) .place = offsetof(struct nrrd, member)
static const struct header_row rows[] = {
    {"type", HEADER_WORD, AT(type), ALLOWED_TYPES, types, ALLOWED_TYPES},
    {"encoding", HEADER_WORD, AT(encoding), ALLOWED_ENCODINGS, encodings, ALLOWED_ENCODINGS, CONUS_ERROR_UNSUPPORTED},
    {"endian", HEADER_WORD, AT(big_endian), NULL, endians, "allowed are little and big"},
    {"line skip/lineskip", HEADER_INTEGER, AT(line_skip)},
    {"byte skip/byteskip", HEADER_INTEGER, AT(byte_skip), .least = -1},
    {"dimension", HEADER_INTEGER, AT(dimension), "allowed are 3 and 4", .least = 1, .check = check_dimension},
    {"sizes", HEADER_INTEGERS, AT(sizes), "a number of each axis is needed", .least = 1, .check = nrrd_check_sizes},
    {"space", HEADER_WORD, AT(space), "so it is not known which side is left; " ALLOWED_SPACES, spaces, ALLOWED_SPACES,
     CONUS_ERROR_UNSUPPORTED, .check = keep_space_word},
    {"space dimension", HEADER_TEXT, AT(space_dimension)},
    {"space directions", HEADER_UNUSED, .missing = "a direction of each axis, or none, is needed",
     .check = read_directions},
    {"kinds", HEADER_UNUSED, .check = check_kinds},
    {"spacings", HEADER_UNUSED, .check = check_spacings},
    {"space units", HEADER_UNUSED, .check = read_units},
    {"space origin", HEADER_UNUSED, .missing = "a point (x,y,z) is needed", .check = read_origin},
    {"data file/datafile", HEADER_UNUSED, .check = nrrd_read_file},
    {"measurement frame", .kind = HEADER_UNUSED}, /* which turns vectors, not places */
    {"block size/blocksize", .kind = HEADER_UNUSED},
    {"thicknesses", .kind = HEADER_UNUSED},
    {"axis mins/axismins", .kind = HEADER_UNUSED},
    {"axis maxs/axismaxs", .kind = HEADER_UNUSED},
    {"centers/centerings", .kind = HEADER_UNUSED},
    {"labels", .kind = HEADER_UNUSED},
    {"units", .kind = HEADER_UNUSED},
    {"min", .kind = HEADER_UNUSED},
    {"max", .kind = HEADER_UNUSED},
    {"old min/oldmin", .kind = HEADER_UNUSED},
    {"old max/oldmax", .kind = HEADER_UNUSED},
    {"content", .kind = HEADER_UNUSED},
    {"number", .kind = HEADER_UNUSED},
    {"sample units/sampleunits", .kind = HEADER_UNUSED},
};
static const struct header_table table = {rows, sizeof rows / sizeof rows[0], .exact = false};

static void nrrd_place(struct text_volume *out, const struct nrrd *nrrd)
{
    const double signs[3] = {nrrd->space > 0 ? -1 : 1, nrrd->space > 1 ? -1 : 1, 1}; /* of x and y that lead to RAS */
    size_t axis = nrrd->list == 0;
    mat4_identity(out->world_from_voxel);
    for (size_t column = 0; column < 4; column++, axis++) {
        for (size_t row = 0; row < 3; row++) {
            out->world_from_voxel[4 * column + row] =
                (column < 3 ? nrrd->directions[axis][row] : nrrd->origin[row]) * signs[row] * nrrd->mm;
        }
    }
    snprintf(out->transform, sizeof out->transform, "space directions, %.*s", HEADER_SHOW(nrrd->space_word));
    out->has_unit = nrrd->has_units;
}

/* "\n" and "\\" stand for what no line can hold. */
static char *unescape_name(struct job *job, struct text value)
{
    char *plain = job_copy(job, value);
    size_t size = 0;
    for (size_t i = 0; job_ok(job) && i < value.size; i++) {
        char next = i + 1 < value.size && value.data[i] == '\\' ? value.data[i + 1] : '\0';
        i += next == 'n' || next == '\\';
        plain[size++] = next == 'n' ? ' ' : value.data[i];
    }
    return job_name(job, (struct text){plain, size});
}

/* Reads one segment. `legacy`: it is label 1 in a volume of its own. */
static void take_segment(struct job *job, struct text_segment *out, const struct text fields[SEGMENT_FIELDS],
                         size_t number, int64_t volumes, bool legacy)
{
    char name[40];
    int64_t value = 1;
    int64_t layer = legacy ? (int64_t)number : 0;
    double rgb[3] = {0};
    snprintf(name, sizeof name, "Segment%zu_LabelValue", number);
    if (!legacy) {
        header_need(job, fields[SEGMENT_VALUE], name, "a label is needed");
        value = header_integer(job, fields[SEGMENT_VALUE], 1, name);
    }
    if (value > UINT32_MAX) {
        job_bad(job, "%s: found %lld, allowed are 1 to 4294967295", name, (long long)value);
    }
    snprintf(name, sizeof name, "Segment%zu_Layer", number);
    if (fields[SEGMENT_LAYER].data) {
        layer = header_integer(job, fields[SEGMENT_LAYER], 0, name);
    } else if (!legacy && volumes != 1) {
        header_need(job, fields[SEGMENT_LAYER], name, "a layer is needed");
    }
    if (layer >= volumes) {
        job_bad(job, "%s: found %lld, allowed are 0 to %lld", name, (long long)layer, (long long)volumes - 1);
    }
    out->label.name = unescape_name(job, fields[SEGMENT_NAME].size ? fields[SEGMENT_NAME] : fields[SEGMENT_ID]);
    snprintf(name, sizeof name, "Segment%zu_Color", number);
    out->label.has_rgb = fields[SEGMENT_COLOUR].data;
    if (out->label.has_rgb) {
        header_numbers(job, rgb, 3, fields[SEGMENT_COLOUR], name);
    }
    for (int i = 0; job_ok(job) && i < 3; i++) {
        if (!(rgb[i] >= 0 && rgb[i] <= 1)) {
            job_bad(job, "%s: found %g, allowed are 0 to 1", name, rgb[i]);
            return;
        }
        out->label.rgb[i] = (uint8_t)(rgb[i] * 255 + 0.5);
    }
    out->label.number = (uint32_t)value;
    out->volume = (size_t)layer;
}

static int compare_segments(const void *a, const void *b)
{
    const struct text_segment *left = a;
    const struct text_segment *right = b;
    int order = (left->volume > right->volume) - (left->volume < right->volume);
    return order ? order : (left->label.number > right->label.number) - (left->label.number < right->label.number);
}

static bool has_field(const struct segment *segment)
{
    bool has = false;
    for (int k = 0; k < SEGMENT_FIELDS; k++) {
        has = has || segment->fields[k].data;
    }
    return has;
}

/* Turns the segments into out->segments; out->count is known. Segments that contradict each other or the volumes are
 * errors: names would be wrong. */
static void take_segments(struct job *job, struct text_volume *out, const struct nrrd *nrrd)
{
    size_t count = nrrd->segments.count;
    bool legacy = (int64_t)count == out->count; /* a volume of each, as before Slicer had layers */
    for (size_t i = 0; i < count; i++) {
        const struct text *fields = nrrd->segments.at[i].fields;
        legacy = legacy && !fields[SEGMENT_VALUE].data && !fields[SEGMENT_LAYER].data;
    }
    out->segments = job_zeroed(job, count, sizeof *out->segments);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        if (has_field(&nrrd->segments.at[i])) {
            take_segment(job, &out->segments[out->segment_count++], nrrd->segments.at[i].fields, i, out->count, legacy);
        }
    }
    if (!job_ok(job)) {
        return;
    }
    order_sort(out->segments, out->segment_count, sizeof *out->segments, compare_segments);
    for (size_t i = 1; i < out->segment_count; i++) {
        const struct text_segment *segment = &out->segments[i];
        const char *before = segment[-1].label.name;
        if (compare_segments(segment - 1, segment) == 0) {
            job_bad(job, "segments: label %u of layer %zu is both \"%s\" and \"%s\"", segment->label.number,
                    segment->volume, before ? before : "", segment->label.name ? segment->label.name : "");
        }
    }
}

/* Keeps a line "key:=value" if it is one of a segment, as "Segment12_Name" is. */
static void keep_segment(struct job *job, struct nrrd *nrrd, struct text key, struct text value)
{
    static const struct header_word known[] = {{"Name", SEGMENT_NAME},        {"ID", SEGMENT_ID},
                                               {"LabelValue", SEGMENT_VALUE}, {"Layer", SEGMENT_LAYER},
                                               {"Color", SEGMENT_COLOUR},     {NULL, 0}};
    static const char prefix[] = "Segment";
    size_t start = sizeof prefix - 1;
    const char *line = text_starts(key, prefix) ? memchr(key.data, '_', key.size) : NULL;
    size_t end = line ? (size_t)(line - key.data) : 0;
    uint64_t number;
    if (end <= start || !text_to_uint((struct text){key.data + start, end - start}, UINT32_MAX, &number)) {
        return;
    }
    if (number >= SEGMENT_LIMIT) {
        job_bad(job, "%.*s: allowed are segments 0 to %d", HEADER_SHOW(key), SEGMENT_LIMIT - 1);
    }
    int field = header_word(known, (struct text){line + 1, key.size - end - 1}, false);
    while (job_ok(job) && field >= 0 && nrrd->segments.count <= number) {
        (void)LIST_ADD(job, &nrrd->segments);
    }
    if (job_ok(job) && field >= 0) {
        header_once(job, &nrrd->segments.at[number].fields[field], value, key);
    }
}

/* "field: value" or "key:=value". */
static void nrrd_read_line(struct job *job, struct header_values *values, struct nrrd *nrrd, struct text line)
{
    const char *colon = memchr(line.data, ':', line.size);
    size_t length = colon ? (size_t)(colon - line.data) : 0;
    bool spaced = colon && line.size >= length + 2;
    struct text name = {line.data, length};
    struct text value = spaced ? (struct text){colon + 2, line.size - length - 2} : line;
    if (spaced && colon[1] == '=') {
        keep_segment(job, nrrd, name, value);
    } else if (!spaced || colon[1] != ' ') {
        job_bad(job, "header: found the line \"%.*s\", allowed are \"field: value\", \"key:=value\"",
                HEADER_SHOW(line));
    } else if (!header_keep(job, values, &table, name, text_trim(value))) {
        job_bad(job, "header: found the field \"%.*s\", which NRRD does not have", HEADER_SHOW(name));
    }
}

/* Up to the empty line, or to the end where the voxels lie in another file. */
static void nrrd_read_lines(struct reader *r, struct header_values *values, struct nrrd *nrrd)
{
    struct job *job = r->job;
    struct text line = {0};
    size_t lines = 0;
    bool ended = false;
    bool known = header_line(r, &line, &lines) && line.size == 8 && line.data[6] == '0' && line.data[7] >= '1' &&
                 line.data[7] <= '5';
    if (!known) {
        job_bad(job, "magic: found \"%.*s\", allowed are NRRD0001 to NRRD0005", HEADER_SHOW(line));
    }
    while (!ended && header_line(r, &line, &lines)) {
        ended = line.size == 0;
        if (!ended && line.data[0] != '#') {
            nrrd_read_line(job, values, nrrd, line);
        }
    }
    if (!ended && !header_has(values, &table, "data file")) {
        job_bad(job, "header: found no empty line at its end, and no \"data file\"");
    }
}

static void check_nrrd(struct job *job, const struct nrrd *nrrd)
{
    if (nrrd->big_endian < 0 && (nrrd->type & 0xff) > 1 && nrrd->encoding != TEXT_NUMBERS) {
        job_bad(job, "endian: missing, allowed are little and big");
    }
    if (nrrd->byte_skip < 0 && nrrd->encoding != TEXT_RAW) {
        job_bad(job, "byte skip: found -1, which only the encoding raw allows");
    }
    if (nrrd->space_dimension.data) {
        job_bad(job, "space dimension: found beside \"space\", allowed is one of them");
    }
}

void nrrd_parse(struct job *job, struct text_volume *out, struct reader r)
{
    struct header_values values = {0};
    struct nrrd nrrd = {.out = out, .big_endian = -1};
    *out = (struct text_volume){.format = "NRRD"};
    nrrd_read_lines(&r, &values, &nrrd);
    header_take(job, &nrrd, &table, &values);
    check_nrrd(job, &nrrd);
    if (!job_ok(job)) {
        return;
    }
    size_t first = nrrd.list == 0;
    out->header_size = reader_at(&r);
    out->type = (struct text_type){(char)(nrrd.type >> 8), (size_t)nrrd.type & 0xff};
    out->encoding = (enum text_encoding)nrrd.encoding;
    out->big_endian = nrrd.big_endian > 0;
    out->line_skip = (uint64_t)nrrd.line_skip;
    out->at_end = nrrd.byte_skip < 0;
    out->byte_skip = out->at_end ? 0 : (uint64_t)nrrd.byte_skip;
    memcpy(out->dim, nrrd.sizes.values + first, sizeof out->dim);
    out->count = nrrd.list < AXES ? nrrd.sizes.values[nrrd.list] : 1;
    out->interleaved = first && out->count > 1;
    nrrd_place(out, &nrrd);
    take_segments(job, out, &nrrd);
}
