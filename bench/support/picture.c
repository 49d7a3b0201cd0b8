/* SPDX-License-Identifier: BSD-3-Clause */
/* A renderer, its camera and its frame, for the scenarios with pictures. */
#include "bench/support/picture.h"

#include "base/geometry/math3.h"

enum { MARGIN_PART = 35 }; /* of the picture's width, on all sides */

void picture_aim(struct camera *camera, struct colour_view *view, const struct camera_frame *frame,
                 const double (*points)[3], size_t count, size_t slices)
{
    double forward[3];
    camera_default_forward(forward);
    camera_frame_points(camera, (const double *)points, count, forward, radians_from_degrees(30), frame);
    *view = (struct colour_view){
        .camera = camera, .width = frame->width, .height = frame->height, .slices = (uint32_t)slices};
}

void picture_aim_at_all(struct picture *picture, const struct bench_options *options, size_t slices)
{
    const struct colour_pass *pass = &picture->renderer->colour;
    uint32_t size[2];
    frame_size(size, options->check);
    uint32_t margin = size[0] / MARGIN_PART;
    const struct camera_frame frame = {size[0], size[1], margin, margin, margin, margin};
    picture_aim(&picture->camera, &picture->view, &frame, (const double(*)[3])pass->content, pass->content_count,
                slices);
}

conus_status picture_begin(struct picture *picture)
{
    conus_status status = gl_context_use(picture->renderer->context, &picture->previous);
    picture->is_current = !status;
    return status ? status : frame_resize(&picture->frame, (uint32_t[]){picture->view.width, picture->view.height});
}

void picture_finish(struct picture *picture)
{
    if (picture->is_current) {
        frame_finish(&picture->frame);
        gl_current_restore(&picture->previous);
    }
    conus_renderer_destroy(picture->renderer);
    *picture = (struct picture){0};
}
