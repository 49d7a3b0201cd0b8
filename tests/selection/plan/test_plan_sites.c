/* SPDX-License-Identifier: BSD-3-Clause */
/* Sites: normals by closed forms; borders, spacing and depths by trying everything; and the sites that are kept. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 14 };
/* A grid that is turned, has voxels of three sizes, and is skewed so much that the nearest centre around a structure
 * can be outside of the box of voxels that holds it. */
static const double GRID[16] = {1.1, 0.3, 0, 0, 1.9, 1.1, 0.1, 0, 0.1, 0.2, 1.7, 0, -5, 3, 20, 1};

static void place(double out[3], size_t voxel)
{
    const size_t at[3] = {voxel % N, voxel / N % N, voxel / N / N};
    const double index[3] = {(double)at[0], (double)at[1], (double)at[2]};
    mat4_point(out, GRID, index);
}

/* 1: an ellipsoid with an arm to the edge of the grid; 2: everything around it, below a plane. */
static uint8_t label_at(size_t voxel)
{
    double x = (double)(voxel % N);
    double y = (double)(voxel / N % N);
    const size_t plane = voxel / N / N;
    double z = (double)plane;
    bool in_arm = fabs(y - 6) < 2 && fabs(z - 6) < 2 && x > 6;
    bool in_body = (x - 6) * (x - 6) / 25 + (y - 6) * (y - 6) / 16 + (z - 6) * (z - 6) / 9 < 1;
    return in_arm || in_body ? 1 : z < 3 ? 2 : 0;
}

static conus_voxels voxels_of(const uint8_t *labels)
{
    conus_voxels voxels = {.data = labels, .type = CONUS_SCALAR_UINT8, .dim = {N, N, N}};
    memcpy(voxels.world_from_voxel, GRID, sizeof GRID);
    return voxels;
}

struct made {
    uint8_t labels[N * N * N];
    conus_atlas *atlas;
    conus_selector *selector;
};

static void make(struct made *out)
{
    for (size_t i = 0; i < sizeof out->labels; i++) {
        out->labels[i] = label_at(i);
    }
    const conus_voxels voxels = voxels_of(out->labels);
    const conus_label names[] = {{.number = 1, .name = "One", .hemisphere = 'L'},
                                 {.number = 2, .name = "Two", .hemisphere = 'R'}};
    assert_ok(conus_atlas_create(&out->atlas, &voxels, names, 2, NULL));
    assert_ok(conus_selector_create(&out->selector, out->atlas, NULL));
}

static void destroy(struct made *made)
{
    conus_selector_destroy(made->selector);
    conus_atlas_destroy(made->atlas);
}

/* mm from the centre of a voxel to the nearest centre with another label, in a grid with 2 voxels more around. */
static double depth_of(const uint8_t *labels, size_t voxel)
{
    double least = INFINITY;
    double from[3];
    place(from, voxel);
    for (int z = -2; z < N + 2; z++) {
        for (int y = -2; y < N + 2; y++) {
            for (int x = -2; x < N + 2; x++) {
                const double index[3] = {x, y, z};
                double to[3];
                bool is_there = x >= 0 && y >= 0 && z >= 0 && x < N && y < N && z < N;
                if (!is_there || labels[x + N * (y + N * z)] != labels[voxel]) {
                    mat4_point(to, GRID, index);
                    vec3_sub(to, to, from);
                    least = fmin(least, vec3_length(to));
                }
            }
        }
    }
    return least;
}

/* The voxel with a label that is deepest, by trying all: of equal ones the nearest to their centroid, then the first.
 */
static size_t deepest_of(const uint8_t *labels, uint8_t label)
{
    static double depths[N * N * N];
    double most = 0;
    double sum[4] = {0};
    for (size_t voxel = 0; voxel < N * N * N; voxel++) {
        double point[3];
        depths[voxel] = labels[voxel] == label ? depth_of(labels, voxel) : 0;
        most = fmax(most, depths[voxel]);
        place(point, voxel);
        vec3_add_scaled(sum, sum, labels[voxel] == label, point);
        sum[3] += labels[voxel] == label;
    }
    vec3_scale(sum, sum, 1 / sum[3]);
    size_t found = 0;
    double least = INFINITY;
    for (size_t voxel = 0; voxel < N * N * N; voxel++) {
        double way[3];
        place(way, voxel);
        vec3_sub(way, way, sum);
        if (depths[voxel] > most - 1e-9 && vec3_length(way) < least - 1e-9) {
            least = vec3_length(way);
            found = voxel;
        }
    }
    return found;
}

static void targets_of_a_structure(void **state)
{
    (void)state;
    struct made made;
    make(&made);
    conus_sites *found[3] = {NULL, NULL, NULL};
    for (int kind = 0; kind < 3; kind++) {
        assert_ok(conus_sites_find(&found[kind], made.selector, "One", (conus_sites_kind)kind));
        assert_null(conus_sites_note(found[kind], 0));
        assert_null(conus_sites_normals(found[kind]));
    }
    size_t count = 0;
    double sum[3] = {0};
    for (size_t voxel = 0; voxel < sizeof made.labels; voxel++) {
        if (made.labels[voxel] == 1) {
            double point[3];
            place(point, voxel);
            vec3_add_scaled(sum, sum, 1, point);
            assert_int_equal(conus_sites_source(found[CONUS_SITES_VOXELS], count), voxel);
            vec3_sub(point, point, conus_sites_points(found[CONUS_SITES_VOXELS]) + 3 * count++);
            assert_near(vec3_length(point), 0, 1e-12);
        }
    }
    assert_int_equal(conus_sites_count(found[CONUS_SITES_VOXELS]), count);
    assert_int_equal(conus_sites_source(found[CONUS_SITES_VOXELS], count), UINT64_MAX);
    assert_int_equal(conus_sites_count(found[CONUS_SITES_DEEPEST]), 1);
    assert_int_equal(conus_sites_source(found[CONUS_SITES_DEEPEST], 0), deepest_of(made.labels, 1));
    for (int a = 0; a < 3; a++) {
        assert_near(conus_sites_points(found[CONUS_SITES_CENTROID])[a], sum[a] / (double)count, 1e-9);
    }
    for (int kind = 0; kind < 3; kind++) {
        conus_sites_destroy(found[kind]);
    }
    assert_fails(conus_sites_find(&found[0], made.selector, "Onee", CONUS_SITES_VOXELS), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "did you mean \"One\"?"));
    destroy(&made);
}

/* Object 2 touches five sides of the grid; if these did not count, its deepest voxels would be at the bottom. */
static void the_edge_of_the_grid_ends_a_structure(void **state)
{
    (void)state;
    struct made made;
    make(&made);
    conus_sites *found = NULL;
    size_t deepest = deepest_of(made.labels, 2);
    assert_int_equal(deepest / N / N, 1);
    assert_ok(conus_sites_find(&found, made.selector, "Two", CONUS_SITES_DEEPEST));
    assert_int_equal(conus_sites_source(found, 0), deepest);
    conus_sites_destroy(found);
    destroy(&made);
}

/* Whatever shapes: the voxel by the rule, also of what is hidden, and of many voxels of one depth. */
static void the_deepest_voxel_is_found_in_any_shape(void **state)
{
    (void)state;
    uint64_t random = 3;
    for (int trial = 0; trial < 12; trial++) {
        struct made made = {0};
        double part = test_random(&random, 0.02, 0.98);
        size_t block = 1 + (size_t)trial % 3; /* of equal voxels */
        for (size_t i = 0; i < sizeof made.labels; i++) {
            size_t first = i % N / block + N * (i / N % N / block + N * (i / N / N / block));
            uint64_t own = first * 7919 + (uint64_t)trial;
            made.labels[i] = test_random(&own, 0, 1) < part ? 1 : test_random(&own, 0, 1) < 0.5 ? 2 : 0;
        }
        made.labels[0] = 1;
        made.labels[1] = 2;
        const conus_voxels voxels = voxels_of(made.labels);
        const conus_label names[] = {{.number = 1, .name = "One", .hemisphere = 'L'},
                                     {.number = 2, .name = "Two", .hemisphere = 'R'}};
        assert_ok(conus_atlas_create(&made.atlas, &voxels, names, 2, NULL));
        assert_ok(conus_atlas_show(made.atlas, NULL, trial % 2 ? "One" : NULL));
        assert_ok(conus_selector_create(&made.selector, made.atlas, NULL));
        for (uint8_t label = 1; label <= 2; label++) {
            conus_sites *found = NULL;
            assert_ok(conus_sites_find(&found, made.selector, label == 1 ? "One" : "Two", CONUS_SITES_DEEPEST));
            assert_int_equal(conus_sites_source(found, 0), deepest_of(made.labels, label));
            conus_sites_destroy(found);
        }
        destroy(&made);
    }
}

static void what_is_in_a_structure_is_kept(void **state)
{
    (void)state;
    struct made made;
    make(&made);
    const conus_voxels voxels = voxels_of(made.labels);
    conus_roi *roi = NULL;
    assert_ok(conus_roi_create(&roi, &voxels, &(conus_roi_options){.threshold = 1.5}));
    size_t counts[3] = {0}; /* number of sites of each label */
    static double points[N * N * N][3];
    for (size_t voxel = 0; voxel < sizeof made.labels; voxel++) {
        place(points[voxel], voxel);
        counts[made.labels[voxel]]++;
    }
    for (int inside = 0; inside < 2; inside++) {
        conus_sites *sites[2];
        for (int k = 0; k < 2; k++) {
            assert_ok(conus_sites_create(&sites[k], points[0], sizeof made.labels));
        }
        assert_ok(conus_sites_keep_named(sites[0], made.selector, "One,Two", inside));
        conus_sites_keep_roi(sites[1], roi, inside);
        assert_int_equal(conus_sites_count(sites[0]), inside ? counts[1] + counts[2] : counts[0]);
        assert_int_equal(conus_sites_count(sites[1]), inside ? counts[2] : counts[0] + counts[1]);
        assert_fails(conus_sites_keep_labelled(sites[0], "none.label", true), CONUS_ERROR_ARGUMENT);
        conus_sites_destroy(sites[0]);
        conus_sites_destroy(sites[1]);
    }
    conus_roi_destroy(roi);
    destroy(&made);
}

/* A cube of 5 x 5 x 5 voxels in the middle has 27 voxels that are not at its border; one of 14 fills the grid. */
static void borders_of_a_region(void **state)
{
    (void)state;
    static uint8_t cube[N * N * N];
    const conus_voxels voxels = voxels_of(cube);
    for (size_t i = 0; i < sizeof cube; i++) {
        cube[i] = i % N >= 4 && i % N < 9 && i / N % N >= 4 && i / N % N < 9 && i / N / N >= 4 && i / N / N < 9;
    }
    for (int all = 0; all < 2; all++) {
        conus_roi *roi = NULL;
        conus_sites *sites = NULL;
        memset(cube, 1, all ? sizeof cube : (size_t)0);
        assert_ok(conus_roi_create(&roi, &voxels, NULL));
        assert_ok(conus_sites_of_roi(&sites, roi));
        assert_int_equal(conus_sites_count(sites), all ? 14 * 14 * 14 - 12 * 12 * 12 : 125 - 27);
        double point[3];
        place(point, (size_t)conus_sites_source(sites, 7));
        vec3_sub(point, point, conus_sites_points(sites) + 21);
        assert_near(vec3_length(point), 0, 1e-12);
        conus_sites_destroy(sites);
        conus_roi_destroy(roi);
    }
}

static void spacing_is_greedy(void **state)
{
    (void)state;
    enum { COUNT = 3000 };
    static double points[COUNT][3];
    static size_t kept[COUNT];
    uint64_t random = 11;
    for (size_t i = 0; i < COUNT; i++) {
        for (int a = 0; a < 3; a++) { /* in part on a lattice, where distances are equal */
            points[i][a] = test_random(&random, -6, 6);
            points[i][a] = i % 3 ? points[i][a] : round(points[i][a]);
        }
    }
    static const double spacings[] = {0.001, 0.5, 1, 2, 100};
    for (size_t s = 0; s < 5; s++) {
        size_t count = 0;
        for (size_t i = 0; i < COUNT; i++) {
            double least = INFINITY;
            for (size_t k = 0; k < count; k++) {
                double way[3];
                vec3_sub(way, points[i], points[kept[k]]);
                least = fmin(least, vec3_length(way));
            }
            if (least >= spacings[s]) {
                kept[count++] = i;
            }
        }
        conus_sites *sites = NULL;
        assert_ok(conus_sites_create(&sites, points[0], COUNT));
        assert_ok(conus_sites_space(sites, spacings[s]));
        assert_int_equal(conus_sites_count(sites), count);
        for (size_t k = 0; k < count; k++) {
            assert_int_equal(conus_sites_source(sites, k), kept[k]);
            assert_memory_equal(conus_sites_points(sites) + 3 * k, points[kept[k]], sizeof points[0]);
        }
        assert_fails(conus_sites_space(sites, 0), CONUS_ERROR_ARGUMENT);
        assert_fails(conus_sites_space(sites, NAN), CONUS_ERROR_ARGUMENT);
        conus_sites_destroy(sites);
    }
    points[5][1] = NAN;
    conus_sites *sites = NULL;
    assert_fails(conus_sites_create(&sites, points[0], COUNT), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "point 6"));
}

enum { BELTS = 24, AROUND = 48, SPHERE = BELTS * AROUND + 2 };

/* Writes a globe made of belts: its normals are nearly those of the ball. */
static const char *write_globe(bool inside_out, bool is_open)
{
    struct buffer text = {0};
    size_t faces = 2 * (size_t)AROUND * BELTS - (is_open ? AROUND : 0);
    buffer_format(&text, "OFF\n%d %zu 0\n", SPHERE + 1, faces);
    for (int belt = 1; belt <= BELTS; belt++) {
        for (int i = 0; i < AROUND; i++) {
            double polar = MATH3_PI * belt / (BELTS + 1);
            double turn = 2 * MATH3_PI * i / AROUND;
            buffer_format(&text, "%.9g %.9g %.9g\n", 100 + 50 * sin(polar) * cos(turn), 50 * sin(polar) * sin(turn),
                          50 * cos(polar));
        }
    }
    buffer_text(&text, "100 0 50\n100 0 -50\n0 0 0\n"); /* the last is in no triangle */
    for (int belt = 0; belt <= BELTS; belt++) {
        for (int i = 0; i < AROUND; i++) {
            int j = (i + 1) % AROUND;
            int a = belt ? (belt - 1) * AROUND + i : SPHERE - 2;
            int b = belt < BELTS ? belt * AROUND + i : SPHERE - 1;
            int c = belt < BELTS ? belt * AROUND + j : SPHERE - 1;
            int d = belt ? (belt - 1) * AROUND + j : SPHERE - 2;
            if (belt < BELTS) {
                buffer_format(&text, "3 %d %d %d\n", a, inside_out ? c : b, inside_out ? b : c);
            }
            if (belt && !(is_open && belt == BELTS)) {
                buffer_format(&text, "3 %d %d %d\n", a, inside_out ? d : c, inside_out ? c : d);
            }
        }
    }
    const char *path = test_scratch("globe.off");
    assert_ok(buffer_status(&text));
    assert_ok(file_write(path, text.data, text.size));
    buffer_finish(&text);
    return path;
}

/* With edges a, b, c along the axes the areas at the corner between them are bc/2, ca/2 and ab/2, with inward normals
 * as seen from the fourth triangle, whose area is the same vector outwards: at its corners one axis is left. */
static void normals_of_a_tetrahedron(void **state)
{
    (void)state;
    static const char file[] = "OFF\n4 4 0\n0 0 0\n2 0 0\n0 3 0\n0 0 5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    static const double areas[4][3] = {{-15, -10, -6}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const char *path = test_scratch("tetrahedron.off");
    assert_ok(file_write(path, file, sizeof file - 1));
    conus_sites *sites = NULL;
    assert_ok(conus_sites_load(&sites, path, false));
    assert_int_equal(conus_sites_count(sites), 4);
    for (size_t i = 0; i < 4; i++) {
        for (int a = 0; a < 3; a++) {
            assert_near(conus_sites_normals(sites)[3 * i + (size_t)a], areas[i][a] / vec3_length(areas[i]), 1e-12);
        }
    }
    conus_sites_destroy(sites);
}

static void normals_point_outwards(void **state)
{
    (void)state;
    for (int variant = 0; variant < 8; variant++) {
        bool inside_out = variant & 1;
        bool flip = variant & 2;
        bool is_open = variant & 4;
        conus_sites *sites = NULL;
        assert_ok(conus_sites_load(&sites, write_globe(inside_out, is_open), flip));
        assert_int_equal(conus_sites_count(sites), is_open ? SPHERE - 1 : SPHERE);
        assert_int_equal(conus_sites_note(sites, 0) != NULL, is_open);
        double sign = (is_open && inside_out) != flip ? -1 : 1;
        for (size_t i = 0; i < conus_sites_count(sites); i++) {
            const double *normal = conus_sites_normals(sites) + 3 * i;
            double out[3];
            vec3_sub(out, conus_sites_points(sites) + 3 * i, (const double[]){100, 0, 0});
            vec3_scale(out, out, sign / 50);
            assert_near(vec3_length(normal), 1, 1e-12);
            assert_true(vec3_angle(normal, out) < (is_open ? 0.2 : 0.1));
            assert_int_equal(conus_sites_source(sites, i), i);
        }
        conus_sites_destroy(sites);
    }
}

static conus_status use_all(void *data)
{
    const struct made *made = data;
    const conus_voxels voxels = voxels_of(made->labels);
    const char *path = test_scratch("globe.off");
    conus_sites *sites[4] = {NULL, NULL, NULL, NULL};
    conus_roi *roi = NULL;
    conus_status status = conus_roi_create(&roi, &voxels, &(conus_roi_options){.threshold = 1});
    status = status ? status : conus_sites_of_roi(&sites[0], roi);
    status = status ? status : conus_sites_keep_named(sites[0], made->selector, "One", true);
    status = status ? status : conus_sites_space(sites[0], 3);
    status = status ? status : conus_sites_find(&sites[1], made->selector, "Two", CONUS_SITES_VOXELS);
    status = status ? status : conus_sites_find(&sites[2], made->selector, "One", CONUS_SITES_CENTROID);
    status = status ? status : conus_sites_load(&sites[3], path, false);
    status = status ? status : conus_sites_keep_labelled(sites[3], test_scratch("lh.few.label"), true);
    if (!status) {
        assert_int_equal(conus_sites_count(sites[3]), 2);
    }
    for (int i = 0; i < 4; i++) {
        conus_sites_destroy(sites[i]);
    }
    conus_roi_destroy(roi);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    static const char few[] = "#!ascii label\n2\n0 0 0 0 0\n7 0 0 0 0\n";
    struct made made;
    make(&made);
    write_globe(false, true);
    assert_ok(file_write(test_scratch("lh.few.label"), few, sizeof few - 1));
    test_every_allocation(use_all, &made);
    destroy(&made);
}

TEST_GROUP(plan_sites)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(targets_of_a_structure),
        cmocka_unit_test(the_edge_of_the_grid_ends_a_structure),
        cmocka_unit_test(the_deepest_voxel_is_found_in_any_shape),
        cmocka_unit_test(what_is_in_a_structure_is_kept),
        cmocka_unit_test(borders_of_a_region),
        cmocka_unit_test(spacing_is_greedy),
        cmocka_unit_test(normals_of_a_tetrahedron),
        cmocka_unit_test(normals_point_outwards),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
