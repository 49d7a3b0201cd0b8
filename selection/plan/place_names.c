/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares points of a list with the areas and positions that they are called as. */
#include "conus/own.h"

#include "atlas/areas/areas.h"
#include "base/geometry/math3.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"
#include "selection/plan/plan.h"

#include <string.h>

enum { ROWS = 64, LEAST = 3 };

static const double FAR_AREA = 15, FAR_POSITION = 40; /* mm */

/** Points whose names say where they are. */
struct named_points {
    size_t count;
    size_t rows[ROWS];
    uint32_t objects[ROWS]; /* of areas */
    double points[ROWS][3];
    double mm[ROWS];
};

static conus_name_gap gap_of(struct named_points *named, double far)
{
    conus_name_gap gap = {.named = named->count};
    for (size_t i = 0; i < named->count; i++) {
        if (i == 0 || named->mm[i] > gap.farthest_mm) {
            gap.farthest = named->rows[i];
            gap.farthest_mm = named->mm[i];
        }
    }
    order_sort(named->mm, named->count, sizeof *named->mm, compare_f64);
    gap.median = named->count ? named->mm[named->count / 2] : 0;
    gap.is_far = gap.median > far;
    return gap;
}

static void add_point(struct named_points *named, size_t row, const double point[3])
{
    named->rows[named->count] = row;
    memcpy(named->points[named->count++], point, sizeof named->points[0]);
}

static bool is_number(struct text name)
{
    double number;
    return text_to_double(name, &number);
}

/* The letters before the number or z of a position: its row, "CP" of CP3. */
static size_t row_size(const char *position)
{
    return strcspn(position, "z0123456789");
}

/* A shaft C has contacts C1 to C6, too. */
static bool are_of_two_rows(const struct named_points *named, const conus_pose_list *list)
{
    const char *first = NULL;
    bool are_two = false;
    for (size_t i = 0; i < named->count && !are_two; i++) {
        const char *name = position_find(text_from(conus_pose_list_row(list, named->rows[i])->id))->name;
        first = first ? first : name;
        are_two = row_size(name) != row_size(first) || strncmp(name, first, row_size(first)) != 0;
    }
    return are_two;
}

conus_status conus_places_check(conus_name_check *out, const conus_atlas *atlas, const conus_pose_list *list)
{
    const conus_brain brain = conus_atlas_brain(atlas).brain;
    bool is_mni = !atlas->has_ccf && (brain == CONUS_BRAIN_MNI152 || brain == CONUS_BRAIN_COLIN27);
    struct named_points areas = {0};
    struct named_points positions = {0};
    conus_name_check found = {0};
    size_t points = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < conus_pose_list_count(list) && i < ROWS && !status; i++) {
        const conus_pose_row *row = conus_pose_list_row(list, i);
        const struct text name = text_from(row->id);
        const double *point = row->pose.world_from_device + 12;
        uint32_t object = 0;
        if (row->error || !row->is_point || !name.size || is_number(name)) {
            points += !row->error && row->is_point;
            continue;
        }
        points++;
        status = object_find(&object, atlas, name);
        status = status == CONUS_ERROR_ARGUMENT ? CONUS_OK : status;
        const struct position *position = is_mni && !object ? position_find(name) : NULL;
        if (object) {
            areas.objects[areas.count] = object;
            add_point(&areas, i, point);
        } else if (position) {
            double way[3];
            vec3_sub(way, point, position->point);
            positions.mm[positions.count] = vec3_length(way);
            add_point(&positions, i, point);
        }
    }
    areas.count = areas.count >= LEAST && 2 * areas.count >= points ? areas.count : 0;
    bool is_cap = positions.count >= LEAST && 5 * positions.count >= 4 * points && are_of_two_rows(&positions, list);
    positions.count = is_cap ? positions.count : 0;
    status = status || !areas.count
                 ? status
                 : plan_distances(areas.mm, atlas, areas.objects, (const double(*)[3])areas.points, areas.count);
    if (status) {
        return status;
    }
    found.areas = gap_of(&areas, FAR_AREA);
    found.positions = gap_of(&positions, FAR_POSITION);
    *out = found;
    return CONUS_OK;
}
