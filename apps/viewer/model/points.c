/* SPDX-License-Identifier: BSD-3-Clause */
/* Loads a list and makes balls of its rows. */
#include "viewer/model/viewer.h"

#include "figures/figure.h"
#include "options/messages.h"
#include "settings/settings.h"

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

void points_finish(struct point_list *list)
{
    if (list->has_electrodes) {
        contacts_ungroup(list->points, list->count);
    }
    free(list->points);
    free(list->rows);
    conus_pose_list_destroy(list->poses);
    *list = (struct point_list){.number = list->number + 1};
}

void points_use(struct viewer *viewer, struct point_list *list)
{
    const unsigned number = viewer->points.number;
    points_finish(&viewer->points);
    viewer->points = *list;
    viewer->points.number = number + 1;
    if (viewer->chosen_point) { /* of the list that goes */
        viewer->tools[FIRST_TOOL].pointer = POINT_BY_MOUSE;
    }
    viewer->chosen_point = 0;
    viewer->version++;
    *list = (struct point_list){0};
}

const conus_drawn_point *points_chosen(const struct viewer *viewer)
{
    size_t i = 0;
    while (i < viewer->points.count && viewer->points.rows[i] != viewer->chosen_point) {
        i++;
    }
    return i < viewer->points.count && viewer->chosen_point ? &viewer->points.points[i] : NULL;
}
