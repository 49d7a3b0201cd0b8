/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What passes and pictures draw of an atlas, without OpenGL: planes of volumes, tubes, meshes, and the rays
 * that meet them. */
#ifndef CONUS_RENDER_PASSES_SHAPES_H
#define CONUS_RENDER_PASSES_SHAPES_H

#include "atlas/atlas.h"
#include "base/status.h"
#include "render/gl/camera.h"

#include <stdint.h>

/* The planes on which a volume is sampled (Eq. 7): perpendicular to the view axis, evenly over the volume's depth
 * range. The depth of a point is its distance from the eye along the view axis. One home for the numbers, so that
 * every pass and engine samples at the same places. */

/** The part of a picture's planes that an ID pass takes when nobody says otherwise: the paper's. */
#define SLICES_FRACTION 0.2

struct slices {
    double start;   /**< Depth in mm at which the volume begins in front of the eye.  */
    double spacing; /**< mm between planes.                                           */
    uint32_t count; /**< 0 when the volume lies behind the eye.                       */
};

/** N when nobody says otherwise: floor(sqrt(2) max(dim)), the 362 of 256^3 (Eq. 7). */
uint32_t slices_default(const size_t dim[3]);

/** Planes of an ID pass, where a colour pass has @p slices (0 = the default): @p fraction of them, in (0, 1], 0 = a
 * fifth; rounded down, at least 1 (Eq. 7). */
uint32_t slices_of_id_pass(uint32_t slices, double fraction, const size_t dim[3]);

/** @p count planes through the cells of a grid of @p dim, seen from @p eye along the unit vector @p axis. */
struct slices slices_over(const size_t dim[3], const double world_from_voxel[16], const double eye[3],
                          const double axis[3], uint32_t count);

/** Depth of plane @p k, from 0 (Eq. 7). A ray with unit direction d hits it at depth * (1 / (d . axis)) mm. */
static inline double slices_depth(const struct slices *slices, uint32_t k)
{
    return slices->start + (k + 0.5) * slices->spacing;
}

/* The streamlines of an atlas as pictures show them: tubes around their segments, straight neighbours as one. Of
 * more than TUBE_POINT_LIMIT points every k-th streamline is drawn; a draft draws about TUBE_DRAFT_LIMIT points, of
 * streamlines from everywhere. Needs no GL. */

enum tube_colour_by {
    TUBE_BY_BUNDLE = 0, /**< The colour of the first of its objects that is shown. */
    TUBE_BY_DIRECTION,  /**< Red from left to right, green from back to front, blue upwards. */
    TUBE_BY_SCALAR      /**< A number of its points or of itself. */
};

struct tube_colouring {
    enum tube_colour_by by;
    char *scalar;     /**< Its name; owned. NULL unless TUBE_BY_SCALAR. */
    double low, high; /**< Values at the ends of the colours. */
};

/* A tube in a mesh layer's texture of objects: the object's number, or TUBE_OWN_COLOUR and sRGB in the lowest
 * three bytes, red first. */
#define TUBE_OWN_COLOUR 0x80000000U
#define TUBE_PALE 0x40000000U /**< Drawn pale, whatever its object. */
#define TUBE_BALL 0x20000000U /**< Until it is drawn: a streamline of one point. */

/** Reads @p name: NULL or "bundle", "direction", or the name of a number that a tractogram of @p atlas has for its
 * points or streamlines, one each. CONUS_ERROR_ARGUMENT, with the names that there are, and for any name where there
 * are no streamlines. */
conus_status tube_colouring_choose(struct tube_colouring *out, const conus_atlas *atlas, const char *name);
void tube_colouring_finish(struct tube_colouring *colouring);

enum {
    TUBE_RAMP_STEPS = 4, /**< Between the colours of a number; between two of them they are mixed in sRGB. */
    TUBE_UNKNOWN = 128   /**< Grey for points without a number or direction: red, green and blue. */
};

/** sRGB of @p part, 0 to 1, of the range of a number; grey where it is NaN. */
void tube_scalar_colour(uint8_t rgb[3], double part);
/** sRGB, 0 to 1, at each step of it. */
void tube_ramp(float rgb[TUBE_RAMP_STEPS + 1][3]);

/** The same of a direction, of any length; its sign does not count. Grey where its length is 0. */
void tube_direction_colour(uint8_t rgb[3], const double direction[3]);

enum { TUBE_POINT_LIMIT = 1000000, TUBE_DRAFT_LIMIT = 20000 };

/** The tubes of a tractogram: one from each point that is kept to the next, those of a draft first. */
struct tube_range {
    size_t first, count, draft;
    float radius;
};

/** The tubes of an atlas. */
struct tubes {
    const conus_atlas *atlas;
    struct tube_range *ranges; /**< [range_count] of its tractograms. */
    size_t range_count;
    size_t step;    /**< Every step-th streamline is drawn. */
    uint64_t *kept; /**< [point_count] Points that are drawn, of one tractogram after the other. */
    size_t point_count;
};

/** Chooses the points of @p atlas, which has streamlines. Takes what they need in a picture off @p memory_left.
 * CONUS_ERROR_MEMORY. */
conus_status tubes_init(struct tubes *out, const conus_atlas *atlas, uint64_t *memory_left);
void tubes_finish(struct tubes *tubes);

/** World mm, [point_count + 1]: the last one stands twice, since each tube also needs the point behind its own. */
void tubes_points(float (*points)[3], const struct tubes *tubes);

/** What is drawn from each point to the next, [point_count], all 0 before: tube_colour(), with TUBE_BALL and TUBE_PALE;
 * 0 = nothing, for hidden bundles, too. Pale are those with @p is_pale [tractogram_count][streamline_count] set; NULL,
 * or NULL for a tractogram: none is. CONUS_ERROR_MEMORY. */
conus_status tubes_paint(uint32_t *paints, const struct tubes *tubes, const struct tube_colouring *colouring,
                         const bool *const *is_pale);

/* The meshes of an atlas and the surfaces around its areas, whose numbers follow those of the objects, as pictures
 * draw them: in one list of corners and one of triangles. Needs no GL. */

struct mesh_vertex {
    float position[3], normal[3]; /**< World mm; the sum of its triangles' normals, each as long as twice its area. */
    uint32_t object;
};

/** The triangles of an object or surface. */
struct mesh_entry {
    size_t first, count; /**< Indices; 0 where it is no mesh. */
    bool is_shown;       /**< It is there, and not hidden. */
};

struct mesh_list {
    struct mesh_vertex *vertices; /**< [vertex_count] */
    size_t vertex_count;
    uint32_t *indices; /**< [index_count] Three a triangle. */
    size_t index_count;
    struct mesh_entry *parts; /**< [part_count] Part i is that of number i + 1. */
    size_t part_count;
    float (
        *values)[2]; /**< [vertex_count] Of a map: the part of its range, and 1; 0 and 0 without one. NULL = no map. */
    uint32_t mapped; /**< Number of the surface that has a map; 0 = none. */
};

/** Takes the size of the lists off @p memory_left. CONUS_ERROR_MEMORY above that. */
conus_status mesh_list_init(struct mesh_list *out, const conus_atlas *atlas, uint64_t *memory_left);
/** Frees the lists of vertices and triangles, and leaves the parts. */
void mesh_list_drop(struct mesh_list *parts);
void mesh_list_finish(struct mesh_list *parts);

/** Updates the hidden meshes. */
void mesh_list_show(struct mesh_list *parts, const conus_atlas *atlas);

/** Whether a picture shows the part, with others that are translucent or with those that are not. @p opacity is by
 * number; NULL = all 1. */
bool mesh_list_draws(const struct mesh_list *parts, size_t part, const float *opacity, bool translucent);

enum { MESH_LAYER_PEELS = 8 }; /* Layers of translucent meshes at a pixel, at most. */

/** A picture of meshes and streamlines. */
struct mesh_layer_view {
    const struct camera *camera;
    uint32_t width, height;
    double shift[2];                  /**< From pixel centres to rays, in pixels, right and up. */
    const float *opacity;             /**< By mesh, from 0 on; NULL = all 1. A mesh of opacity 0 is not drawn. */
    double draft;                     /**< mm; fewer streamlines, at least so wide: see id_pass.h. 0 = all. */
    struct picture_listener listener; /**< Called for pieces of streamlines. */
};

/** What takes a place relative to the eye to the picture: right and up in halves of it, times the depth; the depth. */
void mesh_camera_rows(double rows[9], const struct camera *camera);

/** The inverse, by columns: from (x, y, 1) in the picture to the place of its ray at depth 1. */
void mesh_camera_columns(double columns[9], const double rows[9]);

/* Smooth borders between areas of one surface, for pictures only: engines have the triangles as they are. */

/** Areas that a surface was cut into (mesh.h) share corners, but no triangle, so that their border has teeth.
 * Here each corner of a border belongs to the area of most triangles round it, to the lower number of two; a triangle
 * whose corners are of two areas is cut along the middles of its edges, one of three areas at its centre, too. One with
 * no corner of its own area stays its own. So a border moves by at most half a triangle. Corners at one place have one
 * normal. Surfaces that are closed, and all where two triangles pass an edge the same way, stay as they are. Takes the
 * memory of the pieces off @p memory_left. */
conus_status mesh_borders_smooth(struct mesh_list *parts, const conus_atlas *atlas, uint64_t *memory_left);

/* The meshes and streamlines of an atlas as the rays of a picture meet them, on the CPU: what id_pass.h draws
 * with OpenGL. Triangles and tubes are dealt to bands of rows; each band can be filled on a thread of its own. */

enum { SURFACE_BAND = 8 /**< Rows of a band. */ };

/** A surface that a ray meets. */
struct surface_hit {
    float normal[3]; /**< On the side that is seen, world axes. */
    float depth;     /**< Along the view axis, mm; 0 = nothing. */
    uint32_t object; /**< Its number; for a streamline tube_colour(), and for a surface's map such a colour, too. */
};

/** The surfaces at the pixels of a band, row by row. */
struct surface_band {
    struct surface_hit *solid;  /**< [SURFACE_BAND * width] Opaque: the nearest one. */
    struct surface_hit *layers; /**< [SURFACE_BAND * width][layer_count] Translucent: of each object the nearest one,
                                   nearer ones first; those of depth 0 end the list early. */
    size_t layer_count;
};

struct surface_rays;

/** As mesh_layer_create(), mesh_layer_update() and mesh_layer_destroy(). */
conus_status surface_rays_create(struct surface_rays **out, const conus_atlas *atlas, uint64_t *memory_left);
conus_status surface_rays_update(struct surface_rays *rays, const conus_atlas *atlas,
                                 const struct tube_colouring *colouring, const bool *const *is_pale);
void surface_rays_destroy(struct surface_rays *rays);

/** Deals triangles and tubes to the bands of a picture, whatever the shift of @p view, which surface_rays_fill() reads.
 * What it points to must stay. CONUS_ERROR_MEMORY. */
conus_status surface_rays_begin(struct surface_rays *rays, const struct mesh_layer_view *view);

/** Memory for a band of the picture that was begun; surface_band_finish() frees it in any case. */
conus_status surface_band_init(struct surface_band *out, const struct surface_rays *rays);
void surface_band_finish(struct surface_band *band);

/** Finds the surfaces of band @p number, by rays @p shift pixels right and up from the pixels' centres. */
void surface_rays_fill(struct surface_band *out, const struct surface_rays *rays, size_t number, const double shift[2]);

#endif
