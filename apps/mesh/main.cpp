// SPDX-License-Identifier: BSD-3-Clause
#include "conus_mesh.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <new>
#include <sys/mman.h>
#include <sys/stat.h>
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

void Stream::frame(mesh_frame_kind kind, uint32_t id, const Surface *surface, const std::string &text)
{
    unsigned char header[MESH_FRAME_HEADER_SIZE] = {};
    const uint32_t words[4] = {static_cast<uint32_t>(kind), id, surface ? static_cast<uint32_t>(surface->space) : 0u,
                               static_cast<uint32_t>(text.size())};
    const uint64_t counts[2] = {surface ? surface->positions.size() / 3 : 0,
                                surface ? surface->triangles.size() / 3 : 0};
    std::memcpy(header, words, sizeof words);
    std::memcpy(header + sizeof words, counts, sizeof counts);
    write_fully(header, sizeof header);
    write_fully(text.data(), text.size());
    if (surface) {
        write_fully(surface->positions.data(), surface->positions.size() * sizeof(float));
        write_fully(surface->triangles.data(), surface->triangles.size() * sizeof(uint32_t));
    }
    frames++;
}

void Stream::mesh(const Surface &surface, const std::string &name)
{
    frame(MESH_FRAME_MESH, surface.id, &surface, name.substr(0, MESH_FRAME_TEXT_LIMIT));
}

void Stream::failure(uint32_t id, const std::string &text)
{
    frame(MESH_FRAME_FAILURE, id, nullptr, text.substr(0, MESH_FRAME_TEXT_LIMIT));
}

void Stream::end()
{
    frame(MESH_FRAME_END, frames, nullptr, "");
}

static void answer(const unsigned char *data, size_t size)
{
    Request request(data, size);
    if (std::memcmp(request.take(MESH_MAGIC_SIZE), MESH_REQUEST_MAGIC, MESH_MAGIC_SIZE) != 0) {
        throw Failure("request: it does not begin with " MESH_REQUEST_MAGIC);
    }
    const uint32_t kind = request.number<uint32_t>();
    const uint32_t count = request.number<uint32_t>();
    Stream stream;
    if (kind == MESH_REQUEST_SURFACES) {
        make_surfaces(stream, request, count);
    } else if (kind == MESH_REQUEST_FILES) {
        read_files(stream, request, count);
    } else if (kind == MESH_REQUEST_OBJECTS) {
        read_objects(stream, request, count);
    } else {
        throw Failure("request: found kind " + std::to_string(kind) + ", allowed are 1 to 3");
    }
    stream.end();
}

static void answer_file(const char *path)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    struct stat info;
    if (descriptor < 0 || fstat(descriptor, &info)) {
        throw Failure(std::string(path) + ": " + std::strerror(errno));
    }
    const size_t size = static_cast<size_t>(info.st_size);
    void *data = size ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
    if (data == MAP_FAILED) {
        throw Failure(std::string(path) + ": " + std::strerror(errno));
    }
    answer(static_cast<const unsigned char *>(data), size);
}

int main(int argc, char **argv)
{
    if (argc != 2 || argv[1][0] == '-') {
        std::fputs("usage: conus-mesh REQUEST\n\nWhat conus runs to make meshes with VTK; see loaders/mesh_protocol.h "
                   "for the file REQUEST.\nThe command for people is conus mesh.\n",
                   stderr);
        return 2;
    }
    try {
        answer_file(argv[1]);
    } catch (const std::bad_alloc &) {
        std::fputs("not enough memory\n", stderr);
        return 3;
    } catch (const std::exception &failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return 1;
    }
    return 0;
}
