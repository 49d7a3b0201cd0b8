// SPDX-License-Identifier: BSD-3-Clause
// VTK volume mappers that draw a context volume.
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "bench/peers/peer_window.hpp"

struct peer_picture {
    vtkNew<vtkRenderer> renderer;
    vtkSmartPointer<vtkRenderWindow> window;
    int size[2];
};

namespace
{

/* Bytes, as most files of grey values hold them, from the transfer function's first to its last value. */
vtkSmartPointer<vtkImageData> image_of(const struct volume &volume, const peer_transfer &transfer)
{
    auto image = vtkSmartPointer<vtkImageData>::New();
    const size_t *dim = volume.info.dim;
    image->SetDimensions(static_cast<int>(dim[0]), static_cast<int>(dim[1]), static_cast<int>(dim[2]));
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
    std::transform(volume.values, volume.values + volume.voxel_count,
                   static_cast<unsigned char *>(image->GetScalarPointer()), [&transfer](float value) {
                       const double part = (static_cast<double>(value) - transfer.low) / (transfer.high - transfer.low);
                       return static_cast<unsigned char>(std::lrint(std::clamp(part, 0.0, 1.0) * 255));
                   });
    return image;
}

void set_transfer(vtkVolumeProperty *property, const peer_transfer &transfer)
{
    vtkNew<vtkColorTransferFunction> colour;
    vtkNew<vtkPiecewiseFunction> opacity;
    for (size_t i = 0; i < transfer.count; i++) {
        const float *entry = transfer.rgba[i];
        const double value = 255 * static_cast<double>(i) / static_cast<double>(transfer.count - 1);
        colour->AddRGBPoint(value, entry[0], entry[1], entry[2]);
        opacity->AddPoint(value, entry[3]);
    }
    property->SetColor(colour);
    property->SetScalarOpacity(opacity);
    property->SetScalarOpacityUnitDistance(1);
    property->SetInterpolationTypeToLinear();
}

vtkSmartPointer<vtkVolumeMapper> make_mapper(vtkImageData *image, const peer_picture_options &options)
{
    if (options.caster == PEER_GPU) {
        auto mapper = vtkSmartPointer<vtkGPUVolumeRayCastMapper>::New();
        mapper->SetInputData(image);
        mapper->AutoAdjustSampleDistancesOff();
        mapper->SetSampleDistance(static_cast<float>(options.sample_mm));
        return mapper;
    }
    auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
    mapper->SetInputData(image);
    mapper->AutoAdjustSampleDistancesOff();
    mapper->SetSampleDistance(static_cast<float>(options.sample_mm));
    mapper->SetImageSampleDistance(1);
    if (options.one_thread) {
        mapper->SetNumberOfThreads(1);
    }
    return mapper;
}

std::unique_ptr<peer_picture> make(const struct volume &volume, const peer_transfer &transfer, const camera &camera,
                                   const peer_picture_options &options)
{
    const double range[2] = {1, 2000};
    auto picture = std::make_unique<peer_picture>();
    picture->size[0] = static_cast<int>(options.size[0]);
    picture->size[1] = static_cast<int>(options.size[1]);
    picture->window = peers::make_window(picture->renderer, options.size);
    picture->renderer->SetBackground(0, 0, 0);
    picture->renderer->SetBackgroundAlpha(0);
    vtkNew<vtkVolume> shown;
    shown->SetMapper(make_mapper(image_of(volume, transfer), options));
    set_transfer(shown->GetProperty(), transfer);
    shown->GetProperty()->SetShade(options.shade);
    vtkNew<vtkMatrix4x4> matrix;
    for (int i = 0; i < 16; i++) {
        matrix->SetElement(i % 4, i / 4, volume.info.world_from_voxel[i]);
    }
    shown->SetUserMatrix(matrix);
    picture->renderer->AddVolume(shown);
    peers::aim_camera(picture->renderer, camera.world_from_camera, 2 * std::atan(camera.slope[1]), range);
    picture->window->Render();
    picture->window->WaitForCompletion();
    picture->window->ReleaseCurrent();
    return picture;
}

} // namespace

conus_status peer_picture_create(struct peer_picture **out, const struct volume *context,
                                 const struct peer_transfer *transfer, const struct camera *camera,
                                 const struct peer_picture_options *options)
{
    return peers::guarded([&] { *out = make(*context, *transfer, *camera, *options).release(); });
}

void peer_picture_destroy(struct peer_picture *picture)
{
    delete picture;
}

conus_status peer_picture_draw(struct peer_picture *picture)
{
    return peers::guarded([&] {
        picture->window->Render();
        picture->window->WaitForCompletion();
        picture->window->ReleaseCurrent();
    });
}

conus_status peer_picture_read(struct peer_picture *picture, float *rgba)
{
    return peers::guarded([&] {
        vtkNew<vtkFloatArray> pixels;
        picture->window->MakeCurrent();
        picture->window->GetRGBAPixelData(0, 0, picture->size[0] - 1, picture->size[1] - 1, 0, pixels);
        picture->window->ReleaseCurrent();
        std::memcpy(rgba, pixels->GetPointer(0), sizeof(float) * static_cast<size_t>(pixels->GetNumberOfValues()));
    });
}
