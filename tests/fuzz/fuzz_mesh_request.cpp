// SPDX-License-Identifier: BSD-3-Clause
// Requests to conus-mesh: every voxel lies in the box of its area, and nothing shorter is a request, too.
#include "mesh/request.hpp"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static bool parses(SurfacesRequest &out, const uint8_t *data, size_t size)
{
    try {
        out = parse_request(data, size);
    } catch (const Failure &) {
        return false;
    }
    return true;
}

static bool is_inside(const Box &box, const SurfacesRequest &job, size_t index)
{
    bool inside = true;
    for (int a = 0; a < 3; a++) {
        const size_t size = static_cast<size_t>(job.dim[a]);
        const int at = static_cast<int>(index % size);
        inside = inside && at >= box.low[a] && at <= box.high[a];
        index /= size;
    }
    return inside;
}

static void check_voxels(const SurfacesRequest &job)
{
    const size_t count = row_of(job, 0, job.dim[2]);
    for (size_t n = 0; n < count; n++) {
        const uint32_t area =
            job.voxel_bytes == 2 ? voxel_at<uint16_t>(job.voxels, n) : voxel_at<uint32_t>(job.voxels, n);
        if (area && !is_inside(job.boxes.at(area - 1), job, n)) {
            std::abort();
        }
    }
}

static void check_boxes(const SurfacesRequest &job)
{
    for (const Box &box : job.boxes) {
        for (int a = 0; !is_empty(box) && a < 3; a++) {
            if (box.low[a] < 0 || box.low[a] > box.high[a] || box.high[a] >= job.dim[a]) {
                std::abort();
            }
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    SurfacesRequest request, shorter;
    if (!parses(request, data, size)) {
        return 0;
    }
    if (parses(shorter, data, size - 1)) {
        std::abort();
    }
    check_voxels(request);
    check_boxes(request);
    return 0;
}
