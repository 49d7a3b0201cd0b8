/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The colour pass and what it draws: transfer functions, fields of volumes, haze, pathways, emphasis; and its
 * renderer. */
#ifndef CONUS_RENDER_COLOUR_COLOUR_H
#define CONUS_RENDER_COLOUR_COLOUR_H

#include "atlas/atlas.h"
#include "atlas/volume.h"
#include "conus/picture.h"
#include "render/gl/camera.h"
#include "render/passes/shapes.h"

#include <math.h>
#include <pthread.h>

/* How an object stands out in a picture with a cone. */

enum emphasis {
    EMPHASIS_PALE = 0, /**< Not in the cone.                               */
    EMPHASIS_FULL,     /**< A pixel hits it first.                         */
    EMPHASIS_HATCHED,  /**< In the cone, but occluded: stripes of its colour. */
    EMPHASIS_GLASS,    /**< A surface around the areas: with a dark outline. */
};

/* Colour and opacity of a grey value: piecewise linear between points (Eq. 8), from a preset or a small text file
 * (docs/formats.md, "Transfer functions"). */

enum { TRANSFER_POINT_LIMIT = 4096 };

struct transfer {
    conus_transfer_point *points; /**< [count], at least 1; values never fall. Two equal values are a step. Values are
                                       fractions of the volume's window where the function is relative. */
    size_t count;
    bool relative; /**< Values are fractions of the volume's window: 0 its low, 1 its high end. */
};

/** Parses the text of a transfer function. @p out is the caller's to finish. */
conus_status transfer_parse(struct transfer *out, const uint8_t *data, size_t size);

/** The preset called @p name, else the file of that path. @p out is the caller's to finish. */
conus_status transfer_load(struct transfer *out, const char *name);

/** Copies points of grey values; CONUS_ERROR_ARGUMENT unless they are 1 to TRANSFER_POINT_LIMIT, with values that never
 * fall, and colours and opacities in 0..1. */
conus_status transfer_copy(struct transfer *out, const conus_transfer_point *points, size_t count);

void transfer_finish(struct transfer *transfer);

/** sRGB and opacity at @p value, clamped at both ends (Eq. 8). */
void transfer_at(double rgba[4], const struct transfer *transfer, double value);

/** Extinction per mm of an opacity per mm (Eq. 8); 1 is taken as 1 - 2^-24. */
static inline double transfer_extinction(double opacity)
{
    return -log2(1 - fmin(opacity, 1 - 0x1p-24));
}

/** The grey values that span @p volume's contrast: from its minimum to the 99.5th percentile of the values above it, so
 * that a few bright voxels do not darken the rest. high > low, always. */
conus_status transfer_window(double *low, double *high, const struct volume *volume);

/** The values over which @p transfer changes: from its first to its last point. high > low, always. */
void transfer_span(double *low, double *high, const struct transfer *transfer);

/** Fills @p count entries, evenly spaced over the span from first to last point, with linear R, G, B and the
 * extinction per mm. */
void transfer_table(float *rgbe, size_t count, const struct transfer *transfer);

/* The field of a volume, which the colour pass samples: for each voxel a density and its gradient, four bytes in the
 * layout of the texture; for each brick of 4^3 voxels the range of densities, which gives the empty space around a
 * ray. A field covers the box of voxels around which anything is visible. */

enum { BRICKS_EDGE = 4 };

struct bricks {
    size_t dim[3];     /**< Bricks along i, j, k; the last may reach beyond the grid.                    */
    uint8_t *distance; /**< [dim[0] dim[1] dim[2]], i fastest. 0 = occupied; d = all bricks within d - 1 in every index
                            are empty (at most 255). */
};

void bricks_finish(struct bricks *bricks);

/** Sets the distances. Before the call occupied bricks are 0 and all others 255. */
void bricks_spread(struct bricks *bricks);

enum {
    FIELD_LEVELS = 256,  /**< Densities are bytes.                         */
    FIELD_SURFACE = 128, /**< Labels: the density at which an area begins. */
};

struct field {
    size_t first[3], dim[3]; /**< The box: from which voxel of the volume on, that of a brick, and how many voxels. */
    uint8_t *density;        /**< [voxels] */
    uint8_t *slopes;         /**< [voxels] whose gradients are taken; NULL = the density. */
    double voxel_from_world[16];
    size_t brick_dim[3];
    uint8_t *low, *high; /**< [bricks] range of the densities that a trilinear sample in the brick, or up to one voxel
                              outside it, can take. */
};

/** Density change per mm, of the whole range, at which the stored gradient has half its full length. */
#define FIELD_SOFTNESS 0.03

/** How grey values become densities. */
struct field_scale {
    double low, high; /**< Values that become densities 0 and 255; others are clamped. */
    int unseen;       /**< Densities up to this one, and samples between them, are invisible; -1 = all may be visible.
                       */
};

/** Grey values; central differences. @p out is the caller's to finish in any case, as below. */
conus_status field_of_values(struct field *out, const struct volume *volume, const struct field_scale *scale);

/** Voxels of any object: their blurred occupancy (binomial, sigma 1 voxel), held above FIELD_SURFACE in voxels of
 * objects and below it in others, so that the surface is smooth and yet no voxel changes sides; what is one voxel thick
 * stays so. Gradients are of what is blurred and held again and again, so that terraces become slopes, and then blurred
 * twice. */
conus_status field_of_objects(struct field *out, const struct volume *volume);

void field_finish(struct field *field);

/** The texels of @p count slices from @p first on: @p out gets [count * voxels of a slice][4], the gradient in world
 * axes (128 = 0) as g / (|g| + FIELD_SOFTNESS), and the density. */
void field_texels(uint8_t *out, const struct field *field, size_t first, size_t count);

/** Bricks and their distances to the next one with a density that @p visible names. It has @p per_level entries for
 * each step between densities and one for the last: entry i is density i / per_level. @p out is the caller's to finish
 * in any case. */
conus_status field_bricks(struct bricks *out, const struct field *field, const bool *visible, size_t per_level);

/** Some slices of texels (field_texels()). */
struct field_slab {
    const uint8_t *texels;
    size_t first, count; /**< Slices. */
};

/** A field under way. A zeroed one is empty. */
struct field_task {
    const struct volume *volume; /**< NULL = of nothing. */
    bool is_values;              /**< The field holds grey values, by `scale`; else objects. */
    struct field_scale scale;
    size_t taken; /**< Slabs taken so far; only the caller's thread uses it. */
    bool has_thread;
    pthread_t thread;
    pthread_mutex_t lock;   /**< If there is a thread: guards the members below. */
    pthread_cond_t changed; /**< Signalled with each change of one. */
    bool is_made, stop;
    conus_status status;
    struct field field;
    uint8_t *texels;        /**< Those of some slabs. */
    size_t ready, released; /**< Slabs that have been made, and those of them that may be overwritten. */
};

/** Begins to make the field of @p task, whose volume is read until field_task_end(). */
void field_task_start(struct field_task *task);

/** Waits for the field, which stays the task's. Makes it here if no thread was begun. CONUS_ERROR_MEMORY. */
conus_status field_task_wait(const struct field **out, struct field_task *task);

/** After field_task_wait(): the next slices, from the first on. They stay valid until the next call. False after the
 * last. */
bool field_task_next(struct field_slab *out, struct field_task *task);

/** Cancels what is under way and frees it. */
void field_task_end(struct field_task *task);

/* Pathways that are drawn as haze, by colours and opacities of their values (Eq. 8). */

/** The pathways that are haze, with their transfer functions. */
struct haze_choice {
    struct transfer *transfers; /**< [object_count + 1] in values of the pathway's map; without points: no haze. */
    size_t object_count;
};

/** Haze on a grid: extinction adds up where pathways overlap. */
struct haze_field {
    conus_volume_info info;
    float *texels; /**< [voxels][4] linear R, G, B times the extinction, and the extinction per mm. */
};

/** Reads the choice from @p options. Relative functions span from a pathway's threshold to its largest value.
 * CONUS_ERROR_ARGUMENT for a number that is no pathway. Call haze_choice_finish() in any case. */
conus_status haze_choose(struct haze_choice *out, const conus_atlas *atlas, const conus_renderer_options *options);
void haze_choice_finish(struct haze_choice *choice);

/** Whether the object is haze. */
static inline bool haze_is(const struct haze_choice *choice, size_t number)
{
    return choice && choice->transfers && choice->transfers[number].count > 0;
}

/** The colour, sRGB, and opacity of a pathway that is haze at a place, between voxel centres trilinearly. */
void haze_colour_at(double rgba[4], const conus_atlas *atlas, const struct haze_choice *choice, uint32_t number,
                    const double world[3]);

/** The field of all chosen pathways that are not hidden, on the grid of the first, with a margin of one voxel without
 * haze. No texels if there are none. @p max_memory limits the texels. Call haze_field_finish() in any case. */
conus_status haze_fill(struct haze_field *out, const conus_atlas *atlas, const struct haze_choice *choice,
                       uint64_t max_memory);
void haze_field_finish(struct haze_field *field);

/* The objects that pictures show of an atlas with pathways or areas of probabilities (Eq. 8): these, and some areas
 * of the parcellation, on one grid. */

/** How an area is drawn beside pathways. */
enum pathways_area {
    PATHWAYS_AREA_LEFT_OUT = 0,
    PATHWAYS_AREA_OVER, /**< Replaces pathways in the same voxels. */
    PATHWAYS_AREA_UNDER /**< Pathways replace it in the same voxels; it is translucent. */
};

/** The first volume of values that is not hidden, of a pathway or an area; NULL if there is none. */
const struct volume *pathways_first(const conus_atlas *atlas);

/** Whether there is a pathway or bundle that is not hidden: opaque areas would occlude it. */
bool pathways_shown(const conus_atlas *atlas);

/** Makes a volume without values, on the grid of pathways_first(), extended; where there is none, on that of one of the
 * parcellations. It holds all pathways but those in @p hazy, and the areas that @p drawn [object_count + 1] of enum
 * pathways_area names (NULL = none), or all areas where no pathway or bundle is shown. A voxel of several belongs to
 * the first parcellation's area, the most probable area, or the first pathway, in this order.
 * @p out is the caller's to volume_finish() in any case. */
conus_status pathways_join(struct volume *out, const conus_atlas *atlas, const uint8_t *drawn,
                           const struct haze_choice *hazy);

/* The colour pass (Eq. 8): the atlas's areas, opaque, or its pathways, where it has any, with the areas that a
 * selection hits; areas that are meshes; around them the context volume through its transfer function; and a cone
 * with markers. One ray per pixel over view-aligned planes (Eq. 7), empty bricks skipped, up to the mesh that covers
 * the pixel. */

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
    double draft;                     /**< mm; fewer streamlines, at least so wide: see id_pass.h. 0 = all. */
    struct picture_listener listener; /**< Called for pieces that are drawn, and each time that rays are cast. */
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

/** How edges are smoothed: squares of COLOUR_TILE pixels in which neighbours differ (edges.c) are drawn again. */
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

/* A view of the colour pass as its shader reads it, and the planes that the pass samples. */

/** The shader's uniform block View, in std140's layout. */
struct colour_view_block {
    float context_from_camera[16], areas_from_camera[16], world_from_camera[16];
    float context_bricks[4], areas_bricks[4];
    float lens[4], middle[4], planes[4], light[4];
    float apex[4], axis[4], cone_shape[4], cone_colour[4], line[4];
    int32_t counts[4];
    float markers[COLOUR_MARKER_LIMIT][4], marker_colours[COLOUR_MARKER_LIMIT][4];
    float haze_from_camera[16], haze_shape[4], pale[4];
};

/** The planes of Eq. 7 over the joint depth range of the volumes: @p count of them, 0 = slices_default() of the finest
 * volume. */
struct slices colour_pass_slices(const struct colour_pass *pass, const struct camera *camera, uint32_t count);

/** Fills a zeroed @p block, but for what counts meshes and tiles. */
void colour_view_pack(struct colour_view_block *block, const struct colour_pass *pass, const struct colour_view *view);

/* Smooths the edges of a picture: width * height pixels of four floats, of the squares of COLOUR_TILE pixels that a
 * colour_edges is about. */

/** Squares along so many pixels. */
static inline size_t edges_across(uint32_t pixels)
{
    return (pixels + COLOUR_TILE - 1) / COLOUR_TILE;
}

/** Adds to the zeroed pixels @p drawn the mean of the rays that @p edges shifts, of the squares that are not 0 in
 * @p tiles [edges_across(width) * edges_across(height)], row by row. */
typedef conus_status (*edges_draw)(void *user, float *drawn, const uint32_t *tiles, const struct colour_view *view,
                                   const struct colour_edges *edges);

/** Mixes into @p rgba what @p draw draws of the squares with a pixel that differs from its right or upper neighbour,
 * which may lie in the next one. Draws nothing where there is none. */
conus_status edges_smooth(float *rgba, const struct colour_view *view, const struct colour_edges *edges,
                          edges_draw draw, void *user);

/* The renderer's struct: the colour pass of one atlas. */

struct conus_renderer {
    const conus_atlas *atlas;
    struct colour_pass colour;
    struct transfer transfer; /**< The context's, in grey values. */
    uint64_t max_memory;
    conus_log log; /**< May be NULL. */
    void *log_user;
};

/** Draws, beside pathways, the areas that @p areas names (colour_pass_include()) from now on. */
conus_status renderer_include(conus_renderer *renderer, const uint8_t *areas);

/** Draws the streamlines with @p is_pale set in a pale colour from now on (tubes_paint()). */
conus_status renderer_paint_streamlines(conus_renderer *renderer, const bool *const *is_pale);

/** Draws the picture off-screen, with smooth edges if @p smooth. @p rgba gets width * height pixels of linear R, G, B
 * times A, and A, bottom row first. */
conus_status renderer_draw(float *rgba, conus_renderer *renderer, const struct colour_view *view, bool smooth);

#endif
