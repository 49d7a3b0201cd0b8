// SPDX-License-Identifier: BSD-3-Clause
/** @file
 * conus-mesh: the one program that links VTK. It reads a request (loaders/mesh_protocol.h), and what it finds goes to
 * stdout as a stream of meshes. VTK's readers crash on bad files; what they take with them is this process. */
#ifndef CONUS_APPS_MESH_CONUS_MESH_HPP
#define CONUS_APPS_MESH_CONUS_MESH_HPP

#include "loaders/mesh_protocol.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

class vtkPolyData;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the protocol's numbers are written as they lie in memory");

/** What ends the program, or a file: one line. */
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/** Takes numbers off the bytes of a request. */
class Request
{
  public:
    Request(const unsigned char *data, size_t size) : at(data), left(size)
    {
    }

    const unsigned char *take(size_t size)
    {
        if (size > left) {
            throw Failure("request: it ends too early");
        }
        const unsigned char *here = at;
        at += size;
        left -= size;
        return here;
    }

    template <typename Number> Number number()
    {
        Number value;
        std::memcpy(&value, take(sizeof value), sizeof value);
        return value;
    }

    size_t remaining() const
    {
        return left;
    }

  private:
    const unsigned char *at;
    size_t left;
};

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
void make_surfaces(Stream &stream, Request &request, uint32_t count);

/** The mesh in each file, in order. */
void read_files(Stream &stream, Request &request, uint32_t count);

/** The objects of one file, in the order in which they come first. */
void read_objects(Stream &stream, Request &request, uint32_t count);

#endif
