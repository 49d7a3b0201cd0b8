// SPDX-License-Identifier: BSD-3-Clause
/** @file A request (loaders/extraction/mesh_protocol.h): bytes in, checked numbers out. Without VTK. */
#ifndef CONUS_MESH_REQUEST_HPP
#define CONUS_MESH_REQUEST_HPP

#include "loaders/extraction/mesh_protocol.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the protocol's numbers are written as they lie in memory");

/** One line that says what is wrong, and ends conus-mesh. */
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/** The voxels of an area lie in low to high, both included. */
struct Box {
    int low[3] = {std::numeric_limits<int>::max(), std::numeric_limits<int>::max(), std::numeric_limits<int>::max()};
    int high[3] = {-1, -1, -1};
};

inline bool is_empty(const Box &box)
{
    return box.high[0] < 0;
}

/** Every voxel is 0 or the number of a label, from 1. */
struct SurfacesRequest {
    int dim[3] = {};
    uint32_t voxel_bytes = 0, iterations = 0;
    double pass_band = 0, reduction = 0, world_from_voxel[16] = {};
    std::vector<uint32_t> labels;
    std::vector<Box> boxes; /**< One per label. */
    const unsigned char *voxels = nullptr;
};

/** Where a row of voxels begins. */
inline size_t row_of(const SurfacesRequest &job, int j, int k)
{
    return static_cast<size_t>(job.dim[0]) *
           (static_cast<size_t>(j) + static_cast<size_t>(job.dim[1]) * static_cast<size_t>(k));
}

/** Voxels may lie unaligned in the request. */
template <typename Voxel> uint32_t voxel_at(const unsigned char *voxels, size_t index)
{
    Voxel value;
    std::memcpy(&value, voxels + index * sizeof value, sizeof value);
    return value;
}

/** Its voxels lie in @p data. Throws Failure for all that conus does not ask. */
SurfacesRequest parse_request(const unsigned char *data, size_t size);

#endif
