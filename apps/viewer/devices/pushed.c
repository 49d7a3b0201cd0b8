/* SPDX-License-Identifier: BSD-3-Clause */
/* The newest pose that was put there, once. */
#include "viewer/devices/pushed.h"

static bool ask(struct source *source, double now_s, struct source_news *out, double said[SOURCE_VALUES])
{
    struct pushed *pushed = (struct pushed *)source;
    (void)now_s;
    (void)said; /* a mouse may rest for ever */
    out->state = SOURCE_WELL;
    out->has_pose = pushed->is_new;
    out->pose = pushed->pose;
    pushed->is_new = false;
    return false;
}

void pushed_init(struct pushed *out)
{
    *out = (struct pushed){.source.ask = ask};
}

void pushed_put(struct pushed *pushed, const conus_pose *pose)
{
    pushed->pose = *pose;
    pushed->is_new = true;
}
