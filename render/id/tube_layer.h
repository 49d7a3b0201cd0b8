/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The streamlines of an atlas as a camera sees them: tubes around their segments, found pixel by pixel in closed
 * form (Eq. 18); straight neighbours are drawn as one. Of more than TUBE_POINT_LIMIT points every k-th streamline is
 * drawn; a draft draws about TUBE_DRAFT_LIMIT points, of streamlines from everywhere. Needs a current context. */
#ifndef CONUS_RENDER_ID_TUBE_LAYER_H
#define CONUS_RENDER_ID_TUBE_LAYER_H

#include "atlas/atlas.h"
#include "render/gl/camera.h"
#include "render/gl/context.h"

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

/** The same of a direction, of any length; its sign does not count. Grey where its length is 0. */
void tube_direction_colour(uint8_t rgb[3], const double direction[3]);

/** The colour of the segment from point @p index of streamline @p number to the next, of @p object. */
uint32_t tube_colour(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                     uint64_t index, uint32_t object);

enum { TUBE_POINT_LIMIT = 1000000, TUBE_DRAFT_LIMIT = 20000 };

struct tube_layer;

/** Uploads the streamlines of @p atlas, which has some, and takes their size off @p memory_left. */
conus_status tube_layer_create(struct tube_layer **out, const conus_atlas *atlas, uint64_t *memory_left);
/** NULL is fine. */
void tube_layer_destroy(struct tube_layer *layer);

/** Updates the hidden bundles, and colours the streamlines; those with @p is_pale
 * [tractogram_count][streamline_count] set are pale. NULL, or NULL for a tractogram: none is. */
conus_status tube_layer_update(struct tube_layer *layer, const conus_atlas *atlas,
                               const struct tube_colouring *colouring, const bool *const *is_pale);

struct tube_layer_view {
    const double *eye;               /**< World mm. */
    const double *camera_from_world; /**< [9] As in mesh.vert.glsl, by rows. */
    float shift[2];                  /**< In halves of the picture. */
    uint32_t width, height;
    double draft; /**< mm; draws a draft, in which no tube is thinner. 0 = draws all as they are. */
    struct gl_listener listener;
};

/** Draws into the bound framebuffer as mesh.frag.glsl does, behind what is there; depths are reversed.
 * CONUS_ERROR_CANCELLED. */
conus_status tube_layer_draw(const struct tube_layer *layer, const struct tube_layer_view *view);

#endif
