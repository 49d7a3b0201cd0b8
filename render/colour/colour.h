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
#include "render/gl/listener.h"
#include "render/gl/texel.h"
#include "render/id/slices.h"
#include "render/id/tubes.h"

#define COLOUR_EDGE 0.05F /* By which neighbours differ at an edge: of white, linear radiance times opacity. */

enum {
    COLOUR_MARKER_LIMIT = 64,
    COLOUR_TILE = 4 /**< Pixels along the edge of the squares that are drawn again where there are edges. */
};

/** Texels that the pass's device holds: of a volume, i fastest, or of a table, which is as long as a volume of one row.
 * A zeroed one has none. */
struct colour_texels {
    enum volume_texture_kind kind;
    size_t dim[3];
    uint32_t name; /**< OpenGL: the texture. */
    void *bytes;   /**< The CPU: as volume_texture_fill() takes them. */
};

/** The transfer function in a table: linear R, G, B, and extinction per mm (transfer_table()). */
enum {
    TABLE_PER_LEVEL = 4, /**< Entries for each step between neighbouring densities. */
    COLOUR_TABLE_ENTRIES = (FIELD_LEVELS - 1) * TABLE_PER_LEVEL + 1
};

/** Which bricks of the areas show something, by the opacities of the last picture. */
struct colour_seen;

/** A volume as the colour pass holds it: the box of voxels around which anything is visible. */
struct colour_volume {
    struct colour_texels field, empty;
    struct colour_seen *seen; /**< Of areas; NULL of others. */
    size_t dim[3];            /**< Voxels of the grid. */
    size_t first[3], size[3]; /**< The box: its first voxel, of which each is a brick's first, and its voxels. */
    double world_from_voxel[16];
    double texture_from_world[16]; /**< Texture coordinates: 0 to 1 over the box's cells. */
};

/** All that is drawn of one atlas, and what draws it. */
struct colour_pass {
    struct colour_device *device; /**< The pass's own. */
    struct colour_texels objects; /**< Numbers by voxel of the areas. */
    struct colour_texels transfer;
    struct colour_volume areas, context, haze;
    struct haze_choice hazy;               /**< Pathways that are haze.                */
    struct tube_colouring streamlines;     /**< How they are coloured. */
    bool has_areas, has_haze, has_meshes;  /**< Streamlines are among the meshes. */
    bool may_have_areas, may_have_context; /**< Whatever is hidden: programs leave out what they never need. */
    size_t object_count, around_count;     /**< Objects, and surfaces around them, whose numbers follow.            */
    float *colours;       /**< [1 + object_count + around_count][4] linear R, G, B, 1.                         */
    float *shown;         /**< The same for the last picture, with the emphasis in place of 1.                 */
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
    uint32_t slices;                  /**< N of Eq. 7; 0 = default.                                       */
    bool no_skipping;                 /**< Blends every sample: the same picture, slower, to compare with. */
    double draft;                     /**< mm; fewer streamlines, at least so wide: see tube_layer.h. 0 = all. */
    struct picture_listener listener; /**< Hears of the pieces that are drawn, and of each time that rays are cast. */
    double shift[2];                  /**< From pixel centres to rays, in pixels, right and up.                   */
    const double *world_from_cone;    /**< NULL = no cone; else its apex and frame, looking down -z.      */
    double cone_slope, cone_radius;   /**< Tangent of half its angle; mm about the apex, 0 unless a cylinder. */
    double cone_start, cone_length;   /**< Depths along its axis between which it is drawn, mm.           */
    double cone_reach; /**< Depth to which its wall leaves a line on what it passes, mm; 0 = through everything. */
    double fade;       /**< How much the context is thinned, 0 to 1 (gone).                */
    double line_width; /**< mm, of axis, rim and outline.                                  */
    const struct colour_marker *markers;
    size_t marker_count;     /**< Markers from COLOUR_MARKER_LIMIT on are not drawn.             */
    const uint8_t *emphasis; /**< [object_count + 1] of enum emphasis, by number; NULL = all full. */
    const uint8_t *pale_rgb; /**< [3] sRGB of what is pale, also between stripes; then edges of surfaces are dark. NULL
                                = paler than their own. */
    const uint8_t (*rgb)[3]; /**< [object_count + 1] sRGB, by number; NULL = the atlas's. */
    const uint32_t *group;   /**< [object_count + 1] whose colour of the atlas each object has; NULL = its own. */
    const float *opacity;    /**< [object_count + 1] of surfaces, 0 to 1, by number; NULL = all 1. */
};

/** How edges are smoothed: squares of COLOUR_TILE pixels in which neighbours differ (edges.h) are drawn again. */
struct colour_edges {
    const double (*shifts)[2]; /**< [count] Rays of each pixel, from its centre, in pixels, right and up. */
    size_t count;
    bool is_corner; /**< One ray, through the lower left corner, which counts for the pixels around it: a pixel is half
                       its own ray, half those of its corners. Else it is the mean of all. */
};

/** What holds texels and draws: OpenGL or the CPU. */
struct colour_device;

struct colour_functions {
    /** Makes what is called below work on this thread until leave(); NULL = it always does. */
    conus_status (*enter)(struct colour_device *device);
    void (*leave)(struct colour_device *device);

    /** Holds texels of kind and dim; @p texels NULL = fill() will bring them. Takes their size off @p memory_left.
     * CONUS_ERROR_MEMORY above that. */
    conus_status (*hold)(struct colour_texels *out, struct colour_device *device, enum volume_texture_kind kind,
                         const size_t dim[3], const void *texels, uint64_t *memory_left);
    /** @p count slices from @p first on. */
    void (*fill)(struct colour_texels *texels, size_t first, size_t count, const void *from);
    void (*release)(struct colour_texels *texels);
    /** An error of what was done before, naming @p what; NULL = there is none. */
    conus_status (*check)(const char *what);

    /** Makes what the pass needs, which knows what the atlas may have. */
    conus_status (*prepare)(struct colour_device *device, const struct colour_pass *pass);
    /** Adds the meshes and streamlines of the atlas, which has some. */
    conus_status (*add_meshes)(struct colour_device *device, const conus_atlas *atlas, uint64_t *memory_left);
    /** Updates what is hidden of them, and colours streamlines, if there are any (tubes_paint()). */
    conus_status (*paint)(struct colour_device *device, const conus_atlas *atlas,
                          const struct tube_colouring *colouring, const bool *const *is_pale);

    /** Draws: width * height pixels of linear R, G, B times A, and A, bottom row first; 0 where nothing is drawn. One
     * ray a pixel, and @p edges, unless it is NULL. */
    conus_status (*draw)(float *rgba, struct colour_device *device, const struct colour_pass *pass,
                         const struct colour_view *view, const struct colour_edges *edges);
    const char *(*name)(const struct colour_device *device);
    void (*destroy)(struct colour_device *device);
};

/** First member of every device. */
struct colour_device {
    const struct colour_functions *functions;
};

/* The devices that there are: colour_gl.c, with a context of its own (CONUS_ERROR_GL without an OpenGL 4.5 driver), and
 * colour_rays.c, which draws by rays on all processors: the pictures look the same. They have the same bytes on every
 * processor and system, by any number of threads. */
conus_status colour_gl_create(struct colour_device **out, conus_log log, void *log_user);
conus_status colour_rays_create(struct colour_device **out);

/** The fields that a new pass of one atlas needs. */
struct colour_fields {
    struct field_task objects, context;
};

/** Begins to make the fields on threads of their own, which read the atlas until colour_fields_end(). Needs no GL.
 * The transfer function is not relative. */
void colour_fields_start(struct colour_fields *out, const conus_atlas *atlas, const struct transfer *transfer);
void colour_fields_end(struct colour_fields *fields);

/** Takes @p device, which is entered, and @p hazy over on success. Waits for @p fields. */
conus_status colour_pass_init(struct colour_pass *out, struct colour_device *device, const conus_atlas *atlas,
                              const struct transfer *transfer, struct haze_choice *hazy, struct colour_fields *fields,
                              uint64_t max_memory);
/** The device, which goes, too, is entered by this. */
void colour_pass_finish(struct colour_pass *pass);

/** For the calls below. */
static inline conus_status colour_pass_enter(const struct colour_pass *pass)
{
    const struct colour_functions *functions = pass->device->functions;
    return functions->enter ? functions->enter(pass->device) : CONUS_OK;
}

static inline void colour_pass_leave(const struct colour_pass *pass)
{
    if (pass->device->functions->leave) {
        pass->device->functions->leave(pass->device);
    }
}

/** Updates the hidden objects. */
conus_status colour_pass_update(struct colour_pass *pass, const conus_atlas *atlas, uint64_t max_memory);

/** For an atlas with pathways: from now on draws beside them the areas that @p areas [object_count + 1] of enum
 * pathways_area names; NULL = none. */
conus_status colour_pass_include(struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *areas,
                                 uint64_t max_memory);

/** Colours streamlines by @p colouring, which is taken over on success (NULL = as before), those of @p is_pale palely
 * (tubes_paint()). */
conus_status colour_pass_paint_streamlines(struct colour_pass *pass, const conus_atlas *atlas,
                                           struct tube_colouring *colouring, const bool *const *is_pale);

/** Changes the transfer function of the context, if there is one. */
conus_status colour_pass_set_transfer(struct colour_pass *pass, const conus_atlas *atlas,
                                      const struct transfer *transfer, uint64_t max_memory);

/** Whether something is translucent in the picture, or might be. */
bool colour_pass_has_layers(const struct colour_pass *pass, const struct colour_view *view);

/** Sets the colours and opacities by object number that the view asks for: pass->shown and pass->opacity. */
void colour_pass_look(const struct colour_pass *pass, const struct colour_view *view);

#endif
