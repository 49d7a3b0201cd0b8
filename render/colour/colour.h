/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The colour pass (Eq. 8): the atlas's areas, opaque, or its pathways, where it has any, with the areas that a
 * selection hits; areas that are meshes; around them the context volume through its transfer function; and a cone with
 * markers. One ray per pixel over view-aligned planes (Eq. 7), empty bricks skipped, up to the mesh that covers the
 * pixel. */
#ifndef CONUS_RENDER_COLOUR_COLOUR_H
#define CONUS_RENDER_COLOUR_COLOUR_H

#include "atlas/atlas.h"
#include "render/colour/emphasis.h"
#include "render/colour/field.h"
#include "render/colour/haze.h"
#include "render/colour/transfer.h"
#include "render/gl/camera.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/id/mesh_layer.h"
#include "render/id/slices.h"

enum {
    COLOUR_MARKER_LIMIT = 64,
    COLOUR_TILE = 4 /**< Pixels along the edge of the squares that colour_view.tiles is about. */
};

/** A volume as the colour pass holds it: the box of voxels around which anything is visible. */
struct colour_volume {
    GLuint field, empty;
    size_t dim[3];            /**< Voxels of the grid. */
    size_t first[3], size[3]; /**< The box: its first voxel, of which each is a brick's first, and its voxels. */
    double world_from_voxel[16];
    double texture_from_world[16]; /**< Texture coordinates: 0 to 1 over the box's cells. */
};

/** GL objects of one atlas; everything here happens in the context that was current at colour_pass_init(). */
struct colour_pass {
    GLuint program;       /**< Over one triangle on the screen. */
    GLuint layer_program; /**< The same for translucent pictures; 0 until one is drawn. */
    GLuint view, palette, opacities, vertices, transfer, objects;
    struct colour_volume areas, context, haze;
    struct haze_choice hazy;           /**< Pathways that are haze.                */
    struct mesh_layer *meshes;         /**< NULL if there are none.              */
    struct tube_colouring streamlines; /**< How they are coloured. */
    bool has_areas, has_haze;
    bool may_have_areas, may_have_context; /**< Whatever is hidden: programs leave out what they never need. */
    size_t object_count, around_count;     /**< Objects, and surfaces around them, whose numbers follow.            */
    float *colours;       /**< [1 + object_count + around_count][4] linear R, G, B, 1.                         */
    float *shown;         /**< The same for the last picture.                                                  */
    float *opacity;       /**< [1 + object_count + around_count] of the last picture.                          */
    float *around;        /**< [around_count] opacities of the surfaces around the areas.                      */
    float mapped_opacity; /**< Opacity of the surface that has a map. */
    double (*content)[3]; /**< [content_count] world points around everything visible. */
    size_t content_count;
    size_t object_points; /**< The first of them, which come from voxels. */
    uint8_t *drawn;       /**< [object_count + 1] of enum pathways_area: areas that are drawn beside pathways. */
};

struct colour_marker {
    double centre[3], radius; /**< World mm. */
    uint8_t rgb[3];           /**< sRGB.     */
};

/** The camera, and all that the picture shows besides the atlas. */
struct colour_view {
    const struct camera *camera;
    uint32_t width, height;
    uint32_t slices; /**< N of Eq. 7; 0 = default.                                       */
    bool no_skipping;
    double draft;                  /**< mm; fewer streamlines, at least so wide: see tube_layer.h. 0 = all. */
    struct gl_listener listener;   /**< Hears of pieces of streamlines, and of each time that rays are cast. */
    GLuint tiles;                  /**< Buffer of a number for each square of COLOUR_TILE pixels, row by row: what has 0
                                        is not drawn. 0 = all is drawn. */
    double shift[2];               /**< From pixel centres to rays, in pixels, right and up.                   */
    const double *world_from_cone; /**< NULL = no cone; else its apex and frame, looking down -z.      */
    double cone_slope, cone_radius; /**< Tangent of half its angle; mm about the apex, 0 unless a cylinder. */
    double cone_start, cone_length; /**< Depths along its axis between which it is drawn, mm.           */
    bool grey_cone;                 /**< In place of orange. */
    double fade;                    /**< How much the context is thinned, 0 to 1 (gone).                */
    double line_width;              /**< mm, of axis, rim and outline.                                  */
    const struct colour_marker *markers;
    size_t marker_count;     /**< Markers from COLOUR_MARKER_LIMIT on are not drawn.             */
    const uint8_t *emphasis; /**< [object_count + 1] of enum emphasis, by number; NULL = all full. */
    const uint8_t *pale_rgb; /**< [3] sRGB of what is pale, also between stripes; then edges of surfaces are dark. NULL
                                = paler than their own. */
    const uint8_t (*rgb)[3]; /**< [object_count + 1] sRGB, by number; NULL = the atlas's. */
    const uint32_t *group;   /**< [object_count + 1] whose colour of the atlas each object has; NULL = its own. */
    const float *opacity;    /**< [object_count + 1] of surfaces, 0 to 1, by number; NULL = all 1. */
};

/** The fields that a new pass of one atlas needs. */
struct colour_fields {
    struct field_task objects, context;
};

/** Begins to make the fields on threads of their own, which read the atlas until colour_fields_end(). Needs no GL.
 * CONUS_ERROR_MEMORY. */
conus_status colour_fields_start(struct colour_fields *out, const conus_atlas *atlas, const struct transfer *transfer);
void colour_fields_end(struct colour_fields *fields);

/** Takes @p hazy over on success. Waits for @p fields. */
conus_status colour_pass_init(struct colour_pass *out, const conus_atlas *atlas, const struct transfer *transfer,
                              struct haze_choice *hazy, struct colour_fields *fields, uint64_t max_memory);
void colour_pass_finish(struct colour_pass *pass);

/** Compiles the program that @p view needs; to be called before drawing. */
conus_status colour_pass_need(struct colour_pass *pass, const struct colour_view *view);

/** Updates the hidden objects. */
conus_status colour_pass_update(struct colour_pass *pass, const conus_atlas *atlas, uint64_t max_memory);

/** For an atlas with pathways: from now on draws beside them the areas that @p areas [object_count + 1] of enum
 * pathways_area names; NULL = none. */
conus_status colour_pass_include(struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *areas,
                                 uint64_t max_memory);

/** Colours streamlines by @p colouring, which is taken over on success (NULL = as before), those of @p is_pale palely
 * (tube_layer_update()). */
conus_status colour_pass_paint_streamlines(struct colour_pass *pass, const conus_atlas *atlas,
                                           struct tube_colouring *colouring, const bool *const *is_pale);

/** Changes the transfer function of the context, if there is one. */
conus_status colour_pass_set_transfer(struct colour_pass *pass, const conus_atlas *atlas,
                                      const struct transfer *transfer, uint64_t max_memory);

/** Draws the meshes of @p view into textures of the pass, which the calls below use. To be called before each of them,
 * and before the picture's framebuffer is bound. CONUS_ERROR_CANCELLED. */
conus_status colour_pass_begin(const struct colour_pass *pass, const struct colour_view *view);

/** Draws into the bound framebuffer (RGBA float, linear radiance times opacity). */
conus_status colour_pass_draw(const struct colour_pass *pass, const struct colour_view *view);

/** Prepares everything for drawing @p view, except the draw call, and binds it. */
void colour_pass_prepare(const struct colour_pass *pass, const struct colour_view *view);

enum colour_program {
    COLOUR_RAYS = 0,   /**< Over one triangle on the screen: what pictures use.                          */
    COLOUR_RAYS_PLAIN, /**< The same, with areas as single samples show them: to compare with COLOUR_SLICES. */
    COLOUR_LAYERS,     /**< Over one triangle where something is translucent.                                */
    COLOUR_SLICES      /**< Polygons on the planes, blended by the framebuffer: the paper's way. The vertex shader hands
                           on the plane's number as `layout(location = 0) flat out float`.                    */
};

/** @p pass NULL = for areas, a context and haze; else the program does not look for what its atlas never has. */
conus_status colour_program_create(GLuint *out, const struct program_shader *vertex, enum colour_program kind,
                                   const struct colour_pass *pass);

#endif
