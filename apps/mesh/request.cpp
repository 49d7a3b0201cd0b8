// SPDX-License-Identifier: BSD-3-Clause
// Parses a request and checks its numbers.
#include "request.hpp"

#include <algorithm>
#include <cmath>

namespace
{

/* Takes numbers off the bytes of a request. */
class Cursor
{
  public:
    Cursor(const unsigned char *data, size_t size) : at(data), left(size)
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

void add_run(Box &box, int first, int last, int j, int k)
{
    box.low[0] = std::min(box.low[0], first);
    box.high[0] = std::max(box.high[0], last);
    box.low[1] = std::min(box.low[1], j);
    box.high[1] = std::max(box.high[1], j);
    box.low[2] = std::min(box.low[2], k);
    box.high[2] = std::max(box.high[2], k);
}

template <typename Voxel> void find_runs(SurfacesRequest &job, int j, int k)
{
    const unsigned char *row = job.voxels + row_of(job, j, k) * sizeof(Voxel);
    for (int i = 0; i < job.dim[0];) {
        const uint32_t area = voxel_at<Voxel>(row, static_cast<size_t>(i));
        const int first = i;
        while (i < job.dim[0] && voxel_at<Voxel>(row, static_cast<size_t>(i)) == area) {
            i++;
        }
        if (area > job.labels.size()) {
            throw Failure("request: a voxel's area is not in its list");
        }
        if (area) {
            add_run(job.boxes[area - 1], first, i - 1, j, k);
        }
    }
}

template <typename Voxel> void find_boxes(SurfacesRequest &job)
{
    for (int k = 0; k < job.dim[2]; k++) {
        for (int j = 0; j < job.dim[1]; j++) {
            find_runs<Voxel>(job, j, k);
        }
    }
}

/* The number of voxels. */
size_t take_dimensions(SurfacesRequest &job, Cursor &from)
{
    size_t voxels = 1;
    for (int &dim : job.dim) {
        const uint32_t found = from.number<uint32_t>();
        if (!found || found > 1u << 20 || voxels > SIZE_MAX / 8 / found) {
            throw Failure("request: impossible dimensions");
        }
        dim = static_cast<int>(found);
        voxels *= found;
    }
    return voxels;
}

void take_settings(SurfacesRequest &job, Cursor &from)
{
    constexpr uint32_t SMOOTH_LIMIT = 1000; /* mesh_write.c's */
    job.voxel_bytes = from.number<uint32_t>();
    job.iterations = from.number<uint32_t>();
    from.number<uint32_t>();
    job.pass_band = from.number<double>();
    job.reduction = from.number<double>();
    bool fine = job.iterations <= SMOOTH_LIMIT && job.pass_band >= 0 && job.pass_band <= 2 && job.reduction >= 0 &&
                job.reduction < 1;
    for (double &entry : job.world_from_voxel) {
        entry = from.number<double>();
        fine = fine && std::isfinite(entry);
    }
    if (!fine) {
        throw Failure("request: impossible settings");
    }
}

void take_surfaces(SurfacesRequest &job, Cursor &from, uint32_t count)
{
    const size_t voxels = take_dimensions(job, from);
    take_settings(job, from);
    if ((job.voxel_bytes != 2 && job.voxel_bytes != 4) || count > from.remaining() / sizeof(uint32_t)) {
        throw Failure("request: impossible sizes");
    }
    for (uint32_t i = 0; i < count; i++) {
        job.labels.push_back(from.number<uint32_t>());
    }
    job.boxes.resize(count);
    job.voxels = from.take(voxels * job.voxel_bytes);
    job.voxel_bytes == 2 ? find_boxes<uint16_t>(job) : find_boxes<uint32_t>(job);
}

void check_kind(Cursor &from)
{
    if (std::memcmp(from.take(MESH_MAGIC_SIZE), MESH_REQUEST_MAGIC, MESH_MAGIC_SIZE) != 0) {
        throw Failure("request: it does not begin with " MESH_REQUEST_MAGIC);
    }
    const uint32_t kind = from.number<uint32_t>();
    if (kind != MESH_REQUEST_SURFACES) {
        throw Failure("request: found kind " + std::to_string(kind) + ", allowed is 1");
    }
}

} // namespace

SurfacesRequest parse_request(const unsigned char *data, size_t size)
{
    Cursor from(data, size);
    SurfacesRequest request;
    check_kind(from);
    const uint32_t count = from.number<uint32_t>();
    take_surfaces(request, from, count);
    if (from.remaining()) {
        throw Failure("request: " + std::to_string(from.remaining()) + " bytes are left at its end");
    }
    return request;
}
