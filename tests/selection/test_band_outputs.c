/* SPDX-License-Identifier: BSD-3-Clause */
/* Outputs for bands of values: masks, lists of voxels, packed atlases, pictures' attributes. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "render/image/image.h"
#include "shells.h"
#include "test.h"
#include "value_maps.h"

#include <stdlib.h>
#include <string.h>

enum { DIM = SHELLS_DIM };

static conus_selection *select_ball(conus_selector **selector, const conus_atlas *atlas, const double centre[3],
                                    double radius)
{
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(selector, atlas, NULL));
    assert_ok(conus_select_ball(&selection, *selector, centre, radius));
    return selection;
}

/* Whether the voxel's centre is in the ball. */
static bool in_ball(const size_t at[3], const double centre[3], double radius)
{
    double square = 0;
    for (size_t a = 0; a < 3; a++) {
        double off = (double)at[a] - (DIM - 1) / 2.0 - centre[a];
        square += off * off;
    }
    return square <= radius * radius;
}

/* The outputs hold the band Middle only, although Core and Outer lie in the ball and in the same volume. */
static void masks_and_voxels_of_a_band_are_its_own(void **state)
{
    (void)state;
    static const double centre[3] = {11, 0.2, 0.1};
    conus_atlas *atlas = shells_atlas();
    conus_selector *selector = NULL;
    conus_report *report = NULL;
    conus_grid *mask = NULL;
    conus_grid *values = NULL;
    const char *rows;
    size_t size;
    conus_selection *selection = select_ball(&selector, atlas, centre, 9);
    assert_ok(conus_selection_grid(&mask, selection, &(conus_grid_options){.object = MIDDLE}));
    assert_ok(conus_selection_grid(&values, selection,
                                   &(conus_grid_options){.content = CONUS_GRID_MAP_OF_VALUES, .object = MIDDLE}));
    const uint8_t *in = conus_grid_data(mask).data;
    const float *map = conus_grid_data(values).data;
    size_t found[4] = {0};
    for (size_t v = 0; v < DIM * DIM * DIM; v++) {
        const size_t at[3] = {v % DIM, v / DIM % DIM, v / DIM / DIM};
        found[shell_of(at)] += in_ball(at, centre, 9);
        bool wanted = shell_of(at) == MIDDLE && in_ball(at, centre, 9);
        assert_int_equal(in[v], wanted);
        assert_true(map[v] == (wanted ? volume_value(&atlas->volumes[0], v) : 0));
    }
    assert_true(found[CORE] && found[MIDDLE] && found[OUTER]);
    assert_ok(conus_report_create(&report, selector, NULL));
    assert_ok(conus_report_add(report, "q", selection));
    assert_ok(conus_report_voxels(&rows, &size, report));
    size_t lines[4] = {0};
    for (const char *row = strchr(rows, '\n') + 1; *row; row = strchr(row, '\n') + 1) {
        const char *name = strchr(row, '\t') + 1;
        char *end = strchr(name, '\t');
        size_t at[3];
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = strtoul(end + 1, &end, 10);
        }
        uint32_t shell = shell_of(at);
        assert_int_equal(strncmp(name, shells[shell - 1].name, strlen(shells[shell - 1].name)), 0);
        lines[shell]++;
    }
    assert_memory_equal(lines + 1, found + 1, 3 * sizeof *lines);
    conus_report_destroy(report);
    conus_grid_destroy(mask);
    conus_grid_destroy(values);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* The shells, and before them an area whose probability falls from 1 in the middle to 0 at 20 mm. */
static conus_atlas *make_probable_shells(void)
{
    const conus_object area = {.kind = CONUS_KIND_AREA, .label = 7, .name = "Near", .abbreviation = ""};
    conus_atlas *bands = shells_atlas();
    conus_atlas *atlas = NULL;
    conus_volume_info info = bands->volumes[0].info;
    float *values = values_copy(&bands->volumes[0]);
    float *chances = memory_copy(values, (size_t)DIM * DIM * DIM, sizeof *chances);
    for (size_t v = 0; v < DIM * DIM * DIM; v++) {
        chances[v] = chances[v] < 20 ? 1 - chances[v] / 20 : 0;
    }
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    info.role = CONUS_ROLE_PROBABILITY;
    info.threshold = 0.25;
    assert_ok(area_of_values(atlas, &info, chances, &area));
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0;
    assert_ok(bands_of_values(atlas, &info, values, shells, 3));
    conus_atlas_destroy(bands);
    return atlas;
}

/* The rows of all layers of a cone, and the picture. */
static void answer(char **rows, conus_image **image, const conus_atlas *atlas)
{
    const conus_selector_options all = {.layers = CONUS_LAYERS_ALL};
    conus_selector *selector = NULL;
    const conus_report_options options = {.format = "tsv"};
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    const char *text;
    size_t size;
    conus_pose pose;
    assert_ok(conus_selector_create(&selector, atlas, &all));
    assert_ok(conus_pose_toward(&pose, (double[]){60, 20, 30}, (double[]){1, 2, 3}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.3)));
    assert_ok(conus_report_create(&report, selector, &options));
    assert_ok(conus_report_add(report, "q", selection));
    assert_ok(conus_report_text(&text, &size, report));
    assert_ok(conus_selection_image(image, selection));
    *rows = memory_text(text, size);
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
}

static void a_packed_atlas_has_bands_and_probabilities(void **state)
{
    (void)state;
    conus_atlas *atlas = make_probable_shells();
    conus_atlas *attached = NULL;
    conus_image *images[2];
    char *rows[2];
    size_t size = conus_atlas_packed_size(atlas);
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    assert_ok(conus_atlas_pack(memory, size, atlas));
    assert_ok(conus_atlas_attach(&attached, memory, size));
    answer(&rows[0], &images[0], atlas);
    answer(&rows[1], &images[1], attached);
    assert_string_equal(rows[0], rows[1]);
    for (uint32_t n = 1; n <= 4; n++) {
        assert_non_null(strstr(rows[0], conus_atlas_object(atlas, n)->name));
        assert_true(conus_atlas_object(attached, n)->is_band == (n > 1));
        assert_true(conus_atlas_object(attached, n)->high == conus_atlas_object(atlas, n)->high);
    }
    for (size_t i = 0; i < 2; i++) {
        assert_string_equal(image_find_attribute(images[i], "conus:volume0Threshold")->text, "0.25");
        assert_string_equal(image_find_attribute(images[i], "conus:volume1Bands")->text,
                            "low\thigh\tname\nn/a\t8\tCore\n8\t14\tMiddle\n14\t20\tOuter\n");
        assert_null(image_find_attribute(images[i], "conus:volume1Threshold"));
        conus_image_destroy(images[i]);
        memory_free(rows[i]);
    }
    conus_atlas_destroy(attached);
    free(memory);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(band_outputs)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(masks_and_voxels_of_a_band_are_its_own),
        cmocka_unit_test(a_packed_atlas_has_bands_and_probabilities),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
