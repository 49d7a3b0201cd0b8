/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_use_safe_colours(): areas that touch differ, a left area and its right one are alike. */
#include "atlas/atlas.h"
#include "builders/area_rows.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { RING = 22, NAME = 32 };

static bool alike(const conus_atlas *atlas, uint32_t a, uint32_t b)
{
    return memcmp(atlas->objects[a - 1].rgb, atlas->objects[b - 1].rgb, 3) == 0;
}

/* Whether two areas are a pair such as Precentral_L and Precentral_R. */
static bool is_pair(const conus_atlas *atlas, uint32_t a, uint32_t b)
{
    const char *one = atlas->objects[a - 1].name;
    const char *other = atlas->objects[b - 1].name;
    size_t length = strlen(one);
    return length == strlen(other) && strncmp(one, other, length - 1) == 0 && one[length - 1] != other[length - 1] &&
           strchr("LR", one[length - 1]) && strchr("LR", other[length - 1]);
}

/* Areas whose colours would repeat with the palette's hues lie beside each other: 22 in a ring, of which the first and
 * the last touch, as each and the next do. A voxel without an area lies between each two. */
static void areas_in_a_ring_differ(void **state)
{
    (void)state;
    static const size_t dim[3] = {RING * 2, 3, 1};
    uint32_t labels[RING * 2 * 3] = {0};
    struct area_row rows[RING + 1] = {{0}};
    conus_atlas *atlas = NULL;
    for (uint32_t n = 0; n < RING; n++) {
        rows[n] = (struct area_row){n + 1, "Area", 0, NULL, 0};
        labels[2 * n] = n + 1;
    }
    labels[RING * 4] = RING; /* two voxels beside the first one */
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    conus_atlas_use_safe_colours(atlas);
    for (uint32_t n = 1; n <= RING; n++) {
        assert_false(alike(atlas, n, n % RING + 1));
    }
    conus_atlas_destroy(atlas);
}

/* Three colours are enough for a ring of 22 areas, and stay unchanged; so are two, since 22 is even. The atlas's own
 * colours come back also after two palettes. */
static void a_palette_has_the_colours_that_are_given(void **state)
{
    (void)state;
    static const uint8_t colours[3][3] = {{10, 20, 30}, {200, 40, 60}, {0, 255, 128}};
    static const size_t dim[3] = {RING * 2, 2, 1};
    uint32_t labels[RING * 2 * 2] = {0};
    uint8_t own[RING][3];
    struct area_row rows[RING + 1] = {{0}};
    conus_atlas *atlas = NULL;
    for (uint32_t n = 0; n < RING; n++) {
        rows[n] = (struct area_row){n + 1, "Area", 0, NULL, 0};
        labels[2 * n] = n + 1;
    }
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    for (uint32_t n = 0; n < RING; n++) {
        memcpy(own[n], atlas->objects[n].rgb, 3);
    }
    for (size_t count = 3; count >= 2; count--) {
        assert_ok(conus_atlas_use_palette(atlas, colours[0], count));
        for (uint32_t n = 1; n <= RING; n++) {
            bool found = false;
            for (size_t c = 0; c < count; c++) {
                found = found || memcmp(atlas->objects[n - 1].rgb, colours[c], 3) == 0;
            }
            assert_true(found && (n == RING || !alike(atlas, n, n + 1)));
        }
    }
    assert_fails(conus_atlas_use_palette(atlas, colours[0], 0), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_use_palette(atlas, colours[0], 81), CONUS_ERROR_ARGUMENT);
    conus_atlas_use_own_colours(atlas);
    for (uint32_t n = 0; n < RING; n++) {
        assert_memory_equal(atlas->objects[n].rgb, own[n], 3);
    }
    conus_atlas_destroy(atlas);
}

/* A box of 4 mm about a point. */
static void add_box(conus_atlas *atlas, uint32_t label, const double at[3])
{
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    char name[NAME];
    struct mesh mesh;
    snprintf(name, sizeof name, "Box %u", label);
    assert_ok(mesh_init(&mesh, 8, 12));
    for (size_t v = 0; v < 8; v++) {
        for (size_t a = 0; a < 3; a++) {
            mesh.positions[3 * v + a] = (float)(at[a] + (v >> a & 1 ? 2 : -2));
        }
    }
    memcpy(mesh.triangles, faces, sizeof faces);
    const conus_object area = {.label = label, .name = name, .abbreviation = ""};
    assert_ok(atlas_add_mesh(atlas, &area, &mesh));
}

/* The same ring of surfaces, each 0.3 mm from the next or less. */
static void surfaces_in_a_ring_differ(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create_empty(&atlas, ""));
    const double radius = 4.2 / 2 / sin(acos(-1) / RING);
    for (uint32_t n = 0; n < RING; n++) {
        double angle = 2 * acos(-1) * n / RING;
        add_box(atlas, n + 1, (double[]){radius * cos(angle), radius * sin(angle), 0});
    }
    conus_atlas_use_safe_colours(atlas);
    for (uint32_t n = 1; n <= RING; n++) {
        assert_false(alike(atlas, n, n % RING + 1));
    }
    conus_atlas_destroy(atlas);
}

/* Only areas 1 to 4 of this tree have voxels: 1 touches 2, and 3 touches 4. So groups 11 (1, 3) and 12 (2, 4) touch. */
static void groups_differ_where_what_is_below_them_touches(void **state)
{
    (void)state;
    static const size_t dim[3] = {8, 1, 1};
    static const uint32_t labels[8] = {1, 2, 0, 0, 0, 3, 4, 0};
    static const struct area_row rows[] = {{1, "A", 11, NULL, 0},
                                           {2, "B", 12, NULL, 0},
                                           {3, "C", 11, NULL, 0},
                                           {4, "D", 12, NULL, 0},
                                           {11, "E", 0, NULL, 0},
                                           {12, "F", 0, NULL, 0},
                                           {0}};
    conus_atlas *atlas = NULL;
    assert_ok(area_rows_atlas(&atlas, dim, labels, rows));
    conus_atlas_use_safe_colours(atlas);
    assert_false(alike(atlas, area_rows_number(atlas, "E"), area_rows_number(atlas, "F")));
    assert_false(alike(atlas, area_rows_number(atlas, "A"), area_rows_number(atlas, "B")));
    assert_false(alike(atlas, area_rows_number(atlas, "C"), area_rows_number(atlas, "D")));
    conus_atlas_destroy(atlas);
}

/* Looks at every two voxels with a common face. */
static void no_two_areas_of_aal_that_touch_are_alike(void **state)
{
    (void)state;
    conus_atlas *atlas = NULL;
    size_t contacts = 0;
    size_t pairs = 0;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    conus_atlas_use_safe_colours(atlas);
    const struct volume *volume = atlas_parcellation(atlas);
    const size_t *dim = volume->info.dim;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        const size_t next[3] = {v % dim[0] + 1 < dim[0] ? 1 : 0, v / dim[0] % dim[1] + 1 < dim[1] ? dim[0] : 0,
                                v / dim[0] / dim[1] + 1 < dim[2] ? dim[0] * dim[1] : 0};
        for (int a = 0; a < 3; a++) {
            uint32_t one = volume_object(volume, v);
            uint32_t other = volume_object(volume, v + next[a]);
            if (one && other && one != other && !is_pair(atlas, one, other)) {
                assert_false(alike(atlas, one, other));
                contacts++;
            }
        }
    }
    for (uint32_t one = 1; one <= atlas->area_count; one++) {
        for (uint32_t other = one + 1; other <= atlas->area_count; other++) {
            if (is_pair(atlas, one, other)) {
                assert_true(alike(atlas, one, other));
                pairs++;
            }
        }
    }
    assert_true(contacts > 10000);
    assert_int_equal(pairs, 54); /* all of AAL's 116 but the eight of the vermis */
    conus_atlas_destroy(atlas);
}

TEST_GROUP(safe_colours)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_in_a_ring_differ),
        cmocka_unit_test(a_palette_has_the_colours_that_are_given),
        cmocka_unit_test(surfaces_in_a_ring_differ),
        cmocka_unit_test(groups_differ_where_what_is_below_them_touches),
        cmocka_unit_test(no_two_areas_of_aal_that_touch_are_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
