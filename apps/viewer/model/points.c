/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads a list and makes balls of its rows. */
#include "viewer/model/viewer.h"

#include "figures/figure.h"
#include "options/messages.h"
#include "settings/settings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static conus_status place_rows(struct point_list *list, const conus_atlas *atlas, double radius)
{
    const size_t count = conus_pose_list_count(list->poses);
    conus_selector *selector = NULL;
    list->points = calloc(count + 1, sizeof *list->points);
    list->rows = calloc(count + 1, sizeof *list->rows);
    conus_status status = list->points && list->rows ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : conus_selector_create(&selector, atlas, NULL);
    for (size_t i = 0; i < count && !status; i++) {
        const conus_pose_row *row = conus_pose_list_row(list->poses, i);
        if (!row->error) {
            status = contacts_place(&list->points[list->count], row, radius, selector);
            list->rows[list->count++] = (uint32_t)i + 1;
        }
    }
    conus_selector_destroy(selector);
    return status || contacts_group(&list->has_electrodes, list->points, list->count) ? status : CONUS_ERROR_MEMORY;
}

int points_load(struct point_list *out, const char *path, const struct atlases *atlases, const conus_frame *frame,
                double radius, const struct common_settings *common, uint64_t max_memory)
{
    struct point_list list = {0};
    const struct pose_file_settings plain = {.format = 0};
    const conus_pose_options options =
        pose_settings_options(&plain, NULL, NULL, frame, atlases->items[0].atlas, max_memory);
    int code = print_status(conus_pose_list_load(&list.poses, path, &options));
    const size_t count = conus_pose_list_count(list.poses);
    code = code ? code : pose_settings_match_list(list.poses, path, atlases, NULL, common);
    if (!code && (!count || count > POINT_LIMIT)) {
        code = print_data_error("%s: %zu rows; a list that is drawn has 1 to %d, and --poses shows one after the other",
                                path, count, POINT_LIMIT);
    }
    code = code ? code : print_status(place_rows(&list, atlases->items[0].atlas, radius));
    if (!code && !list.count) {
        code = print_data_error("%s: no row has a position", path);
    }
    if (code) {
        points_finish(&list);
    } else {
        pose_settings_warn_of_names(list.poses, path, atlases);
        *out = list;
    }
    return code;
}

/* The depths of a row, as conus query has them; without a row the plan's, or all. Whether the tool has these. */
static bool find_depths(double out[2], const struct viewer *viewer, const conus_pose_row *row)
{
    out[0] = row && isfinite(row->range[0]) ? row->range[0] : 0;
    out[1] = row && isfinite(row->range[1]) ? row->range[1] : viewer->plan.depth;
    return out[0] == viewer->cone.options.range[0] && out[1] == viewer->cone.options.range[1];
}

/* Asks at them, of a list whose rows have some: a needle of it ends. In other lists those of the tool stay. False: it
 * was said why not. */
static bool use_depths(struct viewer *viewer, const conus_pose_row *row)
{
    double depths[2];
    const bool has_these = find_depths(depths, viewer, row);
    bool has_depths = false;
    for (size_t i = 0; i < conus_pose_list_count(viewer->points.poses) && !has_depths; i++) {
        has_depths = isfinite(conus_pose_list_row(viewer->points.poses, i)->range[1]);
    }
    return !has_depths || has_these || query_set_range(viewer, depths[0], depths[1]);
}

static const conus_pose_row *chosen_row(const struct viewer *viewer)
{
    return viewer->chosen_point ? conus_pose_list_row(viewer->points.poses, viewer->chosen_point - 1) : NULL;
}

void points_check(struct viewer *viewer)
{
    const conus_pose_row *row = chosen_row(viewer);
    const struct tool *tool = &viewer->tools[FIRST_TOOL];
    bool is_there = row && !row->error && tool->pointer == POINT_BY_REPLAY && tool->is_point == row->is_point;
    for (size_t i = row && row->is_point ? 12 : 0; i < 16; i++) { /* a point has no axes */
        is_there = is_there && fabs(tool->pose.world_from_device[i] - row->pose.world_from_device[i]) < 1e-3;
    }
    viewer->chosen_point *= is_there;
}

void points_use(struct viewer *viewer, struct point_list *list)
{
    struct point_list before = viewer->points;
    const conus_pose_row *was = chosen_row(viewer);
    double depths[2];
    const bool has_its = was && find_depths(depths, viewer, was); /* else they were set by hand */
    (void)(has_its && use_depths(viewer, NULL));                  /* those of a list go with it */
    viewer->points = *list;
    viewer->points.number = before.number + 1;
    viewer->version++;
    *list = (struct point_list){0};
    points_check(viewer);
    const conus_pose_row *is = chosen_row(viewer);
    if (was && is && strcmp(was->id, is->id) == 0 && is->angle == was->angle &&
        (is->radius == was->radius || (isnan(is->radius) && isnan(was->radius)))) {
        (void)(has_its && use_depths(viewer, is));
    } else if (was) {
        viewer->tools[FIRST_TOOL].pointer = POINT_BY_MOUSE;
        viewer->chosen_point = 0;
    }
    points_finish(&before);
}

void points_choose(struct viewer *viewer, uint32_t row)
{
    const conus_pose_row *of = row ? conus_pose_list_row(viewer->points.poses, row - 1) : NULL;
    if (of && of->error) {
        viewer_say(viewer, "line %zu: %s", of->line, of->error);
        return;
    }
    if (!use_depths(viewer, of)) {
        return;
    }
    tool_choose(viewer, FIRST_TOOL, of ? POINT_BY_REPLAY : POINT_BY_MOUSE);
    viewer->chosen_point = of ? row : 0;
    if (!of) {
        tool_clear(viewer);
        return;
    }
    points_aim(viewer, of);
    const conus_result *best = conus_selection_result(viewer_selection(viewer), 0);
    const bool has_contact = best && best->object && best->pixels;
    viewer_cross(viewer, has_contact ? best->contact : of->pose.world_from_device + 12);
}

void points_aim(struct viewer *viewer, const conus_pose_row *row)
{
    if (!isnan(row->radius)) {
        viewer->cone.options.radius = row->radius;
    }
    if (row->angle > 0 && viewer->cone.options.radius == 0) {
        viewer->tools[FIRST_TOOL].angle = row->angle;
    }
    (row->is_point ? tool_aim_point : tool_aim)(viewer, FIRST_TOOL, &row->pose);
}

const conus_drawn_point *points_chosen(const struct viewer *viewer)
{
    size_t i = 0;
    while (i < viewer->points.count && viewer->points.rows[i] != viewer->chosen_point) {
        i++;
    }
    return i < viewer->points.count && viewer->chosen_point ? &viewer->points.points[i] : NULL;
}
