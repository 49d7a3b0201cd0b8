/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The ID passes: which object each ray or pixel hits first. All need a current context throughout. */
#ifndef CONUS_RENDER_PASSES_ID_PASS_H
#define CONUS_RENDER_PASSES_ID_PASS_H

#include "atlas/atlas.h"
#include "atlas/surface/mesh.h"
#include "atlas/volume.h"
#include "base/status.h"
#include "conus/selection.h"
#include "render/gl/camera.h"
#include "render/gl/gl.h"
#include "render/passes/shapes.h"

/* The ID pass: which object each of many rays hits first. The rays are those of the pixels of as many cones as one
 * likes, so a block of cones is one draw per volume and one wait. Needs a current context throughout. One trace
 * is: id_pass_begin(); for each volume fill id_pass_rays() and id_pass_trace(); id_pass_read(). For all layers:
 * id_pass_begin(); for each volume fill id_pass_rays() and id_pass_pierce(). */

struct id_pass;

/** A ray in a volume's index space, per mm; with exact sampling, on an axis along which it does not move, origin is the
 * centre of its cell, direction 0 and inverse infinity. Neighbours should be neighbours in the list: they are walked in
 * step. */
struct id_ray {
    double origin[3], direction[3];
    union {
        double inverse[3]; /**< Exact sampling.                                     */
        struct {
            double start, spacing, count; /**< Its cone's struct slices.              */
            double per_depth;             /**< 1 / cosine to the view axis: mm along the ray per mm of depth. */
        } planes;                         /**< CONUS_SAMPLING_SLICES.                                      */
    };
};

/** The first hit of a ray. */
struct id_hit {
    double distance;     /**< mm along the ray, exact; INFINITY = nothing.    */
    uint32_t identifier; /**< 0 = nothing.                                    */
    uint32_t cell[3];    /**< Indices of the voxel.                           */
};

/** An interval of a ray: a run of cells with one identifier (Eq. 10). */
struct id_interval {
    uint32_t ray, identifier;
    double entry, exit; /**< mm along the ray, exact.          */
    uint32_t cell[3];   /**< Indices of its first voxel.       */
};

/** @p identifiers[k] is the caller's number of object k; the last one is that of VOLUME_BLOCKER. 0 makes an object
 * invisible. */
conus_status id_pass_create(struct id_pass **out, conus_sampling sampling, const uint32_t *identifiers,
                            size_t identifier_count);
/** NULL is fine. */
void id_pass_destroy(struct id_pass *pass);

/** How far around each voxel a volume is empty. */
struct id_distances {
    const uint8_t *codes; /**< [voxels] 0 where the voxel holds an object; else 1 + r, where no voxel that differs from
                             it by at most r in every index does.                                        */
    int box[2][3];        /**< The first and the last voxel with objects; last below first where there are none. */
};

/** Uploads the objects of @p volume, which is number 0, 1, ... by the order of these calls; takes the textures' size
 * off @p memory_left. */
conus_status id_pass_add_volume(struct id_pass *pass, const struct volume *volume, const struct id_distances *distances,
                                uint64_t *memory_left);

/** Reserves memory for @p rays rays, at least 1. */
conus_status id_pass_begin(struct id_pass *pass, uint32_t rays);

/** The rays, to be filled in before each volume; NULL = no memory. */
struct id_ray *id_pass_rays(struct id_pass *pass);

/** Traces the rays through volume number @p volume: its cells (Eq. 5) or, with CONUS_SAMPLING_SLICES, the rays' planes
 * (Eq. 7). Nearer hits found before stay; of equally near objects the lower identifier wins. */
conus_status id_pass_trace(struct id_pass *pass, size_t volume);

/** The first hit of each ray, after at least one id_pass_trace(); borrowed until the next id_pass_begin(). */
conus_status id_pass_read(struct id_pass *pass, const struct id_hit **out);

/** Receives @p count intervals in any order, but those of one ray in the order along it. */
typedef conus_status (*id_pass_take)(void *user, const struct id_interval *intervals, uint32_t count);

/** Hands to @p take, in portions, all intervals of the rays in volume number @p volume, whatever hides them. Not for
 * CONUS_SAMPLING_SLICES. */
conus_status id_pass_pierce(struct id_pass *pass, size_t volume, id_pass_take take, void *user);

/* Meshes cut into clusters of neighbouring triangles, so that one test can leave out what a view cannot show. They
 * are laid out for drawing without a draw call, an attribute or a query per triangle: a triangle's last corner is a
 * vertex of its own, whose number is the triangle's. */

/** So many triangles of one mesh are a cluster, at most; so many clusters in a row, from whichever meshes, are a group,
 * and so many a range. */
enum { CLUSTER_TRIANGLES = 16, CLUSTER_GROUP = 8, CLUSTER_RANGE = 256 };

/** At most CLUSTER_TRIANGLES neighbours of one mesh. */
struct cluster {
    uint32_t first, count; /**< Triangles in drawing order. */
    uint32_t object;
};

struct clusters {
    size_t cluster_count;
    struct cluster *cluster; /**< [cluster_count] sorted by `first`.                                          */
    size_t group_count;
    float *balls; /**< [cluster_count + group_count][4] centre and radius, mm, of a ball around each cluster and each
                       group. */
    size_t range_count;
    float *range_balls; /**< [range_count][4] likewise; stays.                                                */
    size_t triangle_count;
    uint32_t *triangle; /**< [triangle_count] number in its mesh, by drawing order.                           */
    size_t vertex_count;
    float *positions;  /**< [vertex_count][3]; NULL once dropped.                                             */
    uint32_t *corners; /**< [triangle_count][3] vertices; the last one's number is the triangle's; likewise.  */
};

/** Object number k is meshes[k - 1]; NULL = it is no mesh. Neighbouring meshes come in a row. */
conus_status clusters_init(struct clusters *out, const struct mesh *const *meshes, size_t count);
void clusters_finish(struct clusters *clusters);

/** Frees positions and corners once a driver has a copy. */
void clusters_drop_triangles(struct clusters *clusters);

/** The cluster of the triangle that is drawn as number @p triangle. */
const struct cluster *clusters_find(const struct clusters *clusters, uint32_t triangle);

/* The mesh ID pass (Eq. 9): which triangle each pixel of n x n buffers hits first. Needs a current context throughout.
 *
 * The device leaves out the clusters of triangles that a view cannot show, and draws the others, which the CPU never
 * sees. The driver proposes the triangles that cover a pixel's centre and are the nearest within rounding, and
 * mesh_distance() settles in double precision which of them is: nearest first; of equally near ones that of the lower
 * object, then the lower triangle.
 *
 * Many queries are read back at once. What a query draws, and where on the driver's grid, does not depend on its
 * neighbours. */

struct mesh_pass;

/** Where the buffer looks from (Eq. 1, Eq. 3): either slope or radius is 0. */
struct mesh_view {
    const double *world_from_device; /**< [16] rigid; looks down its -z.                          */
    double slope;                    /**< Tangent of half the opening angle.                      */
    double radius;                   /**< A cylinder's parallel rays: half the buffer's edge, mm. */
    uint32_t resolution;             /**< n                                                       */
};

/** A pixel's ray in the world; direction is a unit vector. */
struct mesh_ray {
    double origin[3], direction[3];
};

/** The first hit of each pixel's ray so far; bottom row first, [n n] each. */
struct mesh_pixels {
    const struct mesh_ray *rays; /**< Those of the view's pixels.      */
    uint32_t *objects;           /**< In and out: 0 = none.            */
    double *distances;           /**< In and out: mm; INFINITY = none. */
    uint64_t *triangles;         /**< Out, where a mesh is hit first.  */
};

/** One view, and the pixels to fill. */
struct mesh_query {
    struct mesh_view view;
    struct mesh_pixels pixels;
};

/** A triangle that covers a pixel's centre. */
struct mesh_pass_hit {
    uint32_t pixel, object;
    uint32_t triangle; /**< In the object's mesh. */
};

/** Takes hits in any order. */
typedef conus_status (*mesh_pass_take)(void *user, const struct mesh_pass_hit *hit);

/** Uploads meshes, which must outlive the pass; object number k is meshes[k - 1], NULL = it is none. Takes their size
 * on the device off @p memory_left. */
conus_status mesh_pass_create(struct mesh_pass **out, const struct mesh *const *meshes, size_t count,
                              uint64_t *memory_left);
/** NULL is fine. */
void mesh_pass_destroy(struct mesh_pass *pass);

/** Draws the meshes for @p count queries, all of one resolution. A pixel takes a mesh's hit if it is nearer than the
 * hit that it has. */
conus_status mesh_pass_render(struct mesh_pass *pass, const struct mesh_query *queries, size_t count);

/** Hands to @p take every triangle that covers a pixel's centre, whatever hides it (Eq. 10); in the view of a cylinder
 * those behind the device, too. The hits are not exact yet: mesh_distance() decides where a ray hits a triangle. */
conus_status mesh_pass_pierce(struct mesh_pass *pass, const struct mesh_view *view, mesh_pass_take take, void *user);

/* The streamlines of an atlas as a camera sees them: tubes (shapes.h), found pixel by pixel in closed form (Eq. 18).
 * Needs a current context. */

struct tube_layer;

/** Uploads the streamlines of @p atlas, which has some, and takes their size off @p memory_left. */
conus_status tube_layer_create(struct tube_layer **out, const conus_atlas *atlas, uint64_t *memory_left);
/** NULL is fine. */
void tube_layer_destroy(struct tube_layer *layer);

/** Updates the hidden bundles, and colours the streamlines (tubes_paint()). */
conus_status tube_layer_update(struct tube_layer *layer, const struct tube_colouring *colouring,
                               const bool *const *is_pale);

struct tube_layer_view {
    const double *eye;               /**< World mm. */
    const double *camera_from_world; /**< [9] As in mesh.vert.glsl, by rows. */
    float shift[2];                  /**< In halves of the picture. */
    uint32_t width, height;
    double draft; /**< mm; draws a draft, in which no tube is thinner. 0 = draws all as they are. */
    struct picture_listener listener;
};

/** Draws into the bound framebuffer as mesh.frag.glsl does, behind what is there; depths are reversed.
 * CONUS_ERROR_CANCELLED. */
conus_status tube_layer_draw(const struct tube_layer *layer, const struct tube_layer_view *view);

/* The meshes and streamlines of an atlas as a camera sees them: which object covers a pixel, its depth and its
 * normal. The colour pass shades them and ends its rays there. Needs a current context throughout. */

struct mesh_layer;

/** Uploads the meshes and streamlines of @p atlas and the surfaces around its areas, whose numbers follow those of the
 * objects; there must be some. Takes their size off @p memory_left. */
conus_status mesh_layer_create(struct mesh_layer **out, const conus_atlas *atlas, uint64_t *memory_left);
/** NULL is fine. */
void mesh_layer_destroy(struct mesh_layer *layer);

/** Updates the hidden meshes and bundles, and colours the streamlines: see tube_layer_update(). */
conus_status mesh_layer_update(struct mesh_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale);

/** Draws into textures of its own; its framebuffer stays bound. CONUS_ERROR_CANCELLED if the listener ends it. */
conus_status mesh_layer_draw(struct mesh_layer *layer, const struct mesh_layer_view *view);

/** Layers of translucent meshes: for each pixel the nearest surface of each object, nearer ones first. */
struct mesh_layer_peels {
    GLuint surface, object; /**< Array textures, like the two below; 0 where there never was a layer. */
    size_t count;           /**< Layers of the last picture, up to MESH_LAYER_PEELS. */
};
struct mesh_layer_peels mesh_layer_peels(const struct mesh_layer *layer);

/** Opaque surfaces, RGBA32F: the normal on the side that is seen, in world axes, and the depth along the view axis in
 * mm; 0 = nothing.
 */
GLuint mesh_layer_surface(const struct mesh_layer *layer);
/** R32UI: the object's number; for a streamline tube_colour(), and for a surface's map such a colour, too. */
GLuint mesh_layer_object(const struct mesh_layer *layer);

#endif
