/* SPDX-License-Identifier: BSD-3-Clause */
/* A surface is cut into areas by the labels of its vertices. */
#include "atlas/surface/mesh.h"

#include "base/memory.h"
#include "test.h"

#include <string.h>

enum { SIDE = 5 };

/* SIDE x SIDE vertices on the grid's points, two triangles to a square. */
static conus_status make_grid(struct mesh *out)
{
    conus_status status = mesh_init(out, SIDE * SIDE, 2 * (SIDE - 1) * (SIDE - 1));
    for (uint32_t i = 0; !status && i < SIDE * SIDE; i++) {
        out->positions[3 * i] = (float)(i % SIDE);
        out->positions[3 * i + 1] = (float)(int)(i / SIDE);
    }
    for (uint32_t i = 0; !status && i < (SIDE - 1) * (SIDE - 1); i++) {
        uint32_t corner = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        const uint32_t squares[6] = {corner, corner + 1, corner + SIDE, corner + 1, corner + SIDE + 1, corner + SIDE};
        memcpy(out->triangles + 6 * (size_t)i, squares, sizeof squares);
    }
    return status;
}

static const uint32_t rows[SIDE] = {0, 7, 7, 3, 3};

static void label_rows(uint32_t labels[SIDE * SIDE])
{
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        labels[i] = rows[i / SIDE];
    }
}

/* Rows of labels: of the two triangles of a square between two rows, one has two vertices in the lower row and one in
 * the upper, the other the reverse. So each row gets as many triangles. */
static void most_corners_decide(void **state)
{
    (void)state;
    struct mesh mesh;
    struct mesh_parts parts;
    struct notes notes = {0};
    uint32_t labels[SIDE * SIDE];
    label_rows(labels);
    assert_ok(make_grid(&mesh));
    mesh.path = memory_text("grid", 4);
    assert_ok(mesh_split(&parts, &mesh, labels, &notes));
    assert_int_equal(parts.count, 2);
    const uint32_t wanted[2] = {3, 7};
    const size_t triangles[2] = {4 + 8, 4 + 8 + 4};
    double area = 0;
    for (size_t i = 0; i < 2; i++) {
        const struct mesh *part = &parts.parts[i].mesh;
        struct mesh_shape shape;
        struct notes none = {0};
        assert_int_equal(parts.parts[i].label, wanted[i]);
        assert_int_equal(part->triangle_count, triangles[i]);
        assert_string_equal(part->path, "grid");
        assert_ok(mesh_check(&parts.parts[i].mesh, &none));
        assert_ok(mesh_measure(&shape, part));
        assert_false(shape.closed);
        area += (double)part->triangle_count / 2;
        notes_finish(&none);
    }
    assert_near(area, 14, 0); /* of 16 squares; half a row of squares has no label */
    assert_ptr_equal(mesh_parts_find(&parts, 7), &parts.parts[1]);
    assert_null(mesh_parts_find(&parts, 5)); /* between the two */
    assert_int_equal(notes.count, 1);
    assert_string_equal(notes.lines[0], "grid: 4 of 32 triangles have no label and were left out");
    notes_finish(&notes);
    mesh_parts_finish(&parts);
    mesh_finish(&mesh);
}

/* One triangle, with every choice of labels 0, 1, 2 and 3 for its vertices. */
static void every_triangle_follows_the_rule(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 64; i++) {
        const uint32_t labels[3] = {i % 4, i / 4 % 4, i / 16};
        uint32_t wanted = labels[1] == labels[2] ? labels[1] : labels[0];
        struct mesh mesh;
        struct mesh_parts parts = {0};
        struct notes notes = {0};
        assert_ok(mesh_init(&mesh, 3, 1));
        mesh.positions[3] = mesh.positions[7] = 1;
        mesh.triangles[1] = 1;
        mesh.triangles[2] = 2;
        conus_status status = mesh_split(&parts, &mesh, labels, &notes);
        assert_fails(status, wanted ? CONUS_OK : CONUS_ERROR_DATA);
        if (wanted) {
            assert_int_equal(parts.parts[0].label, wanted);
            assert_memory_equal(parts.parts[0].mesh.positions, mesh.positions, 9 * sizeof *mesh.positions);
            assert_memory_equal(parts.parts[0].mesh.triangles, mesh.triangles, 3 * sizeof *mesh.triangles);
        }
        notes_finish(&notes);
        mesh_parts_finish(&parts);
        mesh_finish(&mesh);
    }
}

static bool same_triangle(const struct mesh *a, size_t i, const struct mesh *b, size_t j)
{
    bool same = true;
    for (size_t k = 0; k < 9; k++) {
        float x = a->positions[3 * (size_t)a->triangles[3 * i + k / 3] + k % 3];
        float y = b->positions[3 * (size_t)b->triangles[3 * j + k / 3] + k % 3];
        same = same && x == y;
    }
    return same;
}

/* Counts the triangles of a part that are in the whole, in the same order. */
static size_t count_found(const struct mesh *part, const struct mesh *whole)
{
    size_t found = 0;
    for (size_t at = 0; at < whole->triangle_count && found < part->triangle_count; at++) {
        found += same_triangle(part, found, whole, at);
    }
    return found;
}

/* Whatever the labels, every labelled triangle is in exactly one part, unmoved. */
static void nothing_is_lost_or_moved(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 50; round++) {
        struct mesh mesh;
        struct mesh_parts parts;
        struct notes notes = {0};
        uint32_t labels[SIDE * SIDE];
        size_t total = 0;
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            labels[i] = 1 + (uint32_t)test_random(&random, 0, 6);
        }
        assert_ok(make_grid(&mesh));
        assert_ok(mesh_split(&parts, &mesh, labels, &notes));
        for (size_t p = 0; p < parts.count; p++) {
            assert_int_equal(count_found(&parts.parts[p].mesh, &mesh), parts.parts[p].mesh.triangle_count);
            total += parts.parts[p].mesh.triangle_count;
        }
        assert_int_equal(total, mesh.triangle_count);
        mesh_parts_finish(&parts);
        mesh_finish(&mesh);
    }
}

static conus_status attempt(void *data)
{
    struct mesh mesh = {0};
    struct mesh_parts parts = {0};
    struct notes notes = {0};
    conus_status status = make_grid(&mesh);
    status = status ? status : mesh_split(&parts, &mesh, data, &notes);
    mesh_parts_finish(&parts);
    mesh_finish(&mesh);
    notes_finish(&notes);
    return status;
}

static void every_failing_allocation(void **state)
{
    (void)state;
    uint32_t labels[SIDE * SIDE];
    label_rows(labels);
    test_every_allocation(attempt, labels);
}

TEST_GROUP(mesh_split)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(most_corners_decide),
        cmocka_unit_test(every_triangle_follows_the_rule),
        cmocka_unit_test(nothing_is_lost_or_moved),
        cmocka_unit_test(every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
