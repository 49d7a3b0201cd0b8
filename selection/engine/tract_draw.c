/* SPDX-License-Identifier: BSD-3-Clause */
/* Settles the runs that the driver proposes. */
#include "selection/engine/tract_draw.h"

#include "base/memory.h"

/* Intervals are joined when there are this many, and then whenever their number has doubled since: so they take at most
 * about twice their final memory. */
enum { JOIN_AT = 1 << 16 };

struct tract_draw {
    const struct tract_rays *rays;
    struct tract_pass *pass;
    uint64_t proposals;
};

/* Finds which streamlines of a scene belong to an object; NULL if all do. */
static conus_status find_shown(const bool **out, const struct tract_rays *rays, size_t scene)
{
    size_t count = tract_rays_tractogram(rays, scene)->streamline_count;
    size_t found = 0;
    bool *shown = memory_raw(count, sizeof *shown);
    if (!shown) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t s = 0; s < count; s++) {
        shown[s] = tract_rays_has(rays, scene, (uint32_t)s);
        found += shown[s];
    }
    *out = found < count ? shown : NULL;
    if (!*out) {
        memory_free(shown);
    }
    return CONUS_OK;
}

conus_status tract_draw_create(struct tract_draw **out, const struct tract_rays *rays, uint64_t *memory_left)
{
    struct tract_draw *draw = memory_zeroed(1, sizeof *draw);
    if (!draw) {
        return CONUS_ERROR_MEMORY;
    }
    draw->rays = rays;
    size_t count = tract_rays_scenes(draw->rays);
    struct tract_source *sources = memory_zeroed(count, sizeof *sources);
    conus_status status = sources ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        sources[i].tractogram = tract_rays_tractogram(draw->rays, i);
        status = find_shown(&sources[i].shown, draw->rays, i);
    }
    if (!status && tract_pass_fits(sources, count, *memory_left)) {
        status = tract_pass_create(&draw->pass, sources, count, memory_left);
    }
    for (size_t i = 0; i < count && sources; i++) {
        memory_free((void *)sources[i].shown);
    }
    memory_free(sources);
    if (status || !draw->pass) {
        tract_draw_destroy(draw);
        draw = NULL;
    }
    *out = status ? *out : draw;
    return status;
}

void tract_draw_destroy(struct tract_draw *draw)
{
    if (draw) {
        tract_pass_destroy(draw->pass);
        memory_free(draw);
    }
}

uint64_t tract_draw_proposals(const struct tract_draw *draw)
{
    return draw->proposals;
}

struct tracing {
    struct tract_draw *draw;
    const struct tract_picture *pictures;
};

static conus_status offer_proposal(void *user, const struct tract_proposal *proposal)
{
    const struct tracing *tracing = user;
    const struct tract_picture *picture = &tracing->pictures[proposal->query];
    uint32_t pixel = proposal->pixel;
    const struct tract_hit hit = {&picture->out->object[pixel], &picture->out->distance[pixel],
                                  &picture->out->voxel[pixel]};
    tracing->draw->proposals++;
    tract_rays_offer(tracing->draw->rays, &hit, proposal->source, proposal->run, picture->query.origins[pixel],
                     picture->query.directions[pixel]);
    return CONUS_OK;
}

conus_status tract_draw_trace(struct tract_draw *draw, const struct tract_picture *pictures, size_t count)
{
    struct tracing tracing = {draw, pictures};
    struct tract_query *queries = memory_raw(count, sizeof *queries);
    if (!queries) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        queries[i] = pictures[i].query;
    }
    conus_status status = tract_pass_render(draw->pass, queries, count, offer_proposal, &tracing);
    memory_free(queries);
    return status;
}

struct piercing {
    struct tract_draw *draw;
    const struct tract_query *query;
    struct layers *out;
    size_t first, join_at; /* intervals from the first one on are joined at that many */
};

static conus_status add_proposal(void *user, const struct tract_proposal *proposal)
{
    struct piercing *piercing = user;
    uint32_t pixel = proposal->pixel;
    piercing->draw->proposals++;
    if (piercing->out->count - piercing->first >= piercing->join_at) {
        tract_rays_join(piercing->out, piercing->first);
        size_t left = 2 * (piercing->out->count - piercing->first);
        piercing->join_at = left > JOIN_AT ? left : JOIN_AT;
    }
    return tract_rays_add(piercing->draw->rays, piercing->out, pixel, proposal->source, proposal->run,
                          piercing->query->origins[pixel], piercing->query->directions[pixel]);
}

conus_status tract_draw_pierce(struct tract_draw *draw, struct layers *out, const struct tract_picture *picture)
{
    struct piercing piercing = {draw, &picture->query, out, out->count, JOIN_AT};
    conus_status status = tract_pass_render(draw->pass, &picture->query, 1, add_proposal, &piercing);
    if (!status) {
        tract_rays_join(out, piercing.first);
    }
    return status;
}
