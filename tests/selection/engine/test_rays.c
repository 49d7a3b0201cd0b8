/* SPDX-License-Identifier: BSD-3-Clause */
/* The rays engine against an oracle that visits every cell. */
#include "base/geometry/math3.h"
#include "oracle_traversal.h"
#include "scene.h"
#include "selection/engine/engine.h"
#include "selection/engine/voxels/traverse.h"
#include "test.h"

#include <string.h>

static void assert_same_pixel(const struct evidence *got, const struct evidence *wanted, size_t pixel)
{
    bool same = got->object[pixel] == wanted->object[pixel] && got->voxel[pixel] == wanted->voxel[pixel] &&
                (got->distance[pixel] == wanted->distance[pixel]);
    if (!same) {
        fail_msg("pixel %zu of %u x %u: object %u, voxel %llu, %.17g mm; wanted %u, %llu, %.17g", pixel,
                 got->resolution, got->resolution, got->object[pixel], (unsigned long long)got->voxel[pixel],
                 got->distance[pixel], wanted->object[pixel], (unsigned long long)wanted->voxel[pixel],
                 wanted->distance[pixel]);
    }
}

/* Returns the number of pixels that hit something. */
static size_t compare_with_oracle(struct engine *engine, const conus_atlas *atlas, const struct cone *cone)
{
    struct evidence got, wanted;
    size_t hits = 0;
    assert_ok(evidence_init(&got, cone->resolution));
    assert_ok(evidence_init(&wanted, cone->resolution));
    memset(got.object, 0xff, cone->resolution * cone->resolution * sizeof *got.object);
    assert_ok(engine->functions->trace(engine, &got, cone));
    oracle_trace(&wanted, atlas, cone);
    for (size_t pixel = 0; pixel < (size_t)cone->resolution * cone->resolution; pixel++) {
        assert_same_pixel(&got, &wanted, pixel);
        hits += wanted.object[pixel] != 0;
    }
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

/* Calls body for every kernel that this machine supports. */
static void for_kernels(const conus_atlas *atlas, void (*body)(struct engine *engine, const conus_atlas *atlas, void *),
                        void *data)
{
    const struct engine_options options = {0};
    for (size_t i = 0; traverse_kernel(i); i++) {
        struct engine *engine = NULL;
        if (traverse_kernel(i)->is_supported()) {
            assert_ok(engine_rays_create_with(&engine, atlas, &options, traverse_kernel(i)));
            body(engine, atlas, data);
            engine_destroy(engine);
        }
    }
}

struct poses {
    uint64_t random;
    int count;
    bool warm; /* after so many rays that the engine knows the objects by the voxels' codes */
    size_t hits;
};

static void trace_many_rays(struct engine *engine, const struct cone *cone)
{
    struct cone fine = *cone;
    struct evidence evidence;
    fine.resolution = 730;
    assert_ok(evidence_init(&evidence, fine.resolution));
    assert_ok(engine->functions->trace(engine, &evidence, &fine));
    evidence_finish(&evidence);
}

static void trace_from_random_poses(struct engine *engine, const conus_atlas *atlas, void *data)
{
    struct poses *poses = data;
    uint64_t random = poses->random;
    for (int pose = 0; pose < poses->count; pose++) {
        struct cone cone = scene_cone(&random, atlas);
        if (poses->warm && !pose) {
            trace_many_rays(engine, &cone);
        }
        poses->hits += compare_with_oracle(engine, atlas, &cone);
    }
}

/* Eq. 5, Eq. 6: object, voxel and distance equal the plain traversal's, to the last bit, for every ray. */
static void every_ray_equals_the_plain_traversal(void **state)
{
    (void)state;
    uint64_t random = 1;
    struct poses poses = {.count = 12};
    for (int scene = 0; scene < (int)test_trials(300); scene++) {
        conus_atlas *atlas = scene_atlas(&random, scene % 10 ? 24 : 70, scene % 3);
        poses.random = (uint64_t)scene;
        poses.warm = scene == 2;
        for_kernels(atlas, trace_from_random_poses, &poses);
        conus_atlas_destroy(atlas);
    }
    assert_true(poses.hits > test_trials(200000));
}

/* Eq. 5 without a traversal: the occupied cell that the ray enters first, by the slab method over all cells. */
static double nearest_entry(const struct volume *volume, const double origin[3], const double direction[3])
{
    double nearest = INFINITY;
    const size_t *dim = volume->info.dim;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        const size_t cell[3] = {v % dim[0], v / dim[0] % dim[1], v / dim[0] / dim[1]};
        double enter = 0;
        double leave = INFINITY;
        for (int a = 0; a < 3 && volume_object(volume, v); a++) {
            double near = ((double)cell[a] - 0.5 - origin[a]) / direction[a];
            double far = ((double)cell[a] + 0.5 - origin[a]) / direction[a];
            enter = fmax(enter, fmin(near, far));
            leave = fmin(leave, fmax(near, far));
        }
        nearest = volume_object(volume, v) && enter < leave ? fmin(nearest, enter) : nearest;
    }
    return nearest;
}

static void first_contact_is_the_nearest_cell(void **state)
{
    (void)state;
    uint64_t random = 3;
    const struct engine_options options = {0};
    for (int scene = 0; scene < 40; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 0);
        const struct volume *volume = &atlas->volumes[0];
        struct engine *engine = NULL;
        struct evidence evidence;
        struct cone cone = {.angle = 0.6, .resolution = 8, .pose = scene_generic_pose(&random, atlas)};
        assert_ok(engine_rays_create(&engine, atlas, &options));
        assert_ok(evidence_init(&evidence, cone.resolution));
        assert_ok(engine->functions->trace(engine, &evidence, &cone));
        double origin[3];
        mat4_point(origin, volume->voxel_from_world, cone.pose.world_from_device + 12);
        for (uint32_t pixel = 0; pixel < 64; pixel++) {
            double ray[3];
            cone_ray(ray, &cone, pixel % 8, pixel / 8);
            mat4_direction(ray, volume->voxel_from_world, ray);
            double wanted = nearest_entry(volume, origin, ray);
            assert_int_equal(evidence.object[pixel] != 0, wanted < INFINITY);
            if (wanted < INFINITY) {
                assert_near(evidence.distance[pixel], wanted, 1e-9);
            }
        }
        evidence_finish(&evidence);
        engine_destroy(engine);
        conus_atlas_destroy(atlas);
    }
}

/* A random rotation about a random axis, and a shift. */
static void random_motion(uint64_t *random, double m[16])
{
    double axis[3];
    double turn = test_random(random, 0, 6);
    for (int a = 0; a < 3; a++) {
        axis[a] = test_random(random, -1, 1);
    }
    assert_true(vec3_normalise(axis, axis));
    mat4_identity(m);
    for (int column = 0; column < 3; column++) { /* Rodrigues */
        double unit[3] = {column == 0, column == 1, column == 2};
        double cross[3];
        vec3_cross(cross, axis, unit);
        for (int row = 0; row < 3; row++) {
            m[4 * column + row] =
                unit[row] * cos(turn) + cross[row] * sin(turn) + axis[row] * axis[column] * (1 - cos(turn));
        }
        m[12 + column] = test_random(random, -300, 300);
    }
}

static void move_atlas(conus_atlas *atlas, const double motion[16])
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        struct volume *volume = &atlas->volumes[i];
        mat4_multiply(volume->info.world_from_voxel, motion, volume->info.world_from_voxel);
        assert_true(mat4_invert_affine(volume->voxel_from_world, volume->info.world_from_voxel));
    }
}

static void trace(struct evidence *out, const conus_atlas *atlas, const struct engine_options *options,
                  const struct cone *cone)
{
    struct engine *engine = NULL;
    assert_ok(evidence_init(out, cone->resolution));
    assert_ok(engine_rays_create(&engine, atlas, options));
    assert_ok(engine->functions->trace(engine, out, cone));
    engine_destroy(engine);
}

/* Moving atlas and device together changes nothing: Eq. 5 and Eq. 7 know no preferred frame. */
static void moving_everything_changes_nothing(void **state)
{
    (void)state;
    uint64_t random = 4;
    for (int scene = 0; scene < 60; scene++) {
        const struct engine_options options = {.sampling = scene % 2 ? CONUS_SAMPLING_SLICES : CONUS_SAMPLING_EXACT};
        conus_atlas *atlas = scene_atlas(&random, 24, 0);
        struct cone cone = {.angle = 0.5, .resolution = 16, .pose = scene_generic_pose(&random, atlas)};
        struct evidence still, moved;
        double motion[16];
        random_motion(&random, motion);
        trace(&still, atlas, &options, &cone);
        move_atlas(atlas, motion);
        mat4_multiply(cone.pose.world_from_device, motion, cone.pose.world_from_device);
        trace(&moved, atlas, &options, &cone);
        for (size_t pixel = 0; pixel < 256; pixel++) {
            assert_int_equal(still.object[pixel], moved.object[pixel]);
            assert_true(still.voxel[pixel] == moved.voxel[pixel]);
            if (still.object[pixel]) {
                assert_near(moved.distance[pixel], still.distance[pixel], 1e-8);
            }
        }
        evidence_finish(&still);
        evidence_finish(&moved);
        conus_atlas_destroy(atlas);
    }
}

/* Origins beyond TRAVERSE_FAR, where lanes may not estimate their start, and an empty volume. */
static void extreme_views_equal_the_plain_traversal(void **state)
{
    (void)state;
    uint64_t random = 8;
    for (int scene = 0; scene < 20; scene++) {
        conus_atlas *atlas = scene_atlas(&random, 24, 1);
        if (scene % 4 == 0) {
            memset(atlas->volumes[0].objects16, 0, atlas->volumes[0].voxel_count * sizeof(uint16_t));
        }
        struct cone cone = {.angle = 1e-8, .resolution = 6, .pose = scene_generic_pose(&random, atlas)};
        double *device = cone.pose.world_from_device;
        vec3_scale(device + 12, device + 8, 1e9);
        const struct engine_options options = {0};
        struct engine *engine = NULL;
        assert_ok(engine_rays_create(&engine, atlas, &options));
        compare_with_oracle(engine, atlas, &cone);
        engine_destroy(engine);
        conus_atlas_destroy(atlas);
    }
}

/* Specks of dust, so that every ray passes many of them closely. */
static void sprinkle(struct volume *volume, uint64_t *random)
{
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint16_t object = test_random(random, 0, 1) < 0.02 ? 1 : 0;
        if (volume->objects16) {
            volume->objects16[v] = object;
        } else {
            volume->objects32[v] = object;
        }
    }
}

/* A pose almost along an axis of the grid, from a place almost between two layers of cells: tiny tilts and offsets
 * decide which cells are hit. */
static conus_pose shallow_pose(uint64_t *random, const struct volume *volume)
{
    int along = (int)test_random(random, 0, 3);
    double side = test_random(random, 0, 1) < 0.5 ? -1 : 1;
    double from[3], to[3];
    conus_pose pose;
    for (int a = 0; a < 3; a++) {
        double size = (double)volume->info.dim[a];
        from[a] = floor(test_random(random, 0, size)) - 0.5 + pow(10, test_random(random, -12, -1));
        to[a] = from[a] + pow(10, test_random(random, -12, -1)) * size;
        if (a == along) {
            from[a] = size / 2 + side * size * test_random(random, 0, 2);
            to[a] = from[a] - side * size;
        }
    }
    mat4_point(from, volume->info.world_from_voxel, from);
    mat4_point(to, volume->info.world_from_voxel, to);
    assert_ok(conus_pose_toward(&pose, from, to, NULL));
    return pose;
}

static void trace_shallowly(struct engine *engine, const conus_atlas *atlas, void *data)
{
    struct poses *poses = data;
    uint64_t random = poses->random;
    for (int pose = 0; pose < poses->count; pose++) {
        struct cone cone = {.angle = pow(10, test_random(&random, -9, -1)),
                            .resolution = pose % 2 ? 15 : 16,
                            .pose = shallow_pose(&random, &atlas->volumes[0])};
        poses->hits += compare_with_oracle(engine, atlas, &cone);
    }
}

static void shallow_rays_equal_the_plain_traversal(void **state)
{
    (void)state;
    uint64_t random = 9;
    struct poses poses = {.count = 20};
    for (int scene = 0; scene < (int)test_trials(40); scene++) {
        conus_atlas *atlas = scene_atlas(&random, 100, 0);
        sprinkle(&atlas->volumes[0], &random);
        poses.random = (uint64_t)scene;
        for_kernels(atlas, trace_shallowly, &poses);
        conus_atlas_destroy(atlas);
    }
    assert_true(poses.hits > test_trials(100000));
}

/* Eq. 7 literally: tries each plane of the volume's depth range in front of the device, in turn. */
static uint32_t first_on_slices(const struct volume *volume, const struct cone *cone, uint32_t pixel, uint32_t count)
{
    const double *device = cone->pose.world_from_device;
    double ray[3];
    double near = INFINITY;
    double far = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = corner >> a & 1 ? (double)volume->info.dim[a] - 0.5 : -0.5;
        }
        mat4_point(p, volume->info.world_from_voxel, p);
        vec3_sub(p, p, device + 12);
        near = fmin(near, -vec3_dot(p, device + 8));
        far = fmax(far, -vec3_dot(p, device + 8));
    }
    near = fmax(near, 0);
    cone_ray(ray, cone, pixel % cone->resolution, pixel / cone->resolution);
    for (uint32_t k = 0; k < count && far > near; k++) {
        double depth = near + (k + 0.5) / count * (far - near);
        double p[3];
        long cell[3];
        bool inside = true;
        vec3_add_scaled(p, device + 12, depth / -vec3_dot(ray, device + 8), ray);
        mat4_point(p, volume->voxel_from_world, p);
        for (int a = 0; a < 3; a++) {
            cell[a] = (long)floor(p[a] + 0.5);
            inside = inside && cell[a] >= 0 && cell[a] < (long)volume->info.dim[a];
        }
        long voxel = cell[0] + (long)volume->info.dim[0] * (cell[1] + (long)volume->info.dim[1] * cell[2]);
        if (inside && volume_object(volume, (size_t)voxel)) {
            return volume_object(volume, (size_t)voxel);
        }
    }
    return 0;
}

static void slices_hit_what_lies_on_their_planes(void **state)
{
    (void)state;
    uint64_t random = 9;
    size_t hits = 0;
    for (int scene = 0; scene < 60; scene++) {
        uint32_t eighths = (uint32_t)scene % 9; /* of the planes; 0: the paper's fifth */
        const struct engine_options options = {.sampling = CONUS_SAMPLING_SLICES,
                                               .slices = 3 + 11 * (uint32_t)(scene % 7),
                                               .slice_fraction = eighths / 8.0};
        conus_atlas *atlas = scene_atlas(&random, 24, 0);
        struct cone cone = {.angle = 0.5, .resolution = 12, .pose = scene_generic_pose(&random, atlas)};
        struct evidence evidence;
        trace(&evidence, atlas, &options, &cone);
        uint32_t planes = eighths ? options.slices * eighths / 8 : options.slices / 5;
        planes = planes ? planes : 1;
        for (uint32_t pixel = 0; pixel < 144; pixel++) {
            uint32_t wanted = first_on_slices(&atlas->volumes[0], &cone, pixel, planes);
            assert_int_equal(evidence.object[pixel], wanted);
            assert_int_equal(wanted != 0, evidence.distance[pixel] < INFINITY);
            hits += wanted != 0;
        }
        evidence_finish(&evidence);
        conus_atlas_destroy(atlas);
    }
    assert_true(hits > 500);
}

static conus_status create_and_destroy(void *atlas)
{
    const struct engine_options options = {0};
    struct engine *engine = NULL;
    conus_status status = engine_rays_create(&engine, atlas, &options);
    engine_destroy(engine);
    return status;
}

static void creation_survives_every_failing_allocation(void **state)
{
    (void)state;
    uint64_t random = 2;
    conus_atlas *atlas = scene_atlas(&random, 20, 2);
    test_every_allocation(create_and_destroy, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(rays)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_equals_the_plain_traversal),
        cmocka_unit_test(first_contact_is_the_nearest_cell),
        cmocka_unit_test(moving_everything_changes_nothing),
        cmocka_unit_test(extreme_views_equal_the_plain_traversal),
        cmocka_unit_test(shallow_rays_equal_the_plain_traversal),
        cmocka_unit_test(slices_hit_what_lies_on_their_planes),
        cmocka_unit_test(creation_survives_every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
