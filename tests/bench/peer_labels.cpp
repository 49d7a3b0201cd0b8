// SPDX-License-Identifier: BSD-3-Clause
// VTK pickers and the hardware selector on a labelled volume.
#include <vtkCellPicker.h>
#include <vtkDataObject.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkHardwareSelector.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkVolume.h>
#include <vtkVolumePicker.h>
#include <vtkVolumeProperty.h>

#include <cmath>
#include <limits>
#include <memory>

#include "bench/peers/peer_window.hpp"
#include "tests/bench/peer_labels.h"

struct peer_labels {
    const struct volume *volume;
    vtkNew<vtkRenderer> renderer;
    vtkSmartPointer<vtkRenderWindow> window; /* pickers ask for its size; drawn to for the selector only */
    bool is_drawn;
    vtkNew<vtkVolumePicker> volume_picker;
    vtkNew<vtkCellPicker> cell_picker;
    vtkNew<vtkHardwareSelector> selector;
};

namespace
{

constexpr uint32_t size[2] = {PEER_RESOLUTION, PEER_RESOLUTION};
constexpr double range[2] = {1, 2000}; /* mm before the eye */

/* VTK gets a mask: its pickers interpolate values, and between two labels there are others. */
vtkSmartPointer<vtkImageData> image_of(const struct volume &volume)
{
    auto image = vtkSmartPointer<vtkImageData>::New();
    const size_t *dim = volume.info.dim;
    image->SetDimensions(static_cast<int>(dim[0]), static_cast<int>(dim[1]), static_cast<int>(dim[2]));
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    auto *values = static_cast<unsigned char *>(image->GetScalarPointer());
    for (size_t i = 0; i < volume.voxel_count; i++) {
        values[i] = volume_object(&volume, i) != 0;
    }
    return image;
}

void show(peer_labels &labels, double opacity)
{
    vtkNew<vtkPiecewiseFunction> clear_background;
    clear_background->AddPoint(0, 0);
    clear_background->AddPoint(1, opacity);
    vtkNew<vtkGPUVolumeRayCastMapper> mapper;
    mapper->SetInputData(image_of(*labels.volume));
    mapper->AutoAdjustSampleDistancesOff();
    mapper->SetSampleDistance(1);
    vtkNew<vtkVolume> shown;
    shown->SetMapper(mapper);
    shown->GetProperty()->SetScalarOpacity(clear_background);
    shown->GetProperty()->SetScalarOpacityUnitDistance(1);
    shown->GetProperty()->SetInterpolationTypeToNearest();
    vtkNew<vtkMatrix4x4> matrix;
    for (int i = 0; i < 16; i++) {
        matrix->SetElement(i % 4, i / 4, labels.volume->info.world_from_voxel[i]);
    }
    shown->SetUserMatrix(matrix);
    labels.renderer->AddVolume(shown);
}

std::unique_ptr<peer_labels> make(const struct volume *volume, double opacity, bool window)
{
    auto labels = std::make_unique<peer_labels>();
    labels->volume = volume;
    labels->is_drawn = window;
    if (window) {
        labels->window = peers::make_window(labels->renderer, size);
    } else {
        labels->window = vtkSmartPointer<vtkRenderWindow>::New();
        labels->window->SetSize(size[0], size[1]);
        labels->window->AddRenderer(labels->renderer);
    }
    show(*labels, opacity);
    labels->volume_picker->SetTolerance(0);
    labels->cell_picker->SetTolerance(0);
    labels->selector->SetRenderer(labels->renderer);
    labels->selector->SetFieldAssociation(vtkDataObject::FIELD_ASSOCIATION_CELLS);
    labels->selector->SetArea(0, 0, size[0] - 1, size[1] - 1);
    return labels;
}

uint64_t voxel_at(const struct volume &volume, const size_t at[3])
{
    return at[0] + volume.info.dim[0] * (at[1] + volume.info.dim[1] * at[2]);
}

peer_contact contact_of(const struct volume &volume, const size_t at[3], double distance)
{
    const uint64_t voxel = voxel_at(volume, at);
    return {volume_object(&volume, voxel), voxel, distance};
}

constexpr peer_contact nothing = {0, UINT64_MAX, std::numeric_limits<double>::infinity()};

void pick(peer_labels &labels, peer_contact *contacts, const cone &cone, peer_picker kind, double isovalue)
{
    vtkCellPicker *picker = kind == PEER_CELL_PICKER ? labels.cell_picker.Get() : labels.volume_picker.Get();
    const double *origin = cone.pose.world_from_device + 12;
    picker->SetVolumeOpacityIsovalue(isovalue);
    peers::aim_camera(labels.renderer, cone.pose.world_from_device, cone.angle, range);
    for (uint32_t i = 0; i < size[0] * size[1]; i++) {
        const uint32_t column = i % size[0];
        const uint32_t row = i / size[0];
        contacts[i] = nothing;
        if (picker->Pick(column + 0.5, row + 0.5, 0, labels.renderer)) {
            const double *place = picker->GetPickPosition();
            const int *index = picker->GetPointIJK();
            const size_t at[3] = {static_cast<size_t>(index[0]), static_cast<size_t>(index[1]),
                                  static_cast<size_t>(index[2])};
            const double far = std::hypot(place[0] - origin[0], place[1] - origin[1], place[2] - origin[2]);
            contacts[i] = contact_of(*labels.volume, at, far);
        }
    }
}

/* VTK numbers voxels in a grid of one less along each axis. */
peer_contact contact_of_index(const struct volume &volume, vtkIdType index)
{
    const size_t *dim = volume.info.dim;
    const size_t i = static_cast<size_t>(index);
    const size_t at[3] = {i % (dim[0] - 1), i / (dim[0] - 1) % (dim[1] - 1), i / (dim[0] - 1) / (dim[1] - 1)};
    return at[2] < dim[2] ? contact_of(volume, at, std::numeric_limits<double>::quiet_NaN()) : nothing;
}

void select(peer_labels &labels, peer_contact *contacts, const cone &cone)
{
    if (!labels.is_drawn) {
        throw std::logic_error("peer_labels_select() without a window");
    }
    peers::aim_camera(labels.renderer, cone.pose.world_from_device, cone.angle, range);
    if (!labels.selector->CaptureBuffers()) {
        throw std::runtime_error("vtkHardwareSelector captured nothing");
    }
    for (uint32_t i = 0; i < size[0] * size[1]; i++) {
        const unsigned at[2] = {i % size[0], i / size[0]};
        const vtkHardwareSelector::PixelInformation pixel = labels.selector->GetPixelInformation(at);
        contacts[i] =
            pixel.Valid && pixel.AttributeID >= 0 ? contact_of_index(*labels.volume, pixel.AttributeID) : nothing;
    }
    labels.selector->ClearBuffers();
    labels.window->ReleaseCurrent();
}

} // namespace

conus_status peer_labels_create(struct peer_labels **out, const struct volume *volume, double opacity, bool window)
{
    return peers::guarded([&] { *out = make(volume, opacity, window).release(); });
}

void peer_labels_destroy(struct peer_labels *labels)
{
    delete labels;
}

conus_status peer_labels_pick(struct peer_labels *labels, struct peer_contact *contacts, const struct cone *cone,
                              enum peer_picker kind, double isovalue)
{
    return peers::guarded([&] { pick(*labels, contacts, *cone, kind, isovalue); });
}

conus_status peer_labels_select(struct peer_labels *labels, struct peer_contact *contacts, const struct cone *cone)
{
    return peers::guarded([&] { select(*labels, contacts, *cone); });
}
