// SPDX-License-Identifier: BSD-3-Clause
// VTK's hardware selector on the surfaces of an atlas.
#include <vtkActor.h>
#include <vtkHardwareSelector.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>

#include <cmath>
#include <memory>
#include <unordered_map>

#include "bench/peers/peer_window.hpp"

struct peer_selector {
    vtkNew<vtkRenderer> renderer;
    vtkSmartPointer<vtkRenderWindow> window;
    vtkNew<vtkHardwareSelector> selector;
    std::unordered_map<const vtkProp *, uint32_t> numbers; /* number of each actor */
    double range[2];
};

namespace
{

/* Actors of one mesh share its mapper. */
void add_actors(peer_selector &selector, const mesh_object *objects, size_t count)
{
    std::unordered_map<const struct mesh *, vtkSmartPointer<vtkPolyDataMapper>> mappers;
    for (size_t i = 0; i < count; i++) {
        vtkSmartPointer<vtkPolyDataMapper> &mapper = mappers[objects[i].mesh];
        if (!mapper) {
            mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
            const mesh_object unplaced = {objects[i].mesh, nullptr};
            mapper->SetInputData(peers::make_surface(&unplaced, 1));
        }
        vtkNew<vtkActor> actor;
        vtkNew<vtkMatrix4x4> matrix;
        for (int k = 0; k < 16; k++) {
            matrix->SetElement(k % 4, k / 4, objects[i].world_from_mesh[k]);
        }
        actor->SetMapper(mapper);
        actor->SetUserMatrix(matrix);
        selector.renderer->AddActor(actor);
        selector.numbers[actor] = static_cast<uint32_t>(i) + 1;
    }
}

void aim(peer_selector &selector, const cone &cone)
{
    peers::aim_camera(selector.renderer, cone.pose.world_from_device, 2 * std::atan(cone_slope(&cone)), selector.range);
}

std::unique_ptr<peer_selector> make(const mesh_object *objects, size_t count, double reach, const cone &cone)
{
    static const uint32_t size[2] = {PEER_RESOLUTION, PEER_RESOLUTION};
    auto selector = std::make_unique<peer_selector>();
    selector->window = peers::make_window(selector->renderer, size);
    selector->range[0] = reach * 1e-4;
    selector->range[1] = reach;
    add_actors(*selector, objects, count);
    vtkHardwareSelector *pass = selector->selector;
    pass->SetRenderer(selector->renderer);
    pass->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
    pass->SetArea(0, 0, PEER_RESOLUTION - 1, PEER_RESOLUTION - 1);
    aim(*selector, cone);
    selector->window->Render();
    selector->window->ReleaseCurrent();
    return selector;
}

void trace(peer_selector &selector, uint32_t *objects, const cone &cone)
{
    vtkHardwareSelector *pass = selector.selector;
    aim(selector, cone);
    pass->SetActorPassOnly(true);
    if (!pass->CaptureBuffers()) {
        throw std::runtime_error("vtkHardwareSelector captured nothing");
    }
    for (unsigned i = 0; i < PEER_RESOLUTION * PEER_RESOLUTION; i++) {
        const unsigned at[2] = {i % PEER_RESOLUTION, i / PEER_RESOLUTION};
        const vtkHardwareSelector::PixelInformation pixel = pass->GetPixelInformation(at);
        const auto found = pixel.Valid ? selector.numbers.find(pixel.Prop) : selector.numbers.end();
        objects[i] = found == selector.numbers.end() ? 0 : found->second;
    }
    pass->ClearBuffers();
    selector.window->ReleaseCurrent();
}

} // namespace

conus_status peer_selector_create(struct peer_selector **out, const struct mesh_object *objects, size_t count,
                                  double reach, const struct cone *cone)
{
    return peers::guarded([&] { *out = make(objects, count, reach, *cone).release(); });
}

void peer_selector_destroy(struct peer_selector *selector)
{
    delete selector;
}

conus_status peer_selector_trace(struct peer_selector *selector, uint32_t *objects, const struct cone *cone)
{
    return peers::guarded([&] { trace(*selector, objects, *cone); });
}
