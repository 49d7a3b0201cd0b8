/* SPDX-License-Identifier: BSD-3-Clause */
/* Electrodes of NWB as conus-hdf5 gives them; their positions follow from the frames below by hand. */
#include "poses/programs/pose_programs.h"

#include "base/memory.h"
#include "builders/hdf5_builder.h"
#include "pose_checks.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TABLE "/general/extracellular_ephys/electrodes/"

/* World x = ML, y = -AP, z = -DV, in mm from the corner of the CCF; and the same from bregma. */
static const conus_frame ccf = {.space = CONUS_SPACE_CCF,
                                .world_from_space = {0, -1e-3, 0, 0, 0, 0, -1e-3, 0, 1e-3, 0, 0, 0, 0, 0, 0, 1},
                                .bregma = {5400, 332, 5739}};
static const conus_frame bregma = {.space = CONUS_SPACE_BREGMA,
                                   .world_from_space = {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 5.739, -5.4, -0.332, 1},
                                   .bregma = {5400, 332, 5739}};

struct columns {
    double x[4], y[4], z[4];
    size_t count, z_count; /* 0 = as many as count */
    const char *missing;   /* a column */
    bool is_text;          /* x is */
    bool is_empty;         /* x is */
    int tables; /* of ndx-anatomical-localization, in which rows 2 and 0 have the places (1, 2, 3), (4, 5, 6) */
    const char *origin, *units, *ways;
    double row; /* instead of 2 */
};

static const struct columns plain = {
    {5000, 5100, 5200, 5300}, {1000, 2000, NAN, 3000}, {6000, 7000, 8000, 9000}, 4, .missing = NULL};

static void put(struct hdf5_builder *builder, const struct columns *columns, const char *name, const double *values,
                size_t count)
{
    if (!columns->missing || strcmp(columns->missing, name) != 0) {
        char path[100];
        snprintf(path, sizeof path, TABLE "%s", name);
        hdf5_doubles(builder, HDF5_FRAME_OBJECT, path, values, count);
    }
}

static void put_reference(struct hdf5_builder *builder, const char *name, uint64_t address)
{
    hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_ATTRIBUTE,
                                             .class = HDF5_REFERENCE,
                                             .size = 8,
                                             .name = name,
                                             .data = &address,
                                             .data_size = 8});
}

enum { ELECTRODES = 30 }; /* the address of their table */

/* Adds tables with a Space, and one that is of another type. */
static void put_localization(struct hdf5_builder *builder, const struct columns *columns)
{
    static const double places[3][2] = {{1, 4}, {2, 5}, {3, 6}};
    static const char *const name = "AllenCCFv3";
    for (int i = -1; i < columns->tables; i++) {
        char path[64];
        const int32_t rows[] = {columns->row != 0 ? (int32_t)columns->row : 2, 0};
        snprintf(path, sizeof path, "/general/localization/%d", i + 1);
        hdf5_group(builder, path);
        for (int a = 0; a < 3; a++) {
            snprintf(path, sizeof path, "/general/localization/%d/%c", i + 1, "xyz"[a]);
            hdf5_doubles(builder, HDF5_FRAME_OBJECT, path, places[a], 2);
        }
        snprintf(path, sizeof path, "/general/localization/%d/localized_entity", i + 1);
        hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_OBJECT,
                                                 .class = HDF5_SIGNED,
                                                 .size = 4,
                                                 .rank = 1,
                                                 .dims = {2},
                                                 .address = 60,
                                                 .name = path,
                                                 .data = rows,
                                                 .data_size = 8});
        put_reference(builder, "table", i < 0 ? 77 : ELECTRODES);
        snprintf(path, sizeof path, "/general/localization/%d/space", i + 1);
        hdf5_group(builder, path);
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "space_name", &name, 1);
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "origin", &columns->origin, 1);
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "units", &columns->units, 1);
        hdf5_strings(builder, HDF5_FRAME_ATTRIBUTE, "orientation", &columns->ways, 1);
    }
}

static void build(struct hdf5_builder *builder, const struct columns *columns)
{
    static const char *const groups[] = {"probe0", "probe0", "probe1", ""};
    static const uint64_t ids[] = {7, 8, 9, 10};
    size_t n = columns->count;
    hdf5_begin(builder);
    hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_OBJECT,
                                             .class = HDF5_GROUP,
                                             .address = ELECTRODES,
                                             .name = "/general/extracellular_ephys/electrodes"});
    if (columns->is_text) {
        hdf5_strings(builder, HDF5_FRAME_OBJECT, TABLE "x", groups, n);
    } else {
        put(builder, columns, "x", columns->x, columns->is_empty ? 0 : n);
    }
    put(builder, columns, "y", columns->y, n);
    put(builder, columns, "z", columns->z, columns->z_count ? columns->z_count : n);
    if (!columns->missing || strcmp(columns->missing, "id") != 0) {
        hdf5_frame(builder, (struct built_value){.kind = HDF5_FRAME_OBJECT,
                                                 .class = HDF5_SIGNED,
                                                 .size = 8,
                                                 .rank = 1,
                                                 .dims = {n},
                                                 .address = 50,
                                                 .name = TABLE "id",
                                                 .data = ids,
                                                 .data_size = 8 * n});
    }
    if (!columns->missing || strcmp(columns->missing, "group_name") != 0) {
        hdf5_strings(builder, HDF5_FRAME_OBJECT, TABLE "group_name", groups, n);
    }
    if (columns->tables) {
        put_localization(builder, columns);
    }
    hdf5_end(builder);
}

static conus_status parse_built(conus_pose_list *list, const struct hdf5_builder *builder, const conus_frame *frame)
{
    const conus_pose_options options = {.frame = frame, .space = frame->space};
    struct job job = {0};
    const struct text stream = {job_adopt(&job, memory_copy(builder->bytes.data, builder->bytes.size, 1)),
                                builder->bytes.size};
    if (job_need(&job, stream.data)) {
        pose_nwb_from_hdf5(&(struct pose_reading){.job = &job, .list = list, .options = &options},
                           hdf5_of_stream(&job, stream));
    }
    return job_close(&job, &list->notes, NULL);
}

static void parse(conus_pose_list *list, const struct columns *columns, const conus_frame *frame)
{
    struct hdf5_builder builder;
    build(&builder, columns);
    assert_ok(parse_built(list, &builder, frame));
    buffer_finish(&builder.bytes);
}

static void micrometres_in_ccf(void **state)
{
    (void)state;
    conus_pose_list list = {0};
    parse(&list, &plain, &ccf);
    assert_int_equal(list.count, 4);
    assert_row_at(pose_row_of(&list, 0, "probe0-7"), 6, -5, -1);
    assert_row_at(pose_row_of(&list, 1, "probe0-8"), 7, -5.1, -2);
    assert_row_fails(&list, 2, "probe1-9", "x, y, z: not known");
    assert_row_at(pose_row_of(&list, 3, "10"), 9, -5.3, -3);
    assert_true(list.rows[0].is_point);
    assert_true(pose_has_note(&list, "taken as micrometres"));
    pose_list_finish(&list);
}

/* Two mm behind bregma, one below it and three to the right; once in mm, once in micrometres. */
static void from_bregma_in_either_unit(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        const double unit = i ? 1000 : 1;
        const struct columns columns = {{2 * unit}, {1 * unit}, {3 * unit}, 1, .missing = "group_name"};
        conus_pose_list list = {0};
        parse(&list, &columns, &bregma);
        assert_row_at(pose_row_of(&list, 0, "7"), 8.739, -7.4, -1.332);
        assert_true(pose_has_note(&list, i ? "taken as micrometres" : "taken as mm"));
        assert_false(pose_has_note(&list, "localization"));
        pose_list_finish(&list);
    }
}

/* One place that is off, or places that are not known, do not decide for the others. */
static void most_electrodes_tell_the_unit(void **state)
{
    (void)state;
    static const struct columns cases[] = {
        {{2, 3, 5000}, {1, 1, 1}, {3, 4, 5}, 3, .missing = "group_name"},
        {{0, 2000, -1, 0}, {0, 1000, -1, 0}, {0, 3000, -1, 0}, 4, .missing = "group_name"}};
    for (int i = 0; i < 2; i++) {
        conus_pose_list list = {0};
        parse(&list, &cases[i], &bregma);
        assert_true(pose_has_note(&list, i ? "taken as micrometres" : "taken as mm"));
        pose_list_finish(&list);
    }
}

static void what_looks_wrong(void **state)
{
    (void)state;
    const struct columns flat = {{5000, 5016, 5000}, {20, 40, 3840}, {1, 1, 1}, 3, .missing = NULL};
    conus_pose_list list = {0};
    parse(&list, &flat, &ccf);
    assert_true(pose_has_note(&list, "are they on the probe"));
    pose_list_finish(&list);
}

static const struct columns localized = {
    {0}, {0}, {0}, 3, .missing = "x", .tables = 1, .origin = "Bregma (skull)", .units = "mm", .ways = "RAS"};

/* A table with a Space states origin, unit and directions itself, whichever space is asked for; electrodes then need no
 * positions. */
static void localization_is_preferred(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        conus_pose_list list = {0};
        parse(&list, &localized, i ? &bregma : &ccf);
        assert_int_equal(list.count, 2);
        assert_row_at(pose_row_of(&list, 0, "probe1-9"), 5.739 + 1, -5.4 + 2, -0.332 + 3);
        assert_row_at(pose_row_of(&list, 1, "probe0-7"), 5.739 + 4, -5.4 + 5, -0.332 + 6);
        assert_true(pose_has_note(&list, "positions are those of /general/localization, from bregma"));
        pose_list_finish(&list);
        struct columns corner = localized;
        corner.origin = "Anterior-Superior-Left (ASL) corner of the 3D image volume";
        corner.ways = "PIR";
        parse(&list, &corner, i ? &bregma : &ccf);
        assert_row_at(pose_row_of(&list, 0, "probe1-9"), 3, -1, -2);
        pose_list_finish(&list);
    }
}

static void what_is_refused(void **state)
{
    (void)state;
    static const struct {
        struct columns columns;
        const char *part;
    } cases[] = {
        {{{1, 2, 3}, {40, NAN, 60}, {40, 5, 60}, 3, .missing = NULL}, "y and z are equal in every row"},
        {{{1, 2}, {3, 4}, {5, 6}, 2, .missing = "x"}, "no " TABLE "x"},
        {{{1, 2}, {3, 4}, {5, 6}, 2, .missing = "z"}, "no " TABLE "z"},
        {{{1, 2}, {3, 4}, {5, 6}, 2, .missing = "id"}, TABLE "id: a whole number"},
        {{{1, 2}, {3, 4}, {5, 6}, 2, .z_count = 3}, TABLE "z: a number for each"},
        {{{1, 2}, {3, 4}, {5, 6}, 2, .is_text = true}, TABLE "x: a number for each"},
        {{{1, 2}, {3, 4}, {5, 6}, 2, .is_empty = true}, TABLE "y: a number for each"},
        {{.count = 3, .tables = 2, .origin = "bregma", .units = "mm", .ways = "RAS"}, "more than one table"},
        {{.count = 3, .tables = 1, .origin = "lambda", .units = "mm", .ways = "RAS"}, "origin \"lambda\""},
        {{.count = 3, .tables = 1, .origin = "bregma", .units = "m", .ways = "RAS"}, "units \"m\""},
        {{.count = 3, .tables = 1, .origin = "bregma", .units = "mm", .ways = "RAP"}, "orientation \"RAP\""},
        {{.count = 3, .tables = 1, .origin = "bregma", .units = "mm", .ways = "RA"}, "orientation \"RA\""},
        {{.count = 3, .tables = 1, .origin = "a corner", .units = "um", .ways = "ASL"}, "orientation \"ASL\""},
        {{.count = 3, .tables = 1, .origin = "bregma", .units = "mm", .ways = "RAS", .row = 3}, "found 3, allowed are"},
        {{.count = 3, .tables = 1, .origin = "bregma", .units = "mm", .ways = "RAS", .row = -1}, "found -1, allowed"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct hdf5_builder builder;
        conus_pose_list list = {0};
        build(&builder, &cases[i].columns);
        assert_fails(parse_built(&list, &builder, &ccf), CONUS_ERROR_DATA);
        if (!strstr(conus_message(), cases[i].part)) {
            fail_msg("\"%s\" does not say \"%s\"", conus_message(), cases[i].part);
        }
        pose_list_finish(&list);
        buffer_finish(&builder.bytes);
    }
    const conus_pose_options along = {.frame = &ccf, .axis = CONUS_AXIS_PLUS_Z};
    pose_text_refuse(text_from("\x89HDF\r\n\x1a\n"), &along, "no axis (+z)");
}

static conus_status attempt(void *builder)
{
    conus_pose_list list = {0};
    conus_status status = parse_built(&list, builder, &ccf);
    pose_list_finish(&list);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct hdf5_builder builder;
        build(&builder, i ? &localized : &plain);
        test_every_allocation(attempt, &builder);
        buffer_finish(&builder.bytes);
    }
}

TEST_GROUP(pose_nwb)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(micrometres_in_ccf),
        cmocka_unit_test(from_bregma_in_either_unit),
        cmocka_unit_test(most_electrodes_tell_the_unit),
        cmocka_unit_test(what_looks_wrong),
        cmocka_unit_test(localization_is_preferred),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
