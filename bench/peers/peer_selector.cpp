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
    std::unordered_map<const vtkProp *, uint32_t> numbers; /* of the actors */
    uint32_t low[2];                                       /* corner of the square of pixels that is looked at */
    uint32_t height;
    double range[2];
};

namespace
{

void place(vtkActor *actor, const double *world_from_mesh)
{
    if (world_from_mesh) {
        vtkNew<vtkMatrix4x4> matrix;
        for (int i = 0; i < 16; i++) {
            matrix->SetElement(i % 4, i / 4, world_from_mesh[i]);
        }
        actor->SetUserMatrix(matrix);
    }
}

/* Actors of one mesh share its mapper. */
void add_actors(peer_selector &selector, const mesh_object *objects, size_t count)
{
    std::unordered_map<const struct mesh *, vtkSmartPointer<vtkPolyDataMapper>> mappers;
    for (size_t i = 0; i < count; i++) {
        if (!objects[i].mesh) {
            continue;
        }
        vtkSmartPointer<vtkPolyDataMapper> &mapper = mappers[objects[i].mesh];
        if (!mapper) {
            mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
            const mesh_object unplaced = {objects[i].mesh, nullptr};
            mapper->SetInputData(peers::make_surface(&unplaced, 1));
        }
        vtkNew<vtkActor> actor;
        actor->SetMapper(mapper);
        place(actor, objects[i].world_from_mesh);
        selector.renderer->AddActor(actor);
        selector.numbers[actor] = static_cast<uint32_t>(i) + 1;
    }
}

/* The window's angle, so that the cone fills the square in its middle. */
double window_angle(const peer_selector &selector, const cone &cone)
{
    return 2 * std::atan(cone_slope(&cone) * selector.height / PEER_RESOLUTION);
}

void aim(peer_selector &selector, const cone &cone)
{
    peers::aim_camera(selector.renderer, cone.pose.world_from_device, window_angle(selector, cone), selector.range);
}

std::unique_ptr<peer_selector> make(const mesh_object *objects, size_t count, const uint32_t size[2], double reach,
                                    const cone &cone)
{
    auto selector = std::make_unique<peer_selector>();
    selector->window = peers::make_window(selector->renderer, size);
    selector->height = size[1];
    selector->range[0] = reach * 1e-4;
    selector->range[1] = reach;
    for (int a = 0; a < 2; a++) {
        selector->low[a] = (size[a] - PEER_RESOLUTION) / 2;
    }
    add_actors(*selector, objects, count);
    vtkHardwareSelector *pass = selector->selector;
    pass->SetRenderer(selector->renderer);
    pass->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
    pass->SetArea(selector->low[0], selector->low[1], selector->low[0] + PEER_RESOLUTION - 1,
                  selector->low[1] + PEER_RESOLUTION - 1);
    aim(*selector, cone);
    selector->window->Render();
    selector->window->ReleaseCurrent();
    return selector;
}

uint32_t number_of(const peer_selector &selector, const vtkHardwareSelector::PixelInformation &pixel)
{
    if (!pixel.Valid) {
        return 0;
    }
    auto found = selector.numbers.find(pixel.Prop);
    return found == selector.numbers.end() ? 0 : found->second;
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
        const unsigned at[2] = {selector.low[0] + i % PEER_RESOLUTION, selector.low[1] + i / PEER_RESOLUTION};
        objects[i] = number_of(selector, pass->GetPixelInformation(at));
    }
    pass->ClearBuffers();
    selector.window->ReleaseCurrent();
}

} // namespace

conus_status peer_selector_create(struct peer_selector **out, const struct mesh_object *objects, size_t count,
                                  const uint32_t size[2], double reach, const struct cone *cone)
{
    return peers::guarded([&] { *out = make(objects, count, size, reach, *cone).release(); });
}

void peer_selector_destroy(struct peer_selector *selector)
{
    delete selector;
}

conus_status peer_selector_trace(struct peer_selector *selector, uint32_t *objects, const struct cone *cone)
{
    return peers::guarded([&] { trace(*selector, objects, *cone); });
}
