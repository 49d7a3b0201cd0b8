/* SPDX-License-Identifier: BSD-3-Clause */
/* The torus scene in all layers (Eq. 10), against what is visible and against every triangle of every torus. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "bench/torus/torus_ways.h"
#include "tests/support/oracle_triangle.h"

#include <stdio.h>
#include <string.h>

/* Pixels whose first interval is not what is visible, to the bit. */
static size_t count_other_firsts(const struct layer_way *layers, const struct layer_way *visible)
{
    size_t count = 0;
    for (size_t i = 0; i < layers->cone_count; i++) {
        const struct evidence *seen = &visible->visible[i];
        struct evidence *first = &layers->visible[i];
        (void)layers_first(first, &layers->all_hits[i]);
        for (size_t p = 0; p < TORUS_PIXELS; p++) {
            bool same = first->object[p] == seen->object[p] && first->voxel[p] == seen->voxel[p];
            count += !same || first->distance[p] != seen->distance[p];
        }
    }
    return count;
}

/* All triangles of a torus, if the ray passes the ball around it. */
static bool pierces(const struct mesh *mesh, const double centre[3], const double origin[3], const double direction[3])
{
    double away[3];
    vec3_sub(away, centre, origin);
    double along = vec3_dot(away, direction);
    bool found = false;
    int side;
    if (vec3_dot(away, away) - along * along <= 1.01 * TORUS_RADIUS * TORUS_RADIUS) {
        for (size_t i = 0; i < mesh->triangle_count && !found; i++) {
            found = oracle_triangle(&side, mesh, i, origin, direction) < INFINITY;
        }
    }
    return found;
}

/* What all triangles say of one cone. */
struct truth {
    size_t pierced, objects;            /* pairs of a ray and a torus in it; tori in the cone */
    size_t other_pierced, lost_objects; /* pairs that the intervals have otherwise; tori that they lack */
};

static void compare_torus(struct truth *truth, const struct cone *cone, const bool *has, const struct mesh *mesh,
                          const double centre[3])
{
    size_t wanted = 0, got = 0;
    for (uint32_t pixel = 0; pixel < TORUS_PIXELS; pixel++) {
        double direction[3];
        cone_ray(direction, cone, pixel % TORUS_RESOLUTION, pixel / TORUS_RESOLUTION);
        bool found = pierces(mesh, centre, cone->pose.world_from_device + 12, direction);
        wanted += found;
        got += has[pixel];
        truth->other_pierced += found != has[pixel];
    }
    truth->pierced += wanted;
    truth->objects += wanted > 0;
    truth->lost_objects += wanted > 0 && got == 0;
}

static conus_status find_truth(struct truth *out, const struct layer_way *way, const conus_atlas *atlas,
                               const struct torus_scene *scene)
{
    bool(*has)[TORUS_PIXELS] = memory_raw(scene->count, sizeof *has);
    if (!has) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < way->cone_count; i++) {
        memset(has, 0, scene->count * sizeof *has);
        for (size_t s = 0; s < way->all_hits[i].count; s++) {
            has[way->all_hits[i].intervals[s].object - 1][way->all_hits[i].intervals[s].pixel] = true;
        }
        for (size_t torus = 0; torus < scene->count; torus++) {
            compare_torus(out, &way->cones[i], has[torus], &atlas->meshes[torus], scene->places[torus] + 12);
        }
    }
    memory_free(has);
    return CONUS_OK;
}

static conus_status check_layers(bool *equal, const struct layer_round *round)
{
    struct truth truth = {0};
    size_t firsts = count_other_firsts(&round->ways[1], &round->ways[0]);
    conus_status status = find_truth(&truth, &round->ways[1], round->atlas, &round->scene);
    double cones = (double)round->ways[1].cone_count;
    printf("%zu tori: %.1f in a cone, pierced by %.1f rays each; against all triangles in double %zu of %zu pairs of a "
           "ray and a torus differ, %zu tori are missing; %zu first intervals are not what is visible\n",
           round->scene.count, (double)truth.objects / cones, (double)truth.pierced / (double)truth.objects,
           truth.other_pierced, truth.pierced, truth.lost_objects, firsts);
    *equal = !firsts && !truth.lost_objects && truth.other_pierced <= truth.pierced / 10000;
    return status;
}

static conus_status measure_layers(struct bench *bench, struct layer_round *round)
{
    static const char *const names[LAYER_WAYS] = {
        "20000 tori, rays engine, visible", "20000 tori, rays engine, all layers", "20000 tori, whole query, visible",
        "20000 tori, whole query, all layers"};
    struct bench_variant variants[LAYER_WAYS];
    bool equal;
    conus_status status = CONUS_OK;
    for (size_t w = 0; w < LAYER_WAYS && !status; w++) {
        status = layer_way_init(round, w, w < 2 ? round->rays : NULL, w % 2);
    }
    if (status) {
        return status;
    }
    layer_round_variants(variants, round, names);
    status = check_layers(&equal, round);
    variants[1].equal = variants[1].equal && equal;
    variants[3].equal = variants[3].equal && equal;
    status = status ? status
                    : bench_measure(bench, "layers", variants, LAYER_WAYS, bench->options.poses, bench->options.angle);
    status = status ? status : bench_ratio(bench, "layers_over_visible", &variants[1], &variants[0]);
    return status ? status : bench_ratio(bench, "layers_over_visible_query", &variants[3], &variants[2]);
}

conus_status bench_layers(struct bench *bench)
{
    struct layer_round round;
    bench->one_thread = true;
    conus_status status = layer_round_init(&round, &bench->options, false);
    if (!status) {
        snprintf(bench->driver, sizeof bench->driver, "%s", round.rays->name);
        status = measure_layers(bench, &round);
    }
    layer_round_finish(&round);
    return status;
}
