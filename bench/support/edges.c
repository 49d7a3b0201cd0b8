/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares identifiers pixel by pixel and sorts the differences into edges and errors. */
#include "bench/support/edges.h"

#include "base/geometry/math3.h"

#include <stdio.h>

/* Pixels by which a driver's vertex grid may move an edge. */
#define EDGE_PIXELS (1 / 128.0)

/* Whether a ray within EDGE_PIXELS of the pixel's centre hits the object: nine rays of a tiny cone round it. */
static bool is_near(struct engine *rays, const struct cone *cone, uint32_t pixel, uint32_t object)
{
    struct cone tiny = {.resolution = 3};
    struct evidence evidence;
    double direction[3];
    bool found = false;
    cone_ray(direction, cone, pixel % cone->resolution, pixel / cone->resolution);
    double foreshortening = -vec3_dot(direction, cone->pose.world_from_device + 8);
    double step = EDGE_PIXELS * 2 * tan(cone->angle / 2) / cone->resolution * foreshortening;
    tiny.angle = 2 * atan(1.5 * step);
    if (!conus_pose_along(&tiny.pose, cone->pose.world_from_device + 12, direction, NULL) &&
        !evidence_init(&evidence, tiny.resolution)) {
        if (!rays->functions->trace(rays, &evidence, &tiny)) {
            for (int i = 0; i < 9; i++) {
                found = found || evidence.object[i] == object;
            }
        }
        evidence_finish(&evidence);
    }
    return found;
}

void bench_compare_pixels(struct bench_differences *sum, struct engine *rays, const struct cone *cone,
                          const uint32_t *named, const uint32_t *hits)
{
    for (uint32_t pixel = 0; pixel < cone->resolution * cone->resolution; pixel++) {
        if (named[pixel] != hits[pixel]) {
            bool near = is_near(rays, cone, pixel, named[pixel]);
            sum->at_edges += near;
            sum->elsewhere += !near;
        }
    }
}

bool bench_differences_pass(const struct bench_differences *differences, const char *name, size_t pixels)
{
    if (differences->at_edges || differences->elsewhere) {
        printf("%s: %zu of %zu pixels differ from the rays' at edges, %zu elsewhere\n", name, differences->at_edges,
               pixels, differences->elsewhere);
    }
    return !differences->elsewhere;
}
