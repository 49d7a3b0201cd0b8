/* SPDX-License-Identifier: BSD-3-Clause */
/* A file of several volumes that a table names: areas of probabilities, and what must never be taken for them. Volumes
 * of 20 x 20 x 20 voxels; their values are functions of the place. */
#include "builders/label_row.h"
#include "builders/nifti_builder.h"
#include "conus/atlas_info.h"
#include "conus/file.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DIM = 20, VOLUMES = 3, UINT8 = 2, INT16 = 4, FLOAT32 = 16 };

typedef double formula(size_t volume, const double at[3]);

static double distance(const double at[3], double x, double y, double z)
{
    return sqrt((at[0] - x) * (at[0] - x) + (at[1] - y) * (at[1] - y) + (at[2] - z) * (at[2] - z));
}

/* In percent, 10 less for each voxel of distance from the middle of the area, which is at x = 5, 10 or 15. */
static double blobs(size_t volume, const double at[3])
{
    double percent = floor(100 - 10 * distance(at, 5 + 5 * (double)volume, 10, 10));
    return percent > 0 ? percent : 0;
}

static double fractions(size_t volume, const double at[3])
{
    return blobs(volume, at) / 100;
}

/* 1 in a ball of 4 voxels, else 0. */
static double masks(size_t volume, const double at[3])
{
    return blobs(volume, at) > 60;
}

/* Slabs of labels 30, 31, ...: different ones in each volume, at no place in two of them. */
static double labels(size_t volume, const double at[3])
{
    size_t slab = (size_t)at[2] / 2;
    return slab % VOLUMES == volume ? 30 + (double)slab : 0;
}

/* A head of 9 voxels around the middle, brighter in one volume than in another; 0 to 1, and all around it 0. */
static double scans(size_t volume, const double at[3])
{
    double depth = 9 - distance(at, 10, 10, 10);
    return depth > 0 ? depth / 9 / (1 + (double)volume) : 0;
}

static double negative(size_t volume, const double at[3])
{
    return fractions(volume, at) - 0.5;
}

static double series(size_t volume, const double at[3])
{
    return 700 + 10 * (double)volume + at[0];
}

/* The value of voxel `v` of a volume, i fastest. */
static double value_at(formula *value, size_t volume, size_t v)
{
    const size_t index[3] = {v % DIM, v / DIM % DIM, v / DIM / DIM};
    return value(volume, (double[]){(double)index[0], (double)index[1], (double)index[2]});
}

static void write_volumes(const char *name, int datatype, size_t count, formula *value)
{
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, datatype, (int64_t[]){DIM, DIM, DIM});
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, (double)count);
    for (size_t i = 0; i < count * DIM * DIM * DIM; i++) {
        nifti_voxel(&builder, value_at(value, i / (DIM * DIM * DIM), i % (DIM * DIM * DIM)));
    }
    assert_ok(conus_write_file(test_in(name), builder.bytes.data, builder.bytes.size));
    buffer_finish(&builder.bytes);
}

static conus_atlas *load(const char *name, const conus_load_options *options)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in(name), options));
    return atlas;
}

static void assert_refused(const char *name, const conus_load_options *options, conus_status wanted, const char *words)
{
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, test_in(name), options), wanted);
    assert_null(atlas);
    if (!strstr(conus_message(), words)) {
        fail_msg("found \"%s\", wanted \"%s\"", conus_message(), words);
    }
}

/* Areas by these names, each with the voxels of its volume that reach the threshold. */
static void assert_areas(const conus_atlas *atlas, size_t first, const char *const *names, formula *value, double from)
{
    assert_int_equal(conus_atlas_object_count(atlas), VOLUMES - first);
    for (size_t volume = first; volume < VOLUMES; volume++) {
        const conus_object *area = conus_atlas_object(atlas, volume - first + 1);
        uint64_t voxels = 0;
        for (size_t v = 0; v < DIM * DIM * DIM; v++) {
            voxels += value_at(value, volume, v) >= from;
        }
        assert_int_equal(area->kind, CONUS_KIND_AREA);
        assert_int_equal(area->label, volume + 1);
        assert_string_equal(area->name, names[volume]);
        assert_int_equal(area->voxels, voxels);
        assert_int_equal(conus_atlas_volume(atlas, area->volume)->role, CONUS_ROLE_PROBABILITY);
        assert_true(voxels > 20);
    }
}

static const char *const abc[] = {"A", "B", "C"};

static void a_table_beside_the_file_names_its_volumes(void **state)
{
    (void)state;
    static const struct {
        const char *file, *text;
    } tables[] = {{"maps.txt", "A\nB\nC\n"}, {"maps.txt", "1 A\n2 B\n3 C\n"}, {"maps.csv", "0,A\n1,B\n2,C\n"}};
    for (size_t i = 0; i < 3; i++) {
        char folder[16];
        snprintf(folder, sizeof folder, "beside%zu", i);
        test_folder(folder);
        write_volumes("maps.nii", UINT8, VOLUMES, blobs);
        row_text(test_in(tables[i].file), tables[i].text);
        conus_atlas *atlas = load("maps.nii", NULL);
        assert_areas(atlas, 0, abc, blobs, 25);
        assert_true(test_has_note(atlas, "maps.nii: 3 areas by probabilities of 0.25 and more (values: percent)"));
        assert_non_null(strstr(conus_atlas_label_source(atlas), tables[i].file));
        assert_int_equal(conus_atlas_file_count(atlas), 1);
        assert_string_equal(conus_atlas_file(atlas, 0), test_in(tables[i].file));
        conus_atlas_destroy(atlas);
        atlas = load("maps.nii", &(conus_load_options){.probability = 0.6});
        assert_areas(atlas, 0, abc, blobs, 60);
        conus_atlas_destroy(atlas);
    }
    write_volumes("maps.nii", FLOAT32, VOLUMES, fractions);
    conus_atlas *atlas = load("maps.nii", NULL);
    assert_areas(atlas, 0, abc, fractions, 0.25);
    conus_atlas_destroy(atlas);
    write_volumes("maps.nii", UINT8, VOLUMES, masks);
    atlas = load("maps.nii", NULL);
    assert_areas(atlas, 0, abc, masks, 0.25);
    conus_atlas_destroy(atlas);
}

static void a_given_table_does_so(void **state)
{
    (void)state;
    test_folder("given");
    write_volumes("maps.nii", UINT8, VOLUMES, blobs);
    row_text(test_in("maps.txt"), "x\ny\nz\n"); /* this table is not read */
    row_text(test_in("names.tsv"), "index\tname\tabbreviation\tcolor\n1\tA\ta\t#010203\n2\tB\tb\t#040506\n"
                                   "3\tC\tc\t#070809\n");
    row_text(test_in("two.txt"), "1 A\n2 B\n");
    row_text(test_in("four.txt"), "1 A\n2 B\n3 C\n4 D\n");
    const conus_load_options options = {.labels = test_in("names.tsv")};
    conus_atlas *atlas = load("maps.nii", &options);
    assert_areas(atlas, 0, abc, blobs, 25);
    assert_string_equal(conus_atlas_object(atlas, 2)->abbreviation, "b");
    assert_memory_equal(conus_atlas_object(atlas, 2)->rgb, ((uint8_t[]){4, 5, 6}), 3);
    conus_atlas_destroy(atlas);
    assert_refused("maps.nii", &(conus_load_options){.labels = test_in("two.txt")}, CONUS_ERROR_ARGUMENT,
                   "has 3 volumes, --labels two.txt does not name them: needed is another name for each number from 0 "
                   "to 2, or from 1 to 3; FILE,volume=K chooses one");
    assert_refused("maps.nii", &(conus_load_options){.labels = test_in("four.txt")}, CONUS_ERROR_ARGUMENT,
                   "--labels four.txt does not name them");
    assert_refused("maps.nii", &(conus_load_options){.labels = test_in("gone.txt")}, CONUS_ERROR_IO, "gone.txt");
    row_text(test_in("bad.tsv"), "index\tname\n1\tA\n2.5\tB\n3\tC\n");
    assert_refused("maps.nii", &(conus_load_options){.labels = test_in("bad.tsv")}, CONUS_ERROR_DATA, "bad.tsv: ");
}

static void the_background_is_no_area(void **state)
{
    (void)state;
    static const char *const names[] = {"Background", "B", "C"};
    test_folder("background");
    write_volumes("maps.nii", UINT8, VOLUMES, blobs);
    row_text(test_in("maps.txt"), "0 Background\n1 B\n2 C\n");
    conus_atlas *atlas = load("maps.nii", NULL);
    assert_areas(atlas, 1, names, blobs, 25);
    assert_true(test_has_note(atlas, "volume 0 is left out: it is called Background"));
    conus_atlas_destroy(atlas);
}

static void without_names_one_volume_is_chosen(void **state)
{
    (void)state;
    static const char *const undecided[] = {"1 A\n2 B\n", "2 A\n3 B\n4 C\n", "1 A\n2 A\n3 C\n", ""};
    test_folder("nameless");
    write_volumes("maps.nii", UINT8, VOLUMES, blobs);
    for (size_t i = 0; i < 4; i++) {
        row_text(test_in("maps.txt"), undecided[i]);
        assert_refused("maps.nii", NULL, CONUS_ERROR_ARGUMENT,
                       "volume: the file has 3, choose one by adding \",volume=K\", K from 0 to 2");
    }
    row_text(test_in("maps.txt"), "1 A\n2 B\n3 C\n");
    assert_refused("maps.nii", &(conus_load_options){.labels_anyway = true}, CONUS_ERROR_ARGUMENT, "choose one");
    assert_refused("maps.nii,volume=1", NULL, CONUS_ERROR_DATA, "looks like an image, not like labels");
    write_volumes("one.nii", UINT8, 1, masks);
    row_text(test_in("one.txt"), "1 A\n");
    conus_atlas *atlas = load("one.nii", NULL);
    assert_int_equal(conus_atlas_volume(atlas, 0)->role, CONUS_ROLE_PARCELLATION);
    conus_atlas_destroy(atlas);
}

static void what_is_something_else_is_refused(void **state)
{
    (void)state;
    static const struct {
        formula *value;
        int datatype;
        const char *words;
    } cases[] = {
        {labels, UINT8, "the whole numbers in 3 of them may be labels"},
        {scans, FLOAT32, "where one is above 0, 100 % of the others are, too, as in images of one thing"},
        {negative, FLOAT32, "values from -0.5 to 0.5 are not probabilities, 0 to 1 or percent"},
        {series, INT16, "values from 700 to 739 are not probabilities, 0 to 1 or percent"},
    };
    test_folder("refused");
    row_text(test_in("maps.txt"), "A\nB\nC\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_volumes("maps.nii", cases[i].datatype, VOLUMES, cases[i].value);
        assert_refused("maps.nii", NULL, CONUS_ERROR_DATA, cases[i].words);
        assert_int_equal(strncmp(conus_message(), test_in("maps.nii: a"), strlen(test_in("maps.nii: a"))), 0);
        assert_non_null(strstr(conus_message(), "maps.nii: a table names its 3 volumes, but "));
        assert_non_null(strstr(conus_message(), "FILE,volume=K chooses one, --probability T takes them for areas"));
    }
}

/* The user or the file's name says that it holds probabilities. Values that cannot be probabilities are refused all the
 * same. */
static void what_is_stated_is_believed(void **state)
{
    (void)state;
    const conus_load_options stated = {.probability = 0.1};
    test_folder("stated");
    row_text(test_in("maps.txt"), "A\nB\nC\n");
    row_text(test_in("maps_probseg.txt"), "A\nB\nC\n");
    write_volumes("maps.nii", FLOAT32, VOLUMES, scans);
    write_volumes("maps_probseg.nii", FLOAT32, VOLUMES, scans);
    conus_atlas *atlas = load("maps.nii", &stated);
    assert_areas(atlas, 0, abc, scans, 0.1);
    conus_atlas_destroy(atlas);
    atlas = load("maps_probseg.nii", NULL);
    assert_areas(atlas, 0, abc, scans, 0.25);
    conus_atlas_destroy(atlas);
    write_volumes("maps.nii", FLOAT32, VOLUMES, negative);
    assert_refused("maps.nii", &stated, CONUS_ERROR_DATA, "its least value is -0.5, no probability is below 0");
    write_volumes("maps.nii", INT16, VOLUMES, series);
    assert_refused("maps.nii", &stated, CONUS_ERROR_DATA, "its largest value is 739, probabilities are 0 to 1");
}

/* One map has its file's name, of a file of one or where one is chosen; without a statement it is one of labels. */
static void one_map_is_taken_as_stated(void **state)
{
    (void)state;
    static const struct {
        const char *file, *ask;
        double probability, from;
        const char *name;
    } cases[] = {{"gm.nii", "gm.nii", 0.6, 0.6, "gm"},
                 {"x_probseg.nii", "x_probseg.nii", 0, 0.25, "x_probseg"},
                 {"x_probseg.nii", "x_probseg.nii", 0.9, 0.9, "x_probseg"},
                 {"maps.nii", "maps.nii,volume=1", 0.6, 0.6, "maps"},
                 {"maps_probseg.nii", "maps_probseg.nii,volume=1", 0, 0.25, "maps_probseg"}};
    test_folder("one");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        size_t chosen = strstr(cases[i].ask, "volume") != NULL;
        uint64_t voxels = 0;
        write_volumes(cases[i].file, FLOAT32, chosen ? VOLUMES : 1, fractions);
        for (size_t v = 0; v < DIM * DIM * DIM; v++) {
            voxels += (float)value_at(fractions, chosen, v) >= (float)cases[i].from;
        }
        conus_atlas *atlas = load(cases[i].ask, &(conus_load_options){.probability = cases[i].probability});
        assert_int_equal(conus_atlas_object_count(atlas), 1);
        assert_string_equal(conus_atlas_object(atlas, 1)->name, cases[i].name);
        assert_int_equal(conus_atlas_object(atlas, 1)->label, 1);
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, voxels);
        assert_int_equal(conus_atlas_volume(atlas, 0)->volume, chosen);
        assert_int_equal(conus_atlas_volume(atlas, 0)->role, CONUS_ROLE_PROBABILITY);
        conus_atlas_destroy(atlas);
    }
    const conus_load_options stated = {.probability = 0.5};
    assert_refused("gm.nii", NULL, CONUS_ERROR_DATA, "allowed labels are whole numbers");
    assert_refused("maps_probseg.nii", NULL, CONUS_ERROR_ARGUMENT,
                   "maps_probseg.nii: has 3 volumes of probabilities, as its name or --probability states, and nothing "
                   "names them: --labels FILE does, FILE,volume=K takes one");
    write_volumes("labels.nii", UINT8, 1, labels); /* up to 3: percent, if anything */
    assert_refused("labels.nii", &stated, CONUS_ERROR_ARGUMENT,
                   "--probability states that its values are probabilities, but none is 0.5 or more");
}

static conus_status load_maps(void *unused)
{
    (void)unused;
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_in("maps.nii"), NULL);
    conus_atlas_destroy(atlas);
    return status;
}

/* Where a primitive of an attempt fails as data, the next reader may refuse the file for a reason of its own. */
static conus_status load_or_refuse(void *unused)
{
    conus_status status = load_maps(unused);
    return status == CONUS_ERROR_ARGUMENT ? CONUS_ERROR_DATA : status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    test_folder("memory");
    write_volumes("maps.nii", UINT8, VOLUMES, blobs);
    row_text(test_in("maps.csv"), "0,Background\n1,B\n2,C\n");
    test_every_allocation(load_maps, NULL);
    assert_true(test_every_primitive(load_or_refuse, NULL) > 5);
}

TEST_GROUP(named_maps)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_beside_the_file_names_its_volumes),
        cmocka_unit_test(a_given_table_does_so),
        cmocka_unit_test(the_background_is_no_area),
        cmocka_unit_test(without_names_one_volume_is_chosen),
        cmocka_unit_test(what_is_something_else_is_refused),
        cmocka_unit_test(what_is_stated_is_believed),
        cmocka_unit_test(one_map_is_taken_as_stated),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
