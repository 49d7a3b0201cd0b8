/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks the values of a source: they are finite, and change. */
#include "viewer/devices/devices.h"

#include <math.h>
#include <string.h>

static bool are_finite(const double *values, size_t count)
{
    bool finite = true;
    for (size_t i = 0; i < count; i++) {
        finite = finite && isfinite(values[i]);
    }
    return finite;
}

static void drop_moves(struct source_update *update)
{
    memset(update->move, 0, sizeof update->move);
    memset(update->turn, 0, sizeof update->turn);
    update->widen = 0;
}

/* Whether the source has sent the same values for too long. A pause starts the count anew. */
static bool is_frozen(struct source_watch *watch, const double *said, double now_s)
{
    bool same = watch->any;
    for (size_t i = 0; i < SOURCE_VALUES; i++) {
        same = same && watch->values[i] == said[i];
    }
    if (!same) {
        memcpy(watch->values, said, sizeof watch->values);
        watch->since_s = now_s;
        watch->any = true;
    }
    return now_s - watch->since_s >= SOURCE_FROZEN_S;
}

double source_speed(const struct source *source)
{
    return source->speed > 0 ? source->speed : SOURCE_SPEED;
}

void source_ask(struct source *source, double now_s, struct source_update *out)
{
    double said[SOURCE_VALUES] = {0};
    *out = (struct source_update){.state = SOURCE_NONE};
    if (!source || !source->ask) {
        return;
    }
    bool speaks = source->ask(source, now_s, out, said);
    if (!are_finite(said, SOURCE_VALUES) || !are_finite(out->pose.world_from_device, 16) || !are_finite(out->move, 3) ||
        !are_finite(out->turn, 3) || !isfinite(out->widen)) {
        out->state = SOURCE_BROKEN;
        out->has_pose = false;
        drop_moves(out);
        source->watch.any = false;
    } else if (!speaks) {
        source->watch.any = false;
    } else if (is_frozen(&source->watch, said, now_s) && out->state == SOURCE_WELL) {
        out->state = SOURCE_FROZEN;
        drop_moves(out);
    }
}
