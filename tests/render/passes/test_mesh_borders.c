/* SPDX-License-Identifier: BSD-3-Clause */
/* Borders between areas of one surface are smooth in pictures. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "render/passes/shapes.h"
#include "test.h"

#include <string.h>

/* A bumpy sheet of SIDE x SIDE corners over the grid's points, two triangles to a square. */
enum { SIDE = 12, SQUARES = (SIDE - 1) * (SIDE - 1), TRIANGLES = 2 * SQUARES, AREAS = 3 };

static const uint64_t plenty = 1 << 30;

static void triangle_corners(uint32_t out[3], size_t triangle)
{
    uint32_t square = (uint32_t)triangle / 2;
    uint32_t corner = square / (SIDE - 1) * SIDE + square % (SIDE - 1);
    const uint32_t both[2][3] = {{corner, corner + 1, corner + SIDE}, {corner + 1, corner + SIDE + 1, corner + SIDE}};
    memcpy(out, both[triangle % 2], sizeof both[0]);
}

/* Labels of corners: 3 above the middle, 1 and 2 below it. */
static uint32_t corner_label(uint32_t corner)
{
    return corner / SIDE > 4 ? 3 : corner % SIDE > 5 ? 2 : 1;
}

/* The rule of docs/formats.md: most corners, else the first. */
static uint32_t triangle_label(size_t triangle)
{
    uint32_t t[3];
    triangle_corners(t, triangle);
    uint32_t b = corner_label(t[1]);
    return b == corner_label(t[2]) ? b : corner_label(t[0]);
}

/* Adds the triangles of a label as an object with corners of its own. */
static void add_area(conus_atlas *atlas, const uint32_t labels[TRIANGLES], uint32_t label)
{
    struct mesh mesh = {0};
    size_t count = 0;
    for (size_t i = 0; i < TRIANGLES; i++) {
        count += labels[i] == label;
    }
    assert_ok(mesh_init(&mesh, (size_t)SIDE * SIDE, count));
    for (uint32_t v = 0; v < SIDE * SIDE; v++) {
        mesh.positions[3 * v] = (float)(v % SIDE);
        mesh.positions[3 * v + 1] = (float)(int)(v / SIDE);
        mesh.positions[3 * v + 2] = 0.1F * (float)(v * 7 % 5);
    }
    count = 0;
    for (size_t i = 0; i < TRIANGLES; i++) {
        if (labels[i] == label) {
            triangle_corners(mesh.triangles + 3 * count++, i);
        }
    }
    mesh_scene_add(atlas, &mesh);
}

/* Three areas; their numbers are their labels. */
static conus_atlas *make_sheet(uint32_t labels[TRIANGLES])
{
    conus_atlas *atlas = mesh_scene_atlas();
    for (size_t i = 0; i < TRIANGLES; i++) {
        labels[i] = triangle_label(i);
    }
    for (uint32_t label = 1; label <= AREAS; label++) {
        add_area(atlas, labels, label);
    }
    return atlas;
}

static const struct mesh_vertex *corner_of(const struct mesh_list *list, size_t index)
{
    return &list->vertices[list->indices[index]];
}

/* What a triangle of the list covers of the grid's plane; its sides must face as the sheet's do. */
static double covered(const struct mesh_list *list, size_t first)
{
    const float *a = corner_of(list, first)->position;
    const float *b = corner_of(list, first + 1)->position;
    const float *c = corner_of(list, first + 2)->position;
    double area = ((double)(b[0] - a[0]) * (double)(c[1] - a[1]) - (double)(b[1] - a[1]) * (double)(c[0] - a[0])) / 2;
    assert_true(area > 0);
    return area;
}

static double covered_by(const struct mesh_list *list, uint32_t object)
{
    const struct mesh_entry *part = &list->parts[object - 1];
    double area = 0;
    for (size_t k = part->first; k < part->first + part->count; k += 3) {
        area += covered(list, k);
        for (size_t i = 0; i < 3; i++) {
            assert_int_equal(corner_of(list, k + i)->object, object);
        }
    }
    return area;
}

/* The label whose corners weigh most at a place of the grid's plane, by the place's weights in its triangle. */
static uint32_t heaviest(double x, double y)
{
    double weights[AREAS + 1] = {0};
    uint32_t corner = (uint32_t)y * SIDE + (uint32_t)x;
    double right = x - floor(x);
    double up = y - floor(y);
    bool lower = right + up < 1;
    weights[corner_label(corner + 1)] += lower ? right : 1 - up;
    weights[corner_label(corner + SIDE)] += lower ? up : 1 - right;
    weights[corner_label(lower ? corner : corner + SIDE + 1)] += lower ? 1 - right - up : right + up - 1;
    uint32_t best = 1;
    for (uint32_t label = 2; label <= AREAS; label++) {
        best = weights[label] > weights[best] ? label : best;
    }
    return best;
}

/* A triangle with two corners of an area is that area's by three quarters, one of three areas theirs by a third. */
static void triangles_are_cut_between_corners(void **state)
{
    (void)state;
    uint32_t labels[TRIANGLES];
    conus_atlas *atlas = make_sheet(labels);
    struct mesh_list list;
    uint64_t memory = plenty;
    double wanted[AREAS + 1] = {0};
    for (size_t i = 0; i < TRIANGLES; i++) {
        uint32_t t[3];
        triangle_corners(t, i);
        uint32_t a = corner_label(t[0]);
        uint32_t b = corner_label(t[1]);
        uint32_t c = corner_label(t[2]);
        bool are_three = a != b && b != c && c != a;
        for (int k = 0; k < 3; k++) {
            uint32_t own = corner_label(t[k]);
            int alike = (own == a) + (own == b) + (own == c);
            wanted[own] += are_three || alike == 3 ? 1.0 / 6 : alike == 2 ? 3.0 / 16 : 1.0 / 8;
        }
    }
    assert_ok(mesh_list_init(&list, atlas, &memory));
    assert_true(memory < plenty);
    for (uint32_t label = 1; label <= AREAS; label++) {
        assert_near(covered_by(&list, label), wanted[label], 1e-4);
    }
    for (size_t k = 0; k < list.index_count; k += 3) {
        double centre[2] = {0};
        for (size_t i = 0; i < 3; i++) {
            centre[0] += (double)corner_of(&list, k + i)->position[0] / 3;
            centre[1] += (double)corner_of(&list, k + i)->position[1] / 3;
        }
        assert_int_equal(heaviest(centre[0], centre[1]), corner_of(&list, k)->object);
    }
    mesh_list_finish(&list);
    conus_atlas_destroy(atlas);
}

/* So that the light does not show where the areas were cut from each other: the same as of the whole sheet. */
static void corners_at_one_place_have_one_normal(void **state)
{
    (void)state;
    uint32_t labels[TRIANGLES];
    conus_atlas *atlas = make_sheet(labels);
    conus_atlas *whole = mesh_scene_atlas();
    struct mesh_list list, sheet;
    uint64_t memory = plenty;
    for (size_t i = 0; i < TRIANGLES; i++) {
        labels[i] = 1;
    }
    add_area(whole, labels, 1);
    assert_ok(mesh_list_init(&list, atlas, &memory));
    assert_ok(mesh_list_init(&sheet, whole, &memory));
    size_t checked = 0;
    for (size_t k = 0; k < list.index_count; k++) {
        const struct mesh_vertex *vertex = corner_of(&list, k);
        double x = (double)vertex->position[0];
        double y = (double)vertex->position[1];
        if (x == floor(x) && y == floor(y)) {
            const float *normal = sheet.vertices[(size_t)y * SIDE + (size_t)x].normal;
            for (int a = 0; a < 3; a++) {
                assert_near((double)vertex->normal[a], (double)normal[a], 1e-5);
            }
            checked++;
        }
    }
    assert_true(checked > TRIANGLES);
    mesh_list_finish(&list);
    mesh_list_finish(&sheet);
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(whole);
}

/* One triangle between two areas, of which no corner is its own by most triangles. */
static void a_triangle_without_corners_stays(void **state)
{
    (void)state;
    uint32_t labels[TRIANGLES];
    const size_t lost = 2 * (4 * (SIDE - 1) + 2);
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh_list list;
    uint64_t memory = plenty;
    for (size_t i = 0; i < TRIANGLES; i++) {
        labels[i] = i == lost ? 2 : triangle_label(i) == 3 ? 3 : 1;
    }
    for (uint32_t label = 1; label <= AREAS; label++) {
        add_area(atlas, labels, label);
    }
    assert_ok(mesh_list_init(&list, atlas, &memory));
    assert_near(covered_by(&list, 2), 0.5, 1e-6);
    assert_near(covered_by(&list, 1) + covered_by(&list, 3), SQUARES - 0.5, 1e-4);
    mesh_list_finish(&list);
    conus_atlas_destroy(atlas);
}

/* Two sets of areas on one surface, as two annotations of it: no triangle goes over from one set to the other. */
static void areas_over_each_other_stay(void **state)
{
    (void)state;
    uint32_t labels[TRIANGLES];
    conus_atlas *atlas = make_sheet(labels);
    struct mesh_list list;
    uint64_t memory = plenty;
    for (size_t i = 0; i < TRIANGLES; i++) {
        labels[i] = 4 + (i % 22 > 9);
    }
    add_area(atlas, labels, 4);
    add_area(atlas, labels, 5);
    assert_ok(mesh_list_init(&list, atlas, &memory));
    assert_int_equal(list.index_count, 3 * 2 * TRIANGLES);
    for (uint32_t object = 1; object <= 5; object++) {
        assert_int_equal(list.parts[object - 1].count, 3 * atlas_stored_mesh(atlas, object)->triangle_count);
    }
    mesh_list_finish(&list);
    conus_atlas_destroy(atlas);
}

static void pieces_are_refused_above_the_limit(void **state)
{
    (void)state;
    uint32_t labels[TRIANGLES];
    conus_atlas *atlas = make_sheet(labels);
    struct mesh_list list;
    uint64_t memory = (uint64_t)AREAS * SIDE * SIDE * sizeof(struct mesh_vertex) + UINT64_C(12) * TRIANGLES;
    assert_int_equal(mesh_list_init(&list, atlas, &memory), CONUS_ERROR_MEMORY);
    assert_non_null(strstr(conus_message(), "borders of"));
    conus_atlas_destroy(atlas);
}

static conus_status attempt(void *user)
{
    struct mesh_list list;
    uint64_t memory = plenty;
    conus_status status = mesh_list_init(&list, user, &memory);
    if (!status) {
        mesh_list_finish(&list);
    }
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    uint32_t labels[TRIANGLES];
    conus_atlas *atlas = make_sheet(labels);
    test_every_allocation(attempt, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_borders)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_are_cut_between_corners),  cmocka_unit_test(corners_at_one_place_have_one_normal),
        cmocka_unit_test(a_triangle_without_corners_stays),   cmocka_unit_test(areas_over_each_other_stay),
        cmocka_unit_test(pieces_are_refused_above_the_limit), cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
