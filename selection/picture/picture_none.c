/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands for pictures and their files, in a build without the libraries that they need: each function says so. */
#include "render/image/image.h"

#include "conus/own.h"
#include "render/draw/draw.h"

static conus_status refuse(void)
{
    return fail(CONUS_ERROR_UNSUPPORTED,
                "this build of conus leaves out pictures; conus page shows the atlas in a browser");
}

conus_status image_format_png(struct bytes *out, const conus_image *image)
{
    (void)out, (void)image;
    return refuse();
}

conus_status draw_paint(float *const plane[4], const struct draw_list *list)
{
    (void)plane, (void)list;
    return refuse();
}

conus_status draw_format_pdf(struct buffer *out, const struct draw_list *list, const uint8_t *rgba, double dpi)
{
    (void)out, (void)list, (void)rgba, (void)dpi;
    return refuse();
}

conus_status image_parse_png(conus_image **out, const uint8_t *data, size_t size)
{
    (void)out, (void)data, (void)size;
    return refuse();
}

conus_status conus_selection_image(conus_image **out, const conus_selection *selection)
{
    (void)out, (void)selection;
    return refuse();
}

conus_status conus_cut_image(conus_image **out, const conus_atlas *atlas, const conus_cut_view *view,
                             const conus_view *sheet)
{
    (void)out, (void)atlas, (void)view, (void)sheet;
    return refuse();
}

conus_status conus_render_cuts(conus_image **out, const conus_atlas *atlas, const conus_cut_plane *planes, size_t count,
                               const conus_cut_view *look, conus_renderer *renderer, const conus_view *sheet)
{
    (void)out, (void)atlas, (void)planes, (void)count, (void)look, (void)renderer, (void)sheet;
    return refuse();
}

conus_status conus_points_image(conus_image **out, const conus_atlas *atlas, const conus_view *view,
                                const conus_cut_view *cut, size_t chosen)
{
    (void)out, (void)atlas, (void)view, (void)cut, (void)chosen;
    return refuse();
}

conus_status conus_window_camera(conus_pose *camera, double frustum[4], const conus_pose *window, const double size[2],
                                 const double eye[3])
{
    (void)camera, (void)frustum, (void)window, (void)size, (void)eye;
    return refuse();
}

conus_status conus_render(conus_image **out, conus_renderer *renderer, const conus_view *view)
{
    (void)out, (void)renderer, (void)view;
    return refuse();
}

conus_status conus_context_is_covered(bool *out, const conus_atlas *atlas)
{
    (void)out, (void)atlas;
    return refuse();
}
