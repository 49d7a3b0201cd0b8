// SPDX-License-Identifier: BSD-3-Clause
// A labelled volume to one closed surface per area: discrete flying edges, windowed sinc, quadrics.
#include "conus_mesh.hpp"

#include <vtkCellArray.h>
#include <vtkDiscreteFlyingEdges3D.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>
#include <vtkSmartPointer.h>
#include <vtkWindowedSincPolyDataFilter.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>

namespace
{

/* The area alone, with a border of one empty voxel, so that its surface closes at the volume's edge. */
template <typename Voxel> void paint(vtkImageData *image, const SurfacesRequest &job, uint32_t area)
{
    const Box &box = job.boxes[area - 1];
    int dim[3];
    for (int a = 0; a < 3; a++) {
        dim[a] = box.high[a] - box.low[a] + 3;
    }
    image->SetDimensions(dim);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    unsigned char *mask = static_cast<unsigned char *>(image->GetScalarPointer());
    std::fill_n(mask, static_cast<size_t>(dim[0]) * dim[1] * dim[2], static_cast<unsigned char>(0));
    for (int k = box.low[2]; k <= box.high[2]; k++) {
        for (int j = box.low[1]; j <= box.high[1]; j++) {
            const unsigned char *row = job.voxels + row_of(job, j, k) * sizeof(Voxel);
            const size_t line = static_cast<size_t>(k - box.low[2] + 1) * dim[1] + (j - box.low[1] + 1);
            unsigned char *out = mask + line * dim[0] + 1 - box.low[0];
            for (int i = box.low[0]; i <= box.high[0]; i++) {
                out[i] = voxel_at<Voxel>(row, i) == area;
            }
        }
    }
}

vtkSmartPointer<vtkPolyData> smooth(vtkPolyData *poly, const SurfacesRequest &job)
{
    vtkNew<vtkWindowedSincPolyDataFilter> filter;
    filter->SetInputData(poly);
    filter->SetNumberOfIterations(static_cast<int>(job.iterations));
    filter->SetPassBand(job.pass_band);
    filter->BoundarySmoothingOff();
    filter->FeatureEdgeSmoothingOff();
    filter->NonManifoldSmoothingOn();
    filter->NormalizeCoordinatesOn();
    filter->Update();
    return filter->GetOutput();
}

vtkSmartPointer<vtkPolyData> decimate(vtkPolyData *poly, const SurfacesRequest &job)
{
    vtkNew<vtkQuadricDecimation> filter;
    filter->SetInputData(poly);
    filter->SetTargetReduction(job.reduction);
    filter->Update();
    return filter->GetOutput();
}

/* Quadrics measure distances, so points must be in mm before they are decimated. */
void move_to_world(vtkPolyData *poly, const SurfacesRequest &job, const Box &box)
{
    const double *m = job.world_from_voxel;
    vtkPoints *points = poly->GetPoints();
    for (vtkIdType n = 0; n < points->GetNumberOfPoints(); n++) {
        double p[3], world[3];
        points->GetPoint(n, p);
        for (int a = 0; a < 3; a++) {
            p[a] += box.low[a] - 1;
        }
        for (int r = 0; r < 3; r++) {
            world[r] = m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r];
        }
        points->SetPoint(n, world);
    }
    points->Modified();
}

bool mirrors(const double m[16])
{
    const double cross[3] = {m[5] * m[10] - m[6] * m[9], m[6] * m[8] - m[4] * m[10], m[4] * m[9] - m[5] * m[8]};
    return m[0] * cross[0] + m[1] * cross[1] + m[2] * cross[2] < 0;
}

Surface make_surface(const SurfacesRequest &job, uint32_t area)
{
    vtkNew<vtkImageData> image;
    job.voxel_bytes == 2 ? paint<uint16_t>(image, job, area) : paint<uint32_t>(image, job, area);
    vtkNew<vtkDiscreteFlyingEdges3D> edges;
    edges->SetInputData(image);
    edges->SetValue(0, 1);
    edges->ComputeNormalsOff();
    edges->ComputeGradientsOff();
    edges->ComputeScalarsOff();
    edges->Update();
    vtkSmartPointer<vtkPolyData> poly = edges->GetOutput();
    if (job.iterations) {
        poly = smooth(poly, job);
    }
    move_to_world(poly, job, job.boxes[area - 1]);
    if (job.reduction > 0) {
        poly = decimate(poly, job);
    }
    Surface surface = surface_from(poly);
    surface.id = job.labels[area - 1];
    surface.space = MESH_SPACE_RAS;
    for (size_t t = 0; mirrors(job.world_from_voxel) && t < surface.triangles.size(); t += 3) {
        std::swap(surface.triangles[t + 1], surface.triangles[t + 2]);
    }
    return surface;
}

/* Areas made by several threads, given out in order. At most `window` wait for their turn. */
class Works
{
  public:
    explicit Works(const SurfacesRequest &from) : job(from), done(from.labels.size())
    {
    }

    void run(Stream &stream);

  private:
    bool take(uint32_t &area);
    void work();
    void give_out(Stream &stream);
    std::unique_ptr<Surface> wait_for(size_t i);
    void stop();

    const SurfacesRequest &job;
    std::mutex lock;
    std::condition_variable changed;
    std::vector<std::unique_ptr<Surface>> done;
    size_t next = 0, given = 0, window = 1;
    std::exception_ptr failure;
};

void Works::run(Stream &stream)
{
    const unsigned count = std::clamp(std::thread::hardware_concurrency(), 1u, 16u);
    std::vector<std::thread> threads;
    window = 4 * count;
    for (unsigned i = 0; i < count; i++) {
        threads.emplace_back([this] { work(); });
    }
    give_out(stream);
    for (std::thread &thread : threads) {
        thread.join();
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

/* The next area to be made, when there is room for it; false when all are. */
bool Works::take(uint32_t &area)
{
    std::unique_lock<std::mutex> guard(lock);
    changed.wait(guard, [this] { return failure || next >= done.size() || next < given + window; });
    area = static_cast<uint32_t>(next + 1);
    return !failure && next++ < done.size();
}

void Works::work()
{
    try {
        for (uint32_t area; take(area);) {
            std::unique_ptr<Surface> surface = std::make_unique<Surface>();
            if (!is_empty(job.boxes[area - 1])) {
                *surface = make_surface(job, area);
            }
            const std::lock_guard<std::mutex> guard(lock);
            done[area - 1] = std::move(surface);
            changed.notify_all();
        }
    } catch (...) {
        stop();
    }
}

std::unique_ptr<Surface> Works::wait_for(size_t i)
{
    std::unique_lock<std::mutex> guard(lock);
    changed.wait(guard, [this, i] { return failure || done[i]; });
    if (failure) {
        return nullptr;
    }
    std::unique_ptr<Surface> surface = std::move(done[i]);
    given = i + 1;
    changed.notify_all();
    return surface;
}

void Works::give_out(Stream &stream)
{
    try {
        for (size_t i = 0; i < done.size(); i++) {
            const std::unique_ptr<Surface> surface = wait_for(i);
            if (!surface) {
                return;
            }
            if (!surface->triangles.empty()) {
                stream.mesh(*surface);
            }
        }
    } catch (...) {
        stop();
    }
}

/* Keeps the exception under way for run(), and lets every thread end. */
void Works::stop()
{
    const std::lock_guard<std::mutex> guard(lock);
    if (!failure) {
        failure = std::current_exception();
    }
    changed.notify_all();
}

} // namespace

Surface surface_from(vtkPolyData *poly)
{
    Surface surface;
    vtkCellArray *cells = poly->GetPolys();
    const vtkIdType points = poly->GetNumberOfPoints();
    std::vector<uint32_t> number(static_cast<size_t>(points), UINT32_MAX);
    vtkIdType size;
    const vtkIdType *ids;
    surface.triangles.reserve(3 * static_cast<size_t>(cells->GetNumberOfCells()));
    surface.positions.reserve(3 * static_cast<size_t>(points));
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);) {
        for (vtkIdType corner = 0; size == 3 && corner < 3; corner++) {
            const vtkIdType id = ids[corner];
            if (id < 0 || id >= points) {
                throw Failure("vertex index " + std::to_string(id) + ", allowed are 0 to " +
                              std::to_string(points - 1));
            }
            uint32_t &at = number[static_cast<size_t>(id)];
            if (at == UINT32_MAX) {
                double p[3];
                at = static_cast<uint32_t>(surface.positions.size() / 3);
                poly->GetPoint(id, p);
                surface.positions.insert(surface.positions.end(), {float(p[0]), float(p[1]), float(p[2])});
            }
            surface.triangles.push_back(at);
        }
    }
    return surface;
}

void make_surfaces(Stream &stream, const SurfacesRequest &request)
{
    Works(request).run(stream);
}
