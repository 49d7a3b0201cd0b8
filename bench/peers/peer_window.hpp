// SPDX-License-Identifier: BSD-3-Clause
// Shared by the peers: off-screen windows, cameras, exceptions as statuses.
#ifndef CONUS_BENCH_PEERS_PEER_WINDOW_HPP
#define CONUS_BENCH_PEERS_PEER_WINDOW_HPP

#include <vtkPolyData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <cmath>
#include <exception>
#include <stdexcept>

extern "C" {
#include "bench/peers/peers.h" // last: fail() is a macro to analysers
}

namespace peers
{

struct NoDisplay : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/* Off-screen, without antialiasing. Throws NoDisplay where VTK would end the process. */
vtkSmartPointer<vtkRenderWindow> make_window(vtkRenderer *renderer, const uint32_t size[2]);

/* Puts the renderer's camera at a pose; `angle` is vertical, in radians. */
void aim_camera(vtkRenderer *renderer, const double world_from_camera[16], double angle, const double range[2]);

/* All triangles of the objects, in their order, at their places. */
vtkSmartPointer<vtkPolyData> make_surface(const mesh_object *objects, size_t count);

/* Runs `work` and turns what it throws into a status. */
template <typename Work> conus_status guarded(Work &&work)
{
    try {
        work();
        return CONUS_OK;
    } catch (const NoDisplay &error) {
        return fail(CONUS_ERROR_GL, "%s", error.what());
    } catch (const std::bad_alloc &) {
        return fail(CONUS_ERROR_MEMORY, "VTK: out of memory");
    } catch (const std::exception &error) {
        return fail(CONUS_ERROR_DATA, "VTK: %s", error.what());
    }
}

} // namespace peers

#endif
