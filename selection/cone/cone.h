/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A cone: a pose, an opening angle and the pixels it is looked at through (Eq. 3); or a cylinder, whose rays are
 * parallel. */
#ifndef CONUS_SELECTION_CONE_CONE_H
#define CONUS_SELECTION_CONE_CONE_H

#include "base/status.h"
#include "conus/selection.h"

#include <math.h>

/** Rays of a cone in the device's frame: (right, up, -forward) is a ray's unit direction. */
struct device_rays {
    size_t count;
    uint32_t *pixel; /**< Which, row-major. */
    double *right, *up, *forward;
};

/** Which rays of a cone an engine traces, and what is known of them already. Zeroed: all of them, and nothing. */
struct cone_tracing {
    const bool *wanted;             /**< [n*n] Pixels that are to be traced; NULL = all. */
    const double *per_depth;        /**< [n*n] cone_per_depth(); NULL = unknown. */
    const struct device_rays *rays; /**< The rays of those pixels, neighbours one after the other; NULL = unknown. */
    bool begins_at_range;           /**< Objects that rays leave before range[0] may be left out. */
};

struct cone {
    conus_pose pose;
    double degrees;      /**< Full opening angle as it was given, in (0, 180); 0 of a cylinder. */
    double angle;        /**< The same, radians. */
    uint32_t resolution; /**< n */
    conus_aperture aperture;
    double radius;   /**< Radius of a cylinder, mm; 0 for a cone. */
    double range[2]; /**< Nearest and farthest depth along the axis, mm; both 0 = everything. */
    double slope;    /**< tan(angle / 2), where it is known already, else 0. */
    struct cone_tracing tracing;
};

/** CONUS_ERROR_ARGUMENT with what is allowed, unless angle, resolution, radius and range are in their ranges. */
conus_status cone_check(const struct cone *cone);

/** Buffer coordinates u (or v) of pixel column (or row) @p i: (2i + 1)/n - 1 (Eq. 3). */
static inline double cone_coordinate(uint32_t i, uint32_t resolution)
{
    return (2.0 * i + 1) / resolution - 1;
}

/** n^2 r^2 of pixel column @p i, row @p j of n x n: a whole number. Pixels are ordered by r with it, since r of pixels
 * that are equally far from the centre is rounded differently where n is not a power of two. */
static inline uint32_t cone_square(uint32_t i, uint32_t j, uint32_t resolution)
{
    int32_t u = (int32_t)(2 * i + 1) - (int32_t)resolution;
    int32_t v = (int32_t)(2 * j + 1) - (int32_t)resolution;
    return (uint32_t)(u * u + v * v);
}

/** r of the pixels with that n^2 r^2. */
static inline double cone_radius_of(uint32_t square, uint32_t resolution)
{
    return sqrt(square) / resolution;
}

/** tan(angle / 2). */
double cone_slope(const struct cone *cone);

/** Whether the rays are spread evenly in angle, not as a perspective picture's (Eq. 15). */
bool cone_is_wide(const struct cone *cone);

/** Angle to the axis of the rays at the distance @p radius from the buffer's centre, radians. */
double cone_off_axis(const struct cone *cone, double radius);

/** Unit direction in world space of the ray of pixel column @p i, row @p j (Eq. 3). */
void cone_ray(double out[3], const struct cone *cone, uint32_t i, uint32_t j);

/** Where that ray starts: the apex, or (u, v) radii beside it for a cylinder (Eq. 3). */
void cone_origin(double out[3], const struct cone *cone, uint32_t i, uint32_t j);

/** The point @p distance mm along that ray. */
void cone_point(double out[3], const struct cone *cone, uint32_t i, uint32_t j, double distance);

/** mm along that ray per mm of depth along the axis. */
double cone_per_depth(const struct cone *cone, uint32_t i, uint32_t j);

static inline bool cone_has_range(const struct cone *cone)
{
    return cone->range[1] > 0;
}

/** Solid angle of the aperture, or the cross-section of a cylinder in mm^2 (Eq. 10). */
double cone_cross_section(const struct cone *cone);

/** cone_ray() for @p count rays through the points (u, v) of the buffer: out[axis][ray]. The same bits, too. */
void cone_rays(double *const out[3], const struct cone *cone, const double *u, const double *v, size_t count);

/** The rays through @p count points (u, v) of the buffer, in the device's frame, wherever the cone is. */
void cone_device_rays(double *right, double *up, double *forward, const struct cone *cone, const double *u,
                      const double *v, size_t count);

/** Those of them from number @p first on, @p count of them, in the world, as cone_rays() gives them. */
void cone_rays_from(double *const out[3], const struct cone *cone, const struct device_rays *rays, size_t first,
                    size_t count);

/** Distance of a pixel's centre from the buffer's, r = sqrt(u^2 + v^2), 1 at the circle's rim (Eq. 3): the same for all
 * pixels with the same cone_square(). */
double cone_radius(const struct cone *cone, uint32_t i, uint32_t j);

/** Whether the aperture lets the pixel through: r <= 1, or for a square one always (Eq. 3), but of a wide cone's only
 * where its ray is in the pyramid (Eq. 15). */
bool cone_has_pixel(const struct cone *cone, uint32_t i, uint32_t j);

/** Weight of a pixel, proportional to its solid angle: (1 + tan^2(angle/2) r^2)^(-3/2) (Eq. 4), of a wide cone
 * sin(theta) / theta (Eq. 15). */
double cone_weight(const struct cone *cone, uint32_t i, uint32_t j);

/* Everything that all cones of one shape have in common, wherever they are: kept from one query to the next. */

/** Rays that are walked together are neighbours both ways: pixels come in blocks, and in a block in tiles. */
enum { APERTURE_BLOCK = 16, APERTURE_TILE = 4 };

/** Pixels along an edge up to which weights are not rounded: such a cone is added up in one piece, pixel after pixel.
 */
enum { APERTURE_EXACT_WEIGHTS = 16 };

/** Column of pixel number @p k of a block. */
static inline uint32_t aperture_column(uint32_t k)
{
    uint32_t tile = k / (APERTURE_TILE * APERTURE_TILE);
    return tile % (APERTURE_BLOCK / APERTURE_TILE) * APERTURE_TILE + k % APERTURE_TILE;
}

/** And its row. */
static inline uint32_t aperture_row(uint32_t k)
{
    uint32_t tile = k / (APERTURE_TILE * APERTURE_TILE);
    return tile / (APERTURE_BLOCK / APERTURE_TILE) * APERTURE_TILE + k / APERTURE_TILE % APERTURE_TILE;
}

/** The n x n pixels, row-major. */
struct aperture {
    uint32_t resolution; /**< n */
    conus_aperture shape;
    double angle;
    bool is_wide_square;     /**< Its pixels are those of this angle only (Eq. 15).      */
    bool *in_cone;           /**< cone_has_pixel()                                       */
    uint32_t *square;        /**< cone_square()                                          */
    double *weight;          /**< cone_weight()                                          */
    double *per_depth;       /**< cone_per_depth()                                       */
    uint32_t *inside;        /**< The pixels in the cone, rays.count of them, in the pixels' order. */
    struct device_rays rays; /**< Rays of the pixels in the cone, block by block.             */
    double total_weight;     /**< Sum over the pixels in the cone, in the pixels' order. */
};

/** Whether a pixel in the cone has a neighbour beside, above or below that is not. @p in_cone [n*n]. */
bool aperture_is_border(const bool *in_cone, uint32_t n, uint32_t pixel);

/** Makes it the aperture of @p cone. That takes time only where it had another shape. A zeroed one is ready. */
conus_status aperture_prepare(struct aperture *aperture, const struct cone *cone);
void aperture_finish(struct aperture *aperture);

#endif
