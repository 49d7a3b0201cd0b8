/* SPDX-License-Identifier: BSD-3-Clause */
/* Surfaces of phantoms and of AAL, made by conus-mesh, against closed forms and against the voxels. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/extraction/mesh_extract.h"
#include "made_atlas.h"
#include "test.h"

enum { MOST_AREAS = 200 };

struct found {
    struct mesh_shape shapes[MOST_AREAS]; /* by the area's number - 1 */
    size_t triangles[MOST_AREAS];
    size_t count;
};

static void take(struct job *job, void *user, uint32_t number, const struct mesh *mesh)
{
    struct found *found = user;
    assert_true(number >= 1 && number <= MOST_AREAS);
    found->count++;
    found->triangles[number - 1] = mesh->triangle_count;
    (void)JOB_CALL(job, mesh_measure(&found->shapes[number - 1], mesh));
}

static struct found extract(const conus_atlas *atlas, uint32_t iterations, double reduction)
{
    const struct mesh_extract_options options = {iterations, MESH_DEFAULT_PASS_BAND, reduction, UINT64_C(8) << 30};
    struct found found = {0};
    struct notes notes = {0};
    struct job job = {0};
    mesh_extract(&job, atlas, &options, take, &found);
    assert_ok(job_close(&job, &notes, NULL));
    for (size_t i = 0; i < notes.count; i++) {
        print_message("note: %s\n", notes.lines[i]);
    }
    assert_int_equal(notes.count, 0);
    return found;
}

static conus_atlas *draw(const char *kind, const conus_phantom_options *options, struct phantom_drawing *drawing)
{
    conus_atlas *atlas;
    assert_ok(phantom_draw(drawing, kind, options));
    assert_ok(phantom_drawing_atlas(&atlas, drawing));
    return atlas;
}

/* A ball of 20 mm in voxels of 1 mm. As voxels its volume is off by a part of those on its border; flying edges cut
 * their corners, and smoothing rounds them. 3 % of the volume and 0.05 mm of the centroid are generous limits for all
 * of that. */
static void a_ball_is_one_wherever_the_voxels_point(void **state)
{
    (void)state;
    test_need_conus_mesh();
    const conus_phantom_options grids[] = {
        {0},
        {.flip = {true}},
        {.flip = {true, true, true}},
        {.oblique = 0.5 * 180 / MATH3_PI},
        {.oblique = -0.7 * 180 / MATH3_PI, .flip = {false, true}},
        {.spacing = {1, 1, 2}},
    };
    for (size_t i = 0; i < sizeof grids / sizeof grids[0]; i++) {
        struct phantom_drawing drawing;
        conus_atlas *atlas = draw("sphere", &grids[i], &drawing);
        double volume = phantom_area_volume(&drawing, 1);
        struct found found = extract(atlas, MESH_DEFAULT_SMOOTH, 0);
        assert_int_equal(found.count, 1);
        assert_true(found.shapes[0].closed);
        assert_near(found.shapes[0].volume_mm3, volume, 0.03 * volume);
        for (int a = 0; a < 3; a++) {
            assert_near(found.shapes[0].centroid[a], drawing.shapes[0].centre[a], 0.05);
            assert_near(found.shapes[0].low[a], -drawing.shapes[0].radius, 1);
            assert_near(found.shapes[0].high[a], drawing.shapes[0].radius, 1);
        }
        conus_atlas_destroy(atlas);
        phantom_drawing_finish(&drawing);
    }
}

/* Voxels painted on one side only. */
static conus_atlas *one_sided(bool flip, double voxels_on_the_right)
{
    enum { EDGE = 16, COUNT = EDGE * EDGE * EDGE };
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "made", .dim = {EDGE, EDGE, EDGE}};
    struct notes notes = {0};
    struct label_table table = {0};
    conus_atlas *atlas;
    uint32_t *labels = memory_zeroed(COUNT, sizeof *labels);
    mat4_identity(info.world_from_voxel);
    info.world_from_voxel[0] = flip ? -1 : 1;
    info.world_from_voxel[12] = flip ? 7.5 : -7.5; /* x from -7.5 to 7.5 either way */
    for (int i = 0; i < 3; i++) {
        info.spacing[i] = 1;
    }
    for (size_t v = 0; v < COUNT; v++) {
        double x = info.world_from_voxel[0] * (double)(v % EDGE) + info.world_from_voxel[12];
        labels[v] = x > 0 && x < voxels_on_the_right ? 70000 : 0;
    }
    assert_ok(atlas_create(&atlas, &info, labels, &table, "none", &notes));
    memory_free(labels);
    notes_finish(&notes);
    return atlas;
}

/* Without smoothing, a slab that reaches the volume's borders is closed there, half a voxel outside its outermost
 * centres, on the same side. Edges and corners are cut: 12 edges and 8 corners of less than a voxel's width. */
static void right_stays_right_and_borders_are_closed(void **state)
{
    (void)state;
    test_need_conus_mesh();
    for (int flip = 0; flip < 2; flip++) {
        conus_atlas *atlas = one_sided(flip, 4);
        struct found found = extract(atlas, 0, 0);
        assert_int_equal(found.count, 1);
        assert_true(found.shapes[0].closed);
        assert_near(found.shapes[0].low[0], 0, 1e-6);
        assert_near(found.shapes[0].high[0], 4, 1e-6);
        assert_near(found.shapes[0].low[1], -0.5, 1e-6);
        assert_near(found.shapes[0].high[1], 15.5, 1e-6);
        double edges = 4.0 * (4 + 16 + 16) / 8;
        assert_true(found.shapes[0].volume_mm3 < 4 * 16 * 16);
        assert_near(found.shapes[0].volume_mm3, 4 * 16 * 16 - edges, 2);
        conus_atlas_destroy(atlas);
    }
}

static void decimation_removes_what_it_is_told_to(void **state)
{
    (void)state;
    test_need_conus_mesh();
    struct phantom_drawing drawing;
    conus_atlas *atlas = draw("sphere", NULL, &drawing);
    struct found whole = extract(atlas, MESH_DEFAULT_SMOOTH, 0);
    struct found tenth = extract(atlas, MESH_DEFAULT_SMOOTH, 0.9);
    assert_near((double)tenth.triangles[0] / (double)whole.triangles[0], 0.1, 0.01);
    assert_true(tenth.shapes[0].closed);
    assert_near(tenth.shapes[0].volume_mm3, whole.shapes[0].volume_mm3, 0.01 * whole.shapes[0].volume_mm3);
    conus_atlas_destroy(atlas);
    phantom_drawing_finish(&drawing);
}

/* Volume and centroid of every area by its voxels. */
static void add_up_voxels(double (*centroids)[3], const conus_atlas *atlas)
{
    const struct volume *volume = &atlas->volumes[0];
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint32_t number = volume_object(volume, v);
        const size_t *dim = volume->info.dim;
        size_t row = v / dim[0];
        size_t plane = row / dim[1];
        double p[3] = {(double)(v % dim[0]), (double)(row % dim[1]), (double)plane};
        if (number) {
            mat4_point(p, volume->info.world_from_voxel, p);
            vec3_add_scaled(centroids[number - 1], centroids[number - 1], 1 / (double)atlas->objects[number - 1].voxels,
                            p);
        }
    }
}

static void aal_areas_are_closed_and_keep_volume_and_place(void **state)
{
    (void)state;
    test_need_conus_mesh();
    static double centroids[MOST_AREAS][3];
    conus_atlas *atlas;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    struct found found = extract(atlas, MESH_DEFAULT_SMOOTH, 0);
    assert_int_equal(found.count, 116);
    add_up_voxels(centroids, atlas);
    for (size_t i = 0; i < found.count; i++) {
        double off[3];
        const double large = 1000;
        double volume = atlas->objects[i].volume_mm3;
        assert_true(found.shapes[i].closed);
        assert_near(found.shapes[i].volume_mm3, volume, (volume > large ? 0.03 : 0.06) * volume);
        vec3_sub(off, found.shapes[i].centroid, centroids[i]);
        assert_true(vec3_length(off) < 0.5);
    }
    conus_atlas_destroy(atlas);
}

TEST_GROUP(mesh_extract)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_is_one_wherever_the_voxels_point),
        cmocka_unit_test(right_stays_right_and_borders_are_closed),
        cmocka_unit_test(decimation_removes_what_it_is_told_to),
        cmocka_unit_test(aal_areas_are_closed_and_keep_volume_and_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
