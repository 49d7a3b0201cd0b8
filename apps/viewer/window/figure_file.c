/* SPDX-License-Identifier: BSD-3-Clause */
/* The renderer's and the cutter's pictures of what panes show. */
#include "viewer/window/figure_file.h"

#include "viewer/model/cut_view.h"
#include "viewer/window/screen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void figure_of_window(struct figure_settings *out, const struct window *window)
{
    const struct sheet *sheet = &window->sheet;
    const struct view_atlas *drawn = window->viewer->drawn;
    *out = (struct figure_settings){.dpi = sheet->dpi,
                                    .legend = (size_t)sheet->legend,
                                    .no_legend = sheet->no_text,
                                    .background = backdrop_names[window->viewer->display.backdrop],
                                    .streamline_colour = look_streamline_colour(&drawn->look, drawn->atlas)};
    if (sheet->in_mm) {
        out->width_mm = sheet->mm[0];
        out->height_mm = sheet->mm[1];
    } else {
        memcpy(out->size, sheet->pixels, sizeof out->size);
    }
}

static bool refuse(char why[FIGURE_REASON], const char *text)
{
    snprintf(why, FIGURE_REASON, "%s", text);
    return false;
}

static bool refuse_status(char why[FIGURE_REASON], conus_status status)
{
    return refuse(why, conus_message()[0] || status != CONUS_ERROR_MEMORY ? conus_message() : "not enough memory");
}

/* Ends the image. */
static conus_status write_image(conus_image *image, conus_status status, const char *path)
{
    status = status ? status : conus_image_write(image, path);
    conus_image_destroy(image);
    return status;
}

static conus_status make_renderer(conus_renderer **out, const struct viewer *viewer,
                                  const struct figure_settings *settings)
{
    const struct look *look = &viewer->drawn->look;
    const struct transfer_editor *editor = &viewer->transfer_editor;
    conus_pathway_transfer *pathways = calloc(look->object_count + 1, sizeof *pathways);
    conus_renderer *renderer = NULL;
    if (!pathways) {
        return CONUS_ERROR_MEMORY;
    }
    const conus_renderer_options options = {.transfer = viewer->preset ? viewer->preset : viewer->transfer,
                                            .pathways = pathways,
                                            .pathway_count = look_pathways(pathways, look),
                                            .streamline_colour = settings->streamline_colour};
    conus_status status = conus_renderer_create(&renderer, viewer->drawn->atlas, &options);
    free(pathways);
    if (!status && editor->edited) {
        status = conus_renderer_set_transfer(renderer, editor->points, editor->count);
    }
    if (status) {
        conus_renderer_destroy(renderer);
        return status;
    }
    *out = renderer;
    return CONUS_OK;
}

/* A field of view fits the drawing, which a legend beside it makes narrower; an eye beside the middle needs a
 * frustum. */
static bool set_camera(conus_view *view, struct sight *sight, const char *streamline_colour)
{
    double *f = sight->frustum;
    view->camera = &sight->camera;
    if (f[0] == -f[1] && f[2] == -f[3]) {
        view->field_of_view = 2 * atan(f[3]);
        return true;
    }
    sight_fit(sight, (double[]){view->width, view->height});
    memcpy(view->frustum, f, sizeof view->frustum);
    bool has_key = streamline_colour && strcmp(streamline_colour, "bundle") != 0;
    return view->legend != CONUS_LEGEND_RIGHT || view->no_legend || (!view->selection && !has_key);
}

static bool write_3d(const struct window *window, const struct figure_settings *settings, const char *path,
                     char why[FIGURE_REASON])
{
    const struct viewer *viewer = window->viewer;
    conus_renderer *renderer = NULL;
    conus_image *image = NULL;
    struct sight sight;
    conus_view view = {
        .selection = viewer_selection(viewer), .chosen = viewer->drawn->shown.chosen, .fade = viewer->display.fade};
    window_sight(window, &sight);
    figure_view(&view, settings);
    look_set(&view, &viewer->drawn->look);
    if (!set_camera(&view, &sight, settings->streamline_colour)) {
        return refuse(why, "a tracked head's view has no room for a legend beside it: choose inside, below or none");
    }
    conus_status status = make_renderer(&renderer, viewer, settings);
    status = status ? status : conus_render(&image, renderer, &view);
    status = write_image(image, status, path);
    conus_renderer_destroy(renderer);
    return !status || refuse_status(why, status);
}

static bool write_cut(const struct window *window, enum plane plane, const struct figure_settings *settings,
                      const char *path, char why[FIGURE_REASON])
{
    conus_view sheet = {0};
    conus_cut_view view;
    conus_image *image = NULL;
    figure_view(&sheet, settings);
    cut_view(&view, window->viewer, plane, (double[]){sheet.width, sheet.height});
    conus_status status = conus_cut_image(&image, window->viewer->drawn->atlas, &view, &sheet);
    status = write_image(image, status, path);
    return !status || refuse_status(why, status);
}

bool figure_write(const struct window *window, size_t pane, const struct figure_settings *settings, const char *path,
                  char why[FIGURE_REASON])
{
    return pane == PANE_3D ? write_3d(window, settings, path, why)
                           : write_cut(window, (enum plane)pane, settings, path, why);
}
