/* SPDX-License-Identifier: BSD-3-Clause */
/** @file VTK's pickers and hardware selector on a labelled volume, each as its documentation shows it. */
#ifndef CONUS_TESTS_BENCH_PEER_LABELS_H
#define CONUS_TESTS_BENCH_PEER_LABELS_H

#include "bench/peers/peers.h"

#ifdef __cplusplus
extern "C" {
#endif

enum peer_picker { PEER_VOLUME_PICKER, PEER_CELL_PICKER };

/** The hit of a ray in the labelled volume. */
struct peer_contact {
    uint32_t object;    /**< Object of the named voxel; 0 = none, or a voxel of the background. */
    uint64_t voxel;     /**< Its linear index; UINT64_MAX = no hit.                      */
    double distance_mm; /**< From the apex to the point that was named; NAN if only a voxel was.  */
};

struct peer_labels;

/** Shows the voxels of all objects of @p volume with @p opacity per mm, and nothing elsewhere. The labels tell to which
 * object a voxel belongs that VTK names. @p window: whether it is to be drawn, too. Eyes are within 2 m. */
conus_status peer_labels_create(struct peer_labels **out, const struct volume *volume, double opacity, bool window);
void peer_labels_destroy(struct peer_labels *labels); /**< NULL is fine. */

/** The hits of a picker's 16 * 16 rays through the pixels' centres. @p isovalue is VolumeOpacityIsovalue; VTK's default
 * is 0.05. */
conus_status peer_labels_pick(struct peer_labels *labels, struct peer_contact *contacts, const struct cone *cone,
                              enum peer_picker kind, double isovalue);

/** The voxels that vtkHardwareSelector names for cells, drawing with vtkGPUVolumeRayCastMapper. Needs the window. */
conus_status peer_labels_select(struct peer_labels *labels, struct peer_contact *contacts, const struct cone *cone);

#ifdef __cplusplus
}
#endif

#endif
