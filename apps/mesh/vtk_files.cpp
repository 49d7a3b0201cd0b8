// SPDX-License-Identifier: BSD-3-Clause
// Mesh files of other programs, by VTK's readers, as triangles.
#include "conus_mesh.hpp"
#include "failure.hpp"
#include "file_head.hpp"
#include "mapped_file.hpp"
#include "obj_file.hpp"

#include <vtkAbstractArray.h>
#include <vtkAlgorithm.h>
#include <vtkCellArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTriangleFilter.h>
#include <vtkVariant.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <limits>
#include <map>
#include <new>
#include <sys/stat.h>
#include <utility>

namespace
{

/* What VTK has to say: the first line is kept instead of printed. */
class Listener : public vtkOutputWindow
{
  public:
    static Listener *New();
    vtkTypeMacro(Listener, vtkOutputWindow);

    void DisplayText(const char *text) override
    {
        if (!first.empty()) {
            return;
        }
        /* "ERROR: In file, line n\nvtkThing (0x123): what it is about\n", or without vtkThing */
        first = text;
        const size_t object = first.find("): ");
        const size_t line = first.find('\n');
        if (object != std::string::npos) {
            first.erase(0, object + 3);
        } else if (line != std::string::npos && line + 1 < first.size()) {
            first.erase(0, line + 1);
        }
        first.erase(std::find(first.begin(), first.end(), '\n'), first.end());
        for (size_t at; (at = first.find("(0x")) != std::string::npos && first.find(')', at) != std::string::npos;) {
            first.erase(at, first.find(')', at) - at + 1); /* where in memory an object is, says nothing */
        }
        first = first.empty() ? "an error without a description" : first;
    }

    /* What was said since the last time, "" for nothing. */
    std::string take()
    {
        return std::exchange(first, std::string());
    }

  private:
    std::string first;
};
vtkStandardNewMacro(Listener);

std::string read_head(const std::string &path, size_t limit)
{
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw Failure(std::string("cannot open: ") + std::strerror(errno));
    }
    std::string head(limit, '\0');
    file.read(head.data(), static_cast<std::streamsize>(limit));
    head.resize(static_cast<size_t>(file.gcount()));
    return head;
}

uint64_t size_of(const std::string &path)
{
    struct stat info;
    return stat(path.c_str(), &info) ? 0 : static_cast<uint64_t>(info.st_size);
}

mesh_space space_of_field(vtkPolyData *poly)
{
    vtkAbstractArray *field = poly->GetFieldData()->GetAbstractArray("SPACE");
    if (!field || field->GetNumberOfValues() < 1) {
        return MESH_SPACE_UNSTATED;
    }
    return space_in("SPACE=" + field->GetVariantValue(0).ToString());
}

template <typename Reader> vtkSmartPointer<vtkPolyData> read_as(const std::string &path)
{
    vtkNew<Reader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    if (reader->GetErrorCode()) {
        throw Failure("VTK's reader failed (code " + std::to_string(reader->GetErrorCode()) + ")");
    }
    return reader->GetOutput();
}

/* VTK would leave out triangles that have two corners at the same position; conus counts what is left out. */
vtkSmartPointer<vtkPolyData> read_stl(const std::string &path)
{
    vtkNew<vtkSTLReader> reader;
    reader->SetFileName(path.c_str());
    reader->MergingOff();
    reader->Update();
    if (reader->GetErrorCode()) {
        throw Failure("VTK's reader failed (code " + std::to_string(reader->GetErrorCode()) + ")");
    }
    vtkSmartPointer<vtkPolyData> poly = reader->GetOutput();
    std::map<std::array<double, 3>, vtkIdType> first;
    vtkNew<vtkCellArray> merged;
    vtkIdType size;
    const vtkIdType *ids;
    for (poly->GetPolys()->InitTraversal(); poly->GetPolys()->GetNextCell(size, ids);) {
        merged->InsertNextCell(static_cast<int>(size));
        for (vtkIdType i = 0; i < size; i++) {
            std::array<double, 3> position;
            poly->GetPoint(ids[i], position.data());
            merged->InsertCellPoint(first.emplace(position, ids[i]).first->second);
        }
    }
    poly->SetPolys(merged);
    return poly;
}

vtkSmartPointer<vtkPolyData> read_with(Format format, const std::string &path)
{
    switch (format) {
    case Format::Vtk:
        return read_as<vtkPolyDataReader>(path);
    case Format::Vtp:
        return read_as<vtkXMLPolyDataReader>(path);
    case Format::Ply:
        return read_as<vtkPLYReader>(path);
    case Format::Stl:
        return read_stl(path);
    case Format::Obj:
        break;
    }
    return read_as<vtkOBJReader>(path);
}

void check_indices(vtkCellArray *cells, vtkIdType points)
{
    vtkIdType size;
    const vtkIdType *ids;
    for (cells->InitTraversal(); cells->GetNextCell(size, ids);) {
        for (vtkIdType i = 0; i < size; i++) {
            if (ids[i] < 0 || ids[i] >= points) {
                throw Failure("vertex index " + std::to_string(ids[i]) + ", allowed are 0 to " +
                              std::to_string(points - 1));
            }
        }
    }
}

/* What a file holds, as VTK reads it. */
struct Content {
    Format format = Format::Vtk;
    mesh_space space = MESH_SPACE_UNSTATED;
    vtkSmartPointer<vtkPolyData> poly;
    Objects objects; /* of an OBJ file */
};

Content read_content(const std::string &path, Listener *listener)
{
    const std::string head = read_head(path, 65536);
    Content content;
    content.format = format_of(path, head);
    if (content.format == Format::Ply) {
        check_ply_counts(head, size_of(path));
    }
    if (content.format == Format::Stl) {
        check_stl_size(head, size_of(path));
    }
    if (content.format == Format::Obj) {
        const MappedFile file(path);
        content.objects = parse_obj(file.text());
    }
    try {
        content.poly = read_with(content.format, path);
    } catch (const Failure &failure) {
        const std::string said = listener->take();
        throw Failure(said.empty() ? failure.what() : "VTK's reader: " + said);
    }
    const std::string said = listener->take();
    if (!said.empty()) {
        throw Failure("VTK's reader: " + said);
    }
    check_indices(content.poly->GetPolys(), content.poly->GetNumberOfPoints());
    check_indices(content.poly->GetStrips(), content.poly->GetNumberOfPoints());
    content.space = content.format == Format::Vtp ? space_of_field(content.poly) : stated_space(content.format, head);
    return content;
}

Surface surface_of(vtkPolyData *poly, mesh_space space, uint32_t id)
{
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(poly);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    Surface surface = surface_from(triangles->GetOutput());
    surface.space = space;
    surface.id = id;
    return surface;
}

/* The faces of every object. */
std::vector<vtkSmartPointer<vtkCellArray>> deal_faces(vtkCellArray *faces, const Objects &objects)
{
    std::vector<vtkSmartPointer<vtkCellArray>> dealt(objects.names.size());
    vtkIdType size;
    const vtkIdType *ids;
    if (static_cast<size_t>(faces->GetNumberOfCells()) != objects.of_face.size()) {
        throw Failure("objects: " + std::to_string(objects.of_face.size()) + " faces, VTK's reader found " +
                      std::to_string(faces->GetNumberOfCells()));
    }
    for (vtkSmartPointer<vtkCellArray> &some : dealt) {
        some = vtkSmartPointer<vtkCellArray>::New();
    }
    size_t face = 0;
    for (faces->InitTraversal(); faces->GetNextCell(size, ids);) {
        dealt[objects.of_face[face++]]->InsertNextCell(size, ids);
    }
    return dealt;
}

void write_objects(Stream &stream, const std::string &path, Listener *listener)
{
    const Content content = read_content(path, listener);
    const Objects &objects = content.objects;
    if (objects.names.size() < 2) {
        stream.mesh(surface_of(content.poly, content.space, 0), objects.names.empty() ? "" : objects.names[0]);
        return;
    }
    const std::vector<vtkSmartPointer<vtkCellArray>> dealt = deal_faces(content.poly->GetPolys(), objects);
    for (uint32_t i = 0; i < dealt.size(); i++) {
        vtkNew<vtkPolyData> part;
        part->SetPoints(content.poly->GetPoints());
        part->SetPolys(dealt[i]);
        stream.mesh(surface_of(part, content.space, i), objects.names[i]);
    }
}

/* Calls `read`; what it throws becomes the failure of file `id`. */
template <typename Read> void try_file(Stream &stream, uint32_t id, Read read)
{
    try {
        read();
    } catch (const std::bad_alloc &) {
        stream.failure(id, "VTK's reader needs more memory than a file of this size is allowed");
    } catch (const Failure &failure) {
        stream.failure(id, failure.what());
    }
}

} // namespace

void read_files(Stream &stream, const std::vector<std::string> &paths)
{
    vtkNew<Listener> listener;
    vtkOutputWindow::SetInstance(listener);
    for (uint32_t i = 0; i < paths.size(); i++) {
        listener->take();
        try_file(stream, i, [&] {
            const Content content = read_content(paths[i], listener);
            stream.mesh(surface_of(content.poly, content.space, i));
        });
    }
    vtkOutputWindow::SetInstance(nullptr);
}

void read_objects(Stream &stream, const std::string &path)
{
    vtkNew<Listener> listener;
    vtkOutputWindow::SetInstance(listener);
    try_file(stream, 0, [&] { write_objects(stream, path, listener); });
    vtkOutputWindow::SetInstance(nullptr);
}
