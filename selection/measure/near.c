/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the nearest point of each object to the centre of a ball. */
#include "selection/measure/measure.h"

#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

conus_status near_prepare(struct near *near, const conus_atlas *atlas)
{
    if (near->objects && near->object_count >= atlas->object_count) {
        return CONUS_OK;
    }
    struct near larger = {.object_count = atlas->object_count};
    larger.objects = memory_raw(atlas->object_count + 1, sizeof *larger.objects);
    larger.touched = memory_raw(atlas->object_count + 1, sizeof *larger.touched);
    if (!larger.objects || !larger.touched) {
        near_finish(&larger);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i <= atlas->object_count; i++) {
        larger.objects[i].distance = INFINITY;
    }
    near_finish(near);
    *near = larger;
    return CONUS_OK;
}

void near_finish(struct near *near)
{
    memory_free(near->objects);
    memory_free(near->touched);
    *near = (struct near){0};
}

void near_note(struct near *near, uint32_t object, double distance, const double point[3], double value)
{
    struct near_object *found = &near->objects[object];
    if (found->distance == INFINITY) {
        near->touched[near->touched_count++] = object;
    }
    found->distance = distance;
    found->value = value;
    memcpy(found->point, point, sizeof found->point);
}

/* The least of x' G x over x with x[a] = ends where fixed[a], for which the other coordinates are solved. */
static void solve_free(double x[3], double gram[3][3], const bool fixed[3])
{
    int free[3];
    int count = 0;
    double rhs[3];
    for (int a = 0; a < 3; a++) {
        if (!fixed[a]) {
            free[count++] = a;
        }
    }
    for (int i = 0; i < count; i++) {
        rhs[i] = 0;
        for (int b = 0; b < 3; b++) {
            rhs[i] -= fixed[b] ? gram[free[i]][b] * x[b] : 0;
        }
    }
    if (count == 1) {
        x[free[0]] = rhs[0] / gram[free[0]][free[0]];
    } else if (count == 2) {
        double a = gram[free[0]][free[0]];
        double b = gram[free[0]][free[1]];
        double c = gram[free[1]][free[1]];
        double det = a * c - b * b;
        x[free[0]] = (c * rhs[0] - b * rhs[1]) / det;
        x[free[1]] = (a * rhs[1] - b * rhs[0]) / det;
    }
}

static double length_in(double gram[3][3], const double x[3])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        square += x[a] * (gram[a][0] * x[0] + gram[a][1] * x[1] + gram[a][2] * x[2]);
    }
    return sqrt(fmax(square, 0));
}

double near_skew_box(double out[3], double box[2][3], double gram[3][3])
{
    double best = INFINITY;
    for (int a = 0; a < 3; a++) {
        out[a] = fmin(fmax(0, box[0][a]), box[1][a]);
    }
    if (out[0] == 0 && out[1] == 0 && out[2] == 0) {
        return 0;
    }
    /* The nearest point is the least of one of the box's 26 corners, edges and faces, taken as points, lines, planes */
    for (int part = 0; part < 26; part++) {
        const int state[3] = {part % 3, part / 3 % 3, part / 9};
        const bool fixed[3] = {state[0] < 2, state[1] < 2, state[2] < 2};
        double x[3] = {0};
        bool inside = true;
        for (int a = 0; a < 3; a++) {
            x[a] = fixed[a] ? box[state[a]][a] : 0;
        }
        solve_free(x, gram, fixed);
        for (int a = 0; a < 3; a++) {
            inside = inside && x[a] >= box[0][a] && x[a] <= box[1][a];
        }
        double distance = length_in(gram, x);
        if (inside && distance < best) {
            best = distance;
            memcpy(out, x, sizeof x);
        }
    }
    return best;
}

static double dot_rounded(const double a[3], const double b[3])
{
    double dot = vec3_dot(a, b);
    return fabs(dot) < 1e-6 * vec3_length(a) * vec3_length(b) ? 0 : dot;
}

void near_cells_init(struct near_cells *out, const struct volume *volume)
{
    const double *m = volume->info.world_from_voxel;
    for (int a = 0; a < 9; a++) { /* columns of float matrices are perpendicular up to rounding */
        out->gram[a / 3][a % 3] = dot_rounded(m + 4 * (a / 3), m + 4 * (a % 3));
    }
    out->reach = 0;
    for (int corner = 0; corner < 4; corner++) {
        const double half[3] = {0.5, corner & 1 ? -0.5 : 0.5, corner & 2 ? -0.5 : 0.5};
        out->reach = fmax(out->reach, length_in(out->gram, half));
    }
}

double near_cell(double out[3], struct near_cells *cells, const double cell[3], const double at[3], double limit)
{
    double offset[3];
    double box[2][3];
    vec3_sub(offset, cell, at);
    if (length_in(cells->gram, offset) - cells->reach > limit) {
        return INFINITY;
    }
    for (int a = 0; a < 3; a++) {
        box[0][a] = offset[a] - 0.5;
        box[1][a] = offset[a] + 0.5;
    }
    return near_box(out, box, cells->gram);
}

/* The cells of one volume against a ball. */
struct search {
    struct near *near;
    const struct region *ball;
    double at[3]; /* the centre, in voxels */
    struct near_cells cells;
};

static void search_cell(struct search *search, const struct volume *volume, size_t voxel, const double cell[3])
{
    struct near *near = search->near;
    uint32_t object = volume_object(volume, voxel);
    double best = near->objects[object].distance;
    double offset[3] = {0};
    double distance = near_cell(offset, &search->cells, cell, search->at, fmin(best, search->ball->radius));
    if (distance < best && distance <= search->ball->radius) {
        double point[3];
        mat4_direction(point, volume->info.world_from_voxel, offset);
        vec3_add_scaled(point, search->ball->origin, 1, point);
        near_note(near, object, distance, point, volume_has_values(volume) ? (double)volume_value(volume, voxel) : NAN);
    }
}

static void search_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct search *search = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t i = 0; i < count; i++) {
        uint32_t object = volume_object(volume, first + i);
        if (object && search->near->objects[object].distance > 0) {
            search_cell(search, volume, first + i, (double[]){(double)(at[0] + i), (double)at[1], (double)at[2]});
        }
    }
}

/* Distance from the ball's centre to the box around the mesh. */
static double bounds_distance(const struct mesh *mesh, const double centre[3])
{
    double gap[3];
    for (int a = 0; a < 3; a++) {
        double low = mesh->shape.low[a];
        double high = mesh->shape.high[a];
        gap[a] = centre[a] < low ? low - centre[a] : centre[a] > high ? centre[a] - high : 0;
    }
    return vec3_length(gap);
}

void near_clear(struct near *near)
{
    for (size_t i = 0; i < near->touched_count; i++) {
        near->objects[near->touched[i]].distance = INFINITY;
    }
    near->touched_count = 0;
}

void near_take(struct near *near, const conus_atlas *atlas, const struct region *ball)
{
    near_clear(near);
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(&atlas->volumes[i])) {
            const struct volume *volume = &atlas->volumes[i];
            struct search search = {.near = near, .ball = ball};
            struct region wider = *ball;
            mat4_point(search.at, volume->voxel_from_world, ball->origin);
            near_cells_init(&search.cells, volume);
            wider.radius = (ball->radius + search.cells.reach) * (1 + 1e-9);
            census_walk(&wider, volume, search_row, &search);
        }
    }
    for (uint32_t object = 1; atlas->mesh_count && object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        double away = mesh ? bounds_distance(mesh, ball->origin) : INFINITY;
        if (away > ball->radius) {
            continue;
        }
        double point[3] = {ball->origin[0], ball->origin[1], ball->origin[2]};
        bool inside = away == 0 && fabs(mesh_winding(mesh, ball->origin)) >= 0.5;
        double distance = inside ? 0 : mesh_nearest(point, mesh, ball->origin, ball->radius);
        if (distance <= ball->radius) {
            near_note(near, object, distance, point, NAN);
        }
    }
}
