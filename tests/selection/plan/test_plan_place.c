/* SPDX-License-Identifier: BSD-3-Clause */
/* Places in atlases whose points are known: inner points, sides, positions, and what is refused with the way on. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "builders/area_rows.h"
#include "conus/own.h"
#include "poses/pose_stream.h"
#include "poses/rows/pose_row.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { X = 24, Y = 10, Z = 10 };

/* Blocks on a grid of 1 mm, whose middle, at x = 0, lies between two voxels. */
static const struct area_row rows[] = {
    {1, "Core_L", 0, "CO.L", 0}, /* x -10.5 to -4.5 */
    {2, "Core_R", 0, "CO.R", 0}, /* its mirror image */
    {3, "Both", 0, NULL, 0},     /* two blocks of 2 x 3 x 3 voxels at x -2.5, -1.5 and 1.5, 2.5 */
    {4, "Vermis", 0, NULL, 0},   /* x -2.5 to 2.5 */
    {5, "Area Fp1 left", 0, NULL, 0}, {6, "L_A1_ROI", 0, NULL, 0},
    {7, "R_A1_ROI", 0, NULL, 0},      {8, "Group", 0, NULL, 0},
    {9, "1, 2, 3", 8, NULL, 0},       {10, "Bowl", 8, NULL, 0}, /* a ring without its middle */
    {11, "C3", 0, NULL, 0},           {0},
};

static bool is_in(size_t at[3], size_t x0, size_t x1, size_t y0, size_t y1, size_t z0, size_t z1)
{
    return at[0] >= x0 && at[0] <= x1 && at[1] >= y0 && at[1] <= y1 && at[2] >= z0 && at[2] <= z1;
}

static uint32_t label_at(size_t at[3])
{
    return is_in(at, 1, 7, 0, 4, 0, 4)                                     ? 1
           : is_in(at, 16, 22, 0, 4, 0, 4)                                 ? 2
           : is_in(at, 9, 10, 0, 2, 0, 2) || is_in(at, 13, 14, 0, 2, 0, 2) ? 3
           : is_in(at, 9, 14, 0, 4, 4, 8)                                  ? 4
           : is_in(at, 0, 2, 6, 8, 0, 2)                                   ? 5
           : is_in(at, 0, 2, 6, 8, 4, 6)                                   ? 6
           : is_in(at, 20, 22, 6, 8, 4, 6)                                 ? 7
           : is_in(at, 4, 6, 6, 8, 0, 2)                                   ? 9
           : is_in(at, 4, 8, 5, 9, 5, 5) && !is_in(at, 5, 7, 6, 8, 5, 5)   ? 10
           : is_in(at, 18, 18, 9, 9, 0, 0)                                 ? 11
                                                                           : 0;
}

static conus_atlas *atlas;

static void make_atlas(conus_atlas **out)
{
    static uint32_t labels[X * Y * Z];
    for (size_t i = 0; i < X * Y * Z; i++) {
        labels[i] = label_at((size_t[]){i % X, i / X % Y, i / X / Y});
    }
    assert_ok(area_rows_atlas(out, (const size_t[]){X, Y, Z}, labels, rows));
}

static int open_atlas(void **state)
{
    (void)state;
    make_atlas(&atlas);
    return 0;
}

static int close_atlas(void **state)
{
    (void)state;
    conus_atlas_destroy(atlas);
    return 0;
}

/* Moves the voxels: x of the first one's centre, and of the next. */
static void place_voxels(conus_atlas *own, double first, double step)
{
    struct volume *volume = &own->volumes[0];
    volume->info.world_from_voxel[0] = step;
    volume->info.world_from_voxel[12] = first;
    assert_true(mat4_invert_affine(volume->voxel_from_world, volume->info.world_from_voxel));
}

static void say_space(const char *transform, int code)
{
    atlas->volumes[0].info.space_code = code;
    snprintf(atlas->volumes[0].info.transform, sizeof atlas->volumes[0].info.transform, "%s", transform);
}

static void assert_place(const char *text, double x, double y, double z, const char *said)
{
    conus_place place;
    char words[CONUS_PLACE_TEXT];
    if (conus_place_find(&place, atlas, text, NULL)) {
        fail_msg("%s: %s", text, conus_message());
    }
    conus_place_text(words, &place, NULL);
    if (place.point[0] != x || place.point[1] != y || place.point[2] != z || strcmp(words, said) != 0) {
        fail_msg("%s: (%g, %g, %g), %s", text, place.point[0], place.point[1], place.point[2], words);
    }
}

static void refuse_place(const char *text, const char *message)
{
    conus_place place = {.object = 77};
    assert_fails(conus_place_find(&place, atlas, text, NULL), CONUS_ERROR_ARGUMENT);
    assert_int_equal(place.object, 77);
    if (!strstr(conus_message(), message)) {
        fail_msg("%s: said %s", text, conus_message());
    }
}

static void an_area_has_its_inner_point(void **state)
{
    (void)state;
    assert_place("-1,2,3", -1, 2, 3, "(-1.0, 2.0, 3.0)");
    /* 7 x 5 x 5: five voxels are 3 mm deep; that in the middle is the centroid. */
    assert_place("Core_L", -7.5, -2.5, -2.5, "Core_L: (-7.5, -2.5, -2.5), 3.0 mm inside");
    assert_place("right core", 7.5, -2.5, -2.5, "Core_R: (7.5, -2.5, -2.5), 3.0 mm inside");
    assert_place("index:2", 7.5, -2.5, -2.5, "Core_R: (7.5, -2.5, -2.5), 3.0 mm inside");
    assert_place("centroid:core l", -7.5, -2.5, -2.5, "the centroid of Core_L: (-7.5, -2.5, -2.5)");
    /* All of the ring are a voxel deep; the nearest to its middle, the first of four. */
    assert_place("Bowl", -5.5, 0.5, 0.5, "Bowl: (-5.5, 0.5, 0.5), 1.0 mm inside");
    /* All below a group is it. */
    assert_place("Group", -6.5, 2.5, -3.5, "Group: (-6.5, 2.5, -3.5), 2.0 mm inside");
    refuse_place("centroid:Bowl", "the centroid of Bowl, (-5.5, 2.5, 0.5), is not in it; \"Bowl\" alone is its inner");
    refuse_place("core", "\"Core_L\" (1), \"Core_R\" (2)");
    refuse_place("index:77", "no area has this label");
    refuse_place("Cores", "did you mean");
    refuse_place("1 2", "it has two numbers, a point has three");
    refuse_place("near:Core_L", "there is none");
    refuse_place("1 2 3 4", "\"4\" is a number too many");
}

static void what_is_hidden_has_the_same(void **state)
{
    (void)state;
    assert_ok(conus_atlas_show(atlas, "Core_R", NULL));
    an_area_has_its_inner_point(state);
    assert_ok(conus_atlas_show(atlas, NULL, NULL));
}

static void an_area_on_both_sides_is_refused(void **state)
{
    (void)state;
    refuse_place("Both", "Both lies on both sides: 0.02 cm3 left, 0.02 cm3 right; type --hemispheres split, and as the "
                         "name \"Both left\" "
                         "or \"Both right\"");
    assert_null(strstr(conus_message(), "near:"));
    refuse_place("centroid:Both", "Both lies on both sides"); /* its inner point is no advice */
    const conus_place_options options = {.has_axis = true};
    conus_place place;
    conus_selector *selector = NULL;
    conus_sites *sites = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_fails(conus_sites_find(&sites, selector, "Both", CONUS_SITES_DEEPEST), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "Both lies on both sides: 0.02 cm3 left, 0.02 cm3 right"));
    assert_ok(conus_sites_find(&sites, selector, "Core_L,Core_R", CONUS_SITES_DEEPEST)); /* both are named */
    conus_sites_destroy(sites);
    assert_ok(conus_sites_find(&sites, selector, "Vermis", CONUS_SITES_DEEPEST));
    conus_sites_destroy(sites);
    conus_selector_destroy(selector);
    assert_fails(conus_place_find(&place, atlas, "Both", &options), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "; near:Both is its point nearest to the other end"));
    /* 6 x 5 x 5, whose deepest are 0.5 mm from the midline, less than half of 3 mm; the first of two. */
    assert_place("vermis", -0.5, -2.5, 1.5, "Vermis: (-0.5, -2.5, 1.5), 3.0 mm inside");
    refuse_place("left both", "has no sides here");
    conus_atlas *split = NULL;
    make_atlas(&split);
    assert_ok(conus_atlas_set_hemispheres(split, CONUS_HEMISPHERES_SPLIT));
    assert_ok(conus_place_find(&place, split, "left both", NULL));
    assert_true(place.point[0] < 0);
    assert_fails(conus_place_find(&place, split, "Both", NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "is cut in two"));
    conus_atlas_destroy(split);
}

/* 22 % of it lie on the left, and its inner point is half its depth from the midline: that is not near. */
static void an_area_beside_the_midline_is_refused(void **state)
{
    (void)state;
    static const struct area_row some[] = {
        {1, "Wide", 0, NULL, 0}, {2, "A_L", 0, NULL, 0}, {3, "A_R", 0, NULL, 0}, {0}};
    static uint32_t labels[14 * 11 * 9];
    for (size_t i = 0; i < 14 * 11 * 9; i++) {
        labels[i] = i % 14 >= 5 && i / 14 % 11 < 9 ? 1 : i / 14 % 11 == 10 ? 2 + (i % 14 > 6) : 0;
    }
    conus_atlas *own = NULL;
    conus_place place;
    assert_ok(area_rows_atlas(&own, (const size_t[]){14, 11, 9}, labels, some));
    assert_fails(conus_place_find(&place, own, "Wide", NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "Wide lies on both sides"));
    assert_ok(conus_place_find(&place, own, "left a", NULL));
    conus_atlas_destroy(own);
}

/* An atlas without any side has areas of both sides that lie across the midline: none has an inner point. */
static void without_sides_the_midline_is_no_excuse(void **state)
{
    (void)state;
    static const struct area_row one[] = {{1, "Gyrus", 0, NULL, 0}, {0}};
    static uint32_t labels[6 * 5 * 5];
    for (size_t i = 0; i < 6 * 5 * 5; i++) {
        labels[i] = 1;
    }
    conus_atlas *own = NULL;
    conus_place place;
    assert_ok(area_rows_atlas(&own, (const size_t[]){6, 5, 5}, labels, one));
    assert_fails(conus_place_find(&place, own, "Gyrus", NULL), CONUS_ERROR_ARGUMENT);
    assert_string_equal(
        conus_message(),
        "Gyrus lies on both sides: 0.07 cm3 left, 0.07 cm3 right; type --hemispheres split, and as the "
        "name \"Gyrus left\" or \"Gyrus right\"; centroid:Gyrus is one point of it, in the middle of all");
    assert_ok(conus_place_find(&place, own, "centroid:Gyrus", NULL));
    assert_true(place.point[0] == 0);
    conus_atlas_destroy(own);
}

/* BrainGlobe's rats and fish count x from a corner of the grid, and their areas lie on both sides of its middle. */
static void where_left_ends_may_not_be_known(void **state)
{
    (void)state;
    static const struct area_row some[] = {
        {1, "Cortex", 0, NULL, 0}, {2, "Core_L", 0, NULL, 0}, {3, "Core_R", 0, NULL, 0}, {0}};
    static uint32_t labels[12 * 3 * 3];
    for (size_t i = 0; i < 12 * 3 * 3; i++) {
        labels[i] = i % 12 < 4 || i % 12 > 7 ? 1 : i % 12 < 6 ? 2 : 3;
    }
    static const struct {
        double first; /* x of the first voxel's centre, in voxels of 1 mm */
        double step;
        int code;
        bool is_known;
    } grids[] = {
        {-0.5, -1, 0, false}, {0, 1, 0, false}, {0, 1, 4, true}, {-40, 1, 0, true}, /* a part of a larger image */
    };
    for (size_t g = 0; g < sizeof grids / sizeof *grids; g++) {
        conus_atlas *own = NULL;
        conus_place place;
        assert_ok(area_rows_atlas(&own, (const size_t[]){12, 3, 3}, labels, some));
        place_voxels(own, grids[g].first, grids[g].step);
        own->volumes[0].info.space_code = grids[g].code;
        conus_status status = conus_place_find(&place, own, "Cortex", NULL);
        assert_int_equal(status, grids[g].is_known ? CONUS_OK : CONUS_ERROR_ARGUMENT);
        if (status) {
            assert_string_equal(conus_message(),
                                "Cortex may lie on both sides: x = 0 is an edge of the atlas's grid, and so it is not "
                                "known where left ends; choose a side by a point of it");
        }
        assert_ok(conus_place_find(&place, own, "Core_L", NULL)); /* it says its side */
        conus_atlas_destroy(own);
    }
}

/* The midline of the CCF is ML 5700 um, wherever the corner of the grid is. */
static void the_ccf_has_its_own_midline(void **state)
{
    (void)state;
    static const struct area_row one[] = {{1, "VISp", 0, NULL, 0}, {0}};
    static uint32_t labels[12 * 3 * 3];
    for (size_t i = 0; i < 12 * 3 * 3; i++) {
        labels[i] = i % 12 < 4 || i % 12 > 7;
    }
    conus_atlas *own = NULL;
    conus_place place;
    assert_ok(area_rows_atlas(&own, (const size_t[]){12, 3, 3}, labels, one));
    place_voxels(own, 0, 1); /* x from 0 to 11 mm */
    assert_fails(conus_place_find(&place, own, "VISp", NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "it is not known where left ends"));
    own->has_ccf = true;
    mat4_identity(own->own_from_ccf); /* x = ML - 0.2 mm, y = -AP, z = -DV */
    const double m[16] = {0, -1e-3, 0, 0, 0, 0, -1e-3, 0, 1e-3, 0, 0, 0, -0.2, 0, 0, 1};
    memcpy(own->own_from_ccf, m, sizeof m);
    assert_fails(conus_place_find(&place, own, "VISp", NULL), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "VISp lies on both sides: 36.00 mm3 left, 36.00 mm3 right; type "
                                         "--hemispheres split, and as the name \"VISp left\" or \"VISp right\"");
    assert_fails(conus_place_find(&place, own, "1020:C3", NULL), CONUS_ERROR_ARGUMENT);
    own->own_from_ccf[8] = -1e-3; /* ML grows against x: left by one is right by the other */
    own->own_from_ccf[12] = 11.2;
    assert_fails(conus_place_find(&place, own, "VISp", NULL), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "right; choose one by a point of it"));
    assert_fails(conus_atlas_set_hemispheres(own, CONUS_HEMISPHERES_SPLIT), CONUS_ERROR_UNSUPPORTED);
    memcpy(own->own_from_ccf, m, sizeof m);
    assert_ok(
        conus_atlas_set_hemispheres(own, CONUS_HEMISPHERES_SPLIT)); /* at x = 5.5: 0 to 3 are left, 8 to 11 right */
    assert_ok(conus_place_find(&place, own, "VISp left", NULL));
    assert_true(place.point[0] >= 0 && place.point[0] <= 3);
    assert_ok(conus_place_find(&place, own, "VISp right", NULL));
    assert_true(place.point[0] >= 8);
    conus_atlas_destroy(own);
}

static void a_position_is_one_of_a_cap(void **state)
{
    (void)state;
    conus_place place;
    const struct position *f3 = position_find(text_from("F3"));
    say_space("sform, code 4 (MNI 152)", 4);
    assert_ok(conus_place_find(&place, atlas, "f3", NULL));
    assert_int_equal(place.kind, CONUS_PLACE_POSITION);
    assert_memory_equal(place.point, f3->point, sizeof place.point);
    assert_memory_equal(place.outward, f3->outward, sizeof place.outward);
    assert_place("T3", -82.4, -16.9, -9.3, "position T7: (-82.4, -16.9, -9.3)");
    refuse_place("Cores", "\"Core_R\"? Or a 10-20 position, as C3");
    refuse_place("Xyz", "; 'conus info' lists areas; or a 10-20 position, as C3");
    /* Areas that are called so come first. */
    assert_place("fp1", -10.5, 2.5, -3.5,
                 "Area Fp1 left: (-10.5, 2.5, -3.5), 2.0 mm inside, the area; a position of a cap is called so, too "
                 "(1020:)");
    assert_ok(conus_place_find(&place, atlas, "C3", NULL));
    assert_true(place.kind == CONUS_PLACE_INNER && place.is_also_named);
    assert_ok(conus_place_find(&place, atlas, "1020:C3", NULL));
    assert_int_equal(place.kind, CONUS_PLACE_POSITION);
    refuse_place("1020:A1", "no such position");
    say_space("sform, code 1 (scanner)", 1);
    refuse_place("F3", "it is not known whether the atlas lies there; 1020:F3 says that it does");
    assert_ok(conus_place_find(&place, atlas, "1020:F3", NULL));
    refuse_place("Xyz", "no area");
    assert_place("MNI 1 2 3", 1, 2, 3, "(1.0, 2.0, 3.0), in MNI, where it is not known that the atlas lies");
    assert_null(strstr(conus_message(), "10-20"));
    say_space("sform, code 3 (Talairach)", 3);
    refuse_place("F3", "another brain");
    refuse_place("1020:F3", "another brain");
    refuse_place("MNI 1 2 3", "it says MNI, but the atlas is another brain");
    say_space("test", 0);
}

static void several_areas_that_have_a_position_are_refused(void **state)
{
    (void)state;
    static const struct area_row own_rows[] = {{1, "L_F1_ROI", 0, NULL, 0}, {2, "R_F1_ROI", 0, NULL, 0}, {0}};
    static const uint32_t labels[2] = {1, 2};
    conus_atlas *own = NULL;
    conus_place place;
    assert_ok(area_rows_atlas(&own, (const size_t[]){2, 1, 1}, labels, own_rows));
    assert_fails(conus_place_find(&place, own, "F1", NULL), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "\"F1\" may be any of 2: \"L_F1_ROI\" (1), \"R_F1_ROI\" (2); give a name or a "
                                         "label; 1020:F1 is the position of a cap");
    conus_atlas_destroy(own);
}

static void numbers_are_of_their_space(void **state)
{
    (void)state;
    conus_place place;
    conus_frame frame;
    assert_ok(conus_frame_find(&frame, NULL, CONUS_SPACE_LPS, NULL));
    const conus_place_options options = {.frame = &frame};
    assert_ok(conus_place_find(&place, atlas, "1 2 3", &options));
    assert_true(place.point[0] == -1 && place.point[1] == -2 && place.point[2] == 3);
    assert_fails(conus_place_find(&place, atlas, "1L 2P 3S", &options), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "numbers are lps here"));
    assert_fails(conus_place_find(&place, atlas, "RAS 1 2 3", &options), CONUS_ERROR_ARGUMENT);
    assert_ok(conus_place_find(&place, atlas, "Core_L", &options));
    char words[CONUS_PLACE_TEXT];
    conus_place_text(words, &place, &frame);
    assert_string_equal(words, "Core_L: (7.5, 2.5, -2.5), 3.0 mm inside");
    assert_place("1, 2, 3", 1, 2, 3, "(1.0, 2.0, 3.0), the numbers; an area is called so, too");
}

static void near_is_nearest_to_the_other_place(void **state)
{
    (void)state;
    const double other[3] = {0.2, -2.6, 40};
    const conus_place_options options = {.other = other};
    conus_place place;
    assert_true(conus_place_is_near("near:Core_L") && !conus_place_is_near("Core_L") && !conus_place_is_near("near:"));
    assert_ok(conus_place_find(&place, atlas, "near:Core_L", &options));
    assert_true(place.point[0] == -4.5 && place.point[1] == -2.5 && place.point[2] == -0.5);
    assert_ok(conus_place_find(&place, atlas, "near:Both", &options));
    assert_true(place.point[0] == 1.5 && place.point[1] == -2.5 && place.point[2] == -2.5);
}

/* The middle of a box of triangles, by trying every whole mm; it is not on the grid. */
static void a_closed_surface_has_an_inner_point(void **state)
{
    (void)state;
    static const double low[3] = {-3.3, 2.2, -4.6};
    static const double high[3] = {5.9, 7.4, 6.3};
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (int open = 0; open < 2; open++) {
        conus_atlas *own = NULL;
        struct mesh mesh;
        struct notes notes = {0};
        const conus_object area = {.kind = CONUS_KIND_AREA, .label = 1, .name = "Box left", .abbreviation = ""};
        assert_ok(mesh_init(&mesh, 8, open ? 11 : 12));
        for (int c = 0; c < 24; c++) {
            mesh.positions[c] = (float)(c / 3 >> c % 3 & 1 ? high : low)[c % 3];
        }
        memcpy(mesh.triangles, faces, mesh.triangle_count * sizeof faces[0]);
        assert_ok(mesh_check(&mesh, &notes));
        assert_ok(atlas_create_empty(&own, "box"));
        assert_ok(atlas_add_mesh(own, &area, &mesh));
        double best[3] = {0};
        double most = 0;
        double least = INFINITY;
        for (int i = 0; i < 16 * 16 * 16; i++) {
            const int whole[3] = {i % 16 - 5, i / 16 % 16 - 5, i / 256 - 5};
            const double at[3] = {whole[0], whole[1], whole[2]};
            double depth = INFINITY;
            double off = 0;
            for (int a = 0; a < 3; a++) {
                depth = fmin(depth, fmin(at[a] - (double)(float)low[a], (double)(float)high[a] - at[a]));
                off += pow(at[a] - (low[a] + high[a]) / 2, 2);
            }
            if (depth > most + 1e-9 || (depth > most - 1e-9 && off < least - 1e-6)) {
                most = depth;
                least = off;
                memcpy(best, at, sizeof best);
            }
        }
        conus_place place;
        conus_status status = conus_place_find(&place, own, "Box left", NULL);
        if (open) {
            assert_fails(status, CONUS_ERROR_ARGUMENT);
            assert_non_null(strstr(conus_message(), "no voxels and no closed surface, and so no inner point"));
        } else {
            assert_ok(status);
            assert_memory_equal(place.point, best, sizeof best);
            assert_near(place.depth, most, 1e-9);
        }
        const conus_place_options options = {.other = (const double[]){20, 5, 0}};
        assert_ok(conus_place_find(&place, own, "near:box left", &options));
        assert_near(place.point[0], open ? place.point[0] : high[0], 1e-5);
        notes_finish(&notes);
        conus_atlas_destroy(own);
    }
}

/* A box without a side, a quarter of which is on the left. */
static void the_sides_of_a_surface_are_measured(void **state)
{
    (void)state;
    static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    static const float lows[2] = {-10, -3};
    for (int trial = 0; trial < 2; trial++) {
        conus_atlas *own = NULL;
        struct mesh mesh;
        struct notes notes = {0};
        conus_place place;
        const conus_object area = {.kind = CONUS_KIND_AREA, .label = 1, .name = "Box", .abbreviation = ""};
        assert_ok(mesh_init(&mesh, 8, 12));
        for (int c = 0; c < 24; c++) {
            mesh.positions[c] = c / 3 >> c % 3 & 1 ? 30.0F : c % 3 ? 10.0F : lows[trial];
        }
        memcpy(mesh.triangles, faces, sizeof faces);
        assert_ok(mesh_check(&mesh, &notes));
        assert_ok(atlas_create_empty(&own, "box"));
        assert_ok(atlas_add_mesh(own, &area, &mesh));
        conus_status status = conus_place_find(&place, own, "Box", NULL);
        if (trial) {
            assert_ok(status); /* 9 % */
        } else {
            assert_fails(status, CONUS_ERROR_ARGUMENT);
            assert_string_equal(conus_message(), "Box lies on both sides: 4.00 cm3 left, 12.00 cm3 right; centroid:Box "
                                                 "is one point of it, in the middle of all");
        }
        notes_finish(&notes);
        conus_atlas_destroy(own);
    }
}

static conus_name_check check_names(const char *text)
{
    conus_pose_list *list = NULL;
    conus_name_check found;
    const conus_pose_options options = {.columns = "sides=anyway"};
    assert_ok(pose_list_parse(&list, text_from(text), &options));
    assert_ok(conus_places_check(&found, atlas, list));
    conus_pose_list_destroy(list);
    return found;
}

/* Core_L ends at (-4.5, -0.5, -0.5), Core_R begins at 4.5. */
static void names_of_areas_say_where_points_are(void **state)
{
    (void)state;
    conus_name_check found = check_names("name,x,y,z\nCore_L,-4.6,-2,-2\ncore r,7,-2,-2\nGroup,-6.5,2.5,-3.5\n");
    assert_true(found.areas.named == 3 && found.areas.median == 0 && found.areas.farthest_mm == 0);
    assert_false(found.areas.is_far);
    /* 25, 12 and 0 mm from the nearest centre. */
    found = check_names("name,x,y,z\nCore_L,20.5,-2.5,-2.5\nCore_R,-7.5,-2.5,-2.5\nGroup,-6.5,2.5,-3.5\n");
    assert_true(found.areas.named == 3 && found.areas.farthest == 0);
    assert_near(found.areas.median, 12, 1e-12);
    assert_near(found.areas.farthest_mm, 25, 1e-12);
    assert_false(found.areas.is_far);
    /* Of four the greater of those in the middle, 15 mm and then more. */
    found =
        check_names("name,x,y,z\nCore_L,-7.5,14.5,-2.5\nCore_L,-7.5,2.5,-2.5\nCore_L,-7,-2,-2\nCore_L,11,-2.5,-2.5\n");
    assert_near(found.areas.median, 15, 1e-12);
    assert_false(found.areas.is_far);
    assert_true(
        check_names("name,x,y,z\nCore_L,-7,15,-2\nCore_L,-7,2,-2\nCore_L,-7,-2,-2\nCore_L,-7,15,-2\n").areas.is_far);
    /* What is above an area holds it; a hidden one is where it was. */
    assert_ok(conus_atlas_show(atlas, "Core_R", NULL));
    found = check_names("name,x,y,z\nGroup,-5.5,4.5,0.5\nBowl,-5.5,4.5,0.5\nCore_L,-5.5,-2,-2\n");
    assert_true(found.areas.named == 3 && found.areas.farthest_mm == 0);
    assert_ok(conus_atlas_show(atlas, NULL, NULL));
}

static void few_names_and_numbers_say_nothing(void **state)
{
    (void)state;
    assert_int_equal(check_names("name,x,y,z\nCore_L,90,0,0\nCore_R,-90,0,0\n").areas.named, 0);
    assert_int_equal(check_names("name,x,y,z\n1,90,0,0\n2,-90,0,0\n3,80,0,0\n").areas.named, 0);
    assert_int_equal(check_names("90 0 0\n-90 0 0\n80 0 0\n").areas.named, 0);
    const char *lost = "name,x,y,z\nCore_L,90,0,0\nCore_R,-90,0,0\nCore_L,80,0,0\nA,0,0,0\nB,0,0,0\nC,0,0,0\nD,0,0,0\n";
    assert_int_equal(check_names(lost).areas.named, 0); /* three of seven */
    assert_int_equal(check_names(strchr(strchr(lost, '\n') + 1, '\n') + 1).areas.named, 0);
    const char *directed = "name,x,y,z,dx,dy,dz\nCore_L,90,0,0,0,0,1\nCore_L,90,0,0,0,0,1\nCore_L,90,0,0,0,0,1\n";
    assert_int_equal(check_names(directed).areas.named, 0);
}

static void names_of_positions_say_where_points_are(void **state)
{
    (void)state;
    const char *cap = "name,x,y,z\nFp1,-29,81,-8\nF3,-49,52,39\nPz,0,-84,79\nO1,-29,-114,4\n";
    const char *mirrored = "name,x,y,z\nFp1,29,81,-8\nF3,49,52,39\nPz,0,-84,79\nO1,29,-114,4\n";
    const char *shaft = "name,x,y,z\nP1,29,81,-8\nP2,49,52,39\nP3,0,-84,79\nP4,29,-114,4\n";
    assert_int_equal(check_names(mirrored).positions.named, 0); /* the brain is not known */
    say_space("sform, code 4 (MNI 152)", 4);
    conus_name_check found = check_names(cap);
    assert_true(found.positions.named == 4 && found.positions.median < 2 && !found.positions.is_far);
    found = check_names(mirrored);
    assert_true(found.positions.is_far && found.positions.farthest == 1 && !found.areas.named);
    assert_int_equal(check_names(shaft).positions.named, 0);
    say_space("sform, code 3 (Talairach)", 3);
    assert_int_equal(check_names(mirrored).positions.named, 0);
    say_space("test", 0);
}

static conus_status check_far_names(void *user)
{
    (void)user;
    conus_pose_list *list = NULL;
    conus_name_check found;
    const char *text = "name,x,y,z\nCore_L,-90,0,0\nCore_R,70,0,0\nXyz,80,0,0\nGroup,0,0,40\n";
    conus_status status = pose_list_parse(&list, text_from(text), NULL);
    status = status ? status : conus_places_check(&found, atlas, list);
    conus_pose_list_destroy(list);
    return status;
}

static conus_status find_each(void *user)
{
    (void)user;
    static const char *const texts[] = {"Core_L", "centroid:Group", "near:Both", "Both", "fp1", "Xyz", "1 2 3"};
    const conus_place_options options = {.other = (const double[]){1, 2, 3}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        conus_place place;
        if (conus_place_find(&place, atlas, texts[i], &options) == CONUS_ERROR_MEMORY) {
            return CONUS_ERROR_MEMORY;
        }
    }
    return CONUS_OK;
}

static void memory_may_fail(void **state)
{
    (void)state;
    test_every_allocation(find_each, NULL);
    test_every_allocation(check_far_names, NULL);
}

TEST_GROUP(plan_place)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_area_has_its_inner_point),
        cmocka_unit_test(what_is_hidden_has_the_same),
        cmocka_unit_test(an_area_on_both_sides_is_refused),
        cmocka_unit_test(an_area_beside_the_midline_is_refused),
        cmocka_unit_test(without_sides_the_midline_is_no_excuse),
        cmocka_unit_test(where_left_ends_may_not_be_known),
        cmocka_unit_test(the_ccf_has_its_own_midline),
        cmocka_unit_test(a_position_is_one_of_a_cap),
        cmocka_unit_test(several_areas_that_have_a_position_are_refused),
        cmocka_unit_test(numbers_are_of_their_space),
        cmocka_unit_test(near_is_nearest_to_the_other_place),
        cmocka_unit_test(names_of_areas_say_where_points_are),
        cmocka_unit_test(few_names_and_numbers_say_nothing),
        cmocka_unit_test(names_of_positions_say_where_points_are),
        cmocka_unit_test(a_closed_surface_has_an_inner_point),
        cmocka_unit_test(the_sides_of_a_surface_are_measured),
        cmocka_unit_test(memory_may_fail),
    };
    return cmocka_run_group_tests(tests, open_atlas, close_atlas);
}
