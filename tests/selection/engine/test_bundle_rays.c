/* SPDX-License-Identifier: BSD-3-Clause */
/* Engines and bundles: streamlines among voxels and triangles, by both engines, against the atlas without them and a
 * loop over all capsules (Eq. 18). */
#include "atlas/atlas.h"
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "gl_edge.h"
#include "gl_pair.h"
#include "mesh_scene.h"
#include "scene.h"
#include "test.h"

#include <string.h>

enum { STREAMLINES = 30, POINTS = 25, RESOLUTION = 16, PIXELS = RESOLUTION * RESOLUTION };

/* The same voxels and triangles twice: without streamlines, and with. */
struct pair {
    conus_atlas *without, *with;
    uint32_t odd, even; /* Bundles of those; the even ones are also in the odd bundle if their number is below 10. */
};

static conus_atlas *voxels_and_triangles(uint64_t seed)
{
    const size_t dim[3] = {12, 11, 10};
    uint64_t random = seed;
    uint32_t labels[12 * 11 * 10];
    conus_volume_info info = scene_grid(&random, dim);
    for (size_t v = 0; v < sizeof labels / sizeof labels[0]; v++) {
        labels[v] = v == 0 || test_random(&random, 0, 1) < 0.03 ? 1 + (uint32_t)test_random(&random, 0, 5) : 0;
    }
    conus_atlas *atlas = scene_parcellation(&info, labels);
    mesh_scene_add_soups(atlas, &random);
    return atlas;
}

static struct tractogram random_walks(uint64_t *random)
{
    struct tractogram made = {.path = memory_text("walks.tck", 9),
                              .points = memory_raw(STREAMLINES * POINTS, 3 * sizeof(float)),
                              .first = memory_raw(STREAMLINES + 1, sizeof(uint64_t)),
                              .point_count = STREAMLINES * POINTS,
                              .streamline_count = STREAMLINES,
                              .radius = 0.4};
    assert_true(made.path && made.points && made.first);
    for (uint64_t s = 0; s <= STREAMLINES; s++) {
        made.first[s] = s * POINTS;
    }
    for (uint64_t i = 0; i < 3 * made.point_count; i++) {
        bool begins = i / 3 % POINTS == 0;
        double from = begins ? 0 : (double)made.points[i - 3];
        made.points[i] = (float)(from + test_random(random, -1, 1) * (begins ? 10 : 1));
    }
    return made;
}

static void add_group(struct tractogram *to, const char *name, uint32_t from)
{
    struct tract_group *groups = memory_resize(to->groups, to->group_count + 1, sizeof *groups);
    uint32_t *members = memory_raw(STREAMLINES, sizeof *members);
    size_t count = 0;
    assert_true(groups && members);
    for (uint32_t s = 0; s < STREAMLINES; s++) {
        if (s % 2 == from || (from && s < 10)) {
            members[count++] = s;
        }
    }
    to->groups = groups;
    groups[to->group_count++] = (struct tract_group){memory_text(name, strlen(name)), members, count};
}

static struct pair make_pair(uint64_t seed)
{
    uint64_t random = seed;
    struct pair pair = {voxels_and_triangles(seed), voxels_and_triangles(seed), 0, 0};
    struct tractogram walks = random_walks(&random);
    add_group(&walks, "odd", 1);
    add_group(&walks, "even", 0);
    assert_ok(atlas_add_tractogram(pair.with, &walks, "rest"));
    pair.odd = (uint32_t)conus_atlas_object_count(pair.without) + 1;
    pair.even = pair.odd + 1;
    assert_int_equal(conus_atlas_object_count(pair.with), pair.even);
    return pair;
}

static void destroy_pair(struct pair *pair)
{
    conus_atlas_destroy(pair->without);
    conus_atlas_destroy(pair->with);
}

/* The lowest bundle that has a streamline and is not hidden; 0 = none. */
static uint32_t bundle_of(const struct pair *pair, uint64_t streamline)
{
    bool is_odd = streamline % 2 == 1 || streamline < 10;
    if (is_odd && !conus_atlas_is_hidden(pair->with, pair->odd)) {
        return pair->odd;
    }
    return streamline % 2 == 0 && !conus_atlas_is_hidden(pair->with, pair->even) ? pair->even : 0;
}

/* Tries each segment against the hit of a pixel's ray; objects' numbers of bundles are above all others. */
static void loop_pixel(struct evidence *evidence, const struct pair *pair, const struct cone *cone, uint32_t pixel)
{
    const struct tractogram *walks = atlas_bundle_tractogram(pair->with, pair->odd);
    double origin[3];
    double direction[3];
    cone_origin(origin, cone, pixel % RESOLUTION, pixel / RESOLUTION);
    cone_ray(direction, cone, pixel % RESOLUTION, pixel / RESOLUTION);
    for (uint64_t at = 0; at + 1 < walks->point_count; at++) {
        uint32_t object = bundle_of(pair, at / POINTS);
        double a[3];
        double b[3];
        double interval[2];
        tractogram_point(a, walks, at);
        tractogram_point(b, walks, at + 1);
        if (object && at % POINTS != POINTS - 1 && capsule_interval(interval, origin, direction, a, b, 0.4) &&
            interval[1] >= 0) {
            double t = fmax(interval[0], 0);
            if (t < evidence->distance[pixel] || (t == evidence->distance[pixel] && object < evidence->object[pixel])) {
                evidence->object[pixel] = object;
                evidence->distance[pixel] = t;
                evidence->voxel[pixel] = at;
            }
        }
    }
}

/* Returns the number of pixels that hit streamlines. */
static size_t compare_with_loop(const struct pair *pair, const struct cone *cone)
{
    struct evidence wanted;
    struct evidence got;
    size_t hits = 0;
    mesh_scene_trace(&wanted, pair->without, cone);
    mesh_scene_trace(&got, pair->with, cone);
    for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
        loop_pixel(&wanted, pair, cone, pixel);
        hits += got.object[pixel] == pair->odd || got.object[pixel] == pair->even;
    }
    gl_pair_same_evidence(&got, &wanted);
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

static struct cone random_cone(uint64_t *random, int number)
{
    struct cone cone = mesh_scene_random_cone(random, 12);
    cone.resolution = RESOLUTION;
    if (number % 4 == 3) { /* parallel rays */
        cone.angle = 0;
        cone.radius = 8;
    }
    return cone;
}

static void the_nearest_of_voxels_triangles_and_streamlines_is_hit(void **state)
{
    (void)state;
    uint64_t random = 3;
    size_t hits = 0;
    size_t all = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        struct pair pair = make_pair(seed);
        bool hidden[64] = {false};
        assert_true(pair.even < 64);
        hidden[pair.odd] = seed == 3;
        hidden[pair.even] = seed == 4;
        assert_ok(conus_atlas_set_hidden(pair.with, hidden));
        for (int i = 0; i < 8; i++, all += PIXELS) {
            struct cone cone = random_cone(&random, i);
            hits += compare_with_loop(&pair, &cone);
        }
        destroy_pair(&pair);
    }
    print_message("%zu of %zu pixels hit streamlines\n", hits, all);
    assert_true(hits > all / 10 && hits < all / 2);
}

/* All layers contain those of the atlas without bundles, and each hit of a bundle begins one of its intervals. */
static void layers_begin_with_the_hits(void **state)
{
    (void)state;
    uint64_t random = 4;
    struct pair pair = make_pair(5);
    struct engine *engines[2];
    assert_ok(engine_rays_create(&engines[0], pair.without, &(struct engine_options){0}));
    assert_ok(engine_rays_create(&engines[1], pair.with, &(struct engine_options){0}));
    for (int i = 0; i < 8; i++) {
        struct cone cone = random_cone(&random, i);
        struct layers without = gl_pair_pierce(engines[0], &cone);
        struct layers with = gl_pair_pierce(engines[1], &cone);
        struct evidence first = gl_pair_trace(engines[1], &cone);
        size_t found = 0;
        size_t hits[2] = {0};
        for (size_t k = 0; k < with.count; k++) {
            const conus_interval *it = &with.intervals[k];
            bool is_bundle = it->object >= pair.odd;
            assert_true(it->entry >= 0 && it->entry <= it->exit);
            assert_true(is_bundle || gl_pair_same_interval(it, &without.intervals[found]));
            found += !is_bundle;
            hits[0] += is_bundle && first.object[it->pixel] == it->object && first.distance[it->pixel] == it->entry &&
                       first.voxel[it->pixel] == it->voxel;
        }
        for (size_t pixel = 0; pixel < PIXELS; pixel++) {
            hits[1] += first.object[pixel] >= pair.odd;
        }
        assert_int_equal(found, without.count);
        assert_int_equal(hits[0], hits[1]);
        evidence_finish(&first);
        layers_finish(&with);
        layers_finish(&without);
    }
    engine_destroy(engines[0]);
    engine_destroy(engines[1]);
    destroy_pair(&pair);
}

/* Finds the pixels where a driver may see another triangle than the exact one, or none. */
static void find_edges(bool at_edge[PIXELS], const conus_atlas *atlas, const struct cone *cone)
{
    memset(at_edge, 0, PIXELS * sizeof *at_edge);
    for (uint32_t object = 1; object <= conus_atlas_object_count(atlas); object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        for (size_t triangle = 0; mesh && triangle < mesh->triangle_count; triangle++) {
            for (size_t pixel = 0; pixel < PIXELS; pixel++) {
                at_edge[pixel] = at_edge[pixel] || gl_edge_is_near(cone, mesh, triangle, pixel);
            }
        }
    }
}

static void leave_out(struct layers *layers, const bool at_edge[PIXELS])
{
    size_t kept = 0;
    for (size_t k = 0; k < layers->count; k++) {
        if (!at_edge[layers->intervals[k].pixel]) {
            layers->intervals[kept++] = layers->intervals[k];
        }
    }
    layers->count = kept;
}

/* Compares the first hits of the pixels that are not at an edge, and counts them. */
static size_t compare_hits(const struct gl_pair *pair, const struct cone *cone, const bool at_edge[PIXELS])
{
    struct evidence got = gl_pair_trace(pair->gl, cone);
    struct evidence wanted = gl_pair_trace(pair->rays, cone);
    size_t hits = 0;
    for (size_t pixel = 0; pixel < PIXELS; pixel++) {
        if (at_edge[pixel]) {
            got.object[pixel] = wanted.object[pixel];
            got.voxel[pixel] = wanted.voxel[pixel];
            got.distance[pixel] = wanted.distance[pixel];
        }
        hits += !at_edge[pixel] && wanted.object[pixel];
    }
    gl_pair_same_evidence(&got, &wanted);
    evidence_finish(&got);
    evidence_finish(&wanted);
    return hits;
}

static void both_engines_agree(void **state)
{
    (void)state;
    uint64_t random = 6;
    struct pair atlases = make_pair(6);
    struct gl_pair pair = gl_pair_create(atlases.with, CONUS_SAMPLING_EXACT);
    for (int i = 0; i < 4; i++) {
        bool at_edge[PIXELS];
        struct cone cone = random_cone(&random, i);
        find_edges(at_edge, atlases.with, &cone);
        assert_true(compare_hits(&pair, &cone, at_edge) > PIXELS / 10);
        struct layers got = gl_pair_pierce(pair.gl, &cone);
        struct layers wanted = gl_pair_pierce(pair.rays, &cone);
        leave_out(&got, at_edge);
        leave_out(&wanted, at_edge);
        assert_int_equal(got.count, wanted.count);
        for (size_t k = 0; k < got.count; k++) {
            assert_true(gl_pair_same_interval(&got.intervals[k], &wanted.intervals[k]));
        }
        layers_finish(&got);
        layers_finish(&wanted);
    }
    gl_pair_destroy(&pair);
    destroy_pair(&atlases);
}

/* One streamline along y, through (0, 0, 0), of radius 2, and a cylinder of parallel rays of radius 4 along x, from x =
 * -10. The ray at the height z enters at 10 - sqrt(4 - z*z), and is inside for twice the root. The path with `layers
 * all` is the mean of those. Sampling on slices is as exact. */
static void a_straight_streamline_has_a_closed_form(void **state)
{
    (void)state;
    static const float ends[] = {0, -50, 0, 0, 50, 0};
    static const uint64_t first[] = {0, 2};
    conus_atlas *atlas = mesh_scene_atlas();
    struct tractogram line = {.path = memory_text("line.tck", 8),
                              .points = memory_copy(ends, 6, sizeof *ends),
                              .first = memory_copy(first, 2, sizeof *first),
                              .point_count = 2,
                              .streamline_count = 1,
                              .radius = 2};
    assert_ok(atlas_add_tractogram(atlas, &line, "line"));
    struct cone cone = mesh_scene_cone((double[]){-10, 0, 0}, (double[]){0, 0, 0}, 20, RESOLUTION);
    cone.angle = 0;
    cone.radius = 4;
    struct evidence got;
    mesh_scene_trace(&got, atlas, &cone);
    double sum = 0;
    size_t hits = 0;
    for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
        double origin[3];
        cone_origin(origin, &cone, pixel % RESOLUTION, pixel / RESOLUTION);
        double square = 4 - origin[2] * origin[2];
        assert_int_equal(got.object[pixel], square >= 0);
        if (square >= 0) {
            assert_near(got.distance[pixel], 10 - sqrt(square), 1e-12);
            bool counts = cone_has_pixel(&cone, pixel % RESOLUTION, pixel / RESOLUTION);
            sum += counts ? 2 * sqrt(square) : 0;
            hits += counts;
        }
    }
    for (int slices = 0; slices < 2; slices++) {
        conus_selector_options options = {.struct_size = sizeof options, .resolution = 16, .radius = 4};
        options.layers = slices ? CONUS_LAYERS_VISIBLE : CONUS_LAYERS_ALL;
        options.sampling = slices ? CONUS_SAMPLING_SLICES : CONUS_SAMPLING_EXACT;
        conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
        const conus_result *result = conus_selection_result(selection, 0);
        assert_int_equal(result->pixels, hits);
        assert_true(slices || fabs(result->path - sum / (double)hits) < 1e-12);
        conus_selection_destroy(selection);
    }
    evidence_finish(&got);
    conus_atlas_destroy(atlas);
}

static conus_status create_and_trace(void *data)
{
    const struct pair *pair = data;
    const struct cone cone = mesh_scene_cone((double[]){-30, 0, 0}, (double[]){0, 0, 0}, 30, RESOLUTION);
    struct engine *engine;
    struct layers layers = {0};
    conus_status status = engine_rays_create(&engine, pair->with, &(struct engine_options){0});
    if (!status) {
        status = engine->functions->pierce(engine, &layers, &cone);
        layers_finish(&layers);
        engine_destroy(engine);
    }
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    struct pair pair = make_pair(7);
    test_every_allocation(create_and_trace, &pair);
    destroy_pair(&pair);
}

TEST_GROUP(bundle_rays)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearest_of_voxels_triangles_and_streamlines_is_hit),
        cmocka_unit_test(layers_begin_with_the_hits),
        cmocka_unit_test(a_straight_streamline_has_a_closed_form),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(both_engines_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
