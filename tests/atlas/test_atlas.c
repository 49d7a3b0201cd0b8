/* SPDX-License-Identifier: BSD-3-Clause */
/* Atlases built in memory: dense areas, pathways, notes on oddities. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "test.h"
#include "value_maps.h"

#include <string.h>

static conus_volume_info grid_info(size_t n)
{
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "test", .dim = {n, 1, 1}, .slope = 1};
    double m[16];
    mat4_identity(m);
    m[0] = 2;
    m[4] = 0.5; /* sheared, so that a voxel is smaller than the product of its edges */
    assert_ok(space_describe(&info, m, "sheared"));
    return info;
}

static conus_status name_label(struct label_table *table, uint32_t number, const char *name)
{
    struct label *label = label_table_add(table, number);
    return label ? label_set_text(&label->name, text_from(name)) : CONUS_ERROR_MEMORY;
}

static conus_status make_atlas(conus_atlas **out)
{
    static const uint32_t labels[8] = {0, 4000000001U, 4000000001U, 7, 0, 7, 7, 300};
    conus_volume_info info = grid_info(8);
    struct label_table table = {0};
    struct notes notes = {0};
    conus_status status = name_label(&table, 4000000001U, "far");
    status = status ? status : name_label(&table, 7, "seven");
    status = status ? status : name_label(&table, 9, "absent");
    status = status ? status : name_label(&table, 7, "also seven");
    status = status ? status : label_table_sort(&table, &notes);
    if (!status) {
        table.entries[0].has_parent = true; /* 7 below 9, 9 below 7: a cycle */
        table.entries[0].parent = 9;
        table.entries[1].has_parent = true;
        table.entries[1].parent = 7;
        table.entries[2].has_parent = true; /* 4000000001 below 300, which is no entry but a label present */
        table.entries[2].parent = 300;
        status = atlas_create(out, &info, labels, &table, "made here", &notes);
    }
    notes_finish(&notes);
    label_table_finish(&table);
    return status;
}

static void areas_are_dense_and_keep_their_labels(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(make_atlas(&atlas));
    const uint32_t wanted[] = {7, 9, 300, 4000000001U};
    const uint64_t voxels[] = {3, 0, 1, 2};
    const char *const names[] = {"seven", "absent", "300", "far"};
    assert_int_equal(conus_atlas_object_count(atlas), 4);
    for (size_t i = 0; i < 4; i++) {
        const conus_object *area = conus_atlas_object(atlas, i + 1);
        assert_int_equal(area->label, wanted[i]);
        assert_int_equal(area->voxels, voxels[i]);
        assert_string_equal(area->name, names[i]);
        assert_near(area->volume_mm3, 2.0 * (double)voxels[i], 1e-12);
        assert_int_equal(area->named, i != 2);
    }
    assert_null(conus_atlas_object(atlas, 0));
    assert_null(conus_atlas_object(atlas, 5));
    const uint32_t numbers[8] = {0, 4, 4, 1, 0, 1, 1, 3};
    for (size_t i = 0; i < 8; i++) {
        assert_int_equal(volume_object(&atlas->volumes[0], i), numbers[i]);
    }
    conus_atlas_destroy(atlas);
}

static void oddities_are_noted(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(make_atlas(&atlas));
    assert_true(test_has_note(atlas, "label 7 is named twice"));
    assert_true(test_has_note(atlas, "does not name: 1 (300)"));
    assert_true(test_has_note(atlas, "without a voxel: 1 (9)"));
    assert_true(test_has_note(atlas, "lies below it"));
    assert_int_equal(conus_atlas_object(atlas, 1)->parent, 2);
    assert_int_equal(conus_atlas_object(atlas, 2)->parent, 0);
    assert_int_equal(conus_atlas_object(atlas, 4)->parent, 3);
    conus_atlas_destroy(atlas);
}

/* Makes a chain: the parent of area k is area k + step, and the last area has none. */
static conus_status make_chain(conus_atlas **out, uint32_t count, bool down)
{
    static const uint32_t labels[1] = {1};
    conus_volume_info info = grid_info(1);
    struct label_table table = {0};
    struct notes notes = {0};
    conus_status status = CONUS_OK;
    for (uint32_t k = 1; !status && k <= count; k++) {
        struct label *label = label_table_add(&table, k);
        assert_non_null(label);
        label->has_parent = k != (down ? count : 1);
        label->parent = down ? k + 1 : k - 1;
        status = label_set_text(&label->name, text_from("part"));
    }
    status = status ? status : atlas_create(out, &info, labels, &table, "a table", &notes);
    notes_finish(&notes);
    label_table_finish(&table);
    return status;
}

/* In a chain of n areas the last has n - 1 above it. A walk up from every area of the longest chain here would take
 * 10^10 steps. */
static void trees_are_not_deeper_than_allowed(void **state)
{
    (void)state;
    for (int down = 0; down < 2; down++) {
        conus_atlas *atlas = NULL;
        assert_ok(make_chain(&atlas, ATLAS_DEPTH_LIMIT + 1, down));
        assert_int_equal(conus_atlas_depth(atlas, down ? 1 : ATLAS_DEPTH_LIMIT + 1), 65);
        conus_atlas_destroy(atlas);
        assert_int_equal(make_chain(&atlas, ATLAS_DEPTH_LIMIT + 2, down), CONUS_ERROR_DATA);
        assert_string_equal(conus_message(), down ? "a table: tree: label 1 has more than 64 areas above it"
                                                  : "a table: tree: label 66 has more than 64 areas above it");
        assert_int_equal(make_chain(&atlas, 200000, down), CONUS_ERROR_DATA);
    }
}

/* A circle within the depth limit is broken at its last area; a longer one is refused. */
static void circles_are_broken_or_refused(void **state)
{
    (void)state;
    static const uint32_t labels[1] = {1};
    static const uint32_t counts[] = {2, ATLAS_DEPTH_LIMIT, 200000};
    for (size_t c = 0; c < 3; c++) {
        conus_volume_info info = grid_info(1);
        struct label_table table = {0};
        struct notes notes = {0};
        conus_atlas *atlas = NULL;
        for (uint32_t k = 1; k <= counts[c]; k++) {
            struct label *label = label_table_add(&table, k);
            label->has_parent = true;
            label->parent = k == 1 ? counts[c] : k - 1;
            assert_ok(label_set_text(&label->name, text_from("part")));
        }
        conus_status status = atlas_create(&atlas, &info, labels, &table, "a table", &notes);
        assert_int_equal(status, c < 2 ? CONUS_OK : CONUS_ERROR_DATA);
        for (uint32_t k = 1; !status && k <= counts[c]; k++) {
            assert_int_equal(conus_atlas_object(atlas, k)->parent, k == counts[c] ? 0 : k == 1 ? counts[c] : k - 1);
        }
        assert_true(status || test_has_note(atlas, "lies below it: treated as a root"));
        conus_atlas_destroy(atlas);
        notes_finish(&notes);
        label_table_finish(&table);
    }
}

/* Ten missing parents: eight are named, two are counted. */
static void many_missing_parents_are_counted(void **state)
{
    (void)state;
    static const uint32_t labels[1] = {1};
    conus_volume_info info = grid_info(1);
    struct label_table table = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    for (uint32_t k = 1; k <= 10; k++) {
        struct label *label = label_table_add(&table, k);
        label->has_parent = true;
        label->parent = 100 + k;
        assert_ok(label_set_text(&label->name, text_from("part")));
    }
    assert_ok(atlas_create(&atlas, &info, labels, &table, "a table", &notes));
    assert_true(test_has_note(atlas, "area 8: its parent 108 is not in the label table: treated as a root"));
    assert_false(test_has_note(atlas, "area 9:"));
    assert_true(test_has_note(atlas, "2 more areas are treated as roots"));
    conus_atlas_destroy(atlas);
    notes_finish(&notes);
    label_table_finish(&table);
}

/* The index finds exact names and labels of one object, the same as area_find() does, and leaves all else to
 * area_find(). */
static void exact_names_are_found_by_an_index(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t number;
    } cases[] = {{"seven", 1}, {"7", 1},  {"absent", 2}, {"9", 2},    {"300", 3},        {"far", 4},
                 {"FAR", 0},   {"07", 0}, {"", 0},       {"seve", 0}, {"4000000001", 4}, {"seven ", 0}};
    conus_atlas *atlas = NULL;
    struct object_index index = {0};
    assert_ok(make_atlas(&atlas));
    assert_ok(object_index_init(&index, atlas));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        uint32_t found = 0;
        assert_int_equal(object_index_find(&index, text_from(cases[i].text)), cases[i].number);
        if (cases[i].number) {
            assert_ok(area_find(&found, atlas, text_from(cases[i].text)));
            assert_int_equal(found, cases[i].number);
        }
    }
    object_index_finish(&index);
    conus_atlas_destroy(atlas);
    index = (struct object_index){0};
    assert_ok(make_chain(&atlas, 3, true)); /* three of one name */
    assert_ok(object_index_init(&index, atlas));
    assert_int_equal(object_index_find(&index, text_from("part")), 0);
    assert_int_equal(object_index_find(&index, text_from("2")), 2);
    object_index_finish(&index);
    conus_atlas_destroy(atlas);
}

static conus_status make_with_pathway(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    conus_volume_info info = grid_info(4);
    float *values = NULL;
    conus_status status = make_atlas(&atlas);
    if (!status) {
        values = memory_zeroed(4, sizeof *values);
        status = values ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!status) {
        values[1] = 0.25F;
        values[2] = 0.2499F;
        info.role = CONUS_ROLE_SCALAR;
        info.threshold = 0.25;
        status = pathway_of_values(atlas, &info, values, "tract");
        values = status ? values : NULL;
    }
    if (!status) {
        const conus_object *pathway = conus_atlas_object(atlas, 5);
        assert_int_equal(pathway->kind, CONUS_KIND_PATHWAY);
        assert_int_equal(pathway->label, 1);
        assert_int_equal(pathway->voxels, 1); /* Eq. 6: at or above the threshold */
        assert_int_equal(volume_object(atlas_object_volume(atlas, 5), 1), 5);
    }
    memory_free(values);
    conus_atlas_destroy(atlas);
    return status;
}

static void pathways_follow_the_areas(void **state)
{
    (void)state;
    assert_ok(make_with_pathway(NULL));
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    test_every_allocation(make_with_pathway, NULL);
}

static conus_status make_of_meshes(void *data)
{
    (void)data;
    conus_atlas *atlas = NULL;
    struct mesh mesh = {0};
    conus_object area = {.label = 4000000000U, .name = "wedge", .abbreviation = "", .named = true};
    conus_status status = atlas_create_empty(&atlas, "meshes");
    status = status ? status : mesh_init(&mesh, 4, 4);
    if (!status) { /* a tetrahedron of volume 1/6 */
        const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
        memcpy(mesh.triangles, triangles, sizeof triangles);
        mesh.positions[3] = mesh.positions[7] = mesh.positions[11] = 1;
        status = atlas_add_mesh(atlas, &area, &mesh);
    }
    if (!status) {
        const conus_object *object = conus_atlas_object(atlas, 1);
        assert_int_equal(object->kind, CONUS_KIND_AREA);
        assert_int_equal(object->triangles, 4);
        assert_near(object->volume_mm3, 1.0 / 6, 1e-12);
        assert_null(atlas_parcellation(atlas));
        assert_null(atlas_object_volume(atlas, 1));
        assert_int_equal(atlas_object_mesh(atlas, 1)->vertex_count, 4);
        assert_null(mesh.positions);
    }
    mesh_finish(&mesh);
    conus_atlas_destroy(atlas);
    return status;
}

static void areas_may_be_meshes(void **state)
{
    (void)state;
    test_every_allocation(make_of_meshes, NULL);
}

static void orientation_follows_the_affine(void **state)
{
    (void)state;
    conus_volume_info info = {0};
    double m[16] = {-2, 0.1, 0, 0, 0, 0, -3, 0, 0, 1, 0, 0, 0, 0, 0, 1};
    assert_ok(space_describe(&info, m, "sform"));
    assert_string_equal(info.orientation, "LIA");
    assert_near(info.spacing[1], 3, 1e-12);
    m[0] = m[1] = 0;
    assert_fails(space_describe(&info, m, "sform"), CONUS_ERROR_DATA);
}

/* Each number stands on one side of a limit of atlas/space.h, in a grid of 10^3 voxels of 1 mm. */
static void grids_have_limits(void **state)
{
    (void)state;
    static const struct {
        int at;
        double value;
        const char *message; /* NULL: none */
    } cases[] = {{0, 1e-310, "sform: a step along axis 0 is 1e-310 mm long, allowed are 1e-09 to 1e+06"},
                 {5, 0.9e-9, "axis 1"},
                 {5, 1.1e-9, NULL},
                 {10, -0.9e6, NULL},
                 {10, -1.1e6, "axis 2"},
                 {0, 1e300, "a step along axis 0 is 1e+300 mm"},
                 {0, INFINITY, "axis 0 is inf"},
                 {0, NAN, "singular or not finite"},
                 {13, 1e300, "it begins inf mm"},
                 {13, 1.1e10, "it begins 1.1e+10 mm, 1.1e+10 steps, from the origin"},
                 {12, 9e9, NULL},
                 {12, NAN, "singular or not finite"},
                 {4, 1e6, "axis 1"},
                 {4, 1e5, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_volume_info info = {.dim = {10, 10, 10}};
        double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        double inverse[16];
        m[cases[i].at] = cases[i].value;
        conus_status status = space_describe(&info, m, "sform");
        assert_int_equal(status, space_invert(inverse, m, "sform"));
        if (!status != !cases[i].message || (status && !strstr(conus_message(), cases[i].message))) {
            fail_msg("case %zu: %s", i, status ? conus_message() : "no error");
        }
    }
    conus_volume_info far = {.dim = {10, 10, SIZE_MAX / 1000}};
    const double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    assert_fails(space_describe(&far, m, "sform"), CONUS_ERROR_DATA);
    assert_non_null(strstr(conus_message(), "a corner of the grid is"));
    const double flat[16] = {1, 0, 0, 0, 1, 0.9e-6, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; /* two axes 0.9e-6 apart */
    assert_fails(space_describe(&(conus_volume_info){0}, flat, "sform"), CONUS_ERROR_DATA);
}

/* A matrix as NIfTI-1 keeps it, in float32, and as NIfTI-2 does. */
static void grids_may_differ_by_rounding(void **state)
{
    (void)state;
    conus_volume_info a = {.dim = {91, 109, 91}};
    const double exact[16] = {-0.7, 0, 0, 0, 0, 0.7, 0, 0, 0, 0, 0.7, 0, 90.1, -126.3, -72.7, 1};
    double rounded[16];
    for (int i = 0; i < 16; i++) {
        rounded[i] = (double)(float)exact[i];
    }
    assert_ok(space_describe(&a, exact, "exact"));
    conus_volume_info b = a;
    assert_ok(space_describe(&b, rounded, "rounded"));
    assert_true(space_same_grid(&a, &b));
    rounded[12] += 0.001;
    assert_ok(space_describe(&b, rounded, "moved"));
    assert_false(space_same_grid(&a, &b));
}

/* Four Allen structures; float32 has every 16th whole number there, and every second one from 2^24 on. */
static void labels_in_single_precision(void **state)
{
    (void)state;
    static const struct {
        uint32_t table[2], labels[2];
        const char *error, *note;
    } cases[] = {{{997, 8}, {997, 16777215}, NULL, NULL},
                 {{997, 8}, {997, 16777216}, NULL, "f.nii: labels up to 16777216 as float32, which from 16777216 on"},
                 {{182305696, 8}, {182305696, 8}, NULL, "labels up to 182305696"},
                 {{182305693, 8}, {182305696, 8}, "f.nii: the label 182305693, \"x\", is 182305696 as float32", NULL},
                 {{182305696, 182305697}, {8, 182305696}, "the label 182305697", NULL},
                 {{16777217, 8}, {8, 16777216}, "the label 16777217", NULL},
                 {{16777217, 8}, {8, 16777218}, NULL, "labels up to 16777218"}, /* a tie goes to the even 16777216 */
                 {{182305693, 8}, {8, 182305712}, NULL, "labels up to 182305712"},
                 {{4294967295, 8}, {8, 4294967040}, NULL, "labels up to 4294967040"},
                 {{4294967041, 4294967042}, {8, 4294967040}, "the label 4294967041", NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct label_table table = {0};
        struct notes notes = {0};
        for (int k = 0; k < 2; k++) {
            assert_ok(label_set_text(&label_table_add(&table, cases[i].table[k])->name, text_from("x")));
        }
        assert_ok(label_table_sort(&table, &notes));
        conus_status status = label_table_check_singles(&table, cases[i].labels, 2, 16777216, "f.nii", &notes);
        if (!status != !cases[i].error || (status && !strstr(conus_message(), cases[i].error))) {
            fail_msg("case %zu: %s", i, status ? conus_message() : "no error");
        }
        assert_int_equal(notes.count, cases[i].note != NULL);
        assert_true(!cases[i].note || strstr(notes.lines[0], cases[i].note));
        label_table_finish(&table);
        notes_finish(&notes);
    }
}

static void latin1_names_become_utf8(void **state)
{
    (void)state;
    char *name = NULL;
    assert_ok(label_set_text(&name, text_from("  Br\xfc"
                                              "cke\t ")));
    assert_string_equal(name, "Br\xc3\xbc"
                              "cke");
    assert_ok(label_set_text(&name, text_from("a\tb")));
    assert_string_equal(name, "a b");
    memory_free(name);
}

TEST_GROUP(atlas)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_are_dense_and_keep_their_labels),
        cmocka_unit_test(oddities_are_noted),
        cmocka_unit_test(exact_names_are_found_by_an_index),
        cmocka_unit_test(trees_are_not_deeper_than_allowed),
        cmocka_unit_test(circles_are_broken_or_refused),
        cmocka_unit_test(many_missing_parents_are_counted),
        cmocka_unit_test(pathways_follow_the_areas),
        cmocka_unit_test(every_failing_allocation_is_clean),
        cmocka_unit_test(areas_may_be_meshes),
        cmocka_unit_test(orientation_follows_the_affine),
        cmocka_unit_test(grids_have_limits),
        cmocka_unit_test(grids_may_differ_by_rounding),
        cmocka_unit_test(labels_in_single_precision),
        cmocka_unit_test(latin1_names_become_utf8),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
