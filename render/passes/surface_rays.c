/* SPDX-License-Identifier: BSD-3-Clause */
/* Meets triangles by exact signs of edges, so that no ray passes between two of them, and tubes in closed form. */
#include "render/passes/shapes.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

static const double NEAR = 0.1; /* mm before the eye, as everywhere */

struct surface_rays {
    struct mesh_list parts;
    struct tubes tubes;
    float (*points)[3]; /* [tubes.point_count + 1] */
    uint32_t *paints;   /* [tubes.point_count] */
    float ramp[TUBE_RAMP_STEPS + 1][3];
    struct mesh_layer_view view;
    double rows[9], columns[9]; /* of its camera */
    float (*corners)[3]; /* [parts.vertex_count] By the camera's rows: right and up times the depth; the depth. */
    size_t layer_count;
    size_t *first;   /* [bands + 1] Where the items of each band begin. */
    uint32_t *items; /* Triangles, and behind them tubes. */
};

/* Pixels that something may cover, up to and with the last ones. */
struct span {
    long first[2], last[2]; /* columns, rows */
};

static const uint32_t *corners_of(const struct surface_rays *rays, size_t triangle)
{
    return rays->parts.indices + 3 * triangle;
}

/* Pixels between two places in halves of the picture, and one more for the shift of rays. False if there are none. */
static bool find_span(struct span *out, const struct surface_rays *rays, const double low[2], const double high[2])
{
    const double size[2] = {rays->view.width, rays->view.height};
    bool any = true;
    for (int a = 0; a < 2; a++) {
        double first = floor((fmin(fmax(low[a], -2), 2) + 1) / 2 * size[a] - 1);
        double last = floor((fmin(fmax(high[a], -2), 2) + 1) / 2 * size[a] + 1);
        out->first[a] = (long)fmax(first, 0);
        out->last[a] = (long)fmin(last, size[a] - 1);
        any = any && out->first[a] <= out->last[a];
    }
    return any;
}

static bool span_triangle(struct span *out, const struct surface_rays *rays, size_t triangle)
{
    const uint32_t *t = corners_of(rays, triangle);
    double low[2] = {INFINITY, INFINITY};
    double high[2] = {-INFINITY, -INFINITY};
    int before = 0;
    for (int k = 0; k < 3; k++) {
        const float *corner = rays->corners[t[k]];
        before += (double)corner[2] >= NEAR;
        for (int a = 0; a < 2; a++) {
            double at = (double)corner[a] / (double)corner[2];
            low[a] = fmin(low[a], at);
            high[a] = fmax(high[a], at);
        }
    }
    static const double all[2][2] = {{-1, -1}, {1, 1}};
    return before == 3 ? find_span(out, rays, low, high) : before && find_span(out, rays, all[0], all[1]);
}

/* A tube: its ends relative to the eye, in world axes. */
struct tube {
    double from[3], to[3], radius;
    double front; /* depth before which no point of it is */
    uint32_t paint;
};

static void make_tube(struct tube *out, const struct surface_rays *rays, const struct tube_range *range, size_t n)
{
    const double *eye = rays->view.camera->world_from_camera + 12;
    bool is_ball = rays->paints[n] & TUBE_BALL;
    for (int a = 0; a < 3; a++) {
        out->from[a] = (double)rays->points[n][a] - eye[a];
        out->to[a] = (double)rays->points[n + !is_ball][a] - eye[a];
    }
    out->paint = rays->paints[n] & ~TUBE_BALL;
    out->radius = fmax((double)range->radius, rays->view.draft / 2);
}

/* What a ball covers at most: see tube.vert.glsl. */
static void widen(double low[2], double high[2], const struct surface_rays *rays, const double place[3], double radius)
{
    for (int a = 0; a < 2; a++) {
        double at = place[a] / place[2];
        double reach = radius * (vec3_length(rays->rows + (ptrdiff_t)3 * a) + fabs(at)) / (place[2] - radius);
        low[a] = fmin(low[a], at - reach);
        high[a] = fmax(high[a], at + reach);
    }
}

static bool span_tube(struct span *out, struct tube *tube, const struct surface_rays *rays)
{
    const double *ends[2] = {tube->from, tube->to};
    double place[2][3];
    double low[2] = {INFINITY, INFINITY};
    double high[2] = {-INFINITY, -INFINITY};
    for (int end = 0; end < 2; end++) {
        for (int a = 0; a < 3; a++) {
            place[end][a] = vec3_dot(rays->rows + (ptrdiff_t)3 * a, ends[end]);
        }
    }
    tube->front = fmin(place[0][2], place[1][2]) - tube->radius;
    if (!tube->paint || fmax(place[0][2], place[1][2]) + tube->radius < NEAR) {
        return false;
    }
    static const double all[2][2] = {{-1, -1}, {1, 1}};
    if (!(tube->front > NEAR)) {
        return find_span(out, rays, all[0], all[1]);
    }
    widen(low, high, rays, place[0], tube->radius);
    widen(low, high, rays, place[1], tube->radius);
    return find_span(out, rays, low, high);
}

static const struct tube_range *range_of(const struct surface_rays *rays, size_t n)
{
    const struct tube_range *range = rays->tubes.ranges;
    while (n >= range->first + range->count) {
        range++;
    }
    return range;
}

/* Where an item may be. False where nothing of it is drawn. `tube` is filled if it is one. */
static bool span_item(struct span *out, struct tube *tube, const struct surface_rays *rays, size_t item)
{
    const size_t triangles = rays->parts.index_count / 3;
    if (item < triangles) {
        return span_triangle(out, rays, item);
    }
    make_tube(tube, rays, range_of(rays, item - triangles), item - triangles);
    return span_tube(out, tube, rays);
}

static conus_status make_lists(struct surface_rays *rays)
{
    const struct tubes *tubes = &rays->tubes;
    tube_ramp(rays->ramp);
    rays->corners = memory_raw(rays->parts.vertex_count, sizeof *rays->corners);
    rays->points = memory_zeroed(tubes->point_count + 1, sizeof *rays->points);
    rays->paints = memory_zeroed(tubes->point_count + 1, sizeof *rays->paints);
    if (!rays->corners || !rays->points || !rays->paints) {
        return CONUS_ERROR_MEMORY;
    }
    tubes_points(rays->points, tubes);
    return tubes_paint(rays->paints, tubes, &(const struct tube_colouring){0}, NULL);
}

conus_status surface_rays_create(struct surface_rays **out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct surface_rays *rays = memory_zeroed(1, sizeof *rays);
    conus_status status = rays ? mesh_list_init(&rays->parts, atlas, memory_left) : CONUS_ERROR_MEMORY;
    status = status || !atlas->tractogram_count ? status : tubes_init(&rays->tubes, atlas, memory_left);
    status = status ? status : make_lists(rays);
    if (status) {
        surface_rays_destroy(rays);
        return status;
    }
    *out = rays;
    return CONUS_OK;
}

conus_status surface_rays_update(struct surface_rays *rays, const conus_atlas *atlas,
                                 const struct tube_colouring *colouring, const bool *const *is_pale)
{
    mesh_list_show(&rays->parts, atlas);
    memset(rays->paints, 0, rays->tubes.point_count * sizeof *rays->paints);
    return tubes_paint(rays->paints, &rays->tubes, colouring, is_pale);
}

void surface_rays_destroy(struct surface_rays *rays)
{
    if (rays) {
        mesh_list_finish(&rays->parts);
        tubes_finish(&rays->tubes);
        memory_free(rays->points);
        memory_free(rays->paints);
        memory_free(rays->corners);
        memory_free(rays->first);
        memory_free(rays->items);
        memory_free(rays);
    }
}

static void place_corners(struct surface_rays *rays)
{
    const double *eye = rays->view.camera->world_from_camera + 12;
    for (size_t v = 0; v < rays->parts.vertex_count; v++) {
        double offset[3];
        for (int a = 0; a < 3; a++) {
            offset[a] = (double)rays->parts.vertices[v].position[a] - eye[a];
        }
        for (int a = 0; a < 3; a++) {
            rays->corners[v][a] = (float)vec3_dot(rays->rows + (ptrdiff_t)3 * a, offset);
        }
    }
}

/* Counts an item in the places of its bands, or with `items` lists it there and moves the places on. */
static void deal_item(struct surface_rays *rays, size_t *places, uint32_t *items, size_t item)
{
    struct span span;
    struct tube tube;
    if (span_item(&span, &tube, rays, item)) {
        for (long band = span.first[1] / SURFACE_BAND; band <= span.last[1] / SURFACE_BAND; band++) {
            if (items) {
                items[places[band]] = (uint32_t)item;
            }
            places[band]++;
        }
    }
}

static void deal_items(struct surface_rays *rays, size_t *places, uint32_t *items)
{
    const size_t triangles = rays->parts.index_count / 3;
    for (size_t i = 0; i < rays->parts.part_count; i++) {
        const struct mesh_entry *part = &rays->parts.parts[i];
        bool is_drawn = mesh_list_draws(&rays->parts, i, rays->view.opacity, false) ||
                        mesh_list_draws(&rays->parts, i, rays->view.opacity, true);
        for (size_t t = 0; t < part->count / 3 && is_drawn; t++) {
            deal_item(rays, places, items, part->first / 3 + t);
        }
    }
    for (size_t i = 0; i < rays->tubes.range_count; i++) {
        const struct tube_range *range = &rays->tubes.ranges[i];
        size_t count = rays->view.draft > 0 ? range->draft : range->count;
        for (size_t n = range->first; n < range->first + count; n++) {
            deal_item(rays, places, items, triangles + n);
        }
    }
}

conus_status surface_rays_begin(struct surface_rays *rays, const struct mesh_layer_view *view)
{
    const size_t bands = (view->height + SURFACE_BAND - 1) / SURFACE_BAND;
    rays->view = *view;
    mesh_camera_rows(rays->rows, view->camera);
    mesh_camera_columns(rays->columns, rays->rows);
    place_corners(rays);
    rays->layer_count = 0;
    for (size_t i = 0; i < rays->parts.part_count; i++) {
        rays->layer_count += mesh_list_draws(&rays->parts, i, view->opacity, true);
    }
    rays->layer_count = rays->layer_count < MESH_LAYER_PEELS ? rays->layer_count : MESH_LAYER_PEELS;
    memory_free(rays->first);
    memory_free(rays->items);
    rays->items = NULL;
    size_t *places = memory_zeroed(bands + 1, sizeof *places);
    rays->first = memory_zeroed(bands + 1, sizeof *rays->first);
    conus_status status = places && rays->first ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        deal_items(rays, places, NULL);
        for (size_t band = 0; band < bands; band++) {
            rays->first[band + 1] = rays->first[band] + places[band];
            places[band] = rays->first[band];
        }
        rays->items = memory_raw(rays->first[bands], sizeof *rays->items);
        status = rays->items ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!status) {
        deal_items(rays, places, rays->items);
    }
    memory_free(places);
    return status;
}

conus_status surface_band_init(struct surface_band *out, const struct surface_rays *rays)
{
    const size_t pixels = (size_t)SURFACE_BAND * rays->view.width;
    out->layer_count = rays->layer_count;
    out->solid = memory_raw(pixels, sizeof *out->solid);
    out->layers = memory_raw(pixels * rays->layer_count, sizeof *out->layers);
    return out->solid && out->layers ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void surface_band_finish(struct surface_band *band)
{
    memory_free(band->solid);
    memory_free(band->layers);
    *band = (struct surface_band){0};
}

static uint32_t number_of(const struct surface_rays *rays, const struct surface_hit *hit)
{
    return hit->object & TUBE_OWN_COLOUR ? rays->parts.mapped : hit->object;
}

/* Puts a translucent surface in its place among those of a pixel, of which each object has only its nearest one. */
static void add_layer(struct surface_hit *layers, size_t count, const struct surface_rays *rays,
                      const struct surface_hit *hit)
{
    size_t at = 0;
    while (at < count && layers[at].depth > 0 && layers[at].depth <= hit->depth) {
        if (number_of(rays, &layers[at]) == number_of(rays, hit)) {
            return;
        }
        at++;
    }
    if (at == count) {
        return;
    }
    size_t end = at; /* the object's place behind it, else the first free one, else the last */
    while (end + 1 < count && layers[end].depth > 0 && number_of(rays, &layers[end]) != number_of(rays, hit)) {
        end++;
    }
    memmove(layers + at + 1, layers + at, (end - at) * sizeof *layers);
    layers[at] = *hit;
}

/* Where most of the corners have no value, the surface has its own colour. */
static uint32_t paint_of(const struct surface_rays *rays, const uint32_t *t, const double weight[3])
{
    const uint32_t number = rays->parts.vertices[t[0]].object;
    if (number != rays->parts.mapped || !rays->parts.values) {
        return number;
    }
    double value[2] = {0};
    for (int k = 0; k < 3; k++) {
        value[0] += weight[k] * (double)rays->parts.values[t[k]][0];
        value[1] += weight[k] * (double)rays->parts.values[t[k]][1];
    }
    double at = fmin(fmax(value[0] / fmax(value[1], 1e-6), 0), 1) * TUBE_RAMP_STEPS;
    int step = at < TUBE_RAMP_STEPS ? (int)at : TUBE_RAMP_STEPS - 1;
    uint32_t own = TUBE_OWN_COLOUR;
    for (int c = 0; c < 3; c++) {
        double low = (double)rays->ramp[step][c];
        double colour = low + (at - step) * ((double)rays->ramp[step + 1][c] - low);
        own |= (uint32_t)(255 * colour + 0.5) << 8 * c;
    }
    return value[1] >= 0.5 ? own : number;
}

/* The normal on the side that is seen, of corners with these weights. */
static void find_normal(float out[3], const struct surface_rays *rays, const uint32_t *t, const double weight[3],
                        bool is_front)
{
    double side[3] = {0};
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++) {
            side[a] += weight[k] * (double)rays->parts.vertices[t[k]].normal[a];
        }
    }
    double scale = (is_front ? 1 : -1) / fmax(vec3_length(side), 1e-6);
    for (int a = 0; a < 3; a++) {
        out[a] = (float)(scale * side[a]);
    }
}

static double ray_at(long pixel, double shift, uint32_t size)
{
    return ((double)pixel + 0.5 + shift) / size * 2 - 1;
}

/* A ray (x, y, 1) passes inside where it is on one side of the three planes through the eye and an edge (Olano and
 * Greer 1997). Two triangles find the same number for the edge that they share, but for its sign. */
static void fill_triangle(struct surface_band *out, const struct surface_rays *rays, size_t triangle,
                          const struct span *span, const double shift[2])
{
    const uint32_t *t = corners_of(rays, triangle);
    const uint32_t object = rays->parts.vertices[t[0]].object;
    const bool translucent = rays->view.opacity && rays->view.opacity[object] < 1;
    double corner[3][3], plane[3][3];
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++) {
            corner[k][a] = (double)rays->corners[t[k]][a];
        }
    }
    for (int k = 0; k < 3; k++) {
        vec3_cross(plane[k], corner[(k + 1) % 3], corner[(k + 2) % 3]);
    }
    const double volume = vec3_dot(corner[0], plane[0]);
    const double sign = volume > 0 ? 1 : -1;
    for (long row = span->first[1]; row <= span->last[1]; row++) {
        const double y = ray_at(row, shift[1], rays->view.height);
        const double level[3] = {plane[0][1] * y + plane[0][2], plane[1][1] * y + plane[1][2],
                                 plane[2][1] * y + plane[2][2]};
        for (long column = span->first[0]; column <= span->last[0]; column++) {
            const double x = ray_at(column, shift[0], rays->view.width);
            double weight[3] = {plane[0][0] * x + level[0], plane[1][0] * x + level[1], plane[2][0] * x + level[2]};
            if (!(sign * weight[0] >= 0 && sign * weight[1] >= 0 && sign * weight[2] >= 0)) {
                continue;
            }
            const double sum = weight[0] + weight[1] + weight[2];
            const double depth = volume / sum;
            const size_t pixel = (size_t)(row % SURFACE_BAND) * rays->view.width + (size_t)column;
            struct surface_hit *solid = &out->solid[pixel];
            if (!(depth >= NEAR && isfinite(depth)) ||
                (!translucent && solid->depth > 0 && solid->depth <= (float)depth)) {
                continue;
            }
            for (int k = 0; k < 3; k++) {
                weight[k] /= sum;
            }
            struct surface_hit hit = {.depth = (float)depth, .object = paint_of(rays, t, weight)};
            find_normal(hit.normal, rays, t, weight, volume > 0);
            if (translucent) {
                add_layer(out->layers + pixel * out->layer_count, out->layer_count, rays, &hit);
            } else {
                *solid = hit;
            }
        }
    }
}

static double ball(const double centre[3], double radius, const double ray[3])
{
    double away[3];
    double along = vec3_dot(centre, ray);
    vec3_add_scaled(away, centre, -along, ray);
    double inside = radius * radius - vec3_dot(away, away);
    return inside < 0 ? INFINITY : along - sqrt(inside);
}

/* Where the unit vector `ray` meets the capsule from `a` to `b`, relative to a point of the ray that is near them. */
static double capsule(const double a[3], const double b[3], double radius, const double ray[3])
{
    double axis[3], across[3], offset[3], miss[3];
    vec3_sub(axis, b, a);
    const double span = vec3_length(axis);
    const double cap = fmin(ball(a, radius, ray), ball(b, radius, ray));
    vec3_scale(axis, axis, span > 0 ? 1 / span : 0);
    vec3_add_scaled(across, ray, -vec3_dot(ray, axis), axis);
    const double square = vec3_dot(across, across);
    if (span == 0 || square < 1e-10) {
        return cap;
    }
    vec3_scale(offset, a, -1);
    vec3_add_scaled(offset, offset, vec3_dot(a, axis), axis);
    const double closest = -vec3_dot(offset, across) / square;
    vec3_add_scaled(miss, offset, closest, across);
    const double inside = radius * radius - vec3_dot(miss, miss);
    if (inside < 0) {
        return INFINITY;
    }
    const double t = closest - sqrt(inside / square);
    const double place = t * vec3_dot(ray, axis) - vec3_dot(a, axis);
    return place >= 0 && place <= span ? t : cap;
}

static void meet_tube(struct surface_hit *solid, const struct surface_rays *rays, const struct tube *tube, double x,
                      double y)
{
    const double *m = rays->columns;
    double ray[3], a[3], b[3], point[3];
    for (int axis = 0; axis < 3; axis++) {
        ray[axis] = m[axis] * x + m[3 + axis] * y + m[6 + axis];
    }
    const double per_depth = vec3_length(ray);
    vec3_scale(ray, ray, 1 / per_depth);
    const double near = 0.5 * (vec3_dot(tube->from, ray) + vec3_dot(tube->to, ray));
    vec3_add_scaled(a, tube->from, -near, ray);
    vec3_add_scaled(b, tube->to, -near, ray);
    const double t = capsule(a, b, tube->radius, ray);
    const double depth = (near + t) / per_depth;
    if (!(depth >= NEAR && isfinite(depth)) || (solid->depth > 0 && solid->depth <= (float)depth)) {
        return;
    }
    vec3_scale(point, ray, t);
    vec3_sub(b, b, a);
    vec3_sub(point, point, a);
    const double span = vec3_dot(b, b);
    vec3_add_scaled(point, point, span > 0 ? -fmin(fmax(vec3_dot(point, b) / span, 0), 1) : 0, b);
    vec3_normalise(point, point);
    *solid = (struct surface_hit){
        .normal = {(float)point[0], (float)point[1], (float)point[2]}, .depth = (float)depth, .object = tube->paint};
}

static void fill_tube(struct surface_band *out, const struct surface_rays *rays, const struct tube *tube,
                      const struct span *span, const double shift[2])
{
    for (long row = span->first[1]; row <= span->last[1]; row++) {
        const double y = ray_at(row, shift[1], rays->view.height);
        for (long column = span->first[0]; column <= span->last[0]; column++) {
            struct surface_hit *solid = &out->solid[(size_t)(row % SURFACE_BAND) * rays->view.width + (size_t)column];
            if (!(solid->depth > 0) || (double)solid->depth > tube->front) {
                meet_tube(solid, rays, tube, ray_at(column, shift[0], rays->view.width), y);
            }
        }
    }
}

void surface_rays_fill(struct surface_band *out, const struct surface_rays *rays, size_t number, const double shift[2])
{
    const size_t triangles = rays->parts.index_count / 3;
    const size_t pixels = (size_t)SURFACE_BAND * rays->view.width;
    const long low = (long)number * SURFACE_BAND;
    memset(out->solid, 0, pixels * sizeof *out->solid);
    memset(out->layers, 0, pixels * out->layer_count * sizeof *out->layers);
    for (size_t i = rays->first[number]; i < rays->first[number + 1]; i++) {
        struct span span = {0};
        struct tube tube = {0};
        span_item(&span, &tube, rays, rays->items[i]);
        span.first[1] = span.first[1] > low ? span.first[1] : low;
        span.last[1] = span.last[1] < low + SURFACE_BAND - 1 ? span.last[1] : low + SURFACE_BAND - 1;
        if (rays->items[i] < triangles) {
            fill_triangle(out, rays, rays->items[i], &span, shift);
        } else {
            fill_tube(out, rays, &tube, &span, shift);
        }
    }
}
