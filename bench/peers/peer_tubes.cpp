// SPDX-License-Identifier: BSD-3-Clause
// VTK cell locators on streamlines, which are tubes.
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkTriangleFilter.h>
#include <vtkTubeFilter.h>
#include <vtkUnsignedIntArray.h>

#include <memory>

#include "bench/peers/peer_window.hpp"

struct peer_tubes {
    vtkSmartPointer<vtkPolyData> tubes; // its cells have numbers of streamlines as their only data
    vtkSmartPointer<vtkAbstractCellLocator> locators[PEER_LOCATORS];
    vtkNew<vtkGenericCell> cell;
};

namespace
{

// A line each, with its number, from 1.
vtkSmartPointer<vtkPolyData> make_lines(const tractogram &from)
{
    vtkNew<vtkFloatArray> coordinates;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkUnsignedIntArray> numbers;
    coordinates->SetNumberOfComponents(3);
    coordinates->SetNumberOfTuples(static_cast<vtkIdType>(from.point_count));
    std::copy(from.points, from.points + 3 * from.point_count, coordinates->GetPointer(0));
    points->SetData(coordinates);
    for (size_t s = 0; s < from.streamline_count; s++) {
        lines->InsertNextCell(static_cast<int>(from.first[s + 1] - from.first[s]));
        for (uint64_t i = from.first[s]; i < from.first[s + 1]; i++) {
            lines->InsertCellPoint(static_cast<vtkIdType>(i));
        }
        numbers->InsertNextValue(static_cast<unsigned>(s) + 1);
    }
    auto out = vtkSmartPointer<vtkPolyData>::New();
    out->SetPoints(points);
    out->SetLines(lines);
    out->GetCellData()->AddArray(numbers);
    return out;
}

std::unique_ptr<peer_tubes> make(const tractogram &from, int sides)
{
    vtkNew<vtkTubeFilter> tube;
    vtkNew<vtkTriangleFilter> triangles;
    tube->SetInputData(make_lines(from));
    tube->SetRadius(from.radius);
    tube->SetNumberOfSides(sides);
    tube->CappingOn();
    triangles->SetInputConnection(tube->GetOutputPort());
    tube->ReleaseDataFlagOn();
    triangles->Update();
    auto out = std::make_unique<peer_tubes>();
    out->tubes = triangles->GetOutput();
    return out;
}

void trace(peer_tubes &tubes, uint32_t *streamlines, const cone &cone, double reach, peer_locator kind)
{
    auto *numbers = vtkUnsignedIntArray::SafeDownCast(tubes.tubes->GetCellData()->GetArray(0));
    for (uint32_t i = 0; i < PEER_RESOLUTION * PEER_RESOLUTION; i++) {
        const vtkIdType cell = peers::first_cell(tubes.locators[kind], cone, i, reach, tubes.cell);
        streamlines[i] = cell < 0 ? 0 : numbers->GetValue(cell);
    }
}

} // namespace

conus_status peer_tubes_create(struct peer_tubes **out, const struct tractogram *tractogram, int sides)
{
    return peers::guarded([&] { *out = make(*tractogram, sides).release(); });
}

void peer_tubes_destroy(struct peer_tubes *tubes)
{
    delete tubes;
}

conus_status peer_tubes_build(struct peer_tubes *tubes, enum peer_locator kind)
{
    return peers::guarded([&] { tubes->locators[kind] = peers::build_locator(kind, tubes->tubes); });
}

conus_status peer_tubes_trace(struct peer_tubes *tubes, uint32_t *streamlines, const struct cone *cone, double reach,
                              enum peer_locator kind)
{
    return peers::guarded([&] { trace(*tubes, streamlines, *cone, reach, kind); });
}
