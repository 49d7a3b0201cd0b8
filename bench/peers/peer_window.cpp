// SPDX-License-Identifier: BSD-3-Clause
// Opens the VTK windows of the other files here, and checks the display first.
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkPoints.h>
#include <vtkRenderingOpenGLConfigure.h>
#include <vtkVersion.h>

#include <cmath>
#include <string>

#ifdef VTK_USE_X
#include <X11/Xlib.h>
#endif

#include "bench/peers/peer_window.hpp"

extern "C" {
#include "base/geometry/math3.h"
}

const char *peer_version(void)
{
    return "VTK " VTK_VERSION;
}

namespace
{

/* VTK's window ends the process where it cannot open the display. This connection stays open: a server like Xvfb starts
 * anew when its last client goes, and refuses others meanwhile. */
void need_display()
{
#ifdef VTK_USE_X
    static ::Display *const display = XOpenDisplay(nullptr);
    if (!display) {
        throw peers::NoDisplay("VTK draws to an X display and there is none (DISPLAY; xvfb-run makes one)");
    }
#endif
}

} // namespace

conus_status peer_check_display(void)
{
    return peers::guarded(need_display);
}

vtkSmartPointer<vtkRenderWindow> peers::make_window(vtkRenderer *renderer, const uint32_t size[2])
{
    need_display();
    auto window = vtkSmartPointer<vtkRenderWindow>::New();
    window->OffScreenRenderingOn();
    window->SetMultiSamples(0);
    window->AlphaBitPlanesOn();
    window->SwapBuffersOff();
    window->SetSize(static_cast<int>(size[0]), static_cast<int>(size[1]));
    window->AddRenderer(renderer);
    return window;
}

void peers::aim_camera(vtkRenderer *renderer, const double world_from_camera[16], double angle, const double range[2])
{
    const double *m = world_from_camera;
    vtkCamera *camera = renderer->GetActiveCamera();
    camera->SetPosition(m[12], m[13], m[14]);
    camera->SetFocalPoint(m[12] - m[8], m[13] - m[9], m[14] - m[10]);
    camera->SetViewUp(m[4], m[5], m[6]);
    camera->SetViewAngle(degrees_from_radians(angle));
    camera->SetClippingRange(range[0], range[1]);
}

vtkSmartPointer<vtkPolyData> peers::make_surface(const mesh_object *objects, size_t count)
{
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    points->SetDataTypeToFloat();
    for (size_t i = 0; i < count; i++) {
        const struct mesh *mesh = objects[i].mesh;
        const vtkIdType first = points->GetNumberOfPoints();
        for (size_t v = 0; v < mesh->vertex_count; v++) {
            double place[3] = {mesh->positions[3 * v], mesh->positions[3 * v + 1], mesh->positions[3 * v + 2]};
            if (objects[i].world_from_mesh) {
                mat4_point(place, objects[i].world_from_mesh, place);
            }
            points->InsertNextPoint(place);
        }
        for (size_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *corner = mesh->triangles + 3 * t;
            cells->InsertNextCell({first + corner[0], first + corner[1], first + corner[2]});
        }
    }
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->SetPoints(points);
    surface->SetPolys(cells);
    return surface;
}
