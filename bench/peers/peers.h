/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The VTK classes that people use today for the same questions: selector, picker, locators and volume mappers,
 * each as its documentation shows it. C++ stays behind this header; nothing here is part of the library.
 *
 * Drawing needs a display (X, or Xvfb): CONUS_ERROR_GL without one. No context of VTK's stays current. */
#ifndef CONUS_BENCH_PEERS_PEERS_H
#define CONUS_BENCH_PEERS_PEERS_H

#include "atlas/volume.h"
#include "render/gl/camera.h"
#include "selection/cone/cone.h"
#include "selection/engine/triangles/mesh_rays.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Pixels along the edge of the square that a selector or picker is asked for. */
enum { PEER_RESOLUTION = 16 };

/** "VTK 9.1.0". */
const char *peer_version(void);

/** Whether there is a display. */
conus_status peer_check_display(void);

/* vtkHardwareSelector: surfaces drawn with their numbers as colours. */

struct peer_selector;

/** Shows placed @p objects, a vtkActor each, within @p reach mm of every cone to come, in a window of 16 x 16 pixels;
 * draws it once, along @p cone. Object number k is objects[k - 1]. */
conus_status peer_selector_create(struct peer_selector **out, const struct mesh_object *objects, size_t count,
                                  double reach, const struct cone *cone);
void peer_selector_destroy(struct peer_selector *selector); /**< NULL is fine. */

/** Objects, [16 * 16], of the pixels of the window, which @p cone just fills, by the pass that distinguishes actors
 * (vtkHardwareSelector::ActorPassOnly). */
conus_status peer_selector_trace(struct peer_selector *selector, uint32_t *objects, const struct cone *cone);

/* vtkCellPicker and cell locators: rays into one merged surface, as many as the cone has pixels. */

enum peer_locator { PEER_NO_LOCATOR /**< Pickers only. */, PEER_CELL_LOCATOR, PEER_STATIC_LOCATOR, PEER_LOCATORS };

struct peer_surface;

/** Merges @p objects into one vtkPolyData; nothing to search it with is built yet. */
conus_status peer_surface_create(struct peer_surface **out, const struct mesh_object *objects, size_t count,
                                 double reach);
void peer_surface_destroy(struct peer_surface *surface); /**< NULL is fine. */

/** Builds a vtkCellLocator or vtkStaticCellLocator with VTK's defaults, on all processors if VTK does so. Does nothing
 * if there is one already, or none is wanted. */
conus_status peer_surface_build(struct peer_surface *surface, enum peer_locator kind);

/** Objects of the pixels, by IntersectWithLine() of a locator that has been built. */
conus_status peer_surface_trace(struct peer_surface *surface, uint32_t *objects, const struct cone *cone,
                                enum peer_locator kind);

/** The same by vtkCellPicker::Pick() at the pixels' centres, with that locator (AddLocator) or none. */
conus_status peer_surface_pick(struct peer_surface *surface, uint32_t *objects, const struct cone *cone,
                               enum peer_locator kind);

enum peer_caster { PEER_GPU, PEER_FIXED_POINT };

struct peer_picture_options {
    enum peer_caster caster;
    bool shade;       /**< Shades it by its gradient. */
    bool one_thread;  /**< Only the calling one, where the caster is not OpenGL's. */
    uint32_t size[2]; /**< Pixels. */
    double sample_mm; /**< Distance between samples along a ray. */
};

/** Colour and opacity of grey values from low to high, evenly spaced. */
struct peer_transfer {
    double low, high;
    const float (*rgba)[4]; /**< [count] colours as they are to be composed, and the opacity of 1 mm. */
    size_t count;
};

struct peer_picture;

/** Shows a volume's values through @p transfer, as bytes from its low to its high value; draws it once. */
conus_status peer_picture_create(struct peer_picture **out, const struct volume *context,
                                 const struct peer_transfer *transfer, const struct camera *camera,
                                 const struct peer_picture_options *options);
void peer_picture_destroy(struct peer_picture *picture); /**< NULL is fine. */

conus_status peer_picture_draw(struct peer_picture *picture);

/** The last picture: pixels of R, G, B times A, and A, bottom row first. */
conus_status peer_picture_read(struct peer_picture *picture, float *rgba);

#ifdef __cplusplus
}
#endif

#endif
