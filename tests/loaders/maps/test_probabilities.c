/* SPDX-License-Identifier: BSD-3-Clause */
/* Probabilistic atlases: FSL atlas XMLs and "probabilities" of manifests. All expected numbers follow from the three
 * volumes of 4 x 1 x 1 voxels below. */
#include "atlas/atlas.h"
#include "builders/nifti_builder.h"
#include "conus/file.h"
#include "conus/overlap.h"
#include "render/colour/pathways.h"
#include "selection/selection.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* In percent: A reaches 25 % in voxels 2 and 3, B in 1 and 2, C nowhere; C's values alone could be taken for 0 to 1. */
static const double percent[3][4] = {{10, 24, 25, 80}, {0, 60, 90, 0}, {0, 0, 1, 0}};

static const char *xml(const char *type)
{
    static char text[512];
    snprintf(text, sizeof text,
             "<atlas><header><type>%s</type><images><imagefile>/maps</imagefile></images></header><data>"
             "<label index=\"0\">A</label><label index=\"1\">B</label><label index=\"2\">C</label></data></atlas>",
             type);
    return text;
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* The volumes divided by `divisor`, of 2 x 3 x 4 mm, the first voxel at (-10, -20, -30). */
static void write_maps(const char *path, int datatype, double divisor, size_t count)
{
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, datatype, (int64_t[]){4, 1, 1});
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, (double)count);
    for (size_t i = 0; i < 4 * count; i++) {
        nifti_voxel(&builder, percent[i / 4][i % 4] / divisor);
    }
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(builder.bytes.data, 1, builder.bytes.size, file), builder.bytes.size);
    assert_int_equal(fclose(file), 0);
    buffer_finish(&builder.bytes);
}

static conus_atlas *load(const char *name)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_in(name), NULL));
    return atlas;
}

static void assert_refused(const char *name, conus_status wanted, const char *words)
{
    conus_atlas *atlas = NULL;
    assert_fails(conus_atlas_load(&atlas, test_in(name), NULL), wanted);
    assert_null(atlas);
    if (!strstr(conus_message(), words)) {
        fail_msg("found \"%s\", wanted \"%s\"", conus_message(), words);
    }
}

static void assert_note(const conus_atlas *atlas, const char *words)
{
    for (size_t i = 0; conus_atlas_note(atlas, i); i++) {
        if (strstr(conus_atlas_note(atlas, i), words)) {
            return;
        }
    }
    fail_msg("no note says \"%s\"", words);
}

static void assert_maps(const conus_atlas *atlas)
{
    static const char *const names[] = {"A", "B", "C"};
    static const uint64_t voxels[] = {2, 2, 0};
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    for (uint32_t number = 1; number <= 3; number++) {
        const conus_object *area = conus_atlas_object(atlas, number);
        const conus_volume_info *info = conus_atlas_volume(atlas, area->volume);
        assert_int_equal(area->kind, CONUS_KIND_AREA);
        assert_int_equal(area->label, number);
        assert_string_equal(area->name, names[number - 1]);
        assert_int_equal(area->voxels, voxels[number - 1]);
        assert_near(area->volume_mm3, 24 * (double)voxels[number - 1], 1e-9);
        assert_near(info->threshold, 0.25, 0);
        for (size_t v = 0; v < 4; v++) {
            const double point[3] = {-10 + 2 * (double)v, -20, -30};
            assert_near(atlas_probability(atlas, number, point), percent[number - 1][v] / 100, 1e-7);
        }
    }
    assert_near(conus_atlas_volume(atlas, 0)->maximum, 0.8, 1e-7);
    assert_note(atlas, "C has no voxels: its largest probability is 0.01, the threshold 0.25");
}

static void an_fsl_atlas_has_areas(void **state)
{
    (void)state;
    test_folder("fsl");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    conus_atlas *atlas = load("a.xml");
    assert_maps(atlas);
    assert_note(atlas, "maps.nii: 3 areas by probabilities of 0.25 and more (values: percent)");
    conus_atlas_destroy(atlas);
    write_text(test_in("a.xml"), xml("Statistic"));
    atlas = load("a.xml");
    assert_maps(atlas);
    conus_atlas_destroy(atlas);
    atlas = NULL;
    const conus_load_options named = {.labels = test_in("a.xml")};
    assert_fails(conus_atlas_load(&atlas, test_in("a.xml"), &named), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "areas of probabilities have the names of the atlas XML"));
}

/* p of 500 of 1000 voxels is 1/500, 2/500 ... 1, so that 376 reach a quarter (125/500), as fractions, as codes of a
 * byte (64 of 255), in thousandths and in percent; the first `count` of the other voxels have the value `stray`. Stored
 * codes times a float32 scale come to 1.00000006, or 100.000002. The areas and a pathway see the same. */
static void the_spread_decides_about_the_scale(void **state)
{
    (void)state;
    enum { UINT8 = 2, INT16 = 4, FLOAT32 = 16, UINT16 = 512 };
    static const struct {
        int datatype;
        double slope, factor; /* a voxel is factor p + shift */
        double shift, stray;
        size_t count;
        uint64_t voxels; /* 0: refused, */
        const char *words;
    } cases[] = {
        {UINT8, 1.0 / 255, 255, 0, 0, 0, 376, "(values: 0 to 1)"},
        {UINT8, 100.0 / 255, 255, 0, 0, 0, 376, "(values: percent)"},
        {INT16, 0.001, 1000, 0, 0, 0, 376, "(values: 0 to 1)"},
        {UINT16, 1.0 / 65535, 65535, 0, 0, 0, 376, "(values: 0 to 1)"},
        {UINT8, 1, 255, 0, 0, 0, 376, "(values: 0 to 255)"},
        {UINT16, 1, 65535, 0, 0, 0, 376, "(values: 0 to 65535)"},
        {FLOAT32, 1, 1, 0, 0, 0, 376, "(values: 0 to 1)"},
        {FLOAT32, 1, 100, 0, 0, 0, 376, "(values: percent)"},
        {FLOAT32, 1, 1, 0, 1.02, 300, 676, ": 300 voxels have values below 0 or above the scale, 1 (from 0 to 1.0"},
        {FLOAT32, 1, 1, 0, -0.001, 1, 376, ": 1 voxels have values below 0 or above the scale, 1 (from -0.001"},
        {FLOAT32, 1, 1, 0, -0.05, 300, 376, ": 300 voxels have values below 0"},
        {FLOAT32, 1, 1, 0, 1.7, 1, 377, "(from 0 to 1.7"},
        {FLOAT32, 1, 1, 0, 250, 1, 377, "the scale, 1 (from 0 to 250)"},
        {FLOAT32, 1, 1, 0, 250, 5, 381, "the scale, 1 (from 0 to 250)"},
        {FLOAT32, 1, 100, 0, 101.5, 30, 406, ": 30 voxels have values below 0 or above the scale, 100"},
        {FLOAT32, 1, 100, 0, 250, 1, 377, "the scale, 100 (from 0 to 250)"},
        {FLOAT32, 1, 100, 0, -3, 40, 376, "the scale, 100 (from -3 to 100)"},
        {FLOAT32, 1, 1, 0, 40, 12, 0, "too many values above 1 for probabilities, and too few for percent"},
        {UINT8, 1, 100, 0, 250, 1, 0, "too few values above 100 for the range of uint8, and some for percent"},
        {UINT16, 1, 10000, 0, 60000, 1, 0, "its largest value is 60000"},
        {FLOAT32, 1, 1000, 0, 0, 0, 0, "its largest value is 1000"},
        {FLOAT32, 1, 10, -5, 0, 0, 0, "its least value is -4.98"},
    };
    test_folder("spread");
    write_text(test_in("m.atlas.json"), "{\"conus_atlas\": 1, \"probabilities\": [\"m.nii\"]}");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_builder builder;
        nifti_begin(&builder, 1, i % 2, cases[i].datatype, (int64_t[]){10, 10, 10});
        nifti_set(&builder, "scl_slope", 0, cases[i].slope);
        for (int v = 0; v < 1000; v++) {
            double p = v < 500 ? 0 : (v - 499) / 500.0;
            double value = v < 500 ? 0 : cases[i].factor * p + cases[i].shift;
            value = v < (int)cases[i].count ? cases[i].stray : value;
            nifti_voxel(&builder, cases[i].datatype == FLOAT32 ? value : rint(value));
        }
        assert_ok(conus_write_file(test_in("m.nii"), builder.bytes.data, builder.bytes.size));
        buffer_finish(&builder.bytes);
        if (!cases[i].voxels) {
            assert_refused("m.atlas.json", CONUS_ERROR_DATA, cases[i].words);
            continue;
        }
        conus_atlas *atlas = load("m.atlas.json");
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, cases[i].voxels);
        assert_note(atlas, cases[i].words);
        assert_near(conus_atlas_volume(atlas, 0)->maximum, 1, 1e-8);
        assert_near(conus_atlas_volume(atlas, 0)->minimum, 0, 0);
        conus_atlas_destroy(atlas);
        assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
        assert_ok(conus_atlas_add_pathway(atlas, test_in("m.nii"), NULL));
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, cases[i].voxels);
        conus_atlas_destroy(atlas);
    }
}

/* 40 of 10,000 voxels have 2.5 %, 5 % ... 100 %: 31 reach a quarter. All others are what a spline leaves of 0, in
 * float32, or the code next to 0, 0.15, where int8 has steps of 0.5 and an offset. They are 99.6 % of what is above 0.
 */
static void what_is_left_of_0_does_not_decide_about_the_scale(void **state)
{
    (void)state;
    test_folder("left");
    for (int is_coded = 0; is_coded < 2; is_coded++) {
        struct nifti_builder builder;
        nifti_begin(&builder, 1, false, is_coded ? 256 : 16, (int64_t[]){10, 10, 100});
        nifti_set(&builder, "scl_slope", 0, is_coded ? 0.5 : 1);
        nifti_set(&builder, "scl_inter", 0, is_coded ? 50.15 : 0);
        for (int v = 0; v < 10000; v++) {
            nifti_voxel(&builder, is_coded ? (v < 40 ? 5 * (v + 1) - 100 : -100) : (v < 40 ? 2.5 * (v + 1) : 1e-9));
        }
        assert_ok(conus_write_file(test_in("m_probseg.nii"), builder.bytes.data, builder.bytes.size));
        buffer_finish(&builder.bytes);
        conus_atlas *atlas = load("m_probseg.nii");
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 31);
        assert_note(atlas, "(values: percent)");
        conus_atlas_destroy(atlas);
        assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
        assert_ok(conus_atlas_add_pathway(atlas, test_in("m_probseg.nii"), NULL));
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 31);
        conus_atlas_destroy(atlas);
    }
}

/* The code times the scale that was meant is T; the scale in float32 makes it 2e-8 less, or more. That voxel belongs to
 * T and more, and not to what is below T. */
static void what_is_written_as_a_threshold_reaches_it(void **state)
{
    (void)state;
    static const struct {
        double slope;
        int code; /* of three voxels one; the others have one less and one more */
        double threshold;
    } cases[] = {{0.01, 30, 0.3}, {0.01, 60, 0.6}, {0.01, 80, 0.8}, {1.0 / 255, 51, 0.2},
                 {1.0 / 3, 3, 1}, {0.1, 70, 7},    {0.1, 3, 0.3}};
    test_folder("thresholds");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_builder builder;
        conus_atlas *atlas = NULL;
        conus_roi *roi = NULL;
        double t = cases[i].threshold;
        assert_near(cases[i].code * cases[i].slope, t, 1e-12);
        nifti_begin(&builder, 1, i % 2, 4, (int64_t[]){3, 1, 1});
        nifti_set(&builder, "scl_slope", 0, cases[i].slope);
        for (int k = -1; k <= 1; k++) {
            nifti_voxel(&builder, cases[i].code + k);
        }
        assert_ok(conus_write_file(test_in("t.nii"), builder.bytes.data, builder.bytes.size));
        buffer_finish(&builder.bytes);
        const conus_band bands[] = {{-INFINITY, t, "below"}, {t, INFINITY, "above"}};
        assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
        assert_ok(conus_atlas_add_pathway(atlas, test_in("t.nii"), &(conus_pathway_options){.threshold = t}));
        assert_ok(conus_atlas_add_pathway(atlas, test_in("t.nii"),
                                          &(conus_pathway_options){.bands = bands, .band_count = 2}));
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 2);
        assert_int_equal(conus_atlas_object(atlas, 2)->voxels, 1);
        assert_int_equal(conus_atlas_object(atlas, 3)->voxels, 2);
        assert_ok(conus_atlas_set_threshold(atlas, 1, t * (1 + 1e-5)));
        assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 1);
        conus_atlas_destroy(atlas);
        assert_ok(conus_roi_load(&roi, test_in("t.nii"), &(conus_roi_options){.threshold = t}));
        assert_int_equal(conus_roi_voxels(roi), 2);
        conus_roi_destroy(roi);
    }
}

static void scales_are_told_apart(void **state)
{
    (void)state;
    static const struct {
        int datatype;
        double divisor;
        const char *scale;
    } cases[] = {{2, 1, ""},
                 {16, 1, ""},
                 {16, 100, ""},
                 {64, 100, ""},
                 {2, 100.0 / 255, ", \"scale\": 255"},
                 {16, 0.1, ", \"scale\": 1000"}};
    test_folder("scales");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"m.nii\", \"names\": [\"A\", \"B\", \"C\"]%s}]}",
                 cases[i].scale);
        write_text(test_in("m.atlas.json"), text);
        write_maps(test_in("m.nii"), cases[i].datatype, cases[i].divisor, 3);
        conus_atlas *atlas = load("m.atlas.json");
        if (cases[i].datatype == 2 && cases[i].divisor != 1) { /* rounded to 255ths */
            assert_near(conus_atlas_volume(atlas, 0)->maximum, 204.0 / 255, 1e-12);
        } else {
            assert_maps(atlas);
        }
        conus_atlas_destroy(atlas);
    }
}

/* A map of 0, 1, half of the largest value, and that value. The value of certainty follows from the largest value and
 * from its type; NULL = from nothing, and the message names the largest value after slope and intercept. */
static void the_largest_value_decides_about_the_scale(void **state)
{
    (void)state;
    enum { UINT8 = 2, FLOAT32 = 16, UINT16 = 512 };
    static const struct {
        int datatype;
        double most, slope, intercept, scale;
    } cases[] = {{FLOAT32, 1, 1, 0, 1},        {UINT8, 100, 1, 0, 100},      {UINT8, 101, 1, 0, 255},
                 {UINT8, 200, 1, 0, 255},      {UINT8, 200, 1, 1, 0},        {UINT8, 200, 2, 0, 0},
                 {FLOAT32, 200, 1, 0, 0},      {UINT16, 200, 1, 0, 0},       {UINT16, 32767, 1, 0, 0},
                 {UINT16, 32768, 1, 0, 65535}, {UINT16, 60000, 1, 0, 65535}, {UINT16, 60000, 1, 5, 0}};
    test_folder("largest");
    write_text(test_in("m.atlas.json"),
               "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"m.nii\", \"names\": [\"A\"]}]}");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct nifti_builder builder;
        conus_atlas *atlas = NULL;
        nifti_begin(&builder, 1, false, cases[i].datatype, (int64_t[]){4, 1, 1});
        nifti_set(&builder, "scl_slope", 0, cases[i].slope);
        nifti_set(&builder, "scl_inter", 0, cases[i].intercept);
        for (int v = 0; v < 4; v++) {
            nifti_voxel(&builder, v < 2 ? v * cases[i].most / 4 : (v - 1) * cases[i].most / 2);
        }
        FILE *file = fopen(test_in("m.nii"), "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(builder.bytes.data, 1, builder.bytes.size, file), builder.bytes.size);
        assert_int_equal(fclose(file), 0);
        buffer_finish(&builder.bytes);
        if (cases[i].scale > 0) {
            atlas = load("m.atlas.json");
            assert_near(conus_atlas_volume(atlas, 0)->maximum, cases[i].most / cases[i].scale, 1e-12);
            conus_atlas_destroy(atlas);
        } else {
            assert_refused("m.atlas.json", CONUS_ERROR_DATA, "probabilities are 0 to 1, percent, or over the range");
        }
    }
}

/* Each volume but the empty first one, which is no area, holds 0 and one other value. As percent, 1 and 2 would be
 * below the threshold of 25. */
static const double numbers[4][4] = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 2, 2, 0}, {0, 0, 30, 30}};

static const char masks_xml[] =
    "<atlas><header><type>Probabilistic</type><images><imagefile>/masks</imagefile></images></header><data>"
    "<label index=\"0\">*.*.*.*.*</label><label index=\"1\">A</label><label index=\"2\">B</label>"
    "<label index=\"3\">C</label></data></atlas>";

static void write_masks(const char *path, double odd)
{
    struct nifti_builder builder;
    nifti_begin(&builder, 1, false, 16, (int64_t[]){4, 1, 1});
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, 4);
    for (size_t i = 0; i < 16; i++) {
        nifti_voxel(&builder, i == 15 ? odd : numbers[i / 4][i % 4]);
    }
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(builder.bytes.data, 1, builder.bytes.size, file), builder.bytes.size);
    assert_int_equal(fclose(file), 0);
    buffer_finish(&builder.bytes);
}

/* The voxels of each area are counted in `numbers`. */
static void masks_of_any_value_are_areas(void **state)
{
    (void)state;
    static const char *const names[] = {"A", "B", "C"};
    static const uint64_t voxels[] = {1, 2, 2};
    test_folder("masks");
    write_masks(test_in("masks.nii"), 30);
    write_text(test_in("a.xml"), masks_xml);
    conus_atlas *atlas = load("a.xml");
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    for (uint32_t number = 1; number <= 3; number++) {
        const conus_object *area = conus_atlas_object(atlas, number);
        assert_string_equal(area->name, names[number - 1]);
        assert_int_equal(area->label, number); /* index 0 is background, so a summary has the indices */
        assert_int_equal(area->voxels, voxels[number - 1]);
        assert_near(conus_atlas_volume(atlas, area->volume)->maximum, 1, 0);
    }
    assert_note(atlas, "volume 0 is left out: it is called *.*.*.*.*");
    assert_note(atlas, "masks.nii: 3 areas by probabilities of 0.25 and more (values: masks, since each volume has 0 "
                       "and one other value, taken for 1)");
    conus_atlas_destroy(atlas);
    write_masks(test_in("masks.nii"), 29); /* three values in one volume: these are percent */
    atlas = load("a.xml");
    assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 0);
    assert_int_equal(conus_atlas_object(atlas, 3)->voxels, 2);
    assert_note(atlas, "(values: percent)");
    conus_atlas_destroy(atlas);
}

/* The default threshold of percent, 25, is above 2: without the rule of masks there would be no pathway. */
static void a_mask_is_a_pathway(void **state)
{
    (void)state;
    test_folder("mask_pathway");
    write_masks(test_in("masks.nii"), 30);
    write_text(test_in("p.atlas.json"), "{\"conus_atlas\": 1, \"pathways\": [{\"file\": \"masks.nii\", \"volume\": 2,"
                                        " \"name\": \"B\"}]}");
    conus_atlas *atlas = load("p.atlas.json");
    assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 2);
    assert_note(atlas, "pathway B: 0 and one other value, taken as a mask; threshold 0.5");
    conus_atlas_destroy(atlas);
}

/* The labels of a second entry follow those of the first, and a chosen volume has the next one. */
static void entries_follow_each_other(void **state)
{
    (void)state;
    test_folder("entries");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_maps(test_in("one.nii"), 2, 1, 1);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    write_text(test_in("m.atlas.json"),
               "{\"conus_atlas\": 1, \"probabilities\": [{\"fsl\": \"a.xml\", \"threshold\": 0.1}, \"one.nii\","
               "{\"file\": \"maps.nii\", \"volume\": 1, \"name\": \"again\", \"threshold\": 0.9}],"
               " \"pathways\": [{\"file\": \"one.nii\", \"name\": \"tract\", \"threshold\": 80}], \"threshold\": 24}");
    conus_atlas *atlas = load("m.atlas.json");
    static const struct {
        const char *name;
        uint32_t label;
        uint64_t voxels;
    } wanted[] = {{"A", 1, 4}, {"B", 2, 2}, {"C", 3, 0}, {"one", 4, 2}, {"again", 5, 1}, {"tract", 1, 1}};
    assert_int_equal(conus_atlas_object_count(atlas), 6);
    for (uint32_t number = 1; number <= 6; number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        assert_string_equal(object->name, wanted[number - 1].name);
        assert_int_equal(object->label, wanted[number - 1].label);
        assert_int_equal(object->voxels, wanted[number - 1].voxels);
        assert_int_equal(object->kind, number < 6 ? CONUS_KIND_AREA : CONUS_KIND_PATHWAY);
    }
    conus_atlas_destroy(atlas);
}

static void what_is_no_probability_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *entry, *words;
    } cases[] = {
        {"{\"file\": \"neg.nii\"}", "neg.nii: its least value is -8, no probability is below 0"},
        {"{\"file\": \"big.nii\"}", "big.nii: its largest value is 800, probabilities are 0 to 1, percent, or over"},
        {"{\"file\": \"big.nii\", \"scale\": 500}", "its largest value is 800, allowed is up to the scale, 500"},
        {"{\"file\": \"maps.nii\"}", "maps.nii: has 3 volumes: names (one for each), fsl or volume is needed"},
        {"{\"file\": \"maps.nii\", \"names\": [\"A\"]}", "maps.nii: has 3 volumes: names"},
        {"{\"file\": \"maps.nii\", \"volume\": 3}", "volume"},
        {"{\"file\": \"big.nii\", \"threshold\": 25}", "probabilities[0].threshold: is 25, a probability is up to 1"},
        {"{\"fsl\": \"label.xml\"}", "is of type Label"},
        {"{\"name\": \"x\"}", "probabilities[0]: file or fsl is missing"},
        {"\"big.nii\"], \"parcellation\": \"big.nii\", \"pathways\": [\"big.nii\"",
         "has probabilities and a parcellation"},
        {"\"big.nii\"], \"areas\": [\"s.gii\"", "has probabilities and areas"},
        {"\"maps.nii\"], \"pathways\": [{\"file\": \"maps.nii\", \"scale\": 1}",
         "pathways[0].scale: is for probabilities"},
    };
    test_folder("refused");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_maps(test_in("neg.nii"), 16, -10, 1);
    write_maps(test_in("big.nii"), 16, 0.1, 1);
    write_text(test_in("label.xml"), xml("Label"));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, "{\"conus_atlas\": 1, \"probabilities\": [%s]}", cases[i].entry);
        write_text(test_in("m.atlas.json"), text);
        assert_refused("m.atlas.json", CONUS_ERROR_DATA, cases[i].words);
    }
}

/* Both ends of the cylinder lie outside: it holds all four centres. A's voxels are 2 and 3, B's 1 and 2. */
static void overlapping_areas_are_all_reported(void **state)
{
    (void)state;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    test_folder("overlap");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    conus_atlas *atlas = load("a.xml");
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 0.5, .resolution = 1};
    assert_ok(conus_pose_along(&pose, (double[]){-30, -20, -30}, (double[]){1, 0, 0}, NULL));
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    const conus_result *b = conus_selection_result(selection, 0); /* from x = -9 on, 21 mm away */
    const conus_result *a = conus_selection_result(selection, 1); /* from x = -7 on */
    assert_int_equal(b->object, 2);
    assert_near(b->share, 1, 1e-12);
    assert_near(b->distance, 21, 1e-9);
    assert_near(b->mean_value, 0.75, 1e-7);
    assert_near(b->max_value, 0.9, 1e-7);
    assert_near(b->contact_value, 0.6, 1e-7); /* voxel 1 */
    assert_near(b->exit, 25, 1e-9);
    assert_int_equal(a->object, 1);
    assert_int_equal(a->pixels, 0);
    assert_near(a->entry, 23, 1e-9);
    assert_near(a->exit, 27, 1e-9);
    assert_near(a->mean_value, (0.25 + 0.8) / 2, 1e-7);
    assert_near(a->max_value, 0.8, 1e-7);
    assert_true(isnan(a->contact_value));      /* occluded: it has no contact */
    assert_near(a->cone_fraction, 0.5, 1e-12); /* 48 of 96 mm^3: voxel 2 counts for both */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    assert_ok(conus_atlas_show(atlas, "A", NULL));
    assert_ok(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    assert_int_equal(conus_selection_result(selection, 0)->object, 1);
    assert_near(conus_selection_result(selection, 0)->distance, 23, 1e-9);
    assert_near(conus_selection_result(selection, 0)->contact_value, 0.25, 1e-7); /* voxel 2 */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Voxel 2 is A's with 0.25 and B's with 0.9, whichever comes first in the atlas. */
static void pictures_show_the_most_probable(void **state)
{
    (void)state;
    static const char *const orders[] = {"0}, {\"file\": \"maps.nii\", \"volume\": 1",
                                         "1}, {\"file\": \"maps.nii\", \"volume\": 0"};
    static const uint32_t wanted[][4] = {{0, 2, 2, 1}, {0, 1, 1, 2}};
    const conus_cut_view view = {.centre = {-7, -20, -30}, .mm_per_pixel = 2, .width = 4, .height = 1};
    test_folder("pictures");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    for (size_t i = 0; i < 2; i++) {
        char text[256];
        uint8_t rgba[16];
        uint32_t objects[4];
        struct volume joint;
        snprintf(text, sizeof text,
                 "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"maps.nii\", \"volume\": %s}]}", orders[i]);
        write_text(test_in("m.atlas.json"), text);
        conus_atlas *atlas = load("m.atlas.json");
        assert_ok(conus_cut(rgba, objects, atlas, &view));
        assert_memory_equal(objects, wanted[i], sizeof objects);
        assert_ok(pathways_join(&joint, atlas, NULL, NULL));
        assert_int_equal(joint.voxel_count, 4);
        assert_memory_equal(joint.objects32, wanted[i], sizeof objects);
        volume_finish(&joint);
        conus_atlas_destroy(atlas);
    }
}

static void what_needs_labels_is_refused(void **state)
{
    (void)state;
    test_folder("labels");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    conus_atlas *atlas = load("a.xml");
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_UNSUPPORTED);
    assert_non_null(strstr(conus_message(), "areas of probabilities overlap"));
    assert_fails(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_MERGED), CONUS_ERROR_UNSUPPORTED);
    assert_ok(conus_atlas_set_threshold(atlas, 2, 0.7));
    assert_int_equal(conus_atlas_object(atlas, 2)->voxels, 1);
    conus_atlas_destroy(atlas);
}

/* In percent: A has one voxel of 60 and more, B two. 0.6 as a float is below 0.6, and so is the value. */
static void the_threshold_is_asked_for(void **state)
{
    (void)state;
    static const double wrong[] = {-0.1, 1.01, NAN};
    conus_load_options options = {.probability = 0.6};
    conus_atlas *atlas = NULL;
    test_folder("asked");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    assert_ok(conus_atlas_load(&atlas, test_in("a.xml"), &options));
    assert_int_equal(conus_atlas_object(atlas, 1)->voxels, 1);
    assert_int_equal(conus_atlas_object(atlas, 2)->voxels, 2);
    assert_near(conus_atlas_volume(atlas, 0)->threshold, 0.6, 0);
    conus_atlas_destroy(atlas);
    atlas = NULL;
    for (size_t i = 0; i < 3; i++) {
        options.probability = wrong[i];
        assert_fails(conus_atlas_load(&atlas, test_in("a.xml"), &options), CONUS_ERROR_ARGUMENT);
        assert_null(atlas);
    }
    options.probability = 0.5; /* a pathway of a manifest is no area */
    write_text(test_in("p.atlas.json"), "{\"conus_atlas\": 1, \"pathways\": [{\"fsl\": \"a.xml\"}]}");
    assert_fails(conus_atlas_load(&atlas, test_in("p.atlas.json"), &options), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "--probability 0.5: "));
    assert_non_null(strstr(conus_message(), "p.atlas.json has no areas of probabilities"));
    assert_null(atlas);
}

static conus_status load_any(void *name)
{
    conus_atlas *atlas = NULL;
    conus_status status = conus_atlas_load(&atlas, test_in(name), NULL);
    conus_atlas_destroy(atlas);
    return status;
}

/* Where a primitive of an attempt fails as data, the next reader may refuse the file for a reason of its own. */
static conus_status load_or_refuse(void *name)
{
    conus_status status = load_any(name);
    return status == CONUS_ERROR_UNSUPPORTED ? CONUS_ERROR_DATA : status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    test_folder("memory");
    write_maps(test_in("maps.nii"), 2, 1, 3);
    write_text(test_in("a.xml"), xml("Probabilistic"));
    write_text(test_in("m.atlas.json"), "{\"conus_atlas\": 1, \"probabilities\": [{\"file\": \"maps.nii\", \"names\": "
                                        "[\"A\", \"B\", \"C\"]}, {\"file\": \"maps.nii\", \"volume\": 1}]}");
    test_every_allocation(load_any, "a.xml");
    assert_true(test_every_primitive(load_or_refuse, "a.xml") > 5);
    test_every_allocation(load_any, "m.atlas.json");
    assert_true(test_every_primitive(load_any, "m.atlas.json") > 5);
}

TEST_GROUP(probabilities)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_fsl_atlas_has_areas),
        cmocka_unit_test(scales_are_told_apart),
        cmocka_unit_test(the_spread_decides_about_the_scale),
        cmocka_unit_test(what_is_left_of_0_does_not_decide_about_the_scale),
        cmocka_unit_test(what_is_written_as_a_threshold_reaches_it),
        cmocka_unit_test(the_largest_value_decides_about_the_scale),
        cmocka_unit_test(masks_of_any_value_are_areas),
        cmocka_unit_test(a_mask_is_a_pathway),
        cmocka_unit_test(entries_follow_each_other),
        cmocka_unit_test(what_is_no_probability_is_refused),
        cmocka_unit_test(overlapping_areas_are_all_reported),
        cmocka_unit_test(pictures_show_the_most_probable),
        cmocka_unit_test(what_needs_labels_is_refused),
        cmocka_unit_test(the_threshold_is_asked_for),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
