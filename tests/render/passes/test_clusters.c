/* SPDX-License-Identifier: BSD-3-Clause */
/* Clusters hold every triangle once. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "render/passes/id_pass.h"
#include "test.h"

enum { MESHES = 5 };

struct scene {
    conus_atlas *atlas;
    const struct mesh *meshes[MESHES];
};

/* Objects 2 and 5 are soups, 3 a torus, 4 a single triangle; 1 is no mesh. */
static struct scene make_scene(uint64_t *random)
{
    struct scene scene = {0};
    struct mesh meshes[] = {mesh_scene_soup(random, 700, 30, 5), mesh_scene_torus(25, 6, 20, 12),
                            mesh_scene_soup(random, 1, 30, 5), mesh_scene_soup(random, 129, 50, 3)};
    assert_ok(atlas_create_empty(&scene.atlas, "test"));
    for (int i = 0; i < 4; i++) {
        mesh_scene_add(scene.atlas, &meshes[i]);
    }
    for (uint32_t i = 1; i < MESHES; i++) {
        scene.meshes[i] = atlas_object_mesh(scene.atlas, i);
    }
    return scene;
}

static void assert_in_ball(const float *ball, const float *position)
{
    double offset[3];
    for (int a = 0; a < 3; a++) {
        offset[a] = (double)position[a] - (double)ball[a];
    }
    assert_true(vec3_length(offset) <= (double)ball[3]);
}

static bool is_same_place(const struct clusters *clusters, uint32_t vertex, const struct mesh *mesh, uint32_t wanted)
{
    const float *a = &clusters->positions[3 * (size_t)vertex];
    const float *b = &mesh->positions[3 * (size_t)wanted];
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* A triangle as drawn is one of the mesh's triangles, its corners in the same cyclic order, and its last corner belongs
 * to no other. */
static void check_triangle(const struct clusters *clusters, const struct mesh *mesh, size_t drawn)
{
    const uint32_t *corner = &clusters->corners[3 * drawn];
    const uint32_t *wanted = &mesh->triangles[3 * (size_t)clusters->triangle[drawn]];
    bool same = false;
    assert_int_equal(corner[2], drawn);
    assert_true(corner[0] < clusters->vertex_count && corner[1] < clusters->vertex_count);
    for (size_t turn = 0; turn < 3; turn++) {
        same = same || (is_same_place(clusters, corner[0], mesh, wanted[turn]) &&
                        is_same_place(clusters, corner[1], mesh, wanted[(turn + 1) % 3]) &&
                        is_same_place(clusters, corner[2], mesh, wanted[(turn + 2) % 3]));
    }
    assert_true(same);
}

static void check_cluster(const struct clusters *clusters, const struct cluster *cluster, const struct scene *scene,
                          bool (*seen)[1000])
{
    assert_true(cluster->count >= 1 && cluster->count <= CLUSTER_TRIANGLES);
    for (uint32_t drawn = cluster->first; drawn < cluster->first + cluster->count; drawn++) {
        bool *here = &seen[cluster->object - 1][clusters->triangle[drawn]];
        assert_false(*here);
        *here = true;
        check_triangle(clusters, scene->meshes[cluster->object - 1], drawn);
        assert_ptr_equal(clusters_find(clusters, drawn), cluster);
        for (size_t k = 0; k < 3; k++) {
            assert_in_ball(&clusters->balls[4 * (cluster - clusters->cluster)],
                           &clusters->positions[3 * (size_t)clusters->corners[3 * (size_t)drawn + k]]);
        }
    }
}

static void clusters_hold_every_triangle_once(void **state)
{
    (void)state;
    static bool seen[MESHES][1000];
    uint64_t random = 1;
    struct scene scene = make_scene(&random);
    struct clusters clusters;
    assert_ok(clusters_init(&clusters, scene.meshes, MESHES));
    assert_int_equal(clusters.triangle_count, 700 + 480 + 1 + 129);
    size_t next = 0;
    for (size_t c = 0; c < clusters.cluster_count; c++) {
        assert_int_equal(clusters.cluster[c].first, next);
        check_cluster(&clusters, &clusters.cluster[c], &scene, seen);
        next += clusters.cluster[c].count;
    }
    assert_int_equal(next, clusters.triangle_count);
    clusters_finish(&clusters);
    conus_atlas_destroy(scene.atlas);
}

/* A closed mesh has two triangles to a vertex: almost no vertices beyond one for each triangle. */
static void closed_meshes_need_few_more_vertices(void **state)
{
    (void)state;
    struct mesh torus = mesh_scene_torus(25, 6, 64, 64);
    const struct mesh *meshes[] = {&torus};
    struct clusters clusters;
    assert_ok(clusters_init(&clusters, meshes, 1));
    assert_true((double)clusters.vertex_count < 1.1 * (double)clusters.triangle_count);
    clusters_finish(&clusters);
    mesh_finish(&torus);
}

static conus_status make_and_free(void *scene)
{
    struct clusters clusters = {0};
    conus_status status = clusters_init(&clusters, ((struct scene *)scene)->meshes, MESHES);
    clusters_finish(&clusters);
    return status;
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    uint64_t random = 3;
    struct scene scene = make_scene(&random);
    test_every_allocation(make_and_free, &scene);
    conus_atlas_destroy(scene.atlas);
}

TEST_GROUP(clusters)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clusters_hold_every_triangle_once),
        cmocka_unit_test(closed_meshes_need_few_more_vertices),
        cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
