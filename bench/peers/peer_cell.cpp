// SPDX-License-Identifier: BSD-3-Clause
// VTK cell pickers and cell locators on the surfaces of an atlas.
#include <vtkActor.h>
#include <vtkCellLocator.h>
#include <vtkCellPicker.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkStaticCellLocator.h>

#include <memory>
#include <vector>

#include "bench/peers/peer_window.hpp"

extern "C" {
#include "base/geometry/math3.h"
}

struct peer_surface {
    vtkSmartPointer<vtkPolyData> surface;
    std::vector<uint32_t> object_of_cell;
    vtkSmartPointer<vtkAbstractCellLocator> locators[PEER_LOCATORS];
    vtkNew<vtkCellPicker> pickers[PEER_LOCATORS]; /* the first without a locator */
    vtkNew<vtkGenericCell> cell;
    vtkNew<vtkRenderer> renderer;
    vtkSmartPointer<vtkRenderWindow> window; /* not drawn to: pickers ask for its size */
    double range[2];
};

namespace
{

std::unique_ptr<peer_surface> make(const mesh_object *objects, size_t count, double reach)
{
    auto out = std::make_unique<peer_surface>();
    out->surface = peers::make_surface(objects, count);
    for (size_t i = 0; i < count; i++) {
        out->object_of_cell.insert(out->object_of_cell.end(), objects[i].mesh->triangle_count,
                                   static_cast<uint32_t>(i) + 1);
    }
    out->range[0] = reach * 1e-4;
    out->range[1] = reach;
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(out->surface);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    out->renderer->AddActor(actor);
    out->window = vtkSmartPointer<vtkRenderWindow>::New();
    out->window->AddRenderer(out->renderer);
    for (auto &picker : out->pickers) {
        picker->SetTolerance(0);
    }
    return out;
}

} // namespace

conus_status peer_surface_create(struct peer_surface **out, const struct mesh_object *objects, size_t count,
                                 double reach)
{
    return peers::guarded([&] { *out = make(objects, count, reach).release(); });
}

void peer_surface_destroy(struct peer_surface *surface)
{
    delete surface;
}

conus_status peer_surface_build(struct peer_surface *surface, enum peer_locator kind)
{
    return peers::guarded([&] {
        vtkSmartPointer<vtkAbstractCellLocator> &locator = surface->locators[kind];
        if (locator || kind == PEER_NO_LOCATOR) {
            return;
        }
        if (kind == PEER_CELL_LOCATOR) {
            locator = vtkSmartPointer<vtkCellLocator>::New();
        } else {
            locator = vtkSmartPointer<vtkStaticCellLocator>::New();
        }
        locator->SetDataSet(surface->surface);
        locator->BuildLocator();
        surface->pickers[kind]->AddLocator(locator);
    });
}

conus_status peer_surface_trace(struct peer_surface *surface, uint32_t *objects, const struct cone *cone,
                                enum peer_locator kind)
{
    return peers::guarded([&] {
        const double *origin = cone->pose.world_from_device + 12;
        const uint32_t n = cone->resolution;
        for (uint32_t i = 0; i < n * n; i++) {
            double end[3], t, place[3], parameters[3];
            int part;
            vtkIdType cell = -1;
            cone_ray(end, cone, i % n, i / n);
            vec3_add_scaled(end, origin, surface->range[1], end);
            const int found = surface->locators[kind]->IntersectWithLine(origin, end, 0, t, place, parameters, part,
                                                                         cell, surface->cell);
            objects[i] = found ? surface->object_of_cell[static_cast<size_t>(cell)] : 0;
        }
    });
}

conus_status peer_surface_pick(struct peer_surface *surface, uint32_t *objects, const struct cone *cone,
                               enum peer_locator kind)
{
    return peers::guarded([&] {
        vtkCellPicker *picker = surface->pickers[kind];
        const uint32_t n = cone->resolution;
        surface->window->SetSize(static_cast<int>(n), static_cast<int>(n));
        peers::aim_camera(surface->renderer, cone->pose.world_from_device, cone->angle, surface->range);
        for (uint32_t i = 0; i < n * n; i++) {
            const uint32_t column = i % n;
            const uint32_t row = i / n;
            const bool found = picker->Pick(column + 0.5, row + 0.5, 0, surface->renderer);
            objects[i] = found ? surface->object_of_cell[static_cast<size_t>(picker->GetCellId())] : 0;
        }
    });
}
