// SPDX-License-Identifier: BSD-3-Clause
// The stream of meshes on stdout.
#include "conus_mesh.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <unistd.h>

static void write_fully(const void *bytes, size_t size)
{
    const char *at = static_cast<const char *>(bytes);
    while (size) {
        const ssize_t n = write(STDOUT_FILENO, at, size);
        if (n < 0 && errno != EINTR) {
            throw Failure(std::string("standard output: ") + std::strerror(errno));
        }
        at += n > 0 ? n : 0;
        size -= n > 0 ? static_cast<size_t>(n) : 0;
    }
}

Stream::Stream()
{
    write_fully(MESH_STREAM_MAGIC, MESH_MAGIC_SIZE);
}

void Stream::frame(mesh_frame_kind kind, uint32_t id, const Surface *surface)
{
    unsigned char header[MESH_FRAME_HEADER_SIZE] = {};
    const uint32_t words[4] = {static_cast<uint32_t>(kind), id, surface ? static_cast<uint32_t>(surface->space) : 0u,
                               0};
    const uint64_t counts[2] = {surface ? surface->positions.size() / 3 : 0,
                                surface ? surface->triangles.size() / 3 : 0};
    std::memcpy(header, words, sizeof words);
    std::memcpy(header + sizeof words, counts, sizeof counts);
    write_fully(header, sizeof header);
    if (surface) {
        write_fully(surface->positions.data(), surface->positions.size() * sizeof(float));
        write_fully(surface->triangles.data(), surface->triangles.size() * sizeof(uint32_t));
    }
    frames++;
}

void Stream::mesh(const Surface &surface)
{
    frame(MESH_FRAME_MESH, surface.id, &surface);
}

void Stream::end()
{
    frame(MESH_FRAME_END, frames, nullptr);
}
