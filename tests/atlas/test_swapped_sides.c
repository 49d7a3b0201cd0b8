/* SPDX-License-Identifier: BSD-3-Clause */
/* Names of left and right areas, and where these lie. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "base/memory.h"
#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

/* Pairs A to E: along x each row of voxels has the two areas of one pair, one voxel each, at x = -3.5 and 2.5. */
static const struct area_row rows[] = {{1, "A_L", 0, NULL, 0},
                                       {2, "A_R", 0, NULL, 0},
                                       {3, "B_L", 0, NULL, 0},
                                       {4, "B_R", 0, NULL, 0},
                                       {5, "C_L", 0, NULL, 0},
                                       {6, "C_R", 0, NULL, 0},
                                       {7, "D_L", 0, NULL, 0},
                                       {8, "D_R", 0, NULL, 0},
                                       {9, "Middle", 0, NULL, 0},
                                       {10, "Right", 0, NULL, 0},
                                       {0}};

static const double mirror[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/* The first `pairs` pairs; the first `swapped` of them have left at the larger x. */
static conus_atlas *atlas_of(size_t pairs, size_t swapped)
{
    enum { WIDTH = 8, PAIRS = 4 };
    uint32_t labels[WIDTH * PAIRS] = {0};
    conus_atlas *atlas = NULL;
    for (uint32_t pair = 0; pair < pairs; pair++) {
        uint32_t *row = labels + (size_t)WIDTH * pair;
        row[0] = 2 * pair + 1 + (pair < swapped);
        row[6] = 2 * pair + 2 - (pair < swapped);
        row[7] = 9;
    }
    assert_ok(area_rows_atlas(&atlas, (const size_t[]){WIDTH, PAIRS, 1}, labels, rows));
    return atlas;
}

/* The note about an atlas, or "". Destroys the atlas. */
static const char *said(conus_atlas *atlas)
{
    static char text[400];
    size_t before = atlas->notes.count;
    assert_ok(conflicting_sides_note(atlas));
    snprintf(text, sizeof text, "%s", atlas->notes.count > before ? atlas->notes.lines[before] : "");
    const char *note = conus_atlas_exchanged(atlas);
    assert_string_equal(note ? note : "", text);
    conus_atlas_destroy(atlas);
    return text;
}

static void three_quarters_of_three_pairs_are_told(void **state)
{
    (void)state;
    assert_string_equal(said(atlas_of(4, 4)),
                        "4 of 4 pairs of a left and a right area lie the other way round, A_L (x 2.5 mm) to the right "
                        "of A_R (-3.5 mm): names or positions have left and right exchanged; --sides "
                        "exchanged mirrors the atlas");
    assert_non_null(strstr(said(atlas_of(4, 3)), "3 of 4 pairs"));
    assert_non_null(strstr(said(atlas_of(3, 3)), "3 of 3 pairs"));
    assert_string_equal(said(atlas_of(4, 2)), "");
    assert_string_equal(said(atlas_of(2, 2)), ""); /* too few to tell */
    assert_string_equal(said(atlas_of(4, 0)), "");
    assert_string_equal(said(atlas_of(0, 0)), "");
}

/* Right areas need only be right of left ones, also if all are on one side of x = 0. */
static void the_midline_does_not_matter(void **state)
{
    (void)state;
    conus_atlas *atlas = atlas_of(4, 0);
    assert_ok(atlas_move(atlas, (const double[16]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 500, 0, 0, 1}, "far"));
    assert_string_equal(said(atlas), "");
    atlas = atlas_of(4, 0);
    assert_ok(atlas_move(atlas, mirror, "mirror"));
    assert_non_null(strstr(said(atlas), "4 of 4 pairs"));
}

/* A grid of 128 x 128 rows of 64 voxels is sampled: every second row along y and z is enough for means. */
static void large_grids_are_sampled(void **state)
{
    (void)state;
    enum { X = 64, Y = 128, Z = 128 };
    const size_t dim[3] = {X, Y, Z};
    uint32_t *labels = memory_zeroed((size_t)X * Y * Z, sizeof *labels);
    assert_non_null(labels);
    for (size_t v = 0; v < (size_t)X * Y * Z; v++) {
        uint32_t pair = (uint32_t)(v / X / 8 % 4); /* eight rows each */
        labels[v] = 2 * pair + (v % X < X / 2 ? 2 : 1);
    }
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    memory_free(labels);
    assert_non_null(strstr(said(atlas), "4 of 4 pairs"));
}

/* The phantom's five pairs of surfaces are right; a mirror swaps them. Loading gives no note. */
static void surfaces_have_sides(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("sides"));
    assert_ok(conus_phantom_write("brain", folder, NULL));
    assert_ok(conus_atlas_load(&atlas, folder, NULL));
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        assert_null(strstr(conus_atlas_note(atlas, i), "the other way round"));
    }
    assert_ok(atlas_move(atlas, mirror, "mirror"));
    assert_non_null(strstr(said(atlas), "5 of 5 pairs"));
}

/* mricron's JHU labels call areas right that lie at negative x, which is left by its header; its AAL does not. */
static void real_atlases_are_told(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        bool wrong;
    } cases[] = {{"JHU-WhiteMatter-labels-2mm.nii.gz", true}, {"aal.nii.gz", false}, {"natbrainlab.nii.gz", false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = NULL;
        bool wrong = false;
        assert_ok(conus_atlas_load(&atlas, test_mricron(cases[i].file), NULL));
        for (size_t k = 0; k < conus_atlas_note_count(atlas); k++) {
            wrong = wrong || strstr(conus_atlas_note(atlas, k), "21 of 21 pairs");
        }
        assert_int_equal(wrong, cases[i].wrong);
        conus_atlas_destroy(atlas);
    }
}

/* Exchanged sides are mended in place: the grid and the brain stay, the note goes; it comes where they were right. */
static void exchanged_sides_are_mended(void **state)
{
    (void)state;
    for (size_t swapped = 0; swapped <= 4; swapped += 4) {
        conus_atlas *atlas = atlas_of(4, swapped);
        double low[2][3];
        double high[2][3];
        assert_ok(conflicting_sides_note(atlas));
        assert_int_equal(conus_atlas_exchanged(atlas) != NULL, swapped != 0);
        atlas->volumes[0].info.space_code = 4;
        assert_ok(conus_atlas_bounds(low[0], high[0], atlas));
        assert_ok(conus_atlas_exchange_sides(atlas));
        assert_int_equal(conus_atlas_exchanged(atlas) != NULL, swapped == 0);
        assert_true(swapped || strstr(conus_atlas_exchanged(atlas), "they are right without it"));
        assert_int_equal(conus_atlas_brain(atlas).brain, CONUS_BRAIN_MNI152);
        assert_false(conus_atlas_brain(atlas).is_moved);
        assert_ok(conus_atlas_bounds(low[1], high[1], atlas));
        assert_near(low[0][0], low[1][0], 1e-12);
        assert_near(high[0][0], high[1][0], 1e-12);
        for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
            assert_null(strstr(conus_atlas_note(atlas, i), " mirrors: "));
            assert_int_equal(conus_atlas_note_severity(atlas, i) == CONUS_SEVERITY_WARNING,
                             conus_atlas_note(atlas, i) == conus_atlas_exchanged(atlas));
        }
        assert_ok(conus_atlas_exchange_sides(atlas)); /* and back */
        assert_int_equal(conus_atlas_exchanged(atlas) != NULL, swapped != 0);
        assert_int_equal(conus_atlas_brain(atlas).brain, CONUS_BRAIN_MNI152);
        assert_false(conus_atlas_brain(atlas).is_moved);
        assert_ok(conus_atlas_move(atlas, mirror));
        assert_true(conus_atlas_brain(atlas).is_moved);
        conus_atlas_destroy(atlas);
    }
}

/* A table's column of sides may contradict its names. A lone letter without a counterpart is no side. */
static void names_against_the_column_of_sides_are_told(void **state)
{
    (void)state;
    static const struct {
        struct area_row rows[4];
        const char *said;
    } cases[] = {
        {{{1, "Hippocampus_L", 0, NULL, 'R'}, {2, "Hippocampus_R", 0, NULL, 'L'}, {3, "Middle", 0, NULL, 'B'}},
         "the label table gives 2 of 2 areas another side than their name, first Hippocampus_L, which it calls right: "
         "one of both is wrong; answers have the table's side"},
        {{{1, "A_L", 0, NULL, 'L'}, {2, "Left-vessel", 0, NULL, 'R'}},
         "1 of 2 areas another side than their name, first L"},
        {{{1, "A_L", 0, NULL, 'L'}, {2, "A_R", 0, NULL, 'R'}}, ""},
        {{{1, "Area L", 0, NULL, 'R'}, {2, "Area M", 0, NULL, 'R'}}, ""},
        {{{1, "Right of the left sulcus", 0, NULL, 'R'}, {2, "Left, by rh", 0, NULL, 'L'}}, ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_atlas *atlas = NULL;
        assert_ok(area_rows_atlas(&atlas, (const size_t[]){3, 1, 1}, (const uint32_t[]){1, 2, 3}, cases[i].rows));
        const char *said_of_it = "";
        assert_ok(conflicting_sides_note(atlas));
        for (size_t k = 0; k < conus_atlas_note_count(atlas); k++) {
            const char *each = conus_atlas_note(atlas, k);
            said_of_it = strstr(each, "another side than") ? each : said_of_it;
        }
        assert_non_null(strstr(said_of_it, cases[i].said));
        assert_int_equal(said_of_it[0] == 0, cases[i].said[0] == 0);
        conus_atlas_destroy(atlas);
    }
}

static conus_status note(void *data)
{
    return conflicting_sides_note(data);
}

/* What fails leaves the atlas as it was, its notes, too. */
static conus_status exchange(void *data)
{
    conus_atlas *atlas = data;
    const double at = atlas->volumes[0].info.world_from_voxel[12];
    const size_t count = conus_atlas_note_count(atlas);
    const char *said_before = conus_atlas_exchanged(atlas);
    conus_status status = conus_atlas_exchange_sides(atlas);
    if (status) {
        assert_true(atlas->volumes[0].info.world_from_voxel[12] == at && !atlas->is_moved);
        assert_int_equal(conus_atlas_note_count(atlas), count);
        assert_ptr_equal(conus_atlas_exchanged(atlas), said_before);
    }
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    conus_atlas *atlas = atlas_of(4, 4);
    atlas->objects[0].hemisphere = 'R';
    test_every_allocation(note, atlas);
    conus_atlas_destroy(atlas);
    for (size_t swapped = 0; swapped <= 4; swapped += 4) {
        atlas = atlas_of(4, swapped);
        assert_ok(conflicting_sides_note(atlas));
        test_every_allocation(exchange, atlas);
        conus_atlas_destroy(atlas);
    }
}

TEST_GROUP(swapped_sides)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_quarters_of_three_pairs_are_told),
        cmocka_unit_test(the_midline_does_not_matter),
        cmocka_unit_test(large_grids_are_sampled),
        cmocka_unit_test(surfaces_have_sides),
        cmocka_unit_test(real_atlases_are_told),
        cmocka_unit_test(exchanged_sides_are_mended),
        cmocka_unit_test(names_against_the_column_of_sides_are_told),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
