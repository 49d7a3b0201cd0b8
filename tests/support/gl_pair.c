/* SPDX-License-Identifier: BSD-3-Clause */
#include "gl_pair.h"

#include "selection/engine/engine.h"
#include "test.h"

static int messages;

static void count_message(void *user, const char *line)
{
    *(int *)user += 1;
    print_message("%s\n", line);
}

int gl_pair_messages(void)
{
    return messages;
}

struct gl_pair gl_pair_create(const conus_atlas *atlas, conus_sampling sampling)
{
    const struct engine_options options = {.sampling = sampling, .log = count_message, .log_user = &messages};
    struct gl_pair pair = {.atlas = atlas};
    conus_status status = engine_gl_create(&pair.gl, atlas, &options);
    if (status == CONUS_ERROR_GL) {
        print_message("skipped: %s\n", conus_message());
        skip();
    }
    assert_ok(status);
    assert_ok(engine_rays_create(&pair.rays, atlas, &options));
    return pair;
}

void gl_pair_destroy(struct gl_pair *pair)
{
    engine_destroy(pair->gl);
    engine_destroy(pair->rays);
}

struct layers gl_pair_pierce(struct engine *engine, const struct cone *cone)
{
    struct layers layers = {0};
    assert_ok(engine->functions->pierce(engine, &layers, cone));
    assert_ok(layers_sort(&layers, (size_t)cone->resolution * cone->resolution));
    return layers;
}

bool gl_pair_same_piece(const conus_span *a, const conus_span *b)
{
    return a->pixel == b->pixel && a->object == b->object && a->entry == b->entry && a->exit == b->exit &&
           a->voxel == b->voxel;
}
