/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes JSON and points of a selection, and hands them to the station. */
#include "conus/report.h"
#include "link/station.h"

#include <stdio.h>
#include <string.h>

enum { POINTS_SENT = 16 };

static size_t list_points(struct igtl_point points[POINTS_SENT], const conus_atlas *atlas,
                          const conus_selection *selection)
{
    size_t count = 0;
    for (size_t i = 0; i < conus_selection_count(selection) && count < POINTS_SENT; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        const conus_object *object = conus_atlas_object(atlas, result->object);
        if (object && result->pixels) {
            struct igtl_point *point = &points[count++];
            snprintf(point->name, sizeof point->name, "%s", object->name);
            memcpy(point->rgb, object->rgb, sizeof point->rgb);
            memcpy(point->position, result->contact, sizeof point->position);
        }
    }
    return count;
}

void station_send_selection(struct station *station, const conus_selector *selector, const conus_atlas *atlas,
                            const conus_selection *selection)
{
    struct igtl_point points[POINTS_SENT];
    conus_report *report = NULL;
    const conus_report_options options = {.format = "ndjson"};
    const char *text;
    size_t size;
    conus_status status = conus_report_create(&report, selector, &options);
    status = status ? status : conus_report_add(report, "tracker", selection);
    status = status ? status : conus_report_text(&text, &size, report);
    if (!status) {
        station_send(station, text, points, list_points(points, atlas, selection));
    }
    conus_report_destroy(report);
}
