// SPDX-License-Identifier: BSD-3-Clause
/** @file
 * conus-mesh: the one program that links VTK. It reads a request (loaders/extraction/mesh_protocol.h), and what it
 * makes goes to stdout as a stream of meshes. */
#ifndef CONUS_MESH_CONUS_MESH_HPP
#define CONUS_MESH_CONUS_MESH_HPP

#include "request.hpp"

#include <cstdint>
#include <string>
#include <vector>

class vtkPolyData;

/** A mesh on its way out. */
struct Surface {
    uint32_t id = 0;
    mesh_space space = MESH_SPACE_UNSTATED;
    std::vector<float> positions;
    std::vector<uint32_t> triangles;
};

/** The stream on stdout. */
class Stream
{
  public:
    Stream();
    void mesh(const Surface &surface);
    void end();

  private:
    void frame(mesh_frame_kind kind, uint32_t id, const Surface *surface);
    uint32_t frames = 0;
};

/** The triangles of @p poly, and the vertices that they use. */
Surface surface_from(vtkPolyData *poly);

/** One closed surface per area, in order. */
void make_surfaces(Stream &stream, const SurfacesRequest &request);

#endif
