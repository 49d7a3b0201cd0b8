/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the electrodes of NWB (Neurodata Without Borders): points to posterior, inferior and right, of no unit. */
#include "poses/programs/pose_programs.h"

#include "base/child/hdf5.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TABLE "/general/extracellular_ephys/electrodes"
#define PLACES "/general/localization"

enum { AXES = 3 };

/* Positions of a brain: all of a file nearer to the origin than this are in mm, others in micrometres. */
static const double farthest_mm = 20;

/* Where positions come from: the table of electrodes, or one of ndx-anatomical-localization, which names electrodes. */
struct table {
    size_t count;
    const struct hdf5_value *columns[AXES]; /* x, y, z */
    const struct hdf5_value *rows;          /* of the electrodes in their table; NULL = each its own */
    const struct hdf5_value *ids;           /* of electrodes */
    const struct hdf5_value *groups;        /* their names; NULL = there are none */
    size_t from[AXES];                      /* which column leads to posterior, inferior, right, */
    double sign[AXES];                      /* or -1: the other way */
    double um;                              /* micrometres of the file's unit; 0 = it states none */
    bool from_bregma;                       /* else from the corner of the CCF */
};

static const struct text in_table = {TABLE, sizeof TABLE - 1};

#define ANY_COUNT SIZE_MAX

/* A column of a table, with @p count rows unless that is ANY_COUNT; NULL where it is not there. */
static const struct hdf5_value *find_column(struct job *job, const struct hdf5 *hdf5, struct text table,
                                            const char *name, bool is_text, size_t count)
{
    const struct hdf5_object *object = hdf5_find_in(hdf5, table, name);
    const struct hdf5_value *value = object ? &object->value : NULL;
    bool fine = !value || (value->rank == 1 && (is_text ? value->class == HDF5_STRING : hdf5_is_number(value)) &&
                           (count == ANY_COUNT || value->count == count));
    if (!fine) {
        job_bad(job, "%.*s/%s: %s for each electrode is needed", TEXT_SHOW(table, 200U), name,
                is_text ? "a text" : "a number");
    }
    return value;
}

static struct text get_text(const struct hdf5_object *object, const char *name)
{
    return hdf5_text(object ? hdf5_attribute(object, name) : NULL);
}

static void find_places(struct job *job, struct table *out, const struct hdf5 *hdf5, struct text group)
{
    static const char *const names[AXES] = {"x", "y", "z"};
    for (size_t i = 0; job_ok(job) && i < AXES; i++) {
        out->columns[i] = find_column(job, hdf5, group, names[i], false, i ? out->count : ANY_COUNT);
        out->count = out->columns[0] ? out->columns[0]->count : 0;
        out->from[i] = i;
        out->sign[i] = 1;
        if (!out->columns[i]) {
            job_bad(job, "HDF5, but neither of MATLAB nor electrodes of NWB with positions: no %.*s/%s",
                    TEXT_SHOW(group, 200U), names[i]);
        }
    }
}

/* Which way the columns lead: "PIR" and the like, positive directions. */
static bool take_orientation(struct table *out, struct text letters)
{
    static const char ways[] = "PIRASL"; /* those of the CCF, and the opposite ones */
    unsigned seen = 0;
    for (size_t i = 0; letters.size == AXES && i < AXES; i++) {
        const char *way = letters.data[i] ? strchr(ways, letters.data[i]) : NULL;
        size_t axis = way ? (size_t)(way - ways) % AXES : 0;
        seen |= way ? 1U << axis : 0;
        out->from[axis] = i;
        out->sign[axis] = way && way >= ways + AXES ? -1 : 1;
    }
    return seen == 7;
}

static void take_space(struct job *job, struct table *out, const struct hdf5_object *space)
{
    struct text origin = get_text(space, "origin");
    struct text units = get_text(space, "units");
    struct text ways = get_text(space, "orientation");
    out->from_bregma = text_contains(origin, text_from("bregma"));
    out->um = text_equal(units, "um") ? 1 : text_equal(units, "mm") ? 1000 : 0;
    /* The CCF counts from one corner only, whatever the words for it. */
    bool is_ccf = text_contains(get_text(space, "space_name"), text_from("ccf")) &&
                  text_contains(origin, text_from("corner")) && text_equal(ways, "PIR");
    if (!take_orientation(out, ways) || !(out->um > 0) || !(out->from_bregma || is_ccf)) {
        job_bad(job,
                PLACES ": found origin \"%.*s\", units \"%.*s\", orientation \"%.*s\"; allowed are bregma and the "
                       "PIR corner of the CCF, um and mm",
                TEXT_SHOW(origin, 60U), TEXT_SHOW(units, 20U), TEXT_SHOW(ways, 20U));
    }
}

/* The one table of ndx-anatomical-localization that is of electrodes; NULL without one. */
static const struct hdf5_object *find_localization(struct job *job, const struct hdf5 *hdf5)
{
    const struct hdf5_object *electrodes = hdf5_find(hdf5, TABLE);
    const struct hdf5_object *object;
    const struct hdf5_object *found = NULL;
    size_t at = 0;
    while ((object = hdf5_next_in(hdf5, &at, text_from(PLACES)))) {
        const struct hdf5_object *entity = hdf5_find_in(hdf5, object->value.name, "localized_entity");
        const struct hdf5_value *table = entity ? hdf5_attribute(entity, "table") : NULL;
        bool is_ours = electrodes && table && table->class == HDF5_REFERENCE && table->count == 1 &&
                       (uint64_t)hdf5_whole(table, 0) == electrodes->address;
        if (is_ours && found) {
            job_bad(job, PLACES ": found more than one table of electrodes, allowed is one");
        }
        found = is_ours ? object : found;
    }
    return found;
}

static void find_table(struct job *job, struct table *out, const struct hdf5 *hdf5, bool from_bregma)
{
    const struct hdf5_object *places = find_localization(job, hdf5);
    struct text group = places ? places->value.name : in_table;
    find_places(job, out, hdf5, group);
    out->from_bregma = from_bregma;
    if (job_ok(job) && places) {
        take_space(job, out, hdf5_find_in(hdf5, group, "space"));
        out->rows = find_column(job, hdf5, group, "localized_entity", false, out->count);
    }
    out->ids = find_column(job, hdf5, in_table, "id", false, places ? ANY_COUNT : out->count);
    if (!out->ids || out->ids->class == HDF5_FLOAT) {
        job_bad(job, TABLE "/id: a whole number for each electrode is needed");
    }
    out->groups = find_column(job, hdf5, in_table, "group_name", true, out->ids ? out->ids->count : 0);
    for (size_t i = 0; job_ok(job) && out->rows && i < out->count; i++) {
        double row = hdf5_number(out->rows, i);
        if (!(row >= 0 && row < (double)out->ids->count) || out->rows->class == HDF5_FLOAT) {
            job_bad(job, "%.*s/localized_entity: found %g, allowed are the %zu rows of " TABLE, TEXT_SHOW(group, 200U),
                    row, out->ids->count);
        }
    }
}

/* To posterior, inferior and right, in the file's unit. False where a number is missing. */
static bool get_point(double out[AXES], const struct table *table, size_t index)
{
    bool fine = true;
    for (size_t i = 0; i < AXES; i++) {
        out[i] = table->sign[i] * hdf5_number(table->columns[table->from[i]], index);
        fine = fine && isfinite(out[i]);
    }
    return fine;
}

/* Finds the unit, and what shows that the positions are not those in the brain. */
static void judge(struct job *job, struct table *table)
{
    size_t far = 0;  /* as no place in a mouse is in mm, */
    size_t near = 0; /* or nearer; but 0 and -1 mean that a place is not known */
    double first[AXES] = {0};
    size_t known = 0;
    bool twice = true; /* z repeats y */
    bool flat = true;  /* one z, and y in steps of 20, as sites lie on a probe */
    for (size_t i = 0; i < table->count; i++) {
        double p[AXES];
        if (get_point(p, table, i)) {
            first[2] = known++ ? first[2] : p[2];
            double most = fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2])));
            far += most > farthest_mm;
            near += most > 1 && most <= farthest_mm;
            twice = twice && p[1] == p[2];
            flat = flat && p[2] == first[2] && fmod(p[1], 20) == 0;
        }
    }
    if (known && twice) {
        job_bad(job, "columns y and z are equal in every row, as AllenSDK wrote them: left and right are missing");
    }
    if (known > 1 && flat) {
        job_warn(job, "all positions have one z, and y in steps of 20: are they on the probe, not in the brain?");
    }
    if (table->um > 0 && table->rows) {
        job_note(job, "positions are those of " PLACES ", from %s",
                 table->from_bregma ? "bregma" : "the corner of the CCF");
    } else if (!(table->um > 0)) {
        table->um = far > near ? 1 : 1000; /* no single electrode decides for all */
        job_note(job, "NWB states no unit: positions are taken as %s, to posterior, inferior and right",
                 table->um == 1 ? "micrometres" : "mm");
    }
}

static void add_electrode(const struct pose_reading *to, const struct table *table, size_t index)
{
    char name[POSE_ID_LIMIT + 2]; /* a byte more than allowed, to notice longer names */
    double p[AXES];
    double world[AXES] = {0};
    size_t electrode = table->rows ? (size_t)hdf5_whole(table->rows, index) : index;
    struct text group = table->groups ? hdf5_string(table->groups, electrode) : text_from("");
    int size = snprintf(name, sizeof name, "%.*s%s%lld", TEXT_SHOW(group, sizeof name), group.size ? "-" : "",
                        (long long)hdf5_whole(table->ids, electrode));
    struct text id = {name, (size_t)size < sizeof name ? (size_t)size : sizeof name - 1};
    const conus_frame *frame = to->options->frame;
    bool is_known = get_point(p, table, index);
    for (size_t i = 0; i < AXES && is_known; i++) {
        p[i] = p[i] * table->um + (table->from_bregma ? frame->bregma[i] : 0);
    }
    const char *bad = !is_known ? "x, y, z: not known" : pose_point_of_ccf(world, p, frame) ? conus_message() : NULL;
    pose_add_point(to, to->list->count + 1, world, false, id, bad);
}

void pose_nwb_from_hdf5(const struct pose_reading *to, const struct hdf5 *hdf5)
{
    struct table table = {0};
    find_table(to->job, &table, hdf5, to->options->frame->space == CONUS_SPACE_BREGMA);
    if (job_ok(to->job)) {
        judge(to->job, &table);
    }
    for (size_t i = 0; job_ok(to->job) && i < table.count; i++) {
        add_electrode(to, &table, i);
    }
}

/* The electrodes of NWB, in HDF5: points, in a frame in CCF or from bregma. text is no longer than pose_memory().
 */
void pose_nwb_parse(struct pose_reading *to, struct text text)
{
    static const char *const wanted[] = {TABLE,
                                         TABLE "/id",
                                         TABLE "/group_name",
                                         TABLE "/x",
                                         TABLE "/y",
                                         TABLE "/z",
                                         PLACES "/*",
                                         PLACES "/*/x",
                                         PLACES "/*/y",
                                         PLACES "/*/z",
                                         PLACES "/*/localized_entity",
                                         PLACES "/*/space"};
    const uint64_t left = pose_memory(to->options) - text.size;
    pose_refuse_axis(to, "electrodes");
    const struct hdf5 *hdf5 = hdf5_of_bytes(to->job, text, wanted, sizeof wanted / sizeof wanted[0], left ? left : 1);
    if (hdf5_find(hdf5, TABLE) && to->options->space < CONUS_SPACE_CCF) {
        job_bad(to->job, "electrodes of NWB lie in the CCF or count from bregma: space ccf or bregma is needed");
    }
    pose_nwb_from_hdf5(to, hdf5);
}
