// SPDX-License-Identifier: BSD-3-Clause
/** @file
 * conus-mesh: the one program that links VTK. It reads a request (loaders/child/mesh_protocol.h), and what it finds
 * goes to stdout as a stream of meshes. VTK's readers crash on bad files; what they take with them is this process. */
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
    void mesh(const Surface &surface, const std::string &name = "");
    void failure(uint32_t id, const std::string &text);
    void end();

  private:
    void frame(mesh_frame_kind kind, uint32_t id, const Surface *surface, const std::string &text);
    uint32_t frames = 0;
};

/** The triangles of @p poly, and the vertices that they use. */
Surface surface_from(vtkPolyData *poly);

/** One closed surface per area, in order. */
void make_surfaces(Stream &stream, const SurfacesRequest &request);

/** The mesh in each file, in order. */
void read_files(Stream &stream, const std::vector<std::string> &paths);

/** The objects of one file, in the order in which they come first. */
void read_objects(Stream &stream, const std::string &path);

#endif
