/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists as tables, against what the test itself puts into atlases, folders and files. */
#include "builders/nifti_builder.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { AREAS = 6 };

/* Six voxels along x, from -2.5 to 2.5 mm, each of an area of its own. */
static conus_atlas *make_atlas(const char *const names[AREAS])
{
    static const uint8_t values[AREAS] = {1, 2, 3, 4, 5, 6};
    conus_voxels voxels = CONUS_VOXELS_INIT;
    conus_label labels[AREAS] = {0};
    conus_atlas *atlas = NULL;
    voxels.data = values;
    voxels.type = CONUS_SCALAR_UINT8;
    memcpy(voxels.dim, (size_t[]){AREAS, 1, 1}, sizeof voxels.dim);
    memcpy(voxels.stride, (ptrdiff_t[]){1, AREAS, AREAS}, sizeof voxels.stride);
    memcpy(voxels.world_from_voxel, (double[]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -2.5, 0, 0, 1},
           sizeof voxels.world_from_voxel);
    for (uint32_t i = 0; i < AREAS; i++) {
        labels[i].number = i + 1;
        labels[i].name = names[i];
    }
    assert_ok(conus_atlas_create(&atlas, &voxels, labels, AREAS, NULL));
    return atlas;
}

static const char *const sided[AREAS] = {"left a", "left b", "left c", "right a", "right b", "middle"};

static void objects_have_sides_and_outlive_their_atlas(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas(sided);
    conus_table *table = NULL;
    assert_ok(conus_atlas_show(atlas, NULL, "left c"));
    assert_ok(conus_atlas_list(&table, atlas, "objects"));
    conus_atlas_destroy(atlas);
    assert_int_equal(conus_table_rows(table), AREAS);
    for (size_t i = 0; i < AREAS; i++) {
        const char *side = conus_table_texts(table, "side")[i];
        assert_string_equal(conus_table_texts(table, "name")[i], sided[i]);
        assert_string_equal(side ? side : "none", i < 3 ? "left" : i < 5 ? "right" : "none");
        assert_int_equal(conus_table_objects(table)[i], i + 1);
        assert_int_equal(conus_table_counts(table, "index")[i], i + 1);
        assert_int_equal(conus_table_counts(table, "depth")[i], 1);
        assert_true(conus_table_find(table, "parent")->missing[i]);
        assert_int_equal(conus_table_counts(table, "hidden")[i], i == 2);
    }
    conus_table_destroy(table);
}

/* How many notes are of the kind. */
static size_t count_notes(const conus_atlas *atlas, const char *kind)
{
    conus_table *table = NULL;
    size_t count = 0;
    assert_ok(conus_atlas_list(&table, atlas, "notes"));
    for (size_t i = 0; i < conus_table_rows(table); i++) {
        assert_non_null(conus_table_texts(table, "text")[i]);
        count += strcmp(conus_table_texts(table, "kind")[i], kind) == 0;
    }
    conus_table_destroy(table);
    return count;
}

/* Three pairs whose right areas lie where x is below 0: to the left. Mirrored, they lie right. */
static void notes_say_that_sides_are_exchanged(void **state)
{
    (void)state;
    conus_atlas *atlas =
        make_atlas((const char *const[AREAS]){"right a", "right b", "right c", "left a", "left b", "left c"});
    assert_int_equal(count_notes(atlas, "labels"), 1);
    assert_int_equal(count_notes(atlas, "exchanged"), 1);
    assert_ok(conus_atlas_exchange_sides(atlas));
    assert_int_equal(count_notes(atlas, "exchanged"), 0);
    conus_atlas_destroy(atlas);
}

static void what_is_not_there_has_no_rows(void **state)
{
    (void)state;
    static const char *const lists[] = {"surfaces", "tractograms", "files"};
    conus_atlas *atlas = make_atlas(sided);
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        conus_table *table = NULL;
        assert_ok(conus_atlas_list(&table, atlas, lists[i]));
        assert_int_equal(conus_table_rows(table), 0);
        assert_non_null(conus_table_find(table, "path"));
        conus_table_destroy(table);
    }
    conus_table *none = NULL;
    assert_fails(conus_atlas_list(&none, atlas, "tracts"), CONUS_ERROR_ARGUMENT);
    assert_null(none);
    assert_string_equal(conus_message(), "what: tracts, allowed are objects, surfaces, tractograms, files and notes");
    assert_fails(conus_atlas_list(&none, atlas, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_list(&none, NULL, "objects"), CONUS_ERROR_ARGUMENT);
    assert_null(none);
    conus_atlas_destroy(atlas);
}

/* Of each three numbers the box is known: streamlines from (1, 2, 3) to (4, 2, 3). */
static void tractograms_have_a_box(void **state)
{
    (void)state;
    static const float points[] = {1, 2, 3, 4, 2, 3};
    static const uint64_t first[] = {0, 2};
    conus_polylines lines = CONUS_POLYLINES_INIT;
    conus_streamlines_options options = CONUS_STREAMLINES_OPTIONS_INIT;
    conus_atlas *atlas = make_atlas(sided);
    conus_table *table = NULL;
    lines.points = points;
    lines.type = CONUS_SCALAR_FLOAT32;
    lines.point_count = 2;
    lines.first = first;
    lines.streamline_count = 1;
    options.name = "tract";
    assert_ok(conus_atlas_add_polylines(atlas, &lines, &options));
    assert_ok(conus_atlas_list(&table, atlas, "tractograms"));
    assert_int_equal(conus_table_rows(table), 1);
    assert_int_equal(conus_table_objects(table)[0], AREAS + 1);
    assert_string_equal(conus_table_texts(table, "format")[0], "array");
    assert_null(conus_table_texts(table, "sha256")[0]);
    assert_int_equal(conus_table_counts(table, "streamlines")[0], 1);
    assert_int_equal(conus_table_counts(table, "points")[0], 2);
    assert_near(conus_table_numbers(table, "length_mm")[0], 3, 0);
    assert_near(conus_table_numbers(table, "low_x")[0], 1, 0);
    assert_near(conus_table_numbers(table, "high_x")[0], 4, 0);
    assert_near(conus_table_numbers(table, "low_z")[0], 3, 0);
    conus_table_destroy(table);
    conus_atlas_destroy(atlas);
}

static void choices_are_what_options_take(void **state)
{
    (void)state;
    static const char *const spaces[] = {"ras", "lps", "ccf", "bregma"};
    conus_table *table = NULL;
    assert_ok(conus_list_choices(&table, "spaces"));
    assert_int_equal(conus_table_rows(table), 4);
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(conus_table_texts(table, "name")[i], spaces[i]);
        assert_null(conus_table_texts(table, "help")[i]);
    }
    conus_table_destroy(table);
    assert_ok(conus_list_choices(&table, "scores"));
    for (size_t i = 0; i < conus_table_rows(table); i++) {
        conus_score_info info;
        assert_ok(conus_score_parse(&info, conus_table_texts(table, "name")[i]));
        assert_non_null(conus_table_texts(table, "help")[i]);
    }
    assert_true(conus_table_rows(table) > 5);
    conus_table_destroy(table);
    assert_ok(conus_list_choices(&table, "pose formats"));
    assert_string_equal(conus_table_texts(table, "name")[0], "auto");
    for (size_t i = 0; i < conus_table_rows(table); i++) {
        conus_pose_list *list = NULL;
        const conus_pose_options options = {.format = conus_table_texts(table, "name")[i]};
        assert_fails(conus_pose_list_load(&list, "no such file", &options), CONUS_ERROR_IO);
    }
    conus_table_destroy(table);
    FOR_WORDS(what, "formats", "rows")
    {
        assert_ok(conus_list_choices(&table, what));
        for (size_t i = 0; i < conus_table_rows(table); i++) {
            const char *name = conus_table_texts(table, "name")[i];
            const bool is_format = what[0] == 'f';
            const bool is_afar = is_format && (!strcmp(name, "bids") || !strcmp(name, "bep032")); /* they need more */
            conus_report_options options = {.rows = is_format ? NULL : name, .format = is_format ? name : "tsv"};
            conus_report *report = NULL;
            assert_fails(conus_report_create(&report, NULL, &options), is_afar ? CONUS_ERROR_ARGUMENT : CONUS_OK);
            conus_report_destroy(report);
        }
        conus_table_destroy(table);
    }
    assert_ok(conus_list_choices(&table, "errors"));
    assert_true(conus_table_rows(table) > 15);
    for (size_t i = 0; i < conus_table_rows(table); i++) {
        conus_pose_error error;
        const char *name = conus_table_texts(table, "name")[i];
        assert_ok(conus_pose_error_find(&error, strcmp(name, "vr-controller") ? name : "vr-controller:4"));
        assert_float_equal(conus_table_numbers(table, "tilt_deg")[i], error.tilt_deg, 1e-3); /* of 4 degrees: rounded */
        assert_true(conus_table_numbers(table, "shift_mm")[i] == error.shift);
        assert_true(conus_table_numbers(table, "entry_mm")[i] == error.entry);
        assert_true(conus_table_numbers(table, "target_mm")[i] == error.target);
        assert_true(conus_table_numbers(table, "depth_mm")[i] == error.depth);
        assert_string_equal(conus_table_texts(table, "source")[i], error.source);
    }
    conus_table_destroy(table);
    assert_fails(conus_list_choices(&table, "colours"), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_list_choices(&table, NULL), CONUS_ERROR_ARGUMENT);
}

/* The only place for atlases is a folder with one volume of 2 x 3 x 4 mm, which has the labels 0 to 7. */
static void use_folder(void)
{
    static const char *const others[] = {"FSLDIR",          "SUBJECTS_DIR", "FREESURFER_HOME", "TEMPLATEFLOW_HOME",
                                         "AFNI_ATLAS_PATH", "SPM_DIR",      "NILEARN_DATA",    "MRICROGL_DIR"};
    test_folder("installed");
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        unsetenv(others[i]);
    }
    setenv("XDG_DATA_DIRS", test_in("none"), 1);
    setenv("HOME", test_in(""), 1);
    setenv("PATH", "", 1);
    setenv("CONUS_ATLAS_PATH", test_in(""), 1);
    struct nifti_builder file;
    nifti_begin(&file, 1, false, 2, (const int64_t[]){2, 2, 2});
    nifti_set(&file, "intent_code", 0, 1002);
    for (int i = 0; i < 8; i++) {
        nifti_voxel(&file, i);
    }
    assert_ok(conus_write_file(test_in("corners.nii"), file.bytes.data, file.bytes.size));
    buffer_finish(&file.bytes);
}

static void an_atlas_loads_by_its_name(void **state)
{
    (void)state;
    use_folder();
    conus_table *table = NULL;
    assert_ok(conus_list_installed(&table, NULL, NULL));
    assert_int_equal(conus_table_rows(table), 1);
    assert_string_equal(conus_table_texts(table, "name")[0], "corners");
    assert_string_equal(conus_table_texts(table, "source")[0], "own");
    assert_string_equal(conus_table_texts(table, "kind")[0], "volume");
    assert_null(conus_table_texts(table, "labels")[0]);
    assert_near(conus_table_numbers(table, "spacing_x")[0], 2, 0);
    assert_near(conus_table_numbers(table, "spacing_z")[0], 4, 0);
    const conus_table *places = conus_table_part(table, "places");
    assert_string_equal(conus_table_texts(places, "source")[0], "own");
    assert_int_equal(conus_table_counts(places, "there")[0], 1);
    static const char *const names[] = {"corners", "own:corners", "Corners", "corners,template=mni152"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        conus_atlas *atlas = NULL;
        assert_ok(conus_atlas_load(&atlas, names[i], NULL));
        assert_int_equal(conus_atlas_object_count(atlas), 7);
        assert_string_equal(conus_atlas_volume(atlas, 0)->path, conus_table_texts(table, "path")[0]);
        conus_atlas_destroy(atlas);
    }
    conus_table_destroy(table);
    conus_atlas *none = NULL;
    assert_fails(conus_atlas_load(&none, "corner", NULL), CONUS_ERROR_IO);
    assert_non_null(strstr(conus_message(), "did you mean corners?"));
    assert_fails(conus_atlas_load(&none, "./corners", NULL), CONUS_ERROR_IO);
    assert_null(strstr(conus_message(), "installed"));
}

static const char two_contacts[] =
    "{\"specification\":\"probeinterface\",\"probes\":[{\"ndim\":2,\"si_units\":\"um\",\"contact_positions\":"
    "[[0,10],[0,20]],\"device_channel_indices\":[3,-1],\"probe_planar_contour\":[[0,0],[1,90],[-1,90]]}]}";

static conus_probe *load_probe(void)
{
    conus_probe *probe = NULL;
    test_folder("lists");
    assert_ok(conus_write_file(test_in("probe.json"), two_contacts, sizeof two_contacts - 1));
    assert_ok(conus_probe_load(&probe, test_in("probe.json"), NULL));
    return probe;
}

static void contacts_have_offsets_from_the_tip(void **state)
{
    (void)state;
    conus_probe *probe = load_probe();
    conus_table *table = NULL;
    assert_ok(conus_probe_table(&table, probe));
    conus_probe_destroy(probe);
    assert_int_equal(conus_table_rows(table), 2);
    for (size_t i = 0; i < 2; i++) {
        assert_string_equal(conus_table_texts(table, "id")[i], i ? "1" : "0");
        assert_string_equal(conus_table_texts(table, "probe")[i], "probe1");
        assert_null(conus_table_texts(table, "shank_id")[i]);
        assert_int_equal(conus_table_counts(table, "number")[i], 1);
        assert_int_equal(conus_table_counts(table, "channel")[i], i ? -1 : 3);
        assert_near(conus_table_numbers(table, "y_um")[i], i ? 20 : 10, 0);
        assert_true(isnan(conus_table_numbers(table, "z_um")[i]));
        assert_near(conus_table_numbers(table, "offset_z")[i], i ? 0.02 : 0.01, 1e-12);
    }
    const conus_table *tips = conus_table_part(table, "tips");
    assert_int_equal(conus_table_rows(tips), 1);
    assert_near(conus_table_numbers(tips, "y_um")[0], 0, 0);
    conus_table_destroy(table);
}

static conus_status list_all(void *data)
{
    static const char *const lists[] = {"objects", "surfaces", "tractograms", "files", "notes"};
    conus_table *table = NULL;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < sizeof lists / sizeof *lists && !status; i++) {
        status = conus_atlas_list(&table, data, lists[i]);
        conus_table_destroy(table);
        table = NULL;
    }
    status = status ? status : conus_list_choices(&table, "scores");
    conus_table_destroy(table);
    table = NULL;
    status = status ? status : conus_list_installed(&table, NULL, NULL);
    conus_table_destroy(table);
    return status;
}

static conus_status list_contacts(void *data)
{
    conus_table *table = NULL;
    conus_status status = conus_probe_table(&table, data);
    conus_table_destroy(table);
    return status;
}

static void survives_every_failing_allocation(void **state)
{
    (void)state;
    use_folder();
    conus_atlas *atlas = make_atlas(sided);
    conus_probe *probe = load_probe();
    test_every_allocation(list_all, atlas);
    test_every_allocation(list_contacts, probe);
    conus_probe_destroy(probe);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(lists)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(objects_have_sides_and_outlive_their_atlas),
        cmocka_unit_test(notes_say_that_sides_are_exchanged),
        cmocka_unit_test(what_is_not_there_has_no_rows),
        cmocka_unit_test(tractograms_have_a_box),
        cmocka_unit_test(choices_are_what_options_take),
        cmocka_unit_test(an_atlas_loads_by_its_name),
        cmocka_unit_test(contacts_have_offsets_from_the_tip),
        cmocka_unit_test(survives_every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
