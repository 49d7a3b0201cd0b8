/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of points: a row is chosen to be asked about. */
#include "viewer/panes/panes.h"
#include "viewer/ui/ui.h"

#include <math.h>

void panel_points(struct window *window)
{
    static const char *const columns[] = {"point", "at"};
    static const char *const widest[] = {"", "-199.9, -199.9, -199.9 mm RAS"};
    struct viewer *viewer = window->viewer;
    const size_t count = conus_pose_list_count(viewer->points.poses);
    float widths[2];
    panel_widths(widths, window, columns, widest, 2);
    size_t shown = ui_list_fit(widths, 2, 1);
    if (!ui_table("points", columns, widths, shown, fmaxf(ui_room_below(), 4 * ui_list_line()))) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const conus_pose_row *row = conus_pose_list_row(viewer->points.poses, i);
        char place[VIEWER_PLACE_TEXT];
        if (!ui_list_row()) {
            continue;
        }
        ui_id((uint32_t)i);
        const bool is_chosen = viewer->chosen_point == i + 1;
        if (ui_row_cut(row->id, is_chosen,
                       row->error ? row->error : "asks about it; once more: the mouse points again")) {
            points_choose(viewer, is_chosen ? 0 : (uint32_t)i + 1);
        }
        if (shown > 1) {
            ui_cell();
            ui_text_right(row->error ? "-" : viewer_place_text(place, viewer, row->pose.world_from_device + 12));
        }
        ui_id_end();
    }
    ui_list_end();
}
