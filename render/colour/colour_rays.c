/* SPDX-License-Identifier: BSD-3-Clause */
/* The colour pass on the CPU: colour.frag.glsl and colour_layers.glsl for one ray. What is said there holds here:
 * places are in camera space (mm, looking down -z), t is the depth of a plane, and a ray is t * direction with
 * direction.z = -1.
 *
 * The walk is that of colour_layers.glsl, for opaque pictures, too; but a sample on a plane stands for half the way to
 * its neighbours, and an area begins with the object that its surface has there. Only + - * / and roots make a pixel of
 * what the view holds, and nothing fuses them, so that all processors round alike. */
#include "base/look.h"
#include "base/memory.h"
#include "base/threads.h"
#include "render/colour/colour.h"
#include "render/image/image.h"
#include "render/passes/shapes.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Four numbers side by side: red, green, blue, opacity; or x, y, z and something else. */
typedef float four __attribute__((vector_size(16)));
typedef uint8_t four_bytes __attribute__((vector_size(4)));
typedef int32_t four_whole __attribute__((vector_size(16)));

static const float OPAQUE = 0.995F;
static const float GHOST = 0.3F;       /* how much the cone, its axis and the markers show through areas before them */
static const float SILHOUETTE = 0.35F; /* what is left of the light where a surface is seen from its side */
static const float NEAR = 0.1F;        /* mm before the eye */
static const float NEVER = 1e9F;
static const float SURFACE = (FIELD_SURFACE - 0.5F) / 255;
static const float EDGE = 0.3F; /* cosine between a surface's normal and the view, below which glass has an outline */
static const float OUTLINE_OPACITY = 0.8F;

enum {
    HATCH = 8, /* pixels from stripe to stripe */
    SEEN = 16, /* translucent areas along one ray */
    REFINING = 6,
    BORDER = UINT8_MAX, /* not how far a cell is from others: its voxels are of several objects, all of some */
    LEAST_PIXELS = 4096 /* that are worth a thread */
};

struct colour_rays_device {
    struct colour_device device;
    struct surface_rays *surfaces; /* NULL if there are none */
    float linear[256];             /* of sRGB bytes */
    struct bricks alike;           /* of single cells (find_alike()); none before it is needed */
};

static const size_t texel_sizes[] = {
    [VOLUME_TEXTURE_UINT8] = 1, [VOLUME_TEXTURE_UINT16] = 2, [VOLUME_TEXTURE_UINT32] = 4,
    [VOLUME_TEXTURE_BYTE4] = 4, [VOLUME_TEXTURE_HALF4] = 16, [VOLUME_TEXTURE_FLOAT4] = 16};

static conus_status hold(struct colour_texels *out, struct colour_device *device, enum volume_texture_kind kind,
                         const size_t dim[3], const void *texels, uint64_t *memory_left)
{
    bricks_finish(&((struct colour_rays_device *)device)->alike); /* of other numbers, perhaps */
    size_t slice;
    size_t count;
    size_t bytes;
    if (!memory_multiply(dim[0], dim[1], &slice) || !memory_multiply(slice, dim[2], &count) ||
        !memory_multiply(count, texel_sizes[kind], &bytes) || bytes > *memory_left) {
        return fail(CONUS_ERROR_MEMORY, "field of %zu x %zu x %zu voxels: %llu bytes are left of the allowed memory",
                    dim[0], dim[1], dim[2], (unsigned long long)*memory_left);
    }
    out->kind = kind;
    memcpy(out->dim, dim, sizeof out->dim);
    out->bytes = memory_raw(count, texel_sizes[kind]);
    if (!out->bytes) {
        return CONUS_ERROR_MEMORY;
    }
    if (texels) {
        memcpy(out->bytes, texels, bytes);
    }
    *memory_left -= bytes;
    return CONUS_OK;
}

static void fill(struct colour_texels *texels, size_t first, size_t count, const void *from)
{
    const size_t slice = texels->dim[0] * texels->dim[1] * texel_sizes[texels->kind];
    memcpy((uint8_t *)texels->bytes + first * slice, from, count * slice);
}

static void release(struct colour_texels *texels)
{
    memory_free(texels->bytes);
    texels->bytes = NULL;
}

static conus_status prepare(struct colour_device *device, const struct colour_pass *pass)
{
    struct colour_rays_device *rays = (struct colour_rays_device *)device;
    (void)pass;
    for (int i = 0; i < 256; i++) {
        rays->linear[i] = (float)linear_from_srgb(i / 255.0);
    }
    return CONUS_OK;
}

static conus_status add_meshes(struct colour_device *device, const conus_atlas *atlas, uint64_t *memory_left)
{
    return surface_rays_create(&((struct colour_rays_device *)device)->surfaces, atlas, memory_left);
}

static conus_status paint(struct colour_device *device, const conus_atlas *atlas,
                          const struct tube_colouring *colouring, const bool *const *is_pale)
{
    return surface_rays_update(((struct colour_rays_device *)device)->surfaces, atlas, colouring, is_pale);
}

/* What the rays of one picture share. */
struct scene {
    const struct colour_rays_device *device;
    const struct colour_pass *pass;
    struct colour_view_block view;
    const uint32_t *tiles;      /* that are drawn; NULL: all */
    float part;                 /* of a pixel that each ray is */
    const struct bricks *alike; /* NULL: rays look at each plane */
    bool has_layers;            /* colour_pass_has_layers() */
    float shift[2];             /* of the rays under way */
    uint32_t width, height;
    float *rgba;
    struct surface_band *bands; /* [threads] Where there are surfaces. */
    atomic_size_t next;         /* band that no thread has begun */
    atomic_bool stop;
    const struct picture_listener *listener;
    conus_status status; /* of the listener, which the calling thread asks */
    size_t threads;
};

/* Opacity of mm whose extinction, times mm, is x: 1 - 2^-x. By the series of e^y for |y| <= ln(2) / 2, whose remainder
 * is below 2e-10. */
static float opacity_of(float x)
{
    static const double LN2 = 0.69314718055994530942;
    if (!(x < 60)) {
        return 1;
    }
    const int whole = (int)((double)x + 0.5);
    const double y = (whole - (double)x) * LN2;
    double power = 1.0 / 5040 + y * (1.0 / 40320);
    power = 1.0 / 120 + y * (1.0 / 720 + y * power);
    power = 1.0 / 6 + y * (1.0 / 24 + y * power);
    power = 1 + y * (1 + y * (0.5 + y * power));
    return (float)(1 - power / (double)(UINT64_C(1) << whole));
}

static float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(float v[3])
{
    const float length = sqrtf(dot(v, v));
    for (int a = 0; a < 3; a++) {
        v[a] /= length;
    }
}

/* The linear part of a matrix of columns, times v. */
static void turn(float out[3], const float m[16], const float v[3])
{
    for (int a = 0; a < 3; a++) {
        out[a] = m[a] * v[0] + m[4 + a] * v[1] + m[8 + a] * v[2];
    }
}

static float least(float a, float b)
{
    return b < a ? b : a;
}

static float most(float a, float b)
{
    return a < b ? b : a;
}

static float between(float x, float low, float high)
{
    return least(most(x, low), high);
}

/* floor() of what fits, without a call of the C library. */
static int whole_below(float x)
{
    const int whole = (int)x;
    return whole - (x < (float)whole);
}

/* The same of four; 1 is -1 in comparisons of vectors. */
static four_whole four_below(four x)
{
    const four_whole whole = __builtin_convertvector(x, four_whole);
    return whole + (x < __builtin_convertvector(whole, four));
}

static float depth_of(const struct scene *scene, float plane)
{
    return scene->view.planes[0] + (plane + 0.5F) * scene->view.planes[1];
}

static float plane_after(const struct scene *scene, float depth)
{
    const float at = (depth - scene->view.planes[0]) / scene->view.planes[1] - 0.5F;
    return fabsf(at) < 1e7F ? -(float)whole_below(-at) : at;
}

struct track {
    const struct colour_volume *volume; /* NULL: it is not there, or the ray does not come into it */
    four from, along, inverse;          /* at depth t: from + t * along */
    float first, end;                   /* planes first, first + 1, ... end - 1 lie in the volume */
};

static void make_track(struct track *out, const struct scene *scene, const struct colour_volume *volume,
                       const float from_camera[16], float is_there, const float direction[3])
{
    float enters = NEAR;
    float leaves = NEVER;
    out->volume = NULL;
    out->first = out->end = NEVER;
    if (is_there == 0) {
        return;
    }
    float along[3];
    turn(along, from_camera, direction);
    for (int a = 0; a < 3; a++) {
        out->from[a] = from_camera[12 + a];
        out->along[a] = fabsf(along[a]) < 1e-9F ? 1e-9F : along[a];
        out->inverse[a] = 1 / out->along[a];
        const float one = -out->from[a] * out->inverse[a];
        const float other = (1 - out->from[a]) * out->inverse[a];
        enters = most(enters, least(one, other));
        leaves = least(leaves, most(one, other));
    }
    const float first = most(plane_after(scene, enters), 0);
    const float end = least(plane_after(scene, leaves), scene->view.planes[2]);
    if (first < end) {
        out->volume = volume;
        out->first = first;
        out->end = end;
    }
}

static four place_on(const struct track *track, float depth)
{
    return track->from + depth * track->along;
}

static bool lies_in(four place)
{
    const four_whole is_in = (place >= 0) & (place <= 1);
    return is_in[0] & is_in[1] & is_in[2];
}

static bool is_on(const struct track *track, float plane)
{
    return plane >= track->first && plane < track->end;
}

static float end_of(const struct track *track)
{
    return track->end < NEVER ? track->end : 0;
}

/* The plane up to which the volume is empty or a brick may be visible, from `plane` on; `shows` is set for such a
 * brick.
 */
static float look_ahead(const struct scene *scene, const struct track *track, const float bricks[4], float plane,
                        bool *shows)
{
    if (plane < track->first) {
        return most(plane + 1, track->first);
    }
    if (plane >= track->end) {
        return NEVER;
    }
    const struct colour_texels *empty = &track->volume->empty;
    const four place = place_on(track, depth_of(scene, plane));
    float leave = INFINITY;
    size_t brick[3];
    for (int a = 0; a < 3; a++) {
        brick[a] = (size_t)between(place[a] * bricks[a], 0, (float)(empty->dim[a] - 1));
    }
    const float gap =
        (float)((const uint8_t *)empty->bytes)[brick[0] + empty->dim[0] * (brick[1] + empty->dim[1] * brick[2])];
    *shows = *shows || gap == 0;
    for (int a = 0; a < 3; a++) {
        const float reach = most(gap - 1, 0);
        const float side = track->along[a] >= 0 ? 1 + reach : -reach;
        leave = least(leave, (((float)brick[a] + side) / bricks[a] - track->from[a]) * track->inverse[a]);
    }
    return most(plane + 1, plane_after(scene, leave));
}

/* The eight texels around a place and how much of each is in a sample: along each axis the part of the second. */
struct cell {
    size_t at[8];
    four part;
};

static void find_cell(struct cell *out, const size_t dim[3], four place)
{
    const four_whole size = {(int32_t)dim[0], (int32_t)dim[1], (int32_t)dim[2], 1};
    const four corner = place * __builtin_convertvector(size, four) - 0.5F;
    const four_whole whole = four_below(corner);
    const four_whole before = whole < 0;
    const four_whole behind = whole + 1 >= size;
    const four_whole low = ~before & ((behind & (size - 1)) | (~behind & whole)); /* clamped to the edge */
    const four_whole within = ~(before | behind);
    const size_t base = (size_t)low[0] + dim[0] * ((size_t)low[1] + dim[1] * (size_t)low[2]);
    const size_t step[3] = {within[0] ? 1 : 0, within[1] ? dim[0] : 0, within[2] ? dim[0] * dim[1] : 0};
    out->part = corner - __builtin_convertvector(whole, four);
    for (size_t n = 0; n < 8; n++) {
        out->at[n] = base + (n & 1 ? step[0] : 0) + (n & 2 ? step[1] : 0) + (n & 4 ? step[2] : 0);
    }
}

/* The sample in a cell of these corners, which change. */
static four mix(four corner[8], four part)
{
    for (int a = 0, count = 4; a < 3; a++, count /= 2) {
        for (int n = 0; n < count; n++) {
            corner[n] = corner[2 * n] + part[a] * (corner[2 * n + 1] - corner[2 * n]);
        }
    }
    return corner[0];
}

/* Bytes from 0 to 1, as GL has them: between voxel centres. */
static four sample_bytes(const struct colour_texels *texels, four place)
{
    const uint8_t *bytes = texels->bytes;
    struct cell cell;
    four corner[8];
    find_cell(&cell, texels->dim, place);
    for (int n = 0; n < 8; n++) {
        four_bytes texel;
        memcpy(&texel, bytes + 4 * cell.at[n], sizeof texel);
        corner[n] = __builtin_convertvector(texel, four);
    }
    return mix(corner, cell.part) / 255.0F;
}

static four sample_floats(const struct colour_texels *texels, four place)
{
    const float *floats = texels->bytes;
    struct cell cell;
    four corner[8];
    find_cell(&cell, texels->dim, place);
    for (int n = 0; n < 8; n++) {
        memcpy(&corner[n], floats + 4 * cell.at[n], sizeof corner[n]);
    }
    return mix(corner, cell.part);
}

static void blend(four *sum, four layer)
{
    *sum += (1 - (*sum)[3]) * layer;
}

static void blend_surface(four *sum, four colour, float opacity)
{
    colour[3] = 1;
    blend(sum, colour * opacity);
}

/* Of the gradient in a texel of a field; its length in `strength`. */
static void decode_gradient(float out[3], float *strength, four texel)
{
    for (int a = 0; a < 3; a++) {
        out[a] = texel[a] * (255.0F / 127) - 128.0F / 127;
    }
    *strength = sqrtf(dot(out, out));
}

static float diffuse(const struct scene *scene, const float normal[3])
{
    return most(dot(normal, scene->view.light), 0);
}

/* What is in the ray's way at a place: colour, and extinction per mm, which is 0 where nothing is. */
struct sample {
    four context, haze;
};

/* Context: colour and extinction by the transfer function; shaded where there is a gradient. */
static four sample_context(const struct scene *scene, four place)
{
    const four field = sample_bytes(&scene->pass->context.field, place);
    const int level = (int)(field[3] * (float)(COLOUR_TABLE_ENTRIES - 1) + 0.5F);
    four entry;
    memcpy(&entry, (const float *)scene->pass->transfer.bytes + (ptrdiff_t)4 * level, sizeof entry);
    if (entry[3] == 0) {
        return entry;
    }
    float gradient[3];
    float strength;
    decode_gradient(gradient, &strength, field);
    const float toward = -dot(gradient, scene->view.light) / most(strength, 1e-6F);
    const float shade = 1 - strength + strength * (0.35F + 0.8F * most(toward, 0));
    const float extinction = entry[3] * scene->view.light[3];
    entry *= shade;
    entry[3] = extinction;
    return entry;
}

static struct sample sample_at(const struct scene *scene, const struct track *context, const struct track *haze,
                               float depth)
{
    struct sample sample = {{0}, {0}};
    if (context->volume) {
        const four place = place_on(context, depth);
        if (lies_in(place)) {
            sample.context = sample_context(scene, place);
        }
    }
    if (haze->volume) {
        const four place = place_on(haze, depth);
        if (lies_in(place)) {
            const four texel = sample_floats(&haze->volume->field, place);
            sample.haze = texel / most(texel[3], 1e-9F);
            sample.haze[3] = texel[3];
        }
    }
    return sample;
}

static void blend_sample(four *sum, const struct sample *sample, float mm)
{
    if (sample->context[3] > 0) {
        blend_surface(sum, sample->context, opacity_of(sample->context[3] * mm));
    }
    if (sample->haze[3] > 0) {
        blend_surface(sum, sample->haze, opacity_of(sample->haze[3] * mm));
    }
}

static uint32_t object_of(const struct colour_texels *objects, size_t at)
{
    return objects->kind == VOLUME_TEXTURE_UINT8    ? ((const uint8_t *)objects->bytes)[at]
           : objects->kind == VOLUME_TEXTURE_UINT16 ? ((const uint16_t *)objects->bytes)[at]
                                                    : ((const uint32_t *)objects->bytes)[at];
}

/* The eight voxels around a place, and their objects. */
struct voxels {
    struct cell cell;
    uint32_t objects[8];
};

static void find_voxels(struct voxels *out, const struct scene *scene, four place)
{
    find_cell(&out->cell, scene->pass->objects.dim, place);
    for (int n = 0; n < 8; n++) {
        out->objects[n] = object_of(&scene->pass->objects, out->cell.at[n]);
    }
}

/* How much of a sample at the place the object's voxels are. */
static float weight_of(const struct voxels *voxels, uint32_t object)
{
    const four x = voxels->cell.part;
    const four low = 1 - x;
    const four row = (four){low[0], x[0], low[0], x[0]} * (four){low[1], low[1], x[1], x[1]};
    const four below = row * low[2];
    const four above = row * x[2];
    float sum = 0;
    for (int n = 0; n < 4; n++) {
        sum += voxels->objects[n] == object ? below[n] : 0;
    }
    for (int n = 0; n < 4; n++) {
        sum += voxels->objects[4 + n] == object ? above[n] : 0;
    }
    return sum;
}

/* The object with the largest weight. */
static uint32_t object_among(const struct voxels *voxels)
{
    uint32_t best = 0;
    float largest = -1;
    for (int n = 0; n < 8; n++) {
        const uint32_t object = voxels->objects[n];
        const float weight = object && object != best ? weight_of(voxels, object) : -1;
        best = weight > largest ? object : best;
        largest = most(largest, weight);
    }
    return best;
}

/* Whether the place is in an area. The field is sampled only where some voxels are of objects and some are not: it is
 * held on their sides of the surface. */
static bool is_area(const struct scene *scene, const struct voxels *voxels)
{
    const uint8_t *texels = scene->pass->areas.field.bytes;
    float corner[8];
    int occupied = 0;
    for (int n = 0; n < 8; n++) {
        occupied += voxels->objects[n] != 0;
    }
    if (occupied % 8 == 0) {
        return occupied;
    }
    for (int n = 0; n < 8; n++) {
        corner[n] = texels[4 * voxels->cell.at[n] + 3];
    }
    for (int a = 0, count = 4; a < 3; a++, count /= 2) {
        for (int n = 0; n < count; n++) {
            corner[n] = corner[2 * n] + voxels->cell.part[a] * (corner[2 * n + 1] - corner[2 * n]);
        }
    }
    return corner[0] / 255.0F >= SURFACE;
}

/* Whether the place is in an area, with the voxels around it. */
static bool shows_area(struct voxels *out, const struct scene *scene, four place)
{
    if (!lies_in(place)) {
        return false;
    }
    find_voxels(out, scene, place);
    return is_area(scene, out);
}

/* The object, 0 if it is not visible. */
static uint32_t visible(const struct scene *scene, uint32_t object)
{
    return scene->pass->opacity[object] > 0 ? object : 0;
}

/* The number of the voxel that is nearest to a place in the volume. */
static uint32_t nearest_object(const struct scene *scene, four place)
{
    const size_t *dim = scene->pass->objects.dim;
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        at[a] = (size_t)least(place[a] * (float)dim[a], (float)(dim[a] - 1));
    }
    return object_of(&scene->pass->objects, at[0] + dim[0] * (at[1] + dim[1] * at[2]));
}

/* The depth at which the object, 0 = any, begins that is found at `inside` and not at `outside`. */
static float object_depth(const struct scene *scene, const struct track *areas, uint32_t object, float outside,
                          float inside)
{
    for (int n = 0; n < REFINING; n++) {
        const float middle = 0.5F * (outside + inside);
        struct voxels voxels;
        const bool found =
            shows_area(&voxels, scene, place_on(areas, middle)) && (!object || object_among(&voxels) == object);
        inside = found ? middle : inside;
        outside = found ? outside : middle;
    }
    return inside;
}

static const float least_gradient = 0.25F; /* of the stored gradient (colour.h) */

/* False where it is a border with an area that is not seen, of which the occupancy has hardly a gradient. */
static bool area_normal(float out[3], const struct scene *scene, four place)
{
    float strength;
    decode_gradient(out, &strength, sample_bytes(&scene->pass->areas.field, place));
    for (int a = 0; a < 3; a++) {
        out[a] = -out[a] / most(strength, 1e-6F);
    }
    return strength > least_gradient || !scene->has_layers;
}

/* The normal of the border between two objects, in world axes: their occupancy has no gradient there. Borders mostly
 * lie along the ray, so that they would be dark: they are lit as if turned towards the eye. */
static void border_normal(float out[3], const struct scene *scene, uint32_t object, four place, const float view[3])
{
    const float *m = scene->view.areas_from_camera;
    float gradient[3], across[3];
    for (int a = 0; a < 3; a++) {
        const float reach = 1.5F / (float)scene->pass->objects.dim[a];
        struct voxels above, below;
        four aside = {0};
        aside[a] = reach;
        find_voxels(&above, scene, place + aside);
        find_voxels(&below, scene, place - aside);
        gradient[a] = (weight_of(&above, object) - weight_of(&below, object)) / reach;
    }
    for (ptrdiff_t a = 0; a < 3; a++) {
        across[a] = dot(m + 4 * a, gradient); /* by the transposed matrix */
    }
    turn(gradient, scene->view.world_from_camera, across);
    const float length = sqrtf(dot(gradient, gradient));
    for (int a = 0; a < 3; a++) {
        out[a] = -gradient[a] / most(length, 1e-6F) - view[a];
    }
    normalise(out);
}

/* A ray of a picture. */
struct ray {
    const struct scene *scene;
    float direction[3], view[3];              /* in the camera's and in the world's axes; the latter has length 1 */
    float per_depth;                          /* mm */
    bool is_striped;                          /* its pixel lies on a stripe of what is hatched */
    const struct surface_hit *solid, *layers; /* meshes and streamlines */
    size_t layer_count;
};

/* Distance of the point from the cone's wall, mm, negative inside; NEVER before the apex and beyond its reach. */
static float distance_to_cone(const struct colour_view_block *view, const float p[3])
{
    float q[3];
    for (int a = 0; a < 3; a++) {
        q[a] = p[a] - view->apex[a];
    }
    const float h = dot(q, view->axis);
    if (view->cone_shape[3] == 0 || h <= view->cone_shape[1] || h > view->cone_shape[2]) {
        return NEVER;
    }
    for (int a = 0; a < 3; a++) {
        q[a] -= h * view->axis[a];
    }
    return (sqrtf(dot(q, q)) - view->cone_shape[0] - h * view->apex[3]) / sqrtf(1 + view->apex[3] * view->apex[3]);
}

static four lit(const struct ray *ray, four albedo, const float normal[3])
{
    const float *light = ray->scene->view.light;
    float half[3] = {light[0] - ray->view[0], light[1] - ray->view[1], light[2] - ray->view[2]};
    normalise(half);
    const float x = most(dot(normal, half), 0);
    const float x2 = x * x, x4 = x2 * x2, x8 = x4 * x4, x16 = x8 * x8;
    return albedo * (0.30F + 0.75F * diffuse(ray->scene, normal)) + 0.06F * (x16 * x8 * (x4 * x2)); /* to the 30th */
}

/* A colour of base/look.h. */
static four look(const struct scene *scene, enum look_colour rgb)
{
    const float *linear = scene->device->linear;
    return (four){linear[rgb >> 16], linear[rgb >> 8 & 255], linear[rgb & 255], 1};
}

/* Colour and emphasis of an object or, of a streamline, what shapes.h says: a colour of its own, or pale. */
static four entry_of(const struct scene *scene, uint32_t number)
{
    const float *linear = scene->device->linear;
    four entry;
    if (number & TUBE_OWN_COLOUR) {
        entry = (four){linear[number & 255], linear[number >> 8 & 255], linear[number >> 16 & 255], EMPHASIS_FULL};
    } else {
        memcpy(&entry, scene->pass->shown + (size_t)4 * (number & ~TUBE_PALE), sizeof entry);
    }
    entry[3] = number & TUBE_PALE ? EMPHASIS_PALE : entry[3];
    return entry;
}

/* How far x is on its way from `low` to `high`, 0 to 1, smoothly. */
static float smooth_step(float low, float high, float x)
{
    const float part = between((x - low) / (high - low), 0, 1);
    return part * part * (3 - 2 * part);
}

/* Darkens a surface where it turns away from the eye, so that one of a single colour shows its shape. */
static float silhouette(const float normal[3], const float view[3])
{
    return SILHOUETTE + (1 - SILHOUETTE) * smooth_step(0, 0.5F, fabsf(dot(normal, view)));
}

/* The colour of a surface at depth t: pale where it is not emphasised, with the cone's footprint on the side that faces
 * the apex. */
static four object_colour(const struct ray *ray, uint32_t object, const float normal[3], float t)
{
    const struct colour_view_block *view = &ray->scene->view;
    const four entry = entry_of(ray->scene, object);
    const float part = entry[3] > 2.5F ? 1 : entry[3] > 1.5F ? (float)ray->is_striped : entry[3];
    four pale = 0.16F * entry + 0.30F;
    if (view->pale[3] > 0) {
        memcpy(&pale, view->pale, sizeof pale);
    }
    four albedo = pale + part * (entry - pale);
    albedo *= view->pale[3] > 0 ? silhouette(normal, ray->view) : 1;
    float place[3], from_apex[3], in_world[3];
    for (int a = 0; a < 3; a++) {
        place[a] = t * ray->direction[a];
        from_apex[a] = place[a] - view->apex[a];
    }
    if (fabsf(distance_to_cone(view, place)) < view->line[1]) {
        turn(in_world, view->world_from_camera, from_apex);
        if (dot(normal, in_world) < 0) {
            memcpy(&albedo, view->cone_colour, sizeof albedo);
        }
    }
    return lit(ray, albedo, normal);
}

struct surface {
    float depth;
    four colour; /* times opacity, as everywhere */
};

static const struct surface nowhere = {1e9F, {0}};

/* The cone's wall at depth t, if it is part of the cone that is drawn. */
static struct surface wall_at(const struct ray *ray, float t)
{
    const struct colour_view_block *view = &ray->scene->view;
    float q[3], normal[3];
    for (int a = 0; a < 3; a++) {
        q[a] = t * ray->direction[a] - view->apex[a];
    }
    const float slope = view->apex[3];
    const float h = dot(q, view->axis);
    if (!(t > NEAR && h > view->cone_shape[1] && h < view->axis[3])) {
        return nowhere;
    }
    for (int a = 0; a < 3; a++) {
        normal[a] = q[a] - ((1 + slope * slope) * h + view->cone_shape[0] * slope) * view->axis[a];
    }
    normalise(normal);
    const float facing = fabsf(dot(normal, ray->direction)) / ray->per_depth;
    float opacity = least(view->cone_colour[3] / most(facing, 0.08F), 0.8F);
    opacity = view->axis[3] - h < 2 * view->line[1] ? most(opacity, 0.5F) : opacity;
    struct surface wall = {.depth = t};
    blend_surface(&wall.colour, (four){view->cone_colour[0], view->cone_colour[1], view->cone_colour[2], 1}, opacity);
    return wall;
}

static void find_walls(struct surface *near, struct surface *far, const struct ray *ray)
{
    const struct colour_view_block *view = &ray->scene->view;
    *near = *far = nowhere;
    if (view->cone_shape[3] == 0) {
        return;
    }
    const float *d = ray->direction;
    const float slope = view->apex[3];
    const float radius = view->cone_shape[0];
    const float k = 1 + slope * slope;
    const float dh = dot(d, view->axis);
    const float h = -dot(view->apex, view->axis);
    const float a = dot(d, d) - k * dh * dh;
    const float b = -dot(d, view->apex) - (k * h + radius * slope) * dh;
    const float c = dot(view->apex, view->apex) - (k * h + 2 * radius * slope) * h - radius * radius;
    float root = b * b - a * c;
    if (root <= 0 || fabsf(a) < 1e-9F) {
        return;
    }
    root = sqrtf(root);
    const struct surface one = wall_at(ray, (-b - root) / a);
    const struct surface two = wall_at(ray, (-b + root) / a);
    *near = one.depth <= two.depth ? one : two;
    *far = one.depth <= two.depth ? two : one;
}

static void hit_axis(struct surface *solid, const struct ray *ray)
{
    const struct colour_view_block *view = &ray->scene->view;
    const float along = dot(ray->direction, view->axis);
    const float start = dot(view->apex, view->axis);
    float d[3], q[3], place[3], normal[3];
    for (int i = 0; i < 3; i++) {
        d[i] = ray->direction[i] - along * view->axis[i];
        q[i] = -view->apex[i] + start * view->axis[i];
    }
    const float a = dot(d, d);
    const float b = dot(d, q);
    const float root = b * b - a * (dot(q, q) - view->line[0] * view->line[0]);
    if (view->cone_shape[3] == 0 || root <= 0 || a < 1e-9F) {
        return;
    }
    const float t = (-b - sqrtf(root)) / a;
    for (int i = 0; i < 3; i++) {
        place[i] = t * ray->direction[i] - view->apex[i];
        q[i] = (q[i] + t * d[i]) / view->line[0];
    }
    const float h = dot(place, view->axis);
    if (t > NEAR && t < solid->depth && h > 0 && h < view->axis[3]) {
        turn(normal, view->world_from_camera, q);
        four colour;
        memcpy(&colour, view->cone_colour, sizeof colour);
        solid->depth = t;
        solid->colour = lit(ray, colour * 0.5F, normal);
        solid->colour[3] = 1;
    }
}

/* Balls in their colour with a dark outline. */
static void hit_markers(struct surface *solid, const struct ray *ray)
{
    const struct colour_view_block *view = &ray->scene->view;
    const float a = dot(ray->direction, ray->direction);
    for (int n = 0; n < view->counts[0]; n++) {
        const float *centre = view->markers[n];
        const float b = -dot(ray->direction, centre);
        const float c = dot(centre, centre) - centre[3] * centre[3];
        const float root = b * b - a * c;
        const float t = (-b - sqrtf(most(root, 0))) / a;
        if (root > 0 && t > NEAR && t < solid->depth) {
            float out[3], normal[3];
            for (int i = 0; i < 3; i++) {
                out[i] = (t * ray->direction[i] - centre[i]) / centre[3];
            }
            turn(normal, view->world_from_camera, out);
            four colour = look(ray->scene, LOOK_MARKER_EDGE);
            if (dot(normal, ray->view) <= -0.55F) {
                memcpy(&colour, view->marker_colours[n], sizeof colour);
                colour = lit(ray, colour, normal);
            }
            colour[3] = 1;
            *solid = (struct surface){t, colour};
        }
    }
}

/* Surfaces on the ray in closed form, or found before: walls of the cone, and layers of meshes. */
struct events {
    struct surface near, far; /* walls */
    size_t layer;             /* the next one */
    float layer_depth;
};

static void next_layer(struct events *events, const struct ray *ray, size_t layer)
{
    const float depth = layer < ray->layer_count ? ray->layers[layer].depth : 0;
    events->layer = layer;
    events->layer_depth = depth > 0 ? depth : NEVER;
}

static void next_wall(struct events *events)
{
    events->near = events->far;
    events->far.depth = NEVER;
}

/* 1 where glass is seen edge on, 0 where it faces the eye more than EDGE says. */
static float outline_of(const float normal[3], const float view[3])
{
    return 1 - smooth_step(0.5F * EDGE, EDGE, fabsf(dot(normal, view)));
}

/* Blends the next event and goes on to the one after it. */
static void take_event(four *sum, struct events *events, const struct ray *ray)
{
    if (events->near.depth <= events->layer_depth) {
        blend(sum, events->near.colour);
        next_wall(events);
        return;
    }
    const struct surface_hit *hit = &ray->layers[events->layer];
    float opacity = ray->scene->pass->opacity[hit->object & TUBE_OWN_COLOUR ? 0 : hit->object];
    four shade = object_colour(ray, hit->object, hit->normal, events->layer_depth);
    if (entry_of(ray->scene, hit->object)[3] > 2.5F) {
        const float outline = outline_of(hit->normal, ray->view);
        shade += outline * (look(ray->scene, LOOK_GLASS_EDGE) - shade);
        opacity += outline * (most(opacity, OUTLINE_OPACITY) - opacity);
    }
    blend_surface(sum, shade, opacity);
    next_layer(events, ray, events->layer + 1);
}

/* How far a ray has come. */
struct walk {
    struct track context, areas, haze;
    float plane, known; /* the next plane; those before `known` are in the same bricks */
    four cells;         /* voxels of the areas from plane to plane, along each axis */
    four per_cell;      /* planes from voxel to voxel */
    four across;        /* the same without sign */
    float clear;        /* plane before which all are in `held`, an area, or in none if that is 0 */
    uint32_t held;
    bool bare;          /* nothing but areas is visible before `known` */
    float end;          /* behind the last plane in any volume */
    float last;         /* depth at which the ray ends */
    float event;        /* of the next one */
    float depth;        /* up to which all is blended */
    struct sample near; /* of the last plane: it stands for the space up to depth `half`; none where a leap ends */
    float half;
    uint32_t before;     /* the area at the plane before */
    bool shows;          /* something may be visible at the next plane */
    bool enters, stops;  /* it comes to an area, or to an event or the ray's last depth */
    uint32_t object;     /* the area at that plane */
    float t;             /* its depth */
    uint32_t seen[SEEN]; /* areas that the ray has come to */
    int seen_count;
};

/* Whether the walk passes an event or the ray's end on its way to depth t. */
static bool stops_before(const struct walk *walk, float t)
{
    return (walk->event < NEVER && walk->event <= t) || t >= walk->last;
}

static bool is_seen(const struct walk *walk, uint32_t object)
{
    bool found = walk->seen_count == SEEN;
    for (int n = 0; n < walk->seen_count; n++) {
        found = found || walk->seen[n] == object;
    }
    return found;
}

/* Blends what is before depth `to`, for which `next` stands from half-way on. NULL = nothing is there. */
static void blend_until(struct walk *walk, four *sum, float to, const struct sample *next, const struct ray *ray)
{
    const float near = least(walk->half, to) - walk->depth;
    const float far = to - most(walk->half, walk->depth);
    if (near > 0) {
        blend_sample(sum, &walk->near, near * ray->per_depth);
    }
    if (next && far > 0) {
        blend_sample(sum, next, far * ray->per_depth);
    }
    walk->depth = to;
}

/* The cell between voxel centres at a corner, clamped to the volume: rounding may have put it outside. */
static size_t cell_at(four_whole *low, const size_t dim[3], four corner)
{
    const four_whole last = {(int32_t)dim[0] - 1, (int32_t)dim[1] - 1, (int32_t)dim[2] - 1, 0};
    *low = __builtin_convertvector(corner, four_whole);
    *low &= *low >= 0;
    *low = (*low & (*low < last)) | (last & (*low >= last));
    return (size_t)(*low)[0] + dim[0] * ((size_t)(*low)[1] + dim[1] * (size_t)(*low)[2]);
}

/* Goes on, from `plane`, to the plane walk->clear before which the ray stays in one object, or in none: in cells alike,
 * and on borders while find_object() would say so. */
static void look_along(struct walk *walk, const struct scene *scene, float plane)
{
    const struct track *areas = &walk->areas;
    const struct colour_texels *objects = &scene->pass->objects;
    const four size = {(float)objects->dim[0], (float)objects->dim[1], (float)objects->dim[2], 1};
    const float last = plane > areas->first ? areas->end - 1 : plane; /* rounding may have put both outside */
    four corner = place_on(areas, depth_of(scene, plane)) * size - 0.5F;
    uint32_t object = walk->before;
    walk->clear = plane;
    while (walk->clear < last) {
        four_whole low;
        const size_t at = cell_at(&low, objects->dim, corner);
        const uint8_t gap = scene->alike->distance[at];
        const bool is_border = gap == BORDER;
        const uint32_t own =
            is_border ? nearest_object(scene, place_on(areas, depth_of(scene, walk->clear))) : object_of(objects, at);
        const bool stays = own == object && (!is_border || visible(scene, own));
        if (gap == 0 || !(stays || (walk->clear == plane && !is_border))) {
            break;
        }
        const four middle = __builtin_convertvector(low, four) + 0.5F;
        const four leaves = (middle - corner) * walk->per_cell + ((float)gap - 0.5F) * walk->across;
        const float inside = is_border ? 0 : most(0, least(least(leaves[0], leaves[1]), leaves[2]));
        const float steps = (float)((int)least(last - walk->clear - 1, inside) + 1);
        walk->clear += steps;
        corner += steps * walk->cells;
        object = own;
    }
    walk->held = visible(scene, object);
}

/* The plane up to which what the ray meets of the areas is known, from `plane` on; as look_ahead(). */
static float look_for_areas(struct walk *walk, const struct scene *scene, float plane, bool *shows)
{
    if (scene->alike && is_on(&walk->areas, plane)) {
        if (plane >= walk->clear) {
            look_along(walk, scene, plane);
        }
        *shows = *shows || plane == walk->clear || walk->held;
        return most(walk->clear, plane + 1);
    }
    bool areas_show = scene->view.planes[3] == 0;
    const float known = look_ahead(scene, &walk->areas, scene->view.areas_bricks, plane, &areas_show);
    walk->clear = areas_show ? plane : known;
    walk->held = 0;
    *shows = *shows || areas_show;
    return known;
}

/* Leaps to the plane before the next one at which anything may be visible. */
static void leap(struct walk *walk, four *sum, const struct ray *ray)
{
    const struct scene *scene = ray->scene;
    const bool is_plain = scene->view.planes[3] == 0;
    while (!walk->shows && !walk->stops) {
        const float plane = walk->plane;
        const bool each = is_plain || is_on(&walk->haze, plane);
        bool shows = each;
        float known = look_ahead(scene, &walk->context, scene->view.context_bricks, plane, &shows);
        walk->bare = !shows && !walk->haze.volume;
        known = least(known, look_for_areas(walk, scene, plane, &shows));
        walk->shows = shows && plane < walk->end;
        walk->known = least(!each ? known : is_plain ? walk->end : walk->haze.end, walk->end);
        known = plane < walk->haze.first ? least(known, walk->haze.first) : known;
        const float next = most(least(known, walk->end) - 1, plane);
        walk->t = plane < walk->end ? least(depth_of(scene, next), walk->last) : walk->last;
        walk->stops = !walk->shows && stops_before(walk, walk->t);
        if (!walk->shows && !walk->stops) {
            blend_until(walk, sum, walk->t, NULL, ray);
            walk->near = (struct sample){{0}, {0}};
            walk->half = walk->t + 0.5F * scene->view.planes[1];
            walk->before = 0;
            walk->plane = next + 1;
        }
    }
}

/* Goes on to the next plane, from one at which no other area begins. */
static void pass_plane(struct walk *walk, four *sum, uint32_t object, const struct ray *ray)
{
    const struct sample next = sample_at(ray->scene, &walk->context, &walk->haze, walk->t);
    blend_until(walk, sum, walk->t, &next, ray);
    walk->near = next;
    walk->half = walk->t + 0.5F * ray->scene->view.planes[1];
    walk->before = object;
    walk->plane += 1;
    walk->shows = walk->plane < walk->known;
}

/* The visible object of an area at depth walk->t of the next plane, 0 if there is none. Where the nearest voxel is that
 * of the area that the ray is in, it stays there. */
static uint32_t find_object(const struct walk *walk, const struct scene *scene)
{
    const four place = place_on(&walk->areas, walk->t);
    struct voxels voxels;
    if (!walk->areas.volume || !shows_area(&voxels, scene, place)) {
        return 0;
    }
    const bool stays = walk->before && nearest_object(scene, place) == walk->before;
    return stays ? walk->before : visible(scene, object_among(&voxels));
}

/* Leaps to the last plane before an event, the ray's end and another object, if nothing but areas is there. */
static void leap_inside(struct walk *walk, const struct scene *scene)
{
    const float until = least(least(walk->clear, walk->known), plane_after(scene, least(walk->event, walk->last)) - 1);
    if (walk->bare && until - 1 > walk->plane) {
        walk->plane = until - 1;
        walk->t = depth_of(scene, walk->plane);
    }
}

/* Goes on until the ray comes to an area, an event or its end, or nothing behind would show. */
static void walk_on(struct walk *walk, four *sum, const struct ray *ray)
{
    const struct scene *scene = ray->scene;
    walk->shows = walk->enters = walk->stops = false;
    while (!walk->enters && !walk->stops && (*sum)[3] < OPAQUE) {
        leap(walk, sum, ray);
        if (walk->stops) {
            return;
        }
        const float depth = depth_of(scene, walk->plane);
        const bool is_held = walk->plane < walk->clear && depth <= walk->last; /* else the latter is before the plane */
        walk->t = least(depth, walk->last);
        walk->object = is_held ? walk->held : find_object(walk, scene);
        walk->stops = stops_before(walk, walk->t);
        walk->enters = walk->object && walk->object != walk->before && !is_seen(walk, walk->object);
        if (!walk->enters && !walk->stops) {
            leap_inside(walk, scene);
            pass_plane(walk, sum, walk->object, ray);
        }
    }
}

/* Adds the part of the cone that shines through the surface at the ray's end, or lies behind what the ray passed. */
static four with_rest(four sum, struct events *events, const struct surface *solid, bool is_hit)
{
    four rest = {0};
    while (events->near.depth < solid->depth) {
        blend(&rest, events->near.colour);
        next_wall(events);
    }
    blend(&rest, solid->colour);
    if (!is_hit) {
        return sum + (1 - sum[3]) * rest;
    }
    const float ghost = GHOST * rest[3];
    rest /= most(rest[3], 1e-6F);
    rest[3] = 1;
    return sum + ghost * (rest - sum);
}

/* The depth at which the walk enters an area. From outside of all it is the one that the surface has there, which need
 * not be that of the plane behind. */
static float entry_depth(struct walk *walk, const struct scene *scene)
{
    struct voxels voxels;
    if (!walk->before && !shows_area(&voxels, scene, place_on(&walk->areas, walk->depth))) {
        const float depth = object_depth(scene, &walk->areas, 0, walk->depth, walk->t);
        find_voxels(&voxels, scene, place_on(&walk->areas, depth));
        const uint32_t object = visible(scene, object_among(&voxels));
        if (object && !is_seen(walk, object)) {
            walk->object = object;
            return depth;
        }
    }
    return object_depth(scene, &walk->areas, walk->object, walk->depth, walk->t);
}

/* The area that the walk enters, at depth `stop`. Returns whether it ends the ray. */
static bool enter_area(struct walk *walk, four *sum, const struct ray *ray, float stop)
{
    const float opacity = ray->scene->pass->opacity[walk->object];
    const four place = place_on(&walk->areas, stop);
    float normal[3];
    if (walk->before || !area_normal(normal, ray->scene, place)) {
        border_normal(normal, ray->scene, walk->object, place, ray->view);
    }
    blend_surface(sum, object_colour(ray, walk->object, normal, stop), opacity);
    walk->seen[walk->seen_count++] = walk->object;
    walk->before = walk->object;
    return !(opacity < 1);
}

static four colour_of(const struct ray *ray)
{
    const struct scene *scene = ray->scene;
    const struct colour_view_block *view = &scene->view;
    const struct colour_pass *pass = scene->pass;
    const float mesh = ray->solid->depth > 0 ? ray->solid->depth : NEVER;
    struct surface solid = nowhere;
    struct events events;
    find_walls(&events.near, &events.far, ray);
    next_layer(&events, ray, 0);
    hit_axis(&solid, ray);
    hit_markers(&solid, ray);

    struct walk walk = {.last = least(solid.depth, mesh)};
    make_track(&walk.context, scene, &pass->context, view->context_from_camera, view->context_bricks[3],
               ray->direction);
    make_track(&walk.areas, scene, &pass->areas, view->areas_from_camera, view->areas_bricks[3], ray->direction);
    make_track(&walk.haze, scene, &pass->haze, view->haze_from_camera, view->haze_shape[3], ray->direction);
    walk.end = most(most(end_of(&walk.context), end_of(&walk.areas)), end_of(&walk.haze));
    for (int a = 0; a < 3 && walk.areas.volume; a++) {
        walk.cells[a] = walk.areas.along[a] * view->planes[1] * (float)walk.areas.volume->size[a];
        walk.per_cell[a] = 1 / walk.cells[a];
        walk.across[a] = fabsf(walk.per_cell[a]);
    }
    walk.plane = least(least(walk.context.first, walk.areas.first), walk.haze.first);
    walk.depth = walk.plane < walk.end ? depth_of(scene, walk.plane - 1) : 0;
    walk.half = walk.depth + 0.5F * view->planes[1];
    four sum = {0};
    bool is_hit = false;
    bool ends = false;
    while (!is_hit && sum[3] < OPAQUE && !ends) {
        walk.event = least(events.near.depth, events.layer_depth);
        walk_on(&walk, &sum, ray);
        if (!walk.enters && !walk.stops) {
            break;
        }
        float stop = walk.enters ? entry_depth(&walk, scene) : walk.t;
        const bool is_event = walk.event < NEVER && walk.event <= stop;
        stop = is_event ? walk.event : stop;
        const float at = is_event || !walk.enters ? depth_of(scene, walk.plane) : stop; /* the plane, skipped or not */
        const struct sample next = sample_at(scene, &walk.context, &walk.haze, at);
        blend_until(&walk, &sum, stop, walk.shows ? &next : NULL, ray);
        if (is_event) {
            take_event(&sum, &events, ray);
        } else if (walk.enters) {
            is_hit = enter_area(&walk, &sum, ray, stop);
        } else {
            ends = true;
        }
    }
    if (!is_hit && mesh <= solid.depth && mesh < NEVER && sum[3] < OPAQUE) {
        blend_surface(&sum, object_colour(ray, ray->solid->object, ray->solid->normal, mesh), 1);
        is_hit = true;
    }
    return with_rest(sum, &events, &solid, is_hit);
}

/* Adds a part of the colour at the pixel to the picture. */
static void draw_pixel(struct scene *scene, const struct surface_band *band, uint32_t column, uint32_t row)
{
    const struct colour_view_block *view = &scene->view;
    const float at[2] = {(float)column + 0.5F, (float)row + 0.5F};
    const size_t in_band = (size_t)(row % SURFACE_BAND) * scene->width + column;
    static const struct surface_hit none = {0};
    struct ray ray = {.scene = scene, .solid = &none, .is_striped = (column + row + 1) % HATCH < HATCH / 2};
    for (int a = 0; a < 2; a++) {
        ray.direction[a] = ((at[a] + scene->shift[a]) / view->lens[2 + a] * 2 - 1) * view->lens[a] + view->middle[a];
    }
    ray.direction[2] = -1;
    ray.per_depth = sqrtf(dot(ray.direction, ray.direction));
    turn(ray.view, view->world_from_camera, ray.direction);
    normalise(ray.view);
    if (band) {
        ray.solid = &band->solid[in_band];
        ray.layers = band->layers + in_band * band->layer_count;
        ray.layer_count = band->layer_count;
    }
    const four colour = colour_of(&ray);
    float *pixel = scene->rgba + 4 * ((size_t)row * scene->width + column);
    for (int c = 0; c < 4; c++) {
        pixel[c] += scene->part * colour[c];
    }
}

static void draw_band(struct scene *scene, struct surface_band *surfaces, size_t number, const double shift[2])
{
    const size_t across = edges_across(scene->width);
    const uint32_t first = (uint32_t)(number * SURFACE_BAND);
    bool is_filled = !surfaces;
    /* Tile by tile: they see the same voxels. Surfaces are found with the first pixel that is drawn. */
    for (uint32_t n = 0; n < SURFACE_BAND * across * COLOUR_TILE; n++) {
        const uint32_t tile = n / (COLOUR_TILE * SURFACE_BAND);
        const uint32_t column = tile * COLOUR_TILE + n % COLOUR_TILE;
        const uint32_t row = first + n / COLOUR_TILE % SURFACE_BAND;
        const size_t number_of_tile = row / COLOUR_TILE * across + tile;
        if (row < scene->height && column < scene->width && (!scene->tiles || scene->tiles[number_of_tile])) {
            if (!is_filled) {
                surface_rays_fill(surfaces, scene->device->surfaces, number, shift);
                is_filled = true;
            }
            draw_pixel(scene, surfaces, column, row);
        }
    }
}

/* Draws the bands that no other thread has begun. The last piece runs on the calling thread, which tells the listener.
 */
static void draw_bands(void *user, size_t piece)
{
    struct scene *scene = user;
    const size_t count = (scene->height + SURFACE_BAND - 1) / SURFACE_BAND;
    const double shift[2] = {(double)scene->shift[0], (double)scene->shift[1]};
    size_t number;
    while (!atomic_load(&scene->stop) && (number = atomic_fetch_add(&scene->next, 1)) < count) {
        draw_band(scene, scene->bands ? &scene->bands[piece] : NULL, number, shift);
        if (piece + 1 == scene->threads && listener_tell(scene->listener, number + 1, count)) {
            scene->status = CONUS_ERROR_CANCELLED;
            atomic_store(&scene->stop, true);
        }
    }
}

/* Deals meshes and streamlines to bands, and makes each thread a band of its own. */
static conus_status find_surfaces(struct scene *scene, const struct colour_view *view)
{
    struct surface_rays *surfaces = scene->device->surfaces;
    const struct mesh_layer_view layer = {.camera = view->camera,
                                          .width = view->width,
                                          .height = view->height,
                                          .opacity = scene->pass->opacity,
                                          .draft = view->draft};
    conus_status status = surface_rays_begin(surfaces, &layer);
    scene->bands = status ? NULL : memory_zeroed(scene->threads, sizeof *scene->bands);
    status = status || scene->bands ? status : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < scene->threads && !status; i++) {
        status = surface_band_init(&scene->bands[i], surfaces);
    }
    return status;
}

/* The numbers of a row of voxels; those behind the last row are the last one's. */
static void read_row(uint32_t *out, const struct colour_texels *objects, size_t j, size_t k)
{
    const size_t *dim = objects->dim;
    const size_t row = (j < dim[1] ? j : dim[1] - 1) + dim[1] * (k < dim[2] ? k : dim[2] - 1);
    for (size_t i = 0; i < dim[0]; i++) {
        out[i] = object_of(objects, row * dim[0] + i);
    }
    out[dim[0]] = out[dim[0] - 1];
}

/* Finds the cells between eight voxel centres of one object or of none, and how far from others they are: nothing can
 * begin on a ray in there. Marks those of several objects, in which a ray stays in areas. */
static conus_status find_alike(struct colour_rays_device *device, const struct colour_texels *objects)
{
    const size_t *dim = objects->dim;
    const size_t count = dim[0] * dim[1] * dim[2];
    const size_t length = dim[0] + 1;
    struct bricks alike = {.dim = {dim[0], dim[1], dim[2]}, .distance = memory_raw(count, 1)};
    uint8_t *full = memory_raw(count, 1);
    uint32_t *rows = memory_raw(4 * length, sizeof *rows);
    if (!alike.distance || !full || !rows) {
        memory_free(alike.distance);
        memory_free(full);
        memory_free(rows);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t row = 0; row < dim[1] * dim[2]; row++) {
        for (size_t n = 0; n < 4; n++) {
            read_row(rows + n * length, objects, row % dim[1] + n % 2, row / dim[1] + n / 2);
        }
        for (size_t i = 0; i < dim[0]; i++) {
            const uint32_t *at = rows + i;
            uint32_t change = 0;
            bool is_full = true;
            for (size_t n = 0; n < 4; n++) {
                change |= (at[0] ^ at[n * length]) | (at[0] ^ at[n * length + 1]);
                is_full = is_full & (at[n * length] != 0) & (at[n * length + 1] != 0);
            }
            alike.distance[row * dim[0] + i] = change ? 0 : UINT8_MAX;
            full[row * dim[0] + i] = is_full;
        }
    }
    bricks_spread(&alike);
    for (size_t i = 0; i < count; i++) {
        const uint8_t gap = alike.distance[i] < BORDER ? alike.distance[i] : BORDER - 1;
        alike.distance[i] = gap == 0 && full[i] ? BORDER : gap;
    }
    memory_free(full);
    memory_free(rows);
    device->alike = alike;
    return CONUS_OK;
}

/* Adds the rays that are shifted so to scene->rgba. */
static conus_status cast(struct scene *scene, const double shift[2])
{
    scene->shift[0] = (float)shift[0];
    scene->shift[1] = (float)shift[1];
    atomic_store(&scene->next, 0);
    threads_run(draw_bands, scene, scene->threads);
    return scene->status;
}

static conus_status draw_tiles(void *user, float *drawn, const uint32_t *tiles, const struct colour_view *view,
                               const struct colour_edges *edges)
{
    struct scene *scene = user;
    conus_status status = CONUS_OK;
    (void)view;
    scene->rgba = drawn;
    scene->tiles = tiles;
    scene->part = 1.0F / (float)edges->count;
    for (size_t n = 0; n < edges->count && !status; n++) {
        status = cast(scene, edges->shifts[n]);
    }
    return status;
}

static conus_status draw(float *rgba, struct colour_device *device, const struct colour_pass *pass,
                         const struct colour_view *view, const struct colour_edges *edges)
{
    struct colour_rays_device *own = (struct colour_rays_device *)device;
    struct scene *scene = memory_zeroed(1, sizeof *scene);
    if (!scene) {
        return CONUS_ERROR_MEMORY;
    }
    scene->device = own;
    scene->pass = pass;
    scene->has_layers = colour_pass_has_layers(pass, view);
    scene->part = 1;
    scene->width = view->width;
    scene->height = view->height;
    scene->rgba = rgba;
    scene->listener = &view->listener;
    scene->threads = threads_for((uint64_t)view->width * view->height, LEAST_PIXELS);
    colour_pass_look(pass, view);
    colour_view_pack(&scene->view, pass, view);
    memset(rgba, 0, (size_t)view->width * view->height * 4 * sizeof *rgba);
    conus_status status = own->surfaces ? find_surfaces(scene, view) : CONUS_OK;
    if (!status && view->opacity && pass->has_areas && !view->no_skipping) {
        status = own->alike.distance ? CONUS_OK : find_alike(own, &pass->objects);
        scene->alike = &own->alike;
    }
    status = status ? status : cast(scene, view->shift);
    status = status || !edges ? status : edges_smooth(rgba, view, edges, draw_tiles, scene);
    for (size_t i = 0; scene->bands && i < scene->threads; i++) {
        surface_band_finish(&scene->bands[i]);
    }
    memory_free(scene->bands);
    memory_free(scene);
    return status;
}

static const char *name(const struct colour_device *device)
{
    (void)device;
    return "rays";
}

static void destroy(struct colour_device *device)
{
    surface_rays_destroy(((struct colour_rays_device *)device)->surfaces);
    bricks_finish(&((struct colour_rays_device *)device)->alike);
    memory_free(device);
}

conus_status colour_rays_create(struct colour_device **out)
{
    static const struct colour_functions functions = {.hold = hold,
                                                      .fill = fill,
                                                      .release = release,
                                                      .prepare = prepare,
                                                      .add_meshes = add_meshes,
                                                      .paint = paint,
                                                      .draw = draw,
                                                      .name = name,
                                                      .destroy = destroy};
    struct colour_rays_device *rays = memory_zeroed(1, sizeof *rays);
    if (!rays) {
        return CONUS_ERROR_MEMORY;
    }
    rays->device.functions = &functions;
    *out = &rays->device;
    return CONUS_OK;
}
