// SPDX-License-Identifier: BSD-3-Clause
// What the first bytes of a mesh file say: the first byte is the file's ending and how much longer than that it is.
#include "mesh/failure.hpp"
#include "mesh/file_head.hpp"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void read_head(const std::string &path, const std::string &head, uint64_t size)
{
    try {
        const Format format = format_of(path, head);
        const mesh_space space = stated_space(format, head);
        if (space != MESH_SPACE_UNSTATED && head.find("SPACE") == std::string::npos) {
            std::abort();
        }
        if (format == Format::Ply) {
            check_ply_counts(head, size);
        }
        if (format == Format::Stl) {
            check_stl_size(head, size);
        }
    } catch (const Failure &failure) {
        if (!*failure.what()) {
            std::abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const paths[] = {"a.vtk", "a.STL", "a.obj", "a"};
    if (size) {
        const std::string head(reinterpret_cast<const char *>(data) + 1, size - 1);
        read_head(paths[data[0] % 4], head, head.size() + data[0] / 4);
    }
    return 0;
}
