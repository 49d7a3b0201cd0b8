/* SPDX-License-Identifier: BSD-3-Clause */
/* Atlases of a ball, a slab and other simple shapes. */
#include "picture_scene.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "made_atlas.h"
#include "test.h"
#include "test_gl.h"

#include <stdlib.h>
#include <string.h>

const double picture_identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

double picture_nothing(const double world[3])
{
    (void)world;
    return 0;
}

double picture_ten(const double world[3])
{
    (void)world;
    return 10;
}

double picture_ball_of_20(const double world[3])
{
    return vec3_length(world) < 20;
}

conus_volume_info picture_grid(const size_t dim[3], const double spacing[3], const double world_from_grid[16])
{
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "scene.nii", .dim = {dim[0], dim[1], dim[2]}};
    double grid_from_voxel[16], m[16];
    mat4_identity(grid_from_voxel);
    for (int a = 0; a < 3; a++) {
        grid_from_voxel[5 * a] = spacing[a];
        grid_from_voxel[12 + a] = -0.5 * spacing[a] * ((double)dim[a] - 1);
    }
    mat4_multiply(m, world_from_grid, grid_from_voxel);
    info.slope = 1;
    assert_ok(space_describe(&info, m, "scene"));
    return info;
}

/* @p function at the centre of voxel number @p v. */
static double sample(const conus_volume_info *grid, picture_function function, size_t v)
{
    size_t row = v / grid->dim[0];
    size_t slice = row / grid->dim[1];
    double p[3] = {(double)(v % grid->dim[0]), (double)(row % grid->dim[1]), (double)slice};
    mat4_point(p, grid->world_from_voxel, p);
    return function(p);
}

static void add_context(conus_atlas *atlas, const conus_volume_info *grid, picture_function function)
{
    conus_volume_info info = *grid;
    info.role = CONUS_ROLE_CONTEXT;
    info.minimum = INFINITY;
    info.maximum = -INFINITY;
    size_t count = info.dim[0] * info.dim[1] * info.dim[2];
    float *values = memory_raw(count, sizeof *values);
    for (size_t v = 0; v < count; v++) {
        values[v] = (float)sample(&info, function, v);
        info.minimum = fmin(info.minimum, values[v]);
        info.maximum = fmax(info.maximum, values[v]);
    }
    assert_ok(atlas_set_context(atlas, &info, values));
}

conus_atlas *picture_atlas(const conus_volume_info *grid, picture_function labels, const conus_volume_info *context,
                           picture_function values)
{
    size_t count = grid->dim[0] * grid->dim[1] * grid->dim[2];
    uint32_t *numbers = memory_raw(count, sizeof *numbers);
    for (size_t v = 0; v < count; v++) {
        numbers[v] = (uint32_t)sample(grid, labels, v);
    }
    struct label_table table = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    assert_ok(atlas_create(&atlas, grid, numbers, &table, "scene", &notes));
    notes_finish(&notes);
    memory_free(numbers);
    if (values) {
        add_context(atlas, context ? context : grid, values);
    }
    return atlas;
}

void picture_rigid(double out[16], double angle, const double to[3])
{
    const double axis[3] = {1 / sqrt(14), 2 / sqrt(14), 3 / sqrt(14)};
    mat4_identity(out);
    for (int column = 0; column < 3; column++) { /* Rodrigues */
        double e[3] = {column == 0, column == 1, column == 2};
        double turned[3];
        vec3_cross(turned, axis, e);
        for (int row = 0; row < 3; row++) {
            out[4 * column + row] =
                cos(angle) * e[row] + sin(angle) * turned[row] + (1 - cos(angle)) * axis[column] * axis[row];
        }
        out[12 + column] = to[column];
    }
}

conus_engine picture_engine(void)
{
    const char *engine = getenv("CONUS_TEST_ENGINE");
    return engine && strcmp(engine, "rays") == 0 ? CONUS_ENGINE_RAYS : CONUS_ENGINE_GL;
}

void picture_need_engine(void)
{
    if (picture_engine() == CONUS_ENGINE_GL) {
        test_need_gl();
    }
}

conus_renderer *picture_renderer(const conus_atlas *atlas, const char *transfer)
{
    picture_need_engine();
    const conus_renderer_options options = {.transfer = transfer, .engine = picture_engine()};
    conus_renderer *renderer = NULL;
    assert_ok(conus_renderer_create(&renderer, atlas, &options));
    return renderer;
}

struct camera picture_camera(const double forward[3], double distance, double field_of_view)
{
    struct camera camera;
    const double points[2][3] = {{-1, -1, -1}, {1, 1, 1}};
    const struct camera_frame frame = {.width = PICTURE_WIDTH, .height = PICTURE_HEIGHT};
    camera_frame_points(&camera, points[0], 2, forward, field_of_view, &frame);
    vec3_scale(camera.world_from_camera + 12, camera.world_from_camera + 8, distance);
    return camera;
}

float *picture_draw(conus_renderer *renderer, const struct camera *camera, const struct colour_view *extra, bool smooth)
{
    struct colour_view view = extra ? *extra : (struct colour_view){0};
    view.camera = camera;
    view.width = PICTURE_WIDTH;
    view.height = PICTURE_HEIGHT;
    float *rgba = memory_zeroed(PICTURE_PIXELS, 4 * sizeof *rgba);
    assert_ok(renderer_draw(rgba, renderer, &view, smooth));
    return rgba;
}

void picture_check_haze(conus_atlas *clear, conus_atlas *hazy, double field_of_view)
{
    static const char haze[] = "0 0 0 0 0.06\n";
    const char *path = test_scratch("haze.tf");
    assert_ok(conus_write_file(path, haze, sizeof haze - 1));
    conus_renderer *renderers[2] = {picture_renderer(clear, NULL), picture_renderer(hazy, path)};
    const struct camera camera = picture_camera((double[]){0, 1, 0}, 200, field_of_view);
    const size_t middle = (size_t)4 * (PICTURE_HEIGHT / 2 * PICTURE_WIDTH + PICTURE_WIDTH / 2);
    for (uint32_t slices = 23; slices < 300; slices += 31) {
        float *without = picture_draw(renderers[0], &camera, &(struct colour_view){.slices = slices}, false);
        float *with = picture_draw(renderers[1], &camera, &(struct colour_view){.slices = slices}, false);
        assert_near(with[middle] / without[middle], pow(1 - 0.06, 10), 0.01); /* from 30 mm to 20 */
        memory_free(without);
        memory_free(with);
    }
    conus_renderer_destroy(renderers[0]);
    conus_renderer_destroy(renderers[1]);
    conus_atlas_destroy(clear);
    conus_atlas_destroy(hazy);
}

double picture_difference(const float *a, const float *b)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)PICTURE_PIXELS * 4; i++) {
        sum += fabs((double)a[i] - (double)b[i]);
    }
    return sum / (PICTURE_PIXELS * 4);
}
